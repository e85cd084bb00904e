#include "doublet/animate/parts/skin_penetration.h"

#include "body_weld.h"
#include "doublet/core/parts/edge_distances.h"
#include "garment_part.h"
#include "hidden_skin.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace doublet {
namespace {

constexpr double kDeep = 0.010;      // m: faces are flat where the cloth folds inward between their corners
constexpr double kDeepAtSeam = 0.0003, kDeepBend = 10; // m, 1/m: it must not show as a step where the garment hangs
constexpr double kReachOut = 0.06;   // m
constexpr double kBeyondHem = 0.30;  // m along the skin
constexpr double kSlope = 1;         // m out for each beyond a free edge
constexpr double kAtEdge = 1e-9;     // a barycentric coordinate

/// What of the person's skin may come to lie under the garment.
std::vector<int> skin_near(const Character &c, const detail::GarmentPart &part) {
  const Faces skin = c.high.faces.topRows(part.skin_faces);
  const auto neighbours = vertex_neighbours(skin, static_cast<int>(part.skin_vertices));
  const Eigen::Index scan = part.skin_vertices - static_cast<Eigen::Index>(c.high_body.size());
  std::vector<int> ends;
  for (Eigen::Index v = scan; v < part.skin_vertices; ++v)
    ends.push_back(static_cast<int>(v));
  const std::vector<double> beyond = detail::beyond_free_edges(c);
  const std::vector<double> away = detail::from_the_seam(c, beyond);
  for (Eigen::Index v = 0; v < scan && c.high_body.empty(); ++v)
    if (away[v] == 0)
      ends.push_back(static_cast<int>(v));
  const Eigen::VectorXd along = edge_distances(c.high.vertices, neighbours, ends, kBeyondHem);
  std::vector<int> near = std::move(ends);
  for (Eigen::Index v = 0; v < scan; ++v)
    if (along[v] > 0 && along[v] < kBeyondHem && std::isfinite(beyond[v]))
      near.push_back(static_cast<int>(v));
  return near;
}

} // namespace

SkinPenetrationFix::SkinPenetrationFix(const Character &c)
    : faces_(detail::garment_part(c).fine.faces), garment_({c.high.vertices.bottomRows(faces_.maxCoeff() + 1), faces_}) {
  const detail::GarmentPart part = detail::garment_part(c);
  for (int v : skin_near(c, part))
    skin_.push_back({v});
  std::vector<std::uint8_t> drawn(c.body.vertices.rows(), 0);
  for (Eigen::Index f = 0; f < c.body.faces.rows(); ++f)
    for (int k = 0; k < 3 && c.body_shown[f]; ++k)
      drawn[c.body.faces(f, k)] = 1;
  for (std::size_t v = 0; v < drawn.size(); ++v)
    if (drawn[v])
      body_.push_back({static_cast<int>(v)});

  Eigen::VectorXd coarse(part.garment.vertices.size());
  for (Eigen::Index v = 0; v < coarse.size(); ++v)
    coarse[v] = c.segmentation.clothness[part.garment.vertices[v]];
  const Eigen::VectorXd clothness = part.fine.weights * coarse;
  const EdgeTopology topology = edge_topology(faces_);
  std::vector<int> seam;
  edges_.resize(faces_.rows(), {0, 0, 0});
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const Eigen::Vector2i &edge = topology.edges[e];
    if (topology.edge_faces[e][1] >= 0)
      continue;
    if (clothness[edge[0]] + clothness[edge[1]] < 1e-9) {
      seam.insert(seam.end(), {edge[0], edge[1]});
      continue;
    }
    const int f = topology.edge_faces[e][0];
    for (int k = 0; k < 3; ++k)
      edges_[f][k] |= faces_(f, k) != edge[0] && faces_(f, k) != edge[1];
  }
  const Vertices cloth = c.high.vertices.bottomRows(part.fine.weights.rows());
  depths_ = edge_distances(cloth, vertex_neighbours(faces_, static_cast<int>(cloth.rows())), seam);
  depths_ = (kDeepAtSeam + kDeepBend * depths_.array().square()).min(kDeep);
}

void SkinPenetrationFix::apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body) {
  garment_.move_to(drawn.cloth);
  tuck(drawn.cloth_normals, skin_, high);
  if (body.rows() > 0)
    tuck(drawn.cloth_normals, body_, body);
}

void SkinPenetrationFix::tuck(const Vertices &normals, std::vector<Tucked> &vertices, Vertices &positions) const {
  for (Tucked &tucked : vertices) {
    const Eigen::Vector3d p = positions.row(tucked.vertex);
    const std::optional<MovingSurface::Point> at = garment_.closest(p, kReachOut, tucked.last);
    tucked.last = at ? at->face : -1;
    if (!at)
      continue;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double deep = 0;
    for (int k = 0; k < 3; ++k) {
      const int v = faces_(at->face, k);
      normal += at->barycentric[k] * normals.row(v).transpose();
      deep += at->barycentric[k] * depths_[v];
    }
    normal.normalize();
    const double out = (p - at->point).dot(normal);
    bool beyond = false;
    for (int k = 0; k < 3; ++k)
      beyond |= edges_[at->face][k] && at->barycentric[k] < kAtEdge;
    const double most = -deep + (beyond ? kSlope * std::sqrt(std::max(0.0, at->distance * at->distance - out * out)) : 0.0);
    if (out > most)
      positions.row(tucked.vertex) += (most - out) * normal.transpose();
  }
}

} // namespace doublet
