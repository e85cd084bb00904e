// RayScene::closest() without Embree, which has no WebAssembly: the display surface is bound to the coarse one by closest points.
// Rays are cast where characters are made, not where they are played: what would cast one does not link.

#include "doublet/core/parts/moving_surface.h"
#include "doublet/rays/ray_scene.h"

#include <limits>

namespace doublet {

struct RayScene::Impl {
  MovingSurface surface;
};

RayScene::RayScene(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid)
    : impl_(std::make_shared<const Impl>(Impl{MovingSurface(mesh, face_valid)})) {}

ClosestPoint RayScene::closest(const Eigen::Vector3d &point) const {
  const auto at = impl_->surface.closest(point, std::numeric_limits<double>::infinity());
  return {at->face, at->point, at->barycentric, at->distance};
}

} // namespace doublet
