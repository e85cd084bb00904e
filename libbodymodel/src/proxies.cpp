// Tapered capsules for the fitted body: Levenberg-Marquardt on signed distances, all capsules together.
#include "doublet/bodymodel/proxies.h"
#include "doublet/bodymodel/body_fitter.h"

#include "anatomy.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/core/parts/skeleton_tree.h"
#include "doublet/rays/ray_scene.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace doublet {
namespace {

constexpr int kParameters = 8;           ///< p0, p1, r0, r1
constexpr double kBulgeWeight = 4;       ///< of a capsule outside the body against one inside
constexpr double kClothWeight = 40;      ///< of a capsule in the resting cloth
constexpr double kUncoveredWeight = 0.3; ///< of body surface that cloth does not cover in the scan pose
constexpr double kCoveredShare = 0.1;    ///< a bone with more of its body surface under cloth gets capsules
constexpr double kWrappedShare = 0.33;   ///< cloth that wraps more than this of a bone swings against the next one, too
constexpr double kTether = 1e-3; ///< m^2, pull of a capsule's ends to where they started: it must not wander along the chain
constexpr double kSmallestRadius = 0.01; ///< m
constexpr int kMostLanes = 3;            ///< side by side in a hand
constexpr double kRound = 0.3;           ///< what is so little wider than thick is round
constexpr double kDeepest = 0.01;        ///< m, cloth further inside the fitted body does not rest on it

/// Covered bones, and the next ones down the chain of wrapped bones where cloth that hangs can swing against them: those that
/// lead downwards and do not end in nothing (hands, feet).
void choose_bones(Anatomy &anatomy, const Skeleton &skeleton, const std::vector<std::uint8_t> &under,
                  const Eigen::VectorXd &areas) {
  std::vector<double> all(anatomy.bones.size(), 0), covered(anatomy.bones.size(), 0);
  for (std::size_t v = 0; v < under.size(); ++v)
    if (anatomy.nearest[v] >= 0) {
      all[anatomy.nearest[v]] += areas[v];
      covered[anatomy.nearest[v]] += under[v] ? areas[v] : 0;
    }
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    anatomy.bones[b].chosen = all[b] > 0 && covered[b] > kCoveredShare * all[b];
    anatomy.bones[b].wrapped = all[b] > 0 && covered[b] > kWrappedShare * all[b];
  }
  for (Bone &bone : anatomy.bones)
    for (const Bone &above : anatomy.bones)
      if (above.wrapped && above.end == bone.joint && !skeleton.is_leaf(bone.end) &&
          skeleton.joints[bone.end].rest.y() < skeleton.joints[bone.joint].rest.y())
        bone.chosen = true;
}

/// Where the limb that a bone belongs to leaves the trunk: the first joint of its chain. -1 for bones of the trunk. children:
/// of the skeleton, child_counts().
int limb_root(const Skeleton &skeleton, const std::vector<int> &children, const Bone &bone) {
  int end = bone.joint;
  while (children[end] == 1)
    end = first_child(skeleton, end);
  if (children[end] != 0)
    return -1;
  int root = bone.joint;
  while (skeleton.joints[root].parent >= 0 && children[skeleton.joints[root].parent] == 1)
    root = skeleton.joints[root].parent;
  return root;
}

/// Length of the chain from `root` down to `end`.
double chain_length(const Skeleton &skeleton, int root, int end) {
  double length = 0;
  for (int j = end; j != root; j = skeleton.joints[j].parent)
    length += (skeleton.joints[j].rest - skeleton.joints[skeleton.joints[j].parent].rest).norm();
  return length;
}

/// m, from where cloth hangs to its farthest point; 0 where nothing hangs.
double cloth_length(const RiggedMesh &actor, const Segmentation &segmentation) {
  const Vertices &vertices = actor.mesh.vertices;
  const Eigen::VectorXd &clothness = segmentation.clothness;
  std::vector<int> attached;
  for (int f = 0; f < actor.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3 && actor.face_valid[f]; ++k) {
      const Eigen::RowVector3i corners = actor.mesh.faces.row(f);
      if (clothness[corners[k]] == 0 && std::any_of(corners.begin(), corners.end(), [&](int v) { return clothness[v] > 0; }))
        attached.push_back(corners[k]);
    }
  double longest = 0;
  for (Eigen::Index v = 0; v < vertices.rows() && !attached.empty(); ++v) {
    if (!(clothness[v] > 0))
      continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (int a : attached)
      nearest = std::min(nearest, (vertices.row(v) - vertices.row(a)).norm());
    longest = std::max(longest, nearest);
  }
  return longest;
}

