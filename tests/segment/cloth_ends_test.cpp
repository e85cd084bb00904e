#include "doublet/segment/cloth_segmenter.h"

#include <gtest/gtest.h>

namespace doublet {

namespace {

/// Legs and an arm that are each a triangle a bone: shank, foot, hand; the foot's is the largest.
RiggedMesh limbs() {
  RiggedMesh actor;
  const std::vector<std::pair<const char *, int>> joints{{"pelvis", -1}, {"knee", 0},  {"ankle", 1},
                                                         {"toe", 2},     {"wrist", 0}, {"hand", 4}};
  for (const auto &[name, parent] : joints)
    actor.skeleton.joints.push_back({.name = name, .parent = parent, .rest = Eigen::Vector3d::Zero(), .axes = {}});
  actor.mesh.vertices.resize(9, 3);
  actor.mesh.faces.resize(3, 3);
  actor.weights = MatrixRM::Zero(9, 6);
  const int bones[] = {1, 2, 4};
  for (int f = 0; f < 3; ++f) {
    const double size = f == 1 ? 2 : 1;
    actor.mesh.vertices.middleRows(3 * f, 3) << 0, 0, f, size, 0, f, 0, size, f;
    actor.mesh.faces.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
    actor.weights.block(3 * f, bones[f], 3, 1).setOnes();
  }
  actor.face_valid = {1, 1, 1};
  return actor;
}

Segmentation cloth_at(const std::vector<int> &vertices) {
  Segmentation segmentation;
  segmentation.clothness = Eigen::VectorXd::Zero(9);
  for (const int vertex : vertices)
    segmentation.clothness[vertex] = 1;
  return segmentation;
}

using Names = std::vector<std::string>;

Names named(const std::vector<int> &cloth) {
  Names names;
  for (const ClothEnd &end : cloth_ends(limbs(), cloth_at(cloth)))
    names.push_back(end.joint);
  return names;
}

} // namespace

TEST(ClothEnds, AFootOrAHandOfClothIsNamed) {
  EXPECT_EQ(named({}), Names{});
  EXPECT_EQ(named({0, 1, 2, 3}), Names{}) << "a third of the foot";
  EXPECT_EQ(named({3, 4}), Names{"toe"});
  EXPECT_EQ(named({0, 1, 2, 3, 4, 5, 6, 7, 8}), (Names{"toe", "hand"}));
}

TEST(ClothEnds, AHandThatTheWristMovesIsNoForearm) {
  RiggedMesh actor = limbs();
  actor.skeleton.joints.pop_back(); // "hand": the wrist is the last joint, and moves what lies beyond it
  actor.skeleton.joints[4].parent = 1;
  actor.weights.conservativeResize(9, 5);
  const Segmentation sleeve = cloth_at({0, 1, 2});
  EXPECT_TRUE(cloth_ends(actor, sleeve).empty()) << "all of the bone before it";
  EXPECT_EQ(cloth_ends(actor, cloth_at({6, 7, 8}))[0].joint, "wrist");
}

TEST(ClothEnds, SaysHowMuchOfItIsCloth) {
  EXPECT_NEAR(cloth_ends(limbs(), cloth_at({3, 4}))[0].share, 2 / 3.0, 1e-12);
}

} // namespace doublet
