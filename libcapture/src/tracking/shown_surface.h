#pragma once
// A surface as cameras show it that film between the frames of the others.

#include "doublet/capture/pose_optimizer.h"

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

} // namespace doublet::detail
