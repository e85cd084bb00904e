#include "doublet/bodymodel/body_fitter.h"

#include "anatomy.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/rays/ray_scene.h"
#include "nearest_points.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace doublet {
namespace {

/// Surface that counts as one independent measurement, m^2: the model's errors are alike within about 2 cm.
constexpr double kSampleArea = 4e-4;
/// Correspondences whose normals differ by more than 60 degrees are none.
constexpr double kNormalCosine = 0.5;
/// Weight, against skin, of cloth that the body stands out of, and the scale (m) of its robust weights: where sleeves cross the
/// trunk the closest cloth may be the wrong one, and a plane centimetres off must not decide.
constexpr double kPushWeight = 0.5, kPushScale = 0.02;

/// What is estimated: world = scale * rotation * model(coefficients) + translation.
struct State {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1, prior_scale = 1;
  Eigen::VectorXd coefficients;

  Vertices world(const Vertices &model) const {
    return (scale * model * rotation.transpose()).rowwise() + translation.transpose();
  }
  /// Unknowns: turn about the origin of the model (3), translation (3), log scale (1), coefficients (K).
  void move(const Eigen::VectorXd &step) {
    const Eigen::Vector3d turn = step.head<3>();
    if (turn.norm() > 0)
      rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * rotation;
    translation += step.segment<3>(3);
    scale *= std::exp(step[6]);
    coefficients += step.tail(coefficients.size());
  }
};

/// Gauss-Newton normal equations, filled in blocks of rows so that the products run at matrix speed.
class NormalEquations {
public:
  explicit NormalEquations(int unknowns)
      : matrix_(Eigen::MatrixXd::Zero(unknowns, unknowns)), right_(Eigen::VectorXd::Zero(unknowns)), rows_(256, unknowns),
        residuals_(256) {}

  /// Adds weight * (residual + row . step)^2.
  void add(const Eigen::RowVectorXd &row, double residual, double weight) {
    rows_.row(count_) = std::sqrt(weight) * row;
    residuals_[count_] = std::sqrt(weight) * residual;
    if (++count_ == rows_.rows())
      flush();
  }
  void add_diagonal(int unknown, double residual, double weight) {
    matrix_(unknown, unknown) += weight;
    right_[unknown] -= weight * residual;
  }
  /// Adds the equations of a part whose unknown i is this one's unknown[i].
  void add(NormalEquations &part, const std::vector<int> &unknown) {
    part.flush();
    for (std::size_t i = 0; i < unknown.size(); ++i) {
      right_[unknown[i]] += part.right_[i];
      for (std::size_t j = 0; j <= i; ++j)
        matrix_(std::max(unknown[i], unknown[j]), std::min(unknown[i], unknown[j])) += part.matrix_(i, j);
    }
  }
  Eigen::VectorXd solve() {
    flush();
    return matrix_.selfadjointView<Eigen::Lower>().ldlt().solve(right_);
  }
  /// Lower factor of the matrix: of the inverse covariance, if every residual was divided by its deviation.
  Eigen::LLT<Eigen::MatrixXd> factor() {
    flush();
    return matrix_.selfadjointView<Eigen::Lower>().llt();
  }

private:
  void flush() {
    if (count_ == 0)
      return; // Eigen's blocking divides by the number of rows
    matrix_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.topRows(count_).transpose());
    right_ -= rows_.topRows(count_).transpose() * residuals_.head(count_);
    count_ = 0;
  }
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_;
  MatrixRM rows_;
  Eigen::VectorXd residuals_;
  int count_ = 0;
};

/// direction . d(world point i) / d(unknowns), for a point of a linearisation.
Eigen::RowVectorXd point_row(const State &state, const BodyLinearisation &at, int i, const Eigen::Vector3d &direction) {
  const Eigen::Vector3d turned = state.scale * (state.rotation * at.points.row(i).transpose());
  Eigen::RowVectorXd row(7 + at.jacobian.cols());
  row.head<3>() = turned.cross(direction).transpose();
  row.segment<3>(3) = direction.transpose();
  row[6] = direction.dot(turned);
  row.tail(at.jacobian.cols()) = state.scale * (direction.transpose() * state.rotation) * at.jacobian.middleRows(3 * i, 3);
  return row;
}

