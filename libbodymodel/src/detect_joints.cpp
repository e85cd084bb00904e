#include "doublet/bodymodel/detect_joints.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/options/options.h"
#include "doublet/rays/ray_scene.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace doublet {
namespace {

/// Where a standard joint lies: in the middle of these joints of the model, or at a landmark.
struct JointSource {
  const char *name, *parent, *first, *second;
  const char *landmark = nullptr;
};

/// The chest is where the clavicles part: in the model's rig they hang from a joint at the height of the sternum's end.
constexpr std::array kJoints{
    JointSource{"pelvis", "", "pelvis", "pelvis"},
    JointSource{"spine", "pelvis", "spine2", "spine2"},
    JointSource{"chest", "spine", "chest", "neck"},
    JointSource{"neck", "chest", "neck", "neck"},
    JointSource{"head", "neck", "head", "head"},
    JointSource{"head_top", "head", "", "", "head_top"},
    JointSource{"l_clavicle", "chest", "l_clavicle", "l_clavicle"},
    JointSource{"l_shoulder", "l_clavicle", "l_shoulder", "l_shoulder"},
    JointSource{"l_elbow", "l_shoulder", "l_elbow", "l_elbow"},
    JointSource{"l_wrist", "l_elbow", "l_wrist", "l_wrist"},
    JointSource{"l_hand", "l_wrist", "", "", "l_knuckle"},
    JointSource{"r_clavicle", "chest", "r_clavicle", "r_clavicle"},
    JointSource{"r_shoulder", "r_clavicle", "r_shoulder", "r_shoulder"},
    JointSource{"r_elbow", "r_shoulder", "r_elbow", "r_elbow"},
    JointSource{"r_wrist", "r_elbow", "r_wrist", "r_wrist"},
    JointSource{"r_hand", "r_wrist", "", "", "r_knuckle"},
    JointSource{"l_hip", "pelvis", "l_hip", "l_hip"},
    JointSource{"l_knee", "l_hip", "l_knee", "l_knee"},
    JointSource{"l_ankle", "l_knee", "l_ankle", "l_ankle"},
    JointSource{"l_toe", "l_ankle", "l_toe", "l_toe"},
    JointSource{"r_hip", "pelvis", "r_hip", "r_hip"},
    JointSource{"r_knee", "r_hip", "r_knee", "r_knee"},
    JointSource{"r_ankle", "r_knee", "r_ankle", "r_ankle"},
    JointSource{"r_toe", "r_ankle", "r_toe", "r_toe"},
};

constexpr std::array kLandmarks{"head_top",    "nose_tip",    "l_middle_fingertip", "r_middle_fingertip",
                                "l_thumb_tip", "r_thumb_tip", "l_big_toe_tip",      "r_big_toe_tip",
                                "l_heel",      "r_heel"};

/// m; the ends of the surface are not quite the landmarks: hair, another finger, a shoe.
constexpr double kEndDeviation = 0.05;
/// m; joints that a network sees in images are not quite the model's.
constexpr double kSeenDeviation = 0.03;
/// m; of a surface in clothes, or one that cameras have made: folds and hulls are wrong alike over more than the fitter's 4 cm^2.
constexpr double kDressedDeviation = 0.05;
/// m; surface that is farther from the fitted body is cloth: skin is nearer even if the model is not this person's.
constexpr double kOffSkin = 0.03;
/// m; mean distance of what is taken for skin to the body beyond which the body is somewhere else.
constexpr double kLargestResidual = 0.02;

using Marks = std::map<std::string, Eigen::Vector3d>;

constexpr int kLimbs = 5, kMoreEnds = 3; // head, hands, feet; and corners of a garment that may be mistaken for them

/// Farthest points along the surface: the first from the vertex nearest to the middle, each next from all before.
std::vector<Eigen::Vector3d> ends_of(const Mesh &surface) {
  const auto neighbours = vertex_neighbours(surface.faces, static_cast<int>(surface.vertices.rows()));
  const Eigen::RowVector3d middle = surface.vertices.colwise().mean();
  Eigen::VectorXd off = (surface.vertices.rowwise() - middle).rowwise().squaredNorm();
  for (Eigen::Index v = 0; v < off.size(); ++v)
    if (neighbours[static_cast<std::size_t>(v)].empty()) // from a vertex on no face no way leads anywhere
      off[v] = std::numeric_limits<double>::infinity();
  Eigen::Index nearest = 0;
  off.minCoeff(&nearest);
  std::vector<int> sources{static_cast<int>(nearest)};
  std::vector<Eigen::Vector3d> ends;
  while (ends.size() < kLimbs + kMoreEnds) {
    Eigen::VectorXd ways = edge_distances(surface.vertices, neighbours, sources);
    ways = ways.array().isFinite().select(ways, -1); // another piece
    Eigen::Index farthest = 0;
    if (!(ways.maxCoeff(&farthest) > 0))
      throw Error("joint detection: expected a surface in one piece with five ends (head, hands, feet), found fewer");
    ends.emplace_back(surface.vertices.row(farthest));
    sources.push_back(static_cast<int>(farthest));
  }
  return ends;
}

double across(const Eigen::Vector3d &a, const Eigen::Vector3d &b) {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

struct Ends {
  Eigen::Vector3d head;
  std::array<Eigen::Vector3d, 2> hands, feet;
};

/// Of the first five the lowest two are the feet. Of all others the two that are farthest apart are the hands: an arm that
/// touches a wide sleeve or the trunk is a short way from the middle. The head is what is left highest above the feet.
Ends named_ends(const Mesh &surface) {
  std::vector<Eigen::Vector3d> ends = ends_of(surface);
  std::sort(ends.begin(), ends.begin() + kLimbs, [](const auto &a, const auto &b) { return a.y() < b.y(); });
  const std::array<Eigen::Vector3d, 2> feet{ends[0], ends[1]};
  ends.erase(ends.begin(), ends.begin() + 2);
  std::size_t left = 0, right = 1;
  for (std::size_t a = 0; a < ends.size(); ++a)
    for (std::size_t b = a + 1; b < ends.size(); ++b)
      if (across(ends[a], ends[b]) > across(ends[left], ends[right]))
        left = a, right = b;
  const std::array<Eigen::Vector3d, 2> hands{ends[left], ends[right]};
  ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(right)); // the later one
  ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(left));
  const Eigen::Vector3d between = (feet[0] + feet[1]) / 2;
  const auto above = [&](const Eigen::Vector3d &end) { return end.y() - across(end, between); };
  return {*std::max_element(ends.begin(), ends.end(), [&](const auto &a, const auto &b) { return above(a) < above(b); }), hands,
          feet};
}

