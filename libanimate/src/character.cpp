#include "doublet/animate/character.h"

#include "display/body_weld.h"
#include "display/garment_part.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/core/parts/sparse_solve.h"
#include "doublet/rays/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr double kTouching = 0.010; // m, closer than this body and surface are the same skin (fit residual)
constexpr double kExposed = 0.030;  // m, farther than this the surface says nothing about the body's weights
constexpr int kOverlap = 3;         // triangles of the body beside what cloth hides, of which nothing else may be drawn
constexpr double kReach = 0.6;      // m, how far outside a limb its garment may hang
constexpr double kHeat = 4;         // weights fall to 1/e along the skin within half of its distance to the axis

double interpolate(const Eigen::VectorXd &values, const Faces &faces, const ClosestPoint &at) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += at.barycentric[k] * values[faces(at.face, k)];
  return sum;
}

bool touches_cloth(const Eigen::VectorXd &delta, const Faces &faces, int f) {
  return delta[faces(f, 0)] > 0 || delta[faces(f, 1)] > 0 || delta[faces(f, 2)] > 0;
}

/// Does the body's outward ray reach cloth before it reaches skin?
bool runs_into_cloth(const RayScene &scene, const RiggedMesh &actor, const Eigen::VectorXd &delta, const Vector3d &from,
                     const Vector3d &along) {
  const auto hit = scene.cast(from, along, 1e-4, kReach);
  return hit && touches_cloth(delta, actor.mesh.faces, hit->face);
}

struct NearestBone {
  int joint = 0;
  double distance = std::numeric_limits<double>::infinity();
};

/// A bone runs from its joint to each child.
NearestBone nearest_bone(const Skeleton &skeleton, const Vector3d &p) {
  NearestBone best;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0)
      continue;
    const double d = (p - closest_on_segment(p, skeleton.joints[parent].rest, skeleton.joints[j].rest)).norm();
    if (d < best.distance)
      best = {parent, d};
  }
  return best;
}

/// The capsule whose surface is nearest, in the place of a bone that lies deep in the trunk; distance: from its axis. capsules:
/// the proxies in the rest pose.
NearestBone nearest_capsule(const std::vector<TaperedCapsule> &proxies, const std::vector<Capsule> &capsules, const Vector3d &p) {
  NearestBone best;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < capsules.size(); ++c) {
    const double d = signed_distance(capsules[c], p);
    if (d < nearest) {
      nearest = d;
      best = {proxies[c].joint, (p - closest_on_segment(p, capsules[c].p0, capsules[c].p1)).norm()};
    }
  }
  return best;
}

/// A vertex goes with the majority of its neighbours: single rays slip through edges or graze.
std::vector<std::uint8_t> majority(const std::vector<std::uint8_t> &flags, const Faces &faces) {
  const auto neighbours = vertex_neighbours(faces, static_cast<int>(flags.size()));
  std::vector<std::uint8_t> result = flags;
  for (std::size_t v = 0; v < flags.size(); ++v) {
    std::size_t set = 0;
    for (int n : neighbours[v])
      set += flags[n] ? 1 : 0;
    if (2 * set != neighbours[v].size())
      result[v] = 2 * set > neighbours[v].size();
  }
  return result;
}

/// Also what M_high does not show beside them: it is cut off below a hem, where the scan's closing sheet begins.
void add_uncovered(const Character &c, std::vector<std::uint8_t> &hidden) {
  const RayScene drawn(c.high, c.high_valid);
  const auto neighbours = vertex_neighbours(c.body.faces, static_cast<int>(hidden.size()));
  for (int ring = 0; ring < kOverlap; ++ring) {
    const std::vector<std::uint8_t> before = hidden;
    for (std::size_t v = 0; v < hidden.size(); ++v)
      if (!before[v] && drawn.closest(c.body.vertices.row(static_cast<Eigen::Index>(v))).distance > kTouching)
        hidden[v] = std::any_of(neighbours[v].begin(), neighbours[v].end(), [&](int w) { return before[w] != 0; });
  }
}

void expect(const std::string &what, std::size_t found, std::size_t expected) {
  if (found != expected)
    throw Error("character: " + what + " has " + std::to_string(found) + " entries, expected " + std::to_string(expected));
}