/// Points known by name: a vertex or a joint of the model, where it is in the scan, how far it is trusted.
struct NamedPoint {
  bool joint;
  int index;
  Eigen::Vector3d target;
  double deviation;
};

std::vector<NamedPoint> match_names(const RiggedMesh &actor, const BodyModel &model,
                                    const std::map<std::string, Eigen::Vector3d> &landmarks, const BodyFitOptions &options) {
  std::vector<NamedPoint> points;
  for (const auto &[name, position] : landmarks) {
    if (!position.allFinite())
      throw Error("landmark '" + name + "': expected a finite position");
    const auto found = model.landmarks().find(name);
    if (found != model.landmarks().end())
      points.push_back({false, found->second, position, options.landmark_deviation});
  }
  const std::vector<std::string> names = model.joint_names();
  for (const Joint &joint : actor.skeleton.joints) {
    const auto found = std::find(names.begin(), names.end(), joint.name);
    if (found != names.end())
      points.push_back({true, static_cast<int>(found - names.begin()), joint.rest, options.joint_deviation});
  }
  if (points.size() < 3)
    throw Error("body fit: expected at least 3 landmarks or joints whose names the body model knows, found " +
                std::to_string(points.size()) + " (of " + std::to_string(landmarks.size()) + " landmarks and " +
                std::to_string(actor.skeleton.joint_count()) + " joints)");
  return points;
}

void add_named(NormalEquations &equations, const State &state, const BodyModel &model, const std::vector<NamedPoint> &points) {
  std::vector<int> vertices;
  for (const NamedPoint &point : points)
    if (!point.joint)
      vertices.push_back(point.index);
  const BodyLinearisation at_vertices = model.linearise(state.coefficients, vertices),
                          at_joints = model.joints(state.coefficients);
  int next_vertex = 0;
  for (const NamedPoint &point : points) {
    const BodyLinearisation &at = point.joint ? at_joints : at_vertices;
    const int i = point.joint ? point.index : next_vertex++;
    const Eigen::Vector3d difference =
        state.scale * (state.rotation * at.points.row(i).transpose()) + state.translation - point.target;
    // Cauchy weights: a mark that is far off (hair, a slip of the hand) pulls no harder than one at three deviations.
    const double weight =
        1 / (point.deviation * point.deviation) / (1 + difference.squaredNorm() / std::pow(3 * point.deviation, 2));
    for (int axis = 0; axis < 3; ++axis)
      equations.add(point_row(state, at, i, Eigen::Vector3d::Unit(axis)), difference[axis], weight);
  }
}

/// skipped: the first coefficients, whose prior somebody else has added.
void add_prior(NormalEquations &equations, const State &state, double scale_deviation, int skipped) {
  equations.add_diagonal(6, std::log(state.scale / state.prior_scale), 1 / (scale_deviation * scale_deviation));
  for (int k = skipped; k < state.coefficients.size(); ++k)
    equations.add_diagonal(7 + k, state.coefficients[k], 1);
}

/// Similarity of the mean body to the named points (Umeyama 1991).
State initial_state(const BodyModel &model, const std::vector<NamedPoint> &points) {
  State state;
  state.coefficients = Eigen::VectorXd::Zero(model.component_count());
  const Vertices vertices = model.vertices(state.coefficients), joints = model.joints(state.coefficients).points;
  if (const std::size_t names = model.joint_names().size(); static_cast<std::size_t>(joints.rows()) != names)
    throw std::invalid_argument("body fit: expected joints() of the body model to have a point for each of its " +
                                std::to_string(names) + " joint_names(), found " + std::to_string(joints.rows()));
  Eigen::Matrix3Xd from(3, points.size()), to(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    from.col(i) = (points[i].joint ? joints : vertices).row(points[i].index).transpose();
    to.col(i) = points[i].target;
  }
  const Eigen::Matrix4d similarity = nearest_similarity(from, to, AlignmentScale::Free);
  state.scale = std::cbrt(similarity.topLeftCorner<3, 3>().determinant());
  if (!(std::isfinite(state.scale) && state.scale > 1e-6))
    throw Error("body fit: the landmarks and joints lie on one line or point, which determines no similarity transform");
  state.rotation = similarity.topLeftCorner<3, 3>() / state.scale;
  state.translation = similarity.topRightCorner<3, 1>();
  // Metres stay metres: stature belongs to the model's coefficients. Other units (cm, a child) take the landmarks' scale.
  state.prior_scale = std::abs(std::log(state.scale)) < std::log(1.25) ? 1.0 : state.scale;
  return state;
}

