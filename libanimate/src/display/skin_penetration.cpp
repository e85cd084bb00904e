#include "doublet/animate/parts/skin_penetration.h"

#include "arms.h"
#include "body_weld.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/rays/ray_scene.h"
#include "garment_part.h"
#include "hidden_skin.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

using Cover = SkinPenetrationFix::Cover;

constexpr double kDeep = 0.020; // m: faces are flat where the cloth folds inward between their corners ...
constexpr double kDeepAtHem = 0.010, kDeepPerWay = 0.25; // ... from m, by m for each from a free edge
constexpr double kDeepAtSeam = 0.001, kDeepBend = 10;    // m, 1/m: it must not show as a step where the garment hangs
constexpr double kReachOut = 0.03;                       // m
// Skin that no garment covers in the scan pose, as of a back over which a skirt is thrown: m; only where the cloth lies within
// it, which is where the way to it goes inwards (cosine), not beside it.
constexpr double kDeepBare = 0.002, kReachBare = 0.015, kBeside = 0.3, kWithin = 0.7;
constexpr double kBeyondHem = 0.30; // m along the skin
constexpr double kSlope = 1;        // m out for each beyond a free edge
constexpr double kAtEdge = 1e-9;    // a barycentric coordinate
constexpr double kAsWorn = 0.010;   // m from the garment in the scan pose
// Cosine between the normals of skin and garment: less is moved less, none of what the cloth lies on inside out.
constexpr double kFacing = 0.2;
constexpr double kStandsOut = 1e-4;            // m
constexpr int kLooks = 3;                      // on the way in
constexpr double kFlat = 0.8, kShallow = 0.02; // cosine; m
constexpr double kOblique = 0.3;               // of out for each in, at least
constexpr double kDeepestTuck = 0.09;          // m
constexpr double kWall = 0.3;                  // m in for each along the skin, of skin beside what goes in
constexpr int kGoAlong = 2;                    // times over all edges
constexpr double kOfBoth = 0.1;                // skin weight, above which the garment is of an arm, and of the rest, too

/// (V, 3) share of the skin weights (V, J) that the rest of the person, left and right arm have.
MatrixRM limb_shares(const MatrixRM &weights, const std::vector<int> &arms) {
  MatrixRM shares = MatrixRM::Zero(weights.rows(), 3);
  for (Eigen::Index j = 0; j < weights.cols(); ++j) // none without a body
    shares.col(arms[j]) += weights.col(j);
  return shares;
}

int largest(const MatrixRM &shares, Eigen::Index v) {
  Eigen::Index limb;
  shares.row(v).maxCoeff(&limb);
  return static_cast<int>(limb);
}

/// (skin) how the garment lies in the scan pose on M_high's skin: the scan's, and the body that goes on under it.
std::vector<Cover> cover_of_skin(const Character &c, const detail::GarmentPart &part) {
  const Faces skin = c.high.faces.topRows(part.skin_faces);
  const auto neighbours = vertex_neighbours(skin, static_cast<int>(part.skin_vertices));
  const Eigen::Index scan = part.skin_vertices - static_cast<Eigen::Index>(c.high_body.size());
  std::vector<Cover> cover(static_cast<std::size_t>(part.skin_vertices), Cover::Bare);
  std::vector<int> ends;
  for (Eigen::Index v = scan; v < part.skin_vertices; ++v) {
    cover[v] = Cover::Worn;
    ends.push_back(static_cast<int>(v));
  }
  const std::vector<double> beyond = detail::beyond_free_edges(c);
  const std::vector<double> away = detail::from_the_seam(c, beyond);
  for (Eigen::Index v = 0; v < scan && c.high_body.empty(); ++v)
    if (away[v] == 0)
      ends.push_back(static_cast<int>(v));
  const Eigen::VectorXd along = edge_distances(c.high.vertices, neighbours, ends, kBeyondHem);
  const RayScene cloth({c.high.vertices, c.high.faces.bottomRows(part.fine.faces.rows())});
  for (Eigen::Index v = 0; v < scan; ++v) {
    const ClosestPoint at = cloth.closest(c.high.vertices.row(v));
    if (at.distance < kAsWorn && at.barycentric.minCoeff() > kAtEdge)
      cover[v] = Cover::Worn;
    else if (along[v] < kBeyondHem && std::isfinite(beyond[v]))
      cover[v] = Cover::BeyondHem;
  }
  return cover;
}

} // namespace

