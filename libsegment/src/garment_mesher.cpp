#include "doublet/segment/garment_mesher.h"

#include "doublet/core/error.h"
#include "doublet/core/ray_scene.h"
#include "doublet/core/surface_distance.h"
#include "doublet/segment/diffusion.h"
#include "isotropic.h"
#include "rest_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kCut = 0.5;        // of the diffused indicator: the middle of the step from skin to cloth
constexpr double kOffCut = 0.02;    // no vertex is nearer to the cut, which would make slivers
constexpr double kTooWide = 0.03;   // share of the frames
constexpr double kOnBody = 0.012;   // m, about the error of the hidden body: nearer, the surface lies on it
constexpr double kLeafShare = 0.05; // of a patch on a hand, a foot or the head: it ends there
constexpr double kOffCount = 0.1;   // of the wanted number of vertices
constexpr double kFacesAway = 0.5;  // cosine between a normal and the way a garment ends

/// Values of faces to vertices: means weighted by area; faces of unknown value do not count, a vertex between such is unknown.
Eigen::VectorXd to_vertices(const Mesh &mesh, const Eigen::VectorXd &face_values) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.vertices.rows()), weight = sum;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if (!std::isnan(face_values[f]))
      for (int k = 0; k < 3; ++k) {
        sum[mesh.faces(f, k)] += areas[f] * face_values[f];
        weight[mesh.faces(f, k)] += areas[f];
      }
  for (Eigen::Index v = 0; v < sum.size(); ++v)
    sum[v] = weight[v] > 0 ? sum[v] / weight[v] : kUnknown;
  return sum;
}

/// Where the garment on a joint's bone ends: along the bone to its child; on the trunk, whose garments hang from it, downwards.
Eigen::Vector3d away_along(const Skeleton &skeleton, int joint) {
  int child = -1, count = 0;
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (skeleton.joints[j].parent == joint) {
      child = j;
      ++count;
    }
  const int from = count == 1 ? joint : skeleton.joints[joint].parent, to = count == 1 ? child : joint;
  if (count > 1 || from < 0)
    return -Eigen::Vector3d::UnitY();
  const Eigen::Vector3d way = (skeleton.joints[to].rest - skeleton.joints[from].rest).normalized();
  return way.y() > 0.5 ? Eigen::Vector3d(-Eigen::Vector3d::UnitY()) : way;
}

/// [F] the faces that share an edge with each.
std::vector<std::vector<int>> faces_beside(const Faces &faces) {
  std::vector<std::vector<int>> beside(faces.rows());
  for (const Eigen::Vector2i &pair : edge_topology(faces).edge_faces)
    if (pair[0] >= 0 && pair[1] >= 0) {
      beside[pair[0]].push_back(pair[1]);
      beside[pair[1]].push_back(pair[0]);
    }
  return beside;
}

/// [F] the joint that moves each face most.
std::vector<int> joint_of_faces(const RiggedMesh &actor) {
  std::vector<int> result;
  for (Eigen::Index f = 0; f < actor.mesh.faces.rows(); ++f) {
    const auto weight = [&](int k) { return actor.weights.row(actor.mesh.faces(f, k)); };
    Eigen::Index joint = 0;
    (weight(0) + weight(1) + weight(2)).maxCoeff(&joint);
    result.push_back(static_cast<int>(joint));
  }
  return result;
}

bool is_leaf(const Skeleton &skeleton, int joint) {
  return std::none_of(skeleton.joints.begin(), skeleton.joints.end(), [&](const Joint &j) { return j.parent == joint; });
}

