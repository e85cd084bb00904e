#include "doublet/animate/level_of_detail.h"

#include "doublet/animate/character.h"
#include "doublet/core/error.h"
#include "doublet/core/mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <array>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

using Place = OpenMesh::Vec2d; ///< of the texture

struct Corners {
  std::array<int, 3> vertex;
  std::array<Place, 3> place;
  Place &at(OpenMesh::VertexHandle v) { return place[v.idx() == vertex[0] ? 0 : v.idx() == vertex[1] ? 1 : 2]; }
};

struct DetailTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
  FaceTraits { Corners corners; };
};
using DetailMesh = OpenMesh::TriMesh_ArrayKernelT<DetailTraits>;

/// Where the surface is not the same on both sides: its end, or another place of the texture.
bool is_seam(DetailMesh &mesh, OpenMesh::HalfedgeHandle edge) {
  const OpenMesh::FaceHandle left = mesh.face_handle(edge), right = mesh.opposite_face_handle(edge);
  if (!left.is_valid() || !right.is_valid())
    return true;
  const OpenMesh::VertexHandle from = mesh.from_vertex_handle(edge), to = mesh.to_vertex_handle(edge);
  Corners &a = mesh.data(left).corners, &b = mesh.data(right).corners;
  return a.at(from) != b.at(from) || a.at(to) != b.at(to);
}

/// m, from a point to a line through two others.
double off_line(const OpenMesh::Vec3d &p, const OpenMesh::Vec3d &a, const OpenMesh::Vec3d &b) {
  const double length = (b - a).norm();
  return length > 0 ? ((p - a) % (b - a)).norm() / length : (p - a).norm();
}

/// The quadric error; a vertex on a seam moves only along it, at the cost of how far that cuts a corner.
template <class MeshT> class ModSeamT : public OpenMesh::Decimater::ModQuadricT<MeshT> {
public:
  DECIMATING_MODULE(ModSeamT, MeshT, Seam)
  using Quadric = OpenMesh::Decimater::ModQuadricT<MeshT>;

  explicit ModSeamT(MeshT &mesh) : Quadric(mesh) {}

  float collapse_priority(const CollapseInfo &collapse) override {
    MeshT &mesh = Base::mesh();
    std::vector<OpenMesh::VertexHandle> along;
    for (const auto edge : mesh.voh_range(collapse.v0))
      if (is_seam(mesh, edge))
        along.push_back(mesh.to_vertex_handle(edge));
    if (along.empty())
      return Quadric::collapse_priority(collapse);
    if (along.size() != 2 || !is_seam(mesh, collapse.v0v1))
      return Base::ILLEGAL_COLLAPSE;
    const auto &other = mesh.point(along[0] == collapse.v1 ? along[1] : along[0]);
    const double cut = off_line(collapse.p0, collapse.p1, other), length = (collapse.p1 - other).norm();
    return Quadric::collapse_priority(collapse) + static_cast<float>(cut * cut * length * length);
  }

  /// The corners of the vertex that goes take the places that the other has on their side of the seam.
  void preprocess_collapse(const CollapseInfo &collapse) override {
    MeshT &mesh = Base::mesh();
    const auto of = [&](OpenMesh::FaceHandle face, OpenMesh::VertexHandle vertex) { return mesh.data(face).corners.at(vertex); };
    const bool both = collapse.fl.is_valid() && collapse.fr.is_valid();
    const OpenMesh::FaceHandle first = collapse.fl.is_valid() ? collapse.fl : collapse.fr, second = both ? collapse.fr : first;
    const Place gone = of(first, collapse.v0), one = of(first, collapse.v1), other = of(second, collapse.v1);
    for (const auto face : mesh.vf_range(collapse.v0)) {
      if (face == first || face == second)
        continue;
      Corners &corners = mesh.data(face).corners;
      const Place place = corners.at(collapse.v0) == gone ? one : other;
      corners.at(collapse.v0) = place;
      for (int &vertex : corners.vertex)
        if (vertex == collapse.v0.idx())
          vertex = collapse.v1.idx();
    }
  }
};

/// Can the triangle be added? As add_face() decides it, which says why not on an error stream that all threads share.
bool fits(const DetailMesh &mesh, const std::array<OpenMesh::VertexHandle, 3> &corner) {
  if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
    return false;
  std::array<OpenMesh::HalfedgeHandle, 3> side;
  for (int k = 0; k < 3; ++k) {
    side[k] = mesh.find_halfedge(corner[k], corner[(k + 1) % 3]);
    if (!mesh.is_boundary(corner[k]) || (side[k].is_valid() && !mesh.is_boundary(side[k])))
      return false;
  }
  for (int k = 0; k < 3; ++k) { // a fan that the triangle closes must be the only one at its vertex
    const OpenMesh::HalfedgeHandle in = side[k], out = side[(k + 1) % 3];
    if (!in.is_valid() || !out.is_valid() || mesh.next_halfedge_handle(in) == out)
      continue;
    OpenMesh::HalfedgeHandle end = mesh.opposite_halfedge_handle(out);
    while (!mesh.is_boundary(end))
      end = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(end));
    if (end == in)
      return false;
  }
  return true;
}

