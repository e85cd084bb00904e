#include "first_pose.h"

#include "doublet/core/error.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace doublet {
namespace {

bool centroid(const Image &mask, Eigen::Vector2d &centre) {
  double count = 0;
  centre.setZero();
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask.at(x, y)) {
        centre += Eigen::Vector2d(x, y);
        count += 1;
      }
  centre /= std::max(count, 1.0);
  return count > 0;
}

/// The point closest to the rays through the pixels, in least squares.
struct RayBundle {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  void add(const Camera &camera, const Eigen::Vector2d &pixel) {
    const Eigen::Vector3d d = camera.ray_direction(pixel);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    normal += across;
    right += across * camera.centre();
  }
  Eigen::Vector3d point() const { return normal.ldlt().solve(right); }
};

const Joint &root_joint(const Skeleton &skeleton) {
  for (const Joint &joint : skeleton.joints)
    if (joint.kind == JointKind::Root)
      return joint;
  throw Error("capture: the actor's skeleton has no root with 6 degrees of freedom");
}

} // namespace

Eigen::VectorXd first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Outline> &outlines,
                           const std::vector<Image> &masks, const Context &context) {
  constexpr int kHeadings = 12;
  constexpr int kSize = 256; // px; of the renderings; the overlap of whole silhouettes needs no more
  const Joint &root = root_joint(actor.skeleton);
  const int views = static_cast<int>(rig.size());
  std::vector<Camera> small(views);
  std::vector<Image> measured(views);
  RayBundle rays;
  int used = 0;
  for (int v = 0; v < views; ++v) {
    Eigen::Vector2d centre;
    if (outlines[v].empty() || !centroid(masks[v], centre))
      continue;
    rays.add(rig[v], centre);
    ++used;
    const double scale = std::min(1.0, static_cast<double>(kSize) / std::max(rig[v].width, rig[v].height));
    small[v] =
        rig[v].resized(std::max(1, static_cast<int>(rig[v].width * scale)), std::max(1, static_cast<int>(rig[v].height * scale)));
    measured[v] = Image(small[v].width, small[v].height, 1);
    for (int y = 0; y < small[v].height; ++y)
      for (int x = 0; x < small[v].width; ++x)
        measured[v].at(x, y) = masks[v].at(std::min(masks[v].width - 1, static_cast<int>((x + 0.5) / scale)),
                                           std::min(masks[v].height - 1, static_cast<int>((y + 0.5) / scale)));
  }
  Eigen::VectorXd best = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
  if (used < 2)
    return best; // one ray has no point; the scan's own place is the only guess
  const Eigen::Vector3d target = rays.point();
  double best_score = -1;
  for (int k = 0; k < kHeadings; ++k) {
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
    double angle = 2 * std::numbers::pi * k / kHeadings;
    dofs[root.first_dof + 3] = angle > std::numbers::pi ? angle - 2 * std::numbers::pi : angle;
    double score = 0;
    for (int round = 0; round < 2; ++round) { // centroids of silhouettes and of the body differ; the second round removes that
      const Vertices surface = pose_surface(actor, dofs, {}).vertices;
      std::vector<Eigen::Vector2d> centres(views);
      std::vector<double> overlap(views, -1);
      parallel_for(context, views, [&](int v) {
        if (outlines[v].empty())
          return;
        const Image rendered = silhouette(rasterize(surface, actor.mesh.faces, small[v]));
        if (centroid(rendered, centres[v]))
          overlap[v] = mask_iou(rendered, measured[v]);
      });
      RayBundle bundle;
      int seen = 0;
      score = 0;
      for (int v = 0; v < views; ++v)
        if (overlap[v] >= 0) {
          bundle.add(small[v], centres[v]);
          score += overlap[v];
          ++seen;
        }
      if (round == 0 && seen >= 2)
        dofs.segment<3>(root.first_dof) += target - bundle.point();
    }
    context.check_cancelled();
    // Front and back look alike in silhouettes: leave the scan's heading only for a clear gain.
    if (k == 0 ? true : score > 1.1 * best_score) {
      best_score = score;
      best = dofs;
    }
  }
  return best;
}

} // namespace doublet
