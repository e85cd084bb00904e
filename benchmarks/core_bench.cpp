// What the stages do thousands of times: draw, skin, cast, find closest points. build/benchmarks/core_bench

#include "doublet/core/rasterizer.h"
#include "doublet/core/skinning.h"
#include "doublet/rays/ray_scene.h"
#include "support/figure.h"

#include <benchmark/benchmark.h>

#include <map>

namespace {

using namespace doublet;

/// The figure with about the given number of vertices; made once.
const RiggedMesh &figure(int vertices) {
  static std::map<int, RiggedMesh> made;
  RiggedMesh &actor = made[vertices];
  if (actor.mesh.vertices.rows() == 0)
    actor = testing::figure_actor(0.025 * std::sqrt(12000.0 / vertices));
  return actor;
}

void set_sizes(benchmark::State &state, const RiggedMesh &actor) {
  state.counters["vertices"] = static_cast<double>(actor.mesh.vertices.rows());
  state.counters["faces"] = static_cast<double>(actor.mesh.faces.rows());
}

void rasterize_one_view(benchmark::State &state) {
  const RiggedMesh &actor = figure(static_cast<int>(state.range(0)));
  const Camera camera = testing::camera_ring(8, static_cast<int>(state.range(1)))[1];
  for (auto _ : state)
    benchmark::DoNotOptimize(rasterize(actor.mesh.vertices, actor.mesh.faces, camera));
  set_sizes(state, actor);
}
BENCHMARK(rasterize_one_view)->ArgsProduct({{2500, 13000}, {502, 1004}})->Unit(benchmark::kMillisecond);

void skin_dual_quaternions(benchmark::State &state) {
  const RiggedMesh &actor = figure(static_cast<int>(state.range(0)));
  const Transforms pose = forward_kinematics(actor.skeleton, Eigen::VectorXd::Constant(actor.skeleton.dof_count(), 0.3));
  for (auto _ : state)
    benchmark::DoNotOptimize(dual_quaternion_skinning(actor.mesh.vertices, actor.weights, pose));
  set_sizes(state, actor);
}
BENCHMARK(skin_dual_quaternions)->Arg(2500)->Arg(13000)->Unit(benchmark::kMillisecond);

void kinematics_and_twists(benchmark::State &state) {
  const Skeleton skeleton = testing::figure_skeleton();
  const Eigen::VectorXd pose = Eigen::VectorXd::Constant(skeleton.dof_count(), 0.3);
  for (auto _ : state)
    benchmark::DoNotOptimize(dof_twists(skeleton, pose));
}
BENCHMARK(kinematics_and_twists)->Unit(benchmark::kMicrosecond);

void build_ray_scene(benchmark::State &state) {
  const RiggedMesh &actor = figure(static_cast<int>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(RayScene(actor.mesh));
  set_sizes(state, actor);
}
BENCHMARK(build_ray_scene)->Arg(2500)->Arg(13000)->Unit(benchmark::kMillisecond);

void cast_rays(benchmark::State &state) {
  const RayScene scene(figure(static_cast<int>(state.range(0))).mesh);
  double angle = 0;
  for (auto _ : state) {
    angle += 0.1;
    benchmark::DoNotOptimize(
        scene.cast({3 * std::cos(angle), 1.2, 3 * std::sin(angle)}, {-std::cos(angle), 0, -std::sin(angle)}));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(cast_rays)->Arg(2500)->Arg(13000);

void closest_points(benchmark::State &state) {
  const RiggedMesh &actor = figure(static_cast<int>(state.range(0)));
  const RayScene scene(actor.mesh);
  Eigen::Index v = 0;
  for (auto _ : state) { // 2 cm off the surface, as between captured and true surface
    benchmark::DoNotOptimize(scene.closest(actor.mesh.vertices.row(v).transpose() + Eigen::Vector3d(0.01, 0.01, 0.01)));
    v = (v + 1) % actor.mesh.vertices.rows();
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(closest_points)->Arg(2500)->Arg(13000);

} // namespace

BENCHMARK_MAIN();
