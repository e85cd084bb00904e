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

} // namespace

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
