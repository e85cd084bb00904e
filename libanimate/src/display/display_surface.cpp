#include "doublet/animate/display_surface.h"

#include "body_weld.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/rays/ray_scene.h"
#include "garment_part.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr double kScanReach = 0.010; // m, the scan is looked for so far from the garment: more is another fold
constexpr double kSameSide = 0.5;    // cosine between the normals of garment and scan
constexpr int kSmoothing = 2;        // rounds over the heights
constexpr double kSink = 0.001;      // m, of the skin just under the seam: it must not show as a step ...
constexpr double kSinkBend = 10;     // 1/m, ... more with the square of the way below it ...
constexpr double kDeepest = 0.004;   // m, ... up to this
constexpr double kSeamSlope = 0.3;   // just above the seam skin stands out by so much of the way to it at most
constexpr double kGoesOnEdges = 2;   // of the scan, and what the weld takes back: so far below the seam, where it is the garment
constexpr double kHidden = 0.06;     // m, skin so far below the seam at most is under the garment; further down it is a limb's
constexpr double kAtSeam = 0.03;     // m, about a triangle of M, which may count as covered although the seam runs through it
constexpr double kNearHem = 0.15;    // m, about the radius of what closes a hem in the scan ...
constexpr double kFacesOut = 0.5;    // ... cosine of its normals to the way the garment ends
constexpr double kCarried = 0.05;    // m from the weld, within which the scan's skin goes over to the body's weights
constexpr double kEnough = 0.02;     // share of M's skin weights that tells how a joint stands
constexpr double kOnBody = 0.012;    // m, about the error of the fitted body: nearer, what faces as it does is its skin
constexpr double kCrumb = 0.005;     // m^2, skin in smaller pieces is what the mask left of the sheet below a hem

Vector3d centre_of(const Mesh &mesh, int f) {
  return (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) + mesh.vertices.row(mesh.faces(f, 2))) / 3;
}