SkinPenetrationFix::SkinPenetrationFix(const Character &c, const DisplaySurface &display) {
  const detail::GarmentPart part = detail::garment_part(c);
  faces_ = part.fine.faces;
  const std::vector<int> arms = detail::arms_of_joints(c.actor.skeleton);
  const MatrixRM of_skin = limb_shares(display.skin_weights(c.actor.weights), arms), of_body = limb_shares(c.body_weights, arms);
  const std::vector<Cover> cover = cover_of_skin(c, part);
  for (std::size_t v = 0; v < cover.size(); ++v)
    skin_.vertices.push_back({static_cast<int>(v), cover[v], largest(of_skin, static_cast<Eigen::Index>(v))});
  skin_.bound(c.high.faces.topRows(part.skin_faces), part.skin_vertices);
  const Faces shown = valid_faces(c.body.faces, c.body_shown);
  std::vector<std::uint8_t> drawn(c.body.vertices.rows(), 0);
  for (int v : shown.reshaped())
    drawn[v] = 1;
  for (std::size_t v = 0; v < drawn.size(); ++v)
    if (drawn[v])
      body_.vertices.push_back({static_cast<int>(v), Cover::Worn, largest(of_body, static_cast<Eigen::Index>(v))});
  body_.bound(shown, c.body.vertices.rows());

  Eigen::VectorXd coarse(part.garment.vertices.size());
  for (Eigen::Index v = 0; v < coarse.size(); ++v)
    coarse[v] = c.segmentation.clothness[part.garment.vertices[v]];
  const Eigen::VectorXd clothness = part.fine.weights * coarse;
  const EdgeTopology topology = edge_topology(faces_);
  std::vector<int> seam, hem;
  std::vector<std::array<Edge, 3>> edges(faces_.rows(), {Edge::Inner, Edge::Inner, Edge::Inner});
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const Eigen::Vector2i &edge = topology.edges[e];
    if (topology.edge_faces[e][1] >= 0)
      continue;
    const bool fixed = clothness[edge[0]] + clothness[edge[1]] < 1e-9;
    std::vector<int> &ends = fixed ? seam : hem;
    ends.insert(ends.end(), {edge[0], edge[1]});
    const int f = topology.edge_faces[e][0];
    for (int k = 0; k < 3; ++k)
      if (faces_(f, k) != edge[0] && faces_(f, k) != edge[1])
        edges[f][k] = fixed ? Edge::Seam : Edge::Free;
  }
  const Vertices cloth = c.high.vertices.bottomRows(part.fine.weights.rows());
  const auto neighbours = vertex_neighbours(faces_, static_cast<int>(cloth.rows()));
  const Eigen::ArrayXd from_seam = edge_distances(cloth, neighbours, seam), from_hem = edge_distances(cloth, neighbours, hem);
  for (int limb = 0; limb < of_skin.cols(); ++limb)
    add_sheet(cloth, of_skin.col(limb).tail(cloth.rows()), topology, edges);
  depths_ = (kDeepAtSeam + kDeepBend * from_seam.square()).min(kDeepAtHem + kDeepPerWay * from_hem).min(kDeep);
}

/// The faces of the garment that are over a limb, by its share of their corners' skin weights.
void SkinPenetrationFix::add_sheet(const Vertices &cloth, const Eigen::VectorXd &share, const EdgeTopology &topology,
                                   const std::vector<std::array<Edge, 3>> &edges) {
  Mask over(faces_.rows());
  for (Eigen::Index f = 0; f < faces_.rows(); ++f)
    over[f] = share[faces_(f, 0)] + share[faces_(f, 1)] + share[faces_(f, 2)] > 3 * kOfBoth;
  Sheet &sheet = sheets_.emplace_back();
  if (std::none_of(over.begin(), over.end(), [](auto o) { return o != 0; }))
    return;
  sheet.surface.emplace(Mesh{cloth, faces_}, over);
  sheet.edges = edges;
  for (std::size_t e = 0; e < topology.edges.size(); ++e)
    for (int side = 0; side < 2; ++side) {
      const int f = topology.edge_faces[e][side], other = topology.edge_faces[e][1 - side];
      for (int k = 0; k < 3 && f >= 0 && other >= 0 && over[f] && !over[other]; ++k)
        if (faces_(f, k) != topology.edges[e][0] && faces_(f, k) != topology.edges[e][1])
          sheet.edges[f][k] = Edge::Cut;
    }
}

/// The faces and edges between the vertices, of those of a mesh.
void SkinPenetrationFix::Part::bound(const Faces &all, Eigen::Index mesh_vertices) {
  std::vector<int> number(mesh_vertices, -1);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    number[vertices[i].vertex] = static_cast<int>(i);
  std::vector<std::uint8_t> between(all.rows());
  const Faces numbered = all.unaryExpr([&](int v) { return number[v]; });
  for (Eigen::Index f = 0; f < all.rows(); ++f)
    between[f] = numbered.row(f).minCoeff() >= 0;
  faces = valid_faces(numbered, between);
  edges = edge_topology(faces).edges;
}

