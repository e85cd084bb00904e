#include "doublet/core/garment.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

/// `top` over `bottom`.
template <class Matrix> Matrix stacked(const Matrix &top, const Matrix &bottom) {
  Matrix both(top.rows() + bottom.rows(), top.cols());
  both << top, bottom;
  return both;
}

} // namespace

void validate_garment(const Garment &garment, const RiggedMesh &actor, const std::string &what) {
  require_usable(garment.mesh, what);
  const Eigen::Index count = garment.mesh.vertices.rows();
  const auto expect = [&](const char *array, Eigen::Index found) {
    if (found != count)
      throw Error(what + ": array '" + array + "': expected " + std::to_string(count) + " rows, one a vertex, found " +
                  std::to_string(found));
  };
  expect("region", garment.region.size());
  expect("clothness", garment.clothness.size());
  expect("rest", garment.rest.rows());
  expect("actor_face", garment.actor_face.size());
  expect("barycentric", garment.barycentric.rows());
  if (static_cast<Eigen::Index>(garment.covers.size()) != actor.mesh.faces.rows())
    throw Error(what + ": array 'covers': expected " + std::to_string(actor.mesh.faces.rows()) +
                " entries, one a face of the actor, found " + std::to_string(garment.covers.size()));
  for (Eigen::Index v = 0; v < count; ++v) {
    const auto fail = [&](const std::string &expected, double found) {
      throw Error(what + ": vertex " + std::to_string(v) + ": expected " + expected + ", found " + std::to_string(found));
    };
    if (garment.region[v] < 0 || garment.region[v] >= garment.region_count)
      fail("a region below " + std::to_string(garment.region_count), garment.region[v]);
    if (!(garment.clothness[v] >= 0 && garment.clothness[v] <= 1))
      fail("a clothness in [0, 1]", garment.clothness[v]);
    if (!garment.rest.row(v).allFinite())
      fail("a finite rest position", garment.rest(v, 0));
    if (garment.actor_face[v] < 0 || garment.actor_face[v] >= actor.mesh.faces.rows())
      fail("a face below " + std::to_string(actor.mesh.faces.rows()) + " of the actor", garment.actor_face[v]);
    if (!(garment.barycentric.row(v).minCoeff() > -1e-3 && std::abs(garment.barycentric.row(v).sum() - 1) < 1e-3))
      fail("barycentric coordinates with sum one", garment.barycentric.row(v).sum());
  }
}

MatrixRM at_garment(const Garment &garment, const Faces &actor_faces, const MatrixRM &values) {
  MatrixRM result = MatrixRM::Zero(garment.actor_face.size(), values.cols());
  for (Eigen::Index v = 0; v < result.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      result.row(v) += garment.barycentric(v, k) * values.row(actor_faces(garment.actor_face[v], k));
  return result;
}

DressedActor dress(const RiggedMesh &actor, const Segmentation &segmentation, const Garment &garment) {
  require_actor(actor, "dress");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "dress");
  if (garment.region_count == 0)
    return {actor, segmentation};
  validate_garment(garment, actor, "garment");
  const Eigen::Index bare = actor.mesh.vertices.rows(), count = garment.mesh.vertices.rows(), faces = actor.mesh.faces.rows();
  DressedActor dressed;
  RiggedMesh &mesh = dressed.actor;
  mesh.skeleton = actor.skeleton;
  mesh.mesh.vertices = stacked(actor.mesh.vertices, garment.mesh.vertices);
  mesh.mesh.faces = stacked(actor.mesh.faces, Faces(garment.mesh.faces.array() + static_cast<int>(bare)));
  mesh.weights = stacked(actor.weights, at_garment(garment, actor.mesh.faces, actor.weights));
  mesh.face_valid = actor.face_valid;
  mesh.face_valid.resize(faces, 1);
  for (Eigen::Index f = 0; f < faces; ++f)
    if (garment.covers[f])
      mesh.face_valid[f] = 0;
  mesh.face_valid.resize(faces + garment.mesh.faces.rows(), 1);

  Segmentation &cloth = dressed.segmentation;
  cloth.region_count = garment.region_count;
  cloth.sigma = Eigen::VectorXd::Constant(bare + count, std::numeric_limits<double>::quiet_NaN());
  cloth.sigma.head(std::min(bare, segmentation.sigma.size())) =
      segmentation.sigma.head(std::min(bare, segmentation.sigma.size()));
  cloth.clothness = stacked<Eigen::VectorXd>(Eigen::VectorXd::Zero(bare), garment.clothness);
  cloth.region = stacked<Eigen::VectorXi>(Eigen::VectorXi::Constant(bare, -1), garment.region);
  cloth.rest = stacked<Vertices>(actor.mesh.vertices, garment.rest);
  return dressed;
}

ReferencePerformance dress(const ReferencePerformance &performance, const RiggedMesh &actor, const Garment &garment) {
  require_actor(actor, "dress");
  require_frames(performance.surface.frames, actor.mesh.vertices.rows(), "dress: a captured frame");
  if (garment.region_count == 0)
    return performance;
  validate_garment(garment, actor, "garment");
  ReferencePerformance dressed = performance;
  dressed.surface.unposed.clear();
  dressed.surface.colours.resize(0, 3);
  const Faces cloth = garment.mesh.faces.array() + static_cast<int>(actor.mesh.vertices.rows());
  dressed.surface.faces = stacked(actor.mesh.faces, cloth);
  for (Vertices &frame : dressed.surface.frames)
    frame = stacked<Vertices>(frame, at_garment(garment, actor.mesh.faces, frame));
  return dressed;
}

} // namespace doublet
