#include "doublet/segment/garment_mesher.h"

#include "attachment.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/boundary_loops.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/options/options.h"
#include "doublet/rays/ray_scene.h"
#include "garment_field.h"
#include "handles.h"
#include "isotropic.h"
#include "rest_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

namespace doublet {

using detail::Piece;
using detail::placed;

namespace {

constexpr double kTooWide = 0.03; // share of the frames
constexpr double kOffCount = 0.1; // of the wanted number of vertices

constexpr double kHandle = 0.25; // m around: longer than what joins folds, shorter than a sleeve

constexpr double kPinhole = 0.12; // m around: shorter than a child's wrist

constexpr double kRounding = 1e-9; // of barycentric coordinates: what is carried has a clothness of 0, not nearly so

// Mean cosine along an edge between the way out and that from the crown: there the garment ends; there it begins, as waists and
// necks do (-1 to -0.85), and fronts do not (-0.6 to 0: the shortest way goes down beside them).
constexpr double kEnds = 0.2, kBegins = -0.65;

double length_of(const Vertices &vertices, const std::vector<int> &loop) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    length += (vertices.row(loop[(i + 1) % loop.size()]) - vertices.row(loop[i])).norm();
  return length;
}

/// Loops of the boundary that are no opening: where the scan has joined the cloth to what it touches, the skin in a sleeve.
std::vector<std::vector<int>> pinholes(const Mesh &mesh) {
  std::vector<std::vector<int>> loops = boundary_loops(mesh.faces);
  std::erase_if(loops, [&](const auto &loop) { return length_of(mesh.vertices, loop) > kPinhole; });
  return loops;
}

/// A stretch of a loop of one kind.
struct Run {
  std::size_t first = 0, count = 0;
  double length = 0; ///< m
};

std::vector<Run> runs_of(const Vertices &vertices, const std::vector<int> &loop, const std::vector<char> &kinds) {
  const std::size_t n = loop.size();
  std::vector<Run> runs;
  for (std::size_t i = 0; i < n; ++i) {
    if (kinds[i] == kinds[(i + n - 1) % n])
      continue;
    Run run{i, 0, 0};
    for (; run.count < n && kinds[(i + run.count) % n] == kinds[i]; ++run.count)
      run.length += (vertices.row(loop[(i + run.count + 1) % n]) - vertices.row(loop[(i + run.count) % n])).norm();
    runs.push_back(run);
  }
  return runs; // none if all is of one kind
}

/// Runs that are shorter than `smallest` become the other kind, the shortest first.
void merge_short_runs(const Vertices &vertices, const std::vector<int> &loop, double smallest, std::vector<char> &kinds) {
  for (std::vector<Run> runs = runs_of(vertices, loop, kinds); !runs.empty(); runs = runs_of(vertices, loop, kinds)) {
    const Run &shortest =
        *std::min_element(runs.begin(), runs.end(), [](const Run &a, const Run &b) { return a.length < b.length; });
    if (shortest.length >= smallest)
      break;
    for (std::size_t k = 0; k < shortest.count; ++k)
      kinds[(shortest.first + k) % loop.size()] ^= 1;
  }
}

/// [loop] means of the values (N) along the loop, within `reach` m of each vertex.
std::vector<double> means_along(const Vertices &vertices, const std::vector<int> &loop, const Eigen::VectorXd &values,
                                double reach) {
  std::vector<double> along{0}, means;
  for (std::size_t i = 0; i < loop.size(); ++i)
    along.push_back(along.back() + (vertices.row(loop[(i + 1) % loop.size()]) - vertices.row(loop[i])).norm());
  for (std::size_t i = 0; i < loop.size(); ++i) {
    double sum = 0, weight = 0;
    for (std::size_t j = 0; j < loop.size(); ++j)
      if (std::abs(std::remainder(along[j] - along[i], along.back())) <= reach) {
        sum += (along[j + 1] - along[j]) * values[loop[j]];
        weight += along[j + 1] - along[j];
      }
    means.push_back(weight > 0 ? sum / weight : values[loop[i]]);
  }
  return means;
}

double mean_over(const std::vector<int> &loop, const Eigen::VectorXd &values) {
  return values(loop).mean();
}

/// [loop] 1 = hangs on the skin. `skin` (N): diffused indicator of skin against nothing on the far side of the cut; `ends` (N):
/// of leads_from_top(); `limbs` (N): of on_limbs(). Runs that are shorter than `smallest` do not count.
std::vector<char> hanging(const Vertices &vertices, const std::vector<int> &loop, const Eigen::VectorXd &skin,
                          const Eigen::VectorXd &ends, const Eigen::VectorXd &limbs, double smallest) {
  std::vector<char> kinds;
  for (int v : loop)
    kinds.push_back(skin[v] > 0.5);
  merge_short_runs(vertices, loop, smallest, kinds);
  // Tucked in at the waist, a whole loop holds, though the garment ends there the way the trunk does.
  const bool skin_all_around = std::find(kinds.begin(), kinds.end(), 0) == kinds.end();
  if (skin_all_around && mean_over(loop, limbs) <= 0.5 && mean_over(loop, ends) > kEnds)
    return kinds;
  // Cloth hangs from where it begins. A leg that touches the hem, or is one surface with it in a scan made of silhouettes, does
  // not hold it; nor do an arm in a cuff, or what shows between the fronts of an open jacket.
  const std::vector<double> begins = means_along(vertices, loop, ends, smallest / 2);
  for (std::size_t i = 0; i < loop.size(); ++i)
    kinds[i] &= begins[i] < kBegins;
  merge_short_runs(vertices, loop, smallest, kinds);
  return kinds;
}

/// The frame in which the piece is spread out, but not the very widest (the worst tracking); -1 if there is none.
int wide_frame(const RiggedMesh &actor, const Piece &piece, const MeshSequence &captured) {
  std::vector<std::pair<double, int>> by_area;
  for (std::size_t t = 0; t < captured.frames.size(); ++t)
    by_area.emplace_back(-face_areas(placed(piece, actor.mesh.faces, captured.frames[t]), piece.mesh.faces).sum(),
                         static_cast<int>(t));
  std::sort(by_area.begin(), by_area.end());
  return by_area.empty() ? -1 : by_area[static_cast<std::size_t>(kTooWide * static_cast<double>(by_area.size()))].second;
}

/// (N) 1 for the vertices of the piece's boundary that the garment hangs from.
std::vector<char> hanging_vertices(const Piece &piece, const Eigen::VectorXd &skin_at_cut, const Eigen::VectorXd &ends,
                                   const Eigen::VectorXd &limbs, double min_edge_run) {
  std::vector<char> result(piece.mesh.vertices.rows(), 0);
  for (const std::vector<int> &loop : boundary_loops(piece.mesh.faces)) {
    if (length_of(piece.mesh.vertices, loop) <= kPinhole)
      continue;
    const std::vector<char> kinds = hanging(piece.mesh.vertices, loop, skin_at_cut, ends, limbs, min_edge_run);
    for (std::size_t i = 0; i < loop.size(); ++i)
      result[loop[i]] = kinds[i];
  }
  return result;
}

/// The part of the piece that a way along its edges leads to from where it hangs; what hangs on nothing would fall.
Piece hanging_part(const Piece &piece, std::vector<char> &hangs) {
  std::vector<int> sources, faces, old_vertex;
  for (std::size_t v = 0; v < hangs.size(); ++v)
    if (hangs[v])
      sources.push_back(static_cast<int>(v));
  const Eigen::VectorXd way = edge_distances(
      piece.mesh.vertices, vertex_neighbours(piece.mesh.faces, static_cast<int>(piece.mesh.vertices.rows())), sources);
  Piece part;
  for (int f = 0; f < piece.mesh.faces.rows(); ++f)
    if (std::isfinite(way[piece.mesh.faces(f, 0)])) {
      faces.push_back(f);
      part.actor_face.push_back(piece.actor_face[f]);
      part.corners.push_back(piece.corners[f]);
    }
  part.mesh = faces.empty() ? Mesh{Vertices(0, 3), Faces(0, 3)} : submesh(piece.mesh, faces, &old_vertex);
  std::vector<char> kept;
  for (int v : old_vertex)
    kept.push_back(hangs[v]);
  hangs = std::move(kept);
  return part;
}

/// Which vertices of the new mesh's boundary hang: as the nearest of the cut, whose vertices are at `cut` (N, 3).
std::vector<int> attached_vertices(const Mesh &mesh, const Piece &piece, const Vertices &cut, const std::vector<char> &hangs) {
  std::vector<int> border, attached;
  for (const std::vector<int> &loop : boundary_loops(piece.mesh.faces))
    border.insert(border.end(), loop.begin(), loop.end());
  for (const std::vector<int> &loop : boundary_loops(mesh.faces))
    for (int v : loop) {
      const auto squared = [&](int w) { return (cut.row(w) - mesh.vertices.row(v)).squaredNorm(); };
      if (hangs[*std::min_element(border.begin(), border.end(), [&](int a, int b) { return squared(a) < squared(b); })])
        attached.push_back(v);
    }
  return attached;
}

/// About `vertices` of them in regular triangles, two each: the remesher's edges come out up to a tenth shorter than they are
/// asked for, by how much depends on the mesh that it is given.
Mesh remeshed(const Mesh &mesh, double vertices, double noise) {
  double edge = std::sqrt(2 * face_areas(mesh.vertices, mesh.faces).sum() / (std::sqrt(3.0) * vertices));
  Mesh result;
  double ratio = 1;
  for (int i = 0; i < 3 && (i == 0 || std::abs(ratio - 1) > kOffCount); ++i) {
    edge *= std::sqrt(ratio);
    result = detail::remesh_isotropic(mesh, edge, noise);
    ratio = static_cast<double>(result.vertices.rows()) / vertices;
  }
  return result;
}

/// The piece in the frame in which it is spread out.
struct WidestFrame {
  int frame = -1; ///< row of the captured frames; -1 = the scan pose, there are none
  Mesh mesh;
};

WidestFrame widest_frame_of(const RiggedMesh &actor, const Piece &piece, const MeshSequence &captured) {
  const int wide = wide_frame(actor, piece, captured);
  const Vertices &vertices = wide < 0 ? actor.mesh.vertices : captured.frames[wide];
  return {wide, {placed(piece, actor.mesh.faces, vertices), piece.mesh.faces}};
}

/// Some rows of so many frames, all over the motion, and `wide`.
std::vector<int> sampled_rows(std::size_t frames, int wide) {
  constexpr int kRows = 8;
  std::set<int> rows{wide};
  for (int k = 0; k < kRows; ++k)
    rows.insert(static_cast<int>(k * (frames - 1) / (kRows - 1)));
  return {rows.begin(), rows.end()};
}

/// Where a vertex lies on the piece.
struct Place {
  int face = 0;
  Eigen::Vector3d barycentric;
};

/// Of points (N, 3) on the surface of `mesh`, which has the piece's faces.
std::vector<Place> places_on(const Mesh &mesh, const Vertices &points) {
  const RayScene scene(mesh);
  std::vector<Place> places;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const ClosestPoint at = scene.closest(points.row(i).transpose());
    places.push_back({at.face, at.barycentric});
  }
  return places;
}

