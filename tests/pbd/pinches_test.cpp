// Cloth between proxies that leave it no room.

#include "../../libpbd/src/capsule_motion.h"
#include "../../libpbd/src/pinches.h"
#include "doublet/pbd/cloth_solver.h"
#include "doublet/pbd/detail/lanes.h"
#include "knotted.h"
#include "scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace doublet::pbd {
namespace pinches_test {

using Eigen::Vector3d;

/// One vertex at the origin, which is the middle between two balls or a way off it.
struct Between {
  float weight = 1;
  int order = 0;
  LaneModel model{};
  Array<CapsuleMotion<float>> balls;
  Array<Point> x;
  VertexBoxes<float> boxes;
  Pinches<float> pinches;
  /// The balls' directions from the origin, and how far it is from them (m, negative = inside).
  Between(const Vector3d &one, double from_one, const Vector3d &other, double from_other) {
    model.vertex_count = 1;
    model.weights = &weight;
    model.vertex_order = &order;
    model.thickness = 0.012f;
    model.self_thickness = 0.004f;
    constexpr double radius = 0.1;
    for (const Vector3d &centre : {Vector3d((radius + from_one) * one), Vector3d((radius + from_other) * other)}) {
      const Capsule ball{centre, centre, radius, radius};
      balls.push_back(capsule_motion(ball, ball, Vector3d::Zero()));
    }
    for (int i = 0; i < 1 + kSpareVertices; ++i)
      x.push_back(Vec3f{0, 0, 0});
    boxes.set(model, x, x);
    pinches.find(model, balls, x, boxes);
  }
  float kept() const { return model.thickness - pinches.give()[0]; } ///< m, from either ball
};

TEST(Pinches, LeaveRoomForThreeLayersInTheMiddle) {
  const Vector3d left(-1, 0, 0), right(1, 0, 0);
  EXPECT_FLOAT_EQ(Between(left, 0.02, right, 0.02).kept(), 0.012f);   // there is room
  EXPECT_NEAR(Between(left, 0.01, right, 0.014).kept(), 0.006, 1e-6); // 24 mm, 12 of them for the cloth
  EXPECT_NEAR(Between(left, 0.02, right, 0.004).kept(), 0.006, 1e-6); // wherever it is
  EXPECT_NEAR(Between(left, -0.01, right, -0.02).kept(), -0.021, 1e-6);
}

TEST(Pinches, AreBetweenProxiesThatFaceEachOther) {
  const Vector3d left(-1, 0, 0);
  const auto kept = [&](double cosine) { return Between(left, 0, {-cosine, std::sqrt(1 - cosine * cosine), 0}, 0).kept(); };
  EXPECT_FLOAT_EQ(kept(0.9), 0.012f); // one limb
  EXPECT_NEAR(kept(0.5), 0.012, 1e-6);
  EXPECT_NEAR(kept(0), 0.5 * 0.012 + 0.5 * -0.006, 1e-6);
  EXPECT_NEAR(kept(-0.5), -0.006, 1e-6);
}

/// Nearer to its axis the cloth would come out on the far side of a limb.
TEST(Pinches, LetNothingDeeperIntoAProxyThanAQuarterOfItsRadius) {
  const auto slack_at = [](double depth) {
    Between between({-1, 0, 0}, -depth, {1, 0, 0}, -depth);
    Array<ContactOf<float>> contacts;
    find_capsule_contacts<float>(between.model, between.balls, between.x, between.x, 0.0f, between.pinches.give(), between.boxes,
                                 contacts);
    return contacts[0].slack.lanes[0] - static_cast<float>(std::max(0.0, depth - 0.025)); // less what is opened gently
  };
  EXPECT_NEAR(slack_at(0.01), 0.012 + 0.016, 1e-6);
  EXPECT_NEAR(slack_at(0.05), 0.012 + 0.025, 1e-6);
}

/// A strip that is held by both ends and hangs in a fold between two rods, which come together like an arm and a trunk.
struct Fold {
  scenes::Sheet strip = scenes::grid(12, 20, 0.02);
  Vertices worn;
  Fold() {
    const Eigen::Index count = strip.rest.rows();
    const double half = strip.rest.col(2).maxCoeff();
    worn.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double along = strip.rest(i, 2) / half; // from end to end
      worn.row(i) << strip.rest(i, 0), half * (std::abs(along) - 1), 0.06 * along;
      strip.clothness[i] = std::abs(along) < 1 - 1e-9;
    }
  }
  /// The rods `gap` (m, less than zero = overlapping) and twice `open` from each other.
  static std::vector<Capsule> rods(double gap, double open) {
    std::vector<Capsule> both;
    for (const double side : {-1, 1}) {
      const double z = side * (0.05 + gap / 2 + open);
      both.push_back({{-0.2, -0.1, z}, {0.2, -0.1, z}, 0.05, 0.05});
    }
    return both;
  }
  /// Positions a second after the rods have come as near as `gap`, in half a second.
  Vertices pinched(double gap, int lanes = 1) const {
    ClothOptions options;
    options.edge_collision = true;
    const auto solver = detail::create_with_lanes(ClothModel::create(strip.rest, strip.faces, strip.clothness, options), lanes);
    ClothState state = initial_state(worn);
    std::vector<Capsule> before, now = rods(gap, 0.06);
    StepInputs in;
    in.targets = worn;
    Material material;
    material.k_damping = 0.05;
    for (int frame = 1; frame <= 60; ++frame) {
      before = now;
      now = rods(gap, 0.06 * (1 - std::min(1.0, frame / 20.0)));
      in.previous_capsules = before;
      in.capsules = now;
      solver->step(state, in, material);
    }
    return state.positions;
  }
};

TEST(Pinches, LayersStayApart) {
  const Fold fold;
  for (const double gap : {0.01, 0.0, -0.02})
    EXPECT_EQ(scenes::knotted(fold.pinched(gap), fold.strip.faces).size(), 0u) << gap;
}

TEST(Pinches, EveryLaneGivesTheSameBits) {
  const Fold fold;
  const Vertices expected = fold.pinched(-0.01);
  EXPECT_EQ(fold.pinched(-0.01, 4), expected);
}

} // namespace pinches_test
} // namespace doublet::pbd