Vertices rows_of(const Vertices &all, const std::vector<int> &rows) {
  Vertices part(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    part.row(static_cast<Eigen::Index>(i)) = all.row(rows[i]);
  return part;
}

/// (G', 3) unit normals of the subdivided surface, as smooth as that: the coarse ones subdivided.
Vertices smooth_normals(const Eigen::SparseMatrix<double, Eigen::RowMajor> &subdivide, const Mesh &coarse) {
  Vertices normals = subdivide * vertex_normals(coarse.vertices, coarse.faces);
  for (Eigen::Index v = 0; v < normals.rows(); ++v)
    if (normals.row(v).norm() > 0)
      normals.row(v).normalize();
  return normals;
}

/// m along the normal to the nearest of the scan's faces that looks the same way; NaN if there is none within reach.
double height_of_scan(const RayScene &scene, const Vertices &scan_normals, const Vector3d &p, const Vector3d &normal) {
  double best = std::numeric_limits<double>::quiet_NaN();
  for (const double side : {1.0, -1.0}) {
    const auto hit = scene.cast(p, side * normal, 0, kScanReach);
    if (hit && scan_normals.row(hit->face).dot(normal.transpose()) > kSameSide && !(std::abs(best) <= hit->distance))
      best = side * hit->distance;
  }
  return best;
}

/// NaN become the mean of their neighbours, ring by ring (0 where nothing is known); then all are smoothed.
void fill_and_smooth(const Faces &faces, Eigen::VectorXd &heights) {
  const auto neighbours = vertex_neighbours(faces, static_cast<int>(heights.size()));
  const auto mean_around = [&](const Eigen::VectorXd &from, Eigen::Index v) {
    double sum = 0;
    int count = 0;
    for (int w : neighbours[v])
      if (!std::isnan(from[w])) {
        sum += from[w];
        ++count;
      }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  };
  for (bool grew = true; grew;) {
    grew = false;
    const Eigen::VectorXd before = heights;
    for (Eigen::Index v = 0; v < heights.size(); ++v)
      if (std::isnan(before[v])) {
        heights[v] = mean_around(before, v);
        grew |= !std::isnan(heights[v]);
      }
  }
  heights = heights.array().isNaN().select(0.0, heights);
  for (int round = 0; round < kSmoothing; ++round) {
    const Eigen::VectorXd before = heights;
    for (Eigen::Index v = 0; v < heights.size(); ++v)
      if (!neighbours[v].empty())
        heights[v] = 0.5 * before[v] + 0.5 * mean_around(before, v);
  }
}

/// The garment as it is drawn: subdivided, and out to the scan.
Mesh displaced(const Mesh &garment, const detail::Subdivision &fine, const Mesh &scan) {
  const Vertices smooth = fine.weights * garment.vertices, normals = smooth_normals(fine.weights, garment);
  const RayScene scene(scan);
  const Vertices scan_normals = face_normals(scan.vertices, scan.faces);
  Eigen::VectorXd heights(smooth.rows());
  for (Eigen::Index v = 0; v < smooth.rows(); ++v)
    heights[v] = height_of_scan(scene, scan_normals, smooth.row(v), normals.row(v));
  fill_and_smooth(fine.faces, heights);
  return {smooth + heights.asDiagonal() * normals, fine.faces};
}

/// How often to halve the garment's edges to come nearest to the scan's.
int levels_for(const detail::Worn &garment, const Segmentation &segmentation, const Mesh &high) {
  const double coarse = mean_edge_length(rows_of(segmentation.rest, garment.vertices), garment.mesh.faces);
  const double levels = std::log2(coarse / mean_edge_length(high.vertices, high.faces));
  return std::clamp(static_cast<int>(std::lround(levels)), 0, detail::kMostSubdivisions);
}

Eigen::VectorXd clothness_of(const std::vector<int> &vertices, const Eigen::SparseMatrix<double, Eigen::RowMajor> &subdivide,
                             const Segmentation &segmentation) {
  Eigen::VectorXd coarse(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    coarse[static_cast<Eigen::Index>(i)] = segmentation.clothness[vertices[i]];
  return subdivide * coarse;
}

/// The edges along which the garment hangs, and what of the skin lies under it there.
class Seam {
public:
  /// `cloth`: the subdivided garment; `clothness` of its vertices, 0 = hangs.
  Seam(const Mesh &cloth, const Eigen::VectorXd &clothness)
      : cloth_(cloth), normals_(vertex_normals(cloth.vertices, cloth.faces)), scene_(cloth) {
    const EdgeTopology topology = edge_topology(cloth.faces);
    for (std::size_t e = 0; e < topology.edges.size(); ++e)
      if (topology.edge_faces[e][1] < 0 && clothness[topology.edges[e][0]] + clothness[topology.edges[e][1]] < 1e-9)
        edges_.push_back(topology.edges[e]);
  }

  enum class Side { Above, AtSeam, Under, Away };
  struct Place {
    Side side = Side::Away;
    double below = 0, height = 0; ///< m, way from the seam, < 0 = above it; along `normal`, < 0 = under the garment
    Vector3d normal = Vector3d::Zero();
  };
  /// Where a point of the skin is: above the seam (nothing of the garment is nearer), so but close to it, under the garment just
  /// below it, or elsewhere.
  Place place(const Vector3d &p) const {
    const ClosestPoint at = scene_.closest(p);
    double below = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2i &edge : edges_)
      below = std::min(
          below, (at.point - closest_on_segment(at.point, cloth_.vertices.row(edge[0]), cloth_.vertices.row(edge[1]))).norm());
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      normal += at.barycentric[k] * normals_.row(cloth_.faces(at.face, k)).transpose();
    if (below < 1e-6) {
      if (!(at.distance < kAtSeam) || !(normal.norm() > 0))
        return {at.distance < kAtSeam ? Side::AtSeam : Side::Above};
      const double height = (p - at.point).dot(normal.normalized());
      return {Side::AtSeam, -std::sqrt(std::max(0.0, at.distance * at.distance - height * height)), height, normal.normalized()};
    }
    if (at.distance > kScanReach || below > kHidden || !(normal.norm() > 0))
      return {Side::Away};
    return {Side::Under, below, (p - at.point).dot(normal.normalized()), normal.normalized()};
  }

  Vector3d sunk(const Vector3d &p) const {
    const Place at = place(p);
    if (at.side != Side::Under && at.side != Side::AtSeam)
      return p;
    const double wanted =
        at.below < 0 ? -kSink - kSeamSlope * at.below : -std::min(kSink + kSinkBend * at.below * at.below, kDeepest);
    return p + std::min(wanted - at.height, 0.0) * at.normal;
  }

  /// The faces of M_high that show beside the garment, lie across the seam or just below. `valid`: where M is valid, and not
  /// covered. The skin goes on so far that the weld is below the seam: its end, and where it is taken back to, go along
  /// triangles, up to an edge higher each.
  std::vector<int> skin(const Mesh &high, const std::vector<std::uint8_t> &valid) const {
    std::vector<Side> sides(high.vertices.rows());
    std::vector<std::uint8_t> just_under(high.vertices.rows());
    const double under_seam = detail::kTakenBack + kGoesOnEdges * mean_edge_length(high.vertices, high.faces);
    for (Eigen::Index v = 0; v < high.vertices.rows(); ++v) {
      const Place at = place(high.vertices.row(v));
      sides[v] = at.side;
      just_under[v] = at.side == Side::AtSeam || (at.side == Side::Under && at.below < under_seam);
    }
    std::vector<int> shown;
    for (int f = 0; f < high.faces.rows(); ++f) {
      const auto any = [&](Side side) {
        return sides[high.faces(f, 0)] == side || sides[high.faces(f, 1)] == side || sides[high.faces(f, 2)] == side;
      };
      const bool goes_on = just_under[high.faces(f, 0)] && just_under[high.faces(f, 1)] && just_under[high.faces(f, 2)];
      if (any(Side::AtSeam) || goes_on || (valid[f] && !any(Side::Under)))
        shown.push_back(f);
    }
    return shown;
  }

private:
  const Mesh &cloth_;
  Vertices normals_;
  RayScene scene_;
  std::vector<Eigen::Vector2i> edges_;
};

/// Where the garment ends free, and which way: along itself, across the edge.
class Hem {
public:
  Hem(const Mesh &garment, const Eigen::VectorXd &clothness) {
    const EdgeTopology topology = edge_topology(garment.faces);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
      const Eigen::Vector2i &edge = topology.edges[e];
      if (topology.edge_faces[e][1] >= 0 || clothness[edge[0]] + clothness[edge[1]] < 1e-9)
        continue;
      const Vector3d a = garment.vertices.row(edge[0]), b = garment.vertices.row(edge[1]);
      const Eigen::RowVector3i face = garment.faces.row(topology.edge_faces[e][0]);
      const Vector3d inner = garment.vertices.row(face.sum() - edge.sum()), along = (b - a).normalized();
      places_.push_back((a + b) / 2);
      ways_.push_back((a - inner) - (a - inner).dot(along) * along);
    }
  }

  /// Does this lie before the opening, and look out of it?
  bool closed_by(const Vector3d &centre, const Vector3d &normal) const {
    double nearest = std::numeric_limits<double>::infinity();
    Vector3d way = Vector3d::Zero();
    for (std::size_t e = 0; e < places_.size(); ++e) {
      const double distance = (places_[e] - centre).norm();
      nearest = std::min(nearest, distance);
      way += std::exp(-0.5 * distance * distance / (kNearHem * kNearHem)) * ways_[e];
    }
    return nearest < kNearHem && normal.dot(way.normalized()) > kFacesOut;
  }

private:
  std::vector<Vector3d> places_, ways_;
};

