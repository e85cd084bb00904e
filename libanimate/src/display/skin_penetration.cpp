#include "doublet/animate/parts/skin_penetration.h"

#include "body_weld.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/rays/ray_scene.h"
#include "garment_part.h"
#include "hidden_skin.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

constexpr double kDeep = 0.010;                       // m: faces are flat where the cloth folds inward between their corners
constexpr double kDeepAtSeam = 0.001, kDeepBend = 10; // m, 1/m: it must not show as a step where the garment hangs
constexpr double kReachOut = 0.06;                    // m
constexpr double kBeyondHem = 0.30;                   // m along the skin
constexpr double kSlope = 1;                          // m out for each beyond a free edge
constexpr double kAtEdge = 1e-9;                      // a barycentric coordinate
constexpr double kUnderSeam = 0.10, kAsWorn = 0.010;  // m along the skin from the body; from the garment in the scan pose
constexpr double kFold = 0.9;                         // cosine between the garment's normals above two corners of a face
constexpr double kFoldReach = 0.03;                   // m, all in all: moved farther, a corner would be a spike
constexpr int kRounds = 1;

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
  const RayScene cloth({c.high.vertices, c.high.faces.bottomRows(part.fine.faces.rows())});
  for (Eigen::Index v = 0; v < scan; ++v) {
    if (!(along[v] > 0 && along[v] < kBeyondHem))
      continue;
    const ClosestPoint at = cloth.closest(c.high.vertices.row(v));
    const bool worn = along[v] < kUnderSeam && at.distance < kAsWorn && at.barycentric.minCoeff() > kAtEdge;
    if (std::isfinite(beyond[v]) || worn)
      near.push_back(static_cast<int>(v));
  }
  return near;
}

} // namespace

SkinPenetrationFix::SkinPenetrationFix(const Character &c)
    : faces_(detail::garment_part(c).fine.faces), garment_({c.high.vertices.bottomRows(faces_.maxCoeff() + 1), faces_}) {
  const detail::GarmentPart part = detail::garment_part(c);
  for (int v : skin_near(c, part))
    skin_.push_back({v});
  std::vector<int> number(part.skin_vertices, -1);
  for (std::size_t i = 0; i < skin_.size(); ++i)
    number[skin_[i].vertex] = static_cast<int>(i);
  std::vector<Eigen::RowVector3i> between;
  for (Eigen::Index f = 0; f < part.skin_faces; ++f) {
    const Eigen::RowVector3i corners = c.high.faces.row(f).unaryExpr([&](int v) { return number[v]; });
    if (corners.minCoeff() >= 0)
      between.push_back(corners);
  }
  skin_faces_.resize(static_cast<Eigen::Index>(between.size()), 3);
  for (std::size_t f = 0; f < between.size(); ++f)
    skin_faces_.row(static_cast<Eigen::Index>(f)) = between[f];
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
  edges_.resize(faces_.rows(), {Edge::Inner, Edge::Inner, Edge::Inner});
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const Eigen::Vector2i &edge = topology.edges[e];
    if (topology.edge_faces[e][1] >= 0)
      continue;
    const bool fixed = clothness[edge[0]] + clothness[edge[1]] < 1e-9;
    if (fixed)
      seam.insert(seam.end(), {edge[0], edge[1]});
    const int f = topology.edge_faces[e][0];
    for (int k = 0; k < 3; ++k)
      if (faces_(f, k) != edge[0] && faces_(f, k) != edge[1])
        edges_[f][k] = fixed ? Edge::Seam : Edge::Free;
  }
  const Vertices cloth = c.high.vertices.bottomRows(part.fine.weights.rows());
  depths_ = edge_distances(cloth, vertex_neighbours(faces_, static_cast<int>(cloth.rows())), seam);
  depths_ = (kDeepAtSeam + kDeepBend * depths_.array().square()).min(kDeep);
}

void SkinPenetrationFix::apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body) {
  garment_.move_to(drawn.cloth);
  tuck(drawn.cloth_normals, skin_, high);
  tuck_across_folds(drawn.cloth_normals, high);
  if (body.rows() > 0)
    tuck(drawn.cloth_normals, body_, body);
}

double SkinPenetrationFix::outside(const Eigen::Vector3d &point, const Vertices &normals, int &last,
                                   Eigen::Vector3d &normal) const {
  const std::optional<MovingSurface::Point> at = garment_.closest(point, kReachOut, last);
  last = at ? at->face : -1;
  normal.setZero();
  if (!at)
    return 0;
  double deep = 0;
  bool beyond = false;
  for (int k = 0; k < 3; ++k) {
    const int v = faces_(at->face, k);
    normal += at->barycentric[k] * normals.row(v).transpose();
    deep += at->barycentric[k] * depths_[v];
    if (edges_[at->face][k] != Edge::Inner && at->barycentric[k] < kAtEdge) {
      if (edges_[at->face][k] == Edge::Seam)
        return 0; // above the garment
      beyond = true;
    }
  }
  normal.normalize();
  const double out = (point - at->point).dot(normal);
  const double most = -deep + (beyond ? kSlope * std::sqrt(std::max(0.0, at->distance * at->distance - out * out)) : 0.0);
  return std::max(0.0, out - most);
}

void SkinPenetrationFix::tuck(const Vertices &normals, std::vector<Tucked> &vertices, Vertices &positions) const {
  for (Tucked &tucked : vertices) {
    const Eigen::Vector3d p = positions.row(tucked.vertex);
    tucked.moved = 0;
    if (const double out = outside(p, normals, tucked.last, tucked.normal); out > 0)
      positions.row(tucked.vertex) -= out * tucked.normal.transpose();
  }
}

/// A face whose corners lie under different sides of a fold may have its middle before it.
void SkinPenetrationFix::tuck_across_folds(const Vertices &normals, Vertices &positions) {
  Eigen::Vector3d normal;
  for (Eigen::Index f = 0; f < skin_faces_.rows(); ++f) {
    const Tucked &a = skin_[skin_faces_(f, 0)], &b = skin_[skin_faces_(f, 1)], &c = skin_[skin_faces_(f, 2)];
    if (a.last < 0 || b.last < 0 || c.last < 0)
      continue;
    if (std::min({a.normal.dot(b.normal), b.normal.dot(c.normal), c.normal.dot(a.normal)}) > kFold)
      continue;
    int last = a.last;
    for (int round = 0; round < kRounds; ++round)
      for (int k = 0; k < 4; ++k) { // the middles of the edges, and of the face
        Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
        for (int i = 0; i < 3; ++i)
          if (i != k)
            middle += positions.row(skin_[skin_faces_(f, i)].vertex) / (k < 3 ? 2 : 3);
        const double out = outside(middle, normals, last, normal);
        for (int i = 0; i < 3 && out > 0; ++i)
          if (Tucked &corner = skin_[skin_faces_(f, i)]; i != k && corner.moved + out < kFoldReach) {
            positions.row(corner.vertex) -= out * normal.transpose();
            corner.moved += out;
          }
      }
  }
}

} // namespace doublet
