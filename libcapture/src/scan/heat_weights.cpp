#include "doublet/capture/heat_weights.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/sparse_solve.h"
#include "doublet/rays/ray_scene.h"
#include "face_mask.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace doublet {
namespace {

constexpr double kAlike = 1.1;    // bones up to this much farther than the nearest visible one share a vertex's heat
constexpr double kNearest = 1e-3; // m; closer bones would make H infinite
constexpr double kInvalidFlow =
    1e-3; // conductance of invented triangles: a sheet under a hem must not join the legs with the garment

/// A segment and the joint that carries it.
struct Bone {
  int joint;
  Eigen::Vector3d from, to;

  Eigen::Vector3d closest(const Eigen::Vector3d &point) const {
    const Eigen::Vector3d along = to - from;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0 ? std::clamp(along.dot(point - from) / length2, 0.0, 1.0) : 0.0;
    return from + s * along;
  }
};

/// A joint that turns and has no child (a wrist without a hand) moves what lies beyond it: its bone goes on as the one before
/// it, to the surface.
std::vector<Bone> last_bones(const Skeleton &skeleton, const RayScene &scene) {
  std::vector<char> last(skeleton.joint_count(), 1);
  for (const Joint &joint : skeleton.joints)
    if (joint.parent >= 0)
      last[joint.parent] = 0;
  std::vector<Bone> bones;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint &joint = skeleton.joints[j];
    if (!last[j] || joint.dof_count == 0 || joint.parent < 0)
      continue;
    const Eigen::Vector3d along = (joint.rest - skeleton.joints[joint.parent].rest).stableNormalized();
    if (const std::optional<RayHit> end = scene.cast(joint.rest, along))
      bones.push_back({j, joint.rest, joint.rest + end->distance * along});
  }
  return bones;
}

/// One segment from every joint to each of its children, and those of last_bones(); a lone joint is a bone of length zero.
std::vector<Bone> bones_of(const Skeleton &skeleton, const RayScene &scene) {
  std::vector<Bone> bones = last_bones(skeleton, scene);
  for (const Joint &joint : skeleton.joints)
    if (joint.parent >= 0)
      bones.push_back({joint.parent, skeleton.joints[joint.parent].rest, joint.rest});
  if (bones.empty())
    for (int j = 0; j < skeleton.joint_count(); ++j)
      bones.push_back({j, skeleton.joints[j].rest, skeleton.joints[j].rest});
  return bones;
}

/// Where a vertex gets its heat from.
struct Source {
  std::vector<int> joints; ///< one entry for each bone, may repeat
  double distance = 0;     ///< m, to the nearest of them
};

/// The nearest visible bone and those about as near; without a visible one the nearest. `inside` is the vertex, pulled a little
/// inward.
Source heat_source(const Eigen::Vector3d &inside, const std::vector<Bone> &bones, const RayScene &scene) {
  std::vector<Eigen::Vector3d> point(bones.size());
  std::vector<double> distance(bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b) {
    point[b] = bones[b].closest(inside);
    distance[b] = (point[b] - inside).norm();
  }
  std::vector<int> order(bones.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return distance[a] < distance[b]; });
  Source source;
  for (int b : order) {
    if (!source.joints.empty() && distance[b] > kAlike * source.distance)
      break;
    if (distance[b] > kNearest && scene.occluded(inside, point[b]))
      continue;
    if (source.joints.empty())
      source.distance = distance[b];
    source.joints.push_back(bones[b].joint);
  }
  if (source.joints.empty())
    source = {{bones[order[0]].joint}, distance[order[0]]};
  source.distance = std::max(source.distance, kNearest);
  return source;
}

std::vector<Source> heat_sources(const Mesh &mesh, const Skeleton &skeleton, const Context &context) {
  const RayScene scene(mesh);
  const std::vector<Bone> bones = bones_of(skeleton, scene);
  const Vertices normals = vertex_normals(mesh.vertices, mesh.faces);
  const double inward = 1e-2 * mean_edge_length(mesh.vertices, mesh.faces);
  std::vector<Source> sources(mesh.vertices.rows());
  parallel_for(context, static_cast<int>(sources.size()), [&](int v) {
    sources[v] = heat_source((mesh.vertices.row(v) - inward * normals.row(v)).transpose(), bones, scene);
  });
  return sources;
}

/// Cotangent Laplacian (positive semi-definite) in which invented triangles hardly conduct.
std::vector<Eigen::Triplet<double>> conduction(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](const Faces &faces, double flow) {
    if (faces.rows() > 0)
      for (const Triplet &t : cotangent_laplacian(mesh.vertices, faces))
        entries.emplace_back(t.row, t.col, t.value * flow);
  };
  if (!face_valid.empty()) {
    std::vector<std::uint8_t> invented(face_valid.size());
    std::transform(face_valid.begin(), face_valid.end(), invented.begin(), std::logical_not<>());
    add(valid_faces(mesh.faces, invented), kInvalidFlow);
  }
  add(valid_faces(mesh.faces, face_valid), 1.0);
  return entries;
}

void check_arguments(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const Skeleton &skeleton,
                     const HeatWeightOptions &options) {
  require_usable(mesh, "mesh");
  if (!face_valid.empty())
    detail::expect_mask(face_valid, mesh, "face_valid");
  if (skeleton.joints.empty())
    throw std::invalid_argument("skeleton: expected at least one joint, found none");
  options.validate();
}

} // namespace

// With A the vertex areas: (L_cot + A H) w_j = A H p_j, Baran & Popovic 2007, eq. in Sect. 4 multiplied by A.
MatrixRM heat_weights(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const Skeleton &skeleton,
                      const HeatWeightOptions &options, const Context &context) {
  check_arguments(mesh, face_valid, skeleton, options);
  context.report_progress("template: weights", 0.0);
  const std::vector<Source> sources = heat_sources(mesh, skeleton, context);
  context.report_progress("template: weights", 0.5);
  const Eigen::VectorXd areas = vertex_areas(mesh.vertices, mesh.faces);
  const Eigen::Index count = mesh.vertices.rows();
  auto entries = conduction(mesh, face_valid);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, skeleton.joint_count());
  for (Eigen::Index v = 0; v < count; ++v) {
    const Source &source = sources[v];
    const double bones = static_cast<double>(source.joints.size());
    const double heat = std::max(areas[v], 1e-12) * bones * options.c / (source.distance * source.distance);
    entries.emplace_back(v, v, heat);
    for (int joint : source.joints)
      right(v, joint) += heat / bones;
  }
  MatrixRM weights = solve_symmetric(entries, right, "the heat equilibrium of the mesh's skin weights").cwiseMax(0.0);
  for (Eigen::Index v = 0; v < count; ++v)
    weights.row(v) /= weights.row(v).sum();
  context.report_progress("template: weights", 1.0);
  return weights;
}

} // namespace doublet