/// The marks if hands[left] is the left one; the foot on its side is the left foot.
Marks marks_of(const Ends &ends, int left) {
  const Eigen::Vector3d leftward = ends.hands[left] - ends.hands[1 - left];
  const int left_foot = ends.feet[0].dot(leftward) > ends.feet[1].dot(leftward) ? 0 : 1;
  return {{"head_top", ends.head},
          {"l_middle_fingertip", ends.hands[left]},
          {"r_middle_fingertip", ends.hands[1 - left]},
          {"l_big_toe_tip", ends.feet[left_foot]},
          {"r_big_toe_tip", ends.feet[1 - left_foot]}};
}

void require_names(const BodyModel &model) {
  const std::vector<std::string> names = model.joint_names();
  const auto require = [&](bool found, const std::string &what, const char *name) {
    if (!found)
      throw Error("joint detection: expected the body model to have the " + what + " '" + name + "', found none of this name");
  };
  for (const JointSource &joint : kJoints)
    for (const char *name : {joint.first, joint.second})
      if (joint.landmark)
        require(model.landmarks().count(joint.landmark) > 0, "landmark", joint.landmark);
      else
        require(std::find(names.begin(), names.end(), name) != names.end(), "joint", name);
  for (const char *name : {"l_middle_fingertip", "r_middle_fingertip", "l_big_toe_tip", "r_big_toe_tip"})
    require(model.landmarks().count(name) > 0, "landmark", name);
}

/// What the fitter wants to know of a surface that has no skeleton yet.
RiggedMesh unrigged(const Mesh &surface, const std::vector<std::uint8_t> &face_valid) {
  RiggedMesh actor;
  actor.mesh = surface;
  actor.face_valid = face_valid.empty() ? std::vector<std::uint8_t>(surface.faces.rows(), 1) : face_valid;
  return actor;
}

/// As the fitter takes them: names and places, nothing hangs on them.
std::vector<Joint> seen_joints(const Marks &seen) {
  std::vector<Joint> joints;
  for (const auto &[name, place] : seen) {
    if (!place.allFinite())
      throw Error("joint detection: joint '" + name + "': expected a finite position");
    joints.emplace_back();
    joints.back().name = name;
    joints.back().rest = place;
  }
  return joints;
}

[[noreturn]] void refuse_person(const std::string &what) {
  throw Error("joint detection: expected a person, upright (+Y) and in metres, with arms and legs apart; the body model " + what);
}

/// Everything is skin at first, then what does not stand off the body found so far.
BodyFit fit_side(const RiggedMesh &actor, const BodyModel &model, const Marks &marks, const BodyFitter &fitter,
                 const Context &context) {
  const Vertices &surface = actor.mesh.vertices;
  Segmentation segmentation;
  segmentation.clothness = Eigen::VectorXd::Zero(surface.rows());
  BodyFit fit = fitter.fit(actor, segmentation, model, marks, context);
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    const RayScene body(fit.body);
    parallel_for(context, static_cast<int>(surface.rows()),
                 [&](int v) { segmentation.clothness[v] = body.closest(surface.row(v)).distance > kOffSkin; });
    constexpr double kMostHidden = 0.8; // share of the vertices
    if (segmentation.clothness.mean() > kMostHidden)
      refuse_person("finds no surface near it");
    fit = fitter.fit(actor, segmentation, model, marks, context);
  }
  return fit;
}