/// [F] faces that lie on the body as its skin does; none without a body.
std::vector<std::uint8_t> skin_of(const Mesh &body, const Mesh &high, const Vertices &normals) {
  std::vector<std::uint8_t> is_skin(high.faces.rows(), 0);
  if (body.faces.rows() == 0)
    return is_skin;
  const RayScene scene(body);
  const Vertices body_normals = face_normals(body.vertices, body.faces);
  for (int f = 0; f < high.faces.rows(); ++f) {
    const ClosestPoint at = scene.closest(centre_of(high, f));
    is_skin[f] = at.distance < kOnBody && body_normals.row(at.face).dot(normals.row(f)) > kSameSide;
  }
  return is_skin;
}

/// Takes from the valid faces what the mask left of the sheet that closes the scan below a hem: joined to what is not drawn,
/// looking out of the garment, and no skin of the body, which a shoulder beside an armhole is.
void drop_sheet(const Mesh &high, const Hem &hem, const Mesh &body, std::vector<std::uint8_t> &valid) {
  const Vertices normals = face_normals(high.vertices, high.faces);
  const std::vector<std::uint8_t> is_skin = skin_of(body, high, normals);
  std::vector<std::vector<int>> beside(high.faces.rows());
  for (const Eigen::Vector2i &pair : edge_topology(high.faces).edge_faces)
    if (pair[1] >= 0) {
      beside[pair[0]].push_back(pair[1]);
      beside[pair[1]].push_back(pair[0]);
    }
  std::vector<int> front;
  for (int f = 0; f < high.faces.rows(); ++f)
    if (!valid[f])
      front.push_back(f);
  for (std::size_t i = 0; i < front.size(); ++i)
    for (int f : beside[front[i]])
      if (valid[f] && !is_skin[f] && hem.closed_by(centre_of(high, f), normals.row(f))) {
        valid[f] = 0;
        front.push_back(f);
      }
}

