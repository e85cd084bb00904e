#include "bone_shapes.h"

#include "doublet/core/mesh.h"

namespace doublet {
namespace {

using Eigen::Vector3d;

/// Weights with which every blend of bones can be undone at all poses: where bones turn against each other by almost half a turn,
/// the strongest bone alone.
MatrixRM undoable_weights(const glb::GlbMesh &shown, MatrixRM weights, const std::vector<Transforms> &poses) {
  constexpr double kLeastVolume = 0.05; // what the blend leaves of a unit cube
  const glb::Influences influences = glb::viewer_influences(shown, weights);
  for (const Transforms &pose : poses) {
    const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(influences, pose);
    for (std::size_t i = 0; i < blends.size(); ++i)
      if (!(blends[i].linear().determinant() > kLeastVolume)) {
        Eigen::Index strongest = 0;
        weights.row(shown.vertex_from_shown[i]).maxCoeff(&strongest);
        weights.row(shown.vertex_from_shown[i]).setZero();
        weights(shown.vertex_from_shown[i], strongest) = 1;
      }
  }
  return weights;
}

} // namespace

BoundMesh bind_mesh(std::string name, glb::GlbMesh shown, Faces faces, MatrixRM weights, const std::vector<Vertices> &positions,
                    const std::vector<Transforms> &poses) {
  BoundMesh mesh;
  mesh.name = std::move(name);
  mesh.weights = undoable_weights(shown, std::move(weights), poses);
  mesh.shown = std::move(shown);
  mesh.faces = std::move(faces);
  mesh.influences = glb::viewer_influences(mesh.shown, mesh.weights);
  mesh.positions = &positions;
  mesh.poses = &poses;
  return mesh;
}

Floats3 shape_at(const BoundMesh &mesh, int frame) {
  const Vertices &places = (*mesh.positions)[frame];
  const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(mesh.influences, (*mesh.poses)[frame]);
  Floats3 shape(blends.size(), 3);
  for (std::size_t i = 0; i < blends.size(); ++i) {
    const Vector3d place = places.row(mesh.shown.vertex_from_shown[i]);
    shape.row(i) = (blends[i].inverse() * place).cast<float>().transpose();
  }
  return shape;
}

Floats3 normals_at(const BoundMesh &mesh, int frame) {
  const Vertices world = vertex_normals((*mesh.positions)[frame], mesh.faces);
  const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(mesh.influences, (*mesh.poses)[frame]);
  Floats3 normals(blends.size(), 3);
  for (std::size_t i = 0; i < blends.size(); ++i) {
    const Vector3d normal = world.row(mesh.shown.vertex_from_shown[i]);
    const Vector3d back = blends[i].linear().inverse() * normal;
    normals.row(i) = (back.norm() > 1e-6 ? back.normalized() : Vector3d::UnitY()).cast<float>().transpose();
  }
  return normals;
}

std::vector<double> errors_at(const BoundMesh &mesh, int frame, const Floats3 &shape) {
  const Vertices &places = (*mesh.positions)[frame];
  const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(mesh.influences, (*mesh.poses)[frame]);
  std::vector<double> errors;
  for (std::size_t i = 0; i < blends.size(); ++i) {
    const Vector3d place = places.row(mesh.shown.vertex_from_shown[i]), bare = shape.row(i).cast<double>();
    errors.push_back((blends[i] * bare - place).norm());
  }
  return errors;
}

} // namespace doublet
