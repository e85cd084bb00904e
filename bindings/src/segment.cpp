#include "common.h"

#include "doublet/segment/cloth_prior.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/corrections.h"
#include "doublet/segment/garment_mesher.h"
#include "doublet/segment/slack.h"
#include "doublet/testing/cloth_segmenter_conformance.h"
#include "doublet/testing/garment_mesher_conformance.h"

namespace doublet::python {
namespace {

class PyClothSegmenter : public ClothSegmenter {
public:
  Segmentation segment(const SegmentInputs &inputs, const Context &context) const override {
    return call_override<Segmentation>(static_cast<const ClothSegmenter *>(this), "ClothSegmenter.segment", "a Segmentation",
                                       inputs, context);
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
  Class<SegmentInputs>(m, "SegmentInputs", "Input of a ClothSegmenter; only the surface is required.")
      .def(py::init([](MeshSequence surface, Mask face_valid,
                       const std::optional<py::array_t<double, py::array::c_style | py::array::forcecast>> &canonical,
                       const std::optional<Vertices> &colours, Eigen::VectorXd prior, Eigen::VectorXd gap,
                       Eigen::VectorXi mirrored) {
             return SegmentInputs{std::move(surface),
                                  std::move(face_valid),
                                  canonical ? unstack(*canonical, "canonical") : std::vector<Vertices>(),
                                  colours.value_or(Vertices(0, 3)),
                                  std::move(prior),
                                  std::move(gap),
                                  std::move(mirrored)};
           }),
           py::arg("surface"), py::arg_v("face_valid", Mask{}, "[]"), py::arg("canonical") = std::nullopt,
           py::arg("colours") = std::nullopt, py::arg("prior") = Eigen::VectorXd(), py::arg("gap") = Eigen::VectorXd(),
           py::arg("mirrored") = Eigen::VectorXi())
      .def_readwrite("surface", &SegmentInputs::surface, "MeshSequence as captured; the first frame is the scan, or in its pose")
      .def_readwrite("face_valid", &SegmentInputs::face_valid, "(F) 0 = invented over a large hole; empty = all valid")
      .def_property(
          "canonical", [](const SegmentInputs &s) { return stack(s.canonical); },
          [](SegmentInputs &s, const py::array_t<double, py::array::c_style | py::array::forcecast> &frames) {
            s.canonical = unstack(frames, "canonical");
          },
          "(T, V, 3) m: the frames brought back to the scan pose (canonical_frames), or empty; a copy")
      .def_readwrite("colours", &SegmentInputs::colours,
                     "(F k, 3) B G R, 0 to 255, of k points of every face (sample_colours), NaN = unseen; or empty.")
      .def_readwrite("prior", &SegmentInputs::prior, "(V) prior log odds of cloth (cloth_prior); or empty = 0")
      .def_readwrite(
          "gap", &SegmentInputs::gap,
          "(V) m, distance of the scan from a body fitted inside it (cloth_slack with the scan for the only frame); or empty")
      .def_readwrite("mirrored", &SegmentInputs::mirrored,
                     "(V) the vertex on the body's other side (mirrored_vertices), -1 = none; or empty");
  m.def(
      "cloth_prior", &cloth_prior, py::arg("actor"), Release(),
      "(V) prior log odds of cloth by place on the body: below 0 on hands, feet, head and pieces not connected with the trunk; 0 "
      "elsewhere.");
  m.def("dressed_all_over", &dressed_all_over, py::arg("actor"), Release(),
        "Everything is cloth except hands, feet, head and pieces not connected with the trunk: a body that is fitted to this "
        "segmentation lies within the surface.");
  m.def("mirrored_vertices", &mirrored_vertices, py::arg("actor"), Release(),
        "(V) the mirror image of each vertex on the other side of the body, -1 = none. All -1 without joints l_... and r_....");
  Class<ClothSegmenter, PyClothSegmenter>(m, "ClothSegmenter", "Stage: captured surface -> segmentation. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &ClothSegmenter::create, py::arg("options") = SegmentOptions{},
                  "The built-in segmenter (docs/segmentation.md).")
      .def("segment", &ClothSegmenter::segment, py::arg("inputs"), py::arg("context") = interruptible_context(), Release(),
           "Labels of cloth and skin -> Segmentation. Raises ValueError for fewer than 2 frames or sizes that disagree, "
           "Error for an unusable mesh.");
  m.def(
      "segment_cloth",
      [](const MeshSequence &sequence, const Mask &face_valid, const SegmentOptions &options, const Context &context) {
        return segment_cloth({sequence, face_valid}, options, context);
      },
      py::arg("sequence"), py::arg("face_valid"), py::arg("options") = SegmentOptions{},
      py::arg("context") = interruptible_context(), Release(),
      "ClothSegmenter.create(options).segment(SegmentInputs(sequence, face_valid), context).");
  m.def(
      "segment_performance",
      [](const RiggedMesh &actor, const ReferencePerformance &performance, const ClothSegmenter &segmenter,
         const std::optional<Vertices> &colours, const std::optional<Mesh> &body, const Context &context) {
        return segment_performance(actor, performance, segmenter, colours.value_or(Vertices(0, 3)), body.value_or(Mesh()),
                                   context);
      },
      py::arg("actor"), py::arg("performance"), py::arg("segmenter"), py::arg("colours") = std::nullopt,
      py::arg("body") = std::nullopt, py::arg("context") = interruptible_context(), Release(),
      "The whole stage for a captured performance: computes canonical frames, prior and mirror images, then segments. colours: "
      "of its first frame, from sample_colours; body: fitted inside the scan (BodyFitter on dressed_all_over). Without them "
      "their terms are left out.");
  Class<SegmentSummary>(m, "SegmentSummary", "What a segmentation found.")
      .def_readonly("regions", &SegmentSummary::regions, "cloth regions")
      .def_readonly("cloth_area", &SegmentSummary::cloth_area, "m^2, clothness over a half")
      .def_readonly("transition_area", &SegmentSummary::transition_area, "m^2, clothness of at most a half, but not 0")
      .def_readonly("known_fraction", &SegmentSummary::known_fraction,
                    "share of the vertices on valid faces whose sigma is known")
      .def_readonly("noise", &SegmentSummary::noise, "m, 10 % quantile of sigma")
      .def_readonly("uncertain_area", &SegmentSummary::uncertain_area,
                    "share of the area with a probability of cloth from 0.1 to 0.9");
  m.def("summarise_segmentation", &summarise_segmentation, py::arg("pose"), py::arg("face_valid"), py::arg("segmentation"),
        Release(), "Areas, noise and certainty of a segmentation -> SegmentSummary. pose: actor.mesh.");
  m.def("apply_corrections", &apply_corrections, py::arg("pose"), py::arg("face_valid"), py::arg("found"), py::arg("painted"),
        Release(),
        "The segmentation `found` with corrections: painted (V) is -1 as found, 0 skin, 1 cloth, 2 a border between regions.");
  m.def("cloth_segmenter_violations", &testing::cloth_segmenter_violations, py::arg("segmenter"), Release(),
        "One sentence for each rule that a ClothSegmenter breaks: sizes, ranges, regions, the same bits twice, refusals.");
  m.def(
      "cloth_slack",
      [](const Mesh &body, const py::array_t<double, py::array::c_style | py::array::forcecast> &canonical,
         const Context &context) {
        const std::vector<Vertices> frames = unstack(canonical, "canonical");
        py::gil_scoped_release release;
        return cloth_slack(body, frames, context);
      },
      py::arg("body"), py::arg("canonical"), py::arg("context") = interruptible_context(),
      "(V) m: distance of the captured surface, transformed back to the scan pose (canonical_frames), outside the body that is "
      "exceeded in 5 % of the frames; 0 = on the body or inside it.");
  OptionsClass<GarmentOptions>(m, "Options of GarmentMesher.");
  Class<GarmentMesher, PyGarmentMesher>(m, "GarmentMesher", "Stage: segmentation -> the garment's mesh. Subclass to replace it.")
      .def(py::init<>())
      .def_static("create", &GarmentMesher::create, py::arg("options") = GarmentOptions{}, "The built-in mesher.")
      .def("mesh", &GarmentMesher::mesh, py::arg("actor"), py::arg("segmentation"), py::arg("body"), py::arg("captured"),
           py::arg("context") = interruptible_context(), Release(), "All cloth as a mesh of its own.");
  m.def("garment_mesher_violations", &testing::garment_mesher_violations, py::arg("mesher"), py::arg("actor"),
        py::arg("segmentation"), Release(),
        "One sentence for each rule that a GarmentMesher breaks on an actor of yours: it fits, the same bits twice, refusals.");
  m.def(
      "mesh_garment", &mesh_garment, py::arg("actor"), py::arg("segmentation"), py::arg("body"), py::arg("captured"),
      py::arg("options") = GarmentOptions{}, py::arg("context") = interruptible_context(), Release(),
      "GarmentMesher.create(options).mesh(...): all cloth that hangs free as a mesh of its own. body and captured may be empty.");
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
