#include "first_pose.h"

#include "doublet/core/error.h"
#include "ray_bundle.h"
#include "small_view.h"

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

const Joint &root_joint(const Skeleton &skeleton) {
  for (const Joint &joint : skeleton.joints)
    if (joint.kind == JointKind::Root)
      return joint;
  throw Error("capture: the actor's skeleton has no root with 6 degrees of freedom");
}

/// The scan pose at one place and heading after another, against the masks.
class Placement {
public:
  Placement(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks, const Context &context)
      : actor_(actor), context_(context), root_(root_joint(actor.skeleton)), views_(small_views(rig, masks, kSize)),
        centres_(views_.size()) {
    for (size_t v = 0; v < views_.size(); ++v)
      if (centroid(views_[v].mask, centres_[v]))
        rays_.add(views_[v].camera, centres_[v]);
  }

  int views() const { return rays_.rays; }

  Eigen::VectorXd facing(double heading) const {
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(actor_.skeleton.dof_count());
    dofs[root_.first_dof + 3] = heading;
    const Vertices turned = pose_surface(actor_, dofs, {}).vertices;
    dofs.segment<3>(root_.first_dof) = rays_.point() - turned.colwise().mean().transpose();
    return dofs;
  }

  /// Moves `dofs` until the centroids meet and returns the overlap there, mean over the views. Where the image cuts the actor, it
  /// cuts the rendering, too, so that a few rounds also get those right.
  double settle(Eigen::VectorXd &dofs) const {
    constexpr int kRounds = 4;
    double overlap = 0;
    for (int round = 0; round <= kRounds; ++round) {
      detail::RayBundle wanted, got;
      overlap = compare(dofs, wanted, got);
      if (got.rays >= 2 && round < kRounds)
        dofs.segment<3>(root_.first_dof) += wanted.point() - got.point();
    }
    return overlap;
  }

private:
  static constexpr int kSize = 192; // px; the overlap of whole silhouettes needs no more

  double compare(const Eigen::VectorXd &dofs, detail::RayBundle &wanted, detail::RayBundle &got) const {
    const Vertices surface = pose_surface(actor_, dofs, {}).vertices;
    std::vector<Eigen::Vector2d> centres(views_.size());
    std::vector<double> overlap(views_.size(), 0);
    std::vector<std::uint8_t> seen(views_.size(), 0);
    parallel_for(context_, static_cast<int>(views_.size()), [&](int v) {
      if (views_[v].mask.empty())
        return;
      const Image rendered = silhouette(rasterize(surface, actor_.mesh.faces, views_[v].camera, actor_.face_valid));
      seen[v] = centroid(rendered, centres[v]);
      overlap[v] = mask_iou(rendered, views_[v].mask);
    });
    double sum = 0;
    for (size_t v = 0; v < views_.size(); ++v) {
      sum += overlap[v];
      if (seen[v]) {
        wanted.add(views_[v].camera, centres_[v]);
        got.add(views_[v].camera, centres[v]);
      }
    }
    return sum / rays_.rays;
  }

  const RiggedMesh &actor_;
  const Context &context_;
  const Joint &root_;
  std::vector<SmallView> views_;
  std::vector<Eigen::Vector2d> centres_; // of the masks
  detail::RayBundle rays_;
};

} // namespace

Eigen::VectorXd first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                           const Context &context) {
  constexpr int kHeadings = 24;          // 15 degrees apart; the local optimisation turns three times as far
  constexpr double kClearlyBetter = 1.1; // for the half where front and back are exchanged
  const Placement placement(actor, rig, masks, context);
  Eigen::VectorXd best = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
  if (placement.views() < 2)
    return best;
  double best_score = 0;
  for (int k = 0; k < kHeadings; ++k) {
    const int step = k % 2 ? (k + 1) / 2 : -k / 2; // 0, 1, -1, 2, -2, ...: the scan's own first
    const double heading = 2 * std::numbers::pi * step / kHeadings;
    Eigen::VectorXd dofs = placement.facing(heading);
    const double score = placement.settle(dofs) / (4 * std::abs(step) > kHeadings ? kClearlyBetter : 1);
    if (score > best_score) {
      best_score = score;
      best = dofs;
    }
    context.check_cancelled();
  }
  return best;
}

} // namespace doublet