/// (F) 1 for the sheet that closes the scan below a hem: the invalid faces, and what is left beside them that faces the way the
/// garment ends.
std::vector<char> closing_sheet(const RiggedMesh &actor) {
  const Faces &faces = actor.mesh.faces;
  const Vertices normals = face_normals(actor.mesh.vertices, faces);
  std::vector<Eigen::Vector3d> away;
  for (int j = 0; j < actor.skeleton.joint_count(); ++j)
    away.push_back(away_along(actor.skeleton, j));
  std::vector<char> sheet(faces.rows()), seen(faces.rows());
  std::vector<int> front;
  const std::vector<int> joints = joint_of_faces(actor);
  for (int f = 0; f < faces.rows(); ++f) {
    sheet[f] = !actor.face_valid[f] || normals.row(f).dot(away[joints[f]].transpose()) > kFacesAway;
    seen[f] = !actor.face_valid[f];
    if (seen[f])
      front.push_back(f);
  }
  const auto beside = faces_beside(faces);
  for (std::size_t i = 0; i < front.size(); ++i)
    for (int f : beside[front[i]])
      if (sheet[f] && !seen[f]) {
        seen[f] = 1;
        front.push_back(f);
      }
  return seen;
}

/// (F) 1 for skin that moved as if it were cloth: what lies on the body beyond a garment's end (a knee below a hem that brushes
/// it), or at the end of a limb. A waistband lies on the body, too, but on the side where the garment hangs.
std::vector<char> bare_ends(const RiggedMesh &actor, const std::vector<char> &sheet, const Clothness &clothness,
                            const Mesh &body) {
  const Faces &faces = actor.mesh.faces;
  std::vector<char> bare(faces.rows(), 0);
  if (body.faces.rows() == 0)
    return bare;
  Vertices centres(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    centres.row(f) =
        (actor.mesh.vertices.row(faces(f, 0)) + actor.mesh.vertices.row(faces(f, 1)) + actor.mesh.vertices.row(faces(f, 2))) / 3;
  const Eigen::VectorXd distance = distances_to_surface(centres, body), areas = face_areas(actor.mesh.vertices, faces);
  const auto cloth = [&](int f) {
    return clothness.clothness[faces(f, 0)] + clothness.clothness[faces(f, 1)] + clothness.clothness[faces(f, 2)] > 1.5;
  };
  const auto beside = faces_beside(faces);
  const std::vector<int> joints = joint_of_faces(actor);
  std::vector<char> seen(faces.rows(), 0);
  for (int start = 0; start < faces.rows(); ++start) {
    const auto lies_on_body = [&](int f) { return !sheet[f] && cloth(f) && distance[f] < kOnBody; };
    if (seen[start] || !lies_on_body(start))
      continue;
    std::vector<int> patch{start};
    seen[start] = 1;
    double beyond = 0, ends = 0, area = 0; // beyond: how far the skin around lies towards the limb's end, m times edges
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    std::vector<int> around;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const int f = patch[i];
      area += areas[f];
      middle += areas[f] * centres.row(f);
      ends += is_leaf(actor.skeleton, joints[f]) ? areas[f] : 0.0;
      for (int g : beside[f]) {
        if (!sheet[g] && !cloth(g))
          around.push_back(g);
        if (!seen[g] && lies_on_body(g)) {
          seen[g] = 1;
          patch.push_back(g);
        }
      }
    }
    middle /= area;
    for (int g : around)
      beyond += (centres.row(g) - middle).dot(away_along(actor.skeleton, joints[g]).transpose());
    if (beyond > 0 || ends > kLeafShare * area)
      for (int f : patch)
        bare[f] = 1;
  }
  return bare;
}

/// What of each face is cloth of the region, [0, 1]; what is `excluded` (the sheet below the hem, bare skin) is not.
Eigen::VectorXd cloth_of_faces(const RiggedMesh &actor, const std::vector<char> &excluded, const Clothness &clothness,
                               int region) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(actor.mesh.faces.rows());
  for (Eigen::Index f = 0; f < result.size(); ++f)
    for (int k = 0; k < 3 && !excluded[f]; ++k) {
      const int v = actor.mesh.faces(f, k);
      result[f] += clothness.region[v] == region ? clothness.clothness[v] / 3 : 0.0;
    }
  return result;
}