void require_high_body(const Character &c) {
  if (c.high_body.empty())
    return;
  const Eigen::Index skin = c.garment_subdivisions < 0 ? 0 : detail::garment_part(c).skin_vertices;
  if (static_cast<Eigen::Index>(c.high_body.size()) >= skin)
    throw Error("character: high_body has " + std::to_string(c.high_body.size()) + " entries, expected fewer than the " +
                std::to_string(skin) + " vertices of M_high's skin");
  for (int v : c.high_body)
    if (v < 0 || v >= c.body.vertices.rows())
      throw Error("character: high_body: expected vertices of the body in [0, " + std::to_string(c.body.vertices.rows()) +
                  "), found " + std::to_string(v));
}

void require_inputs(const RiggedMesh &actor, const Segmentation &segmentation) {
  require_actor(actor, "character");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "character");
}

/// (L + A H) w = A H p on the free vertices, w given on the others. Where they go over slowly, skin of the trunk
/// follows an arm by centimetres out of the capsules, and out of the cloth that lies on these.
MatrixRM diffuse_weights(const Mesh &body, const Skeleton &skeleton, const std::vector<TaperedCapsule> &proxies,
                         const std::vector<std::uint8_t> &fixed, MatrixRM weights) {
  const int n = static_cast<int>(body.vertices.rows());
  std::vector<int> unknown(n, -1);
  int count = 0;
  for (int v = 0; v < n; ++v)
    if (!fixed[v])
      unknown[v] = count++;
  if (count == 0)
    return weights;
  const Eigen::VectorXd areas = vertex_areas(body.vertices, body.faces);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(skeleton.dof_count());
  const std::vector<Capsule> capsules = pose_capsules(proxies, skeleton, forward_kinematics(skeleton, rest));
  MatrixRM right = MatrixRM::Zero(count, weights.cols());
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < n; ++v)
    if (!fixed[v]) {
      const Vector3d p = body.vertices.row(v);
      const NearestBone bone = capsules.empty() ? nearest_bone(skeleton, p) : nearest_capsule(proxies, capsules, p);
      const double heat = kHeat * std::max(areas[v], 1e-10) / std::max(bone.distance * bone.distance, 1e-6);
      entries.emplace_back(unknown[v], unknown[v], heat);
      right(unknown[v], bone.joint) += heat;
    }
  for (const Triplet &t : cotangent_laplacian(body.vertices, body.faces)) {
    if (fixed[t.row])
      continue;
    if (fixed[t.col])
      right.row(unknown[t.row]) -= t.value * weights.row(t.col);
    else
      entries.emplace_back(unknown[t.row], unknown[t.col], t.value);
  }
  const Eigen::MatrixXd solution = solve_symmetric(entries, right, "the heat equation of the body's skin weights");
  for (int v = 0; v < n; ++v)
    if (!fixed[v])
      weights.row(v) = solution.row(unknown[v]).cwiseMax(0);
  return weights;
}

/// What is hidden of the body becomes part of M_high's skin. False if it does not fit there.
bool weld_hidden_body(Character &c, const std::vector<std::uint8_t> &hidden) {
  const detail::GarmentPart part = detail::garment_part(c);
  if (part.skin_faces == 0)
    return false;
  const Mesh skin{
      c.high.vertices.topRows(part.skin_vertices),
      valid_faces(c.high.faces.topRows(part.skin_faces), {c.high_valid.begin(), c.high_valid.begin() + part.skin_faces})};
  if (skin.faces.rows() == 0)
    return false;
  const std::optional<detail::WeldedSkin> welded = detail::weld_body(skin, c.body, hidden);
  if (!welded)
    return false;
  const Mesh garment{c.high.vertices.bottomRows(part.fine.weights.rows()), part.fine.faces};
  c.high = detail::joined(welded->mesh, garment);
  c.high_valid.assign(c.high.faces.rows(), 1);
  c.high_body = welded->body_vertices;
  return true;
}

} // namespace

std::vector<std::uint8_t> hidden_by_cloth(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body) {
  require_inputs(actor, segmentation);
  require_usable(body, "body");
  const RayScene scene(actor.mesh, actor.face_valid);
  const Vertices normals = vertex_normals(body.vertices, body.faces);
  std::vector<std::uint8_t> hidden(body.vertices.rows(), 0);
  for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) {
    const Vector3d p = body.vertices.row(v), n = normals.row(v);
    const ClosestPoint at = scene.closest(p);
    if (interpolate(segmentation.clothness, actor.mesh.faces, at) > 0)
      hidden[v] = 1;
    else if (at.distance > kTouching && n.squaredNorm() > 0 && runs_into_cloth(scene, actor, segmentation.clothness, p, n))
      hidden[v] = 1;
  }
  return majority(hidden, body.faces);
}

