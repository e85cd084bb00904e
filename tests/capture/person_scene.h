#pragma once
// A person with the standard joints, a ring of cameras, and masks of known poses.

#include "doublet/capture/limb_search.h"
#include "support/figure.h"
#include "tracker_scene.h"

namespace person_scene {

using namespace doublet;

constexpr double kDegree = std::numbers::pi / 180;

inline Eigen::VectorXd constant(int size, double value) {
  return Eigen::VectorXd::Constant(size, value);
}

/// A person, 6 cameras and the masks of a known pose.
struct Scene {
  RiggedMesh actor = doublet::testing::figure_actor(0.045);
  CameraRig rig = doublet::testing::camera_ring(6, 256);
  std::vector<Limb> limbs = find_limbs(actor.skeleton);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
  std::vector<Image> masks;
  Context context;

  Scene() { film(); }
  void film() {
    masks.clear();
    const Vertices surface = pose_surface(actor, truth, {}).vertices;
    for (const Camera &camera : rig)
      masks.push_back(silhouette(rasterize(surface, actor.mesh.faces, camera)));
  }
  LimbProblem problem() const {
    return {&actor, &rig, &masks, {}, constant(static_cast<int>(actor.mesh.vertices.rows()), 1), truth};
  }
  int dof(const std::string &name) const {
    const auto &names = actor.skeleton.dof_names;
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  Vertices joints(const Eigen::VectorXd &dofs) const {
    return joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, dofs));
  }
};

/// Masks only: quick to make.
class Masks : public tracker_scene::Frames {
public:
  using tracker_scene::Frames::Frames;
  Image image(int, int) override { return {}; }
};

} // namespace person_scene
