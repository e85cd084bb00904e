#include "doublet/segment/cloth_prior.h"

#include "doublet/core/parts/skeleton_tree.h"
#include "limb_ends.h"
#include "log_odds.h"
#include "surface_patches.h"

#include <algorithm>

namespace doublet {
namespace {

using detail::Surface;

/// (V) in [0, 1]: part of a hand, a foot or the head; rises from the joint to halfway between it and the end.
Eigen::VectorXd extremities(const RiggedMesh &actor, const Surface &surface) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(surface.size());
  for (const detail::LimbEnd &limb : detail::limb_ends(actor)) {
    const Eigen::RowVector3d at = actor.skeleton.joints[limb.mover].rest.transpose();
    const Eigen::VectorXd distance = (actor.mesh.vertices.rowwise() - at).rowwise().norm();
    double end = 0;
    for (int v = 0; v < surface.size(); ++v)
      if (surface.areas[v] > 0 && actor.weights(v, limb.mover) > 0.5)
        end = std::max(end, distance[v]);
    if (end > 0)
      result = result.cwiseMax((actor.weights.col(limb.mover).array() * (2 * distance.array() / end).min(1.0)).matrix());
  }
  return result;
}

/// (V) 1 on pieces of the surface without any of the trunk (what a joint of several children moves most): what comes out under a
/// hem or a cuff. The whole surface if none has any.
Eigen::VectorXd unattached(const RiggedMesh &actor, const Surface &surface) {
  const std::vector<int> children = child_counts(actor.skeleton);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(surface.size());
  bool some_attached = false;
  for (const detail::Patch &piece : connected_patches(surface, choose(surface, [](int) { return true; }))) {
    const bool attached = std::any_of(piece.members.begin(), piece.members.end(), [&](int v) {
      Eigen::Index joint = 0;
      actor.weights.row(v).maxCoeff(&joint);
      return children[joint] > 1;
    });
    some_attached |= attached;
    for (const int v : piece.members)
      result[v] = attached ? 0.0 : 1.0;
  }
  return some_attached ? result : Eigen::VectorXd::Zero(surface.size());
}

/// (V) in [0, 1]: nobody's hands, feet and head hang loose, and a garment hangs from the trunk.
Eigen::VectorXd surely_skin(const RiggedMesh &actor, const char *what) {
  require_actor(actor, what);
  const Surface surface = detail::surface_of(actor.mesh, actor.face_valid);
  return extremities(actor, surface).cwiseMax(unattached(actor, surface));
}

} // namespace

Eigen::VectorXd cloth_prior(const RiggedMesh &actor) {
  return -detail::kSurest * surely_skin(actor, "cloth_prior");
}

Segmentation dressed_all_over(const RiggedMesh &actor) {
  const Eigen::ArrayXd skin = surely_skin(actor, "dressed_all_over").array();
  Segmentation dressed;
  dressed.sigma = Eigen::VectorXd::Zero(skin.size());
  dressed.clothness = (skin < 0.5).cast<double>();
  dressed.region = (skin < 0.5).select(Eigen::VectorXi::Zero(skin.size()).array(), -1);
  dressed.region_count = 1;
  return dressed;
}

} // namespace doublet
