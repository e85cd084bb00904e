#include "doublet/core/error.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/core/parts/sparse_solve.h"
#include "doublet/options/options.h"
#include "doublet/rays/ray_scene.h"
#include "holes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace doublet::detail {
namespace {

constexpr double kLongBorder = 0.1; // m
/// Mean cosine: a sheet has the garment's back on both sides (towards -1), the bottom of a fold walls that face it (towards 1),
/// the wall of an undercut fold one of each.
constexpr double kBehind = -0.15;

/// (V) 1 where the vertex is far from the scan and the scan is sparse, or where the surface turns away from a scan that is rather
/// near: a sheet between a leg and a hem that nearly touch is nowhere far from both.
std::vector<std::uint8_t> invented_vertices(const Mesh &surface, const Eigen::VectorXd &density, const Mesh &scan,
                                            const TemplateOptions &options, const Context &context) {
  constexpr double kTurned = 0.5, kRatherNear = 1.0 / 3; // cosine of 60 degrees; of hole_gap, still above the noise of a scan
  const RayScene scene(scan);
  const Vertices normals = vertex_normals(surface.vertices, surface.faces),
                 scan_normals = face_normals(scan.vertices, scan.faces);
  const int count = static_cast<int>(surface.vertices.rows());
  std::vector<double> gap(count);
  std::vector<std::uint8_t> turned(count);
  parallel_for(context, count, [&](int v) {
    const ClosestPoint closest = scene.closest(surface.vertices.row(v));
    gap[v] = closest.distance;
    turned[v] = normals.row(v).dot(scan_normals.row(closest.face)) < kTurned;
  });
  std::vector<double> usual;
  for (int v = 0; v < count; ++v)
    if (gap[v] <= options.hole_gap && std::isfinite(density[v]))
      usual.push_back(density[v]);
  if (usual.empty())
    throw Error("scan: expected the reconstruction to follow the scan, found no point of it within " +
                options::to_text(options.hole_gap) + " m of the scan");
  const double sparse = median(usual) - options.density_drop;
  std::vector<std::uint8_t> invented(count);
  for (int v = 0; v < count; ++v)
    invented[v] =
        (gap[v] > options.hole_gap && !(density[v] >= sparse)) || (gap[v] > kRatherNear * options.hole_gap && turned[v]);
  return invented;
}

/// Shortest ways (m) along edges from the vertices with start[v] != 0, not beyond `limit`; infinity where nothing was reached.
Eigen::VectorXd distances_from(const Mesh &surface, const std::vector<std::vector<int>> &neighbours,
                               const std::vector<std::uint8_t> &start, double limit) {
  std::vector<int> starts;
  for (int v = 0; v < static_cast<int>(start.size()); ++v)
    if (start[v])
      starts.push_back(v);
  return edge_distances(surface.vertices, neighbours, starts, limit);
}

/// The vertices within `reach` (m, along edges) of `from`, itself included.
std::vector<int> within_reach(const Mesh &surface, const std::vector<std::vector<int>> &neighbours, int from, double reach) {
  std::map<int, double> distances{{from, 0.0}};
  propagate_along_edges(surface.vertices, neighbours, {from}, reach, [&](int v) -> double & {
    return distances.try_emplace(v, std::numeric_limits<double>::infinity()).first->second;
  });
  std::vector<int> found;
  for (const auto &[v, d] : distances)
    found.push_back(v);
  return found;
}

/// Morphological opening: drops what is narrower than twice `radius`.
std::vector<std::uint8_t> opened(const Mesh &surface, double radius, std::vector<std::uint8_t> invented) {
  const auto neighbours = vertex_neighbours(surface.faces, static_cast<int>(surface.vertices.rows()));
  std::vector<std::uint8_t> outside(invented.size()), core(invented.size());
  for (std::size_t v = 0; v < invented.size(); ++v)
    outside[v] = !invented[v];
  const Eigen::VectorXd depth = distances_from(surface, neighbours, outside, radius);
  for (std::size_t v = 0; v < invented.size(); ++v)
    core[v] = !(depth[v] <= radius);
  const Eigen::VectorXd reach = distances_from(surface, neighbours, core, radius);
  for (std::size_t v = 0; v < invented.size(); ++v)
    invented[v] = reach[v] <= radius && invented[v];
  return invented;
}

/// (F) 1 where two corners or three are marked.
std::vector<std::uint8_t> faces_of(const Mesh &surface, const std::vector<std::uint8_t> &vertices) {
  std::vector<std::uint8_t> faces(surface.faces.rows());
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f)
    faces[f] = vertices[surface.faces(f, 0)] + vertices[surface.faces(f, 1)] + vertices[surface.faces(f, 2)] >= 2;
  return faces;
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

/// The boundary loops of the regions that are longer than kLongBorder.
struct Borders {
  std::vector<int> count;     ///< per region
  std::vector<int> of_vertex; ///< (V) number of the border that a vertex lies on, -1 for none
};

Borders find_borders(const Mesh &surface, const std::vector<int> &region, int region_count, const EdgeTopology &topology) {
  std::vector<std::map<int, std::vector<std::pair<int, double>>>> edges(region_count);
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto pair = topology.edge_faces[e];
    const int a = pair[0] < 0 ? -1 : region[pair[0]], b = pair[1] < 0 ? -1 : region[pair[1]];
    if (a == b)
      continue;
    const int from = topology.edges[e][0], to = topology.edges[e][1];
    const double length = (surface.vertices.row(from) - surface.vertices.row(to)).norm();
    for (int r : {a, b})
      if (r >= 0) {
        edges[r][from].push_back({to, length});
        edges[r][to].push_back({from, length});
      }
  }
  Borders borders{std::vector<int>(region_count, 0), std::vector<int>(surface.vertices.rows(), -1)};
  int next = 0;
  for (int r = 0; r < region_count; ++r)
    while (!edges[r].empty()) {
      double twice = 0; // every edge is met from both ends
      std::vector<int> loop, stack{edges[r].begin()->first};
      while (!stack.empty()) {
        const auto at = edges[r].find(stack.back());
        stack.pop_back();
        if (at == edges[r].end())
          continue;
        loop.push_back(at->first);
        for (const auto &[to, length] : at->second) {
          twice += length;
          stack.push_back(to);
        }
        edges[r].erase(at);
      }
      if (twice / 2 <= kLongBorder)
        continue;
      ++borders.count[r];
      for (int v : loop)
        borders.of_vertex[v] = next;
      ++next;
    }
  return borders;
}

