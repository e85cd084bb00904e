#include "common.h"

#include "doublet/core/error.h"
#include "doublet/core/finding.h"
#include "doublet/core/garment.h"
#include "doublet/core/rasterizer.h"
#include "doublet/core/skinning.h"
#include "doublet/core/textured_faces.h"

#include <cstring>

namespace doublet::python {

std::string described(const py::object &object) {
  if (py::isinstance<py::array>(object))
    return py::str("an array of {} {}").format(object.attr("dtype"), object.attr("shape"));
  return py::str("{}").format(py::type::of(object).attr("__name__"));
}

py::array_t<double> stack(const std::vector<Vertices> &frames) {
  const py::ssize_t rows = frames.empty() ? 0 : frames.front().rows();
  py::array_t<double> result({static_cast<py::ssize_t>(frames.size()), rows, py::ssize_t(3)});
  double *out = result.mutable_data();
  for (const Vertices &frame : frames) {
    if (frame.rows() != rows)
      throw std::invalid_argument("frames differ in their number of vertices");
    std::memcpy(out, frame.data(), sizeof(double) * frame.size());
    out += frame.size();
  }
  return result;
}

std::vector<Vertices> unstack(const py::array_t<double, py::array::c_style | py::array::forcecast> &frames, const char *what) {
  if (frames.ndim() != 3 || frames.shape(2) != 3)
    throw std::invalid_argument(std::string(what) + ": expected the shape (frames, vertices, 3), found " +
                                std::string(py::str(frames.attr("shape"))));
  std::vector<Vertices> result;
  for (py::ssize_t t = 0; t < frames.shape(0); ++t)
    result.push_back(Eigen::Map<const Vertices>(frames.data(t, 0, 0), frames.shape(1), 3));
  return result;
}

namespace {

/// Called on the thread that called the stage: Ctrl-C becomes KeyboardInterrupt and unwinds the stage.
bool interrupted() {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0)
    throw py::error_already_set();
  return false;
}

using Floats2 = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Floats4 = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;

py::array_t<double> as_matrices(const Transforms &transforms) {
  py::array_t<double> result({static_cast<py::ssize_t>(transforms.size()), py::ssize_t(4), py::ssize_t(4)});
  auto out = result.mutable_unchecked<3>();
  for (std::size_t j = 0; j < transforms.size(); ++j)
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        out(j, r, c) = transforms[j].matrix()(r, c);
  return result;
}

Transforms as_transforms(const py::array_t<double, py::array::c_style | py::array::forcecast> &matrices) {
  if (matrices.ndim() != 3 || matrices.shape(1) != 4 || matrices.shape(2) != 4)
    throw std::invalid_argument("transforms must have the shape (joints, 4, 4)");
  Transforms result;
  for (py::ssize_t j = 0; j < matrices.shape(0); ++j) {
    Eigen::Isometry3d transform;
    transform.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrices.data(j, 0, 0));
    result.push_back(transform);
  }
  return result;
}

py::object makers() {
  return py::module_::import("doublet.common.makers");
}

/// tp_init of a class without a constructor, in the place of pybind11's "No constructor defined!".
int refuse_to_construct(PyObject *self, PyObject *, PyObject *) {
  try {
    const py::object said = makers().attr("no_constructor")(py::type::of(self));
    PyErr_SetObject(PyExc_TypeError, said.ptr());
  } catch (py::error_already_set &error) {
    error.restore();
  }
  return -1;
}

/// Asked by pybind11 for an object that is no `wanted`: throws TypeError if a function makes one of it; else converts nothing.
PyObject *refuse_other_class(PyObject *given, PyTypeObject *wanted) {
  const auto said = makers().attr("other_class")(py::handle(given), py::handle(reinterpret_cast<PyObject *>(wanted)));
  if (py::len(said) > 0)
    throw py::type_error(said.cast<std::string>());
  return nullptr;
}

void bind_errors(py::module_ &m) {
  static py::exception<Error> error(m, "Error", PyExc_RuntimeError);
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer)
        std::rethrow_exception(pointer);
    } catch (const FileNotFound &e) {
      py::set_error(PyExc_FileNotFoundError, e.what());
    } catch (const Cancelled &e) {
      py::set_error(PyExc_KeyboardInterrupt, e.what());
    } catch (const Error &e) {
      py::set_error(error, e.what());
    } catch (const std::filesystem::filesystem_error &e) { // of a folder that nobody may write to, say
      py::set_error(error, (e.path1().string() + ": " + e.code().message()).c_str());
    }
  });
}

