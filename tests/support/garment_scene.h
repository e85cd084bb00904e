#pragma once
// An actor in a garment of two triangles.

#include "doublet/core/garment.h"
#include "support/figure.h"

namespace doublet::testing {

/// A ball with weights and sigmas of no pattern; its first face is invalid.
struct GarmentScene {
  RiggedMesh actor;
  Segmentation segmentation;
  Garment garment;

  GarmentScene() {
    actor.skeleton = figure_skeleton();
    actor.mesh = sphere(0.5);
    actor.face_valid.assign(actor.mesh.faces.rows(), 1);
    actor.face_valid[0] = 0;
    actor.weights = MatrixRM::Random(actor.mesh.vertices.rows(), actor.skeleton.joint_count()).cwiseAbs();
    actor.weights.array().colwise() /= actor.weights.rowwise().sum().array();
    segmentation.sigma = Eigen::VectorXd::LinSpaced(actor.mesh.vertices.rows(), 0, 0.1);
    segmentation.clothness = Eigen::VectorXd::Ones(actor.mesh.vertices.rows());
    segmentation.region = Eigen::VectorXi::Zero(actor.mesh.vertices.rows());
    segmentation.region_count = 1;
    make_garment();
  }

  /// Two triangles of two regions.
  void make_garment() {
    garment.actor_face.resize(6);
    garment.actor_face << 10, 20, 30, 40, 50, 60;
    garment.barycentric.resize(6, 3);
    garment.barycentric << 1, 0, 0, 0.5, 0.5, 0, 0.25, 0.25, 0.5, 0, 1, 0, 0.75, 0, 0.25, 0.125, 0.375, 0.5;
    garment.mesh.vertices = interpolate_to_garment(garment, actor.mesh.faces, actor.mesh.vertices);
    garment.mesh.faces.resize(2, 3);
    garment.mesh.faces << 0, 1, 2, 3, 4, 5;
    garment.region.resize(6);
    garment.region << 0, 0, 0, 1, 1, 1;
    garment.region_count = 2;
    garment.clothness.resize(6);
    garment.clothness << 0, 0.5, 1, 0, 0.25, 1;
    garment.rest = 1.5 * garment.mesh.vertices;
    garment.replaced_faces.assign(actor.mesh.faces.rows(), 0);
    for (int f : {10, 20, 30})
      garment.replaced_faces[f] = 1;
  }
  Eigen::Index bare() const { return actor.mesh.vertices.rows(); }
};

inline Garment empty_garment(const RiggedMesh &actor) {
  Garment garment;
  garment.mesh = {Vertices(0, 3), Faces(0, 3)};
  garment.rest.resize(0, 3);
  garment.barycentric.resize(0, 3);
  garment.replaced_faces.assign(actor.mesh.faces.rows(), 0);
  return garment;
}

} // namespace doublet::testing