/// (V) how many borders are within `reach` (m, along edges).
std::vector<int> borders_within(const Mesh &surface, const Borders &borders, double reach) {
  const auto neighbours = vertex_neighbours(surface.faces, static_cast<int>(surface.vertices.rows()));
  std::vector<int> near(borders.of_vertex.size(), 0);
  for (int border = 0; border < std::accumulate(borders.count.begin(), borders.count.end(), 0); ++border) {
    std::vector<std::uint8_t> start(borders.of_vertex.size());
    for (std::size_t v = 0; v < start.size(); ++v)
      start[v] = borders.of_vertex[v] == border;
    const Eigen::VectorXd distance = distances_from(surface, neighbours, start, reach);
    for (std::size_t v = 0; v < near.size(); ++v)
      near[v] += distance[v] <= reach;
  }
  return near;
}

/// (V) For vertices of `chosen`: does the true surface around, within `reach` (m, along edges), face the vertex or turn its back
/// on it? The mean cosine between a true vertex's normal and the direction from there; 0 elsewhere.
std::vector<double> facing(const Mesh &surface, const std::vector<std::uint8_t> &chosen, double reach, const Context &context) {
  const int count = static_cast<int>(surface.vertices.rows());
  const auto neighbours = vertex_neighbours(surface.faces, count);
  const Vertices normals = vertex_normals(surface.vertices, surface.faces);
  std::vector<double> out(chosen.size(), 0);
  parallel_for(context, count, [&](int v) {
    if (!chosen[v])
      return;
    double sum = 0;
    int seen = 0;
    for (const int q : within_reach(surface, neighbours, v, reach))
      if (!chosen[q]) {
        sum += normals.row(q).dot((surface.vertices.row(v) - surface.vertices.row(q)).normalized());
        ++seen;
      }
    out[v] = seen > 0 ? sum / seen : 0;
  });
  return out;
}