/// The part of a garment that has these faces and whose vertices have these places.
Garment placed_garment(const RiggedMesh &actor, const Piece &piece, const Faces &faces, const std::vector<Place> &places) {
  Garment garment;
  garment.mesh.faces = faces;
  garment.barycentric.resize(static_cast<Eigen::Index>(places.size()), 3);
  garment.actor_face.resize(static_cast<Eigen::Index>(places.size()));
  for (std::size_t v = 0; v < places.size(); ++v) {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      place += places[v].barycentric[k] * piece.corners[places[v].face][k];
    garment.actor_face[static_cast<Eigen::Index>(v)] = piece.actor_face[places[v].face];
    garment.barycentric.row(static_cast<Eigen::Index>(v)) = (place / place.sum()).transpose();
  }
  garment.mesh.vertices = interpolate_to_garment(garment, actor.mesh.faces, actor.mesh.vertices);
  return garment;
}

/// [exceedances] (N, 3) m, from what the frames show; `wide`: the one in which it is spread out.
std::vector<Vertices> rest_shapes_of(const Garment &garment, const RiggedMesh &actor, const MeshSequence &captured, int wide,
                                     const std::vector<int> &attached, const std::vector<double> &exceedances) {
  std::vector<Vertices> frames, shapes;
  for (const Vertices &frame : captured.frames)
    frames.push_back(interpolate_to_garment(garment, actor.mesh.faces, frame));
  for (double exceedance : exceedances)
    shapes.push_back(detail::rest_shape(garment.mesh.faces, garment.mesh.vertices, frames, wide, attached, exceedance));
  return shapes;
}