enum class Label : std::uint8_t { Ignored, Exposed, Cloth };

/// The actor's surface as the fit sees it.
struct Scan {
  const RiggedMesh &actor;
  std::vector<Label> face_label; ///< (F)
  std::vector<char> exposed;     ///< (V) all faces around are exposed
  Vertices normals;              ///< (V, 3) over the valid faces
  Eigen::VectorXd areas;         ///< (V) m^2
  RayScene scene;
};

Scan prepare_scan(const RiggedMesh &actor, const Segmentation &segmentation) {
  require_usable(actor.mesh, "actor mesh"); // weights and regions do not matter here
  const Faces &faces = actor.mesh.faces;
  const int v = static_cast<int>(actor.mesh.vertices.rows()), f = static_cast<int>(faces.rows());
  if (segmentation.clothness.size() != v)
    throw std::invalid_argument("clothness: expected " + std::to_string(v) + " entries, one per vertex, found " +
                                std::to_string(segmentation.clothness.size()));
  if (!segmentation.clothness.allFinite())
    throw Error("clothness: expected values in [0, 1], found NaN or infinity");
  if (static_cast<int>(actor.face_valid.size()) != f)
    throw std::invalid_argument("face_valid: expected " + std::to_string(f) + " entries, one per face, found " +
                                std::to_string(actor.face_valid.size()));
  std::vector<Label> label(f, Label::Exposed);
  std::vector<char> exposed(v, 1);
  Faces valid(f, 3);
  int valid_count = 0;
  for (int i = 0; i < f; ++i) {
    for (int k = 0; k < 3; ++k)
      if (segmentation.clothness[faces(i, k)] > 0)
        label[i] = Label::Cloth;
    if (!actor.face_valid[i])
      label[i] = Label::Ignored;
    else
      valid.row(valid_count++) = faces.row(i);
    if (label[i] != Label::Exposed)
      for (int k = 0; k < 3; ++k)
        exposed[faces(i, k)] = 0;
  }
  valid.conservativeResize(valid_count, 3);
  const Eigen::VectorXd areas = vertex_areas(actor.mesh.vertices, valid);
  for (int i = 0; i < v; ++i)
    exposed[i] = exposed[i] && areas[i] > 0;
  return {actor, std::move(label), std::move(exposed), vertex_normals(actor.mesh.vertices, valid), areas, RayScene(actor.mesh)};
}

Eigen::Vector3d interpolated(const Vertices &values, const Faces &faces, const ClosestPoint &at) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    sum += at.barycentric[k] * values.row(faces(at.face, k)).transpose();
  return sum.normalized();
}

/// One point-to-plane residual: body vertex, plane, weight.
struct Plane {
  int vertex = -1;
  Eigen::Vector3d point, normal;
  double weight = 0;
};

double geman_mcclure(double residual, double scale) {
  const double s = scale * scale / (scale * scale + residual * residual);
  return s * s;
}

struct BodySurface {
  Vertices vertices, normals;
  Eigen::VectorXd areas;
};

