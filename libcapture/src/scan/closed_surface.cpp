#include "closed_surface.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/boundary_loops.h"
#include "doublet/core/parts/disjoint_sets.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>

namespace doublet::detail {
namespace {

using Face = std::array<int, 3>;
using FaceList = std::vector<Face>;

std::uint64_t directed(int a, int b) {
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
}

FaceList proper_faces(const Faces &faces) {
  FaceList out;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Face face{faces(f, 0), faces(f, 1), faces(f, 2)};
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0])
      out.push_back(face);
  }
  return out;
}

/// Every directed edge may occur once; faces at one that occurs more often go, all of them.
FaceList without_bad_edges(const FaceList &faces) {
  std::unordered_map<std::uint64_t, int> uses;
  for (const Face &f : faces)
    for (int k = 0; k < 3; ++k)
      ++uses[directed(f[k], f[(k + 1) % 3])];
  FaceList out;
  for (const Face &f : faces) {
    bool good = true;
    for (int k = 0; k < 3; ++k)
      good = good && uses[directed(f[k], f[(k + 1) % 3])] == 1 && uses[directed(f[(k + 1) % 3], f[k])] <= 1;
    if (good)
      out.push_back(f);
  }
  return out;
}

/// Gives every fan of faces around a vertex (faces joined by edges at that vertex) a vertex of its own.
void split_fans(FaceList &faces, std::vector<int> &source) {
  std::unordered_map<std::uint64_t, int> face_of_edge;
  for (int f = 0; f < static_cast<int>(faces.size()); ++f)
    for (int k = 0; k < 3; ++k)
      face_of_edge[directed(faces[f][k], faces[f][(k + 1) % 3])] = f;
  // Corners are the nodes, corners of one vertex across a shared edge are joined: one set is one fan.
  const int corners = 3 * static_cast<int>(faces.size());
  DisjointSets fans(corners);
  for (int f = 0; f < static_cast<int>(faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      const auto other = face_of_edge.find(directed(b, a));
      if (other == face_of_edge.end())
        continue;
      const Face &g = faces[other->second];
      const int ka = static_cast<int>(std::find(g.begin(), g.end(), a) - g.begin());
      const int kb = static_cast<int>(std::find(g.begin(), g.end(), b) - g.begin());
      fans.unite(3 * f + k, 3 * other->second + ka);
      fans.unite(3 * f + (k + 1) % 3, 3 * other->second + kb);
    }
  std::vector<int> fan_of_vertex(source.size(), -1), vertex_of_fan(corners, -1);
  for (int c = 0; c < corners; ++c) {
    const int fan = fans.root(c);
    int &corner = faces[c / 3][c % 3];
    if (vertex_of_fan[fan] < 0) {
      if (fan_of_vertex[corner] < 0) {
        fan_of_vertex[corner] = fan;
        vertex_of_fan[fan] = corner;
      } else {
        vertex_of_fan[fan] = static_cast<int>(source.size());
        source.push_back(source[corner]);
      }
    }
    corner = vertex_of_fan[fan];
  }
}

Mesh largest_component(const Mesh &mesh, std::vector<int> &old_vertex) {
  int count = 0;
  const Eigen::VectorXi component = vertex_components(mesh.faces, static_cast<int>(mesh.vertices.rows()), &count);
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  Eigen::VectorXd total = Eigen::VectorXd::Zero(count);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    total[component[mesh.faces(f, 0)]] += areas[f];
  Eigen::Index largest = 0;
  total.maxCoeff(&largest);
  std::vector<int> chosen, from_sub;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (component[mesh.faces(f, 0)] == largest)
      chosen.push_back(f);
  const Mesh out = submesh(mesh, chosen, &from_sub);
  std::vector<int> old(from_sub.size());
  for (std::size_t i = 0; i < old.size(); ++i)
    old[i] = old_vertex[from_sub[i]];
  old_vertex = old;
  return out;
}

/// The loops of boundary edges, against the direction of the faces beside them: the order in which a filling face runs.
std::vector<std::vector<int>> loops_to_fill(const Faces &faces) {
  std::vector<std::vector<int>> loops = boundary_loops(faces); // fans were split, so one boundary edge leaves a vertex
  for (std::vector<int> &loop : loops)
    std::reverse(loop.begin() + 1, loop.end());
  return loops;
}

/// A fan from the loop's centroid; a single triangle for a loop of three.
void fill_loop(const std::vector<int> &loop, Mesh &mesh, std::vector<int> &old_vertex) {
  const Eigen::Index first = mesh.faces.rows();
  if (loop.size() == 3) {
    mesh.faces.conservativeResize(first + 1, 3);
    mesh.faces.row(first) << loop[0], loop[1], loop[2];
    return;
  }
  const int centre = static_cast<int>(mesh.vertices.rows());
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (int v : loop)
    sum += mesh.vertices.row(v);
  mesh.vertices.conservativeResize(centre + 1, 3);
  mesh.vertices.row(centre) = sum / static_cast<double>(loop.size());
  old_vertex.push_back(-1);
  mesh.faces.conservativeResize(first + static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t k = 0; k < loop.size(); ++k)
    mesh.faces.row(first + static_cast<Eigen::Index>(k)) << loop[k], loop[(k + 1) % loop.size()], centre;
}

} // namespace

Mesh closed_surface(const Mesh &mesh, std::vector<int> &old_vertex) {
  FaceList faces = without_bad_edges(proper_faces(mesh.faces));
  if (faces.empty())
    throw Error("surface: expected a mesh that can be closed, found no manifold triangle in it");
  old_vertex.resize(mesh.vertices.rows());
  std::iota(old_vertex.begin(), old_vertex.end(), 0);
  split_fans(faces, old_vertex);
  Mesh out;
  out.vertices.resize(static_cast<Eigen::Index>(old_vertex.size()), 3);
  for (std::size_t v = 0; v < old_vertex.size(); ++v)
    out.vertices.row(static_cast<Eigen::Index>(v)) = mesh.vertices.row(old_vertex[v]);
  out.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    out.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  out = largest_component(out, old_vertex);
  for (const auto &loop : loops_to_fill(out.faces))
    fill_loop(loop, out, old_vertex);
  if (const MeshReport report = report_mesh(out); !report.closed())
    throw Error("surface: expected a closed manifold surface after repair, found " + report.to_string());
  return out;
}

} // namespace doublet::detail