/// (M, 3) the points at these places on the faces of a mesh with such vertices.
Vertices points_at(const std::vector<Place> &places, const Faces &faces, const Vertices &vertices) {
  Vertices points = Vertices::Zero(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (int k = 0; k < 3; ++k)
      points.row(static_cast<Eigen::Index>(i)) += places[i].barycentric[k] * vertices.row(faces(places[i].face, k));
  return points;
}

/// (N) by the way from where it hangs, in the rest shape.
Eigen::VectorXd clothness_of(const Garment &garment, const std::vector<int> &attached, double band) {
  const Eigen::VectorXd way =
      edge_distances(garment.rest, vertex_neighbours(garment.mesh.faces, static_cast<int>(garment.rest.rows())), attached);
  return band > 0 ? Eigen::VectorXd((way / band).cwiseMin(1.0)) : Eigen::VectorXd((way.array() > 0).cast<double>());
}

/// (N, 3 K) of N vertices in K shapes.
MatrixRM side_by_side(const std::vector<Vertices> &shapes) {
  MatrixRM all(shapes[0].rows(), 3 * static_cast<Eigen::Index>(shapes.size()));
  for (std::size_t k = 0; k < shapes.size(); ++k)
    all.middleCols(3 * static_cast<Eigen::Index>(k), 3) = shapes[k];
  return all;
}

/// The point of the faces nearest to the origin, their corners (N, n) in any number of dimensions.
Place nearest_place(const Faces &faces, const MatrixRM &corners) {
  const Eigen::VectorXd squared = corners.rowwise().squaredNorm();
  double nearest = std::numeric_limits<double>::infinity();
  Place best;
  for (int f = 0; f < faces.rows(); ++f) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    const double aa = squared[a], bb = squared[b], cc = squared[c], ab = corners.row(a).dot(corners.row(b)),
                 ac = corners.row(a).dot(corners.row(c)), bc = corners.row(b).dot(corners.row(c));
    // The way from a corner to the origin is the corner's negative.
    const Eigen::Vector3d w = closest_on_triangle(aa - ab, aa - ac, ab - bb, ab - bc, ac - bc, ac - cc);
    const double distance =
        w[0] * w[0] * aa + w[1] * w[1] * bb + w[2] * w[2] * cc + 2 * (w[0] * w[1] * ab + w[0] * w[2] * ac + w[1] * w[2] * bc);
    if (distance < nearest) {
      nearest = distance;
      best = {f, w};
    }
  }
  return best;
}

