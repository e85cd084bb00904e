#include "common.h"

#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/fullness.h"
#include "doublet/segment/garment_mesher.h"
#include "doublet/testing/cloth_segmenter_conformance.h"

namespace doublet::python {
namespace {

class PyClothSegmenter : public ClothSegmenter {
public:
  Clothness segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                    const Context &context) const override {
    return call_override<Clothness>(static_cast<const ClothSegmenter *>(this), "ClothSegmenter.segment", "a Clothness", sequence,
                                    face_valid, context);
  }
};

class PyGarmentMesher : public GarmentMesher {
public:
  Garment mesh(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    return call_override<Garment>(static_cast<const GarmentMesher *>(this), "GarmentMesher.mesh", "a Garment", actor, clothness,
                                  body, captured, context);
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
        py::arg("sequence"), py::arg("options") = FullnessOptions{}, py::arg("context") = interruptible_context(), Release(),
        "(V) width of the cloth across gravity over that of the scan, at least 1; 1 on what is rigid.");
  py::class_<ClothSegmenter, PyClothSegmenter>(m, "ClothSegmenter", "Stage: mesh sequence -> clothness. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &ClothSegmenter::create, py::arg("options") = SegmentOptions{}, "The built-in segmenter (Sect. 5).")
      .def("segment", &ClothSegmenter::segment, py::arg("sequence"), py::arg("face_valid"),
           py::arg("context") = interruptible_context(), Release(), "How loose every vertex of the sequence is. face_valid (F).");
  m.def("segment_cloth", &segment_cloth, py::arg("sequence"), py::arg("face_valid"), py::arg("options") = SegmentOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "ClothSegmenter.create(options).segment(sequence, face_valid, context).");
  m.def("cloth_segmenter_violations", &testing::cloth_segmenter_violations, py::arg("segmenter"), Release(),
        "One sentence for each rule that a ClothSegmenter breaks: sizes, ranges, regions, the same bits twice, refusals.");
  OptionsClass<GarmentOptions>(m, "GarmentOptions", "Options of GarmentMesher.")
      .field("own_mesh", &GarmentOptions::own_mesh, "off: the cloth is the loose part of the template")
      .field("vertices", &GarmentOptions::vertices, "about, of all regions together")
      .field("closing", &GarmentOptions::closing, "narrower slits are closed, m")
      .field("smallest_hole", &GarmentOptions::smallest_hole, "smaller holes are filled, m^2")
      .field("smallest_piece", &GarmentOptions::smallest_piece, "smaller pieces move as skin, m^2")
      .field("smallest_edge", &GarmentOptions::smallest_edge, "shorter changes between hanging and free edge are noise, m")
      .field("spread", &GarmentOptions::spread, "share of the time that a length may be exceeded")
      .field("band", &GarmentOptions::band, "width of the attachment, m");
  py::class_<GarmentMesher, PyGarmentMesher>(m, "GarmentMesher",
                                             "Stage: clothness -> the garment's mesh. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &GarmentMesher::create, py::arg("options") = GarmentOptions{}, "The built-in mesher.")
      .def("mesh", &GarmentMesher::mesh, py::arg("actor"), py::arg("clothness"), py::arg("body"), py::arg("captured"),
           py::arg("context") = interruptible_context(), Release(), "All cloth as a mesh of its own.");
  m.def("mesh_garment", &mesh_garment, py::arg("actor"), py::arg("clothness"), py::arg("body"), py::arg("captured"),
        py::arg("options") = GarmentOptions{}, py::arg("context") = interruptible_context(), Release(),
        "All cloth of the actor as a mesh of its own, in one call.");
  py::class_<GarmentSummary>(m, "GarmentSummary", "What the mesher made.")
      .def_readonly("vertices", &GarmentSummary::vertices)
      .def_readonly("faces", &GarmentSummary::faces)
      .def_readonly("regions", &GarmentSummary::regions)
      .def_readonly("loops", &GarmentSummary::loops, "boundaries; a skirt has two")
      .def_readonly("hanging_loops", &GarmentSummary::hanging_loops, "that hang on the skeleton, at least in part")
      .def_readonly("mean_edge", &GarmentSummary::mean_edge, "m")
      .def_readonly("smallest_angle", &GarmentSummary::smallest_angle, "degrees, 1 % quantile");
  m.def("summarise_garment", &summarise_garment, py::arg("garment"), Release(), "Counts and quality of a garment's mesh.");
}

} // namespace doublet::python
