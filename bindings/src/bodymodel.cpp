#include "common.h"

#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/train_body_model.h"

namespace doublet::python {
namespace {

using Landmarks = std::map<std::string, Eigen::Vector3d>;

class PyBodyFitter : public BodyFitter {
public:
  BodyFit fit(const RiggedMesh &actor, const Clothness &clothness, const BodyModel &model, const Landmarks &landmarks,
              const Context &context) const override {
    // The model by pointer: it is passed on, not copied.
    PYBIND11_OVERRIDE_PURE(BodyFit, BodyFitter, fit, actor, clothness, &model, landmarks, context);
  }
  std::vector<BodyFit> fit_together(const std::vector<DressedScan> &scans, const BodyModel &model,
                                    const Context &context) const override {
    PYBIND11_OVERRIDE_IMPL(std::vector<BodyFit>, BodyFitter, "fit_together", scans, &model, context);
    return BodyFitter::fit_together(scans, model, context);
  }
};

void bind_regions(py::module_ &m) {
  py::class_<BodyRegion>(m, "BodyRegion", "How far a fit can be trusted along one bone.")
      .def_readonly("joint", &BodyRegion::joint, "that the bone hangs from")
      .def_readonly("area", &BodyRegion::area, "m^2 of the body")
      .def_readonly("exposed", &BodyRegion::exposed, "share of it whose nearest surface is skin")
      .def_readonly("residual", &BodyRegion::residual, "m, mean distance of that skin to the body")
      .def_readonly("deviation", &BodyRegion::deviation, "m, expected RMS error");
  m.def("body_regions", &body_regions, py::arg("fit"), py::arg("actor"), py::arg("clothness"), Release(),
        "One BodyRegion a bone: how far the fit can be trusted there.");
}

void bind_proxy_statistics(py::module_ &m) {
  py::class_<ProxyStatistics>(m, "ProxyStatistics", "How well the capsules stand for the body under cloth, m.")
      .def_readonly("capsules", &ProxyStatistics::capsules)
      .def_readonly("samples", &ProxyStatistics::samples)
      .def_readonly("mean_distance", &ProxyStatistics::mean_distance)
      .def_readonly("percentile95", &ProxyStatistics::percentile95)
      .def_readonly("largest_bulge", &ProxyStatistics::largest_bulge)
      .def_readonly("cloth_clearance", &ProxyStatistics::cloth_clearance);
  m.def("proxy_statistics", &proxy_statistics, py::arg("capsules"), py::arg("fit"), py::arg("actor"), py::arg("clothness"),
        Release(), "How far capsules and body are apart under the cloth.");
}

void bind_training(py::module_ &m) {
  OptionsClass<TrainOptions>(m, "Options of train_body_model.");
  py::class_<TrainSummary>(m, "TrainSummary", "What a training kept.")
      .def_readonly("meshes", &TrainSummary::meshes)
      .def_readonly("vertices", &TrainSummary::vertices)
      .def_readonly("components", &TrainSummary::components)
      .def_readonly("variance_kept", &TrainSummary::variance_kept, "fraction")
      .def_readonly("reconstruction_mm", &TrainSummary::reconstruction_mm, "mean vertex error of the training set");
  m.def("train_body_model", &train_body_model, py::arg("population"), py::arg("out"), py::arg("options") = TrainOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Registered meshes (POPULATION.npz) -> statistical body model (MODEL.npz).");
}

} // namespace

void bind_bodymodel(py::module_ &m) {
  py::class_<BodyModel, std::shared_ptr<BodyModel>>(m, "BodyModel", "vertices = mean + components s, s ~ N(0, I).")
      .def_static(
          "read", [](const std::filesystem::path &path) { return std::const_pointer_cast<BodyModel>(BodyModel::read(path)); },
          py::arg("path"), Release(),
          "A model in this library's format or SMPL's (.npz). Raises FileNotFoundError, or Error naming file and array.")
      .def_property_readonly("vertex_count", &BodyModel::vertex_count)
      .def_property_readonly("component_count", &BodyModel::component_count)
      .def_property_readonly("shape_count", &BodyModel::shape_count, "the first coefficients; the others are the pose")
      .def_property_readonly("faces", &BodyModel::faces)
      .def_property_readonly("landmarks", &BodyModel::landmarks)
      .def_property_readonly("name", &BodyModel::name, "name and hash of the file")
      .def("vertices", &BodyModel::vertices, py::arg("coefficients"), "(B, 3) m")
      .def("component", &BodyModel::component, py::arg("k"), "(B, 3) m per standard deviation");
  OptionsClass<BodyFitOptions>(m, "Options of BodyFitter.");
  OptionsClass<ProxyOptions>(m, "Options of fit_proxies.");
  py::class_<DressedScan>(m, "DressedScan", "One of several scans of the same person.")
      .def(py::init([](const RiggedMesh &actor, const Clothness &clothness, const Landmarks &landmarks) {
             return DressedScan{&actor, &clothness, landmarks};
           }),
           py::arg("actor"), py::arg("clothness"), py::arg("landmarks"), py::keep_alive<1, 2>(), py::keep_alive<1, 3>())
      .def_property_readonly(
          "actor", [](const DressedScan &scan) { return scan.actor; }, py::return_value_policy::reference)
      .def_property_readonly(
          "clothness", [](const DressedScan &scan) { return scan.clothness; }, py::return_value_policy::reference)
      .def_readonly("landmarks", &DressedScan::landmarks, "name -> point on the surface, m");
  py::class_<BodyFitter, PyBodyFitter>(m, "BodyFitter", "Stage: dressed surface -> body underneath. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &BodyFitter::create, py::arg("options") = BodyFitOptions{}, "The built-in fitter.")
      .def("fit", &BodyFitter::fit, py::arg("actor"), py::arg("clothness"), py::arg("model"), py::arg("landmarks"),
           py::arg("context") = interruptible_context(), Release(), "The body under the clothes. landmarks: name -> point, m.")
      .def("fit_together", &BodyFitter::fit_together, py::arg("scans"), py::arg("model"),
           py::arg("context") = interruptible_context(), Release(), "One shape, a pose a scan; a list of BodyFit.");
  m.def("fit_proxies", &fit_proxies, py::arg("fit"), py::arg("actor"), py::arg("clothness"), py::arg("options") = ProxyOptions{},
        Release(), "Tapered capsules along the bones, inside the body: what cloth collides with.");
  bind_regions(m);
  bind_proxy_statistics(m);
  bind_training(m);
}

} // namespace doublet::python