/// (V) of `invented`, without folds of the garment that nobody saw: narrower than `width`, with the same border on either side
/// (two would be garment and limb that nearly touch), and not behind it. A sheet's tips are narrow, too, but behind the hem.
std::vector<std::uint8_t> without_folds(const Mesh &surface, const Borders &borders, double width,
                                        std::vector<std::uint8_t> invented, const std::vector<double> &facing) {
  const std::vector<std::uint8_t> broad = opened(surface, width / 2, invented);
  const std::vector<int> near = borders_within(surface, borders, width);
  for (std::size_t v = 0; v < invented.size(); ++v)
    if (!broad[v] && near[v] < 2 && facing[v] > kBehind)
      invented[v] = 0;
  return invented;
}

/// Drops the parts of `wide` that hung on the sheet by a fold only, wider places of it: small, with one border, not behind it.
void drop_islands(const Mesh &surface, const Borders &borders, const EdgeTopology &topology, double sheet_hole,
                  const std::vector<double> &facing, std::vector<std::uint8_t> &wide) {
  int count = 0;
  const std::vector<int> part = face_regions(wide, topology, &count);
  const Eigen::VectorXd areas = face_areas(surface.vertices, surface.faces);
  std::vector<double> area(count), faced(count);
  std::vector<std::set<int>> touched(count);
  for (std::size_t f = 0; f < part.size(); ++f)
    if (part[f] >= 0) {
      const double own = areas[static_cast<Eigen::Index>(f)];
      area[part[f]] += own;
      for (int k = 0; k < 3; ++k) {
        const int v = surface.faces(static_cast<Eigen::Index>(f), k);
        faced[part[f]] += own * facing[v];
        if (borders.of_vertex[v] >= 0)
          touched[part[f]].insert(borders.of_vertex[v]);
      }
    }
  for (std::size_t f = 0; f < part.size(); ++f)
    if (const int p = part[f]; p >= 0 && area[p] < sheet_hole && touched[p].size() < 2 && faced[p] > 3 * area[p] * kBehind)
      wide[f] = 0;
}

} // namespace

std::vector<HolePatch> find_holes(const Mesh &surface, const Eigen::VectorXd &density, const Mesh &scan,
                                  const TemplateOptions &options, const Context &context) {
  const auto invented = invented_vertices(surface, density, scan, options, context);
  const auto chosen = faces_of(surface, invented);
  const EdgeTopology topology = edge_topology(surface.faces);
  int count = 0;
  const std::vector<int> region = face_regions(chosen, topology, &count);
  const Borders borders = find_borders(surface, region, count, topology);
  const std::vector<double> faced = facing(surface, invented, options.narrow_hole, context);
  auto wide = faces_of(surface, without_folds(surface, borders, options.narrow_hole, invented, faced));
  drop_islands(surface, borders, topology, options.sheet_hole, faced, wide);
  const Eigen::VectorXd areas = face_areas(surface.vertices, surface.faces);
  std::vector<HolePatch> patches(count);
  for (int f = 0; f < static_cast<int>(region.size()); ++f)
    if (region[f] >= 0) {
      patches[region[f]].faces.push_back(f);
      if (wide[f])
        patches[region[f]].wide_faces.push_back(f);
      patches[region[f]].area += areas[f];
    }
  for (int r = 0; r < count; ++r)
    patches[r].borders = borders.count[r];
  std::stable_sort(patches.begin(), patches.end(), [](const HolePatch &a, const HolePatch &b) { return a.area > b.area; });
  return patches;
}

bool is_large(const HolePatch &patch, const TemplateOptions &options) {
  return patch.area >= options.large_hole || (patch.area >= options.sheet_hole && patch.borders >= 2);
}

void flatten(Mesh &surface, const std::vector<HolePatch> &patches) {
  std::vector<std::uint8_t> in_patch(surface.faces.rows(), 0);
  for (const HolePatch &patch : patches)
    for (int f : patch.faces)
      in_patch[f] = 1;
  std::vector<int> unknown(surface.vertices.rows(), -2); // -2: in no patch, -1: on a border, else the row of the system
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
  const Eigen::MatrixXd solution = solve_symmetric(entries, right, "the membrane over the holes of the surface");
  for (std::size_t v = 0; v < unknown.size(); ++v)
    if (unknown[v] >= 0)
      surface.vertices.row(static_cast<Eigen::Index>(v)) = solution.row(unknown[v]);
}

} // namespace doublet::detail
