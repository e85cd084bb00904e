// Time of one video frame of cloth: a flared skirt over a dancing pair of legs, dt 1/40 s, 24 iterations, drag, friction, blend
// and proxies on, one core. Arguments: vertices around, rows (52 x 24: 1300 vertices, 2496 faces; 72 x 35: 2592, 5040),
// self-collision (0, 1), simulations side by side in one register. s_a_sample: CPU time a frame of one simulation.

#include "doublet/pbd/detail/lanes.h"
#include "pbd/scenes.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <random>

namespace {

using namespace doublet::pbd;

/// Around the material that Sect. 7 recovers (narrow: what is left when an estimation converges), or anywhere in the box.
std::vector<Material> population(int count, bool narrow) {
  Material centre;
  centre.d_n = 5.4;
  centre.d_t = 5.6;
  centre.k_bend = 0.75;
  centre.k_stretch = 1;
  centre.k_friction = 0.47;
  std::vector<Material> materials(count, centre);
  std::mt19937 random(1);
  for (Material &m : materials)
    for (int k = 0; k < 5; ++k) {
      const MaterialParameter &p = material_parameters()[k];
      const double u = std::uniform_real_distribution<double>(0, 1)(random), width = p.upper - p.lower;
      if (!narrow)
        m.*p.value = p.lower + std::max(1e-3, u) * width;
      else if (p.value != &Material::k_stretch)
        m.*p.value += 0.05 * (u - 0.5) * width;
    }
  return materials;
}

void skirt_frames(benchmark::State &bench, bool narrow) {
  const int around = static_cast<int>(bench.range(0)), rows = static_cast<int>(bench.range(1));
  const int lanes = static_cast<int>(bench.range(3));
  const scenes::Sheet skirt = scenes::skirt(around, rows);
  ClothOptions options = ClothOptions::paper();
  options.self_collision = bench.range(2) != 0;
  const std::vector<int> supported = detail::supported_lanes();
  if (std::find(supported.begin(), supported.end(), lanes) == supported.end()) {
    bench.SkipWithError("this processor has no registers of that width");
    return;
  }
  const auto solver = detail::create_with_lanes(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options), lanes);
  const scenes::Dancer dancer;
  const std::vector<Material> materials = population(lanes, narrow);
  std::vector<ClothState> states(lanes, initial_state(skirt.rest));
  Vertices previous = dancer.targets(skirt.rest, 0), current;
  std::vector<Capsule> previous_capsules = dancer.capsules(0), capsules;
  int frame = 0;
  for (auto unused : bench) {
    (void)unused;
    bench.PauseTiming();
    const double t = ++frame / 40.0;
    current = dancer.targets(skirt.rest, t);
    capsules = dancer.capsules(t);
    bench.ResumeTiming();
    StepInputs in;
    in.targets = current;
    in.previous_targets = previous;
    in.capsules = capsules;
    in.previous_capsules = previous_capsules;
    benchmark::DoNotOptimize(solver->step_batch(states, {&in, 1}, materials));
    previous.swap(current);
    previous_capsules.swap(capsules);
  }
  bench.counters["vertices"] = static_cast<double>(skirt.rest.rows());
  bench.counters["s_a_sample"] =
      benchmark::Counter(lanes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void whole_box(benchmark::State &bench) {
  skirt_frames(bench, false);
}
void narrow(benchmark::State &bench) {
  skirt_frames(bench, true);
}
BENCHMARK(whole_box)
    ->ArgNames({"around", "rows", "self", "lanes"})
    ->ArgsProduct({{52}, {24}, {0, 1}, {1, 4, 8, 16}})
    ->ArgsProduct({{72}, {35}, {0, 1}, {1, 4, 8, 16}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(narrow)
    ->ArgNames({"around", "rows", "self", "lanes"})
    ->ArgsProduct({{52}, {24}, {0, 1}, {1, 4, 8, 16}})
    ->ArgsProduct({{72}, {35}, {0, 1}, {1, 4, 8, 16}})
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
