#include "garment_field.h"

#include "doublet/core/parts/connected_sets.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/face_neighbours.h"
#include "doublet/rays/surface_distance.h"
#include "doublet/segment/parts/diffusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kOffCut = 0.02;     // no vertex is nearer to the cut, which would make slivers
constexpr double kOnBody = 0.012;    // m, about the error of the hidden body: nearer, the surface lies on it
constexpr double kTouches = 0.05;    // of a piece of skin: so much of it lies on the body, whatever it wears or holds
constexpr double kAlongEdges = 0.03; // m, of ways along edges: they zigzag
constexpr double kFacesAway = 0.5;   // cosine between a normal and the way a garment ends

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

/// A bone of an arm or a leg: the trunk's, and the head's, go up, or part.
bool is_limb(const Skeleton &skeleton, int joint) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  return skeleton.joints[joint].parent >= 0 && away_along(skeleton, joint) != Eigen::Vector3d(-up);
}

/// (F, 3) unit vectors along the faces that lead away from the top of the surface they are on, which is the crown of a head.
Vertices ways_from_top(const Mesh &mesh) {
  const int n = static_cast<int>(mesh.vertices.rows());
  int count = 0;
  const Eigen::VectorXi piece = vertex_components(mesh.faces, n, &count);
  std::vector<int> tops(count, -1);
  for (int v = 0; v < n; ++v)
    if (piece[v] >= 0 && (tops[piece[v]] < 0 || mesh.vertices(v, 1) > mesh.vertices(tops[piece[v]], 1)))
      tops[piece[v]] = v;
  Eigen::VectorXd distance = edge_distances(mesh.vertices, vertex_neighbours(mesh.faces, n), tops);
  for (double &value : distance)
    value = std::isfinite(value) ? value : kUnknown; // a vertex on no face
  distance = diffuse_on_surface(mesh.vertices, mesh.faces, distance, kAlongEdges);
  const Vertices normals = face_normals(mesh.vertices, mesh.faces);
  Vertices ways(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < ways.rows(); ++f) { // the gradient, but for its length
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k)
      sum += distance[mesh.faces(f, k)] *
             (mesh.vertices.row(mesh.faces(f, (k + 2) % 3)) - mesh.vertices.row(mesh.faces(f, (k + 1) % 3)));
    ways.row(f) = Eigen::RowVector3d(normals.row(f)).cross(sum).normalized();
  }
  return ways;
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

/// What of each face is cloth of the region, [0, 1]; the sheet below the hem is not.
Eigen::VectorXd cloth_of_faces(const RiggedMesh &actor, const std::vector<char> &sheet, const Segmentation &segmentation,
                               int region) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(actor.mesh.faces.rows());
  for (Eigen::Index f = 0; f < result.size(); ++f)
    for (int k = 0; k < 3 && !sheet[f]; ++k) {
      const int v = actor.mesh.faces(f, k);
      result[f] += segmentation.region[v] == region ? segmentation.clothness[v] / 3 : 0.0;
    }
  return result;
}

/// Connected sets of vertices on one side of the cut that are too small change sides.
void drop_small_sets(const Mesh &mesh, double smallest, bool above, Eigen::VectorXd &field) {
  const Eigen::VectorXd areas = vertex_areas(mesh.vertices, mesh.faces);
  std::vector<char> on_side;
  for (double value : field)
    on_side.push_back((value > kCut) == above);
  for (const std::vector<int> &members : connected_sets(vertex_neighbours(mesh.faces, static_cast<int>(field.size())), on_side))
    if (areas(members).sum() < smallest)
      for (int v : members)
        field[v] = 2 * kCut - field[v];
}

} // namespace

std::vector<char> closing_sheet(const RiggedMesh &actor, const Segmentation &segmentation) {
  const Faces &faces = actor.mesh.faces;
  const Vertices normals = face_normals(actor.mesh.vertices, faces);
  const std::vector<int> joints = joint_of_faces(actor);
  std::vector<char> sheet(faces.rows()), cloth(faces.rows()), faces_away(faces.rows());
  std::vector<int> invalid, skin;
  for (int f = 0; f < faces.rows(); ++f) {
    faces_away[f] = normals.row(f).dot(away_along(actor.skeleton, joints[f]).transpose()) > kFacesAway;
    cloth[f] = segmentation.clothness(faces.row(f).transpose()).mean() > kCut;
    sheet[f] = !actor.face_valid[f];
    if (sheet[f])
      invalid.push_back(f);
    else if (!cloth[f])
      skin.push_back(f);
  }
  const auto beside = face_neighbours(faces);
  const auto grow = [&](std::vector<int> front, const auto &may_be) {
    for (std::size_t i = 0; i < front.size(); ++i)
      for (int f : beside[front[i]])
        if (faces_away[f] && !sheet[f] && may_be(f)) {
          sheet[f] = 1;
          front.push_back(f);
        }
  };
  grow(invalid, [](int) { return true; });
  grow(skin, [&](int f) { return cloth[f] != 0; });
  return sheet;
}

