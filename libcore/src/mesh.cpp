#include "doublet/core/mesh.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/disjoint_sets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace doublet {

namespace {

constexpr double kDegenerateArea = 1e-14; // m^2: a triangle of 0.1 micrometre, below what float coordinates can hold

/// One side of a face: a -> b as the face runs.
struct HalfEdge {
  int low, high, face;
  bool forward; ///< runs from low to high
};

bool in_range(const Faces &faces, int f, int vertex_count) {
  return faces.row(f).minCoeff() >= 0 && faces.row(f).maxCoeff() < vertex_count;
}

void require_in_range(const Faces &faces, Eigen::Index vertex_count, const char *caller) {
  for (int f = 0; f < faces.rows(); ++f)
    if (!in_range(faces, f, static_cast<int>(vertex_count)))
      throw std::invalid_argument(std::string(caller) + ": face " + std::to_string(f) + " has a corner outside the " +
                                  std::to_string(vertex_count) + " vertices");
}

/// By edge, then face. Of a mesh they are dealt out by their lower vertex first, to each of which belong a few: a sort of all by
/// comparison takes five times as long.
void sort_by_edge(std::vector<HalfEdge> &edges) {
  const auto before = [](const HalfEdge &x, const HalfEdge &y) {
    return std::tie(x.low, x.high, x.face, x.forward) < std::tie(y.low, y.high, y.face, y.forward);
  };
  const auto [least, most] =
      std::minmax_element(edges.begin(), edges.end(), [](const HalfEdge &x, const HalfEdge &y) { return x.low < y.low; });
  if (edges.empty() || least->low < 0 || static_cast<std::size_t>(most->low) > 4 * edges.size()) {
    std::sort(edges.begin(), edges.end(), before);
    return;
  }
  std::vector<std::size_t> end(static_cast<std::size_t>(most->low) + 1, 0); // of each vertex's, once they are dealt out
  for (const HalfEdge &edge : edges)
    ++end[edge.low];
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  std::vector<HalfEdge> dealt(edges.size());
  for (const HalfEdge &edge : edges)
    dealt[end[edge.low]++] = edge;
  for (std::size_t v = 0, first = 0; v < end.size(); first = end[v++])
    std::sort(dealt.begin() + static_cast<std::ptrdiff_t>(first), dealt.begin() + static_cast<std::ptrdiff_t>(end[v]), before);
  edges = std::move(dealt);
}

/// Half-edges sorted by edge, then face; repeated corners and faces for which skip is set make none.
std::vector<HalfEdge> sorted_half_edges(const Faces &faces, const std::vector<bool> &skip = {}) {
  std::vector<HalfEdge> out;
  out.reserve(static_cast<std::size_t>(faces.rows()) * 3);
  for (int f = 0; f < faces.rows(); ++f) {
    if (!skip.empty() && skip[f])
      continue;
    for (int k = 0; k < 3; ++k) {
      const int a = faces(f, k), b = faces(f, (k + 1) % 3);
      if (a != b)
        out.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  }
  sort_by_edge(out);
  return out;
}

std::size_t edge_end(const std::vector<HalfEdge> &edges, std::size_t begin) {
  std::size_t end = begin;
  while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high)
    ++end;
  return end;
}

Eigen::Vector3d area_vector(const Vertices &vertices, const Faces &faces, int f) {
  const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
  return 0.5 * (b - a).cross(c - a);
}

/// Unit; zero for a degenerate face.
Eigen::Vector3d face_normal(const Vertices &vertices, const Faces &faces, int f) {
  const Eigen::Vector3d a = area_vector(vertices, faces, f);
  const double length = a.norm();
  return length >= kDegenerateArea ? Eigen::Vector3d(a / length) : Eigen::Vector3d::Zero();
}

/// Components over the faces whose corners are all in range.
int count_components(const Faces &faces, int vertex_count, Eigen::VectorXi &component) {
  DisjointSets sets(vertex_count);
  std::vector<bool> used(vertex_count, false);
  for (int f = 0; f < faces.rows(); ++f) {
    if (!in_range(faces, f, vertex_count))
      continue;
    sets.unite(faces(f, 0), faces(f, 1));
    sets.unite(faces(f, 0), faces(f, 2));
    for (int k = 0; k < 3; ++k)
      used[faces(f, k)] = true;
  }
  component.setConstant(vertex_count, -1);
  int count = 0;
  for (int v = 0; v < vertex_count; ++v)
    if (used[v])
      component[v] = sets.root(v) == v ? count++ : component[sets.root(v)];
  return count;
}

} // namespace

