#include "doublet/capture/rest_pose.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/sparse_solve.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

/// (V) radians, mean by skin weight of the angles between the joints of a vertex and its heaviest one.
Eigen::VectorXd bends_of(const RiggedMesh &actor, const Eigen::VectorXd &dofs) {
  const Transforms world_from_rest = forward_kinematics(actor.skeleton, dofs);
  const int joints = actor.skeleton.joint_count();
  MatrixRM angles(joints, joints);
  for (int i = 0; i < joints; ++i)
    for (int j = 0; j < joints; ++j)
      angles(i, j) = Eigen::AngleAxisd(world_from_rest[i].linear().transpose() * world_from_rest[j].linear()).angle();
  Eigen::VectorXd bends(actor.weights.rows());
  for (Eigen::Index v = 0; v < bends.size(); ++v) {
    Eigen::Index heaviest = 0;
    actor.weights.row(v).maxCoeff(&heaviest);
    bends[v] = actor.weights.row(v).dot(angles.row(heaviest));
  }
  return bends;
}

std::vector<std::uint8_t> on_valid_faces(const RiggedMesh &actor) {
  std::vector<std::uint8_t> on(actor.mesh.vertices.rows(), 0);
  for (Eigen::Index f = 0; f < actor.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3 && actor.face_valid[f]; ++k)
      on[actor.mesh.faces(f, k)] = 1;
  return on;
}

/// Of the points' coordinates, each by itself.
Eigen::RowVector3d median_of(std::vector<Eigen::RowVector3d> points) {
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  Eigen::RowVector3d median;
  for (int k = 0; k < 3; ++k) {
    std::nth_element(points.begin(), middle, points.end(), [&](const auto &a, const auto &b) { return a[k] < b[k]; });
    median[k] = (*middle)[k];
  }
  return median;
}

/// Where the least bent frames have the vertex; false if all are bent too much.
bool seen_at(int v, const std::vector<Vertices> &frames, const MatrixRM &bends, const RestPoseOptions &options,
             Eigen::RowVector3d &at) {
  std::vector<std::pair<double, int>> least;
  for (int t = 0; t < static_cast<int>(frames.size()); ++t)
    if (bends(t, v) <= options.max_bend)
      least.emplace_back(bends(t, v), t);
  const auto count = std::min<std::size_t>(options.frames, least.size());
  if (count == 0)
    return false;
  std::partial_sort(least.begin(), least.begin() + static_cast<std::ptrdiff_t>(count), least.end());
  std::vector<Eigen::RowVector3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(frames[least[i].second].row(v));
  at = median_of(std::move(points));
  return true;
}

} // namespace

Vertices refine_rest_pose(const RiggedMesh &actor, const ReferencePerformance &performance,
                          const std::vector<std::uint8_t> &rigid, const RestPoseOptions &options, const Context &context) {
  options.validate();
  require_actor(actor, "refine_rest_pose");
  require_performance(performance, actor, "refine_rest_pose");
  const Vertices &rest = actor.mesh.vertices;
  if (static_cast<Eigen::Index>(rigid.size()) != rest.rows())
    throw std::invalid_argument("refine_rest_pose: expected " + std::to_string(rest.rows()) + " entries in rigid, found " +
                                std::to_string(rigid.size()));
  const std::vector<Vertices> frames = canonical_frames(actor, performance, context);
  MatrixRM bends(static_cast<Eigen::Index>(frames.size()), rest.rows());
  for (Eigen::Index t = 0; t < bends.rows(); ++t)
    bends.row(t) = bends_of(actor, performance.dofs.row(t)).transpose();

  // The membrane: the Laplacian's energy, and squares of the distance to what is seen, or of the correction in cloth.
  const std::vector<std::uint8_t> valid = on_valid_faces(actor);
  const Eigen::VectorXd areas = vertex_areas(rest, actor.mesh.faces);
  const double seen_weight = 1 / (options.smoothing * options.smoothing),
               cloth_weight = 1 / (options.fade_distance * options.fade_distance);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Triplet &t : cotangent_laplacian(rest, actor.mesh.faces))
    entries.emplace_back(t.row, t.col, t.value);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rest.rows(), 3);
  bool any_seen = false;
  for (int v = 0; v < static_cast<int>(rest.rows()); ++v) {
    constexpr double kLeast = 1e-9; // m^2; pieces of which nothing is known stay
    double weight = kLeast;
    Eigen::RowVector3d at;
    if (!rigid[v])
      weight += cloth_weight * areas[v];
    else if (valid[v] && seen_at(v, frames, bends, options, at)) {
      any_seen = true;
      weight += seen_weight * areas[v];
      right.row(v) = seen_weight * areas[v] * (at - rest.row(v));
    }
    entries.emplace_back(v, v, weight);
  }
  if (!any_seen)
    throw Error("refine_rest_pose: expected skin on valid faces that some of " + std::to_string(frames.size()) +
                " frames show bent by less than " + options::to_text(options.max_bend) + " rad, found none");
  return rest + solve_symmetric(entries, right, "the membrane of the rest pose's correction");
}

} // namespace doublet