void bind_context(py::module_ &m) {
  Class<Context>(m, "Context", "Progress, log, cancellation and threads of a long call. Ctrl-C always works.")
      .def(py::init([](std::function<void(const std::string &, double)> progress, std::function<void(const std::string &)> log,
                       int threads) {
             Context context = interruptible_context();
             context.progress = std::move(progress);
             context.log = std::move(log);
             context.threads = threads;
             return context;
           }),
           py::kw_only(), py::arg("progress") = nullptr, py::arg("log") = nullptr, py::arg("threads") = 0,
           "progress(stage, fraction in [0, 1]); log(line); threads: 0 = one per core, results do not depend on it.")
      .def_readwrite("threads", &Context::threads, "0 = one per core; results do not depend on it")
      .def("report_progress", &Context::report_progress, py::arg("stage"), py::arg("fraction"), Release(),
           "Calls progress(stage, fraction); raises KeyboardInterrupt if the user asked to stop.")
      .def("log_line", &Context::log_line, py::arg("line"), Release(), "Passes a line to log.")
      .def("__repr__", [](const Context &context) {
        return context.threads ? "Context(threads=" + std::to_string(context.threads) + ")" : std::string("Context()");
      });
}

void bind_finding(py::module_ &m) {
  Class<Finding>(m, "Finding",
                 "What is wrong with a session or a result: impossible ones stop a run, doubtful ones are only reported.")
      .def(py::init([](bool impossible, std::string text, std::string kind) {
             return Finding{impossible, std::move(text), std::move(kind)};
           }),
           py::arg("impossible"), py::arg("text"), py::arg("kind") = "")
      .def_readonly("impossible", &Finding::impossible, "the run stops")
      .def_readonly("text", &Finding::text, "one sentence that names expectation and finding")
      .def_readonly("kind", &Finding::kind, "a word for programs; may be empty")
      .def_property_readonly(
          "level", [](const Finding &finding) { return finding.impossible ? "impossible" : "doubtful"; },
          "'impossible' or 'doubtful'")
      .def("__repr__",
           [](const Finding &finding) { return std::string(finding.impossible ? "impossible: " : "doubtful: ") + finding.text; });
}

