#pragma once
// A triangle mesh, its checks and basic measures.

#include "doublet/core/types.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

struct Mesh {
  Vertices vertices; ///< (V, 3) metres
  Faces faces;       ///< (F, 3)
};

/// What is wrong, or right, with a mesh. A stage asks before it starts.
struct MeshReport {
  int vertices = 0, faces = 0;
  int non_finite_vertices = 0;
  int out_of_range_faces = 0; ///< a corner index < 0 or >= V
  int degenerate_faces = 0;   ///< repeated corner, or area below 1e-14 m^2
  int boundary_edges = 0;     ///< edges with one face
  int non_manifold_edges = 0; ///< edges with more than two faces, or two faces in the same direction
  int unused_vertices = 0;
  int components = 0; ///< connected components of faces
  bool closed() const { return boundary_edges == 0 && non_manifold_edges == 0; }
  /// Finite, in range, not empty: what no stage can do without.
  bool usable() const { return faces > 0 && vertices > 0 && non_finite_vertices == 0 && out_of_range_faces == 0; }
  std::string to_string() const; ///< one line
};

MeshReport report_mesh(const Mesh &mesh);
/// Throws Error naming `what` unless report_mesh(mesh).usable().
void require_usable(const Mesh &mesh, const std::string &what);

/// (F, 3) unit normals; zero for degenerate faces.
Vertices face_normals(const Vertices &vertices, const Faces &faces);
/// (V, 3) unit normals, weighted by angle; zero where no face is.
Vertices vertex_normals(const Vertices &vertices, const Faces &faces);
void vertex_normals(const Vertices &vertices, const Faces &faces, Vertices &normals);
/// (F) areas, m^2.
Eigen::VectorXd face_areas(const Vertices &vertices, const Faces &faces);
/// (V) one third of the adjacent face areas, m^2.
Eigen::VectorXd vertex_areas(const Vertices &vertices, const Faces &faces);
/// m; 0 without edges. Throws std::invalid_argument on indices out of range.
double mean_edge_length(const Vertices &vertices, const Faces &faces);

/// Undirected edges (a < b), sorted; with the one or two faces beside each (-1 where there is none).
struct EdgeTopology {
  std::vector<Eigen::Vector2i> edges;
  std::vector<Eigen::Vector2i> edge_faces;
};
EdgeTopology edge_topology(const Faces &faces);
/// Neighbouring vertices by edge, sorted, for each of vertex_count vertices.
std::vector<std::vector<int>> vertex_neighbours(const Faces &faces, int vertex_count);
/// Connected components over `faces` (by shared vertices): per vertex the component, -1 for unused vertices; numbered by lowest
/// vertex.
Eigen::VectorXi vertex_components(const Faces &faces, int vertex_count, int *count = nullptr);

/// Entries (row, column, value) of the cotangent Laplacian L = D - W, (V, V), with W_ij = (cot a + cot b) / 2, clamped to >= 0.
/// Positive semi-definite; row sums are zero. Pinkall & Polthier 1993.
struct Triplet {
  int row, col;
  double value;
};
std::vector<Triplet> cotangent_laplacian(const Vertices &vertices, const Faces &faces);

/// The faces with face_valid[f] != 0; all of them if the mask is empty.
Faces valid_faces(const Faces &faces, const Mask &face_valid);

/// The mesh of the chosen faces with unused vertices dropped; `vertex_from_sub[i]` is the old index of new vertex i.
Mesh submesh(const Mesh &mesh, const std::vector<int> &face_indices, std::vector<int> *vertex_from_sub = nullptr);

} // namespace doublet