/// Of the faces, those in connected pieces of some size.
std::vector<int> without_crumbs(const Mesh &mesh, const std::vector<int> &faces) {
  const Mesh part = submesh(mesh, faces);
  int count = 0;
  const Eigen::VectorXi piece = vertex_components(part.faces, static_cast<int>(part.vertices.rows()), &count);
  const Eigen::VectorXd areas = face_areas(part.vertices, part.faces);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(count);
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    sizes[piece[part.faces(f, 0)]] += areas[f];
  std::vector<int> kept;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (sizes[piece[part.faces(static_cast<Eigen::Index>(i), 0)]] >= kCrumb)
      kept.push_back(faces[i]);
  return kept;
}

/// (C) values (V, C) at a point of their mesh.
Eigen::RowVectorXd interpolated(const MatrixRM &values, const Faces &faces, const ClosestPoint &at) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(values.cols());
  for (int k = 0; k < 3; ++k)
    sum += at.barycentric[k] * values.row(faces(at.face, k));
  return sum;
}

/// The faces of a welded skin that are the scan's alone, with its vertices.
Mesh scan_of(const Mesh &skin, Eigen::Index scan_vertices) {
  std::vector<std::uint8_t> of_scan(skin.faces.rows());
  for (Eigen::Index f = 0; f < skin.faces.rows(); ++f)
    of_scan[f] = skin.faces.row(f).maxCoeff() < scan_vertices;
  return {skin.vertices.topRows(scan_vertices), valid_faces(skin.faces, of_scan)};
}

/// That which moves some weighted vertices best (Umeyama 1991).
Eigen::Isometry3d rigid_motion(const Vertices &from, const Vertices &to, const std::vector<WeightedVertex> &vertices) {
  double sum = 0;
  Vector3d from_centre = Vector3d::Zero(), to_centre = Vector3d::Zero();
  for (const WeightedVertex &v : vertices) {
    sum += v.weight;
    from_centre += v.weight * from.row(v.vertex).transpose();
    to_centre += v.weight * to.row(v.vertex).transpose();
  }
  from_centre /= sum;
  to_centre /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const WeightedVertex &v : vertices)
    covariance += v.weight * (to.row(v.vertex).transpose() - to_centre) * (from.row(v.vertex) - from_centre.transpose());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double turn = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = svd.matrixU() * Vector3d(1, 1, turn).asDiagonal() * svd.matrixV().transpose();
  motion.translation() = to_centre - motion.linear() * from_centre;
  return motion;
}

} // namespace