/// m, mean over its vertices: how far a body stands out of the surface. Nobody does, dressed or not; a body that looks the wrong
/// way has its feet, hands and belly where there is nothing.
double beyond_surface(const Mesh &surface, const Mesh &body, const Context &context) {
  const RayScene scene(surface);
  const Vertices normals = vertex_normals(surface.vertices, surface.faces);
  Eigen::VectorXd beyond = Eigen::VectorXd::Zero(body.vertices.rows());
  parallel_for(context, static_cast<int>(body.vertices.rows()), [&](int v) {
    const Eigen::Vector3d point = body.vertices.row(v);
    const ClosestPoint at = scene.closest(point);
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c)
      outward += at.barycentric[c] * normals.row(surface.faces(at.face, c)).transpose();
    if (outward.dot(point - at.point) > 0)
      beyond[v] = at.distance;
  });
  return beyond.mean();
}

/// m, how badly a body explains a surface: how far it stands out of it and how far the surface is from it, means over the
/// vertices. Either alone deceives: a body that looks the wrong way may hide in the surface with its limbs drawn in, or leave a
/// wide garment no farther off.
double mismatch(const Mesh &surface, const Mesh &body, const Context &context) {
  const RayScene scene(body);
  Eigen::VectorXd off(surface.vertices.rows());
  parallel_for(context, static_cast<int>(off.size()), [&](int v) { off[v] = scene.closest(surface.vertices.row(v)).distance; });
  return beyond_surface(surface, body, context) + off.mean();
}

/// Joints of the model in the world: the fit's body tells how the model's space lies there.
std::map<std::string, Eigen::Vector3d> world_joints(const BodyModel &model, const BodyFit &fit) {
  const Eigen::Matrix4d world =
      nearest_similarity(model.vertices(fit.coefficients).transpose(), fit.body.vertices.transpose(), AlignmentScale::Free);
  const Vertices joints = model.joints(fit.coefficients).points;
  const std::vector<std::string> names = model.joint_names();
  std::map<std::string, Eigen::Vector3d> result;
  for (std::size_t j = 0; j < names.size(); ++j)
    result[names[j]] =
        world.topLeftCorner<3, 3>() * joints.row(static_cast<Eigen::Index>(j)).transpose() + world.topRightCorner<3, 1>();
  return result;
}

void read_marks(const BodyModel &model, DetectedJoints &marks) {
  const auto joints = world_joints(model, marks.fit);
  const auto landmark = [&](const char *name) -> Eigen::Vector3d {
    return marks.fit.body.vertices.row(model.landmarks().at(name)).transpose();
  };
  for (const JointSource &source : kJoints) {
    const Eigen::Vector3d place =
        source.landmark ? landmark(source.landmark) : Eigen::Vector3d((joints.at(source.first) + joints.at(source.second)) / 2);
    marks.joints.push_back({source.name, source.parent, place, std::nullopt});
  }
  for (const char *name : kLandmarks)
    if (model.landmarks().count(name) > 0)
      marks.landmarks[name] = landmark(name);
}

} // namespace

DetectedJoints detect_joints(const Mesh &surface, const std::vector<std::uint8_t> &face_valid, const BodyModel &model,
                             const BodyFitOptions &options, const std::map<std::string, Eigen::Vector3d> &seen,
                             const Context &context) {
  require_usable(surface, "joint detection");
  require_names(model);
  RiggedMesh actor = unrigged(surface, face_valid);
  BodyFitOptions loose = options;
  loose.landmark_deviation = std::max(options.landmark_deviation, kEndDeviation);
  loose.joint_deviation = std::max(options.joint_deviation, kSeenDeviation);
  loose.surface_deviation = std::max(options.surface_deviation, kDressedDeviation);
  const auto fitter = BodyFitter::create(loose);
  DetectedJoints marks;
  if (seen.empty()) {
    const Ends ends = named_ends(surface);
    std::array<BodyFit, 2> fits;
    std::array<double, 2> mismatches;
    for (int side = 0; side < 2; ++side) {
      fits[side] = fit_side(actor, model, marks_of(ends, side), *fitter, context);
      mismatches[side] = mismatch(surface, fits[side].body, context);
    }
    const int better = mismatches[1] < mismatches[0];
    marks.facing_ambiguity = mismatches[better] / std::max(mismatches[1 - better], 1e-9);
    marks.fit = std::move(fits[better]);
  } else {
    actor.skeleton.joints = seen_joints(seen);
    marks.fit = fit_side(actor, model, {}, *fitter, context);
  }
  if (!(marks.fit.residual < kLargestResidual))
    refuse_person("stays " + options::to_text(1000 * marks.fit.residual, 3) + " mm from the surface on average");
  read_marks(model, marks);
  return marks;
}

} // namespace doublet
