#include "doublet/core/parts/labelling.h"

#include <gtest/gtest.h>

#include <random>

using namespace doublet;

namespace {

LabellingEnergy random_energy(std::mt19937 &random, int vertices, int edges) {
  std::uniform_real_distribution<double> gain(-1, 1), cost(0, 0.7);
  std::uniform_int_distribution<int> vertex(0, vertices - 1);
  LabellingEnergy energy;
  energy.gain = Eigen::VectorXd::NullaryExpr(vertices, [&] { return gain(random); });
  for (int e = 0; e < edges; ++e) {
    energy.edges.emplace_back(vertex(random), vertex(random)); // doubled edges and loops are harmless
    energy.cost.push_back(cost(random));
  }
  return energy;
}

double value(const LabellingEnergy &energy, const std::vector<char> &labels) {
  double sum = 0;
  for (Eigen::Index v = 0; v < energy.gain.size(); ++v)
    sum -= labels[v] ? energy.gain[v] : 0.0;
  for (std::size_t e = 0; e < energy.edges.size(); ++e)
    sum += labels[energy.edges[e][0]] != labels[energy.edges[e][1]] ? energy.cost[e] : 0.0;
  return sum;
}

double lowest_of_all(const LabellingEnergy &energy) {
  const auto n = static_cast<int>(energy.gain.size());
  double lowest = 0;
  for (int bits = 0; bits < 1 << n; ++bits) {
    std::vector<char> labels(n);
    for (int v = 0; v < n; ++v)
      labels[v] = static_cast<char>(bits >> v & 1);
    lowest = std::min(lowest, value(energy, labels));
  }
  return lowest;
}

} // namespace

TEST(Labelling, IsTheLowestOfAllLabellings) {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    const LabellingEnergy energy = random_energy(random, 11, 5 + round);
    EXPECT_NEAR(value(energy, lowest_labelling(energy)), lowest_of_all(energy), 1e-9) << round;
  }
}

TEST(Labelling, WithoutEdgesEachVertexTakesItsGain) {
  LabellingEnergy energy;
  energy.gain.resize(4);
  energy.gain << 0.3, -0.2, 0, 1e-9;
  EXPECT_EQ(lowest_labelling(energy), (std::vector<char>{1, 0, 0, 1}));
  EXPECT_TRUE(lowest_labelling({}).empty());
}

TEST(Labelling, AMarginIsTheShiftThatTurnsTheLabel) {
  std::mt19937 random(6);
  for (int round = 0; round < 20; ++round) {
    const LabellingEnergy energy = random_energy(random, 11, 20);
    const Eigen::VectorXd weight = Eigen::VectorXd::NullaryExpr(11, [&] { return 0.5 + (random() % 100) / 100.0; });
    const Eigen::VectorXd margin = labelling_margins(energy, weight, 3, 600);
    for (const double shift : {-1.5, -0.4, 0.0, 0.3, 1.1}) {
      LabellingEnergy shifted = energy;
      shifted.gain -= shift * weight;
      const std::vector<char> labels = lowest_labelling(shifted);
      for (Eigen::Index v = 0; v < margin.size(); ++v)
        if (std::abs(margin[v] - shift) > 0.011) { // the steps
          EXPECT_EQ(labels[v] != 0, margin[v] > shift) << round << ' ' << shift << ' ' << v;
        }
    }
  }
}

TEST(Labelling, AMarginOfALoneVertexIsItsGainByItsWeight) {
  LabellingEnergy energy;
  energy.gain.resize(3);
  energy.gain << 2, -0.5, 100;
  const Eigen::VectorXd margin = labelling_margins(energy, Eigen::Vector3d(2, 1, 1), 6, 1200);
  EXPECT_NEAR(margin[0], 1, 0.011);
  EXPECT_NEAR(margin[1], -0.5, 0.011);
  EXPECT_EQ(margin[2], 6);
}