/// The other bones of limbs that are long enough to touch cloth with: arms and hands that hang or swing beside a skirt.
std::vector<std::uint8_t> reaching_bones(const Anatomy &anatomy, const RiggedMesh &actor, const Segmentation &segmentation) {
  const Skeleton &skeleton = actor.skeleton;
  const std::vector<int> children = child_counts(skeleton);
  std::vector<std::uint8_t> reaching(anatomy.bones.size(), 0);
  const double length = cloth_length(actor, segmentation);
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    const Bone &bone = anatomy.bones[b];
    const int root = limb_root(skeleton, children, bone);
    if (bone.chosen)
      continue;
    const Eigen::Vector3d &from = skeleton.joints[root < 0 ? bone.joint : root].rest;
    const double reach = root < 0 ? length : chain_length(skeleton, root, bone.end);
    for (Eigen::Index v = 0; v < actor.mesh.vertices.rows() && !reaching[b]; ++v)
      reaching[b] = segmentation.clothness[v] > 0 && (actor.mesh.vertices.row(v).transpose() - from).norm() < reach;
  }
  return reaching;
}

struct Capsules {
  std::vector<Capsule> shape;
  std::vector<int> joint;
};

double &parameter(Capsule &c, int k) {
  return k < 3 ? c.p0[k] : k < 6 ? c.p1[k - 3] : k == 6 ? c.r0 : c.r1;
}

std::vector<int> bone_vertices(const Anatomy &anatomy, int bone) {
  std::vector<int> members;
  for (std::size_t v = 0; v < anatomy.nearest.size(); ++v)
    if (anatomy.nearest[v] == bone)
      members.push_back(static_cast<int>(v));
  return members;
}

Eigen::Vector3d centroid(const Mesh &body, const std::vector<int> &members) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int v : members)
    sum += body.vertices.row(v).transpose();
  return sum / static_cast<double>(members.size());
}

/// A limb: capsules end to end, their spheres at the centroids of slices of the body.
void start_limb(const Mesh &body, const std::vector<int> &members, const Eigen::Vector3d &a, const Eigen::Vector3d &b, int count,
                std::vector<Capsule> &out) {
  const Eigen::Vector3d axis = b - a;
  std::vector<std::vector<int>> slices(count + 1);
  for (int v : members) {
    const double t = (body.vertices.row(v).transpose() - a).dot(axis) / axis.squaredNorm();
    slices[std::clamp(static_cast<int>(std::lround(t * count)), 0, count)].push_back(v);
  }
  std::vector<Eigen::Vector3d> centre(count + 1);
  std::vector<double> radius(count + 1, kSmallestRadius);
  for (int s = 0; s <= count; ++s) {
    centre[s] = slices[s].empty() ? Eigen::Vector3d(a + axis * s / count) : centroid(body, slices[s]);
    double sum = 0;
    for (int v : slices[s])
      sum += (body.vertices.row(v).transpose() - centre[s]).norm() / slices[s].size();
    radius[s] = std::max(0.8 * sum, kSmallestRadius);
  }
  for (int s = 0; s < count; ++s)
    out.push_back({centre[s], centre[s + 1], radius[s], radius[s + 1]});
}