/// The places of vertices that are given on another mesh of the garment, `from`: nearest over several frames at once, since in
/// any single one layers of cloth touch and folds are squeezed. `captured` in the rows `rows`, and the scan pose.
std::vector<Place> carried_places(const RiggedMesh &actor, const MeshSequence &captured, const std::vector<int> &rows,
                                  const Piece &piece, const Garment &from, const std::vector<Place> &on_from) {
  std::vector<Vertices> of_piece{piece.mesh.vertices}, of_from{from.mesh.vertices};
  for (int row : rows) {
    of_piece.push_back(placed(piece, actor.mesh.faces, captured.frames[row]));
    of_from.push_back(interpolate_to_garment(from, actor.mesh.faces, captured.frames[row]));
  }
  const MatrixRM corners = side_by_side(of_piece), from_points = side_by_side(of_from);
  MatrixRM points = MatrixRM::Zero(static_cast<Eigen::Index>(on_from.size()), corners.cols());
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (int k = 0; k < 3; ++k)
      points.row(i) += on_from[i].barycentric[k] * from_points.row(from.mesh.faces(on_from[i].face, k));
  std::vector<Place> result;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    result.push_back(nearest_place(piece.mesh.faces, corners.rowwise() - points.row(i)));
  return result;
}

/// One region's part of a garment, before it is one of several. Its triangles are regular in the rest shape: what is folded even
/// in the frame in which the piece is spread out would be left with a few long ones. So the piece is meshed there first, which
/// gives a rest shape of every width, and the answer is the middle one, meshed again; the others are carried over to its mesh.
Garment mesh_region(const RiggedMesh &actor, const MeshSequence &captured, const Piece &piece, const WidestFrame &widest,
                    const std::vector<char> &hangs, int region, double vertices, const GarmentOptions &options) {
  const Mesh closed = detail::with_closed_loops(widest.mesh, pinholes(piece.mesh));
  const Mesh first = remeshed(detail::without_handles(closed, kHandle), vertices, 0);
  const auto attached = [&](const Mesh &mesh) { return attached_vertices(mesh, piece, widest.mesh.vertices, hangs); };
  Garment garment = placed_garment(actor, piece, first.faces, places_on(widest.mesh, first.vertices));
  std::vector<int> seam = attached(first);
  const std::size_t middle = (options.length_exceedances.size() - 1) / 2;
  if (widest.frame < 0) // nothing to tell widths from
    garment.rest = rest_shapes_of(garment, actor, captured, widest.frame, seam, {options.length_exceedances[middle]})[0];
  else {
    const std::vector<Vertices> shapes = rest_shapes_of(garment, actor, captured, widest.frame, seam, options.length_exceedances);
    const Mesh rest{shapes[middle], garment.mesh.faces};
    const Mesh second = remeshed(rest, vertices, options.min_edge_run);
    const std::vector<Place> on_first = places_on(rest, second.vertices);
    const std::vector<int> rows = sampled_rows(captured.frames.size(), widest.frame);
    garment = placed_garment(actor, piece, second.faces, carried_places(actor, captured, rows, piece, garment, on_first));
    seam = attached({interpolate_to_garment(garment, actor.mesh.faces, captured.frames[widest.frame]), second.faces});
    garment.rest = second.vertices;
    for (std::size_t k = 0; k < shapes.size() && shapes.size() > 1; ++k)
      garment.widths.push_back(k == middle ? garment.rest : points_at(on_first, rest.faces, shapes[k]));
  }
  garment.clothness = clothness_of(garment, seam, options.attachment_width);
  garment.region = Eigen::VectorXi::Constant(garment.mesh.vertices.rows(), region);
  return garment;
}

