#include "common.h"

#include "doublet/core/parts/self_intersection.h"
#include "doublet/rays/ray_scene.h"
#include "doublet/rays/surface_distance.h"

namespace doublet::python {

void bind_rays(py::module_ &m) {
  Class<RayScene>(m, "RayScene", "Rays and closest points against one mesh.")
      .def(py::init<const Mesh &, const Mask &>(), py::arg("mesh"), py::arg_v("face_valid", Mask{}, "[]"), Release())
      .def(
          "cast",
          [](const RayScene &scene, const Vertices &origins, const Vertices &directions, double min_distance) {
            if (origins.rows() != directions.rows())
              throw std::invalid_argument("origins and directions differ in length");
            Eigen::VectorXi faces(origins.rows());
            Eigen::VectorXd distances(origins.rows());
            parallel_for({}, static_cast<int>(origins.rows()), [&](int i) {
              const auto hit = scene.cast(origins.row(i), directions.row(i), min_distance);
              faces[i] = hit ? hit->face : -1;
              distances[i] = hit ? hit->distance : std::numeric_limits<double>::infinity();
            });
            return std::make_pair(faces, distances);
          },
          py::arg("origins"), py::arg("directions"), py::arg("min_distance") = 0.0, Release(),
          "(face, distance) of the first hits of N rays; face -1 and distance inf if there is none. directions (N, 3) unit: "
          "otherwise distances are in multiples of their lengths.")
      .def(
          "closest",
          [](const RayScene &scene, const Vertices &points) {
            Eigen::VectorXi faces(points.rows());
            Eigen::VectorXd distances(points.rows());
            Vertices closest(points.rows(), 3);
            parallel_for({}, static_cast<int>(points.rows()), [&](int i) {
              const ClosestPoint nearest = scene.closest(points.row(i));
              faces[i] = nearest.face;
              distances[i] = nearest.distance;
              closest.row(i) = nearest.point;
            });
            return std::make_tuple(faces, distances, closest);
          },
          py::arg("points"), Release(), "(face, distance, point) of the closest surface point of N points.");
  m.def("self_intersecting_faces", &self_intersecting_faces, py::arg("mesh"), py::arg("context") = interruptible_context(),
        Release(), "(F) 1 for the faces that pass through another face");
  m.def("distances_to_surface", &distances_to_surface, py::arg("points"), py::arg("surface"),
        py::arg_v("face_valid", Mask{}, "[]"), py::arg("context") = interruptible_context(), Release(),
        "(N) unsigned distances, m");
  m.def("visible_vertices", &visible_vertices, py::arg("vertices"), py::arg("faces"), py::arg("cameras"), py::arg("tolerance"),
        Release(), "(V) 1 where at least one camera sees the vertex; tolerance in m");
}

} // namespace doublet::python
