#include "oriented_scan.h"

#include <utility>
#include <vector>

namespace doublet::detail {
namespace {

/// Does the face run from a to b?
bool runs(const Faces &faces, int face, int a, int b) {
  for (int k = 0; k < 3; ++k)
    if (faces(face, k) == a && faces(face, (k + 1) % 3) == b)
      return true;
  return false;
}

/// For every face the faces beside it, and whether they run the other way round.
std::vector<std::vector<std::pair<int, bool>>> beside(const Faces &faces) {
  std::vector<std::vector<std::pair<int, bool>>> out(faces.rows());
  const EdgeTopology topology = edge_topology(faces);
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto [f, g] = std::pair(topology.edge_faces[e][0], topology.edge_faces[e][1]);
    if (f < 0 || g < 0 || f == g)
      continue;
    const int a = topology.edges[e][0], b = topology.edges[e][1];
    const bool against = runs(faces, f, a, b) == runs(faces, g, a, b);
    out[f].push_back({g, against});
    out[g].push_back({f, against});
  }
  return out;
}

/// m^3, about the faces' mean corner.
double volume(const Mesh &mesh, const std::vector<int> &part) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (int f : part)
    centre += mesh.vertices(mesh.faces.row(f), Eigen::all).colwise().mean() / static_cast<double>(part.size());
  double sum = 0;
  for (int f : part) {
    const Eigen::Vector3d a = mesh.vertices.row(mesh.faces(f, 0)) - centre, b = mesh.vertices.row(mesh.faces(f, 1)) - centre,
                          c = mesh.vertices.row(mesh.faces(f, 2)) - centre;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

} // namespace

Mesh oriented_scan(const Mesh &scan) {
  Mesh out = scan;
  const auto neighbours = beside(scan.faces);
  const Eigen::VectorXd areas = face_areas(scan.vertices, scan.faces);
  const auto turn = [&](int f) { std::swap(out.faces(f, 1), out.faces(f, 2)); };
  std::vector<int> sign(neighbours.size(), 0); // 1: as the first face of its part, -1: the other way round
  double total = 0;
  for (int first = 0; first < static_cast<int>(sign.size()); ++first) {
    if (sign[first] != 0)
      continue;
    std::vector<int> part{first};
    sign[first] = 1;
    double balance = 0; // m^2, of the area that is as the first face
    for (std::size_t i = 0; i < part.size(); ++i) {
      balance += sign[part[i]] * areas[part[i]];
      for (const auto &[g, against] : neighbours[part[i]])
        if (sign[g] == 0) {
          sign[g] = against ? -sign[part[i]] : sign[part[i]];
          part.push_back(g);
        }
    }
    for (int f : part)
      if (sign[f] * balance < 0)
        turn(f);
    total += volume(out, part);
  }
  for (int f = 0; total < 0 && f < out.faces.rows(); ++f)
    turn(f);
  return out;
}

} // namespace doublet::detail