/// Does the cut run through this face between garment and skin? Such faces stay, under the garment's edge, or there would be a
/// gap.
bool is_waistband(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &field, int f) {
  bool skin = false;
  for (int k = 0; k < 3; ++k) {
    const int v = actor.mesh.faces(f, k);
    skin |= field[v] <= detail::kCut && segmentation.clothness[v] < 0.5;
  }
  return skin && actor.face_valid[f];
}

void append(Garment &all, const Garment &part) {
  const Eigen::Index before = all.mesh.vertices.rows(), count = part.mesh.vertices.rows(), faces = all.mesh.faces.rows();
  const auto grow = [&](auto &to, const auto &from) {
    to.conservativeResize(before + count, to.cols());
    to.bottomRows(count) = from;
  };
  grow(all.mesh.vertices, part.mesh.vertices);
  grow(all.region, part.region);
  grow(all.clothness, part.clothness);
  grow(all.rest, part.rest);
  all.widths.resize(part.widths.size(), Vertices(0, 3));
  for (std::size_t k = 0; k < part.widths.size(); ++k)
    grow(all.widths[k], part.widths[k]);
  grow(all.actor_face, part.actor_face);
  grow(all.barycentric, part.barycentric);
  all.mesh.faces.conservativeResize(faces + part.mesh.faces.rows(), 3);
  all.mesh.faces.bottomRows(part.mesh.faces.rows()) = part.mesh.faces.array() + static_cast<int>(before);
}