/// Body vertex -> closest point of the whole scan: skin pulls, cloth only holds the body inside, invented surface does nothing.
std::vector<Plane> body_to_scan(const Scan &scan, const BodySurface &body, double robust, const BodyFitOptions &options,
                                const Context &context) {
  std::vector<Plane> planes(body.vertices.rows());
  parallel_for(context, static_cast<int>(planes.size()), [&](int i) {
    const Eigen::Vector3d point = body.vertices.row(i);
    const ClosestPoint at = scan.scene.closest(point);
    if (at.face < 0 || scan.face_label[at.face] == Label::Ignored)
      return;
    const Eigen::Vector3d normal = interpolated(scan.normals, scan.actor.mesh.faces, at);
    const double outside = normal.dot(point - at.point);
    const double area = body.areas[i] / kSampleArea, facing = normal.dot(body.normals.row(i).transpose());
    if (scan.face_label[at.face] == Label::Cloth) {
      if (facing < 0)
        return; // a hand beside a skirt is not under it
      // Outside: pushed in. Just inside: drawn a little, because cloth rests on the body somewhere and does not hover everywhere.
      const double beyond = outside + options.cloth_margin;
      const double weight = beyond > 0 ? kPushWeight * geman_mcclure(beyond, kPushScale)
                                       : options.cloth_attraction * geman_mcclure(beyond, options.outlier_scale);
      planes[i] = {i, at.point - options.cloth_margin * normal, normal, area * weight};
      return;
    }
    for (int k = 0; k < 3; ++k)
      if (!scan.exposed[scan.actor.mesh.faces(at.face, k)])
        return; // at the rim of the exposed part the closest point is only the nearest there is
    if (facing > kNormalCosine)
      planes[i] = {i, at.point, normal, area * geman_mcclure(at.distance, robust)};
  });
  return planes;
}

/// Exposed scan vertex -> nearest body vertex.
std::vector<Plane> scan_to_body(const Scan &scan, const BodySurface &body, double robust, const Context &context) {
  const NearestPoints nearest(body.vertices);
  std::vector<Plane> planes(scan.exposed.size());
  parallel_for(context, static_cast<int>(planes.size()), [&](int i) {
    if (!scan.exposed[i])
      return;
    const Eigen::Vector3d point = scan.actor.mesh.vertices.row(i), normal = scan.normals.row(i);
    const int vertex = nearest.nearest(point);
    if (normal.dot(body.normals.row(vertex).transpose()) < kNormalCosine)
      return;
    const double distance = normal.dot(body.vertices.row(vertex).transpose() - point);
    planes[i] = {vertex, point, normal, scan.areas[i] / kSampleArea * geman_mcclure(distance, robust)};
  });
  return planes;
}

BodySurface surface_of(const State &state, const BodyModel &model) {
  BodySurface body;
  body.vertices = state.world(model.vertices(state.coefficients));
  body.normals = vertex_normals(body.vertices, model.faces());
  body.areas = vertex_areas(body.vertices, model.faces());
  return body;
}

double exposed_residual(const Scan &scan, const Mesh &body, const Context &context) {
  const RayScene scene(body);
  std::vector<double> distance(scan.exposed.size(), 0.0);
  parallel_for(context, static_cast<int>(distance.size()), [&](int i) {
    if (scan.exposed[i])
      distance[i] = scene.closest(scan.actor.mesh.vertices.row(i).transpose()).distance;
  });
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (scan.exposed[i]) {
      sum += scan.areas[i] * distance[i];
      area += scan.areas[i];
    }
  return sum / area;
}

/// Everything about one of the scans.
struct Subject {
  Scan scan;
  std::vector<NamedPoint> named;
  State state;
  std::vector<int> unknown; ///< (7 + K) its unknowns among those of all scans: the shape comes first and is common
};

std::vector<int> unknowns_of(int subject, const BodyModel &model) {
  const int shape = model.shape_count(), own = 7 + model.component_count() - shape, first = shape + subject * own;
  std::vector<int> unknown(7 + model.component_count());
  std::iota(unknown.begin(), unknown.begin() + 7, first);
  std::iota(unknown.begin() + 7, unknown.begin() + 7 + shape, 0);
  std::iota(unknown.begin() + 7 + shape, unknown.end(), first + 7);
  return unknown;
}

class IcpBodyFitter : public BodyFitter {
public:
  explicit IcpBodyFitter(const BodyFitOptions &options) : options_(options) { options_.validate(); }

  BodyFit fit(const RiggedMesh &actor, const Segmentation &segmentation, const BodyModel &model,
              const std::map<std::string, Eigen::Vector3d> &landmarks, const Context &context) const override {
    return fit_together({{&actor, &segmentation, landmarks}}, model, context)[0];
  }

