#include "first_pose.h"

#include "calibration/ray_bundle.h"
#include "doublet/core/error.h"
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

/// The scan pose at one place and heading after another, against the masks.
class Placement {
public:
  /// `size` px: of the small views; `rounds` of moving the rendering to where the masks are.
  Placement(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks, int size, int rounds,
            const Context &context)
      : actor_(actor), context_(context), root_(root_joint(actor.skeleton)), rounds_(rounds),
        views_(small_views(rig, masks, size)), centres_(views_.size()) {
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
    double overlap = 0;
    for (int round = 0; round <= rounds_; ++round) {
      detail::RayBundle wanted, got;
      overlap = compare(dofs, wanted, got);
      if (got.rays >= 2 && round < rounds_)
        dofs.segment<3>(root_.first_dof) += wanted.point() - got.point();
    }
    return overlap;
  }

private:
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
  const int rounds_;
  std::vector<SmallView> views_;
  std::vector<Eigen::Vector2d> centres_; // of the masks
  detail::RayBundle rays_;
};

/// Step k of `headings` around the vertical, the scan's own first, then those beside it: 0, 1, -1, 2, -2, ...
int heading_step(int k) {
  return k % 2 ? (k + 1) / 2 : -k / 2;
}

PlacedPose best_place(const Placement &placement, const RiggedMesh &actor, int headings, const Context &context) {
  constexpr double kClearlyBetter = 1.1; // for the half where front and back are exchanged
  PlacedPose best{Eigen::VectorXd::Zero(actor.skeleton.dof_count()), 0};
  if (placement.views() < 2)
    return best;
  double best_score = 0;
  for (int k = 0; k < headings; ++k) {
    const int step = heading_step(k);
    PlacedPose placed{placement.facing(2 * std::numbers::pi * step / headings), 0};
    placed.overlap = placement.settle(placed.dofs);
    const double score = placed.overlap / (4 * std::abs(step) > headings ? kClearlyBetter : 1);
    if (score > best_score) {
      best_score = score;
      best = placed;
    }
    context.throw_if_cancelled();
  }
  return best;
}

constexpr int kSize = 192; // px; the overlap of whole silhouettes needs no more
constexpr int kRounds = 4;

} // namespace

const Joint &root_joint(const Skeleton &skeleton) {
  for (const Joint &joint : skeleton.joints)
    if (joint.kind == JointKind::Root)
      return joint;
  throw Error("capture: the actor's skeleton has no root with 6 degrees of freedom");
}

PlacedPose first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks, const Context &context) {
  constexpr int kHeadings = 24; // 15 degrees apart; the local optimisation turns three times as far
  return best_place(Placement(actor, rig, masks, kSize, kRounds, context), actor, kHeadings, context);
}

PlacedPose rough_first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                            const Context &context) {
  return best_place(Placement(actor, rig, masks, kSize / 2, 1, context), actor, 12, context);
}

std::vector<PlacedPose> placed_all_around(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                                          int headings, const Context &context) {
  const Placement placement(actor, rig, masks, kSize, kRounds, context);
  std::vector<PlacedPose> placed;
  for (int k = 0; placement.views() >= 2 && k < headings; ++k) {
    placed.push_back({placement.facing(2 * std::numbers::pi * heading_step(k) / headings), 0});
    placed.back().overlap = placement.settle(placed.back().dofs);
    context.throw_if_cancelled();
  }
  return placed;
}

} // namespace doublet
