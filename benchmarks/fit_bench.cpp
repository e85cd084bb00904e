// What material estimation costs: build/benchmarks/fit_bench. A skirt of about 1300 vertices, 8 cameras.
// --benchmark_filter=estimate/.*/250 for the whole loop on a shorter piece, estimate/.*/1000 for 1000 frames and 512 evaluations.

#include "fit/synthetic.h"

#include <benchmark/benchmark.h>

#include <sys/resource.h>

#include <ctime>
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
      s.simulator->step(cloth, frames[t - 1], frames[t], {testing::cotton()}, testing::kDt);
    benchmark::DoNotOptimize(cloth);
  }
  set_rate(state);
}
BENCHMARK(simulate)->Unit(benchmark::kMillisecond);

/// Simulation included; subtract the above.
void simulate_and_measure(benchmark::State &state) {
  const testing::Scene &s = scene(static_cast<int>(state.range(0)));
  const MaterialObjective objective(*s.simulator, s.performance, s.observations, testing::kDt, no_settling());
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
    MaterialObjective(*s.simulator, s.performance, s.observations, testing::kDt, no_settling(), {}, one_thread());
  set_rate(state);
}
BENCHMARK(prepare_images)->Arg(502)->Arg(1004)->Unit(benchmark::kMillisecond);

/// `count` frames out of those of `scene`, forth and back.
std::pair<ReferencePerformance, Observations> forth_and_back(const testing::Scene &s, int count) {
  ReferencePerformance performance = s.performance;
  Observations observations = s.observations;
  const int last = static_cast<int>(s.frames.size()) - 1;
  performance.dofs.resize(count, s.performance.dofs.cols());
  performance.surface.frames.clear();
  performance.frames.clear();
  performance.joints.assign(count, s.performance.joints[0]);
  observations.views.clear();
  for (int t = 0; t < count; ++t) {
    const bool back = t / last % 2 == 1;
    const int frame = back ? last - t % last : t % last;
    performance.dofs.row(t) = s.performance.dofs.row(frame);
    performance.surface.frames.push_back(t == 0 ? s.performance.surface.frames[0] : s.frames[frame]);
    performance.frames.push_back(t);
    observations.views.push_back(s.observations.views[frame]);
    const bool was_back = (t - 1) / last % 2 == 1; // the matches between t - 1 and t
    if (t > 0 && was_back)
      for (std::size_t c = 0; c < observations.views[t].size(); ++c) {
        observations.views[t][c].matches = s.observations.views[frame + 1][c].matches;
        for (FeatureMatch &match : observations.views[t][c].matches)
          std::swap(match.previous, match.current);
      }
  }
  observations.frames = performance.frames;
  return {performance, observations};
}

/// A whole estimation: population, evaluations, frames, threads, frames a window (0 = one rollout). Self-collision on, 8 cameras
/// of 1004 pixels. The parts are shares of the CPU time.
void estimate(benchmark::State &state) {
  static const auto scene = testing::make_scene({testing::cotton()}, {126, 8, 1004, 25, 52, true, 9});
  const auto [performance, observations] = forth_and_back(*scene, static_cast<int>(state.range(2)));
  Context context;
  context.threads = static_cast<int>(state.range(3));
  CmaEsOptions cma;
  cma.population = static_cast<int>(state.range(0));
  cma.max_evaluations = static_cast<int>(state.range(1));
  cma.min_deviation = 1e-9; // all evaluations
  EnergyTimes times;
  double evaluations = 0, image_bytes = 0;
  const std::clock_t start = std::clock();
  for (auto _ : state) {
    EnergyOptions energy;
    energy.window = static_cast<int>(state.range(4));
    MaterialObjective objective(*scene->simulator, performance, observations, testing::kDt, energy, {}, context);
    MinimiseOptions options;
    options.make_optimizer = [&](int n, std::uint64_t) { return create_cma_es(n, cma); };
    evaluations = minimise(objective, options, context).parts[0].evaluations;
    times = objective.times();
    image_bytes = static_cast<double>(objective.image_bytes());
  }
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const double rest =
      seconds - times.set_up - times.simulate - times.project - times.rims - times.contour - times.features - times.surface;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["cpu_s"] = seconds;
  state.counters["evaluations"] = evaluations;
  state.counters["ms_per_sample_frame"] = 1e3 * (seconds - times.set_up) / (evaluations * static_cast<double>(state.range(2)));
  for (const auto &[name, part] : {std::pair{"set_up", times.set_up},
                                   {"simulate", times.simulate},
                                   {"project", times.project},
                                   {"rims", times.rims},
                                   {"contour", times.contour},
                                   {"features", times.features},
                                   {"surface", times.surface},
                                   {"optimiser_and_rest", rest}})
    state.counters[name] = part / seconds;
  state.counters["image_MB"] = image_bytes / 1e6;
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1e3;
}
BENCHMARK(estimate)
    ->Args({9, 36, 250, 2, 0})
    ->Args({16, 64, 250, 2, 0})
    ->Args({32, 64, 250, 2, 0})
    ->Args({9, 36, 250, 2, 60})
    ->Args({16, 64, 250, 2, 60})
    ->Args({9, 512, 1000, 2, 0})
    ->Args({16, 512, 1000, 2, 0})
    ->Args({9, 512, 1000, 2, 60})
    ->Args({16, 512, 1000, 2, 60})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

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
