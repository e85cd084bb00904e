#pragma once
// What every GarmentMesher must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/segment/garment_mesher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <exception>
#include <string>
#include <vector>

namespace doublet::testing {

namespace detail {

/// m that a garment reaches beyond the faces with cloth on the actor, or that cloth reaches beyond the garment, in boxes; 0 if
/// either is nothing.
inline double beside_the_cloth(const Garment &garment, const RiggedMesh &actor, const Segmentation &segmentation) {
  Eigen::AlignedBox3d cloth, around, made;
  for (Eigen::Index v = 0; v < actor.mesh.vertices.rows(); ++v)
    if (segmentation.clothness[v] > 0)
      cloth.extend(actor.mesh.vertices.row(v).transpose());
  for (const auto &face : actor.mesh.faces.rowwise())
    if ((segmentation.clothness(face.transpose()).array() > 0).any())
      for (const int corner : face)
        around.extend(actor.mesh.vertices.row(corner).transpose());
  for (Eigen::Index v = 0; v < garment.mesh.vertices.rows(); ++v)
    made.extend(garment.mesh.vertices.row(v).transpose());
  if (cloth.isEmpty() || made.isEmpty())
    return 0;
  return std::max({(around.min() - made.min()).maxCoeff(), (made.max() - around.max()).maxCoeff(),
                   (made.min() - cloth.min()).maxCoeff(), (cloth.max() - made.max()).maxCoeff()});
}

} // namespace detail

/// One sentence for each rule that the mesher breaks on an actor and a segmentation of yours: the garment fits the actor
/// (validate_garment) and lies where its cloth does, two calls give the same bits, without cloth there are no vertices, and a
/// segmentation of another mesh is refused.
inline std::vector<std::string> garment_mesher_violations(const GarmentMesher &mesher, const RiggedMesh &actor,
                                                          const Segmentation &segmentation) {
  std::vector<std::string> broken;
  try {
    const Garment garment = mesher.mesh(actor, segmentation, {}, {}, {}), again = mesher.mesh(actor, segmentation, {}, {}, {});
    validate_garment(garment, actor, "the garment");
    const double beside = detail::beside_the_cloth(garment, actor, segmentation);
    if (beside > 0.1)
      broken.push_back("the garment is not where the cloth is: one reaches beyond the other by " + std::to_string(beside) + " m");
    const auto same = [](const auto &a, const auto &b) { return a.rows() == b.rows() && a == b; };
    if (!same(garment.mesh.vertices, again.mesh.vertices) || !same(garment.mesh.faces, again.mesh.faces) ||
        !same(garment.rest, again.rest) || !same(garment.clothness, again.clothness))
      broken.push_back("a second call gives other bits");
  } catch (const std::exception &error) {
    broken.push_back(std::string("expected a garment that fits the actor: ") + error.what());
  }
  try {
    Segmentation bare = segmentation;
    bare.clothness.setZero();
    bare.region.setConstant(-1);
    bare.region_count = 0;
    if (const auto vertices = mesher.mesh(actor, bare, {}, {}, {}).mesh.vertices.rows())
      broken.push_back("expected no vertices where nothing is cloth, found " + std::to_string(vertices));
  } catch (const std::exception &error) {
    broken.push_back(std::string("without cloth the mesher threw: ") + error.what());
  }
  try {
    Segmentation shorter = segmentation;
    shorter.clothness.conservativeResize(segmentation.clothness.size() - 1);
    mesher.mesh(actor, shorter, {}, {}, {});
    broken.push_back("a segmentation of another mesh is not refused");
  } catch (const std::exception &) { // of whatever kind: Python has its own
  }
  return broken;
}

} // namespace doublet::testing