  std::vector<BodyFit> fit_together(const std::vector<ClothedScan> &scans, const BodyModel &model,
                                    const Context &context) const override {
    context.report_progress("body", 0.0);
    std::vector<Subject> subjects = prepare(scans, model);
    for (int iteration = 0; iteration < 10; ++iteration)
      move(subjects, equations(subjects, model, [](const Subject &, NormalEquations &) {}).solve());
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
      context.report_progress("body", 0.1 + 0.8 * iteration / options_.iterations);
      move(subjects, surface_equations(subjects, model, robust_scale(iteration), context).solve());
    }
    // What the last step left: the posterior of the unknowns around the answer (Laplace's approximation).
    const auto certainty = surface_equations(subjects, model, options_.outlier_scale, context).factor();
    std::vector<BodyFit> fits;
    for (const Subject &subject : subjects)
      fits.push_back(result(subject, model, certainty, context));
    context.report_progress("body", 1.0);
    return fits;
  }

private:
  std::vector<Subject> prepare(const std::vector<ClothedScan> &scans, const BodyModel &model) const {
    if (scans.empty())
      throw std::invalid_argument("body fit: expected at least one scan, found none");
    std::vector<Subject> subjects;
    for (std::size_t i = 0; i < scans.size(); ++i)
      try {
        Scan scan = prepare_scan(*scans[i].actor, *scans[i].segmentation);
        if (std::count(scan.exposed.begin(), scan.exposed.end(), 1) == 0)
          throw Error("body fit: no vertex of the actor is exposed (valid and clothness 0), nothing to fit to");
        std::vector<NamedPoint> named = match_names(*scans[i].actor, model, scans[i].landmarks, options_);
        State state = initial_state(model, named);
        subjects.push_back({std::move(scan), std::move(named), std::move(state), unknowns_of(static_cast<int>(i), model)});
      } catch (const Error &error) {
        if (scans.size() == 1)
          throw;
        throw Error("scan " + std::to_string(i) + ": " + error.what());
      }
    return subjects;
  }

  /// Five times the final scale at first, so that a pose that is centimetres off still finds its surface.
  double robust_scale(int iteration) const {
    const double progress = std::min(1.0, iteration / std::max(1.0, options_.iterations * 2.0 / 3.0));
    return options_.outlier_scale * std::pow(5.0, 1 - progress);
  }

  static void move(std::vector<Subject> &subjects, const Eigen::VectorXd &step) {
    for (Subject &subject : subjects)
      subject.state.move(step(subject.unknown));
  }

  /// The named points, the priors, and what `add_rest` adds of each subject.
  template <typename AddRest>
  NormalEquations equations(const std::vector<Subject> &subjects, const BodyModel &model, const AddRest &add_rest) const {
    const int shape = model.shape_count(), own = 7 + model.component_count() - shape;
    NormalEquations all(shape + static_cast<int>(subjects.size()) * own);
    for (int k = 0; k < shape; ++k)
      all.add_diagonal(k, subjects[0].state.coefficients[k], 1);
    for (const Subject &subject : subjects) {
      NormalEquations part(7 + model.component_count());
      add_rest(subject, part);
      add_named(part, subject.state, model, subject.named);
      add_prior(part, subject.state, options_.scale_deviation, shape);
      all.add(part, subject.unknown);
    }
    return all;
  }

  NormalEquations surface_equations(const std::vector<Subject> &subjects, const BodyModel &model, double robust,
                                    const Context &context) const {
    return equations(subjects, model, [&](const Subject &subject, NormalEquations &part) {
      const BodySurface body = surface_of(subject.state, model);
      std::vector<Plane> planes = body_to_scan(subject.scan, body, robust, options_, context);
      const std::vector<Plane> back = scan_to_body(subject.scan, body, robust, context);
      planes.insert(planes.end(), back.begin(), back.end());
      const BodyLinearisation at = model.linearise(subject.state.coefficients, all_vertices(model));
      const double certainty = 1 / (options_.surface_deviation * options_.surface_deviation);
      for (const Plane &plane : planes)
        if (plane.weight > 1e-6)
          part.add(point_row(subject.state, at, plane.vertex, plane.normal),
                   plane.normal.dot(body.vertices.row(plane.vertex).transpose() - plane.point), certainty * plane.weight);
    });
  }

  static std::vector<int> all_vertices(const BodyModel &model) {
    std::vector<int> all(model.vertex_count());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  static BodyFit result(const Subject &subject, const BodyModel &model, const Eigen::LLT<Eigen::MatrixXd> &certainty,
                        const Context &context) {
    BodyFit fit;
    fit.body = {subject.state.world(model.vertices(subject.state.coefficients)), model.faces()};
    if (!fit.body.vertices.allFinite())
      throw Error("body fit: diverged; the landmarks or joints do not fit the surface");
    fit.coefficients = subject.state.coefficients;
    fit.model = model.name();
    fit.residual = exposed_residual(subject.scan, fit.body, context);
    fit.deviation = deviations(subject, model, certainty, context);
    return fit;
  }

  /// (B) sqrt(trace(J covariance J^T)) of each vertex.
  static Eigen::VectorXd deviations(const Subject &subject, const BodyModel &model, const Eigen::LLT<Eigen::MatrixXd> &certainty,
                                    const Context &context) {
    const BodyLinearisation at = model.linearise(subject.state.coefficients, all_vertices(model));
    Eigen::VectorXd deviation(model.vertex_count());
    parallel_for(context, model.vertex_count(), [&](int v) {
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(certainty.rows(), 3);
      for (int axis = 0; axis < 3; ++axis)
        columns(subject.unknown, axis) = point_row(subject.state, at, v, Eigen::Vector3d::Unit(axis)).transpose();
      deviation[v] = certainty.matrixL().solve(columns).norm();
    });
    return deviation;
  }

  BodyFitOptions options_;
};

} // namespace

