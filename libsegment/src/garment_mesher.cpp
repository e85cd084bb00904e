#include "doublet/segment/garment_mesher.h"

#include "doublet/core/error.h"
#include "doublet/core/ray_scene.h"
#include "garment_field.h"
#include "isotropic.h"
#include "rest_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace doublet {

using detail::boundary_loops;
using detail::Piece;
using detail::placed;

namespace {

constexpr double kTooWide = 0.03; // share of the frames
constexpr double kOffCount = 0.1; // of the wanted number of vertices

/// [loop] 1 = hangs on the skin. `skin` (N): diffused indicator of skin against nothing on the far side of the cut.
std::vector<char> hanging(const Vertices &vertices, const std::vector<int> &loop, const Eigen::VectorXd &skin, double smallest) {
  const std::size_t n = loop.size();
  std::vector<char> result(n);
  for (std::size_t i = 0; i < n; ++i)
    result[i] = skin[loop[i]] > 0.5;
  const auto length = [&](std::size_t i) { return (vertices.row(loop[(i + 1) % n]) - vertices.row(loop[i])).norm(); };
  // Short runs of one kind become the other, the shortest first.
  while (true) {
    double shortest = smallest;
    std::size_t first = n, count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (result[i] == result[(i + n - 1) % n])
        continue; // not the start of a run
      double run = 0;
      std::size_t k = 0;
      for (; k < n && result[(i + k) % n] == result[i]; ++k)
        run += length((i + k) % n);
      if (run < shortest) {
        shortest = run;
        first = i;
        count = k;
      }
    }
    if (first == n)
      return result;
    for (std::size_t k = 0; k < count; ++k)
      result[(first + k) % n] ^= 1;
  }
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
std::vector<char> hanging_vertices(const Piece &piece, const Eigen::VectorXd &skin_at_cut, double smallest_edge) {
  std::vector<char> result(piece.mesh.vertices.rows(), 0);
  for (const std::vector<int> &loop : boundary_loops(piece.mesh.faces)) {
    const std::vector<char> kinds = hanging(piece.mesh.vertices, loop, skin_at_cut, smallest_edge);
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
  const Eigen::VectorXd way = detail::distances_along(piece.mesh.faces, piece.mesh.vertices, sources);
  Piece part;
  for (int f = 0; f < piece.mesh.faces.rows(); ++f)
    if (way[piece.mesh.faces(f, 0)] < detail::kNoWay) {
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
  std::vector<int> rim, attached;
  for (const std::vector<int> &loop : boundary_loops(piece.mesh.faces))
    rim.insert(rim.end(), loop.begin(), loop.end());
  for (const std::vector<int> &loop : boundary_loops(mesh.faces))
    for (int v : loop) {
      const auto squared = [&](int w) { return (cut.row(w) - mesh.vertices.row(v)).squaredNorm(); };
      if (hangs[*std::min_element(rim.begin(), rim.end(), [&](int a, int b) { return squared(a) < squared(b); })])
        attached.push_back(v);
    }
  return attached;
}

/// Regular triangles with edges of about `edge` (m), and as many as such edges would make: the remesher's come out up to a tenth
/// shorter, by how much depends on the mesh that it is given.
Mesh remeshed(const Mesh &mesh, double edge) {
  const double wanted = 2 * face_areas(mesh.vertices, mesh.faces).sum() / (std::sqrt(3.0) * edge * edge);
  Mesh result;
  double ratio = 1;
  for (int i = 0; i < 3 && (i == 0 || std::abs(ratio - 1) > kOffCount); ++i) {
    edge *= std::sqrt(ratio);
    result = detail::remesh_isotropic(mesh, edge);
    ratio = static_cast<double>(result.vertices.rows()) / wanted;
  }
  return result;
}

/// One region's part of a garment, before it is one of several.
Garment mesh_region(const RiggedMesh &actor, const MeshSequence &captured, const Piece &piece, const std::vector<char> &hangs,
                    int region, double edge, const GarmentOptions &options) {
  const int wide = wide_frame(actor, piece, captured);
  const Vertices &spread_out = wide < 0 ? actor.mesh.vertices : captured.frames[wide];
  const Mesh spread{placed(piece, actor.mesh.faces, spread_out), piece.mesh.faces};
  Garment garment;
  garment.mesh = remeshed(spread, edge);
  const Eigen::Index count = garment.mesh.vertices.rows();
  const RayScene scene(spread);
  garment.actor_face.resize(count);
  garment.barycentric.resize(count, 3);
  for (Eigen::Index v = 0; v < count; ++v) {
    const ClosestPoint at = scene.closest(garment.mesh.vertices.row(v).transpose());
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      place += at.barycentric[k] * piece.corners[at.face][k];
    garment.actor_face[v] = piece.actor_face[at.face];
    garment.barycentric.row(v) = (place / place.sum()).transpose();
  }
  const std::vector<int> attached = attached_vertices(garment.mesh, piece, spread.vertices, hangs);
  garment.mesh.vertices = at_garment(garment, actor.mesh.faces, actor.mesh.vertices);
  std::vector<Vertices> frames;
  for (const Vertices &frame : captured.frames)
    frames.push_back(at_garment(garment, actor.mesh.faces, frame));
  garment.rest = detail::rest_shape(garment.mesh.faces, garment.mesh.vertices, frames, wide, attached, options.spread);
  const Eigen::VectorXd way = detail::distances_along(garment.mesh.faces, garment.rest, attached);
  garment.clothness =
      options.band > 0 ? Eigen::VectorXd((way / options.band).cwiseMin(1.0)) : Eigen::VectorXd((way.array() > 0).cast<double>());
  garment.region = Eigen::VectorXi::Constant(count, region);
  return garment;
}

/// Does the cut run through this face between garment and skin? Such faces stay, under the garment's edge, or there would be a
/// gap.
bool is_waistband(const RiggedMesh &actor, const Clothness &clothness, const Eigen::VectorXd &field, int f) {
  bool skin = false;
  for (int k = 0; k < 3; ++k) {
    const int v = actor.mesh.faces(f, k);
    skin |= field[v] <= detail::kCut && clothness.clothness[v] < 0.5;
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
  grow(all.actor_face, part.actor_face);
  grow(all.barycentric, part.barycentric);
  all.mesh.faces.conservativeResize(faces + part.mesh.faces.rows(), 3);
  all.mesh.faces.bottomRows(part.mesh.faces.rows()) = part.mesh.faces.array() + static_cast<int>(before);
}

void check_inputs(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured) {
  require_actor(actor, "garment");
  require_clothness(clothness, actor.mesh.vertices.rows(), "garment");
  require_frames(captured.frames, actor.mesh.vertices.rows(), "garment: a captured frame");
  if (body.vertices.rows() > 0)
    require_usable(body, "garment: body");
}

void say_what_falls(const Piece &whole, const Piece &hung, int region, const Context &context) {
  const std::string name = "garment: region " + std::to_string(region);
  const auto area = [](const Piece &piece) { return face_areas(piece.mesh.vertices, piece.mesh.faces).sum(); };
  if (whole.mesh.faces.rows() == 0)
    context.say(name + " is too small or too thin for a mesh; it moves as skin");
  else if (hung.mesh.faces.rows() == 0)
    context.say(name + " does not touch skin and hangs on nothing; it moves as skin");
  else if (hung.mesh.faces.rows() < whole.mesh.faces.rows())
    context.say(name + ": " + std::to_string(area(whole) - area(hung)) + " m^2 of it hang on nothing and move as skin");
}

class IsotropicMesher : public GarmentMesher {
public:
  explicit IsotropicMesher(const GarmentOptions &options) : options_(options) { options_.validate(); }

  Garment mesh(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    check_inputs(actor, clothness, body, captured);
    Garment garment;
    garment.mesh = {Vertices(0, 3), Faces(0, 3)};
    garment.barycentric.resize(0, 3);
    garment.rest.resize(0, 3);
    garment.covers.assign(actor.mesh.faces.rows(), 0);
    if (!options_.own_mesh)
      return garment;
    const std::vector<char> sheet = detail::closing_sheet(actor);
    std::vector<char> excluded = detail::bare_ends(actor, sheet, clothness, body);
    for (std::size_t f = 0; f < excluded.size(); ++f)
      excluded[f] |= sheet[f];
    std::vector<Eigen::VectorXd> fields;
    std::vector<Piece> pieces;
    std::vector<std::vector<char>> hangs; // [R][N]
    double area = 0;
    for (int r = 0; r < clothness.region_count; ++r) {
      fields.push_back(detail::garment_field(actor, excluded, clothness, r, options_));
      const Piece whole = detail::cut_out(actor.mesh, fields.back());
      const Eigen::VectorXd skin = detail::skin_around(actor, sheet, fields.back(), whole, options_.closing);
      hangs.push_back(hanging_vertices(whole, skin, options_.smallest_edge));
      pieces.push_back(hanging_part(whole, hangs.back()));
      say_what_falls(whole, pieces.back(), r, context);
      const int wide = wide_frame(actor, pieces.back(), captured);
      const Vertices &vertices = wide < 0 ? actor.mesh.vertices : captured.frames[wide];
      area += face_areas(placed(pieces.back(), actor.mesh.faces, vertices), pieces.back().mesh.faces).sum();
    }
    const double edge =
        std::sqrt(2 * area / (std::sqrt(3.0) * options_.vertices)); // area of an equilateral triangle, two a vertex
    for (int r = 0; r < clothness.region_count; ++r) {
      context.report("garment", static_cast<double>(r) / clothness.region_count);
      if (pieces[r].mesh.faces.rows() == 0)
        continue;
      const Garment part = mesh_region(actor, captured, pieces[r], hangs[r], garment.region_count, edge, options_);
      append(garment, part);
      for (int f : pieces[r].actor_face)
        garment.covers[f] = !is_waistband(actor, clothness, fields[r], f);
      ++garment.region_count;
    }
    context.report("garment", 1.0);
    return garment;
  }

private:
  GarmentOptions options_;
};

} // namespace

void GarmentOptions::validate() const {
  const auto check = [](bool ok, const std::string &expected, double found) {
    if (!ok)
      throw std::invalid_argument("GarmentOptions: expected " + expected + ", found " + std::to_string(found));
  };
  check(vertices >= 50 && vertices <= 200000, "vertices in [50, 200000]", vertices);
  check(closing >= 0 && closing <= 1, "closing in [0, 1] m", closing);
  check(smallest_hole >= 0 && smallest_hole <= 10, "smallest_hole in [0, 10] m^2", smallest_hole);
  check(smallest_piece >= 0 && smallest_piece <= 10, "smallest_piece in [0, 10] m^2", smallest_piece);
  check(smallest_edge >= 0 && smallest_edge <= 10, "smallest_edge in [0, 10] m", smallest_edge);
  check(spread > 0 && spread < 1, "spread in (0, 1)", spread);
  check(band >= 0 && band <= 1, "band in [0, 1] m", band);
}

std::unique_ptr<GarmentMesher> GarmentMesher::create(const GarmentOptions &options) {
  return std::make_unique<IsotropicMesher>(options);
}

Garment mesh_garment(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
                     const GarmentOptions &options, const Context &context) {
  return GarmentMesher::create(options)->mesh(actor, clothness, body, captured, context);
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