DisplayMesh build_display_mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &high, const Mesh &body) {
  require_actor(actor, "build_display_mesh");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "build_display_mesh");
  require_usable(high, "build_display_mesh: high");
  if (body.faces.rows() > 0)
    require_usable(body, "build_display_mesh: body");
  const detail::Worn garment = detail::worn_garment(actor, segmentation);
  std::vector<std::uint8_t> bare(actor.mesh.faces.rows(), 1);
  for (int f : garment.faces)
    bare[f] = 0;
  DisplayMesh display{high, std::vector<std::uint8_t>(high.faces.rows())};
  if (garment.faces.size() < bare.size()) {
    const RayScene uncovered(actor.mesh, bare);
    for (int f = 0; f < high.faces.rows(); ++f)
      display.valid[f] = actor.face_valid[uncovered.closest(centre_of(high, f)).face];
  }
  if (garment.faces.empty())
    return display;
  display.garment_subdivisions = levels_for(garment, segmentation, high);
  const detail::Subdivision fine =
      detail::subdivide(garment.mesh.faces, static_cast<int>(garment.mesh.vertices.rows()), display.garment_subdivisions);
  const Mesh cloth = displaced(garment.mesh, fine, high);
  const Eigen::VectorXd cloth_clothness = clothness_of(garment.vertices, fine.weights, segmentation);
  drop_sheet(high, Hem(cloth, cloth_clothness), body, display.valid);
  const Seam seam(cloth, cloth_clothness);
  Mesh skin = submesh(high, without_crumbs(high, seam.skin(high, display.valid)));
  for (Eigen::Index v = 0; v < skin.vertices.rows(); ++v)
    skin.vertices.row(v) = seam.sunk(skin.vertices.row(v));
  display.mesh = detail::joined(skin, cloth);
  display.valid.assign(display.mesh.faces.rows(), 1);
  return display;
}

DisplaySurface::DisplaySurface(const Character &c) : coarse_vertices_(c.actor.mesh.vertices.rows()) {
  if (c.high.faces.rows() == 0)
    throw Error("DisplaySurface: expected a character with a display mesh, found none");
  validate_character(c);
  if (c.garment_subdivisions < 0) {
    skin_.emplace(c.actor.mesh, c.actor.face_valid, c.high, c.high_valid);
    skin_vertices_ = scan_vertices_ = c.high.vertices.rows();
    return;
  }
  const detail::GarmentPart part = detail::garment_part(c);
  garment_vertices_ = part.garment.vertices;
  garment_faces_ = part.garment.mesh.faces;
  skin_vertices_ = part.skin_vertices;
  subdivide_ = part.fine.weights;
  const Vertices smooth = subdivide_ * part.garment.mesh.vertices, normals = smooth_normals(subdivide_, part.garment.mesh);
  heights_ = (c.high.vertices.bottomRows(smooth.rows()) - smooth).cwiseProduct(normals).rowwise().sum();
  if (skin_vertices_ == 0)
    return;
  std::vector<std::uint8_t> valid = c.actor.face_valid;
  for (int f : part.garment.faces)
    valid[f] = 0;
  const Mesh skin{c.high.vertices.topRows(skin_vertices_), c.high.faces.topRows(part.skin_faces)};
  scan_vertices_ = skin_vertices_ - static_cast<Eigen::Index>(c.high_body.size());
  const Mesh scan = c.high_body.empty() ? skin : scan_of(skin, scan_vertices_);
  skin_.emplace(c.actor.mesh, valid, scan, std::vector<std::uint8_t>{});
  if (!c.high_body.empty())
    carry(c, valid, skin, part);
}

