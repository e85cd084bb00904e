#include "doublet/options/options.h"
#include "doublet/pbd/cloth_solver.h"

#include <Eigen/Geometry>
#include <stdexcept>

namespace doublet::pbd {
namespace {

[[noreturn]] void refuse_model(const std::string &what) {
  throw std::invalid_argument("cloth model: " + what);
}

void check_mesh(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness) {
  if (rest.rows() == 0 || faces.rows() == 0)
    refuse_model("the mesh is empty (" + std::to_string(rest.rows()) + " vertices, " + std::to_string(faces.rows()) + " faces)");
  if (clothness.size() != rest.rows())
    refuse_model("clothness must have one value a vertex (" + std::to_string(rest.rows()) + "), found " +
                 std::to_string(clothness.size()));
  for (int i = 0; i < rest.rows(); ++i) {
    if (!rest.row(i).allFinite() || rest.row(i).cwiseAbs().maxCoeff() > 1e6)
      refuse_model("rest position of vertex " + std::to_string(i) + " is not a finite point within 1e6 m");
    if (!(clothness[i] >= 0 && clothness[i] <= 1))
      refuse_model("clothness must lie in [0, 1], found " + options::to_text(clothness[i]) + " at vertex " + std::to_string(i));
  }
  for (int f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      if (faces(f, k) < 0 || faces(f, k) >= rest.rows())
        refuse_model("face " + std::to_string(f) + " has index " + std::to_string(faces(f, k)) + ", expected 0.." +
                     std::to_string(rest.rows() - 1));
}

double face_area(const Vertices &rest, const Faces &faces, int f) {
  const Eigen::Vector3d a = rest.row(faces(f, 0)), b = rest.row(faces(f, 1)), c = rest.row(faces(f, 2));
  return 0.5 * (b - a).cross(c - a).norm();
}

/// (N) 1/m^2
Eigen::VectorXd inverse_masses_of(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(rest.rows());
  for (int f = 0; f < faces.rows(); ++f) {
    const double area = face_area(rest, faces, f);
    if (!(area > 1e-12))
      refuse_model("face " + std::to_string(f) + " is degenerate: its area must exceed 1e-12 m^2, found " +
                   options::to_text(area, 4));
    for (int v : faces.row(f))
      mass[v] += area / 3;
  }
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(rest.rows());
  for (int i = 0; i < rest.rows(); ++i) {
    if (mass[i] == 0)
      refuse_model("vertex " + std::to_string(i) + " belongs to no face and has no mass");
    if (clothness[i] > 0)
      inverse[i] = 1 / mass[i];
  }
  return inverse;
}

} // namespace

std::shared_ptr<const ClothModel> ClothModel::create(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness,
                                                     const ClothOptions &options) {
  return std::shared_ptr<const ClothModel>(new ClothModel(rest, faces, clothness, options));
}

ClothModel::ClothModel(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options)
    : rest_(rest), faces_(faces), clothness_(clothness), options_(options) {
  options.validate();
  check_mesh(rest, faces, clothness);
  inverse_masses_ = inverse_masses_of(rest, faces, clothness);
}

} // namespace doublet::pbd