void check_inputs(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured) {
  require_actor(actor, "garment");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "garment");
  require_frames(captured.frames, actor.mesh.vertices.rows(), "garment: a captured frame");
  if (body.vertices.rows() > 0)
    require_usable(body, "garment: body");
}

void say_what_falls(const Piece &whole, const Piece &hung, bool is_free, int region, const Context &context) {
  const std::string name = "garment: region " + std::to_string(region);
  const auto area = [](const Piece &piece) { return face_areas(piece.mesh.vertices, piece.mesh.faces).sum(); };
  if (!is_free)
    context.log_line(name + " lies on the body; it moves as skin");
  else if (whole.mesh.faces.rows() == 0)
    context.log_line(name + " is too small or too thin for a mesh; it moves as skin");
  else if (hung.mesh.faces.rows() == 0)
    context.log_line(name + " does not touch skin, so nothing holds it; it moves as skin");
  else if (hung.mesh.faces.rows() < whole.mesh.faces.rows())
    context.log_line(name + ": " + options::to_text(area(whole) - area(hung), 4) +
                     " m^2 of it are held by nothing and move as skin");
}

class IsotropicMesher : public GarmentMesher {
public:
  explicit IsotropicMesher(const GarmentOptions &options) : options_(options) { options_.validate(); }

