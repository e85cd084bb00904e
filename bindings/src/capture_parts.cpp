// The pieces of a capture that Python may replace: features, pose, lost limbs, surface.
#include "common.h"

#include "doublet/capture/performance_capture.h"
#include "doublet/testing/capture_conformance.h"

namespace doublet::python {
namespace {

using Floats2 = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;

class PyFeatureTracker : public FeatureTracker {
public:
  Features detect(const Image &image, const Image &mask) const override {
    return call_override<Features>(this, "FeatureTracker.detect", "Features", image, mask);
  }
  std::vector<std::pair<int, int>> match(const Features &previous, const Features &current, double reach) const override {
    return call_override<std::vector<std::pair<int, int>>>(this, "FeatureTracker.match", "pairs of indices (N, 2)", previous,
                                                           current, reach);
  }
};

/// A copy of a problem for Python, which may keep it: when the call ends its pointers do, too.
template <class Problem> class Lent {
public:
  /// A copy in every case: one that is lent already must outlive this call.
  explicit Lent(const Problem &problem) : object(py::cast(Problem(problem))), problem_(object.cast<Problem *>()) {}
  Lent(const Lent &) = delete;
  Lent &operator=(const Lent &) = delete;
  ~Lent() {
    problem_->actor = nullptr;
    problem_->rig = nullptr;
    if constexpr (requires { problem_->outlines; })
      problem_->outlines = nullptr;
    else
      problem_->masks = nullptr;
  }
  const py::object object;

private:
  Problem *problem_;
};

/// What a problem points to, while it does.
template <class T> const T &pointed(const T *pointer) {
  if (!pointer)
    throw std::invalid_argument("a problem is valid only during the call that receives it; copy what is needed later");
  return *pointer;
}

class PyPoseOptimizer : public PoseOptimizer {
public:
  PoseEstimate optimize(const PoseProblem &problem, const Context &context) override {
    const py::gil_scoped_acquire gil;
    const Lent<PoseProblem> lent(problem);
    return call_override<PoseEstimate>(this, "PoseOptimizer.optimize", "a PoseEstimate", lent.object, context);
  }
};

class PySurfaceRefiner : public SurfaceRefiner {
public:
  SurfaceEstimate refine(const SurfaceProblem &problem, const Context &context) override {
    const py::gil_scoped_acquire gil;
    const Lent<SurfaceProblem> lent(problem);
    return call_override<SurfaceEstimate>(this, "SurfaceRefiner.refine", "a SurfaceEstimate", lent.object, context);
  }
};

class PyLimbSearch : public LimbSearch {
public:
  Eigen::VectorXd search(const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &lost,
                         const Context &context) override {
    const py::gil_scoped_acquire gil;
    const Lent<LimbProblem> lent(problem);
    return call_override<Eigen::VectorXd>(this, "LimbSearch.search", "a pose (D)", lent.object, dofs, lost, context);
  }
};

Floats2 as_rows(const std::vector<Eigen::Vector2f> &points) {
  Floats2 rows(points.size(), 2);
  for (std::size_t i = 0; i < points.size(); ++i)
    rows.row(i) = points[i];
  return rows;
}

Features make_features(const Floats2 &points, MatrixRM descriptors) {
  if (points.rows() != descriptors.rows())
    throw std::invalid_argument("Features: expected one descriptor per point, found " + std::to_string(points.rows()) +
                                " points and " + std::to_string(descriptors.rows()) + " descriptors");
  Features features;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    features.points.emplace_back(points.row(i));
  features.descriptors = std::move(descriptors);
  return features;
}

void bind_features(py::module_ &m) {
  OptionsClass<FeatureTrackerOptions>(m, "Options of the SIFT feature tracker.");
  Class<Features>(m, "Features", "Features of one image.")
      .def(py::init(&make_features), py::arg("points"), py::arg("descriptors"))
      .def_property_readonly(
          "points", [](const Features &f) { return as_rows(f.points); }, "(N, 2) pixels")
      .def_readonly("descriptors", &Features::descriptors, "(N, C); closeness is Euclidean distance");
  Class<FeatureTracker, PyFeatureTracker>(m, "FeatureTracker", "Swap point: image -> features, features -> matches.")
      .def(py::init<>())
      .def_static("create", &FeatureTracker::create, py::arg("options") = FeatureTrackerOptions{}, "The built-in tracker (SIFT).")
      .def("detect", &FeatureTracker::detect, py::arg("image"), py::arg("mask"), Release(),
           "Features of an image (H, W, 3) inside its mask (H, W). Called from many threads.")
      .def("match", &FeatureTracker::match, py::arg("previous"), py::arg("current"), py::arg("reach"), Release(),
           "Pairs (index in previous, index in current) no farther apart than `reach` pixels. Called from many threads.");
}

void bind_problems(py::module_ &m) {
  Class<Outline>(m, "Outline", "Boundary of a mask, N points.")
      .def_property_readonly(
          "points", [](const Outline &o) { return as_rows(o.points); }, "(N, 2) pixels")
      .def_property_readonly(
          "normals", [](const Outline &o) { return as_rows(o.normals); }, "(N, 2) unit, out of the mask");
  m.def("trace_outline", static_cast<Outline (*)(const Image &, int)>(&trace_outline), py::arg("mask"), py::arg("margin") = 2,
        Release(), "Boundary of a mask (H, W).");
  Class<SurfaceTrack>(m, "SurfaceTrack", "A surface point and the pixel where it is seen.")
      .def_readonly("view", &SurfaceTrack::view, "camera")
      .def_property_readonly(
          "face", [](const SurfaceTrack &track) { return track.surface.face; }, "of the surface")
      .def_property_readonly(
          "barycentric", [](const SurfaceTrack &track) { return track.surface.barycentric; }, "(3) of that face's corners")
      .def_readonly("pixel", &SurfaceTrack::pixel, "(2) where the point is seen")
      .def_readonly("weight", &SurfaceTrack::weight, "against the other tracks");
  Class<SeenPoint>(m, "SeenPoint", "A point that moves with a joint of the skeleton, and its observed position.")
      .def_readonly("joint", &SeenPoint::joint, "index of the joint that moves it")
      .def_readonly("rest", &SeenPoint::rest, "(3) m, in the rest pose")
      .def_readonly("seen", &SeenPoint::seen, "(3) m, in the world")
      .def_readonly("tolerance", &SeenPoint::tolerance, "m, error of the observation: within this distance there is no residual");
  Class<ViewTiming>(m, "ViewTiming", "Delays of cameras by fractions of a frame.")
      .def_readonly("late", &ViewTiming::late, "(C) frames by which each shows an earlier moment; (0) = none does")
      .def_readonly("velocity", &ViewTiming::velocity, "(V, 3) m per frame, of the surface");
  Class<PoseProblem>(m, "PoseProblem", "Observations and prediction of one frame. Valid only during the call that receives it.")
      .def_property_readonly(
          "actor", [](const PoseProblem &p) { return pointed(p.actor); }, "a copy")
      .def_property_readonly(
          "rig", [](const PoseProblem &p) { return pointed(p.rig); }, "cameras")
      .def_property_readonly(
          "outlines", [](const PoseProblem &p) { return pointed(p.outlines); }, "measured, one per camera; empty = no part")
      .def_readonly("tracks", &PoseProblem::tracks, "SurfaceTracks: points of the surface and where they are seen")
      .def_readonly("points", &PoseProblem::points, "SeenPoints: joints that keypoints show")
      .def_readonly("offset", &PoseProblem::offset, "(V, 3) m, rest pose, predicted from the previous frame")
      .def_readonly("reliability", &PoseProblem::reliability, "(V) in [0, 1], low on loose cloth")
      .def_readonly("predicted", &PoseProblem::predicted, "(D)")
      .def_readonly("start", &PoseProblem::start, "(D)")
      .def_readonly("first", &PoseProblem::first, "nothing is known yet")
      .def_readonly("timing", &PoseProblem::timing, "ViewTiming: delays by fractions of a frame");
  Class<SurfaceProblem>(m, "SurfaceProblem",
                        "Observations and prediction of the surface in one frame. Valid only during the call that receives it.")
      .def_property_readonly(
          "actor", [](const SurfaceProblem &p) { return pointed(p.actor); }, "a copy")
      .def_property_readonly(
          "rig", [](const SurfaceProblem &p) { return pointed(p.rig); }, "cameras")
      .def_property_readonly(
          "outlines", [](const SurfaceProblem &p) { return pointed(p.outlines); }, "measured, one per camera; empty = no part")
      .def_readonly("tracks", &SurfaceProblem::tracks, "SurfaceTracks: points of the surface and where they are seen")
      .def_readonly("base", &SurfaceProblem::base, "(V, 3) m, the predicted surface")
      .def_readonly("skinned", &SurfaceProblem::skinned, "(V, 3) m, posed without any offset")
      .def_readonly("reliability", &SurfaceProblem::reliability, "(V) in [0, 1], low on loose cloth")
      .def_readonly("timing", &SurfaceProblem::timing, "ViewTiming: delays by fractions of a frame");
}

void bind_pose(py::module_ &m) {
  OptionsClass<PoseOptions>(m, "Options of the pose optimiser.");
  Class<PoseEstimate>(m, "PoseEstimate", "A pose and how well it explains its frame.")
      .def(py::init<>())
      .def_readwrite("dofs", &PoseEstimate::dofs, "(D)")
      .def_readwrite("rim_px", &PoseEstimate::rim_px, "mean residual of the outlines, pixels")
      .def_readwrite("sift_px", &PoseEstimate::sift_px, "mean residual of the features, pixels")
      .def_readwrite("energy", &PoseEstimate::energy, "robust mean, in [0, 1]")
      .def_readwrite("iterations", &PoseEstimate::iterations, "that were made");
  Class<PoseOptimizer, PyPoseOptimizer>(m, "PoseOptimizer", "Swap point: one frame's correspondences -> pose.")
      .def(py::init<>())
      .def_static("create", &PoseOptimizer::create, py::arg("options") = PoseOptions{},
                  "The built-in optimiser (Gauss-Newton on rims and tracks).")
      .def(
          "optimize",
          [](PoseOptimizer &self, const PoseProblem &problem, const Context &context) {
            pointed(problem.actor);
            return self.optimize(problem, context);
          },
          py::arg("problem"), py::arg("context") = interruptible_context(), Release(),
          "The pose that explains the problem best.");
  m.def(
      "pose_surface",
      [](const RiggedMesh &actor, const Eigen::VectorXd &dofs, const Vertices &offset) {
        return pose_surface(actor, dofs, offset).vertices;
      },
      py::arg("actor"), py::arg("dofs"), py::arg("offset") = Vertices(0, 3), Release(),
      "(V, 3) m, skinned positions of the rest pose + offset (V, 3).");
}

void bind_limbs(py::module_ &m) {
  OptionsClass<ParticleAnnealingOptions>(m, "Options of the interacting simulated annealing of lost limbs.");
  OptionsClass<LimbSearchOptions>(m, "Options of the search for lost limbs.");
  Class<Limb>(m, "Limb", "A chain of the skeleton between two forks, or from a fork to an end.")
      .def_readonly("name", &Limb::name, "of its first joint")
      .def_numbers("joints", &Limb::joints, "indices, parents first")
      .def_numbers("dofs", &Limb::dofs, "indices");
  m.def("find_limbs", &find_limbs, py::arg("skeleton"), "The limbs of a skeleton by its topology.");
  Class<LimbProblem>(m, "LimbProblem", "A frame in which limbs were lost. Valid only during the call that receives it.")
      .def_property_readonly(
          "actor", [](const LimbProblem &p) { return pointed(p.actor); }, "a copy")
      .def_property_readonly(
          "rig", [](const LimbProblem &p) { return pointed(p.rig); }, "cameras")
      .def_property_readonly(
          "masks", [](const LimbProblem &p) { return pointed(p.masks); }, "measured, one per camera; empty = no part")
      .def_readonly("offset", &LimbProblem::offset, "(V, 3) m, rest pose, predicted from the previous frame")
      .def_readonly("reliability", &LimbProblem::reliability, "(V) in [0, 1], low on loose cloth")
      .def_readonly("predicted", &LimbProblem::predicted, "(D)")
      .def_readonly("points", &LimbProblem::points, "SeenPoints: joints that keypoints show");
  Class<LimbSearch, PyLimbSearch>(m, "LimbSearch", "Swap point: a pose with lost limbs -> a better one.")
      .def(py::init<>())
      .def_static("create", &LimbSearch::create, py::arg("options") = LimbSearchOptions{},
                  "The built-in search (interacting simulated annealing).")
      .def(
          "search",
          [](LimbSearch &self, const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &lost,
             const Context &context) {
            pointed(problem.actor);
            return self.search(problem, dofs, lost, context);
          },
          py::arg("problem"), py::arg("dofs"), py::arg("lost"), py::arg("context") = interruptible_context(), Release(),
          "(D) the pose `dofs` with the lost limbs sought anew.");
}

void bind_surface(py::module_ &m) {
  OptionsClass<SurfaceOptions>(m, "Options of the surface refiner.");
  Class<SurfaceEstimate>(m, "SurfaceEstimate", "A surface and how well it explains its frame.")
      .def(py::init<>())
      .def_readwrite("vertices", &SurfaceEstimate::vertices, "(V, 3) m")
      .def_readwrite("rim_px", &SurfaceEstimate::rim_px, "mean residual of the outlines, pixels")
      .def_readwrite("sift_px", &SurfaceEstimate::sift_px, "mean residual of the features, pixels");
  Class<SurfaceRefiner, PySurfaceRefiner>(m, "SurfaceRefiner", "Swap point: posed surface and correspondences -> surface.")
      .def(py::init<>())
      .def_static("create", &SurfaceRefiner::create, py::arg("options") = SurfaceOptions{},
                  "The built-in refiner (Laplacian deformation).")
      .def(
          "refine",
          [](SurfaceRefiner &self, const SurfaceProblem &problem, const Context &context) {
            pointed(problem.actor);
            return self.refine(problem, context);
          },
          py::arg("problem"), py::arg("context") = interruptible_context(), Release(),
          "The surface that explains the problem best.");
}

/// One piece as a property that keeps a Python subclass alive.
template <class T> void bind_piece(Class<CaptureParts> &parts, const char *name, std::shared_ptr<T> CaptureParts::*piece) {
  parts.def_property(
      name, [piece](const CaptureParts &self) { return py::cast((self.*piece).get(), py::return_value_policy::reference); },
      [piece](CaptureParts &self, const py::object &object) { self.*piece = kept<T>(object); },
      "an object of that interface; None = the built-in one");
}

void bind_capture_kits(py::module_ &m) {
  m.def("frame_source_violations", &testing::frame_source_violations, py::arg("frames"), Release(),
        "One sentence for each rule that a FrameSource breaks: channels, masks, sizes, the same frame again.");
  m.def("silhouette_extractor_violations", &testing::silhouette_extractor_violations, py::arg("extractor"), py::arg("training"),
        py::arg("image"), Release(), "The same of a SilhouetteExtractor, trained and tried with images of yours.");
  m.def("feature_tracker_violations", &testing::feature_tracker_violations, py::arg("tracker"), py::arg("image"), py::arg("mask"),
        py::arg("reach"), Release(), "The same of a FeatureTracker, on an image of yours; reach in pixels.");
  m.def("pose_optimizer_violations", &testing::pose_optimizer_violations, py::arg("optimizer"), py::arg("problem"), Release(),
        "The same of a PoseOptimizer, on a problem that it was given.");
  m.def("surface_refiner_violations", &testing::surface_refiner_violations, py::arg("refiner"), py::arg("problem"), Release(),
        "The same of a SurfaceRefiner, on a problem that it was given.");
  m.def("limb_search_violations", &testing::limb_search_violations, py::arg("search"), py::arg("problem"), py::arg("dofs"),
        py::arg("lost"), Release(), "The same of a LimbSearch, on a problem, a pose within the limits and limbs that are lost.");
  m.def("performance_capture_violations", &testing::performance_capture_violations, py::arg("capture"), py::arg("actor"),
        py::arg("rig"), py::arg("frames"), py::arg("extractor") = nullptr, Release(),
        "The same for a PerformanceCapture, on a short video of yours, which it captures twice.");
}

} // namespace

void bind_capture_parts(py::module_ &m) {
  bind_features(m);
  bind_problems(m);
  bind_pose(m);
  bind_limbs(m);
  bind_surface(m);
  OptionsClass<CalibrationRefinementOptions>(m, "Options of the refinement of the cameras.");
  Class<CaptureParts> parts(m, "CaptureParts", "The parts of a capture; None = the built-in one, created from the options.");
  parts.def(py::init([](const py::object &features, const py::object &pose, const py::object &limbs, const py::object &surface) {
              return CaptureParts{kept<FeatureTracker>(features), kept<PoseOptimizer>(pose), kept<LimbSearch>(limbs),
                                  kept<SurfaceRefiner>(surface)};
            }),
            py::arg("features") = py::none(), py::arg("pose") = py::none(), py::arg("limbs") = py::none(),
            py::arg("surface") = py::none());
  bind_piece(parts, "features", &CaptureParts::features);
  bind_piece(parts, "pose", &CaptureParts::pose);
  bind_piece(parts, "limbs", &CaptureParts::limbs);
  bind_piece(parts, "surface", &CaptureParts::surface);
  bind_capture_kits(m);
}

} // namespace doublet::python