void bind_mesh(py::module_ &m) {
  Class<MeshReport>(m, "MeshReport", "What is wrong, or right, with a mesh.")
      .def_readonly("vertices", &MeshReport::vertices, "V")
      .def_readonly("faces", &MeshReport::faces, "F")
      .def_readonly("non_finite_vertices", &MeshReport::non_finite_vertices, "with NaN or infinity")
      .def_readonly("out_of_range_faces", &MeshReport::out_of_range_faces, "a corner index < 0 or >= V")
      .def_readonly("degenerate_faces", &MeshReport::degenerate_faces, "a repeated corner, or an area below 1e-14 m^2")
      .def_readonly("boundary_edges", &MeshReport::boundary_edges, "edges of one face")
      .def_readonly("non_manifold_edges", &MeshReport::non_manifold_edges,
                    "edges of more than two faces, or of two in the same direction")
      .def_readonly("unused_vertices", &MeshReport::unused_vertices, "of no face")
      .def_readonly("components", &MeshReport::components, "connected components of faces")
      .def_property_readonly("closed", &MeshReport::closed, "no boundary, and manifold")
      .def_property_readonly("usable", &MeshReport::usable, "finite, in range, not empty: what no stage can do without")
      .def("__repr__", &MeshReport::to_string);
  Class<Mesh>(m, "Mesh", "Triangle mesh: vertices (V, 3) m, faces (F, 3).")
      .def_copies()
      .def("__repr__",
           [](const Mesh &mesh) {
             return "Mesh(" + std::to_string(mesh.vertices.rows()) + " vertices, " + std::to_string(mesh.faces.rows()) +
                    " faces)";
           })
      .def(py::init<>())
      .def(py::init([](Vertices vertices, Faces faces) {
             return Mesh{std::move(vertices), std::move(faces)};
           }),
           py::arg("vertices"), py::arg("faces"))
      .def_readwrite("vertices", &Mesh::vertices, "(V, 3) m")
      .def_readwrite("faces", &Mesh::faces, "(F, 3) indices of vertices")
      .def("report", &report_mesh, "What is wrong, or right, with the mesh.");
  Class<TexturedFaces>(m, "TexturedFaces", "Faces to be drawn, with the vertices of a surface.")
      .def(py::init<>())
      .def(py::init([](Faces faces, decltype(TexturedFaces::texcoords) texcoords) {
             return TexturedFaces{std::move(faces), std::move(texcoords)};
           }),
           py::arg("faces"), py::arg("texcoords"))
      .def_readwrite("faces", &TexturedFaces::faces, "(F, 3)")
      .def_readwrite("texcoords", &TexturedFaces::texcoords, "(3 F, 2) of corners, (0, 0) is the top left; (0, 2) = none");
  Class<MeshSequence>(m, "MeshSequence", "A deforming surface: faces (F, 3), frames (T, V, 3) m.")
      .def_copies()
      .def(py::init<>())
      .def(py::init([](Faces faces, const py::array_t<double, py::array::c_style | py::array::forcecast> &frames) {
             return MeshSequence{std::move(faces), unstack(frames, "frames")};
           }),
           py::arg("faces"), py::arg("frames"))
      .def_readwrite("faces", &MeshSequence::faces, "(F, 3)")
      .def_property(
          "frames", [](const MeshSequence &s) { return stack(s.frames); },
          [](MeshSequence &s, const py::array_t<double, py::array::c_style | py::array::forcecast> &frames) {
            s.frames = unstack(frames, "frames");
          },
          "(T, V, 3) m; a copy that cannot be written to: set it as a whole")
      .def("__len__", [](const MeshSequence &s) { return s.frames.size(); });
  m.def("face_normals", &face_normals, py::arg("vertices"), py::arg("faces"), Release(),
        "(F, 3) unit; zero for degenerate faces.");
  m.def("vertex_normals", py::overload_cast<const Vertices &, const Faces &>(&vertex_normals), py::arg("vertices"),
        py::arg("faces"), Release(), "(V, 3) unit, weighted by angle; zero where no face is.");
  m.def("face_areas", &face_areas, py::arg("vertices"), py::arg("faces"), Release(), "(F) m^2.");
  m.def("vertex_areas", &vertex_areas, py::arg("vertices"), py::arg("faces"), Release(),
        "(V) m^2, a third of the faces around each vertex.");
}

void bind_camera(py::module_ &m) {
  Class<Camera>(m, "Camera", "Pinhole camera, OpenCV's conventions: x_cam = R x_world + t.")
      .def_copies()
      .def("__repr__",
           [](const Camera &camera) {
             return py::str("Camera({!r}, {} x {}, focal length {:.6g} px)")
                 .format(camera.name, camera.width, camera.height, camera.K(0, 0));
           })
      .def(py::init<>())
      .def_readwrite("name", &Camera::name, "of the camera, as in files")
      .def_readwrite("K", &Camera::K, "(3, 3) pixels: focal lengths and principal point")
      .def_readwrite("distortion", &Camera::distortion, "k1 k2 p1 p2 k3")
      .def_readwrite("R", &Camera::R, "(3, 3) of cam_from_world")
      .def_readwrite("t", &Camera::t, "(3) m, of cam_from_world")
      .def_readwrite("width", &Camera::width, "of the images, pixels")
      .def_readwrite("height", &Camera::height, "of the images, pixels")
      .def_property_readonly("centre", &Camera::centre, "(3) m, centre of projection")
      .def("project", &Camera::project, py::arg("point"), "Pixel of a world point.")
      .def("resized", &Camera::resized, py::arg("width"), py::arg("height"), "The same camera for images of another size.");
  m.def(
      "rasterize",
      [](const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid) {
        FaceBuffer buffer;
        {
          const py::gil_scoped_release release;
          buffer = rasterize(vertices, faces, camera, face_valid);
        }
        const std::vector<py::ssize_t> shape{buffer.height, buffer.width};
        return py::make_tuple(move_to_array(std::move(buffer.face), shape), move_to_array(std::move(buffer.depth), shape));
      },
      py::arg("vertices"), py::arg("faces"), py::arg("camera"), py::arg_v("face_valid", Mask{}, "[]"),
      "(face, depth): face index at each pixel (-1 = background) and depth in m (inf = background), both (height, width).");
}