std::string MeshReport::to_string() const {
  std::string s = std::to_string(vertices) + " vertices, " + std::to_string(faces) + " faces, " + std::to_string(components) +
                  " components, " + (closed() ? "closed" : "open");
  const auto add = [&s](int n, const char *what) {
    if (n > 0)
      s += ", " + std::to_string(n) + " " + what;
  };
  add(non_finite_vertices, "non-finite vertices");
  add(out_of_range_faces, "faces with corners out of range");
  add(degenerate_faces, "degenerate faces");
  add(boundary_edges, "boundary edges");
  add(non_manifold_edges, "non-manifold edges");
  add(unused_vertices, "unused vertices");
  return s;
}

MeshReport report_mesh(const Mesh &mesh) {
  MeshReport r;
  r.vertices = static_cast<int>(mesh.vertices.rows());
  r.faces = static_cast<int>(mesh.faces.rows());
  for (int v = 0; v < r.vertices; ++v)
    r.non_finite_vertices += !mesh.vertices.row(v).allFinite();

  std::vector<bool> bad(r.faces, false);
  for (int f = 0; f < r.faces; ++f) {
    bad[f] = !in_range(mesh.faces, f, r.vertices);
    r.out_of_range_faces += bad[f];
    if (!bad[f])
      r.degenerate_faces += !(area_vector(mesh.vertices, mesh.faces, f).norm() >= kDegenerateArea);
  }
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh.faces, bad);
  for (std::size_t i = 0, end; i < edges.size(); i = end) {
    end = edge_end(edges, i);
    const std::size_t n = end - i;
    r.boundary_edges += n == 1;
    r.non_manifold_edges += n > 2 || (n == 2 && edges[i].forward == edges[i + 1].forward);
  }
  Eigen::VectorXi component;
  r.components = count_components(mesh.faces, r.vertices, component);
  r.unused_vertices = static_cast<int>((component.array() < 0).count());
  return r;
}

/// As MeshReport::usable() has it, without the rest of a report.
void require_usable(const Mesh &mesh, const std::string &what) {
  const bool usable = mesh.faces.rows() > 0 && mesh.vertices.rows() > 0 && mesh.vertices.allFinite() &&
                      mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < mesh.vertices.rows();
  if (!usable)
    throw Error(what + ": expected a mesh with faces, finite vertices and corners in range, found " +
                report_mesh(mesh).to_string());
}

Vertices face_normals(const Vertices &vertices, const Faces &faces) {
  require_in_range(faces, vertices.rows(), "face_normals");
  Vertices normals(faces.rows(), 3);
  for (int f = 0; f < faces.rows(); ++f)
    normals.row(f) = face_normal(vertices, faces, f);
  return normals;
}

void vertex_normals(const Vertices &vertices, const Faces &faces, Vertices &normals) {
  require_in_range(faces, vertices.rows(), "vertex_normals");
  normals.setZero(vertices.rows(), 3);
  for (int f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d of_face = face_normal(vertices, faces, f);
    if (of_face.isZero(0))
      continue;
    for (int k = 0; k < 3; ++k) {
      const int v = faces(f, k);
      const Eigen::Vector3d a = vertices.row(faces(f, (k + 1) % 3)) - vertices.row(v);
      const Eigen::Vector3d b = vertices.row(faces(f, (k + 2) % 3)) - vertices.row(v);
      normals.row(v) += std::atan2(a.cross(b).norm(), a.dot(b)) * of_face;
    }
  }
  for (int v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 1e-12)
      normals.row(v) /= length;
    else
      normals.row(v).setZero();
  }
}

Vertices vertex_normals(const Vertices &vertices, const Faces &faces) {
  Vertices normals;
  vertex_normals(vertices, faces, normals);
  return normals;
}

Eigen::VectorXd face_areas(const Vertices &vertices, const Faces &faces) {
  require_in_range(faces, vertices.rows(), "face_areas");
  Eigen::VectorXd areas(faces.rows());
  for (int f = 0; f < faces.rows(); ++f)
    areas[f] = area_vector(vertices, faces, f).norm();
  return areas;
}

Eigen::VectorXd vertex_areas(const Vertices &vertices, const Faces &faces) {
  const Eigen::VectorXd of_face = face_areas(vertices, faces);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.rows());
  for (int f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      areas[faces(f, k)] += of_face[f] / 3;
  return areas;
}

double mean_edge_length(const Vertices &vertices, const Faces &faces) {
  require_in_range(faces, vertices.rows(), "mean_edge_length");
  const std::vector<HalfEdge> edges = sorted_half_edges(faces);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < edges.size(); i = edge_end(edges, i), ++count)
    sum += (vertices.row(edges[i].low) - vertices.row(edges[i].high)).norm();
  return count ? sum / count : 0;
}

