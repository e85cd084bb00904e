#include "hidden_skin.h"

#include "body_weld.h"
#include "doublet/core/parts/connected_sets.h"
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
constexpr double kBeside = 0.30, kFar = 0.60; // m from the free edges: where seams are looked for, and what is beside them
constexpr std::size_t kFewest = 20;           // triangles, of which a colour is known

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

/// The median of the brighter half: a shadow only darkens.
Vector3d lit_colour(std::vector<Vector3d> colours) {
  std::sort(colours.begin(), colours.end(), [](const Vector3d &a, const Vector3d &b) { return a.sum() > b.sum(); });
  colours.resize(colours.size() / 2);
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Vector3d &colour : colours)
      values.push_back(colour[k]);
    result[k] = median(values);
  }
  return result;
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

std::vector<std::vector<Vector3d>> seams_beside(const Character &c, const std::vector<double> &away) {
  const auto vertices = static_cast<int>(c.high.vertices.rows());
  Faces faces = valid_faces(c.high.faces, c.high_valid);
  std::vector<char> on_seam(static_cast<std::size_t>(vertices), 0);
  if (!c.high_body.empty()) {
    const GarmentPart part = garment_part(c);
    faces = c.high.faces.topRows(part.skin_faces);
    for (int v : weld_vertices(faces, part.skin_vertices - static_cast<Eigen::Index>(c.high_body.size())))
      on_seam[v] = away[v] < kBeside;
  }
  const EdgeTopology topology = edge_topology(faces);
  for (std::size_t e = 0; e < topology.edges.size() && c.high_body.empty(); ++e)
    for (int v : topology.edges[e])
      if (topology.edge_faces[e][1] < 0 && away[v] < kBeside)
        on_seam[v] = 1;
  std::vector<std::vector<Vector3d>> seams;
  for (const std::vector<int> &loop : connected_sets(vertex_neighbours(faces, vertices), on_seam)) {
    seams.emplace_back();
    for (int v : loop)
      seams.back().push_back(c.high.vertices.row(v));
  }
  return seams;
}

std::vector<double> from_the_seam(const Character &c, const std::vector<double> &away) {
  std::vector<double> distance(away.size(), kInfinite);
  for (const std::vector<Vector3d> &seam : seams_beside(c, away))
    for (std::size_t v = 0; v < away.size(); ++v)
      if (away[v] < kFar)
        distance[v] = std::min(distance[v], distance_to(seam, c.high.vertices.row(static_cast<Eigen::Index>(v))));
  return distance;
}

HiddenSkin::HiddenSkin(Character &c, const std::vector<double> &away, const TexCoords &texcoords, const Image &image) {
  for (std::vector<Vector3d> &points : seams_beside(c, away))
    seams_.push_back({std::move(points), Vector3d::Zero()});
  std::vector<Vector3d> all; // B G R
  std::vector<std::vector<Vector3d>> beside(seams_.size());
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  for (int f = 0; f < c.high.faces.rows(); ++f) {
    constexpr double kReach = 0.20; // m
    const double farthest = std::max({away[c.high.faces(f, 0)], away[c.high.faces(f, 1)], away[c.high.faces(f, 2)]});
    if (farthest > kReach || !c.high_valid[f] || hidden[f])
      continue;
    const Eigen::Vector2d at = texcoords.middleRows(3 * f, 3).colwise().mean().transpose() * image.width;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    all.emplace_back(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
    if (!seams_.empty())
      beside[nearest_seam(c.high.vertices.row(c.high.faces(f, 0)))].push_back(all.back());
  }
  if (!(is_known_ = all.size() >= kFewest))
    return;
  colour_ = lit_colour(all);
  c.body_colour = (colour_ / 255).array().pow(kGamma).matrix().reverse();
  for (std::size_t k = 0; k < seams_.size(); ++k)
    seams_[k].colour = beside[k].size() < kFewest ? colour_ : lit_colour(beside[k]);
}

std::size_t HiddenSkin::nearest_seam(const Vector3d &at) const {
  std::vector<double> distances;
  for (const Seam &seam : seams_)
    distances.push_back(distance_to(seam.points, at));
  return static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
}

HiddenSkin::Here HiddenSkin::at(const Vector3d &point) const {
  constexpr double kTouches = 1e-3; // m
  if (seams_.empty())
    return {kInfinite, colour_};
  Here here{kInfinite, Vector3d::Zero()};
  double sum = 0;
  for (const Seam &seam : seams_) {
    const double distance = distance_to(seam.points, point), share = std::pow(std::max(distance, kTouches), -4);
    here.distance = std::min(here.distance, distance);
    here.colour += share * seam.colour;
    sum += share;
  }
  here.colour /= sum;
  return here;
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