/// k-means of surface points, started at mutually farthest ones.
std::vector<std::vector<int>> clusters(const Mesh &body, const std::vector<int> &members, int count) {
  std::vector<Eigen::Vector3d> centres{centroid(body, members)};
  auto nearest = [&](int v) {
    int best = 0;
    for (std::size_t c = 1; c < centres.size(); ++c)
      if ((body.vertices.row(v).transpose() - centres[c]).norm() < (body.vertices.row(v).transpose() - centres[best]).norm())
        best = static_cast<int>(c);
    return best;
  };
  for (int c = 0; c < count; ++c) {
    const int farthest = *std::max_element(members.begin(), members.end(), [&](int p, int q) {
      return (body.vertices.row(p).transpose() - centres[nearest(p)]).norm() <
             (body.vertices.row(q).transpose() - centres[nearest(q)]).norm();
    });
    centres.push_back(body.vertices.row(farthest).transpose());
  }
  centres.erase(centres.begin());
  std::vector<std::vector<int>> groups;
  for (int iteration = 0; iteration < 10; ++iteration) {
    groups.assign(count, {});
    for (int v : members)
      groups[nearest(v)].push_back(v);
    for (int c = 0; c < count; ++c)
      if (!groups[c].empty())
        centres[c] = centroid(body, groups[c]);
  }
  return groups;
}

/// Algebraic least-squares sphere: |x|^2 = 2 c.x + (r^2 - |c|^2), about the centroid.
void start_sphere(const Mesh &body, const std::vector<int> &members, const Eigen::Vector3d &along, std::vector<Capsule> &out) {
  const Eigen::Vector3d middle = centroid(body, members);
  Eigen::Matrix4d matrix = 1e-9 * Eigen::Matrix4d::Identity();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (int v : members) {
    const Eigen::Vector3d x = body.vertices.row(v).transpose() - middle;
    const Eigen::Vector4d row(2 * x.x(), 2 * x.y(), 2 * x.z(), 1);
    matrix += row * row.transpose();
    right += row * x.squaredNorm();
  }
  const Eigen::Vector4d solution = matrix.ldlt().solve(right);
  const double radius = std::sqrt(std::max(solution[3] + solution.head<3>().squaredNorm(), 0.0));
  // A flat patch gives a huge sphere: then stand one spread of the points behind it.
  const double bounded = std::clamp(radius, 0.02, 0.12);
  const Eigen::Vector3d centre = middle + solution.head<3>() * std::min(1.0, bounded / std::max(radius, 1e-9));
  const double r = 0.8 * bounded;
  out.push_back({centre - 0.3 * r * along, centre + 0.3 * r * along, r, r});
}

/// Hands and feet are flat: limbs side by side across the widest direction, as many as they are times as wide as thick, or one
/// more.
void start_flat_limb(const Mesh &body, const std::vector<int> &members, const Eigen::Vector3d &a, const Eigen::Vector3d &b,
                     int count, std::vector<Capsule> &out) {
  const Eigen::Vector3d along = (b - a).normalized(), middle = centroid(body, members);
  const auto across = [&](int v) {
    const Eigen::Vector3d from = body.vertices.row(v).transpose() - middle;
    return Eigen::Vector3d(from - from.dot(along) * along);
  };
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int v : members)
    spread += across(v) * across(v).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread); // ascending, the first of them along
  const double flat = std::sqrt(axes.eigenvalues()[2] / std::max(axes.eigenvalues()[1], 1e-12));
  const std::size_t lanes = std::clamp(static_cast<int>(std::ceil(flat - kRound)), 1, kMostLanes);
  std::vector<int> order = members;
  std::sort(order.begin(), order.end(),
            [&](int p, int q) { return across(p).dot(axes.eigenvectors().col(2)) < across(q).dot(axes.eigenvectors().col(2)); });
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto at = [&](std::size_t l) { return order.begin() + static_cast<std::ptrdiff_t>(l * order.size() / lanes); };
    const std::vector<int> part(at(lane), at(lane + 1));
    if (part.empty())
      continue;
    const Eigen::Vector3d beside = centroid(body, part) - middle, aside = beside - beside.dot(along) * along;
    start_limb(body, part, a + aside, b + aside, count, out);
  }
}

