#include "doublet/core/error.h"
#include "doublet/core/ray_scene.h"
#include "holes.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>

namespace doublet::detail {
namespace {

constexpr double kLongRim = 0.1; // m

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// (V) 1 where the vertex is far from the scan and the scan is sparse.
std::vector<std::uint8_t> invented_vertices(const Mesh &surface, const Eigen::VectorXd &density, const Mesh &scan,
                                            const TemplateOptions &options, const Context &context) {
  const RayScene scene(scan);
  const int count = static_cast<int>(surface.vertices.rows());
  std::vector<double> gap(count);
  parallel_for(context, count, [&](int v) { gap[v] = scene.closest(surface.vertices.row(v)).distance; });
  std::vector<double> usual;
  for (int v = 0; v < count; ++v)
    if (gap[v] <= options.hole_gap && std::isfinite(density[v]))
      usual.push_back(density[v]);
  if (usual.empty())
    throw Error("scan: expected the reconstruction to follow the scan, found no point of it within " +
                std::to_string(options.hole_gap) + " m of the scan");
  const double sparse = median(usual) - options.density_drop;
  std::vector<std::uint8_t> invented(count);
  for (int v = 0; v < count; ++v)
    invented[v] = gap[v] > options.hole_gap && !(density[v] >= sparse);
  return invented;
}

/// Numbers the connected regions (over edges) of faces with chosen[f] != 0; -1 elsewhere.
std::vector<int> face_regions(const std::vector<std::uint8_t> &chosen, const EdgeTopology &topology, int *count) {
  std::vector<std::vector<int>> neighbours(chosen.size());
  for (const Eigen::Vector2i &pair : topology.edge_faces)
    if (pair[0] >= 0 && pair[1] >= 0 && chosen[pair[0]] && chosen[pair[1]]) {
      neighbours[pair[0]].push_back(pair[1]);
      neighbours[pair[1]].push_back(pair[0]);
    }
  std::vector<int> region(chosen.size(), -1), stack;
  *count = 0;
  for (int f = 0; f < static_cast<int>(chosen.size()); ++f) {
    if (!chosen[f] || region[f] >= 0)
      continue;
    region[f] = *count;
    for (stack = {f}; !stack.empty();) {
      const int at = stack.back();
      stack.pop_back();
      for (int g : neighbours[at])
        if (region[g] < 0) {
          region[g] = *count;
          stack.push_back(g);
        }
    }
    ++*count;
  }
  return region;
}

/// Lengths of the connected sets of boundary edges of every region.
std::vector<int> count_long_rims(const Mesh &surface, const std::vector<int> &region, int count, const EdgeTopology &topology) {
  std::vector<std::map<int, std::vector<std::pair<int, double>>>> rims(count);
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto pair = topology.edge_faces[e];
    const int a = pair[0] < 0 ? -1 : region[pair[0]], b = pair[1] < 0 ? -1 : region[pair[1]];
    if (a == b)
      continue;
    const int from = topology.edges[e][0], to = topology.edges[e][1];
    const double length = (surface.vertices.row(from) - surface.vertices.row(to)).norm();
    for (int r : {a, b})
      if (r >= 0) {
        rims[r][from].push_back({to, length});
        rims[r][to].push_back({from, length});
      }
  }
  std::vector<int> long_rims(count, 0);
  for (int r = 0; r < count; ++r)
    while (!rims[r].empty()) {
      double twice = 0; // every edge is met from both ends
      std::vector<int> stack{rims[r].begin()->first};
      while (!stack.empty()) {
        const auto at = rims[r].find(stack.back());
        stack.pop_back();
        if (at == rims[r].end())
          continue;
        for (const auto &[to, length] : at->second) {
          twice += length;
          stack.push_back(to);
        }
        rims[r].erase(at);
      }
      long_rims[r] += twice / 2 > kLongRim;
    }
  return long_rims;
}

} // namespace

std::vector<HolePatch> find_holes(const Mesh &surface, const Eigen::VectorXd &density, const Mesh &scan,
                                  const TemplateOptions &options, const Context &context) {
  const auto invented = invented_vertices(surface, density, scan, options, context);
  std::vector<std::uint8_t> chosen(surface.faces.rows());
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f)
    chosen[f] = invented[surface.faces(f, 0)] + invented[surface.faces(f, 1)] + invented[surface.faces(f, 2)] >= 2;
  const EdgeTopology topology = edge_topology(surface.faces);
  int count = 0;
  const std::vector<int> region = face_regions(chosen, topology, &count);
  const std::vector<int> rims = count_long_rims(surface, region, count, topology);
  const Eigen::VectorXd areas = face_areas(surface.vertices, surface.faces);
  std::vector<HolePatch> patches(count);
  for (int f = 0; f < static_cast<int>(region.size()); ++f)
    if (region[f] >= 0) {
      patches[region[f]].faces.push_back(f);
      patches[region[f]].area += areas[f];
    }
  for (int r = 0; r < count; ++r)
    patches[r].rims = rims[r];
  std::stable_sort(patches.begin(), patches.end(), [](const HolePatch &a, const HolePatch &b) { return a.area > b.area; });
  return patches;
}

bool is_large(const HolePatch &patch, const TemplateOptions &options) {
  return patch.area >= options.large_hole || (patch.area >= options.sheet_hole && patch.rims >= 2);
}

void flatten(Mesh &surface, const std::vector<HolePatch> &patches) {
  std::vector<std::uint8_t> in_patch(surface.faces.rows(), 0);
  for (const HolePatch &patch : patches)
    for (int f : patch.faces)
      in_patch[f] = 1;
  std::vector<int> unknown(surface.vertices.rows(), -2); // -2: in no patch, -1: on a rim, else the row of the system
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f)
    if (in_patch[f])
      for (int k = 0; k < 3; ++k)
        unknown[surface.faces(f, k)] = 0;
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f)
    if (!in_patch[f])
      for (int k = 0; k < 3; ++k)
        if (int &u = unknown[surface.faces(f, k)]; u >= 0)
          u = -1;
  int count = 0;
  for (int &u : unknown)
    if (u >= 0)
      u = count++;
  if (count == 0)
    return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  for (const Eigen::Vector2i &edge : edge_topology(surface.faces).edges)
    for (int side = 0; side < 2; ++side) {
      const int a = unknown[edge[side]], b = edge[1 - side];
      if (a < 0)
        continue;
      entries.emplace_back(a, a, 1.0);
      if (unknown[b] >= 0)
        entries.emplace_back(a, unknown[b], -1.0);
      else
        right.row(a) += surface.vertices.row(b);
    }
  Eigen::SparseMatrix<double> laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixXd solution = solver.solve(right);
  if (solver.info() != Eigen::Success || !solution.allFinite())
    throw Error("surface: the membrane over its holes could not be computed");
  for (std::size_t v = 0; v < unknown.size(); ++v)
    if (unknown[v] >= 0)
      surface.vertices.row(static_cast<Eigen::Index>(v)) = solution.row(unknown[v]);
}

} // namespace doublet::detail
