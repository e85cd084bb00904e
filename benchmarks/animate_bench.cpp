// Time of one frame of a character that plays: pose, cloth, transfer to M_high, body and its tuck. DOUBLET_CHARACTER names a
// character.glb, DOUBLET_CLIP a .bvh or .amc; without them a made-up figure in a skirt marches. The parts are timed beside the
// whole, in one run. crowd/N: so
// many copies side by side in the lanes (s_a_character: time of each).

#include "animate/figure_character.h"
#include "doublet/animate/animator.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/body_penetration.h"
#include "doublet/animate/parts/garment_penetration.h"
#include "doublet/animate/parts/skin_penetration.h"
#include "doublet/animate/retarget.h"

#include <benchmark/benchmark.h>
#include <cstdlib>

namespace {

using namespace doublet;

struct Scene {
  Character character;
  std::vector<Eigen::VectorXd> poses;
  Scene() {
    const char *file = std::getenv("DOUBLET_CHARACTER"), *clip = std::getenv("DOUBLET_CLIP");
    character = file ? read_character(file) : testing::figure_character();
    RetargetOptions options;
    options.fps = 1 / character.solver.dt;
    const MatrixRM dofs = clip ? retarget(read_motion_file(clip), character.actor.skeleton, options).dofs
                               : testing::marching(character.actor.skeleton, 200, options.fps);
    for (Eigen::Index t = 0; t < dofs.rows(); ++t)
      poses.push_back(dofs.row(t));
  }
};
const Scene &scene() {
  static const Scene made;
  return made;
}

/// Forwards and back again, so that no frame jumps.
const Eigen::VectorXd &pose_at(std::size_t frame) {
  const std::size_t last = scene().poses.size() - 1, at = frame % (2 * last);
  return scene().poses[at <= last ? at : 2 * last - at];
}

void whole_frame(benchmark::State &state) {
  Player player(scene().character);
  player.reset(pose_at(0));
  std::size_t t = 0;
  for (auto unused : state) {
    (void)unused;
    player.step(pose_at(++t));
  }
  state.counters["cloth_vertices"] =
      static_cast<double>(player.state().regions.empty() ? 0 : player.state().regions[0].positions.rows());
  state.counters["drawn_triangles"] = static_cast<double>(scene().character.high.faces.rows());
}
void crowd(benchmark::State &state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  Player first(scene().character);
  first.reset(pose_at(0));
  std::vector<Player> players(count, first);
  std::vector<Player *> all;
  for (Player &player : players)
    all.push_back(&player);
  std::vector<Eigen::VectorXd> poses(count);
  std::size_t t = 0;
  for (auto unused : state) {
    (void)unused;
    ++t;
    for (std::size_t k = 0; k < count; ++k)
      poses[k] = pose_at(t + k);
    step_players(all, poses, scene().character.solver.dt);
  }
  state.counters["s_a_character"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void part_pose(benchmark::State &state) {
  const Character &c = scene().character;
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies, c.solver.cloth);
  PosedFrame frame;
  std::size_t t = 0;
  for (auto unused : state) {
    (void)unused;
    simulator.pose(pose_at(++t), frame);
  }
}
void part_cloth(benchmark::State &state) {
  AnimateOptions options;
  options.high = options.body = false;
  Player player(scene().character, options);
  player.reset(pose_at(0));
  std::size_t t = 0;
  for (auto unused : state) {
    (void)unused;
    player.step(pose_at(++t));
  }
}
void part_transfer(benchmark::State &state) {
  Player player(scene().character);
  const Vertices surface = player.reset(pose_at(0)).surface;
  const DisplaySurface display(scene().character);
  DisplayBuffers buffers;
  Vertices high;
  for (auto unused : state) {
    (void)unused;
    display.apply(surface, high, buffers);
  }
}
void part_body(benchmark::State &state) {
  const Character &c = scene().character;
  const SkinBinding skin(c.body.vertices, c.body_weights);
  std::vector<DualQuaternion> joints;
  dual_quaternions(c.actor.skeleton, forward_kinematics(c.actor.skeleton, pose_at(0)), joints);
  Vertices body;
  for (auto unused : state) {
    (void)unused;
    skin.pose(joints, body);
  }
}
void part_tuck(benchmark::State &state) {
  Player player(scene().character);
  BodyPenetrationFix tuck(scene().character);
  std::size_t t = 0;
  player.reset(pose_at(0));
  for (auto unused : state) {
    (void)unused;
    state.PauseTiming();
    const AnimationFrame &frame = player.step(pose_at(++t));
    const Character &c = scene().character;
    Vertices body = dual_quaternion_skinning(c.body.vertices, c.body_weights, c.actor.skeleton, frame.world_from_rest);
    state.ResumeTiming();
    tuck.apply(frame.surface, body);
  }
}
void part_lift_garment(benchmark::State &state) {
  if (!GarmentPenetrationFix::applies_to(scene().character)) {
    state.SkipWithError("the character has no garment of its own");
    return;
  }
  Player player(scene().character);
  GarmentPenetrationFix lift(scene().character);
  std::size_t t = 0;
  player.reset(pose_at(0));
  for (auto unused : state) {
    (void)unused;
    state.PauseTiming();
    const AnimationFrame &frame = player.step(pose_at(++t));
    Vertices surface = frame.surface;
    state.ResumeTiming();
    lift.apply(frame.body, surface);
  }
}
void part_tuck_skin(benchmark::State &state) {
  AnimateOptions options;
  options.body = false;
  options.resolve_body_penetration = false;
  Player player(scene().character, options);
  SkinPenetrationFix tuck(scene().character);
  const DisplaySurface display(scene().character);
  DisplayBuffers buffers;
  Vertices high, none;
  std::size_t t = 0;
  player.reset(pose_at(0));
  for (auto unused : state) {
    (void)unused;
    state.PauseTiming();
    display.apply(player.step(pose_at(++t)).surface, high, buffers);
    state.ResumeTiming();
    tuck.apply(buffers, high, none);
  }
}

BENCHMARK(whole_frame)->Unit(benchmark::kMillisecond)->Iterations(300);
BENCHMARK(part_pose)->Unit(benchmark::kMillisecond);
BENCHMARK(part_cloth)->Unit(benchmark::kMillisecond)->Iterations(300);
BENCHMARK(part_transfer)->Unit(benchmark::kMillisecond);
BENCHMARK(part_body)->Unit(benchmark::kMillisecond);
BENCHMARK(part_lift_garment)->Unit(benchmark::kMillisecond)->Iterations(300);
BENCHMARK(part_tuck_skin)->Unit(benchmark::kMillisecond)->Iterations(300);
BENCHMARK(part_tuck)->Unit(benchmark::kMillisecond)->Iterations(100);
BENCHMARK(crowd)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond)->Iterations(100);

} // namespace
