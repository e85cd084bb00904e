#include "decimate.h"

#include "doublet/core/error.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace doublet::detail {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Surface = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

using LabelHandle = OpenMesh::FPropHandleT<std::uint8_t>;

/// Allows a vertex on a rim to move along the rim only.
template <class MeshT> class ModRimT : public OpenMesh::Decimater::ModBaseT<MeshT> {
public:
  DECIMATING_MODULE(ModRimT, MeshT, Rim)

  explicit ModRimT(MeshT &mesh) : Base(mesh, true) {}
  void set_labels(LabelHandle labels) { labels_ = labels; }

  float collapse_priority(const CollapseInfo &collapse) override {
    MeshT &mesh = Base::mesh();
    const auto label = [&](auto face) { return mesh.property(labels_, face); };
    if (collapse.fl.is_valid() && collapse.fr.is_valid() && label(collapse.fl) != label(collapse.fr))
      return Base::LEGAL_COLLAPSE;
    for (const auto face : mesh.vf_range(collapse.v0))
      if (label(face) != label(collapse.fl.is_valid() ? collapse.fl : collapse.fr))
        return Base::ILLEGAL_COLLAPSE;
    return Base::LEGAL_COLLAPSE;
  }

private:
  LabelHandle labels_;
};

Surface to_openmesh(const LabelledMesh &labelled, LabelHandle &labels) {
  const Mesh &mesh = labelled.mesh;
  Surface out;
  out.add_property(labels);
  std::vector<Surface::VertexHandle> handles;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
    handles.push_back(out.add_vertex({mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto face = out.add_face(handles[mesh.faces(f, 0)], handles[mesh.faces(f, 1)], handles[mesh.faces(f, 2)]);
    if (!face.is_valid())
      throw Error("surface: expected a manifold mesh to decimate, found that face " + std::to_string(f) +
                  " makes it non-manifold");
    out.property(labels, face) = labelled.labels[f];
  }
  return out;
}

LabelledMesh from_openmesh(const Surface &surface, LabelHandle labels) {
  LabelledMesh out;
  Mesh &mesh = out.mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(surface.n_vertices()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(surface.n_faces()), 3);
  out.labels.resize(surface.n_faces());
  for (const auto v : surface.vertices()) {
    const auto &p = surface.point(v);
    mesh.vertices.row(v.idx()) << p[0], p[1], p[2];
  }
  for (const auto f : surface.faces()) {
    int k = 0;
    for (const auto v : surface.fv_range(f))
      mesh.faces(f.idx(), k++) = v.idx();
    out.labels[f.idx()] = surface.property(labels, f);
  }
  return out;
}

/// 1 for an equilateral triangle, 0 for a degenerate one.
double shape(const Surface::Point *c) {
  const double sides = (c[1] - c[0]).sqrnorm() + (c[2] - c[1]).sqrnorm() + (c[0] - c[2]).sqrnorm();
  return sides > 0 ? 2 * std::sqrt(3.0) * ((c[1] - c[0]) % (c[2] - c[0])).norm() / sides : 0;
}

double longest_edge(const Surface::Point *c) {
  return std::sqrt(std::max({(c[1] - c[0]).sqrnorm(), (c[2] - c[1]).sqrnorm(), (c[0] - c[2]).sqrnorm()}));
}

/// May the first vertex of the half-edge move onto the second? No face of a size that stays may turn over or become a needle.
bool collapse_helps(Surface &surface, Surface::HalfedgeHandle edge, double length) {
  if (!surface.is_collapse_ok(edge))
    return false;
  const auto from = surface.from_vertex_handle(edge), to = surface.to_vertex_handle(edge);
  const Surface::FaceHandle left = surface.face_handle(edge), right = surface.opposite_face_handle(edge);
  for (const auto face : surface.vf_range(from)) {
    if (face == left || face == right)
      continue;
    Surface::Point before[3], after[3];
    int k = 0;
    for (const auto v : surface.fv_range(face)) {
      before[k] = surface.point(v);
      after[k++] = surface.point(v == from ? to : v);
    }
    const auto normal = [](const Surface::Point *c) { return (c[1] - c[0]) % (c[2] - c[0]); };
    constexpr double kNeedle = 0.1; // below this shape a normal says little
    if (longest_edge(before) < length || shape(before) < kNeedle)
      continue; // it goes, too
    if ((normal(before) | normal(after)) <= 0 || shape(after) < kNeedle)
      return false;
  }
  return true;
}

/// One pass over all edges; returns how many went.
int collapse_pass(Surface &surface, double length) {
  int collapsed = 0;
  for (const auto edge : surface.edges()) {
    if (surface.status(edge).deleted() || surface.calc_edge_sqr_length(edge) >= length * length)
      continue;
    const auto half = surface.halfedge_handle(edge, 0), opposite = surface.halfedge_handle(edge, 1);
    const bool forward = collapse_helps(surface, half, length);
    if (!forward && !collapse_helps(surface, opposite, length))
      continue;
    surface.collapse(forward ? half : opposite);
    ++collapsed;
  }
  return collapsed;
}

} // namespace

Mesh collapse_short_edges(const Mesh &mesh, double length, std::vector<int> &old_vertex) {
  LabelHandle labels;
  Surface surface = to_openmesh({mesh, std::vector<std::uint8_t>(mesh.faces.rows(), 1)}, labels);
  OpenMesh::VPropHandleT<int> index;
  surface.add_property(index);
  for (const auto v : surface.vertices())
    surface.property(index, v) = v.idx();
  surface.request_vertex_status();
  surface.request_edge_status();
  surface.request_halfedge_status();
  surface.request_face_status();
  constexpr int kPasses = 10;
  for (int pass = 0; pass < kPasses && collapse_pass(surface, length) > 0; ++pass) {
  }
  surface.garbage_collection();
  old_vertex.clear();
  for (const auto v : surface.vertices())
    old_vertex.push_back(surface.property(index, v));
  return from_openmesh(surface, labels).mesh;
}

LabelledMesh decimate(const LabelledMesh &labelled, int triangles) {
  LabelHandle labels;
  Surface surface = to_openmesh(labelled, labels);
  surface.request_face_normals();
  surface.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Surface> decimater(surface);
  OpenMesh::Decimater::ModQuadricT<Surface>::Handle quadric;
  ModRimT<Surface>::Handle rim;
  OpenMesh::Decimater::ModNormalFlippingT<Surface>::Handle flipping;
  OpenMesh::Decimater::ModAspectRatioT<Surface>::Handle aspect;
  decimater.add(quadric);
  decimater.add(rim);
  decimater.add(flipping);
  decimater.add(aspect);
  decimater.module(quadric).unset_max_err(); // the number of triangles decides
  decimater.module(rim).set_labels(labels);
  decimater.module(flipping).set_max_normal_deviation(60);
  decimater.module(aspect).set_aspect_ratio(6); // longest edge over height; needles spoil the Laplacian and the cloth
  if (!decimater.initialize())
    throw Error("surface: the decimation could not be set up");
  decimater.decimate_to_faces(0, static_cast<std::size_t>(triangles));
  surface.garbage_collection();
  return from_openmesh(surface, labels);
}

} // namespace doublet::detail
