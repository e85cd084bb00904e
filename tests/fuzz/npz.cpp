// Archives between stages, and body models: an archive is given to every reader of one.
#include "doublet/files/npz.h"
#include "doublet/bodymodel/body_model.h"
#include "doublet/fit/material_estimator.h"
#include "harness.h"

namespace {

using namespace doublet;

/// What the corpus' performance and garment belong to.
const RiggedMesh &person() {
  static const RiggedMesh actor = read_actor(Path(DOUBLET_FUZZ_CORPUS) / "npz" / "actor.npz");
  return actor;
}

} // namespace

DOUBLET_HARNESS(npz) {
  const Path path = fuzz::put("arrays.npz", input);
  const auto attempt = [&](auto read) { fuzz::expect_read_or_refused([&] { read(path); }); };
  attempt([](const Path &p) {
    const Npz npz = Npz::read(p);
    for (const auto &[name, array] : npz.arrays)
      fuzz::expect_read_or_refused([&npz, &name = name] { npz.matrix(name); });
  });
  attempt([](const Path &p) { read_actor(p); });
  attempt([](const Path &p) { read_performance(p, person()); });
  attempt([](const Path &p) { read_segmentation(p); });
  attempt([](const Path &p) { read_garment(p, person()); });
  attempt([](const Path &p) { read_body(p); });
  attempt([](const Path &p) { read_observations(p); });
  attempt([](const Path &p) { read_simulated(p); });
  attempt([](const Path &p) { BodyModel::read(p); });
}

#ifdef DOUBLET_LIBFUZZER
#include "archive_mutator.h"
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  return fuzz::mutate_archive(data, size, max_size, seed);
}
#endif