void bind_skeleton(py::module_ &m) {
  Class<JointAnnotation>(m, "JointAnnotation", "A joint as the user annotates it.")
      .def(py::init([](std::string name, std::string parent, Eigen::Vector3d position, std::optional<int> dof) {
             return JointAnnotation{std::move(name), std::move(parent), position, dof};
           }),
           py::arg("name"), py::arg("parent"), py::arg("position"), py::arg("dof") = std::nullopt)
      .def_readwrite("name", &JointAnnotation::name, "of the joint")
      .def_readwrite("parent", &JointAnnotation::parent, "name of the joint that carries it; empty = the root")
      .def_readwrite("position", &JointAnnotation::position, "(3) m")
      .def_readwrite("dof", &JointAnnotation::dof, "rotational degrees of freedom; None = as usual for a joint of this name");
  Class<Skeleton>(m, "Skeleton", "Kinematic skeleton; joints are sorted parents first.")
      .def_copies()
      .def(py::init(&make_skeleton), py::arg("marks"))
      .def_property_readonly(
          "joint_names",
          [](const Skeleton &s) {
            std::vector<std::string> names;
            for (const Joint &joint : s.joints)
              names.push_back(joint.name);
            return names;
          },
          "(J)")
      .def_property_readonly(
          "joint_parents",
          [](const Skeleton &s) {
            Eigen::VectorXi parents(s.joint_count());
            for (int j = 0; j < s.joint_count(); ++j)
              parents[j] = s.joints[j].parent;
            return parents;
          },
          "(J) indices, -1 = none")
      .def_property_readonly(
          "joint_rest",
          [](const Skeleton &s) {
            Vertices rest(s.joint_count(), 3);
            for (int j = 0; j < s.joint_count(); ++j)
              rest.row(j) = s.joints[j].rest;
            return rest;
          },
          "(J, 3) m, scan pose")
      .def_readonly("dof_names", &Skeleton::dof_names, "(D)")
      .def_readonly("lower", &Skeleton::lower, "(D) least value of each degree of freedom, rad or m")
      .def_readonly("upper", &Skeleton::upper, "(D) greatest value")
      .def("find", &Skeleton::find, py::arg("name"), "Index of a joint; raises Error if there is none of that name.")
      .def(
          "forward_kinematics",
          [](const Skeleton &s, const Eigen::VectorXd &dofs) { return as_matrices(forward_kinematics(s, dofs)); },
          py::arg("dofs"), "(J, 4, 4) world_from_rest")
      .def(
          "joint_positions",
          [](const Skeleton &s, const Eigen::VectorXd &dofs) { return joint_positions(s, forward_kinematics(s, dofs)); },
          py::arg("dofs"), "(J, 3) m");
  m.def(
      "dual_quaternion_skinning",
      [](const Vertices &rest, const MatrixRM &weights,
         const py::array_t<double, py::array::c_style | py::array::forcecast> &world_from_rest) {
        const Transforms transforms = as_transforms(world_from_rest);
        const py::gil_scoped_release release;
        return dual_quaternion_skinning(rest, weights, transforms);
      },
      py::arg("rest"), py::arg("weights"), py::arg("world_from_rest"),
      "(V, 3) the rest positions (V, 3) m, skinned with transforms (J, 4, 4) and weights (V, J).");
}