/// Connected sets of vertices on one side of the cut that are too small change sides.
void drop_small_sets(const Mesh &mesh, double smallest, bool above, Eigen::VectorXd &field) {
  const auto on_side = [&](int v) { return (field[v] > kCut) == above; };
  Faces chosen(mesh.faces.rows(), 3);
  const Eigen::VectorXd areas = vertex_areas(mesh.vertices, mesh.faces);
  const auto neighbours = vertex_neighbours(mesh.faces, static_cast<int>(field.size()));
  std::vector<char> seen(field.size(), 0);
  for (int start = 0; start < field.size(); ++start) {
    if (seen[start] || !on_side(start))
      continue;
    std::vector<int> members{start};
    seen[start] = 1;
    double area = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      area += areas[members[i]];
      for (int w : neighbours[members[i]])
        if (!seen[w] && on_side(w)) {
          seen[w] = 1;
          members.push_back(w);
        }
    }
    if (area < smallest)
      for (int v : members)
        field[v] = 2 * kCut - field[v];
  }
}

/// A piece of the actor's surface: every corner of every face knows its place on the actor.
struct Piece {
  Mesh mesh;
  std::vector<int> actor_face;                         ///< [F]
  std::vector<std::array<Eigen::Vector3d, 3>> corners; ///< [F] barycentric on the actor's face
};

/// (N, 3) where the piece's vertices are when the actor's are at `actor_vertices`.
Vertices placed(const Piece &piece, const Faces &actor_faces, const Vertices &actor_vertices) {
  Vertices result(piece.mesh.vertices.rows(), 3);
  for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      Eigen::RowVector3d p = Eigen::RowVector3d::Zero();
      for (int j = 0; j < 3; ++j)
        p += piece.corners[f][k][j] * actor_vertices.row(actor_faces(piece.actor_face[f], j));
      result.row(piece.mesh.faces(f, k)) = p;
    }
  return result;
}

/// The surface where field > kCut, cut along the line between (marching triangles).
Piece cut_out(const Mesh &mesh, const Eigen::VectorXd &field) {
  Piece piece;
  std::vector<Eigen::RowVector3d> points;
  std::vector<std::array<int, 3>> faces;
  std::map<std::array<int, 2>, int> index; // of a vertex (v, v) or of the point on an edge
  const auto point_at = [&](int a, int b) {
    const auto [it, fresh] = index.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(points.size()));
    if (fresh) {
      const double t = a == b ? 0.0 : (kCut - field[it->first[0]]) / (field[it->first[1]] - field[it->first[0]]);
      points.push_back(mesh.vertices.row(it->first[0]) + t * (mesh.vertices.row(it->first[1]) - mesh.vertices.row(it->first[0])));
    }
    return it->second;
  };
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    std::vector<int> ids; // of the polygon above the cut
    std::vector<Eigen::Vector3d> places;
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      if (field[a] > kCut) {
        ids.push_back(point_at(a, a));
        places.push_back(Eigen::Vector3d::Unit(k));
      }
      if ((field[a] > kCut) != (field[b] > kCut)) {
        const double t = (kCut - field[a]) / (field[b] - field[a]);
        ids.push_back(point_at(a, b));
        places.push_back((1 - t) * Eigen::Vector3d::Unit(k) + t * Eigen::Vector3d::Unit((k + 1) % 3));
      }
    }
    for (std::size_t k = 2; k < ids.size(); ++k) {
      faces.push_back({ids[0], ids[k - 1], ids[k]});
      piece.actor_face.push_back(f);
      piece.corners.push_back({places[0], places[k - 1], places[k]});
    }
  }
  piece.mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    piece.mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i];
  piece.mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    piece.mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return piece;
}

