// Milliseconds a frame and sample of material estimation, solver and energy apart: build/benchmarks/fit_bench
// A skirt of about 1300 vertices, 8 cameras, one thread.

#include "fit/synthetic.h"

#include <benchmark/benchmark.h>

#include <map>

namespace {

using namespace doublet;

constexpr int kFrames = 40;

const testing::Scene &scene(int pixels) {
  static std::map<int, std::unique_ptr<testing::Scene>> made;
  auto &entry = made[pixels];
  if (!entry)
    entry = testing::make_scene({testing::cotton()}, {kFrames, 8, pixels, 25, 52});
  return *entry;
}

Context one_thread() {
  Context context;
  context.threads = 1;
  return context;
}

void set_rate(benchmark::State &state) {
  state.counters["ms_per_frame"] =
      benchmark::Counter(kFrames / 1000.0, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

EnergyOptions no_settling() {
  EnergyOptions options;
  options.settle_frames = 0;
  return options;
}

void simulate(benchmark::State &state) {
  const testing::Scene &s = scene(1004);
  std::vector<PosedFrame> frames;
  for (int t = 0; t < kFrames; ++t)
    frames.push_back(s.simulator->pose(s.performance.dofs.row(t).transpose()));
  for (auto _ : state) {
    CharacterState cloth = s.simulator->start(frames[0]);
    for (int t = 1; t < kFrames; ++t)
      s.simulator->step(cloth, frames[t - 1], frames[t], {testing::cotton()}, 1.0 / 40);
    benchmark::DoNotOptimize(cloth);
  }
  set_rate(state);
}
BENCHMARK(simulate)->Unit(benchmark::kMillisecond);

/// Simulation included; subtract the above.
void simulate_and_measure(benchmark::State &state) {
  const testing::Scene &s = scene(static_cast<int>(state.range(0)));
  const MaterialObjective objective(*s.simulator, s.performance, s.observations, no_settling());
  for (auto _ : state)
    benchmark::DoNotOptimize(objective.energies({{testing::cotton()}}, one_thread()));
  set_rate(state);
  state.counters["image_MB"] = static_cast<double>(objective.image_bytes()) / 1e6;
}
BENCHMARK(simulate_and_measure)->Arg(502)->Arg(1004)->Unit(benchmark::kMillisecond);

/// Poses, distance fields and the depth of what is not cloth, once a session.
void prepare_images(benchmark::State &state) {
  const testing::Scene &s = scene(static_cast<int>(state.range(0)));
  for (auto _ : state)
    MaterialObjective(*s.simulator, s.performance, s.observations, no_settling(), {}, one_thread());
  set_rate(state);
}
BENCHMARK(prepare_images)->Arg(502)->Arg(1004)->Unit(benchmark::kMillisecond);

void cma_es_generation(benchmark::State &state) {
  auto optimizer = create_cma_es(5);
  for (auto _ : state) {
    if (optimizer->stop())
      optimizer = create_cma_es(5);
    const MatrixRM samples = optimizer->ask();
    optimizer->tell(samples, samples.rowwise().squaredNorm());
  }
}
BENCHMARK(cma_es_generation)->Unit(benchmark::kMicrosecond);

} // namespace

BENCHMARK_MAIN();
