// Heat equilibrium skin weights on tubes, where the answer is known.
#include "capture/capture_shapes.h"
#include "doublet/capture/heat_weights.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"

#include <cmath>
#include <gtest/gtest.h>

namespace doublet {
namespace heat_weights_test {

/// A chain of fixed joints along +Y through (x, ., 0); joint i+1 is the child of joint i.
std::vector<JointAnnotation> chain(const std::string &prefix, const std::string &parent, double x,
                                   const std::vector<double> &heights) {
  std::vector<JointAnnotation> marks;
  for (std::size_t i = 0; i < heights.size(); ++i)
    marks.push_back({prefix + std::to_string(i),
                     i == 0 ? parent : prefix + std::to_string(i - 1),
                     {x, heights[i], 0},
                     i == 0 && parent.empty() ? 6 : 0});
  return marks;
}

void expect_partition_of_unity(const MatrixRM &weights) {
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
}

/// The same heat equation on a line: -w'' + H w = H p along a tube of radius r whose two bones meet at 0. Far from the ends the
/// surface equation has no variation around the tube.
double tube_weight(double at, double r) {
  constexpr int kSteps = 4000;
  const double half = 8 * r, h = 2 * half / kSteps;
  std::vector<double> lower(kSteps + 1, -1 / (h * h)), diagonal(kSteps + 1), right(kSteps + 1);
  for (int i = 0; i <= kSteps; ++i) {
    const double y = -half + i * h;
    const bool shared = std::hypot(r, y) <= 1.1 * r; // both bones within 1.1 of the nearer one
    const double H = (shared ? 2 : 1) / (r * r), p = shared ? 0.5 : (y > 0 ? 1 : 0);
    diagonal[i] = (i == 0 || i == kSteps ? 1 : 2) / (h * h) + H;
    right[i] = H * p;
  }
  for (int i = 1; i <= kSteps; ++i) { // Thomas algorithm
    const double m = lower[i] / diagonal[i - 1];
    diagonal[i] -= m * lower[i];
    right[i] -= m * right[i - 1];
  }
  std::vector<double> w(kSteps + 1);
  w[kSteps] = right[kSteps] / diagonal[kSteps];
  for (int i = kSteps - 1; i >= 0; --i)
    w[i] = (right[i] - lower[i] * w[i + 1]) / diagonal[i];
  return w[static_cast<int>(std::lround((at + half) / h))];
}

TEST(HeatWeights, TubeMatchesTheLineEquation) {
  const double r = 0.05;
  const Mesh tube = testing::capsule(r, -0.5, 0.5, 48, 200);
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.5, 0, 0.5}));
  const MatrixRM weights = heat_weights(tube, {}, skeleton);
  expect_partition_of_unity(weights);
  const int upper = skeleton.find("b1");
  for (Eigen::Index v = 0; v < tube.vertices.rows(); ++v)
    if (const double y = tube.vertices(v, 1); std::abs(y) < 0.25) {
      EXPECT_NEAR(weights(v, upper), tube_weight(y, r), 0.015) << "y " << y;
    }
}

TEST(HeatWeights, ALastJointThatTurnsMovesWhatLiesBeyondIt) {
  const Mesh arm = testing::capsule(0.04, 0, 0.6, 32, 120);
  std::vector<JointAnnotation> marks = chain("b", "", 0, {0, 0.2, 0.4}); // shoulder, elbow, wrist; no hand
  const auto beyond_wrist = [&] {
    const Skeleton skeleton = make_skeleton(marks);
    const MatrixRM weights = heat_weights(arm, {}, skeleton);
    expect_partition_of_unity(weights);
    Eigen::RowVectorXd least = Eigen::RowVectorXd::Ones(3);
    for (Eigen::Index v = 0; v < arm.vertices.rows(); ++v)
      if (arm.vertices(v, 1) > 0.5)
        least = least.cwiseMin(weights.row(v));
    return least;
  };
  EXPECT_GT(beyond_wrist()[1], 0.9); // fixed: the forearm goes on
  marks.back().dof = 2;
  EXPECT_GT(beyond_wrist()[2], 0.9);
}

TEST(HeatWeights, DoNotDependOnTheResolution) {
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.3, 0, 0.3}));
  const Mesh coarse = testing::capsule(0.05, -0.3, 0.3, 16, 60), fine = testing::capsule(0.05, -0.3, 0.3, 64, 240);
  const MatrixRM a = heat_weights(coarse, {}, skeleton), b = heat_weights(fine, {}, skeleton);
  for (Eigen::Index v = 0; v < coarse.vertices.rows(); ++v) {
    Eigen::Index same = 0;
    if ((fine.vertices.rowwise() - coarse.vertices.row(v)).rowwise().squaredNorm().minCoeff(&same) < 1e-12) {
      EXPECT_NEAR(a(v, 1), b(same, 1), 0.03);
    }
  }
}