void bind_observations(py::module_ &m) {
  Class<ViewObservation>(m, "ViewObservation", "2D data of one camera at one frame, pixels.")
      .def(py::init([](const Floats2 &contour, const Floats4 &matches) {
             if (!contour.allFinite() || !matches.allFinite())
               throw std::invalid_argument("ViewObservation: expected finite pixels, found NaN or infinity");
             ViewObservation view;
             for (Eigen::Index i = 0; i < contour.rows(); ++i)
               view.contour.emplace_back(contour.row(i));
             for (Eigen::Index i = 0; i < matches.rows(); ++i)
               view.matches.push_back({matches.row(i).head<2>(), matches.row(i).tail<2>()});
             return view;
           }),
           py::arg("contour"), py::arg("matches"))
      .def_property_readonly(
          "contour",
          [](const ViewObservation &view) {
            Floats2 points(view.contour.size(), 2);
            for (std::size_t i = 0; i < view.contour.size(); ++i)
              points.row(i) = view.contour[i];
            return points;
          },
          "(N, 2) boundary of the measured silhouette")
      .def_property_readonly(
          "matches",
          [](const ViewObservation &view) {
            Floats4 points(view.matches.size(), 4);
            for (std::size_t i = 0; i < view.matches.size(); ++i)
              points.row(i) << view.matches[i].previous.transpose(), view.matches[i].current.transpose();
            return points;
          },
          "(N, 4) features at t-1 (x, y) and t (x, y)");
  Class<Observations>(m, "Observations", "2D data of the whole sequence (observations.npz).")
      .def(py::init<>())
      .def_readwrite("cameras", &Observations::cameras, "(C) Cameras, in the order of a frame's views")
      .def_numbers_readwrite("frames", &Observations::frames, "(T) video frame numbers")
      .def_readwrite("views", &Observations::views, "[frame][camera]; a copy");
}

