#include "common.h"

#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/detect_joints.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/bodymodel/train_body_model.h"
#include "doublet/testing/body_fitter_conformance.h"
#include "doublet/testing/body_model_conformance.h"

#include <algorithm>

namespace doublet::python {
namespace {

using Landmarks = std::map<std::string, Eigen::Vector3d>;

using Linearised = std::pair<Vertices, MatrixRM>;

/// What never changes comes from the constructor, so that C++ may keep references to it; the rest asks Python.
class PyBodyModel : public BodyModel {
public:
  PyBodyModel(int vertex_count, int component_count, Faces faces, std::map<std::string, int> landmarks, std::string name,
              std::optional<int> shape_count, std::vector<std::string> joint_names)
      : vertex_count_(vertex_count), component_count_(component_count), shape_count_(shape_count.value_or(component_count)),
        faces_(std::move(faces)), landmarks_(std::move(landmarks)), name_(std::move(name)), joint_names_(std::move(joint_names)) {
    const auto inside = [&](int v) { return v >= 0 && v < vertex_count; };
    if (vertex_count < 1 || component_count < 0 || shape_count_ < 0 || shape_count_ > component_count)
      throw std::invalid_argument("BodyModel: expected vertices, and 0 <= shape_count <= component_count, found " +
                                  std::to_string(vertex_count) + ", " + std::to_string(shape_count_) + " and " +
                                  std::to_string(component_count));
    if (!std::all_of(faces_.data(), faces_.data() + faces_.size(), inside))
      throw std::invalid_argument("BodyModel: faces must have indices in [0, " + std::to_string(vertex_count) + ")");
    for (const auto &[landmark, vertex] : landmarks_)
      if (!inside(vertex))
        throw std::invalid_argument("BodyModel: landmark '" + landmark + "' must be a vertex in [0, " +
                                    std::to_string(vertex_count) + "), found " + std::to_string(vertex));
  }
  int vertex_count() const override { return vertex_count_; }
  int component_count() const override { return component_count_; }
  int shape_count() const override { return shape_count_; }
  const Faces &faces() const override { return faces_; }
  const std::map<std::string, int> &landmarks() const override { return landmarks_; }
  std::string name() const override { return name_; }
  std::vector<std::string> joint_names() const override { return joint_names_; }
  Vertices vertices(const Eigen::VectorXd &coefficients) const override {
    return checked("vertices", call<Vertices>("vertices", "positions (B, 3)", coefficients), vertex_count_);
  }
  Vertices component(int k) const override {
    return checked("component", call<Vertices>("component", "displacements (B, 3)", k), vertex_count_);
  }
  BodyLinearisation linearise(const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) const override {
    if (!defines("linearise"))
      return BodyModel::linearise(coefficients, chosen);
    return checked("linearise", call<Linearised>("linearise", kPair, coefficients, chosen), chosen.size());
  }
  BodyLinearisation joints(const Eigen::VectorXd &coefficients) const override {
    if (!defines("joints"))
      return BodyModel::joints(coefficients);
    return checked("joints", call<Linearised>("joints", kPair, coefficients), joint_names_.size());
  }

private:
  static constexpr const char *kPair = "points (n, 3) and their jacobian (3n, K)";
  bool defines(const char *method) const {
    const py::gil_scoped_acquire gil;
    return static_cast<bool>(py::get_override(static_cast<const BodyModel *>(this), method));
  }
  template <class R, class... Arguments>
  R call(const std::string &method, const char *expected, const Arguments &...arguments) const {
    return call_override<R>(static_cast<const BodyModel *>(this), "BodyModel." + method, expected, arguments...);
  }
  static void require_rows(const std::string &method, const char *what, Eigen::Index found, std::size_t expected) {
    if (found != static_cast<Eigen::Index>(expected))
      throw std::invalid_argument("BodyModel." + method + " must return " + std::to_string(expected) + " " + what + ", found " +
                                  std::to_string(found));
  }
  static Vertices checked(const std::string &method, Vertices points, std::size_t count) {
    require_rows(method, "points", points.rows(), count);
    return points;
  }
  BodyLinearisation checked(const std::string &method, Linearised result, std::size_t count) const {
    require_rows(method, "points", result.first.rows(), count);
    require_rows(method, "rows of the jacobian", result.second.rows(), 3 * count);
    require_rows(method, "columns of the jacobian", result.second.cols(), component_count_);
    return {std::move(result.first), std::move(result.second)};
  }