/// What goes with the body's weights: the body, and the scan's skin beside it more and more; below a seam from the seam on, where
/// it has the garment's.
void DisplaySurface::carry(const Character &c, const std::vector<std::uint8_t> &valid, const Mesh &skin,
                           const detail::GarmentPart &part) {
  const Mesh cloth{c.high.vertices.bottomRows(part.fine.weights.rows()), part.fine.faces};
  const Seam seam(cloth, clothness_of(garment_vertices_, subdivide_, c.segmentation));
  std::vector<double> below(scan_vertices_, 0); // m from the seam; 0 = not under the garment that hangs there
  for (Eigen::Index v = 0; v < scan_vertices_; ++v)
    if (const Seam::Place at = seam.place(skin.vertices.row(v)); at.side == Seam::Side::Under)
      below[v] = at.below;
  std::vector<int> weld_below, weld_elsewhere;
  for (int v : detail::weld_vertices(skin.faces, scan_vertices_))
    (below[v] > 0 ? weld_below : weld_elsewhere).push_back(v);
  const auto neighbours = vertex_neighbours(skin.faces, static_cast<int>(skin_vertices_));
  const Eigen::VectorXd to_weld_below = edge_distances(skin.vertices, neighbours, weld_below, kHidden),
                        away = edge_distances(skin.vertices, neighbours, weld_elsewhere, kCarried);
  const RayScene body(c.body);
  std::vector<Eigen::RowVectorXd> weights;
  for (Eigen::Index v = 0; v < skin_vertices_; ++v) {
    const bool of_body = v >= scan_vertices_;
    const double left = of_body ? 1 : below[v] > 0 ? below[v] / (below[v] + to_weld_below[v]) : 1 - away[v] / kCarried;
    if (!(left > 0))
      continue;
    carried_.push_back({static_cast<int>(v), left * left * (3 - 2 * left)});
    if (of_body)
      weights.emplace_back(c.body_weights.row(c.high_body[v - scan_vertices_]));
    else
      weights.push_back(interpolated(c.body_weights, c.body.faces, body.closest(skin.vertices.row(v))));
  }
  carried_weights_.resize(static_cast<Eigen::Index>(carried_.size()), c.body_weights.cols());
  Vertices rest(carried_weights_.rows(), 3);
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    carried_weights_.row(static_cast<Eigen::Index>(i)) = weights[i];
    rest.row(static_cast<Eigen::Index>(i)) = skin.vertices.row(carried_[i].vertex);
  }
  binding_.emplace(rest, carried_weights_);
  const RayScene bare(c.actor.mesh, valid);
  for (Eigen::Index v = scan_vertices_; v < skin_vertices_; ++v)
    nearest_.push_back(c.actor.mesh.faces(bare.closest(skin.vertices.row(v)).face, 0));
  rest_ = c.actor.mesh.vertices;
  skeleton_ = c.actor.skeleton;
  told_by_.resize(c.actor.skeleton.joint_count());
  std::vector<std::uint8_t> told(rest_.rows(), 0);
  for (Eigen::Index f = 0; f < c.actor.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      told[c.actor.mesh.faces(f, k)] |= valid[f];
  for (std::size_t j = 0; j < told_by_.size(); ++j)
    for (Eigen::Index v = 0; v < rest_.rows(); ++v)
      if (const double weight = c.actor.weights(v, static_cast<Eigen::Index>(j)); told[v] && weight > kEnough)
        told_by_[j].push_back({static_cast<int>(v), weight});
}

void DisplaySurface::joints_of(const Vertices &surface, std::vector<DualQuaternion> &joints) const {
  Transforms world_from_rest(told_by_.size());
  for (std::size_t j = 0; j < told_by_.size(); ++j) { // parents come first
    const int parent = skeleton_.joints[j].parent;
    world_from_rest[j] = parent < 0 ? Eigen::Isometry3d::Identity() : world_from_rest[parent];
    if (told_by_[j].size() >= 3)
      world_from_rest[j] = rigid_motion(rest_, surface, told_by_[j]);
  }
  dual_quaternions(skeleton_, world_from_rest, joints);
}

Vertices DisplaySurface::apply(const Vertices &surface) const {
  Vertices high;
  DisplayBuffers buffers;
  apply(surface, high, buffers);
  return high;
}

