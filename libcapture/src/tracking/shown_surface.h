#pragma once
// A surface as cameras show it that film between the frames of the others, and what they are seen to show of it.

#include "doublet/capture/pose_optimizer.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::detail {

/// Refers to the surface, (V, 3) m.
class ShownSurface {
public:
  ShownSurface(const Vertices &surface, const ViewTiming &timing) : surface_(surface) {
    for (const double late : timing.late)
      moved_.emplace_back(surface - late * timing.velocity);
  }
  /// (V, 3) m, of a camera.
  const Vertices &in(int view) const { return moved_.empty() ? surface_ : moved_[static_cast<std::size_t>(view)]; }

private:
  const Vertices &surface_;
  std::vector<Vertices> moved_; // [views], or none
};

/// Throws std::invalid_argument unless every track is of one of the views and on one of the faces.
inline void require_tracks(const std::vector<SurfaceTrack> &tracks, std::size_t views, const Faces &faces,
                           const std::string &who) {
  for (const SurfaceTrack &track : tracks)
    if (track.view < 0 || static_cast<std::size_t>(track.view) >= views || track.surface.face < 0 ||
        track.surface.face >= faces.rows())
      throw std::invalid_argument(who + ": a track must be of one of the views and on one of the faces");
}

} // namespace doublet::detail
