#include "hidden_skin.h"

#include "body_weld.h"
#include "doublet/core/parts/quantile.h"
#include "garment_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Corners of the edges along which a garment ends free, or hangs.
struct GarmentEdges {
  std::vector<Vector3d> free, fixed;
  GarmentEdges(const Worn &garment, const Segmentation &segmentation) {
    const auto is_fixed = [&](int v) { return segmentation.clothness[garment.vertices[v]] == 0; };
    const EdgeTopology topology = edge_topology(garment.mesh.faces);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
      const Eigen::Vector2i &edge = topology.edges[e];
      if (topology.edge_faces[e][1] < 0)
        (is_fixed(edge[0]) && is_fixed(edge[1]) ? fixed : free).push_back(garment.mesh.vertices.row(edge[0]));
    }
  }
};

double distance_to(const std::vector<Vector3d> &points, const Vector3d &from) {
  double nearest = kInfinite;
  for (const Vector3d &point : points)
    nearest = std::min(nearest, (point - from).norm());
  return nearest;
}

} // namespace

std::vector<double> beyond_free_edges(const Character &c) {
  std::vector<double> away(static_cast<std::size_t>(c.high.vertices.rows()), kInfinite);
  if (c.garment_subdivisions < 0)
    return away;
  const GarmentPart part = garment_part(c);
  const GarmentEdges edges(part.garment, c.segmentation);
  for (Eigen::Index v = 0; v < part.skin_vertices; ++v) {
    const Vector3d at = c.high.vertices.row(v);
    if (const double free = distance_to(edges.free, at); free <= distance_to(edges.fixed, at))
      away[v] = free;
  }
  return away;
}

std::vector<double> from_the_seam(const Character &c, const std::vector<double> &away) {
  constexpr double kBeside = 0.30; // m from the free edges
  std::vector<Vector3d> seam;
  if (!c.high_body.empty()) {
    const GarmentPart part = garment_part(c);
    const Eigen::Index scan = part.skin_vertices - static_cast<Eigen::Index>(c.high_body.size());
    for (int v : weld_vertices(c.high.faces.topRows(part.skin_faces), scan))
      if (away[v] < kBeside)
        seam.push_back(c.high.vertices.row(v));
  }
  const EdgeTopology topology = edge_topology(valid_faces(c.high.faces, c.high_valid));
  for (std::size_t e = 0; e < topology.edges.size() && c.high_body.empty(); ++e)
    if (topology.edge_faces[e][1] < 0 && away[topology.edges[e][0]] < kBeside && away[topology.edges[e][1]] < kBeside)
      seam.push_back(c.high.vertices.row(topology.edges[e][0]));
  std::vector<double> distance(away.size(), kInfinite);
  for (std::size_t v = 0; v < away.size(); ++v)
    if (away[v] < 2 * kBeside)
      distance[v] = distance_to(seam, c.high.vertices.row(static_cast<Eigen::Index>(v)));
  return distance;
}

bool find_hidden_colour(Character &c, const std::vector<double> &away, const TexCoords &texcoords, const Image &image) {
  constexpr double kReach = 0.20; // m
  constexpr std::size_t kFewest = 20;
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  std::vector<Vector3d> found; // B G R
  for (int f = 0; f < c.high.faces.rows(); ++f) {
    const double farthest = std::max({away[c.high.faces(f, 0)], away[c.high.faces(f, 1)], away[c.high.faces(f, 2)]});
    if (farthest > kReach || !c.high_valid[f] || hidden[f])
      continue;
    const Eigen::Vector2d at = texcoords.middleRows(3 * f, 3).colwise().mean().transpose() * image.width;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    found.emplace_back(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
  }
  if (found.size() < kFewest)
    return false;
  std::sort(found.begin(), found.end(), [](const Vector3d &a, const Vector3d &b) { return a.sum() > b.sum(); });
  found.resize(found.size() / 2); // a shadow only darkens
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Vector3d &bgr : found)
      values.push_back(bgr[k]);
    c.body_colour[2 - k] = std::pow(median(values) / 255, kGamma);
  }
  return true;
}

} // namespace doublet::detail

namespace doublet {

std::vector<std::uint8_t> hidden_faces(const Character &c) {
  validate_character(c);
  std::vector<std::uint8_t> hidden(static_cast<std::size_t>(c.high.faces.rows()), 0);
  if (c.high_body.empty())
    return hidden;
  const detail::GarmentPart part = detail::garment_part(c);
  const Eigen::Index scan = part.skin_vertices - static_cast<Eigen::Index>(c.high_body.size());
  for (Eigen::Index f = 0; f < part.skin_faces; ++f)
    hidden[f] = c.high.faces.row(f).maxCoeff() >= scan;
  return hidden;
}

} // namespace doublet