/// By area alone: the angles of vertex_normals() cost as much as all else here.
void SkinPenetrationFix::Part::find_normals(const Vertices &positions) {
  for (Tucked &tucked : vertices)
    tucked.own.setZero();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    Tucked *const corners[] = {&vertices[faces(f, 0)], &vertices[faces(f, 1)], &vertices[faces(f, 2)]};
    const Eigen::Vector3d a = positions.row(corners[0]->vertex), b = positions.row(corners[1]->vertex),
                          c = positions.row(corners[2]->vertex), across = (b - a).cross(c - a);
    for (Tucked *corner : corners)
      corner->own += across;
  }
  for (Tucked &tucked : vertices)
    tucked.own.normalize(); // none stays none
}

void SkinPenetrationFix::apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body) {
  for (Sheet &sheet : sheets_)
    if (sheet.surface)
      sheet.surface->move_to(drawn.cloth);
  tuck(drawn.cloth_normals, skin_, high);
  if (body.rows() > 0)
    tuck(drawn.cloth_normals, body_, body);
}

SkinPenetrationFix::Beside SkinPenetrationFix::beside(const Sheet &sheet, const Eigen::Vector3d &point, const Vertices &normals,
                                                      Cover cover, const Eigen::Vector3d &own, int &last) const {
  const bool bare = cover == Cover::Bare;
  const std::optional<MovingSurface::Point> at = sheet.surface->closest(point, bare ? kReachBare : kReachOut, last);
  last = at ? at->face : -1;
  Beside found;
  if (!at)
    return found;
  double deep = 0;
  found.covered = true;
  for (int k = 0; k < 3; ++k) {
    const int v = faces_(at->face, k);
    found.normal += at->barycentric[k] * normals.row(v).transpose();
    deep += at->barycentric[k] * depths_[v];
    const Edge edge = sheet.edges[at->face][k];
    if (edge != Edge::Inner && !(cover == Cover::Worn && edge == Edge::Seam) && at->barycentric[k] < kAtEdge) {
      found.covered = false;
      if (edge != Edge::Free)
        return found; // above the garment, or where it goes on over another limb
    }
  }
  found.normal.normalize();
  const Eigen::Vector3d away = point - at->point;
  const double out = away.dot(found.normal);
  deep = bare ? std::min(deep, kDeepBare) : deep;
  const double way = found.covered ? 0.0 : kSlope * std::sqrt(std::max(0.0, at->distance * at->distance - out * out));
  found.out = std::max(0.0, out + deep - way);
  if (bare)
    found.out *= std::clamp((away.dot(own) / std::max(at->distance, kStandsOut) - kBeside) / (kWithin - kBeside), 0.0, 1.0);
  found.covered = found.covered && (!bare || found.out > 0);
  return found;
}

/// Straight inwards: along the garment's normal what lies under one side of a fold would come out of the other.
void SkinPenetrationFix::find_way_in(const Vertices &normals, const Vertices &positions, Tucked &tucked) const {
  tucked.in = 0;
  tucked.covered = false;
  const Sheet &sheet = sheets_[tucked.limb];
  if (!sheet.surface)
    return;
  int last = tucked.last;
  for (int look = 0; look < kLooks && tucked.in < kDeepestTuck; ++look) {
    const Beside at =
        beside(sheet, positions.row(tucked.vertex).transpose() - tucked.in * tucked.own, normals, tucked.cover, tucked.own, last);
    const double facing = tucked.own.dot(at.normal);
    if (look == 0) {
      tucked.last = last;
      tucked.covered = at.covered;
    }
    if (!(at.out > kStandsOut) || facing <= 0)
      break;
    tucked.in += std::min(1.0, facing / kFacing) * at.out / std::max(facing, kOblique);
    if (facing > kFlat && tucked.in < kShallow)
      break; // no other fold lies there
  }
  tucked.in = std::min(tucked.in, kDeepestTuck);
}

void SkinPenetrationFix::take_neighbours_along(Part &part, const Vertices &positions) {
  for (int ring = 0; ring < kGoAlong; ++ring)
    for (const Eigen::Vector2i &edge : part.edges) {
      Tucked &a = part.vertices[edge[0]], &b = part.vertices[edge[1]], &less = a.in < b.in ? a : b;
      const double most = std::max(a.in, b.in);
      if (less.covered && most > less.in)
        less.in = std::max(less.in, most - kWall * (positions.row(a.vertex) - positions.row(b.vertex)).norm());
    }
}

void SkinPenetrationFix::tuck(const Vertices &normals, Part &part, Vertices &positions) const {
  part.find_normals(positions);
  for (Tucked &tucked : part.vertices)
    find_way_in(normals, positions, tucked);
  take_neighbours_along(part, positions);
  for (const Tucked &tucked : part.vertices)
    positions.row(tucked.vertex) -= tucked.in * tucked.own.transpose();
}

} // namespace doublet