  Garment mesh(const RiggedMesh &actor, const Segmentation &found, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    check_inputs(actor, found, body, captured);
    Garment garment;
    garment.attachment = detail::attachment_of(actor, found, options_);
    garment.mesh = {Vertices(0, 3), Faces(0, 3)};
    garment.barycentric.resize(0, 3);
    garment.rest.resize(0, 3);
    garment.replaced_faces.assign(actor.mesh.faces.rows(), 0);
    if (!options_.remesh)
      return garment;
    const std::vector<char> free = detail::free_regions(actor, found, garment.attachment);
    const Segmentation segmentation = detail::with_regions(found, free);
    const std::vector<char> sheet = detail::closing_sheet(actor, segmentation);
    std::vector<Eigen::VectorXd> fields;
    std::vector<Piece> pieces;
    std::vector<WidestFrame> widest;
    std::vector<std::vector<char>> hangs; // [R][N]
    std::vector<double> areas;            // [R] m^2, spread out
    for (int r = 0; r < segmentation.region_count; ++r) {
      fields.push_back(detail::garment_field(actor, sheet, segmentation, r, options_));
      const Piece whole = detail::cut_out(actor.mesh, fields.back());
      const Eigen::VectorXd skin = detail::skin_around(actor, sheet, fields.back(), whole, options_.closing_length);
      hangs.push_back(hanging_vertices(whole, skin, detail::leads_from_top(actor, whole), detail::on_limbs(actor, whole),
                                       options_.min_edge_run));
      pieces.push_back(hanging_part(whole, hangs.back()));
      say_what_falls(whole, pieces.back(), free[r], r, context);
      widest.push_back(widest_frame_of(actor, pieces.back(), captured));
      areas.push_back(face_areas(widest.back().mesh.vertices, widest.back().mesh.faces).sum());
    }
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    for (int r = 0; r < segmentation.region_count; ++r) {
      context.report_progress("garment", static_cast<double>(r) / segmentation.region_count);
      if (pieces[r].mesh.faces.rows() == 0) {
        garment.attachment = (found.region.array() == r).select(1.0, garment.attachment.array());
        continue;
      }
      const Garment part = mesh_region(actor, captured, pieces[r], widest[r], hangs[r], garment.region_count,
                                       options_.vertices * areas[r] / area, options_);
      append(garment, part);
      for (int f : pieces[r].actor_face)
        garment.replaced_faces[f] = !is_waistband(actor, segmentation, fields[r], f);
      ++garment.region_count;
    }
    const Eigen::ArrayXd carried = interpolate_to_garment(garment, actor.mesh.faces, garment.attachment).array();
    const Eigen::ArrayXd loose = (carried > 1 - kRounding).select(0.0, 1 - carried);
    garment.clothness = garment.clothness.cwiseMin(loose.matrix());
    const std::vector<char> scraps = detail::scraps(actor, garment.replaced_faces, body, options_.min_piece_area);
    for (std::size_t f = 0; f < scraps.size() && garment.region_count > 0; ++f)
      garment.replaced_faces[f] |= scraps[f];
    context.report_progress("garment", 1.0);
    return garment;
  }

private:
  GarmentOptions options_;
};

} // namespace

void GarmentOptions::validate() const {
  options::check(*this);
  if (length_exceedances.empty() || !std::is_sorted(length_exceedances.begin(), length_exceedances.end()))
    throw std::invalid_argument("GarmentOptions: length_exceedances: expected at least one, ascending, found " +
                                std::string(length_exceedances.empty() ? "none" : "others"));
}

std::unique_ptr<GarmentMesher> GarmentMesher::create(const GarmentOptions &options) {
  return std::make_unique<IsotropicMesher>(options);
}

Garment mesh_garment(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
                     const GarmentOptions &options, const Context &context) {
  return GarmentMesher::create(options)->mesh(actor, segmentation, body, captured, context);
}

GarmentSummary summarise_garment(const Garment &garment) {
  GarmentSummary summary;
  summary.vertices = static_cast<int>(garment.mesh.vertices.rows());
  summary.faces = static_cast<int>(garment.mesh.faces.rows());
  summary.regions = garment.region_count;
  if (summary.faces == 0)
    return summary;
  require_usable(garment.mesh, "garment");
  if (garment.rest.rows() != summary.vertices || garment.clothness.size() != summary.vertices)
    throw std::invalid_argument("summarise_garment: expected rest and clothness of " + std::to_string(summary.vertices) +
                                " vertices, found " + std::to_string(garment.rest.rows()) + " and " +
                                std::to_string(garment.clothness.size()));
  for (const std::vector<int> &loop : boundary_loops(garment.mesh.faces)) {
    ++summary.loops;
    summary.hanging_loops += std::any_of(loop.begin(), loop.end(), [&](int v) { return garment.clothness[v] == 0; });
  }
  summary.mean_edge = mean_edge_length(garment.rest, garment.mesh.faces);
  std::vector<double> angles;
  for (Eigen::Index f = 0; f < garment.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d p = garment.rest.row(garment.mesh.faces(f, k)),
                               a = garment.rest.row(garment.mesh.faces(f, (k + 1) % 3)) - p,
                               b = garment.rest.row(garment.mesh.faces(f, (k + 2) % 3)) - p;
      angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  const auto first = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 100);
  std::nth_element(angles.begin(), first, angles.end());
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  summary.smallest_angle = *first * kDegrees;
  return summary;
}

} // namespace doublet
