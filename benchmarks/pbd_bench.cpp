// Time of one video frame of cloth: a flared skirt over a dancing pair of legs, dt 1/40 s, 24 iterations, drag, friction, blend
// and proxies on, one core. Arguments: vertices around, rows (52 x 24: 1300 vertices, 2496 faces; 72 x 35: 2592, 5040),
// self-collision (0, 1).

#include "pbd/scenes.h"

#include <benchmark/benchmark.h>

namespace {

using namespace doublet::pbd;

void skirt_frame(benchmark::State &bench) {
  const scenes::Sheet skirt = scenes::skirt(static_cast<int>(bench.range(0)), static_cast<int>(bench.range(1)));
  ClothOptions options;
  options.self_collision = bench.range(2) != 0;
  const auto model = ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options);
  const auto solver = ClothSolver::create(model);
  const scenes::Dancer dancer;
  ClothState state = initial_state(skirt.rest);
  Material material;
  material.d_n = 5.4; // the material that Sect. 7 recovers
  material.d_t = 5.6;
  material.k_bend = 0.75;
  material.k_stretch = 1;
  material.k_friction = 0.47;
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
    in.targets = &current;
    in.previous_targets = &previous;
    in.capsules = &capsules;
    in.previous_capsules = &previous_capsules;
    solver->step(state, in, material);
    previous.swap(current);
    previous_capsules.swap(capsules);
  }
  bench.counters["vertices"] = static_cast<double>(skirt.rest.rows());
  bench.counters["faces"] = static_cast<double>(skirt.faces.rows());
}
BENCHMARK(skirt_frame)
    ->ArgNames({"around", "rows", "self"})
    ->Args({52, 24, 0})
    ->Args({52, 24, 1})
    ->Args({72, 35, 0})
    ->Args({72, 35, 1})
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
