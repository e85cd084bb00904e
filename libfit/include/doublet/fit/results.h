#pragma once
// The results of the stages in a folder, read on demand, and the inputs of the material estimation.

#include "doublet/core/garment.h"
#include "doublet/core/stage_values.h"
#include "doublet/files/files.h"
#include "doublet/fit/material_estimator.h"

#include <optional>
#include <string>
#include <vector>

namespace doublet {

/// The inputs from which material and width are estimated: a captured performance, and a garment in several widths. Owns what
/// take() points to.
struct FilmedTake {
  std::vector<CharacterSimulator> widths;
  ReferencePerformance performance;
  Observations observations;
  double dt = 0; ///< s, one video frame
  Take take() const;
};

/// The results in a folder (docs/formats.md). Cached values are always read from files, never those that were written, so that a
/// resumed run continues with the same bits. All methods throw as the readers of files.h. Not thread-safe.
class Results {
public:
  explicit Results(Path folder) : out_(std::move(folder)) {}
  Path path(const std::string &name) const { return out_ / name; }
  /// Clears the cache; call it after files were written. Reconstruction::run() begins with it.
  void forget();
  /// Sets the garment's widths to these positions (see choose_widths) until forget(), overriding material.json.
  void set_widths(const std::vector<double> &positions);

  const RiggedMesh &actor(); ///< cached
  ReferencePerformance performance();
  Observations observations() const;
  Segmentation segmentation() const;
  BodyFit body() const;
  std::vector<TaperedCapsule> proxies();
  const Garment &offered_garment(); ///< cached; from the mesher, with all widths to choose from
  const Garment &garment();         ///< cached; in the width that was estimated with the material, or else in the middle one
  const DressedActor &dressed();    ///< cached; the simulated character: the actor in garment()
  ReferencePerformance dressed_performance();                   ///< on the garment's mesh, which is the same for all widths
  CharacterSimulator simulator(const pbd::ClothOptions &cloth); ///< of dressed()
  /// `garments`: one per width; empty = all widths in garment.npz.
  FilmedTake take(const SolverSettings &solver, const std::vector<Garment> &garments = {});

private:
  Path out_;
  std::optional<RiggedMesh> actor_;
  std::optional<Garment> offered_garment_, garment_;
  std::optional<DressedActor> dressed_;
};

} // namespace doublet
