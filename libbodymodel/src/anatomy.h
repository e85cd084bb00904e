#pragma once
// Which bone each point of a body belongs to.

#include "doublet/core/mesh.h"
#include "doublet/core/skeleton.h"
#include "doublet/rays/ray_scene.h"

#include <vector>

namespace doublet {

struct Bone {
  int joint, end;
  bool chosen = false, wrapped = false; ///< of the proxies
};

struct Anatomy {
  std::vector<Bone> bones;
  std::vector<int> nearest; ///< per body vertex
};

/// Every vertex belongs to the nearest bone that it sees through the flesh (Baran & Popovic 2007): with the arms down, a flank is
/// closer to the arm's bone than to the spine.
Anatomy find_bones(const Mesh &body, const Vertices &normals, const RayScene &scene, const Skeleton &skeleton);

} // namespace doublet