MatrixRM transfer_weights(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body,
                          const std::vector<TaperedCapsule> &proxies) {
  require_proxies(proxies, actor.skeleton, "character");
  std::vector<std::uint8_t> exposed = hidden_by_cloth(actor, segmentation, body);
  const RayScene scene(actor.mesh, actor.face_valid);
  const Vertices surface_normals = face_normals(actor.mesh.vertices, actor.mesh.faces);
  const Vertices normals = vertex_normals(body.vertices, body.faces);
  MatrixRM weights = MatrixRM::Zero(body.vertices.rows(), actor.skeleton.joint_count());
  for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) {
    const ClosestPoint at = scene.closest(body.vertices.row(v));
    exposed[v] = !exposed[v] && at.distance < kExposed && !touches_cloth(segmentation.clothness, actor.mesh.faces, at.face) &&
                 surface_normals.row(at.face).dot(normals.row(v)) > 0;
    for (int k = 0; k < 3 && exposed[v]; ++k)
      weights.row(v) += at.barycentric[k] * actor.weights.row(actor.mesh.faces(at.face, k));
  }
  weights = diffuse_weights(body, actor.skeleton, proxies, exposed, std::move(weights));
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double sum = weights.row(v).sum();
    if (!(sum > 1e-9)) // a vertex without faces: no equation reached it
      weights(v, nearest_bone(actor.skeleton, body.vertices.row(v)).joint) = 1;
    else
      weights.row(v) /= sum;
  }
  return weights;
}

void validate_character(const Character &c) {
  require_inputs(c.actor, c.segmentation);
  expect("materials", c.materials.size(), c.segmentation.region_count);
  for (const pbd::Material &material : c.materials)
    pbd::validate(material);
  c.solver.validate();
  require_proxies(c.proxies, c.actor.skeleton, "character");
  if (c.body.faces.rows() > 0) {
    require_usable(c.body, "body");
    expect("body_weights", c.body_weights.rows(), c.body.vertices.rows());
    expect("a row of body_weights", c.body_weights.cols(), c.actor.skeleton.joint_count());
    expect("body_shown", c.body_shown.size(), c.body.faces.rows());
    if (!c.body_weights.allFinite())
      throw Error("character: body_weights: expected finite numbers, found NaN or infinity");
  }
  if (c.high.faces.rows() > 0) {
    require_usable(c.high, "high");
    expect("high_valid", c.high_valid.size(), c.high.faces.rows());
    if (c.garment_subdivisions != -1)
      detail::garment_part(c); // throws
    require_high_body(c);
  }
  if (c.texture.empty() != (c.texcoords.rows() == 0))
    throw Error("character: texture and texcoords must both be there or both be empty");
  if (!c.texture.empty())
    expect("texcoords", c.texcoords.rows(), 3 * c.high.faces.rows());
  if (!c.texcoords.allFinite())
    throw Error("character: texcoords: expected finite numbers, found NaN or infinity");
}

Character make_character(const RiggedMesh &actor, const Segmentation &segmentation, const BodyFit &body,
                         const std::vector<TaperedCapsule> &proxies, const std::vector<pbd::Material> &materials,
                         const SolverSettings &solver, const Mesh &high, const std::vector<std::uint8_t> &high_valid,
                         int garment_subdivisions) {
  Character c;
  c.actor = actor;
  c.segmentation = segmentation;
  c.proxies = proxies;
  c.materials = materials;
  c.solver = solver;
  c.high = high;
  c.garment_subdivisions = garment_subdivisions;
  c.high_valid = high_valid.empty() ? std::vector<std::uint8_t>(high.faces.rows(), 1) : high_valid;
  if (body.body.faces.rows() > 0) {
    require_body(body, "character");
    c.body = body.body;
    c.body_model = body.model;
    c.body_weights = transfer_weights(actor, segmentation, body.body, proxies);
    std::vector<std::uint8_t> hidden = hidden_by_cloth(actor, segmentation, body.body);
    if (garment_subdivisions >= 0)
      add_uncovered(c, hidden);
    c.body_shown.assign(c.body.faces.rows(), 0);
    const bool welded = garment_subdivisions >= 0 && weld_hidden_body(c, hidden);
    for (Eigen::Index f = 0; f < c.body.faces.rows() && !welded; ++f)
      c.body_shown[f] = hidden[c.body.faces(f, 0)] || hidden[c.body.faces(f, 1)] || hidden[c.body.faces(f, 2)];
  }
  validate_character(c);
  return c;
}

} // namespace doublet
