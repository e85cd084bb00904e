#pragma once

#include "doublet/core/camera.h"
#include "doublet/core/image.h"

#include <vector>

namespace doublet {

/// A camera and its measured mask, both made small: whole silhouettes are compared, not their edges.
struct SmallView {
  Camera camera;
  Image mask; ///< 255 = actor; empty = the view takes no part
};

/// One entry a camera, at most `size` pixels wide or high. A view whose mask is empty, or shows no actor, takes no part.
std::vector<SmallView> small_views(const CameraRig &rig, const std::vector<Image> &masks, int size);

} // namespace doublet
