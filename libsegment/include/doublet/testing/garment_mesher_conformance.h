#pragma once
// What every GarmentMesher must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/segment/garment_mesher.h"

#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

/// One sentence for each rule that the mesher breaks on an actor and a segmentation of yours: the garment fits the actor
/// (validate_garment), two calls give the same bits, without cloth there are no vertices, and a segmentation of another mesh is
/// refused with std::invalid_argument.
inline std::vector<std::string> garment_mesher_violations(const GarmentMesher &mesher, const RiggedMesh &actor,
                                                          const Segmentation &segmentation) {
  std::vector<std::string> broken;
  try {
    const Garment garment = mesher.mesh(actor, segmentation, {}, {}, {}), again = mesher.mesh(actor, segmentation, {}, {}, {});
    validate_garment(garment, actor, "the garment");
    if (garment.mesh.vertices != again.mesh.vertices || garment.mesh.faces != again.mesh.faces || garment.rest != again.rest ||
        garment.clothness != again.clothness)
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
  } catch (const std::invalid_argument &) {
  } catch (const std::exception &error) {
    broken.push_back(std::string("a segmentation of another mesh: expected std::invalid_argument, found: ") + error.what());
  }
  return broken;
}

} // namespace doublet::testing