DetailMesh to_openmesh(const Vertices &vertices, const TexturedFaces &drawn, std::vector<int> &kept) {
  DetailMesh mesh;
  std::vector<DetailMesh::VertexHandle> handles;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v)
    handles.push_back(mesh.add_vertex({vertices(v, 0), vertices(v, 1), vertices(v, 2)}));
  for (Eigen::Index f = 0; f < drawn.faces.rows(); ++f) {
    const std::array corner{handles[drawn.faces(f, 0)], handles[drawn.faces(f, 1)], handles[drawn.faces(f, 2)]};
    if (!fits(mesh, corner)) {
      kept.push_back(static_cast<int>(f));
      continue;
    }
    Corners &corners = mesh.data(mesh.add_face(corner[0], corner[1], corner[2])).corners;
    for (int k = 0; k < 3; ++k) {
      corners.vertex[k] = drawn.faces(f, k);
      corners.place[k] =
          drawn.texcoords.rows() > 0 ? Place(drawn.texcoords(3 * f + k, 0), drawn.texcoords(3 * f + k, 1)) : Place(0, 0);
    }
  }
  for (int f : kept)
    for (int k = 0; k < 3; ++k)
      mesh.status(handles[drawn.faces(f, k)]).set_locked(true);
  return mesh;
}

TexturedFaces from_openmesh(const DetailMesh &mesh, const TexturedFaces &drawn, const std::vector<int> &kept) {
  std::vector<int> vertices;
  std::vector<double> places;
  const auto add = [&](int vertex, double u, double v) {
    vertices.push_back(vertex);
    places.insert(places.end(), {u, v});
  };
  for (const auto face : mesh.faces()) { // but those that are gone
    const Corners &corners = mesh.data(face).corners;
    for (int k = 0; k < 3; ++k)
      add(corners.vertex[k], corners.place[k][0], corners.place[k][1]);
  }
  const bool textured = drawn.texcoords.rows() > 0;
  for (int f : kept)
    for (int k = 0; k < 3; ++k)
      add(drawn.faces(f, k), textured ? drawn.texcoords(3 * f + k, 0) : 0, textured ? drawn.texcoords(3 * f + k, 1) : 0);
  const auto count = static_cast<Eigen::Index>(vertices.size());
  TexturedFaces reduced;
  reduced.faces = Eigen::Map<const Faces>(vertices.data(), count / 3, 3);
  if (textured)
    reduced.texcoords = Eigen::Map<const decltype(reduced.texcoords)>(places.data(), count, 2);
  return reduced;
}

void require_drawn(const Vertices &vertices, const TexturedFaces &drawn, int triangles) {
  if (drawn.faces.rows() > 0 && (drawn.faces.minCoeff() < 0 || drawn.faces.maxCoeff() >= vertices.rows()))
    throw std::invalid_argument("reduce_faces: faces: expected indices of the " + std::to_string(vertices.rows()) + " vertices");
  if (drawn.texcoords.rows() > 0 && drawn.texcoords.rows() != 3 * drawn.faces.rows())
    throw std::invalid_argument("reduce_faces: texcoords: expected " + std::to_string(3 * drawn.faces.rows()) +
                                " corners or none, found " + std::to_string(drawn.texcoords.rows()));
  if (triangles < 4)
    throw std::invalid_argument("reduce_faces: triangles: expected at least 4, found " + std::to_string(triangles));
  if (!vertices.allFinite() || !drawn.texcoords.allFinite())
    throw std::invalid_argument("reduce_faces: expected finite numbers, found NaN or infinity");
}

} // namespace

TexturedFaces drawn_faces(const Character &character) {
  validate_character(character);
  TexturedFaces drawn{valid_faces(character.high.faces, character.high_valid), {}};
  if (character.texcoords.rows() == 0)
    return drawn;
  drawn.texcoords.resize(3 * drawn.faces.rows(), 2);
  for (Eigen::Index f = 0, at = 0; f < character.high.faces.rows(); ++f)
    if (character.high_valid[f])
      drawn.texcoords.middleRows(3 * at++, 3) = character.texcoords.middleRows(3 * f, 3);
  return drawn;
}

TexturedFaces reduce_faces(const Vertices &vertices, const TexturedFaces &drawn, int triangles) {
  constexpr double kMostTurn = 60; // degrees, of a face in one collapse
  require_drawn(vertices, drawn, triangles);
  std::vector<int> kept;
  DetailMesh mesh = to_openmesh(vertices, drawn, kept);
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<DetailMesh> decimater(mesh);
  ModSeamT<DetailMesh>::Handle seam;
  OpenMesh::Decimater::ModNormalFlippingT<DetailMesh>::Handle flipping;
  decimater.add(seam);
  decimater.add(flipping);
  decimater.module(seam).unset_max_err(); // the number of triangles decides
  decimater.module(flipping).set_max_normal_deviation(kMostTurn);
  if (!decimater.initialize())
    throw Error("reduce_faces: the decimation could not be set up");
  decimater.decimate_to_faces(0, static_cast<std::size_t>(triangles));
  return from_openmesh(mesh, drawn, kept);
}

} // namespace doublet
