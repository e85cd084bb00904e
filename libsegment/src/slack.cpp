#include "doublet/segment/slack.h"

#include "doublet/core/parts/quantile.h"
#include "doublet/core/stage_values.h"
#include "doublet/rays/ray_scene.h"

#include <stdexcept>

namespace doublet {

namespace {

constexpr double kShare = 0.95; // of the frames; the others are lost tracking and extreme bends

/// m from the body to a point outside it, 0 inside. `normals` (B, 3) of the body's vertices.
double distance_outside(const RayScene &scene, const Mesh &body, const Vertices &normals, const Eigen::Vector3d &point) {
  const ClosestPoint at = scene.closest(point);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    normal += at.barycentric[k] * normals.row(body.faces(at.face, k)).transpose();
  return normal.dot(point - at.point) > 0 ? at.distance : 0.0;
}

} // namespace

Eigen::VectorXd cloth_slack(const Mesh &body, const std::vector<Vertices> &canonical, const Context &context) {
  if (canonical.empty())
    throw std::invalid_argument("cloth_slack: expected at least one canonical frame, found none");
  const int count = static_cast<int>(canonical[0].rows());
  require_frames(canonical, count, "cloth_slack: a canonical frame");
  require_usable(body, "cloth_slack: body");
  const RayScene scene(body);
  const Vertices normals = vertex_normals(body.vertices, body.faces);
  MatrixRM distances(count, static_cast<Eigen::Index>(canonical.size()));
  for (Eigen::Index t = 0; t < distances.cols(); ++t) {
    context.throw_if_cancelled();
    parallel_for(context, count, [&](int v) { distances(v, t) = distance_outside(scene, body, normals, canonical[t].row(v)); });
  }
  Eigen::VectorXd slack(count);
  for (int v = 0; v < count; ++v)
    slack[v] = quantile({distances.row(v).begin(), distances.row(v).end()}, kShare);
  return slack;
}

} // namespace doublet
