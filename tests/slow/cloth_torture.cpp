// Every corner of the material box, with one and four substeps, without and with restitution: a skirt on a dancer who jumps, in
// gusts of wind, then at rest. Nothing may become NaN, be thrown, or fly off. Those that
// do not come to rest within the four seconds after are named, but allowed: tangled cloth with k_bend = 1 shakes on.
//   cloth_torture SECONDS    shared out among the 256 combinations

#include "pbd/scenes.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>

namespace {

using namespace doublet::pbd;
using Clock = std::chrono::steady_clock;

struct Worst {
  double speed = 0, speed_at_rest = 0, reach = 0; ///< m/s, m/s, m
  long frames = 0, dances = 0, restless = 0;      ///< restless: faster than 3 m/s at the end of the rest
};
constexpr double kFrame = 1.0 / 40;
constexpr int kDance = 160, kRest = 160; // frames

/// One dance from the rest pose and one rest, at most `reach` m from the waist's middle.
void dance_and_rest(const ClothSolver &solver, const scenes::Sheet &skirt, const Material &material, double reach,
                    std::mt19937 &random, Worst &worst) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const scenes::Dancer dancer{3};
  ClothState state = initial_state(skirt.rest);
  Vertices previous = skirt.rest, targets;
  std::vector<Capsule> previous_capsules = dancer.capsules(0), capsules;
  for (int f = 1; f <= kDance + kRest; ++f) {
    StepInputs in;
    targets = dancer.targets(skirt.rest, std::min(f, kDance) * kFrame);
    capsules = dancer.capsules(std::min(f, kDance) * kFrame);
    if (f <= kDance) {
      if (f % 20 == 0) { // the tracker slips: the waist one way, the legs others
        targets.rowwise() += 0.3 * Eigen::RowVector3d(unit(random), unit(random), unit(random));
        for (Capsule &c : capsules)
          c.p0 += 0.3 * Eigen::Vector3d(unit(random), unit(random), unit(random)),
              c.p1 += 0.3 * Eigen::Vector3d(unit(random), unit(random), unit(random));
      }
      in.wind = 20 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    }
    in.targets = &targets;
    in.previous_targets = &previous;
    in.capsules = &capsules;
    in.previous_capsules = &previous_capsules;
    solver.step(state, in, material); // throws if it meets a number that is not finite
    const double speed = state.velocities.rowwise().norm().maxCoeff();
    const double far = (state.positions.rowwise() - targets.row(0)).rowwise().norm().maxCoeff();
    if (!state.positions.allFinite() || !(speed <= 100.001))
      throw std::runtime_error("speed " + std::to_string(speed) + " m/s in frame " + std::to_string(f));
    if (!(far < reach))
      throw std::runtime_error("reaches " + std::to_string(far) + " m in frame " + std::to_string(f));
    worst.speed = std::max(worst.speed, speed);
    worst.reach = std::max(worst.reach, far);
    ++worst.frames;
    if (f == kDance + kRest) {
      worst.speed_at_rest = std::max(worst.speed_at_rest, speed);
      worst.dances += 1;
      worst.restless += speed > 3;
    }
    previous = targets;
    previous_capsules = capsules;
  }
}

} // namespace

int main(int argc, char **argv) {
  const double seconds = argc == 2 ? std::atof(argv[1]) : 0;
  if (seconds <= 0)
    return std::fprintf(stderr, "usage: cloth_torture SECONDS\n"), 1;
  const auto start = Clock::now();
  const scenes::Sheet skirt = scenes::skirt(26, 10);
  std::mt19937 random(1);
  Worst stiff, rubber;
  int broken = 0, done = 0;
  for (int corner = 0; corner < 64; ++corner)
    for (int substeps : {1, 4})
      for (double restitution : {0.0, 1.0}) {
        Material material;
        int bit = 0;
        for (const MaterialParameter &p : material_parameters())
          material.*p.value = corner >> bit++ & 1 ? p.upper : p.lower;
        const bool soft = material.k_stretch == 0;
        if (soft)
          material.k_stretch = 1e-3; // 0 itself is outside: it would hang from nothing
        ClothOptions options = ClothOptions::paper();
        options.substeps = substeps;
        options.restitution = restitution;
        const auto solver = ClothSolver::create(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options));
        ++done;
        try {
          do // stiff cloth stays about the dancer; rubber may hang as far as it can fall
            dance_and_rest(*solver, skirt, material, soft ? 1000 : 3, random, soft ? rubber : stiff);
          while (std::chrono::duration<double>(Clock::now() - start).count() < seconds * done / 256);
        } catch (const std::exception &e) {
          ++broken;
          std::printf("BROKEN: %s; substeps %d, restitution %g", e.what(), substeps, restitution);
          for (const MaterialParameter &p : material_parameters())
            std::printf(", %s %g", p.name, material.*p.value);
          std::printf("\n");
        }
      }
  for (const auto &[name, worst] : {std::pair("k_stretch 1", stiff), std::pair("k_stretch 0.001", rubber)})
    std::printf("%s: %ld frames, fastest %.1f m/s, farthest %.2f m; at rest %ld of %ld above 3 m/s, fastest %.2f m/s\n", name,
                worst.frames, worst.speed, worst.reach, worst.restless, worst.dances, worst.speed_at_rest);
  std::printf("%d combinations, %d broken, %.0f s\n", done, broken, std::chrono::duration<double>(Clock::now() - start).count());
  return broken > 0;
}