void bind_stage_values(py::module_ &m) {
  Class<RiggedMesh>(m, "RiggedMesh", "Surface in the scan pose, skeleton and skin weights (actor.npz).")
      .def_copies()
      .def(py::init([](Mesh mesh, Mask face_valid, MatrixRM weights, Skeleton skeleton) {
             return RiggedMesh{std::move(mesh), std::move(face_valid), std::move(weights), std::move(skeleton)};
           }),
           py::arg("mesh"), py::arg("face_valid"), py::arg("weights"), py::arg("skeleton"))
      .def_readwrite("mesh", &RiggedMesh::mesh, "scan pose, m")
      .def_readwrite("face_valid", &RiggedMesh::face_valid, "(F) 0 = invented over a large hole")
      .def_readwrite("weights", &RiggedMesh::weights, "(V, J)")
      .def_readwrite("skeleton", &RiggedMesh::skeleton, "Skeleton");
  Class<ReferencePerformance>(m, "ReferencePerformance", "The captured performance (performance.npz).")
      .def_copies()
      .def(py::init<>())
      .def_readwrite("surface", &ReferencePerformance::surface, "MeshSequence of the captured surface")
      .def_readwrite("dofs", &ReferencePerformance::dofs, "(T, D)")
      .def_property(
          "joints", [](const ReferencePerformance &p) { return stack(p.joints); },
          [](ReferencePerformance &p, const py::array_t<double, py::array::c_style | py::array::forcecast> &joints) {
            p.joints = unstack(joints, "joints");
          },
          "(T, J, 3) m; a copy that cannot be written to: set it as a whole")
      .def_numbers_readwrite("frames", &ReferencePerformance::frames, "(T) video frame numbers");
  m.def(
      "canonical_frames",
      [](const RiggedMesh &actor, const ReferencePerformance &performance, const Context &context) {
        std::vector<Vertices> frames;
        {
          py::gil_scoped_release release;
          frames = canonical_frames(actor, performance, context);
        }
        return stack(frames);
      },
      py::arg("actor"), py::arg("performance"), py::arg("context") = interruptible_context(),
      "(T, V, 3) m: the captured frames, transformed back to the scan pose.");
  Class<Segmentation>(m, "Segmentation", "Which vertices are loose cloth (segmentation.npz).")
      .def_copies()
      .def(py::init<>())
      .def(py::init([](Eigen::VectorXd sigma, Eigen::VectorXd clothness, Eigen::VectorXi region) {
             const int count = region.size() ? region.maxCoeff() + 1 : 0;
             return Segmentation{std::move(sigma), std::move(clothness), std::move(region), count};
           }),
           py::arg("sigma"), py::arg("clothness"), py::arg("region"))
      .def_readwrite("sigma", &Segmentation::sigma, "(V) m")
      .def_readwrite("clothness", &Segmentation::clothness, "(V) in [0, 1]")
      .def_readwrite("region", &Segmentation::region, "(V), -1 = rigid")
      .def_readwrite("probability", &Segmentation::probability, "(V) in [0, 1], of being cloth; empty = not known")
      .def_readwrite("slack", &Segmentation::slack,
                     "(V) m, distance that the surface reaches from the body (cloth_slack); empty = not measured")
      .def_readwrite("rest", &Segmentation::rest, "(V, 3) m, the shape that defines lengths and masses; empty = the scan pose")
      .def_readwrite("region_count", &Segmentation::region_count, "cloth regions");
  Class<Garment>(m, "Garment", "All cloth of a character as a mesh of its own (garment.npz).")
      .def_copies()
      .def(py::init<>())
      .def_readwrite("mesh", &Garment::mesh, "scan pose, m")
      .def_readwrite("region", &Garment::region, "(G)")
      .def_readwrite("clothness", &Garment::clothness, "(G) 0 = attached to the skeleton, 1 = free")
      .def_readwrite("rest", &Garment::rest, "(G, 3) m, the shape that defines lengths and masses")
      .def_readwrite("actor_face", &Garment::actor_face, "(G) face of the actor on which the vertex lies")
      .def_readwrite("barycentric", &Garment::barycentric, "(G, 3) of that face's corners")
      .def_readwrite("widths", &Garment::widths,
                     "[K] (G, 3) m, rest shapes to choose from, the widest first; empty = only `rest`")
      .def_readwrite("replaced_faces", &Garment::replaced_faces, "(F) faces of the actor that the garment replaces")
      .def_readwrite("attachment", &Garment::attachment,
                     "(V) of the actor's cloth: 1 = carried by the body, 0 = hangs free; empty = all free")
      .def_readwrite("region_count", &Garment::region_count, "cloth regions");
  m.def("choose_widths", &choose_widths, py::arg("garment"), py::arg("chosen") = std::vector<double>{}, Release(),
        "The garment in one width. chosen: for each region a position among `widths`, 0 = the first, 0.5 = halfway to the "
        "second; empty = its `rest`.");
  m.def("common_widths", &common_widths, py::arg("garments"), py::arg("count"), Release(),
        "[garments][count] positions among the widths at which several meshes of one garment have the same rest area, the widest "
        "first.");
  m.def("width_variants", &width_variants, py::arg("garment"), Release(), "The garment in each of its widths.");
  Class<DressedActor>(m, "DressedActor", "The actor in a garment of its own mesh.")
      .def_readwrite("actor", &DressedActor::actor, "V + G vertices: the actor's, then the garment's")
      .def_readwrite("segmentation", &DressedActor::segmentation, "of the V + G vertices");
  m.def("dress", py::overload_cast<const RiggedMesh &, const Segmentation &, const Garment &>(&dress), py::arg("actor"),
        py::arg("segmentation"), py::arg("garment"), Release(), "The actor in the garment.");
  m.def("dress", py::overload_cast<const ReferencePerformance &, const RiggedMesh &, const Garment &>(&dress),
        py::arg("performance"), py::arg("actor"), py::arg("garment"), Release(),
        "The captured surface on the dressed actor's mesh.");
  Class<TaperedCapsule>(m, "TaperedCapsule", "Collision proxy carried by a joint.")
      .def(py::init([](int joint, Eigen::Vector3d p0, Eigen::Vector3d p1, double r0, double r1) {
             return TaperedCapsule{joint, p0, p1, r0, r1};
           }),
           py::arg("joint"), py::arg("p0"), py::arg("p1"), py::arg("r0"), py::arg("r1"))
      .def_readwrite("joint", &TaperedCapsule::joint, "index of the joint that carries it")
      .def_readwrite("p0", &TaperedCapsule::p0, "(3) m, one end of the axis, scan pose")
      .def_readwrite("p1", &TaperedCapsule::p1, "(3) m, the other end")
      .def_readwrite("r0", &TaperedCapsule::r0, "m, radius at p0")
      .def_readwrite("r1", &TaperedCapsule::r1, "m, radius at p1");
  m.def(
      "capsule_mesh",
      [](const Eigen::Vector3d &p0, const Eigen::Vector3d &p1, double r0, double r1) {
        return capsule_mesh({Capsule{p0, p1, r0, r1}});
      },
      py::arg("p0"), py::arg("p1"), py::arg("r0"), py::arg("r1"),
      "Closed triangle mesh of a tapered capsule: spheres at p0 and p1, m, and the cone between them.");
  Class<BodyFit>(m, "BodyFit", "The body under the clothes, scan pose (body.npz).")
      .def(py::init<>())
      .def_readwrite("body", &BodyFit::body, "the body's mesh, scan pose, m")
      .def_readwrite("coefficients", &BodyFit::coefficients, "of the statistical model")
      .def_readwrite("model", &BodyFit::model, "name and hash of the statistical model")
      .def_readwrite("residual", &BodyFit::residual, "m")
      .def_readwrite("deviation", &BodyFit::deviation, "(B) m, expected RMS error of each vertex; empty = not known");
}

} // namespace