std::unique_ptr<BodyFitter> BodyFitter::create(const BodyFitOptions &options) {
  return std::make_unique<IcpBodyFitter>(options);
}

std::vector<BodyFit> BodyFitter::fit_together(const std::vector<ClothedScan> &, const BodyModel &, const Context &) const {
  throw std::logic_error("this body fitter takes one scan at a time");
}

std::vector<BodyRegion> body_regions(const BodyFit &fit, const RiggedMesh &actor, const Segmentation &segmentation) {
  const Scan scan = prepare_scan(actor, segmentation);
  require_body(fit, "body_regions");
  const RayScene scene(fit.body);
  const Anatomy anatomy = find_bones(fit.body, vertex_normals(fit.body.vertices, fit.body.faces), scene, actor.skeleton);
  const Eigen::VectorXd areas = vertex_areas(fit.body.vertices, fit.body.faces);
  std::vector<BodyRegion> of_joint(actor.skeleton.joint_count());
  std::vector<double> seen(of_joint.size(), 0);
  for (int v = 0; v < fit.body.vertices.rows(); ++v) {
    if (anatomy.nearest[v] < 0)
      continue;
    const int joint = anatomy.bones[anatomy.nearest[v]].joint;
    BodyRegion &region = of_joint[joint];
    const ClosestPoint at = scan.scene.closest(fit.body.vertices.row(v).transpose());
    region.area += areas[v];
    if (fit.deviation.size() > 0)
      region.deviation += areas[v] * fit.deviation[v] * fit.deviation[v];
    if (at.face >= 0 && scan.face_label[at.face] == Label::Exposed) {
      region.residual += areas[v] * at.distance;
      seen[joint] += areas[v];
    }
  }
  std::vector<BodyRegion> regions;
  for (int j = 0; j < actor.skeleton.joint_count(); ++j) {
    BodyRegion &region = of_joint[j];
    if (region.area == 0)
      continue;
    region.joint = actor.skeleton.joints[j].name;
    region.exposed = seen[j] / region.area;
    region.residual = seen[j] > 0 ? region.residual / seen[j] : 0;
    region.deviation = std::sqrt(region.deviation / region.area);
    regions.push_back(region);
  }
  return regions;
}

std::vector<std::uint8_t> body_under_cloth(const Mesh &body, const RiggedMesh &actor, const Segmentation &segmentation) {
  const Scan scan = prepare_scan(actor, segmentation);
  std::vector<std::uint8_t> under(body.vertices.rows(), 0);
  for (std::size_t i = 0; i < under.size(); ++i) {
    const ClosestPoint at = scan.scene.closest(body.vertices.row(i).transpose());
    under[i] = at.face >= 0 && scan.face_label[at.face] == Label::Cloth;
  }
  return under;
}

} // namespace doublet