/// Limbs are sliced; bones shorter than the flesh around them is thick (pelvis to hip) get one capsule more, by clusters; the
/// ends of limbs are flat.
void start_capsules(const Mesh &body, const Anatomy &anatomy, int bone, const Skeleton &skeleton, int count, Capsules &out) {
  const Eigen::Vector3d a = skeleton.joints[anatomy.bones[bone].joint].rest, b = skeleton.joints[anatomy.bones[bone].end].rest;
  const std::vector<int> members = bone_vertices(anatomy, bone);
  double thickness = 0;
  for (int v : members)
    thickness += (body.vertices.row(v).transpose() - closest_on_segment(body.vertices.row(v), a, b)).norm() / members.size();
  const bool flat = skeleton.is_leaf(anatomy.bones[bone].end);
  const bool stub = (b - a).norm()<1.5 * thickness &&static_cast<int>(members.size())> 20 * (count + 1);
  if (flat) {
    start_flat_limb(body, members, a, b, count, out.shape);
  } else if (stub) {
    for (const std::vector<int> &group : clusters(body, members, count + 1))
      if (group.size() > 4)
        start_sphere(body, group, Eigen::Vector3d::UnitY(), out.shape);
  } else {
    start_limb(body, members, a, b, count, out.shape);
  }
  out.joint.resize(out.shape.size(), anatomy.bones[bone].joint);
}

/// What the capsules are fitted to.
struct Target {
  Mesh body;
  RayScene scene;
  Vertices normals;                   ///< (B, 3) of the body
  std::vector<int> points;            ///< body vertices
  std::vector<double> weights;        ///< of points, m^2
  std::vector<int> joints;            ///< of points: only capsules that move with this joint may stand for them
  std::vector<Eigen::Vector3d> cloth; ///< resting cloth
};

struct Sum {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  double cost = 0;
  void add(int capsule, const Eigen::Matrix<double, kParameters, 1> &gradient, double residual, double weight) {
    const int at = capsule * kParameters;
    matrix.block<kParameters, kParameters>(at, at) += weight * gradient * gradient.transpose();
    right.segment<kParameters>(at) -= weight * residual * gradient;
    cost += weight * residual * residual;
  }
};

Eigen::Matrix<double, kParameters, 1> distance_gradient(Capsule capsule, const Eigen::Vector3d &point) {
  constexpr double h = 1e-6;
  Eigen::Matrix<double, kParameters, 1> gradient;
  for (int k = 0; k < kParameters; ++k) {
    double &p = parameter(capsule, k);
    const double value = p;
    p = value + h;
    const double up = signed_distance(capsule, point);
    p = value - h;
    gradient[k] = (up - signed_distance(capsule, point)) / (2 * h);
    p = value;
  }
  return gradient;
}

/// Nearest of all capsules, or of those that move with `joint`.
int nearest_capsule(const Capsules &capsules, const Eigen::Vector3d &point, double &distance, int joint = -1) {
  int best = -1;
  distance = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < capsules.shape.size(); ++c) {
    if (joint >= 0 && capsules.joint[c] != joint)
      continue;
    if (const double d = signed_distance(capsules.shape[c], point); d < distance) {
      distance = d;
      best = static_cast<int>(c);
    }
  }
  return best;
}

/// Most of six rays leave the body: true inside even where the surface folds through itself.
bool surrounded(const RayScene &scene, const Mesh &body, const Eigen::Vector3d &point) {
  int leaving = 0;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d direction = (k % 2 ? -1 : 1) * Eigen::Vector3d::Unit(k / 2);
    const auto hit = scene.cast(point, direction);
    if (!hit)
      continue;
    const Eigen::Vector3d a = body.vertices.row(body.faces(hit->face, 0)), b = body.vertices.row(body.faces(hit->face, 1)),
                          c = body.vertices.row(body.faces(hit->face, 2));
    leaving += (b - a).cross(c - a).dot(direction) > 0;
  }
  return leaving >= 4;
}

/// Signed distance to the body (negative inside) and its outward direction at the closest point. The sign comes from interpolated
/// vertex normals: a face normal is ambiguous where the closest point is an edge, as in every fold. Where the skin of an arm pit
/// is folded into the chest its normals lie, so "outside" is verified.
double body_distance(const RayScene &scene, const Mesh &body, const Vertices &normals, const Eigen::Vector3d &point,
                     Eigen::Vector3d &outward) {
  const ClosestPoint at = scene.closest(point);
  outward.setZero();
  for (int k = 0; k < 3; ++k)
    outward += at.barycentric[k] * normals.row(body.faces(at.face, k)).transpose();
  outward.normalize();
  const bool outside = outward.dot(point - at.point) > 0 && !surrounded(scene, body, point);
  return outside ? at.distance : -at.distance;
}

