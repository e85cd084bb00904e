#include "decimate.h"

#include "doublet/core/error.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace doublet::detail {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Surface = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

Surface to_openmesh(const Mesh &mesh) {
  Surface out;
  std::vector<Surface::VertexHandle> handles;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
    handles.push_back(out.add_vertex({mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if (!out.add_face(handles[mesh.faces(f, 0)], handles[mesh.faces(f, 1)], handles[mesh.faces(f, 2)]).is_valid())
      throw Error("surface: expected a manifold mesh to decimate, found that face " + std::to_string(f) +
                  " makes it non-manifold");
  return out;
}

Mesh from_openmesh(const Surface &surface) {
  Mesh out;
  out.vertices.resize(static_cast<Eigen::Index>(surface.n_vertices()), 3);
  out.faces.resize(static_cast<Eigen::Index>(surface.n_faces()), 3);
  for (const auto v : surface.vertices()) {
    const auto &p = surface.point(v);
    out.vertices.row(v.idx()) << p[0], p[1], p[2];
  }
  for (const auto f : surface.faces()) {
    int k = 0;
    for (const auto v : surface.fv_range(f))
      out.faces(f.idx(), k++) = v.idx();
  }
  return out;
}

} // namespace

Mesh decimate(const Mesh &mesh, int triangles) {
  Surface surface = to_openmesh(mesh);
  surface.request_face_normals();
  surface.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Surface> decimater(surface);
  OpenMesh::Decimater::ModQuadricT<Surface>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Surface>::Handle flipping;
  OpenMesh::Decimater::ModAspectRatioT<Surface>::Handle aspect;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.add(aspect);
  decimater.module(quadric).unset_max_err(); // the number of triangles decides
  decimater.module(flipping).set_max_normal_deviation(60);
  decimater.module(aspect).set_aspect_ratio(6); // longest edge over height; needles spoil the Laplacian and the cloth
  if (!decimater.initialize())
    throw Error("surface: the decimation could not be set up");
  decimater.decimate_to_faces(0, static_cast<std::size_t>(triangles));
  surface.garbage_collection();
  return from_openmesh(surface);
}

} // namespace doublet::detail
