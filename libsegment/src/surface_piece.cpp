#include "surface_piece.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/disjoint_sets.h"

#include <algorithm>
#include <map>
#include <set>

namespace doublet::detail {

Piece cut_out(const Mesh &mesh, const Eigen::VectorXd &field) {
  Piece piece;
  std::vector<Eigen::RowVector3d> points;
  std::vector<std::array<int, 3>> faces;
  std::map<std::array<int, 2>, int> index; // of a vertex (v, v) or of the point on an edge
  const auto point_at = [&](int a, int b) {
    const auto [it, fresh] = index.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(points.size()));
    if (fresh) {
      const double t = a == b ? 0.0 : (kCut - field[it->first[0]]) / (field[it->first[1]] - field[it->first[0]]);
      points.push_back(mesh.vertices.row(it->first[0]) + t * (mesh.vertices.row(it->first[1]) - mesh.vertices.row(it->first[0])));
    }
    return it->second;
  };
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    std::vector<int> ids; // of the polygon above the cut
    std::vector<Eigen::Vector3d> places;
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      if (field[a] > kCut) {
        ids.push_back(point_at(a, a));
        places.push_back(Eigen::Vector3d::Unit(k));
      }
      if ((field[a] > kCut) != (field[b] > kCut)) {
        const double t = (kCut - field[a]) / (field[b] - field[a]);
        ids.push_back(point_at(a, b));
        places.push_back((1 - t) * Eigen::Vector3d::Unit(k) + t * Eigen::Vector3d::Unit((k + 1) % 3));
      }
    }
    for (std::size_t k = 2; k < ids.size(); ++k) {
      faces.push_back({ids[0], ids[k - 1], ids[k]});
      piece.actor_face.push_back(f);
      piece.corners.push_back({places[0], places[k - 1], places[k]});
    }
  }
  piece.mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    piece.mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i];
  piece.mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    piece.mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return piece;
}

Vertices placed(const Piece &piece, const Faces &actor_faces, const Vertices &actor_vertices) {
  Vertices result(piece.mesh.vertices.rows(), 3);
  for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      Eigen::RowVector3d p = Eigen::RowVector3d::Zero();
      for (int j = 0; j < 3; ++j)
        p += piece.corners[f][k][j] * actor_vertices.row(actor_faces(piece.actor_face[f], j));
      result.row(piece.mesh.faces(f, k)) = p;
    }
  return result;
}

void require_manifold(const Mesh &mesh, const std::string &what) {
  std::map<std::array<int, 2>, int> corner; // (a, b): that at a of the face with this edge
  int repeated = 0;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      repeated += !corner.try_emplace({mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)}, 3 * f + k).second;
  DisjointSets fans(static_cast<int>(3 * mesh.faces.rows())); // corners at one vertex, across the edges there
  const auto next = [](int c) { return c - c % 3 + (c + 1) % 3; };
  for (const auto &[edge, c] : corner)
    if (const auto other = corner.find({edge[1], edge[0]}); other != corner.end()) {
      fans.unite(c, next(other->second));
      fans.unite(next(c), other->second);
    }
  std::vector<int> fan(static_cast<std::size_t>(mesh.vertices.rows()), -1);
  std::set<int> pinched;
  for (int c = 0; c < 3 * mesh.faces.rows(); ++c) {
    const int v = mesh.faces(c / 3, c % 3), root = fans.root(c);
    if (fan[v] >= 0 && fan[v] != root)
      pinched.insert(v);
    fan[v] = root;
  }
  if (repeated > 0 || !pinched.empty())
    throw Error(what + ": expected a manifold surface, found " + std::to_string(repeated) +
                " edges with several faces on one side and " + std::to_string(pinched.size()) +
                " vertices at which pieces touch; mend the template");
}

} // namespace doublet::detail