EdgeTopology edge_topology(const Faces &faces) {
  const std::vector<HalfEdge> edges = sorted_half_edges(faces);
  EdgeTopology out;
  for (std::size_t i = 0, end; i < edges.size(); i = end) {
    end = edge_end(edges, i);
    out.edges.emplace_back(edges[i].low, edges[i].high);
    out.edge_faces.emplace_back(edges[i].face, end - i > 1 ? edges[i + 1].face : -1);
  }
  return out;
}

std::vector<std::vector<int>> vertex_neighbours(const Faces &faces, int vertex_count) {
  require_in_range(faces, vertex_count, "vertex_neighbours");
  std::vector<std::vector<int>> out(vertex_count);
  for (const Eigen::Vector2i &e : edge_topology(faces).edges) {
    out[e[0]].push_back(e[1]);
    out[e[1]].push_back(e[0]);
  }
  for (std::vector<int> &n : out)
    std::sort(n.begin(), n.end());
  return out;
}

Eigen::VectorXi vertex_components(const Faces &faces, int vertex_count, int *count) {
  require_in_range(faces, vertex_count, "vertex_components");
  Eigen::VectorXi component;
  const int n = count_components(faces, vertex_count, component);
  if (count)
    *count = n;
  return component;
}

std::vector<Triplet> cotangent_laplacian(const Vertices &vertices, const Faces &faces) {
  require_in_range(faces, vertices.rows(), "cotangent_laplacian");
  const auto half_cotangent = [&](int f, int low, int high) {
    const int apex = faces.row(f).sum() - low - high;
    const Eigen::Vector3d a = vertices.row(low) - vertices.row(apex), b = vertices.row(high) - vertices.row(apex);
    const double doubled_area = a.cross(b).norm();
    return doubled_area >= 2 * kDegenerateArea ? 0.5 * a.dot(b) / doubled_area : 0.0;
  };
  const std::vector<HalfEdge> edges = sorted_half_edges(faces);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(vertices.rows());
  std::vector<Triplet> out;
  out.reserve(edges.size() + vertices.rows());
  for (std::size_t i = 0, end; i < edges.size(); i = end) {
    end = edge_end(edges, i);
    double w = 0;
    for (std::size_t k = i; k < end; ++k)
      w += half_cotangent(edges[k].face, edges[k].low, edges[k].high);
    w = std::max(w, 0.0);
    out.push_back({edges[i].low, edges[i].high, -w});
    out.push_back({edges[i].high, edges[i].low, -w});
    diagonal[edges[i].low] += w;
    diagonal[edges[i].high] += w;
  }
  for (int v = 0; v < vertices.rows(); ++v)
    out.push_back({v, v, diagonal[v]});
  return out;
}

Faces valid_faces(const Faces &faces, const std::vector<std::uint8_t> &face_valid) {
  Faces kept(faces.rows(), 3);
  int count = 0;
  for (int f = 0; f < faces.rows(); ++f)
    if (face_valid.empty() || face_valid[f])
      kept.row(count++) = faces.row(f);
  return kept.topRows(count);
}

Mesh submesh(const Mesh &mesh, const std::vector<int> &face_indices, std::vector<int> *vertex_from_sub) {
  std::vector<bool> used(mesh.vertices.rows(), false);
  for (const int f : face_indices) {
    if (f < 0 || f >= mesh.faces.rows() || !in_range(mesh.faces, f, static_cast<int>(mesh.vertices.rows())))
      throw std::invalid_argument("submesh: face " + std::to_string(f) + " is not one of the " +
                                  std::to_string(mesh.faces.rows()) + " faces, or has a corner out of range");
    for (int k = 0; k < 3; ++k)
      used[mesh.faces(f, k)] = true;
  }
  std::vector<int> old_index, new_index(used.size(), -1);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) {
      new_index[v] = static_cast<int>(old_index.size());
      old_index.push_back(static_cast<int>(v));
    }
  Mesh out;
  out.vertices.resize(old_index.size(), 3);
  for (std::size_t i = 0; i < old_index.size(); ++i)
    out.vertices.row(i) = mesh.vertices.row(old_index[i]);
  out.faces.resize(face_indices.size(), 3);
  for (std::size_t i = 0; i < face_indices.size(); ++i)
    for (int k = 0; k < 3; ++k)
      out.faces(i, k) = new_index[mesh.faces(face_indices[i], k)];
  if (vertex_from_sub)
    *vertex_from_sub = std::move(old_index);
  return out;
}

} // namespace doublet