/// Points on a capsule's surface: rings along the axis and the two poles. visit(point, t in [0, 1], unit direction from the
/// axis).
template <typename Visit> void visit_surface(const Capsule &c, Visit visit) {
  constexpr int rings = 7, around = 12;
  const Eigen::Vector3d axis = c.p1 - c.p0;
  const Eigen::Vector3d along = axis.norm() > 1e-9 ? Eigen::Vector3d(axis.normalized()) : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d u = along.unitOrthogonal(), w = along.cross(u);
  for (int i = 0; i < rings; ++i) {
    const double t = static_cast<double>(i) / (rings - 1), radius = (1 - t) * c.r0 + t * c.r1;
    for (int k = 0; k < around; ++k) {
      const double phi = 2 * std::numbers::pi * k / around;
      const Eigen::Vector3d direction = std::cos(phi) * u + std::sin(phi) * w;
      visit(Eigen::Vector3d(c.p0 + t * axis + radius * direction), t, direction);
    }
  }
  visit(Eigen::Vector3d(c.p0 - c.r0 * along), 0.0, Eigen::Vector3d(-along));
  visit(Eigen::Vector3d(c.p1 + c.r1 * along), 1.0, along);
}

/// Body points against their capsules.
void add_points(Sum &sum, const Capsules &capsules, const Target &target, double clearance) {
  for (std::size_t i = 0; i < target.points.size(); ++i) {
    const Eigen::Vector3d point = target.body.vertices.row(target.points[i]);
    double distance;
    const int c = nearest_capsule(capsules, point, distance, target.joints[i]);
    const double residual = distance - clearance;
    sum.add(c, distance_gradient(capsules.shape[c], point), residual, target.weights[i] * (residual < 0 ? kBulgeWeight : 1));
  }
}

/// Capsule surfaces against the body: whatever stands out of it.
void add_bulges(Sum &sum, const Capsules &capsules, const Target &target) {
  for (std::size_t c = 0; c < capsules.shape.size(); ++c) {
    const Capsule &capsule = capsules.shape[c];
    const double patch =
        2 * std::numbers::pi * (capsule.r0 + capsule.r1) / 2 * ((capsule.p1 - capsule.p0).norm() + capsule.r0 + capsule.r1) / 86;
    visit_surface(capsule, [&](const Eigen::Vector3d &point, double t, const Eigen::Vector3d &direction) {
      Eigen::Vector3d outward;
      const double outside = body_distance(target.scene, target.body, target.normals, point, outward);
      if (outside <= 0)
        return;
      Eigen::Matrix<double, kParameters, 1> gradient;
      const double by_radius = outward.dot(direction);
      gradient << (1 - t) * outward, t * outward, (1 - t) * by_radius, t * by_radius;
      sum.add(static_cast<int>(c), gradient, outside, kBulgeWeight * patch);
    });
  }
}

Sum accumulate(const Capsules &capsules, const Capsules &start, const Target &target, const ProxyOptions &options) {
  const int n = static_cast<int>(capsules.shape.size()) * kParameters;
  Sum sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  add_points(sum, capsules, target, options.clearance);
  add_bulges(sum, capsules, target);
  const double cloth_weight = kClothWeight * 1e-4; // a cloth sample stands for about a square centimetre
  for (const Eigen::Vector3d &point : target.cloth) {
    double distance;
    const int c = nearest_capsule(capsules, point, distance);
    if (distance < options.cloth_margin)
      sum.add(c, distance_gradient(capsules.shape[c], point), distance - options.cloth_margin, cloth_weight);
  }
  for (std::size_t c = 0; c < capsules.shape.size(); ++c)
    for (int k = 0; k < 6; ++k) {
      Capsule now = capsules.shape[c], then = start.shape[c];
      Eigen::Matrix<double, kParameters, 1> unit = Eigen::Matrix<double, kParameters, 1>::Zero();
      unit[k] = 1;
      sum.add(static_cast<int>(c), unit, parameter(now, k) - parameter(then, k), kTether);
    }
  return sum;
}

