#include "doublet/animate/parts/garment_penetration.h"

#include "arms.h"
#include "doublet/core/error.h"
#include "doublet/pbd/parts/longest_stretch.h"
#include "garment_part.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr double kLiftAbove = 0.004;                    // m: triangles are flat where the body is round
constexpr double kLiftReach = 0.04, kLiftSurely = 0.02; // m: how deep it may lie; up to where it is lifted all the way
constexpr double kLiftTouches = 1e-4;                   // m, so near the way out is the body's normal
constexpr double kLiftSlope = 0.7;                      // m less for each along the garment, as it lies and as it is at rest
constexpr int kLiftRings = 3;                           // times over all edges

/// The body's faces that the cloth collides with: of bones with a capsule, and not of arms.
Mask faces_that_lift(const Character &c) {
  const std::vector<int> arms = detail::arms_of_joints(c.actor.skeleton);
  std::vector<std::uint8_t> lifts(arms.size(), 0);
  for (const TaperedCapsule &capsule : c.proxies)
    lifts[capsule.joint] = arms[capsule.joint] == 0;
  Mask chosen(static_cast<std::size_t>(c.body.faces.rows()), 0);
  for (Eigen::Index f = 0; f < c.body.faces.rows(); ++f) {
    Eigen::Index joint;
    c.body_weights.row(c.body.faces(f, 0)).maxCoeff(&joint);
    chosen[f] = lifts[joint];
  }
  return chosen;
}

const Character &liftable(const Character &c) {
  validate_character(c);
  if (!GarmentPenetrationFix::applies_to(c))
    throw Error("GarmentPenetrationFix: expected a character with a garment's own mesh and a body with capsules, found none");
  return c;
}

} // namespace

GarmentPenetrationFix::GarmentPenetrationFix(const Character &c)
    : body_faces_(liftable(c).body.faces), body_(c.body, faces_that_lift(c)) {
  const detail::Worn worn = detail::worn_garment(c.actor, c.segmentation);
  for (int v : worn.vertices)
    garment_.push_back({v, c.segmentation.clothness[v] == 0});
  const Vertices &rest = worn.mesh.vertices;
  for (const Eigen::Vector2i &edge : edge_topology(worn.mesh.faces).edges)
    edges_.push_back({edge[0], edge[1], (rest.row(edge[0]) - rest.row(edge[1])).norm()});
}

bool GarmentPenetrationFix::applies_to(const Character &c) {
  const Mask lifting = faces_that_lift(c);
  return c.garment_subdivisions >= 0 && std::find(lifting.begin(), lifting.end(), 1) != lifting.end();
}

void GarmentPenetrationFix::find_way_out(const Vertices &body, const Vertices &surface, Lifted &lifted) const {
  lifted.by.setZero();
  if (lifted.hangs)
    return;
  const Vector3d p = surface.row(lifted.vertex);
  const std::optional<MovingSurface::Point> at = body_.closest(p, kLiftReach, lifted.last);
  lifted.last = at ? at->face : -1;
  if (!at)
    return;
  const Vector3d a = body.row(body_faces_(at->face, 0)), b = body.row(body_faces_(at->face, 1)),
                 c = body.row(body_faces_(at->face, 2)), across = (b - a).cross(c - a), away = p - at->point;
  const bool inside = away.dot(across) < 0;
  const double above = inside ? -at->distance : at->distance;
  if (!(above < kLiftAbove) || !(across.norm() > 0))
    return;
  const Vector3d out = at->distance > kLiftTouches ? Vector3d(away / above) : Vector3d(across.normalized());
  lifted.by = std::min(1.0, (kLiftReach - at->distance) / (kLiftReach - kLiftSurely)) * (kLiftAbove - above) * out;
}

/// m, by which the ends may be lifted apart.
double GarmentPenetrationFix::slope(const Edge &edge, const Vertices &surface) const {
  const double length = (surface.row(garment_[edge.a].vertex) - surface.row(garment_[edge.b].vertex)).norm();
  return kLiftSlope * std::min(length, edge.rest);
}

void GarmentPenetrationFix::take_neighbours_along(const Vertices &surface) {
  for (int ring = 0; ring < kLiftRings; ++ring)
    for (const Edge &edge : edges_) {
      Lifted &a = garment_[edge.a], &b = garment_[edge.b];
      const bool first = a.by.squaredNorm() > b.by.squaredNorm();
      const Vector3d most = first ? a.by : b.by;
      Lifted &less = first ? b : a;
      if (less.hangs || most.isZero(0))
        continue;
      const double length = most.norm(), wanted = length - slope(edge, surface);
      if (wanted > less.by.norm())
        less.by = wanted / length * most;
    }
}

/// Where two limbs lift neighbours apart, or cloth that is stretched already, both are lifted less: the garment would be torn to
/// a spike between them.
void GarmentPenetrationFix::bring_neighbours_together(const Vertices &surface) {
  for (int ring = 0; ring < kLiftRings; ++ring)
    for (const Edge &edge : edges_) {
      Lifted &a = garment_[edge.a], &b = garment_[edge.b];
      const Vector3d apart = b.by - a.by;
      if (apart.isZero(0))
        continue;
      const Vector3d along = surface.row(b.vertex) - surface.row(a.vertex);
      const double length = along.norm(), longer = apart.dot(along) / length,
                   share = std::min(slope(edge, surface) / apart.norm(),
                                    longer > 0 ? std::max(0.0, pbd::kLongestStretch * edge.rest - length) / longer : 1.0);
      if (!(share < 1))
        continue;
      const Vector3d less = (1 - share) * apart;
      const double of_a = a.hangs ? 0 : b.hangs ? 1 : 0.5;
      a.by += of_a * less;
      b.by -= (1 - of_a) * less;
    }
}

void GarmentPenetrationFix::apply(const Vertices &body, Vertices &surface) {
  body_.move_to(body);
  for (Lifted &lifted : garment_)
    find_way_out(body, surface, lifted);
  take_neighbours_along(surface);
  bring_neighbours_together(surface);
  for (const Lifted &lifted : garment_)
    surface.row(lifted.vertex) += lifted.by.transpose();
}

} // namespace doublet