bool has_complex(const py::handle &object) {
  if (PyComplex_Check(object.ptr()))
    return true;
  if (py::hasattr(object, "dtype")) {
    const py::object type = object.attr("dtype");
    return py::isinstance<py::dtype>(type) && type.attr("kind").cast<std::string>() == "c";
  }
  if (!py::isinstance<py::tuple>(object) && !py::isinstance<py::list>(object))
    return false;
  for (const py::handle inner : object)
    if (has_complex(inner))
      return true;
  return false;
}

void refuse_complex_arrays() {
  using Api = py::detail::npy_api;
  static const auto from_any = Api::get().PyArray_FromAny_;
  static const auto copy_into = Api::get().PyArray_CopyInto_;
  static const auto refuse = [] { PyErr_SetString(PyExc_TypeError, "expected real numbers, found complex ones"); };
  Api::get().PyArray_FromAny_ = [](PyObject *given, PyObject *type, int least, int most, int flags, PyObject *context) {
    if (!type)
      return from_any(given, type, least, most, flags, context);
    // As it is first: so a list's type shows, too.
    const auto array = py::reinterpret_steal<py::object>(from_any(given, nullptr, 0, 0, Api::NPY_ARRAY_ENSUREARRAY_, nullptr));
    if (!array)
      PyErr_Clear();
    if (array && has_complex(array) && !py::str(py::handle(type).attr("kind")).equal(py::str("c"))) {
      Py_DECREF(type); // NumPy's function would have taken it
      refuse();
      return static_cast<PyObject *>(nullptr);
    }
    return from_any(array ? array.ptr() : given, type, least, most, flags, context);
  };
  Api::get().PyArray_CopyInto_ = [](PyObject *to, PyObject *from) {
    if (has_complex(from) && !has_complex(to)) {
      refuse();
      return -1;
    }
    const int copied = copy_into(to, from);
    const py::object kind = py::handle(to).attr("dtype"), given = py::handle(from).attr("dtype");
    if (copied < 0 || kind.attr("kind").cast<std::string>() != "i" || kind.equal(given) ||
        py::module_::import("numpy").attr("array_equal")(py::handle(to), py::handle(from)).cast<bool>())
      return copied;
    PyErr_SetString(PyExc_TypeError, "expected whole numbers of 32 bits, found others"); // NumPy would cut them off
    return -1;
  };
}

Context interruptible_context() {
  Context context;
  context.cancelled = interrupted;
  return context;
}

void name_makers(const py::module_ &m) {
  const initproc without = reinterpret_cast<PyTypeObject *>(py::detail::get_internals().instance_base)->tp_init;
  for (const auto &item : py::reinterpret_borrow<py::dict>(m.attr("__dict__"))) {
    const auto *bound = PyType_Check(item.second.ptr()) ? py::detail::get_type_info((PyTypeObject *)item.second.ptr()) : nullptr;
    if (!bound)
      continue;
    if (bound->type->tp_init == without)
      bound->type->tp_init = refuse_to_construct;
    const_cast<py::detail::type_info *>(bound)->implicit_conversions.push_back(&refuse_other_class);
  }
}

void bind_core(py::module_ &m) {
  bind_errors(m);
  bind_context(m);
  bind_finding(m);
  bind_mesh(m);
  bind_camera(m);
  bind_skeleton(m);
  bind_observations(m);
  bind_stage_values(m);
}

} // namespace doublet::python