Capsules moved(Capsules capsules, const Eigen::VectorXd &step) {
  for (std::size_t c = 0; c < capsules.shape.size(); ++c) {
    Capsule &shape = capsules.shape[c];
    for (int k = 0; k < kParameters; ++k)
      parameter(shape, k) += step[c * kParameters + k];
    shape.r0 = std::max(shape.r0, kSmallestRadius);
    shape.r1 = std::max(shape.r1, kSmallestRadius);
  }
  return capsules;
}

void optimise(Capsules &capsules, const Target &target, const ProxyOptions &options) {
  const Capsules start = capsules;
  double damping = 1e-2;
  Sum current = accumulate(capsules, start, target, options);
  for (int iteration = 0; iteration < options.iterations && damping < 1e6; ++iteration) {
    Eigen::MatrixXd damped = current.matrix;
    damped.diagonal() += damping * (current.matrix.diagonal().array() + 1e-6).matrix();
    const Capsules trial = moved(capsules, damped.ldlt().solve(current.right));
    Sum next = accumulate(trial, start, target, options);
    const bool better = next.cost < current.cost;
    damping *= better ? 0.3 : 4;
    if (better) {
      capsules = trial;
      current = std::move(next);
    }
  }
}

/// Least squares only discourages: whatever still reaches into the resting cloth is made thinner.
void keep_out_of_cloth(Capsules &capsules, const Target &target, double margin) {
  for (Capsule &capsule : capsules.shape) {
    double least = margin;
    for (const Eigen::Vector3d &point : target.cloth)
      least = std::min(least, signed_distance(capsule, point));
    capsule.r0 = std::max(capsule.r0 - (margin - least), 1e-3);
    capsule.r1 = std::max(capsule.r1 - (margin - least), 1e-3);
  }
}

/// Cloth that could rest on the body: vertices and centroids of the valid faces whose corners are all cloth, where it faces the
/// way the body under it faces. In an arm pit the sleeve and the trunk's cloth run through each other and through the body; there
/// it bounds nothing.
std::vector<Eigen::Vector3d> resting_cloth(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body,
                                           const Vertices &normals, const RayScene &scene) {
  std::vector<Eigen::Vector3d> points;
  const Mesh &mesh = actor.mesh;
  const Vertices cloth_normals = face_normals(mesh.vertices, mesh.faces);
  std::vector<char> used(mesh.vertices.rows(), 0);
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::RowVector3i corners = mesh.faces.row(f);
    if (!actor.face_valid[f] ||
        std::any_of(corners.begin(), corners.end(), [&](int i) { return !(segmentation.clothness[i] > 0); }))
      continue;
    const Eigen::Vector3d centre =
        (mesh.vertices.row(corners[0]) + mesh.vertices.row(corners[1]) + mesh.vertices.row(corners[2])).transpose() / 3;
    Eigen::Vector3d outward;
    const double outside = body_distance(scene, body, normals, centre, outward);
    if (outside < -kDeepest || outward.dot(cloth_normals.row(f).transpose()) < 0)
      continue;
    points.push_back(centre);
    for (int i : corners)
      if (!used[i]) {
        used[i] = 1;
        points.push_back(mesh.vertices.row(i).transpose());
      }
  }
  return points;
}

/// The capsules of some of the bones, fitted together.
Capsules fit_bones(Target &target, const Anatomy &anatomy, const std::vector<std::uint8_t> &chosen,
                   const std::vector<std::uint8_t> &under, const Eigen::VectorXd &areas, const Skeleton &skeleton,
                   const ProxyOptions &options) {
  target.points.clear(), target.weights.clear(), target.joints.clear();
  for (std::size_t v = 0; v < under.size(); ++v)
    if (anatomy.nearest[v] >= 0 && chosen[anatomy.nearest[v]]) {
      target.points.push_back(static_cast<int>(v));
      target.weights.push_back(areas[v] * (under[v] ? 1 : kUncoveredWeight));
      target.joints.push_back(anatomy.bones[anatomy.nearest[v]].joint);
    }
  Capsules capsules;
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b)
    if (chosen[b])
      start_capsules(target.body, anatomy, static_cast<int>(b), skeleton, options.capsules_per_bone, capsules);
  if (capsules.shape.empty())
    return capsules;
  optimise(capsules, target, options);
  keep_out_of_cloth(capsules, target, options.cloth_margin);
  return capsules;
}

} // namespace

