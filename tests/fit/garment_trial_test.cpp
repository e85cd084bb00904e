#include "doublet/fit/garment_trial.h"
#include "fit/synthetic.h"

#include <gtest/gtest.h>

namespace doublet {
namespace {

using namespace testing;

TEST(GarmentTrial, SamplesAreSpreadEvenlyAndDoNotStretch) {
  const ParameterSpace space;
  const int stretch = 3, count = 64;
  ASSERT_EQ(space.names[stretch], "k_stretch");
  const MatrixRM samples = trial_samples(space, count);
  ASSERT_EQ(samples.rows(), count);
  EXPECT_TRUE((samples.col(stretch).array() == 1).all());
  for (int i = 0; i < space.size(); ++i)
    for (int quarter = 0; quarter < 4 && i != stretch; ++quarter) {
      const auto column = samples.col(i).array();
      EXPECT_NEAR((column >= quarter / 4.0 && column < (quarter + 1) / 4.0).count(), count / 4, 3) << space.names[i];
    }
  EXPECT_EQ(space.material(samples.row(0).transpose()).k_stretch, 1);
  EXPECT_EQ(trial_samples(space, count / 4, 1), samples.middleRows(count / 4, count / 4)); // shares of one sequence
  EXPECT_THROW(trial_samples(space, count, -1), std::invalid_argument);
}

double cost_of_width(const Scene &scene, double fullness) {
  Segmentation segmentation = scene.segmentation;
  segmentation.fullness = Eigen::VectorXd::Constant(segmentation.clothness.size(), fullness);
  const CharacterSimulator simulator(scene.actor, segmentation, scene.proxies, scene.simulator->options());
  MaterialObjective objective(simulator, scene.performance, scene.observations);
  const Eigen::VectorXd costs = trial_energy(objective, 16);
  EXPECT_EQ(costs.size(), 1);
  return costs[0];
}

TEST(GarmentTrial, TheGarmentThatWasFilmedCostsLeast) {
  const std::unique_ptr<Scene> scene = make_scene({cotton()});
  const double true_one = cost_of_width(*scene, 1), wider = cost_of_width(*scene, 1.2), widest = cost_of_width(*scene, 1.5);
  std::printf("trial energy: true width %.1f, 1.2 %.1f, 1.5 %.1f\n", true_one, wider, widest);
  EXPECT_LT(true_one, 0.9 * wider);
  EXPECT_LT(wider, 0.9 * widest);
}

TEST(GarmentTrial, WrongOptionsAreRefused) {
  TrialOptions options;
  EXPECT_NO_THROW(options.validate());
  options.spreads = {0.2, 1.0};
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options = {};
  options.materials = 3;
  EXPECT_THROW(options.validate(), std::invalid_argument);
}

} // namespace
} // namespace doublet
