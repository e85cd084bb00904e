#include "common.h"

#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/corrections.h"
#include "doublet/segment/fullness.h"
#include "doublet/segment/garment_mesher.h"
#include "doublet/testing/cloth_segmenter_conformance.h"
#include "doublet/testing/garment_mesher_conformance.h"

namespace doublet::python {
namespace {

class PyClothSegmenter : public ClothSegmenter {
public:
  Segmentation segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                       const Context &context) const override {
    return call_override<Segmentation>(static_cast<const ClothSegmenter *>(this), "ClothSegmenter.segment", "a Segmentation",
                                       sequence, face_valid, context);
  }
};

class PyGarmentMesher : public GarmentMesher {
public:
  Garment mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    return call_override<Garment>(static_cast<const GarmentMesher *>(this), "GarmentMesher.mesh", "a Garment", actor,
                                  segmentation, body, captured, context);
  }
};

} // namespace

void bind_segment(py::module_ &m) {
  OptionsClass<OppositeOptions>(m, "The rays by which ClothSegmenter measures.");
  OptionsClass<SegmentOptions>(m, "Options of ClothSegmenter.");
  OptionsClass<FullnessOptions>(m, "Options of estimate_fullness.");
  m.def("estimate_fullness", &estimate_fullness, py::arg("scan"), py::arg("face_valid"), py::arg("segmentation"),
        py::arg("sequence"), py::arg("options") = FullnessOptions{}, py::arg("context") = interruptible_context(), Release(),
        "(V) width of the cloth across gravity over that of the scan, at least 1; 1 on what is rigid.");
  Class<ClothSegmenter, PyClothSegmenter>(m, "ClothSegmenter", "Stage: mesh sequence -> segmentation. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &ClothSegmenter::create, py::arg("options") = SegmentOptions{}, "The built-in segmenter (Sect. 5).")
      .def("segment", &ClothSegmenter::segment, py::arg("sequence"), py::arg("face_valid"),
           py::arg("context") = interruptible_context(), Release(), "How loose every vertex of the sequence is. face_valid (F).");
  m.def("segment_cloth", &segment_cloth, py::arg("sequence"), py::arg("face_valid"), py::arg("options") = SegmentOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "ClothSegmenter.create(options).segment(sequence, face_valid, context).");
  m.def("fitting_thresholds", &fitting_thresholds, py::arg("pose"), py::arg("face_valid"), py::arg("sigma"),
        py::arg("options") = SegmentOptions{}, Release(),
        "The options, with both thresholds raised while all of the surface moves: the noise of a poor capture.");
  m.def("segmented_pose", &segmented_pose, py::arg("actor"), py::arg("performance"), Release(),
        "The first frame if it is in the scan's pose, otherwise the actor's mesh: what a segmentation is made in -> Mesh.");
  m.def("segment_performance", &segment_performance, py::arg("actor"), py::arg("performance"), py::arg("segmenter"),
        py::arg("fullness") = FullnessOptions{}, py::arg("context") = interruptible_context(), Release(),
        "The whole stage for a captured performance: frames brought back to the scan pose, segmentation, fullness.");
  m.def("corrected_segmentation", &corrected_segmentation, py::arg("pose"), py::arg("face_valid"), py::arg("found"),
        py::arg("painted"), Release(),
        "What was found, with a person's corrections: painted (V) is -1 as found, 0 skin, 1 cloth, 2 a seam between regions.");
  m.def("cloth_segmenter_violations", &testing::cloth_segmenter_violations, py::arg("segmenter"), Release(),
        "One sentence for each rule that a ClothSegmenter breaks: sizes, ranges, regions, the same bits twice, refusals.");
  OptionsClass<GarmentOptions>(m, "Options of GarmentMesher.");
  Class<GarmentMesher, PyGarmentMesher>(m, "GarmentMesher", "Stage: segmentation -> the garment's mesh. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &GarmentMesher::create, py::arg("options") = GarmentOptions{}, "The built-in mesher.")
      .def("mesh", &GarmentMesher::mesh, py::arg("actor"), py::arg("segmentation"), py::arg("body"), py::arg("captured"),
           py::arg("context") = interruptible_context(), Release(), "All cloth as a mesh of its own.");
  m.def("garment_mesher_violations", &testing::garment_mesher_violations, py::arg("mesher"), py::arg("actor"),
        py::arg("segmentation"), Release(),
        "One sentence for each rule that a GarmentMesher breaks on an actor of yours: it fits, the same bits twice, refusals.");
  m.def("mesh_garment", &mesh_garment, py::arg("actor"), py::arg("segmentation"), py::arg("body"), py::arg("captured"),
        py::arg("options") = GarmentOptions{}, py::arg("context") = interruptible_context(), Release(),
        "All cloth of the actor as a mesh of its own, in one call.");
  Class<GarmentSummary>(m, "GarmentSummary", "What the mesher made.")
      .def_readonly("vertices", &GarmentSummary::vertices, "of the garment's mesh")
      .def_readonly("faces", &GarmentSummary::faces, "of the garment's mesh")
      .def_readonly("regions", &GarmentSummary::regions, "cloth regions")
      .def_readonly("loops", &GarmentSummary::loops, "boundaries; a skirt has two")
      .def_readonly("hanging_loops", &GarmentSummary::hanging_loops, "that hang on the skeleton, at least in part")
      .def_readonly("mean_edge", &GarmentSummary::mean_edge, "m")
      .def_readonly("smallest_angle", &GarmentSummary::smallest_angle, "degrees, 1 % quantile");
  m.def("summarise_garment", &summarise_garment, py::arg("garment"), Release(), "Counts and quality of a garment's mesh.");
}

} // namespace doublet::python
