// Archives between stages, and body models.
#include "doublet/files/npz.h"
#include "doublet/bodymodel/body_model.h"
#include "doublet/fit/material_estimator.h"
#include "harness.h"

#include <utility>

namespace {

using namespace doublet;

/// What the corpus' performance and garment belong to.
const RiggedMesh &person() {
  static const RiggedMesh actor = read_actor(Path(DOUBLET_FUZZ_CORPUS) / "npz" / "actor.npz");
  return actor;
}

using Read = void (*)(const Path &);

/// An array that an archive of a kind has and others have not, and the reader of that kind.
constexpr std::pair<const char *, Read> kReaders[] = {
    {"dof_names", [](const Path &path) { read_actor(path); }},
    {"dofs", [](const Path &path) { read_performance(path, person()); }},
    {"clothness", [](const Path &path) { read_segmentation(path); }},
    {"covers", [](const Path &path) { read_garment(path, person()); }},
    {"coefficients", [](const Path &path) { read_body(path); }},
    {"contour_offsets", [](const Path &path) { read_observations(path); }},
    {"garment", [](const Path &path) { read_simulated(path); }},
    {"v_template", [](const Path &path) { BodyModel::read(path); }},
    {"body_model_format", [](const Path &path) { BodyModel::read(path); }},
};

} // namespace

DOUBLET_HARNESS(npz) {
  const Path path = fuzz::put("arrays.npz", input);
  Npz npz;
  fuzz::expect_read_or_refused([&] { npz = Npz::read(path); });
  for (const auto &[name, array] : npz.arrays)
    fuzz::expect_read_or_refused([&npz, &name = name] { npz.matrix(name); });
  for (const auto &[name, read] : kReaders)
    if (npz.has(name))
      fuzz::expect_read_or_refused([&path, read = read] { read(path); });
}

#ifdef DOUBLET_LIBFUZZER
#include "archive_mutator.h"
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  return fuzz::mutate_archive(data, size, max_size, seed);
}
#endif
