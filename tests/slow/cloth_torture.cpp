// Every corner of the material box, in the paper's solver and in the default one, with one and four substeps, without and with
// restitution: a skirt on a dancer who jumps, in gusts of wind, then four seconds at rest. Nothing may become NaN, be thrown, or
// fly off, and no stiff skirt may shake as a whole after the rest. Where a proxy holds the cloth off to several times its length
// single vertices may: the fastest of these skirts is named.
//   cloth_torture SECONDS    shared out among the 512 combinations; each dances at least once

#include "pbd/scenes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace doublet::pbd;
using Clock = std::chrono::steady_clock;

constexpr double kFrame = 1.0 / 40;
constexpr int kDance = 160, kRest = 160; // frames
constexpr double kResting = 0.02;        // m/s, of the fastest vertex
constexpr double kShaking = 3;           // m/s, root mean square over the skirt

struct Worst {
  double speed = 0, speed_at_rest = 0, mean_at_rest = 0, reach = 0; ///< m/s, m/s, m/s root mean square, m
  long frames = 0, dances = 0, moving = 0, fast = 0; ///< moving, fast: a vertex above kResting, kShaking at the end
  std::string fastest;                               ///< the skirt of speed_at_rest
};

struct Corner {
  Material material;
  bool soft, broken = false;
};
std::vector<Corner> corners_of_box() {
  std::vector<Corner> corners(64);
  for (int i = 0; i < 64; ++i) {
    Material &material = corners[i].material;
    int bit = 0;
    for (const MaterialParameter &p : material_parameters())
      material.*p.value = i >> bit++ & 1 ? p.upper : p.lower;
    corners[i].soft = material.k_stretch == 0;
    if (corners[i].soft)
      material.k_stretch = 1e-3; // 0 itself is outside: it would hang from nothing
  }
  return corners;
}

/// The corners in one solver; they dance side by side.
class Troupe {
public:
  Troupe(const scenes::Sheet &skirt, const ClothOptions &options, const std::string &name)
      : skirt_(skirt), name_(name),
        solver_(ClothSolver::create(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options))),
        corners_(corners_of_box()) {
    for (const Corner &corner : corners_)
      materials_.push_back(corner.material);
  }
  int broken() const {
    int count = 0;
    for (const Corner &corner : corners_)
      count += corner.broken;
    return count;
  }

  /// One dance from the rest pose and one rest.
  void dance_and_rest(std::mt19937 &random, Worst &stiff, Worst &rubber) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto any_way = [&] { return Eigen::Vector3d(unit(random), unit(random), unit(random)); };
    const scenes::Dancer dancer{3};
    std::vector<ClothState> states(corners_.size(), initial_state(skirt_.rest));
    Vertices previous = skirt_.rest, targets;
    std::vector<Capsule> previous_capsules = dancer.capsules(0), capsules;
    for (int f = 1; f <= kDance + kRest; ++f) {
      StepInputs in;
      targets = dancer.targets(skirt_.rest, std::min(f, kDance) * kFrame);
      capsules = dancer.capsules(std::min(f, kDance) * kFrame);
      if (f <= kDance) {
        if (f % 20 == 0) { // the tracker slips: the waist one way, the legs others
          targets.rowwise() += 0.3 * any_way().transpose();
          for (Capsule &c : capsules)
            c.p0 += 0.3 * any_way(), c.p1 += 0.3 * any_way();
        }
        in.wind = 20 * any_way();
      }
      in.targets = targets;
      in.previous_targets = previous;
      in.capsules = capsules;
      in.previous_capsules = previous_capsules;
      for (int i : solver_->step_batch(states, {&in, 1}, materials_, 1))
        report(i, f, "not finite");
      for (size_t i = 0; i < corners_.size(); ++i)
        check(i, f, states[i], targets.row(0), corners_[i].soft ? rubber : stiff);
      previous = targets;
      previous_capsules = capsules;
    }
  }

