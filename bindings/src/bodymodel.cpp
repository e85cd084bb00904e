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
};

} // namespace

void bind_bodymodel(py::module_ &m) {
  py::class_<BodyModel, std::shared_ptr<BodyModel>>(m, "BodyModel", "vertices = mean + components s, s ~ N(0, I).")
      .def_static(
          "read", [](const std::filesystem::path &path) { return std::const_pointer_cast<BodyModel>(BodyModel::read(path)); },
          py::arg("path"), Release())
      .def_property_readonly("vertex_count", &BodyModel::vertex_count)
      .def_property_readonly("component_count", &BodyModel::component_count)
      .def_property_readonly("faces", &BodyModel::faces)
      .def_property_readonly("landmarks", &BodyModel::landmarks)
      .def_property_readonly("name", &BodyModel::name, "name and hash of the file")
      .def("vertices", &BodyModel::vertices, py::arg("coefficients"), "(B, 3) m")
      .def("component", &BodyModel::component, py::arg("k"), "(B, 3) m per standard deviation");
  OptionsClass<BodyFitOptions>(m, "BodyFitOptions", "Options of BodyFitter.")
      .field("iterations", &BodyFitOptions::iterations, "of ICP")
      .field("landmark_deviation", &BodyFitOptions::landmark_deviation, "m, how far a clicked landmark is trusted")
      .field("joint_deviation", &BodyFitOptions::joint_deviation, "m, how far a marked joint is trusted")
      .field("surface_deviation", &BodyFitOptions::surface_deviation, "m, of skin around the model, per 4 cm^2 of surface")
      .field("scale_deviation", &BodyFitOptions::scale_deviation, "relative, of the similarity's scale")
      .field("outlier_scale", &BodyFitOptions::outlier_scale, "m, of the robust weights (hair, shoes)")
      .field("cloth_margin", &BodyFitOptions::cloth_margin, "m, the body stays this far inside cloth");
  OptionsClass<ProxyOptions>(m, "ProxyOptions", "Options of fit_proxies.")
      .field("clearance", &ProxyOptions::clearance, "m, how far the capsules stay inside the body on average")
      .field("cloth_margin", &ProxyOptions::cloth_margin, "m, at least this far inside the cloth of the scan pose")
      .field("capsules_per_bone", &ProxyOptions::capsules_per_bone, "1 to 3")
      .field("iterations", &ProxyOptions::iterations, "of the least squares");
  py::class_<BodyFitter, PyBodyFitter>(m, "BodyFitter", "Stage: dressed surface -> body underneath. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &BodyFitter::create, py::arg("options") = BodyFitOptions{})
      .def("fit", &BodyFitter::fit, py::arg("actor"), py::arg("clothness"), py::arg("model"), py::arg("landmarks"),
           py::arg("context") = interruptible_context(), Release());
  m.def("fit_proxies", &fit_proxies, py::arg("fit"), py::arg("actor"), py::arg("clothness"), py::arg("options") = ProxyOptions{},
        Release());
}

} // namespace doublet::python