std::vector<TaperedCapsule> fit_proxies(const BodyFit &fit, const RiggedMesh &actor, const Segmentation &segmentation,
                                        const ProxyOptions &options) {
  options.validate();
  require_body(fit, "fit_proxies");
  const std::vector<std::uint8_t> under = body_under_cloth(fit.body, actor, segmentation);
  const Eigen::VectorXd areas = vertex_areas(fit.body.vertices, fit.body.faces);
  Target target{fit.body, RayScene(fit.body), vertex_normals(fit.body.vertices, fit.body.faces), {}, {}, {}, {}};
  target.cloth = resting_cloth(actor, segmentation, target.body, target.normals, target.scene);
  Anatomy anatomy = find_bones(fit.body, target.normals, target.scene, actor.skeleton);
  choose_bones(anatomy, actor.skeleton, under, areas);
  std::vector<std::uint8_t> clothed, reaching = reaching_bones(anatomy, actor, segmentation);
  for (const Bone &bone : anatomy.bones)
    clothed.push_back(bone.chosen);
  Capsules capsules = fit_bones(target, anatomy, clothed, under, areas, actor.skeleton, options);
  const Capsules beside = fit_bones(target, anatomy, reaching, under, areas, actor.skeleton, options);
  capsules.shape.insert(capsules.shape.end(), beside.shape.begin(), beside.shape.end());
  capsules.joint.insert(capsules.joint.end(), beside.joint.begin(), beside.joint.end());
  std::vector<TaperedCapsule> result;
  for (std::size_t c = 0; c < capsules.shape.size(); ++c) {
    const Eigen::Vector3d origin = actor.skeleton.joints[capsules.joint[c]].rest;
    const Capsule &shape = capsules.shape[c];
    result.push_back({capsules.joint[c], shape.p0 - origin, shape.p1 - origin, shape.r0, shape.r1});
  }
  return result;
}

ProxyStatistics proxy_statistics(const std::vector<TaperedCapsule> &capsules, const BodyFit &fit, const RiggedMesh &actor,
                                 const Segmentation &segmentation) {
  ProxyStatistics statistics;
  require_proxies(capsules, actor.skeleton, "proxy_statistics");
  require_body(fit, "proxy_statistics");
  statistics.capsules = static_cast<int>(capsules.size());
  if (capsules.empty())
    return statistics;
  const Transforms rest(actor.skeleton.joint_count(), Eigen::Isometry3d::Identity());
  Capsules posed{pose_capsules(capsules, actor.skeleton, rest), {}};
  const std::vector<std::uint8_t> under = body_under_cloth(fit.body, actor, segmentation);
  std::vector<double> distances;
  double distance;
  for (std::size_t v = 0; v < under.size(); ++v)
    if (under[v]) {
      nearest_capsule(posed, fit.body.vertices.row(v).transpose(), distance);
      distances.push_back(std::abs(distance));
    }
  std::sort(distances.begin(), distances.end());
  statistics.samples = static_cast<int>(distances.size());
  if (!distances.empty()) {
    statistics.mean_distance = std::accumulate(distances.begin(), distances.end(), 0.0) / distances.size();
    statistics.percentile95 = distances[std::min(distances.size() - 1, distances.size() * 95 / 100)];
  }
  const RayScene scene(fit.body);
  const Vertices normals = vertex_normals(fit.body.vertices, fit.body.faces);
  for (const Capsule &capsule : posed.shape)
    visit_surface(capsule, [&](const Eigen::Vector3d &point, double, const Eigen::Vector3d &) {
      Eigen::Vector3d outward;
      statistics.largest_bulge = std::max(statistics.largest_bulge, body_distance(scene, fit.body, normals, point, outward));
    });
  statistics.cloth_clearance = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d &point : resting_cloth(actor, segmentation, fit.body, normals, scene)) {
    nearest_capsule(posed, point, distance);
    statistics.cloth_clearance = std::min(statistics.cloth_clearance, distance);
  }
  return statistics;
}

} // namespace doublet