TEST(HeatWeights, ABoneAcrossAGapGetsNothing) {
  // A thin arm 5 mm beside a thick torso: the torso's near side is closer to the arm's bone than to its own.
  const Mesh torso = testing::capsule(0.10, 0, 0.6, 64, 60), arm = testing::capsule(0.02, 0.1, 0.5, 24, 40, 0.125);
  const Mesh both = testing::join({torso, arm});
  auto marks = chain("t", "", 0, {0, 0.6});
  for (const JointAnnotation &mark : chain("a", "t0", 0.125, {0.1, 0.5}))
    marks.push_back(mark);
  // t0 also owns the bone to the arm's first joint, which leaves the torso: it is not visible from most of it, and belongs to t0
  // anyway.
  const Skeleton skeleton = make_skeleton(marks);
  const MatrixRM weights = heat_weights(both, {}, skeleton);
  expect_partition_of_unity(weights);
  const int t = skeleton.find("t0"), a = skeleton.find("a0");
  EXPECT_GT(weights.col(t).head(torso.vertices.rows()).minCoeff(), 0.999);
  for (Eigen::Index v = torso.vertices.rows(); v < both.vertices.rows(); ++v)
    if (both.vertices(v, 1) > 0.2) { // below, the bone from t0 to the arm's first joint ends inside the arm
      EXPECT_GT(weights(v, a), 0.95);
    }
}

TEST(HeatWeights, LeafJointsOwnNothing) {
  const Mesh tube = testing::capsule(0.05, -0.3, 0.3, 16, 30);
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.3, 0, 0.3}));
  EXPECT_EQ(heat_weights(tube, {}, skeleton).col(skeleton.find("b2")).maxCoeff(), 0);
}

TEST(HeatWeights, ALoneJointOwnsAll) {
  const Mesh tube = testing::capsule(0.05, -0.3, 0.3, 16, 30);
  const MatrixRM weights = heat_weights(tube, {}, make_skeleton(chain("b", "", 0, {0.0})));
  EXPECT_EQ(weights.cols(), 1);
  EXPECT_EQ(weights.minCoeff(), 1);
}

TEST(HeatWeights, InvalidTrianglesHardlyConduct) {
  // A tube whose middle is marked as invented: the step between the two bones becomes sharp there.
  const Mesh tube = testing::capsule(0.05, -0.3, 0.3, 32, 120);
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.3, 0, 0.3}));
  std::vector<std::uint8_t> valid(tube.faces.rows(), 1);
  for (Eigen::Index f = 0; f < tube.faces.rows(); ++f)
    valid[f] = std::abs(tube.vertices(tube.faces.row(f), 1).mean()) > 0.03;
  const MatrixRM with = heat_weights(tube, valid, skeleton), without = heat_weights(tube, {}, skeleton);
  double leak_with = 0, leak_without = 0;
  for (Eigen::Index v = 0; v < tube.vertices.rows(); ++v)
    if (const double y = tube.vertices(v, 1); y > 0.035 && y < 0.08) {
      leak_with += with(v, 0);
      leak_without += without(v, 0);
    }
  EXPECT_LT(leak_with, 0.1 * leak_without);
}

TEST(HeatWeights, BadInputIsRefused) {
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.3, 0, 0.3}));
  Mesh tube = testing::capsule(0.05, -0.3, 0.3, 16, 30);
  EXPECT_THROW(heat_weights(Mesh{}, {}, skeleton), Error);
  EXPECT_THROW(heat_weights(tube, {1, 1}, skeleton), std::invalid_argument);
  EXPECT_THROW(heat_weights(tube, {}, Skeleton{}), std::invalid_argument);
  HeatWeightOptions options;
  options.c = 0;
  EXPECT_THROW(heat_weights(tube, {}, skeleton, options), std::invalid_argument);
  tube.vertices(0, 0) = std::nan("");
  EXPECT_THROW(heat_weights(tube, {}, skeleton), Error);
}

TEST(HeatWeights, OpenAndNonManifoldMeshesStillGetWeights) {
  const Skeleton skeleton = make_skeleton(chain("b", "", 0, {-0.3, 0, 0.3}));
  Mesh tube = testing::capsule(0.05, -0.3, 0.3, 16, 30);
  const Eigen::Index rows = tube.vertices.rows(), faces = tube.faces.rows();
  tube.faces = tube.faces.bottomRows(faces - 40).eval(); // open
  tube.faces.conservativeResize(faces - 38, 3);
  tube.faces.row(faces - 40) = tube.faces.row(0); // a repeated face
  tube.faces.row(faces - 39) << 3, 3, 4;          // no area
  tube.vertices.conservativeResize(rows + 1, 3);
  tube.vertices.row(rows) << 0.2, 0, 0; // no face
  expect_partition_of_unity(heat_weights(tube, {}, skeleton));
}

TEST(HeatWeights, RigTemplatePutsItTogether) {
  Template surface;
  surface.mesh = testing::capsule(0.05, -0.3, 0.3, 16, 30);
  surface.face_valid.assign(surface.mesh.faces.rows(), 1);
  const RiggedMesh actor = rig_template(surface, chain("b", "", 0, {-0.3, 0, 0.3}));
  EXPECT_EQ(actor.weights.rows(), surface.mesh.vertices.rows());
  EXPECT_EQ(actor.weights.cols(), 3);
  surface.face_valid.pop_back();
  EXPECT_THROW(rig_template(surface, chain("b", "", 0, {-0.3, 0, 0.3})), std::invalid_argument);
}

} // namespace heat_weights_test
} // namespace doublet
