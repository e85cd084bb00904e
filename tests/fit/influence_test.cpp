#include "doublet/core/error.h"
#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/parts/influence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace doublet {
namespace {

/// Two parts of three parameters: a strong one, a weak one, one without any effect; noise of a chaotic kind on top: the same for
/// the same sample, unrelated for its neighbours.
class Noisy : public Objective {
public:
  double noise = 0, scale = 1;
  int asked = 0;
  int parameter_count() const override { return 3; }
  int part_count() const override { return 2; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    asked += static_cast<int>(samples.rows());
    MatrixRM energies(samples.rows(), 2);
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      const Eigen::VectorXd x = samples.row(s).transpose();
      EXPECT_GE(x.minCoeff(), 0);
      EXPECT_LE(x.maxCoeff(), 1);
      energies(s, 0) = scale * (40 + 100 * std::pow(x[0] - 0.3, 2) + 10 * std::fabs(x[1] - 0.5) + chaos(x.head(3)));
      energies(s, 1) = scale * (7 + 3 * x[4] + (x[5] >= 1 ? 50.0 : 0.0) + chaos(x.tail(3))); // x[5]: a cliff at the end
    }
    return energies;
  }

private:
  double chaos(const Eigen::VectorXd &x) const {
    const auto seed = static_cast<std::uint64_t>(std::fabs(std::sin(1e5 * x.dot(Eigen::Vector3d(3, 5, 7)))) * 1e15);
    return noise * NormalGenerator(seed).normal();
  }
};

MatrixRM answers() {
  MatrixRM answers(2, 3);
  answers << 0.3, 0.5, 0.5, 0.9, 0, 1;
  return answers;
}

TEST(Influence, RanksTheParametersAndSaysWhichTheEnergyIgnores) {
  Noisy objective;
  objective.noise = 0.3;
  const std::vector<Influence> found = measure_influence(objective, answers());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(objective.asked, 4 * 3 + 12);
  EXPECT_NEAR(found[0].noise, 0.3, 0.2);
  // Probes at +-0.05 and +-0.15: the root of the mean square of 100 h^2 is 1.6, of 10 |h| 1.12.
  EXPECT_NEAR(found[0].change[0], 1.6, 0.5);
  EXPECT_NEAR(found[0].change[1], 1.12, 0.5);
  EXPECT_EQ(found[0].rank[2], 3);
  EXPECT_TRUE(found[0].exceeds_noise(0));
  EXPECT_TRUE(found[0].exceeds_noise(1));
  EXPECT_FALSE(found[0].exceeds_noise(2));
}

TEST(Influence, ACliffBesideTheAnswerIsNoNoiseAndTheBoxHasEdges) {
  Noisy objective;
  objective.noise = 0.02;
  const Influence found = measure_influence(objective, answers())[1];
  EXPECT_LT(found.noise, 0.1); // four of the twelve repeats fall off the cliff
  EXPECT_EQ(found.rank, (std::vector<int>{3, 2, 1}));
  EXPECT_NEAR(found.change[1], 3 * std::sqrt((0.05 * 0.05 + 0.15 * 0.15 + 0.25 * 0.25 + 0.35 * 0.35) / 4), 0.05);
  EXPECT_FALSE(found.exceeds_noise(0));
  EXPECT_TRUE(found.exceeds_noise(1));
  EXPECT_TRUE(found.exceeds_noise(2));
}

TEST(Influence, WithoutNoiseWhatIsIgnoredHasNone) {
  Noisy objective;
  const Influence found = measure_influence(objective, answers())[0];
  EXPECT_LT(found.change[2], 0.01);
  EXPECT_EQ(found.rank, (std::vector<int>{1, 2, 3}));
  EXPECT_FALSE(found.exceeds_noise(2));
}

TEST(Influence, ScalingTheEnergyChangesNoRank) {
  Noisy objective, scaled;
  objective.noise = scaled.noise = 0.3;
  scaled.scale = 1024; // a power of two: the same bits
  const std::vector<Influence> a = measure_influence(objective, answers()), b = measure_influence(scaled, answers());
  for (int r : {0, 1}) {
    EXPECT_EQ(a[r].rank, b[r].rank);
    EXPECT_EQ(1024 * a[r].change, b[r].change);
    EXPECT_EQ(1024 * a[r].noise, b[r].noise);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(a[r].exceeds_noise(i), b[r].exceeds_noise(i));
  }
}

TEST(Influence, RefusesAnswersOfOtherSizes) {
  Noisy objective;
  EXPECT_THROW(measure_influence(objective, MatrixRM::Zero(1, 3)), std::invalid_argument);
  EXPECT_THROW(measure_influence(objective, MatrixRM::Constant(2, 3, 1.5)), std::invalid_argument);
  EXPECT_THROW(measure_influence(objective, MatrixRM::Constant(2, 3, std::nan(""))), std::invalid_argument);
}

} // namespace
} // namespace doublet