std::vector<char> scraps(const RiggedMesh &actor, const Mask &covered, const Mesh &body, double largest) {
  const Faces &faces = actor.mesh.faces;
  std::vector<char> result(faces.rows(), 0), left = result;
  if (body.faces.rows() == 0)
    return result;
  Vertices centres(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    centres.row(f) =
        (actor.mesh.vertices.row(faces(f, 0)) + actor.mesh.vertices.row(faces(f, 1)) + actor.mesh.vertices.row(faces(f, 2))) / 3;
    left[f] = actor.face_valid[f] && !covered[f];
  }
  const Eigen::VectorXd distance = distances_to_surface(centres, body), areas = face_areas(actor.mesh.vertices, faces);
  for (const std::vector<int> &patch : connected_sets(face_neighbours(faces), left)) {
    double area = 0, on_body = 0;
    for (int f : patch) {
      area += areas[f];
      on_body += distance[f] < kOnBody ? areas[f] : 0;
    }
    if (area < largest && on_body < kTouches * area)
      for (int f : patch)
        result[f] = 1;
  }
  return result;
}

Eigen::VectorXd garment_field(const RiggedMesh &actor, const std::vector<char> &sheet, const Segmentation &segmentation,
                              int region, const GarmentOptions &options) {
  Eigen::VectorXd field = to_vertices(actor.mesh, cloth_of_faces(actor, sheet, segmentation, region));
  field = diffuse_on_surface(actor.mesh.vertices, actor.mesh.faces, field, options.closing_length);
  for (double &value : field)
    value = std::isfinite(value) ? value : 0.0;
  drop_small_sets(actor.mesh, options.min_hole_area, false, field);
  drop_small_sets(actor.mesh, options.min_piece_area, true, field);
  for (double &value : field)
    if (std::abs(value - kCut) < kOffCut)
      value = value > kCut ? kCut + kOffCut : kCut - kOffCut;
  return field;
}

Eigen::VectorXd skin_around(const RiggedMesh &actor, const std::vector<char> &sheet, const Eigen::VectorXd &field,
                            const Piece &piece, double smoothing) {
  const Faces &faces = actor.mesh.faces;
  Eigen::VectorXd is_skin(faces.rows());
  for (Eigen::Index f = 0; f < is_skin.size(); ++f) {
    const bool garment = field[faces(f, 0)] + field[faces(f, 1)] + field[faces(f, 2)] > 3 * kCut;
    is_skin[f] = garment ? kUnknown : sheet[f] ? 0.0 : 1.0;
  }
  const Eigen::VectorXd skin = diffuse_on_surface(actor.mesh.vertices, faces, to_vertices(actor.mesh, is_skin), smoothing);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(piece.mesh.vertices.rows());
  for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      double value = 0;
      for (int j = 0; j < 3; ++j)
        value += piece.corners[f][k][j] * skin[faces(piece.actor_face[f], j)];
      result[piece.mesh.faces(f, k)] = std::isfinite(value) ? value : 0.0;
    }
  return result;
}

Eigen::VectorXd leads_from_top(const RiggedMesh &actor, const Piece &piece) {
  const Vertices &x = piece.mesh.vertices, from_top = ways_from_top(actor.mesh);
  const EdgeTopology edges = edge_topology(piece.mesh.faces);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(x.rows()), count = sum;
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    if (edges.edge_faces[e].minCoeff() >= 0)
      continue;
    const int f = edges.edge_faces[e].maxCoeff(), a = edges.edges[e][0], b = edges.edges[e][1];
    const Eigen::RowVector3d along = (x.row(b) - x.row(a)).normalized();
    const int opposite = piece.mesh.faces.row(f).sum() - a - b;
    const Eigen::RowVector3d across = x.row(a) - x.row(opposite), out = (across - across.dot(along) * along).normalized();
    const double cosine = out.dot(from_top.row(piece.actor_face[f]));
    for (int v : {a, b}) {
      sum[v] += cosine;
      count[v] += 1;
    }
  }
  return sum.cwiseQuotient(count.cwiseMax(1));
}

Eigen::VectorXd on_limbs(const RiggedMesh &actor, const Piece &piece) {
  const std::vector<int> joints = joint_of_faces(actor);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(piece.mesh.vertices.rows());
  for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f)
    for (int k = 0; k < 3 && is_limb(actor.skeleton, joints[piece.actor_face[f]]); ++k)
      result[piece.mesh.faces(f, k)] = 1;
  return result;
}

} // namespace doublet::detail
