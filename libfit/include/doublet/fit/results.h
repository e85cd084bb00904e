#pragma once
// What the stages have written into a folder, read when it is asked for, and what a material is estimated from.

#include "doublet/core/garment.h"
#include "doublet/core/stage_values.h"
#include "doublet/files/files.h"
#include "doublet/fit/material_estimator.h"

#include <optional>
#include <string>
#include <vector>

namespace doublet {

/// What material and width are estimated from: a film, and a garment in several widths. Owns what take() points to.
struct FilmedTake {
  std::vector<CharacterSimulator> widths;
  ReferencePerformance performance;
  Observations observations;
  double dt = 0; ///< s, one video frame
  Take take() const;
};

/// The values of a folder of results (docs/formats.md). What is kept in memory is what was read from a file, not what was written
/// to it, so that a resumed run goes on with the same bits. All throw as the readers of files.h do. Not thread-safe.
class Results {
public:
  explicit Results(Path folder) : out_(std::move(folder)) {}
  Path path(const std::string &name) const { return out_ / name; }
  /// To be called after files were written. Reconstruction::run() begins with it.
  void forget();
  /// The garment at these positions among its widths (see choose_widths), until forget(), whatever material.json says.
  void set_widths(const std::vector<double> &positions);

  const RiggedMesh &actor(); ///< kept
  ReferencePerformance performance();
  Observations observations() const;
  Segmentation segmentation() const;
  BodyFit body() const;
  std::vector<TaperedCapsule> proxies();
  const Garment &offered_garment(); ///< kept; as the mesher made it, in several widths to choose from
  const Garment &garment();         ///< kept; in the width that was estimated with the material, or else in the middle one
  const DressedActor &dressed();    ///< kept; what is simulated: the actor in garment()
  ReferencePerformance dressed_performance(); ///< whatever the width: it is on the garment's mesh, which is that of all
  CharacterSimulator simulator(const pbd::ClothOptions &cloth); ///< of dressed()
  /// `garments`: one a width; none = in all that garment.npz offers.
  FilmedTake take(const SolverSettings &solver, const std::vector<Garment> &garments = {});

private:
  Path out_;
  std::optional<RiggedMesh> actor_;
  std::optional<Garment> offered_garment_, garment_;
  std::optional<DressedActor> dressed_;
};

} // namespace doublet