void DisplaySurface::apply(const Vertices &surface, Vertices &high, DisplayBuffers &buffers) const {
  if (binding_ && surface.rows() == coarse_vertices_ && surface.allFinite())
    joints_of(surface, buffers.joints);
  apply(surface, buffers.joints, high, buffers);
}

void DisplaySurface::apply(const Vertices &surface, const std::vector<DualQuaternion> &joints, Vertices &high,
                           DisplayBuffers &b) const {
  if (surface.rows() != coarse_vertices_)
    throw std::invalid_argument("DisplaySurface::apply: surface has " + std::to_string(surface.rows()) + " vertices, expected " +
                                std::to_string(coarse_vertices_));
  if (!surface.allFinite())
    throw std::invalid_argument("DisplaySurface::apply: surface: expected finite positions, found NaN or infinity");
  high.resize(skin_vertices_ + subdivide_.rows(), 3);
  if (skin_)
    skin_->apply(surface, high.topRows(scan_vertices_), b.skin_rows);
  if (binding_) {
    binding_->pose(joints, b.carried);
    for (std::size_t i = 0; i < carried_.size(); ++i) {
      auto row = high.row(carried_[i].vertex);
      const auto carried = b.carried.row(static_cast<Eigen::Index>(i));
      if (carried_[i].weight == 1)
        row = carried;
      else
        row += carried_[i].weight * (carried - row);
    }
  }
  if (garment_vertices_.empty())
    return;
  b.garment.resize(static_cast<Eigen::Index>(garment_vertices_.size()), 3);
  for (std::size_t i = 0; i < garment_vertices_.size(); ++i)
    b.garment.row(static_cast<Eigen::Index>(i)) = surface.row(garment_vertices_[i]);
  vertex_normals(b.garment, garment_faces_, b.garment_normals);
  b.cloth.resize(subdivide_.rows(), 3);
  b.cloth_normals.resize(subdivide_.rows(), 3);
  b.garment_rows.resize(b.garment.rows(), 4);
  b.garment_rows << b.garment, Eigen::VectorXd::Zero(b.garment.rows());
  multiply(subdivide_, b.garment_rows, b.cloth);
  b.garment_rows.leftCols<3>() = b.garment_normals;
  multiply(subdivide_, b.garment_rows, b.cloth_normals);
  for (Eigen::Index v = 0; v < b.cloth.rows(); ++v) {
    const double length = b.cloth_normals.row(v).norm();
    b.cloth.row(v) += (length > 0 ? heights_[v] / length : 0.0) * b.cloth_normals.row(v);
  }
  high.bottomRows(subdivide_.rows()) = b.cloth;
}

MatrixRM DisplaySurface::sample(const MatrixRM &values) const {
  if (values.rows() != coarse_vertices_)
    throw std::invalid_argument("DisplaySurface::sample: values has " + std::to_string(values.rows()) + " rows, expected " +
                                std::to_string(coarse_vertices_));
  MatrixRM result(skin_vertices_ + subdivide_.rows(), values.cols());
  if (skin_)
    result.topRows(scan_vertices_) = skin_->sample(values);
  for (std::size_t i = 0; i < nearest_.size(); ++i)
    result.row(scan_vertices_ + static_cast<Eigen::Index>(i)) = values.row(nearest_[i]);
  if (!garment_vertices_.empty()) {
    MatrixRM garment(garment_vertices_.size(), values.cols());
    for (std::size_t i = 0; i < garment_vertices_.size(); ++i)
      garment.row(i) = values.row(garment_vertices_[i]);
    result.bottomRows(subdivide_.rows()) = subdivide_ * garment;
  }
  return result;
}

MatrixRM DisplaySurface::skin_weights(const MatrixRM &weights) const {
  MatrixRM result = sample(weights);
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    auto row = result.row(carried_[i].vertex);
    row += carried_[i].weight * (carried_weights_.row(static_cast<Eigen::Index>(i)) - row);
  }
  return result;
}

} // namespace doublet