private:
  void check(size_t i, int frame, const ClothState &state, const Eigen::RowVector3d &waist, Worst &worst) {
    const double speed = state.velocities.rowwise().norm().maxCoeff();
    const double far = (state.positions.rowwise() - waist).rowwise().norm().maxCoeff();
    if (!(speed <= 100.001))
      report(i, frame, "speed " + std::to_string(speed) + " m/s");
    if (!(far < (corners_[i].soft ? 1000 : 3))) // stiff cloth stays about the dancer; rubber may hang as far as it can fall
      report(i, frame, "reaches " + std::to_string(far) + " m");
    worst.speed = std::max(worst.speed, speed);
    worst.reach = std::max(worst.reach, far);
    ++worst.frames;
    if (frame == kDance + kRest)
      check_rest(i, frame, speed, std::sqrt(state.velocities.rowwise().squaredNorm().mean()), worst);
  }
  void check_rest(size_t i, int frame, double speed, double mean, Worst &worst) {
    if (!corners_[i].soft && !(mean < kShaking)) // rubber still falls
      report(i, frame, "shakes at " + std::to_string(mean) + " m/s");
    if (speed > worst.speed_at_rest)
      worst.fastest = description(i);
    worst.speed_at_rest = std::max(worst.speed_at_rest, speed);
    worst.mean_at_rest = std::max(worst.mean_at_rest, mean);
    worst.dances += 1;
    worst.moving += speed > kResting;
    worst.fast += speed > kShaking;
  }
  std::string description(size_t i) const {
    std::string all = name_;
    for (const MaterialParameter &p : material_parameters()) {
      char value[32];
      std::snprintf(value, sizeof value, ", %s %g", p.name, materials_[i].*p.value);
      all += value;
    }
    return all;
  }
  void report(size_t i, int frame, const std::string &what) {
    if (!corners_[i].broken)
      std::printf("BROKEN: %s in frame %d; %s\n", what.c_str(), frame, description(i).c_str());
    corners_[i].broken = true;
  }

  const scenes::Sheet &skirt_;
  std::string name_;
  std::unique_ptr<ClothSolver> solver_;
  std::vector<Corner> corners_;
  std::vector<Material> materials_;
};

} // namespace

int main(int argc, char **argv) {
  const double seconds = argc == 2 ? std::atof(argv[1]) : 0;
  if (seconds <= 0)
    return std::fprintf(stderr, "usage: cloth_torture SECONDS\n"), 1;
  const auto start = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const scenes::Sheet skirt = scenes::skirt(26, 10);
  std::mt19937 random(1);
  int broken = 0, done = 0;
  for (const auto &[name, base] : {std::pair("paper", ClothOptions::paper()), std::pair("default", ClothOptions{})}) {
    Worst stiff, rubber;
    for (int substeps : {1, 4})
      for (double restitution : {0.0, 1.0}) {
        ClothOptions options = base;
        options.substeps = substeps;
        options.restitution = restitution;
        Troupe troupe(skirt, options,
                      std::string(name) + ", " + std::to_string(substeps) + " substeps, restitution " +
                          (restitution > 0 ? "1" : "0"));
        ++done;
        do
          troupe.dance_and_rest(random, stiff, rubber);
        while (passed() < seconds * done / 8);
        broken += troupe.broken();
      }
    for (const auto &[kind, worst] : {std::pair("k_stretch 1", stiff), std::pair("k_stretch 0.001", rubber)})
      std::printf(
          "%s, %s: %ld frames, fastest %.1f m/s, farthest %.2f m; at rest, of %ld dances, %ld with a vertex above %g m/s, "
          "%ld above %g m/s, fastest %.2f m/s (%s), skirt %.2f m/s\n",
          name, kind, worst.frames, worst.speed, worst.reach, worst.dances, worst.moving, kResting, worst.fast, kShaking,
          worst.speed_at_rest, worst.fastest.c_str(), worst.mean_at_rest);
  }
  std::printf("%d combinations, %d broken, %.0f s\n", 64 * done, broken, passed());
  return broken > 0;
}
