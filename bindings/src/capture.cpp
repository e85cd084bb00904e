#include "common.h"

#include "doublet/capture/calibration_file.h"
#include "doublet/capture/heat_weights.h"
#include "doublet/capture/measured_observations.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/person_calibration.h"
#include "doublet/capture/rest_pose.h"
#include "doublet/capture/scan_alignment.h"
#include "doublet/capture/scan_from_views.h"
#include "doublet/capture/session_check.h"
#include "doublet/capture/start_frame.h"
#include "doublet/capture/template_builder.h"
#include "doublet/capture/triangulation.h"

namespace doublet::python {
namespace {

constexpr const char *kMask = "a uint8 array (H, W), 255 = actor, or (0, 0) for none";

class PySilhouetteExtractor : public SilhouetteExtractor {
public:
  void train(int camera, const std::vector<Image> &images) override {
    PYBIND11_OVERRIDE_PURE(void, SilhouetteExtractor, train, camera, images);
  }
  void learn_actor(int camera, const std::vector<Image> &images) override {
    PYBIND11_OVERRIDE(void, SilhouetteExtractor, learn_actor, camera, images);
  }
  Image extract(int camera, const Image &image) const override {
    return call_override<Image>(this, "SilhouetteExtractor.extract", kMask, camera, image);
  }
  Image refine(int camera, const Image &image, const Image &mask) const override {
    const py::gil_scoped_acquire gil;
    if (!py::get_override(static_cast<const SilhouetteExtractor *>(this), "refine"))
      return mask;
    return call_override<Image>(this, "SilhouetteExtractor.refine", kMask, camera, image, mask);
  }
};

/// (n, 3) pixel and confidence.
std::vector<Keypoint> to_keypoints(const Vertices &rows) {
  std::vector<Keypoint> keypoints;
  for (const auto &row : rows.rowwise())
    keypoints.push_back({row.head<2>(), row.z()});
  return keypoints;
}

Vertices to_rows(const std::vector<Keypoint> &keypoints) {
  Vertices rows(keypoints.size(), 3);
  for (std::size_t i = 0; i < keypoints.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) << keypoints[i].pixel.transpose(), keypoints[i].confidence;
  return rows;
}

class PyFrameSource : public FrameSource {
public:
  int frame_count() const override { return count("frame_count"); }
  int camera_count() const override { return count("camera_count"); }
  Image image(int camera, int frame) override {
    return call_override<Image>(this, "FrameSource.image", "a uint8 array (H, W, 3), or (0, 0) for none", camera, frame);
  }
  Image mask(int camera, int frame) override { return call_override<Image>(this, "FrameSource.mask", kMask, camera, frame); }
  std::vector<Keypoint> keypoints(int camera, int frame) override {
    const py::gil_scoped_acquire gil;
    if (!py::get_override(static_cast<const FrameSource *>(this), "keypoints"))
      return FrameSource::keypoints(camera, frame);
    const char *expected = "a float array (12, 3), or (0, 3) for none";
    return to_keypoints(call_override<Vertices>(this, "FrameSource.keypoints", expected, camera, frame));
  }

private:
  /// A property of the subclass.
  int count(const char *name) const {
    const py::gil_scoped_acquire gil;
    const py::object self = py::cast(static_cast<const FrameSource *>(this), py::return_value_policy::reference);
    if (py::type::of(self).attr(name).is(py::type::of<FrameSource>().attr(name)))
      throw std::runtime_error(std::string("FrameSource.") + name + " is not defined by the subclass");
    const py::object found = self.attr(name);
    if (!PyLong_Check(found.ptr()) && !PyIndex_Check(found.ptr()))
      throw py::type_error(std::string("FrameSource.") + name + " must be a whole number, found " + described(found));
    return found.cast<int>();
  }
};

/// __init_subclass__ of FrameSource: the counts are properties; methods of their name, as one once wrote them, become some.
void make_counts_properties(const py::object &subclass, const py::kwargs &keywords) {
  const py::module_ builtins = py::module_::import("builtins");
  for (const char *name : {"frame_count", "camera_count"}) {
    const py::dict own = builtins.attr("dict")(subclass.attr("__dict__"));
    if (!own.contains(name) || !PyFunction_Check(own[name].ptr()))
      continue;
    const std::string text = subclass.attr("__name__").cast<std::string>() + "." + name +
                             " as a method is deprecated: make it a property, as it is of every FrameSource";
    if (PyErr_WarnEx(PyExc_DeprecationWarning, text.c_str(), 1) != 0)
      throw py::error_already_set();
    py::setattr(subclass, name, builtins.attr("property")(own[name]));
  }
  builtins.attr("super")(py::type::of<FrameSource>(), subclass).attr("__init_subclass__")(**keywords);
}

class PyPerformanceCapture : public PerformanceCapture {
public:
  CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                        const Context &context) override {
    // By pointer: frames and extractor are passed on, not copied.
    return call_override<CaptureResult>(static_cast<const PerformanceCapture *>(this), "PerformanceCapture.capture",
                                        "a CaptureResult", actor, rig, &frames, extractor, context);
  }
};

void bind_calibration(py::module_ &m) {
  OptionsClass<CalibrationOptions>(m, "Options of read_calibration.");
  Class<Lens>(m, "Lens", "A lens that Camera.distortion cannot describe: images are undistorted when a session reads them.")
      .def(py::init<>())
      .def_readwrite("fisheye", &Lens::fisheye, "OpenCV's fisheye model; otherwise its extensions of Brown's")
      .def_readwrite("distortion", &Lens::distortion, "fisheye: k1 .. k4; otherwise 8, 12 or 14 terms; empty = none")
      .def_property_readonly("needs_undistortion", &Lens::needs_undistortion, "false: Camera.distortion is sufficient");
  Class<CalibratedCamera>(m, "CalibratedCamera", "A camera as it was calibrated, and its lens.")
      .def(py::init([](Camera camera, Lens lens, int late) {
             return CalibratedCamera{std::move(camera), std::move(lens), late};
           }),
           py::arg("camera"), py::arg("lens") = Lens{}, py::arg("late") = 0)
      .def_readwrite("camera", &CalibratedCamera::camera, "its distortion is zero if the lens needs undistortion")
      .def_readwrite("lens", &CalibratedCamera::lens, "undistorted when frames are read")
      .def_readwrite("late", &CalibratedCamera::late,
                     "delay in frames: its frame t + late shows the same moment as frame t of the others")
      .def("project", &CalibratedCamera::project, py::arg("point"),
           "Pixel of a world point (3), m, in the original (distorted) image.")
      .def("project_jacobian", &CalibratedCamera::project_jacobian, py::arg("point"), "(2, 3) pixels per metre.");
  py::implicitly_convertible<Camera, CalibratedCamera>();
  m.def(
      "triangulate",
      [](const std::vector<CalibratedCamera> &cameras, const Vertices &seen) { return triangulate(cameras, to_keypoints(seen)); },
      py::arg("cameras"), py::arg("seen"), Release(),
      "(3) m: the point on which the largest set of cameras agrees, or None if no two do. seen: (C, 3) pixel and confidence in "
      "each camera; points with a confidence below 0.3 are ignored.");
  m.def("read_calibration", &read_calibration, py::arg("path"), py::arg("options") = CalibrationOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Cameras of OpenCV, COLMAP, EasyMocap, Pose2Sim, Caliscope, anipose, Qualisys, Panoptic Studio, Metashape, Nerfstudio or "
        "ActorsHQ, or of a calibration.yml, in metres and with +Y up. The context's log says which were left out.");
  m.def("write_calibration", &write_calibration, py::arg("path"), py::arg("cameras"), Release(),
        "Writes calibration.yml of a session, atomically; also accepts Camera objects.");
}

/// seen (T, joints, 3) pixel and confidence; silhouettes T arrays (n, 2), or none.
PersonView person_view(const std::string &name, std::pair<int, int> size,
                       const py::array_t<double, py::array::c_style | py::array::forcecast> &seen, double focal,
                       std::vector<std::vector<Eigen::Vector2d>> silhouettes) {
  if (seen.ndim() != 3 || seen.shape(1) != kKeypoints || seen.shape(2) != 3)
    throw std::invalid_argument("PersonView: seen: expected an array (T, " + std::to_string(kKeypoints) + ", 3)");
  PersonView view{name, size.first, size.second, focal, {}, std::move(silhouettes)};
  const auto at = seen.template unchecked<3>();
  for (py::ssize_t t = 0; t < seen.shape(0); ++t)
    for (py::ssize_t j = 0; j < kKeypoints; ++j)
      view.seen.push_back({{at(t, j, 0), at(t, j, 1)}, at(t, j, 2)});
  return view;
}

void bind_person_calibration(py::module_ &m) {
  OptionsClass<PersonCalibrationOptions>(m, "Options of calibrate_from_person.");
  Class<PersonView>(m, "PersonView", "What one camera shows of a person.")
      .def(py::init(&person_view), py::arg("name"), py::arg("size"), py::arg("seen"), py::arg("focal") = 0.0,
           py::arg("silhouettes") = std::vector<std::vector<Eigen::Vector2d>>{},
           "size: width and height, px. seen: (T, 12, 3) pixel and confidence of doublet.session.keypoints.JOINTS. focal: px, 0 "
           "= not known. "
           "silhouettes: of each frame corners of a hull (n, 2), none where it is not known.")
      .def_property_readonly(
          "name", [](const PersonView &view) { return view.name; }, "of the camera");
  Class<PersonCamera>(m, "PersonCamera", "Result for one camera.")
      .def_readonly("agreeing", &PersonCamera::agreeing,
                    "share of its keypoints within three expected errors of the projected joints")
      .def_readonly("error", &PersonCamera::error, "px, median of these")
      .def_readonly("tangent_error", &PersonCamera::tangent_error,
                    "m, median distance, at the person, between the tangent planes of two cameras; NaN without silhouettes");
  Class<PersonCalibration>(m, "PersonCalibration", "Cameras calibrated from one person.")
      .def_readonly("rig", &PersonCalibration::rig, "m, +Y up, the floor at y = 0")
      .def_readonly("cameras", &PersonCalibration::cameras, "one PersonCamera each")
      .def_readonly("joints", &PersonCalibration::joints, "(12 moments, 3) m; NaN where no two cameras agree")
      .def_readonly("frames", &PersonCalibration::frames, "of the moments");
  m.def("calibrate_from_person", &calibrate_from_person, py::arg("views"), py::arg("options") = PersonCalibrationOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Calibrates static cameras from joints and silhouettes of one person who moves in front of them.");
  m.def("silhouette_hull", &silhouette_hull, py::arg("mask"), Release(),
        "Corners (n, 2) px of the convex hull of a mask (H, W) uint8; empty if it is, or if it touches a border.");
}

void bind_session(py::module_ &m) {
  Class<SessionCamera>(m, "SessionCamera", "One camera of a session and its files.")
      .def(py::init<>())
      .def_readwrite("name", &SessionCamera::name, "of the camera")
      .def_readwrite("video", &SessionCamera::video, "mp4 or printf pattern of images; empty if there are only masks")
      .def_readwrite("masks", &SessionCamera::masks, "the same kinds; empty = silhouettes are computed from the video")
      .def_readwrite("background", &SessionCamera::background, "image of the empty stage or pattern of several; empty = none")
      .def_readwrite("first_frame", &SessionCamera::first_frame, "of video and masks: frame 0 of the session")
      .def_readwrite("late", &SessionCamera::late, "frames, as CalibratedCamera.late")
      .def_readonly("video_fps", &SessionCamera::video_fps, "as stated in the video's container; 0 = not stated");
  Class<Session>(m, "Session", "A capture session on disk, checked as a whole.")
      .def_copies()
      .def("__repr__",
           [](const Session &session) {
             return py::str("Session({!r}, {} cameras, {} frames at {:.6g} fps)")
                 .format(session.name, session.cameras.size(), session.frame_count, session.fps);
           })
      .def(py::init<>(), "An empty session, to be filled by hand, that need not exist on disk.")
      .def(py::init(&read_session), py::arg("folder"), Release())
      .def("recalibrated", &recalibrated, py::arg("calibration"), Release(),
           "The session with the cameras of another calibration.yml, such as the refined one of a capture.")
      .def_readwrite("folder", &Session::folder, "absolute")
      .def_readwrite("name", &Session::name, "of the session")
      .def_readwrite("fps", &Session::fps, "frames a second")
      .def_readwrite("frame_count", &Session::frame_count, "of every camera")
      .def_readwrite("cameras", &Session::cameras, "SessionCameras")
      .def_readwrite("rig", &Session::rig, "a Camera for each of `cameras`")
      .def_readwrite("lenses", &Session::lenses, "undistorted when images are read; one per camera")
      .def_readwrite("scan", &Session::scan, "absolute; empty if there is none")
      .def_readwrite("scan_from_views", &Session::scan_from_views, "whether `doublet scan` made the scan from the views")
      .def_readwrite("calibration", &Session::calibration, "absolute")
      .def_readwrite("markers", &Session::markers, "joints.json, absolute; empty if there is none")
      .def_readwrite("joints", &Session::joints, "JointAnnotations of joints.json")
      .def_readwrite("landmarks", &Session::landmarks, "name -> (3) m, clicked on the body's surface")
      .def_readwrite("new_motion", &Session::new_motion, "absolute; empty if there is none")
      .def_readwrite("keypoints", &Session::keypoints, "keypoints.npz, absolute; empty if there is none");
  Class<FrameSource, PyFrameSource> source(m, "FrameSource", "Swap point: where the images and masks come from.");
  const py::cpp_function init_subclass(&make_counts_properties, py::name("__init_subclass__"));
  source.attr("__init_subclass__") = py::reinterpret_steal<py::object>(PyClassMethod_New(init_subclass.ptr()));
  source.def(py::init<>())
      .def_static("open", &FrameSource::open, py::arg("session"), Release(), "Images and masks of a session, read on demand.")
      .def_property_readonly("frame_count", &FrameSource::frame_count, "of each camera")
      .def_property_readonly("camera_count", &FrameSource::camera_count, "of the session")
      .def("image", &FrameSource::image, py::arg("camera"), py::arg("frame"), Release(), "(H, W, 3) uint8, BGR")
      .def("mask", &FrameSource::mask, py::arg("camera"), py::arg("frame"), Release(), "(H, W) uint8, 255 = actor")
      .def(
          "keypoints", [](FrameSource &frames, int camera, int frame) { return to_rows(frames.keypoints(camera, frame)); },
          py::arg("camera"), py::arg("frame"), Release(),
          "(12, 3) pixel and confidence of doublet.session.keypoints.JOINTS; (0, 3) if there are none.");
  OptionsClass<ChromaKeyOptions>(m, "Options of the built-in SilhouetteExtractor.");
  OptionsClass<BackgroundOptions>(m, "Options of silhouettes by the difference to a background.");
  OptionsClass<SilhouetteOptions>(m, "How silhouettes of a session are computed.");
  Class<SilhouetteExtractor, PySilhouetteExtractor>(m, "SilhouetteExtractor", "Swap point: image -> mask (255 = actor).")
      .def(py::init<>())
      .def_static("create", py::overload_cast<const ChromaKeyOptions &>(&SilhouetteExtractor::create),
                  py::arg("options") = ChromaKeyOptions{}, "By a key colour.")
      .def_static("create", py::overload_cast<const BackgroundOptions &>(&SilhouetteExtractor::create), py::arg("options"),
                  "By the difference to a background.")
      .def("train", &SilhouetteExtractor::train, py::arg("camera"), py::arg("images"), Release(),
           "Trains on a few images of one camera; called once per camera, before extract().")
      .def("learn_actor", &SilhouetteExtractor::learn_actor, py::arg("camera"), py::arg("images"), Release(),
           "Learns the actor's appearance from a few images of the take, after train(); may do nothing.")
      .def("extract", &SilhouetteExtractor::extract, py::arg("camera"), py::arg("image"), Release(), "Mask (H, W), 255 = actor.")
      .def("refine", &SilhouetteExtractor::refine, py::arg("camera"), py::arg("image"), py::arg("mask"), Release(),
           "A ready mask (H, W) with its outline refined to the edge in the image; default: the mask as it is.");
  m.def("session_silhouettes", &session_silhouettes, py::arg("session"), py::arg("frames"),
        py::arg("options") = SilhouetteOptions{}, py::arg("context") = interruptible_context(), Release(),
        "A trained extractor for cameras without ready masks, or whose masks are refined (mask_error); None if no camera needs "
        "one.");
  m.def("require_scanned", &require_scanned, py::arg("session"), "Raises if the session has no scan or no joints.");
  Class<CameraView>(m, "CameraView", "What a camera shows at a frame.")
      .def(py::init([](Image image, Image mask) {
             return CameraView{std::move(image), std::move(mask)};
           }),
           py::arg("image") = Image{}, py::arg("mask") = Image{})
      .def_property_readonly(
          "image", [](const CameraView &view) { return view.image; }, "(H, W, 3) uint8, BGR; (0, 0) = nothing")
      .def_property_readonly(
          "mask", [](const CameraView &view) { return view.mask; }, "(H, W) uint8, 255 = actor; (0, 0) = none");
  m.def("read_view", &read_view, py::arg("frames"), py::arg("camera"), py::arg("frame"), py::arg("extractor") = nullptr,
        Release(),
        "The image, and the ready mask as refined by the extractor or, without one, the extractor's mask -> CameraView.");
  Class<FrameViews>(m, "FrameViews", "What all cameras of a session show at a frame.")
      .def_readonly("images", &FrameViews::images, "(H, W, 3) uint8, BGR, or empty; one per camera")
      .def_readonly("masks", &FrameViews::masks, "(H, W) uint8, 255 = actor, or empty; one per camera");
  m.def("read_views", &read_views, py::arg("session"), py::arg("frame"), py::arg("extractor") = nullptr, Release(),
        "read_view for every camera -> FrameViews.");
  Class<StartFrame>(m, "StartFrame", "The frame in which a take is most similar to the scan.")
      .def_readonly("frame", &StartFrame::frame, "of the frame source")
      .def_readonly("overlap", &StartFrame::overlap,
                    "IoU of the silhouettes with those of the scan placed there, mean over the cameras")
      .def_readonly("first_overlap", &StartFrame::first_overlap, "the same in frame 0")
      .def_property_readonly("in_scan_pose", &StartFrame::in_scan_pose, "tracking begins there at once: overlap 0.8")
      .def_property_readonly("near_scan_pose", &StartFrame::near_scan_pose, "near enough to search the pose: overlap 0.4")
      .def_property_readonly(
          "world_from_scan", [](const StartFrame &start) { return MatrixRM(start.world_from_scan.matrix()); },
          "(4, 4): where the scan is placed");
  m.def("find_start_frame", &find_start_frame, py::arg("scan"), py::arg("rig"), py::arg("frames"),
        py::arg("extractor").none(true) = nullptr, py::arg("context") = interruptible_context(), Release(),
        "Frame 0 if it is in the scan's pose, moved and turned about the vertical, otherwise the frame that comes nearest -> "
        "StartFrame.");
  OptionsClass<ViewScanOptions>(m, "Options of scan_from_views.");
  m.def(
      "scan_from_views",
      [](const CameraRig &rig, const std::vector<CameraView> &views, const ViewScanOptions &options, const Context &context,
         const Mesh *body) {
        return body ? scan_from_views(rig, views, *body, options, context) : scan_from_views(rig, views, options, context);
      },
      py::arg("rig"), py::arg("views"), py::arg("options") = ViewScanOptions{}, py::arg("context") = interruptible_context(),
      py::arg("body") = nullptr, Release(),
      "Visual hull of the masks, moved inwards where cameras agree -> Mesh, open where it faces down and no camera sees it. "
      "views: one CameraView per camera, of one frame; body: a fitted one, from which the surface is no farther than the "
      "outlines are.");
  Class<AlignedScan>(m, "AlignedScan", "A scan in the world of the cameras, and what was detected about it.")
      .def_readonly("mesh", &AlignedScan::mesh, "m, +Y up; without floor, specks and surroundings")
      .def_readonly("unit", &AlignedScan::unit, "of the scan: 'm', 'cm', 'mm' or 'inches'")
      .def_readonly("up", &AlignedScan::up, "its axis that points up: '+x' ... '-z'")
      .def_readonly("floor", &AlignedScan::floor, "it contained a floor, which was removed")
      .def_readonly("distance", &AlignedScan::distance, "m to the hull, mean over the nearest four fifths of the surface");
  m.def("align_scan", &align_scan, py::arg("scan"), py::arg("hull"), py::arg("context") = interruptible_context(), Release(),
        "Aligns a scan, in any unit and with any up axis, to the visual hull of the cameras (scan_from_views) -> AlignedScan.");
  OptionsClass<RestPoseOptions>(m, "Options of refine_rest_pose.");
  m.def("refine_rest_pose", &refine_rest_pose, py::arg("actor"), py::arg("performance"), py::arg("rigid"),
        py::arg("options") = RestPoseOptions{}, py::arg("context") = interruptible_context(), Release(),
        "(V, 3) m: the actor's vertices in the rest pose, with the skin (rigid (V) = 1) moved to its median position in the "
        "least bent frames.");
}

void bind_session_check(py::module_ &m) {
  Class<SessionCheck>(m, "SessionCheck", "What is wrong with a session, and the frame of C cameras in which it was checked.")
      .def_readonly("findings", &SessionCheck::findings, "Findings, in the order of the checks")
      .def_readonly("start", &SessionCheck::start, "StartFrame if the scan does not fit frame 0 as placed; or None")
      .def_readonly("start_text", &SessionCheck::start_text, "the same in words; may be empty")
      .def_property_readonly("frame", &SessionCheck::frame, "in which the session was checked")
      .def_readonly("rig", &SessionCheck::rig, "(C) the cameras, resized to at most 500 pixels")
      .def_readonly("silhouettes", &SessionCheck::silhouettes, "(C) masks (h, w), 255 = actor; (0, 0) = none")
      .def_readonly("shadows", &SessionCheck::shadows, "(C) the same of the scan; empty without one")
      .def_readonly(
          "overlaps", &SessionCheck::overlaps,
          "(C, C) IoU of the measured silhouette of camera i with the scan's in camera j, or NaN; (0, 0) without a scan")
      .def_readonly("joints", &SessionCheck::joints, "(J, 3) m, placed as the scan is");
  m.def("check_session", &check_session, py::arg("session"), py::arg("frames"), py::arg("extractor").none(true) = nullptr,
        py::arg("context") = interruptible_context(), Release(),
        "Checks the plausibility of a session: scan, joints, calibration, frame rates and silhouettes against each other -> "
        "SessionCheck.");
}

void bind_template(py::module_ &m) {
  OptionsClass<TemplateOptions>(m, "Options of build_template.");
  OptionsClass<HeatWeightOptions>(m, "Options of heat_weights.");
  Class<Template>(m, "Template", "The closed surface of a scan, its two decimations and the invented faces.")
      .def(py::init<>())
      .def_readwrite("mesh", &Template::mesh, "M, which is tracked and simulated")
      .def_readwrite("high", &Template::high, "M_high, what is displayed")
      .def_readwrite("face_valid", &Template::face_valid, "(F) 0 = suggested as invented over a large hole")
      .def_readwrite("high_face_valid", &Template::high_face_valid, "(FH) the same of M_high");
  Class<SurfaceQuality>(m, "SurfaceQuality", "Quality of a surface of the template.")
      .def_readonly("triangles", &SurfaceQuality::triangles, "of the surface")
      .def_readonly("self_intersections", &SurfaceQuality::self_intersections, "triangles that pass through another one")
      .def_readonly("invalid_area", &SurfaceQuality::invalid_area, "m^2")
      .def_readonly("smallest_angle", &SurfaceQuality::smallest_angle, "degrees, over all triangles")
      .def_readonly("first_centile_angle", &SurfaceQuality::first_centile_angle,
                    "degrees, 1 % quantile of the triangles' smallest angles")
      .def_readonly("scan_mean", &SurfaceQuality::scan_mean, "m, distance of the scan's vertices to the surface")
      .def_readonly("scan_max", &SurfaceQuality::scan_max, "m, the largest of them")
      .def_readonly("mean_to_scan", &SurfaceQuality::mean_to_scan, "m, distance of the valid surface to the scan")
      .def_readonly("max_to_scan", &SurfaceQuality::max_to_scan, "m, the largest of them");
  Class<TemplateSummary>(m, "TemplateSummary", "Quality of both surfaces of a template.")
      .def_readonly("mesh", &TemplateSummary::mesh, "SurfaceQuality of M")
      .def_readonly("high", &TemplateSummary::high, "SurfaceQuality of M_high");
  m.def("build_template", &build_template, py::arg("scan"), py::arg("options") = TemplateOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "The closed surface of a scan, its two decimations and the faces that were invented over holes.");
  m.def("summarise_template", &summarise_template, py::arg("surface"), py::arg("scan"),
        py::arg("context") = interruptible_context(), Release(),
        "Quality of both surfaces of a template, and their distances to the scan.");
  m.def("write_template_suggestion", &write_template_suggestion, py::arg("path"), py::arg("surface"), Release(),
        "template_suggestion.npz: the masks of both surfaces.");
  m.def("heat_weights", &heat_weights, py::arg("mesh"), py::arg("face_valid"), py::arg("skeleton"),
        py::arg("options") = HeatWeightOptions{}, py::arg("context") = interruptible_context(), Release(),
        "(V, J) skin weights by heat equilibrium; rows sum to one.");
  m.def("rig_template", &rig_template, py::arg("surface"), py::arg("joints"), py::arg("context") = interruptible_context(),
        Release(), "Skeleton from the marked joints and skin weights -> RiggedMesh.");
  m.def("read_mesh", &read_mesh, py::arg("path"), Release(),
        ".ply, .obj, .stl or .off: vertices and faces; polygons become fans of triangles. Raises FileNotFoundError, or Error "
        "naming the file.");
  m.def("write_mesh", &write_mesh, py::arg("path"), py::arg("mesh"), Release(),
        "Writes .ply, .obj, .stl or .off, by the extension, atomically.");
}

void bind_performance(py::module_ &m) {
  OptionsClass<CaptureOptions>(m, "Options of PerformanceCapture.")
      .get()
      .def_readwrite("checkpoint", &CaptureOptions::checkpoint,
                     "file from which an interrupted capture resumes, with the same bits; empty = none");
  Class<LostLimb>(m, "LostLimb", "A limb that the local optimisation had lost.")
      .def(py::init<>())
      .def_readwrite("frame", &LostLimb::frame, "video frame number")
      .def_readwrite("limb", &LostLimb::limb, "name of its first joint")
      .def_readwrite("before", &LostLimb::before, "m, error after the local optimisation")
      .def_readwrite("after", &LostLimb::after, "m, error of the pose that was kept")
      .def_readwrite("recovered", &LostLimb::recovered, "was it found again?");
  Class<JointVisibility>(m, "JointVisibility", "Number of frames in which a joint's bone was seen, inferred, lost.")
      .def(py::init<>())
      .def_readwrite("joint", &JointVisibility::joint, "name of one with degrees of freedom")
      .def_readwrite("seen", &JointVisibility::seen, "enough of it visible that moves with the skeleton")
      .def_readwrite("inferred", &JointVisibility::inferred, "hidden; it follows from the joints before and after it")
      .def_readwrite("lost", &JointVisibility::lost, "its limb was lost and not found again");
  Class<RefinedCamera>(m, "RefinedCamera", "Refinement of one camera by the take.")
      .def(py::init<>())
      .def_readwrite("camera", &RefinedCamera::camera, "its name")
      .def_readwrite("seen", &RefinedCamera::seen, "it shows the actor in some moment")
      .def_readwrite("moved", &RefinedCamera::moved, "m, RMS shift of the actor's outlines relative to the given camera")
      .def_readwrite("sure", &RefinedCamera::sure, "m, standard deviation of `moved`")
      .def_readwrite("turned", &RefinedCamera::turned, "degrees")
      .def_readwrite("shifted", &RefinedCamera::shifted, "m, of the centre")
      .def_readwrite("focal", &RefinedCamera::focal, "change as a share")
      .def_readwrite("late", &RefinedCamera::late, "frames by which it shows a motion later than the others")
      .def_readwrite("delay", &RefinedCamera::delay, "whole frames of `late` that were corrected")
      .def_readwrite("late_sure", &RefinedCamera::late_sure, "frames, standard deviation of `late`");
  Class<CaptureSummary>(m, "CaptureSummary", "Quality and times of a capture.")
      .def(py::init<>())
      .def_readwrite("rim_px", &CaptureSummary::rim_px, "(T) mean residual of the outlines, pixels")
      .def_readwrite("keypoint_distance", &CaptureSummary::keypoint_distance,
                     "(T) m, mean distance of joints from their keypoints; NaN where there are none")
      .def_readwrite("sift_px", &CaptureSummary::sift_px, "(T) mean residual of the features, pixels")
      .def_readwrite("silhouette_iou", &CaptureSummary::silhouette_iou, "(T) mean over cameras, against the measured masks")
      .def_numbers_readwrite("views", &CaptureSummary::views, "(T) cameras that took part")
      .def_readwrite("jitter_before", &CaptureSummary::jitter_before, "rad, mean |second difference| of the joint angles")
      .def_readwrite("jitter_after", &CaptureSummary::jitter_after, "the same after smoothing")
      .def_readwrite("lost_limbs", &CaptureSummary::lost_limbs, "in the order of frames")
      .def_readwrite("start_frame", &CaptureSummary::start_frame, "video frame from which tracking went both ways")
      .def_readwrite("joints", &CaptureSummary::joints, "those with degrees of freedom")
      .def_readwrite("cameras", &CaptureSummary::cameras, "RefinedCamera for each; empty if refinement was off")
      .def_readwrite("cameras_refined", &CaptureSummary::cameras_refined,
                     "performance and observations are of the refined cameras")
      .def_readwrite("measure_seconds", &CaptureSummary::measure_seconds, "s: images to outlines, features and their matches")
      .def_readwrite("map_seconds", &CaptureSummary::map_seconds, "s: features lifted to the surface and matched with the map")
      .def_readwrite("pose_seconds", &CaptureSummary::pose_seconds, "s: poses")
      .def_readwrite("limb_seconds", &CaptureSummary::limb_seconds, "s: the check of limbs and the search for lost ones")
      .def_readwrite("surface_seconds", &CaptureSummary::surface_seconds, "s: surfaces")
      .def_readwrite("seconds_per_frame", &CaptureSummary::seconds_per_frame, "s, of the whole run");
  Class<CaptureResult>(m, "CaptureResult", "Performance, observations and summary of a capture.")
      .def(py::init<>())
      .def_readwrite("performance", &CaptureResult::performance, "ReferencePerformance")
      .def_readwrite("observations", &CaptureResult::observations, "what was measured in the images")
      .def_readwrite("summary", &CaptureResult::summary, "CaptureSummary");
  m.def("filmed", &filmed, py::arg("session"), py::arg("captured"), Release(),
        "The session with the cameras that the capture used: the refined ones if there are any, with their delays corrected.");
  m.def("measure_observations", &measure_observations, py::arg("rig"), py::arg("frames"), py::arg("extractor") = nullptr,
        py::arg("numbers") = std::vector<int>{}, py::arg("tracker") = nullptr, py::arg("options") = FeatureTrackerOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Observations of a take without tracking it, as the capture measures them: outlines of the frames `numbers` (empty = "
        "all) and, with a FeatureTracker, feature matches with the previous frame. extractor: trained, for frames without a "
        "ready mask.");
  Class<PerformanceCapture, PyPerformanceCapture>(m, "PerformanceCapture", "Stage: video -> reference performance.")
      .def(py::init<>())
      .def_static(
          "create",
          [](const CaptureOptions &options, const CaptureParts &parts) { return PerformanceCapture::create(options, parts); },
          py::arg("options") = CaptureOptions{}, py::arg("parts") = CaptureParts{},
          "The built-in capture; `parts` replaces parts of it.")
      .def("capture", &PerformanceCapture::capture, py::arg("actor"), py::arg("rig"), py::arg("frames"),
           py::arg("extractor").none(true) = nullptr, py::arg("context") = interruptible_context(), Release(),
           "Tracks all frames. extractor: None if all cameras have masks.");
}

} // namespace

void bind_capture(py::module_ &m) {
  bind_calibration(m);
  bind_person_calibration(m);
  bind_session(m);
  bind_session_check(m);
  bind_template(m);
  bind_capture_parts(m);
  bind_performance(m);
}

} // namespace doublet::python
