#include "common.h"

#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/fullness.h"

namespace doublet::python {
namespace {

class PyClothSegmenter : public ClothSegmenter {
public:
  Clothness segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                    const Context &context) const override {
    PYBIND11_OVERRIDE_PURE(Clothness, ClothSegmenter, segment, sequence, face_valid, context);
  }
};

} // namespace

void bind_segment(py::module_ &m) {
  OptionsClass<SegmentOptions>(m, "SegmentOptions", "Options of ClothSegmenter.")
      .field("rigid_threshold", &SegmentOptions::rigid_threshold, "t_rigid, m: below, a vertex is rigid")
      .field("cloth_threshold", &SegmentOptions::cloth_threshold, "t_cloth, m: above, a vertex is cloth")
      .field("diffusion", &SegmentOptions::diffusion, "length scale of the diffusion, m")
      .field("smallest_region", &SegmentOptions::smallest_region, "smaller islands and holes are dropped, m^2");
  OptionsClass<FullnessOptions>(m, "FullnessOptions", "Options of estimate_fullness.")
      .field("estimate", &FullnessOptions::estimate, "off: the cloth is as wide as the scan")
      .field("quantile", &FullnessOptions::quantile, "over time, of the width that counts")
      .field("largest", &FullnessOptions::largest, "more is taken for a mistake of the tracking")
      .field("smoothing", &FullnessOptions::smoothing, "length scale of the diffusion over the surface, m");
  m.def("estimate_fullness", &estimate_fullness, py::arg("scan"), py::arg("face_valid"), py::arg("clothness"),
        py::arg("sequence"), py::arg("options") = FullnessOptions{}, py::arg("context") = interruptible_context(), Release());
  py::class_<ClothSegmenter, PyClothSegmenter>(m, "ClothSegmenter", "Stage: mesh sequence -> clothness. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &ClothSegmenter::create, py::arg("options") = SegmentOptions{})
      .def("segment", &ClothSegmenter::segment, py::arg("sequence"), py::arg("face_valid"),
           py::arg("context") = interruptible_context(), Release());
  m.def("segment_cloth", &segment_cloth, py::arg("sequence"), py::arg("face_valid"), py::arg("options") = SegmentOptions{},
        py::arg("context") = interruptible_context(), Release());
}

} // namespace doublet::python