  int vertex_count_, component_count_, shape_count_;
  Faces faces_;
  std::map<std::string, int> landmarks_;
  std::string name_;
  std::vector<std::string> joint_names_;
};

class PyBodyFitter : public BodyFitter {
public:
  BodyFit fit(const RiggedMesh &actor, const Segmentation &segmentation, const BodyModel &model, const Landmarks &landmarks,
              const Context &context) const override {
    // The model by pointer: it is passed on, not copied.
    return call_override<BodyFit>(static_cast<const BodyFitter *>(this), "BodyFitter.fit", "a BodyFit", actor, segmentation,
                                  &model, landmarks, context);
  }
  std::vector<BodyFit> fit_together(const std::vector<ClothedScan> &scans, const BodyModel &model,
                                    const Context &context) const override {
    PYBIND11_OVERRIDE_IMPL(std::vector<BodyFit>, BodyFitter, "fit_together", scans, &model, context);
    return BodyFitter::fit_together(scans, model, context);
  }
};

void bind_marks(py::module_ &m) {
  Class<DetectedJoints>(m, "DetectedJoints", "Joints and landmarks of a surface without annotations.")
      .def_readonly("joints", &DetectedJoints::joints, "the standard joints, JointAnnotation")
      .def_readonly("landmarks", &DetectedJoints::landmarks, "name -> point on the body, m")
      .def_readonly("fit", &DetectedJoints::fit, "the body that they were read from")
      .def_readonly("facing_ambiguity", &DetectedJoints::facing_ambiguity,
                    "distance between body and surface, divided by that of the body fitted to face the other way: near 1 = front "
                    "and back are ambiguous");
  m.def("detect_joints", &detect_joints, py::arg("surface"), py::arg("face_valid"), py::arg("model"),
        py::arg("options") = BodyFitOptions{}, py::arg("seen") = std::map<std::string, Eigen::Vector3d>{},
        py::arg("context") = interruptible_context(), Release(),
        "Joints and landmarks of a person, upright (+Y), by fitting the body model. face_valid: 0 = invented, empty = all valid; "
        "seen: joints whose positions are known to 3 cm, name -> (3) m; without them arms and legs must be apart.");
}

void bind_regions(py::module_ &m) {
  Class<BodyRegion>(m, "BodyRegion", "How far a fit can be trusted along one bone.")
      .def_readonly("joint", &BodyRegion::joint, "at which the bone begins")
      .def_readonly("area", &BodyRegion::area, "m^2 of the body")
      .def_readonly("exposed", &BodyRegion::exposed, "share of it whose nearest surface is skin")
      .def_readonly("residual", &BodyRegion::residual, "m, mean distance of that skin to the body")
      .def_readonly("deviation", &BodyRegion::deviation, "m, expected RMS error");
  m.def("body_regions", &body_regions, py::arg("fit"), py::arg("actor"), py::arg("segmentation"), Release(),
        "One BodyRegion per bone: how far the fit can be trusted there.");
}

void bind_proxy_statistics(py::module_ &m) {
  Class<ProxyStatistics>(m, "ProxyStatistics", "How well the capsules approximate the body under cloth, m.")
      .def_readonly("capsules", &ProxyStatistics::capsules, "their number")
      .def_readonly("samples", &ProxyStatistics::samples, "body vertices under cloth")
      .def_readonly("mean_distance", &ProxyStatistics::mean_distance,
                    "m, mean |signed distance| of body vertices under cloth to the union of capsules")
      .def_readonly("percentile95", &ProxyStatistics::percentile95, "m, 95 % quantile of the same")
      .def_readonly("largest_bulge", &ProxyStatistics::largest_bulge,
                    "m, largest distance by which a capsule protrudes from the body; 0 = none")
      .def_readonly("cloth_clearance", &ProxyStatistics::cloth_clearance,
                    "m, smallest signed distance of the resting cloth to the capsules; negative = pushed");
  m.def("proxy_statistics", &proxy_statistics, py::arg("capsules"), py::arg("fit"), py::arg("actor"), py::arg("segmentation"),
        Release(), "Distances between capsules and body under the cloth -> ProxyStatistics.");
}

void bind_training(py::module_ &m) {
  OptionsClass<TrainOptions>(m, "Options of train_body_model.");
  Class<TrainSummary>(m, "TrainSummary", "What a training kept.")
      .def_readonly("meshes", &TrainSummary::meshes, "of the population")
      .def_readonly("vertices", &TrainSummary::vertices, "of each")
      .def_readonly("components", &TrainSummary::components, "of shape that were kept")
      .def_readonly("variance_kept", &TrainSummary::variance_kept, "fraction")
      .def_readonly("reconstruction_mm", &TrainSummary::reconstruction_mm, "mean vertex error of the training set");
  m.def("train_body_model", &train_body_model, py::arg("population"), py::arg("out"), py::arg("options") = TrainOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Registered meshes (POPULATION.npz) -> statistical body model (MODEL.npz).");
}

} // namespace

void bind_bodymodel(py::module_ &m) {
  Class<BodyModel, PyBodyModel, std::shared_ptr<BodyModel>>(
      m, "BodyModel",
      "vertices = mean + components s, s ~ N(0, I). To replace it, define vertices(coefficients) and component(k) in a subclass; "
      "a "
      "model that is not linear also linearise(coefficients, chosen), one with a skeleton joints(coefficients).")
      .def(py::init<int, int, Faces, std::map<std::string, int>, std::string, std::optional<int>, std::vector<std::string>>(),
           py::kw_only(), py::arg("vertex_count"), py::arg("component_count"), py::arg("faces"),
           py::arg("landmarks") = std::map<std::string, int>(), py::arg("name") = "python", py::arg("shape_count") = std::nullopt,
           py::arg("joint_names") = std::vector<std::string>(),
           "For subclasses. faces (F, 3); landmarks: name -> vertex; shape_count: number of shape coefficients, which come "
           "first, None = all.")
      .def_static(
          "read", [](const std::filesystem::path &path) { return std::const_pointer_cast<BodyModel>(BodyModel::read(path)); },
          py::arg("path"), Release(),
          "A model in this library's format or SMPL's (.npz). Raises FileNotFoundError, or Error naming file and array.")
      .def_property_readonly("vertex_count", &BodyModel::vertex_count, "B")
      .def_property_readonly("component_count", &BodyModel::component_count, "C, of shape")
      .def_property_readonly("shape_count", &BodyModel::shape_count,
                             "number of shape coefficients, which come first; the others are the pose")
      .def_property_readonly("faces", &BodyModel::faces, "(FB, 3)")
      .def_property_readonly("landmarks", &BodyModel::landmarks, "name -> vertex of the body")
      .def_property_readonly("name", &BodyModel::name, "name and hash of the file")
      .def_property_readonly("joint_names", &BodyModel::joint_names, "of the model's own skeleton; empty = none")
      .def("vertices", &BodyModel::vertices, py::arg("coefficients"), Release(), "(B, 3) m")
      .def("component", &BodyModel::component, py::arg("k"), Release(), "(B, 3) m per standard deviation")
      .def(
          "linearise",
          [](const BodyModel &model, const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) {
            for (const int vertex : chosen)
              if (vertex < 0 || vertex >= model.vertex_count())
                throw std::invalid_argument("BodyModel.linearise: chosen: expected vertices in [0, " +
                                            std::to_string(model.vertex_count()) + "), found " + std::to_string(vertex));
            const BodyLinearisation at = model.linearise(coefficients, chosen);
            return std::pair(at.points, at.jacobian);
          },
          py::arg("coefficients"), py::arg("chosen"), Release(),
          "The chosen vertices (n, 3) m and their derivatives (3n, K) m per standard deviation.")
      .def(
          "joints",
          [](const BodyModel &model, const Eigen::VectorXd &coefficients) {
            const BodyLinearisation at = model.joints(coefficients);
            return std::pair(at.points, at.jacobian);
          },
          py::arg("coefficients"), Release(), "The same of the model's own joints, in the order of joint_names.");
  m.def("body_model_violations", &testing::body_model_violations, py::arg("model"), Release(),
        "One sentence for each rule that a BodyModel breaks: counts, indices, derivatives, the same bits twice, refusals.");
  OptionsClass<BodyFitOptions>(m, "Options of BodyFitter.");
  OptionsClass<ProxyOptions>(m, "Options of fit_proxies.");
  Class<ClothedScan>(m, "ClothedScan", "One of several scans of the same person.")
      .def(py::init([](const RiggedMesh &actor, const Segmentation &segmentation, const Landmarks &landmarks) {
             return ClothedScan{&actor, &segmentation, landmarks};
           }),
           py::arg("actor"), py::arg("segmentation"), py::arg("landmarks"), py::keep_alive<1, 2>(), py::keep_alive<1, 3>())
      .def_property_readonly(
          "actor", [](const ClothedScan &scan) { return scan.actor; }, py::return_value_policy::reference,
          "RiggedMesh in the scan pose")
      .def_property_readonly(
          "segmentation", [](const ClothedScan &scan) { return scan.segmentation; }, py::return_value_policy::reference,
          "Segmentation of the actor")
      .def_readonly("landmarks", &ClothedScan::landmarks, "name -> point on the surface, m");
  Class<BodyFitter, PyBodyFitter>(m, "BodyFitter", "Stage: dressed surface -> body under the clothes. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &BodyFitter::create, py::arg("options") = BodyFitOptions{}, "The built-in fitter.")
      .def("fit", &BodyFitter::fit, py::arg("actor"), py::arg("segmentation"), py::arg("model"), py::arg("landmarks"),
           py::arg("context") = interruptible_context(), Release(), "The body under the clothes. landmarks: name -> point, m.")
      .def("fit_together", &BodyFitter::fit_together, py::arg("scans"), py::arg("model"),
           py::arg("context") = interruptible_context(), Release(), "One shape, and one pose per scan -> list of BodyFit.");
  m.def("body_fitter_violations", &testing::body_fitter_violations, py::arg("fitter"), py::arg("actor"), py::arg("segmentation"),
        py::arg("model"), py::arg("landmarks"), Release(),
        "One sentence for each rule that a BodyFitter breaks on a scan of yours: sizes, finite, the same bits twice, refusals.");
  m.def("fit_proxies", &fit_proxies, py::arg("fit"), py::arg("actor"), py::arg("segmentation"),
        py::arg("options") = ProxyOptions{}, Release(),
        "Tapered capsules along the bones, inside the body: what cloth collides with.");
  bind_marks(m);
  bind_regions(m);
  bind_proxy_statistics(m);
  bind_training(m);
}

} // namespace doublet::python