/// The boundary as loops of vertices, each in the order of its faces.
std::vector<std::vector<int>> boundary_loops(const Faces &faces) {
  std::map<int, int> next;
  std::set<std::array<int, 2>> directed;
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      directed.insert({faces(f, k), faces(f, (k + 1) % 3)});
  for (const auto &[a, b] : directed)
    if (!directed.count({b, a}))
      next[a] = b;
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    for (auto it = next.begin(); it != next.end();) {
      loop.push_back(it->first);
      const int to = it->second;
      next.erase(it);
      it = next.find(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

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

/// The boundary vertices of the piece: does each hang?
std::vector<std::pair<int, char>> kinds_of_cut(const Piece &piece, const Eigen::VectorXd &skin_at_cut, double smallest_edge) {
  std::vector<std::pair<int, char>> cut;
  for (const std::vector<int> &loop : boundary_loops(piece.mesh.faces)) {
    const std::vector<char> kinds = hanging(piece.mesh.vertices, loop, skin_at_cut, smallest_edge);
    for (std::size_t i = 0; i < loop.size(); ++i)
      cut.emplace_back(loop[i], kinds[i]);
  }
  return cut;
}

/// The connected parts of the piece that hang on skin; the others would fall.
Piece hung_part(const Piece &piece, const Eigen::VectorXd &skin_at_cut, double smallest_edge) {
  const Eigen::VectorXi part = vertex_components(piece.mesh.faces, static_cast<int>(piece.mesh.vertices.rows()));
  std::set<int> hung;
  for (const auto &[v, hangs] : kinds_of_cut(piece, skin_at_cut, smallest_edge))
    if (hangs)
      hung.insert(part[v]);
  Piece result;
  std::vector<int> chosen;
  for (int f = 0; f < piece.mesh.faces.rows(); ++f)
    if (hung.count(part[piece.mesh.faces(f, 0)])) {
      chosen.push_back(f);
      result.actor_face.push_back(piece.actor_face[f]);
      result.corners.push_back(piece.corners[f]);
    }
  result.mesh = submesh(piece.mesh, chosen);
  return result;
}

/// Which vertices of the new mesh's boundary hang: as the nearest vertex of the cut.
std::vector<int> attached_vertices(const Mesh &mesh, const Piece &piece, const Vertices &piece_vertices,
                                   const Eigen::VectorXd &skin_at_cut, double smallest_edge) {
  const std::vector<std::pair<int, char>> cut = kinds_of_cut(piece, skin_at_cut, smallest_edge);
  std::vector<int> attached;
  for (const std::vector<int> &loop : boundary_loops(mesh.faces))
    for (int v : loop) {
      const auto squared = [&](const auto &c) { return (piece_vertices.row(c.first) - mesh.vertices.row(v)).squaredNorm(); };
      const auto nearest =
          std::min_element(cut.begin(), cut.end(), [&](const auto &a, const auto &b) { return squared(a) < squared(b); });
      if (nearest->second)
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
Garment mesh_region(const RiggedMesh &actor, const MeshSequence &captured, const Piece &piece, const Eigen::VectorXd &skin_at_cut,
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
  const std::vector<int> attached = attached_vertices(garment.mesh, piece, spread.vertices, skin_at_cut, options.smallest_edge);
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

void check_inputs(const RiggedMesh &actor, const Clothness &clothness, const MeshSequence &captured) {
  require_usable(actor.mesh, "garment: actor");
  const auto expect = [](const std::string &what, Eigen::Index found, Eigen::Index expected) {
    if (found != expected)
      throw std::invalid_argument("garment: " + what + ": expected " + std::to_string(expected) + " entries, found " +
                                  std::to_string(found));
  };
  expect("actor.face_valid", static_cast<Eigen::Index>(actor.face_valid.size()), actor.mesh.faces.rows());
  expect("clothness", clothness.clothness.size(), actor.mesh.vertices.rows());
  expect("clothness.region", clothness.region.size(), actor.mesh.vertices.rows());
  for (const Vertices &frame : captured.frames)
    expect("a captured frame", frame.rows(), actor.mesh.vertices.rows());
}

class IsotropicMesher : public GarmentMesher {
public:
  explicit IsotropicMesher(const GarmentOptions &options) : options_(options) { options_.validate(); }

  Garment mesh(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    check_inputs(actor, clothness, captured);
    Garment garment;
    garment.mesh = {Vertices(0, 3), Faces(0, 3)};
    garment.barycentric.resize(0, 3);
    garment.rest.resize(0, 3);
    garment.covers.assign(actor.mesh.faces.rows(), 0);
    if (!options_.own_mesh)
      return garment;
    const std::vector<char> sheet = closing_sheet(actor);
    std::vector<char> excluded = bare_ends(actor, sheet, clothness, body);
    for (std::size_t f = 0; f < excluded.size(); ++f)
      excluded[f] |= sheet[f];
    std::vector<Eigen::VectorXd> fields;
    std::vector<Piece> pieces;
    double area = 0;
    for (int r = 0; r < clothness.region_count; ++r) {
      fields.push_back(garment_field(actor, excluded, clothness, r));
      const Piece whole = cut_out(actor.mesh, fields.back());
      pieces.push_back(hung_part(whole, skin_around(actor, sheet, fields.back(), whole), options_.smallest_edge));
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
      const Garment part = mesh_region(actor, captured, pieces[r], skin_around(actor, sheet, fields[r], pieces[r]),
                                       garment.region_count, edge, options_);
      if (!(part.clothness.array() == 0).any()) {
        context.say("garment: region " + std::to_string(r) + " does not touch skin and hangs on nothing; it moves as skin");
        continue;
      }
      append(garment, part);
      for (int f : pieces[r].actor_face)
        garment.covers[f] = 1;
      ++garment.region_count;
    }
    context.report("garment", 1.0);
    return garment;
  }

private:
  static void say_what_falls(const Piece &whole, const Piece &hung, int region, const Context &context) {
    const std::string name = "garment: region " + std::to_string(region);
    if (whole.mesh.faces.rows() == 0)
      context.say(name + " is too small or too thin for a mesh; it moves as skin");
    else if (hung.mesh.faces.rows() == 0)
      context.say(name + " does not touch skin and hangs on nothing; it moves as skin");
    else if (hung.mesh.faces.rows() < whole.mesh.faces.rows())
      context.say(name + ": " +
                  std::to_string(face_areas(whole.mesh.vertices, whole.mesh.faces).sum() -
                                 face_areas(hung.mesh.vertices, hung.mesh.faces).sum()) +
                  " m^2 of it hang on nothing and move as skin");
  }

  /// (V) what is garment, above and below kCut.
  Eigen::VectorXd garment_field(const RiggedMesh &actor, const std::vector<char> &excluded, const Clothness &clothness,
                                int region) const {
    Eigen::VectorXd field = to_vertices(actor.mesh, cloth_of_faces(actor, excluded, clothness, region));
    field = diffuse_on_surface(actor.mesh.vertices, actor.mesh.faces, field, options_.closing);
    for (double &value : field)
      value = std::isfinite(value) ? value : 0.0;
    drop_small_sets(actor.mesh, options_.smallest_hole, false, field);
    drop_small_sets(actor.mesh, options_.smallest_piece, true, field);
    for (double &value : field)
      if (std::abs(value - kCut) < kOffCut)
        value = value > kCut ? kCut + kOffCut : kCut - kOffCut;
    return field;
  }

  /// (N) at the vertices of the piece: 1 where the cut runs along skin, 0 where the surface beyond it is invented (a hem).
  Eigen::VectorXd skin_around(const RiggedMesh &actor, const std::vector<char> &sheet, const Eigen::VectorXd &field,
                              const Piece &piece) const {
    Eigen::VectorXd faces(actor.mesh.faces.rows());
    for (Eigen::Index f = 0; f < faces.size(); ++f) {
      const bool garment =
          field[actor.mesh.faces(f, 0)] + field[actor.mesh.faces(f, 1)] + field[actor.mesh.faces(f, 2)] > 3 * kCut;
      faces[f] = garment ? kUnknown : sheet[f] ? 0.0 : 1.0;
    }
    const Eigen::VectorXd skin =
        diffuse_on_surface(actor.mesh.vertices, actor.mesh.faces, to_vertices(actor.mesh, faces), options_.closing);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(piece.mesh.vertices.rows());
    for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        double value = 0;
        for (int j = 0; j < 3; ++j)
          value += piece.corners[f][k][j] * skin[actor.mesh.faces(piece.actor_face[f], j)];
        result[piece.mesh.faces(f, k)] = value;
      }
    return result;
  }

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
