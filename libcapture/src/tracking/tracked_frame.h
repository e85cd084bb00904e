#pragma once
// What the tracker finds at a frame, as a value that a checkpoint keeps.

#include "doublet/capture/performance_capture.h"

#include <array>
#include <cstdint>

namespace doublet {

/// Where the limbs stand after a frame.
struct LimbRecord {
  /// By limb: searches in a row that failed; how many frames from the start the next one is.
  std::vector<int> misses, next_search;
  std::vector<int> steady_since; ///< (D) so many frames from the start a degree of freedom last jumped
};

/// All that the tracker finds at one frame of a pass. What it knows at a frame follows from these values of the frames before and
/// from their images, and from nothing else.
struct TrackedFrame {
  int frame = 0;                                  ///< index; that of the first one tracked is the start
  bool searched = false;                          ///< the start, and not in the scan's pose
  std::uint64_t images = 0;                       ///< fingerprint of all images and masks; first pass, else 0
  std::vector<std::vector<FeatureMatch>> matches; ///< [cameras], to the frame before; first pass, else empty
  std::vector<SurfaceTrack> mapped;               ///< features that the map has found; first pass, else empty
  Eigen::VectorXd dofs;                           ///< (D)
  Vertices surface;                               ///< (V, 3) m, refined
  double rim_px = 0, sift_px = 0;                 ///< mean residuals, pixels
  LimbRecord limbs;
  std::vector<LostLimb> lost;
  /// Since the start, earlier runs included: measuring, map, poses, limbs, surfaces (as in CaptureSummary), everything.
  std::array<double, 6> seconds{};
};

std::string to_bytes(const TrackedFrame &frame);
/// Throws Error unless these are the bytes of one.
TrackedFrame from_bytes(const std::string &bytes);

/// Could the tracker have found this? Sizes, indices and finite numbers: `limbs` = find_limbs() of the actor.
bool fits(const TrackedFrame &frame, const RiggedMesh &actor, std::size_t cameras, std::size_t limbs, bool first_pass);

} // namespace doublet
