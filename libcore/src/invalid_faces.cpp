#include "doublet/core/parts/invalid_faces.h"

namespace doublet {
namespace {

/// Faces that `extended` has taken away are valid again where they hang together with one farther than kReach from any invalid
/// face: that is no rest of a sheet, but the surface in which a hole lies.
void give_back_what_reaches_far(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid,
                                std::vector<std::uint8_t> &extended) {
  constexpr double kReach = 0.2; // m
  const int n = static_cast<int>(mesh.vertices.rows());
  std::vector<int> taken;
  std::vector<char> known(n, 0);
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (face_valid[f] && !extended[f])
      taken.push_back(f);
    for (int c = 0; !face_valid[f] && c < 3; ++c)
      known[mesh.faces(f, c)] = 1;
  }
  if (taken.empty())
    return;
  int count = 0;
  const Eigen::VectorXi piece = vertex_components(mesh.faces(taken, Eigen::all), n, &count);
  std::vector<char> far(count, 0);
  for (int i = 0; i < n; ++i) {
    bool near = piece[i] < 0 || far[piece[i]];
    for (int k = 0; !near && k < n; ++k)
      near = known[k] && (mesh.vertices.row(i) - mesh.vertices.row(k)).squaredNorm() < kReach * kReach;
    if (!near)
      far[piece[i]] = 1;
  }
  for (const int f : taken)
    extended[f] = far[piece[mesh.faces(f, 0)]];
}

} // namespace

std::vector<std::uint8_t> extend_invalid_faces(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid) {
  constexpr double kSameWay = 0.6; // cosine
  std::vector<std::uint8_t> valid = face_valid;
  std::vector<int> invalid;
  for (std::size_t f = 0; f < valid.size(); ++f)
    if (!valid[f])
      invalid.push_back(static_cast<int>(f));
  if (invalid.empty())
    return valid;
  int count = 0;
  Eigen::VectorXi sheet = vertex_components(mesh.faces(invalid, Eigen::all), static_cast<int>(mesh.vertices.rows()), &count);
  const Vertices normals = face_normals(mesh.vertices, mesh.faces);
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  Vertices facing = Vertices::Zero(count, 3);
  for (const int f : invalid)
    facing.row(sheet[mesh.faces(f, 0)]) += areas[f] * normals.row(f);
  facing.rowwise().normalize();
  for (std::vector<int> front = invalid; !front.empty();) { // ring after ring
    front.clear();
    for (int f = 0; f < mesh.faces.rows(); ++f)
      for (int c = 0; valid[f] && c < 3; ++c)
        if (const int s = sheet[mesh.faces(f, c)]; s >= 0 && normals.row(f).dot(facing.row(s)) > kSameWay) {
          valid[f] = 0;
          front.push_back(f);
        }
    for (const int f : front) {
      const int joined = mesh.faces.row(f).unaryExpr([&](int i) { return sheet[i]; }).maxCoeff();
      for (int c = 0; c < 3; ++c)
        if (int &s = sheet[mesh.faces(f, c)]; s < 0)
          s = joined;
    }
  }
  give_back_what_reaches_far(mesh, face_valid, valid);
  return valid;
}

} // namespace doublet
