// A player beside animate(), beside itself in other steps, and what may change while it plays.

#include "doublet/animate/animator.h"
#include "doublet/animate/player.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/self_intersection.h"
#include "figure_character.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DOUBLET_OWN_MALLOC 1 // the sanitizer's own stands in its place
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DOUBLET_OWN_MALLOC 1
#endif
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0};
} // namespace

#ifndef DOUBLET_OWN_MALLOC
// Every allocation of this program goes through one of these; glibc has the true ones under other names.
extern "C" {
void *__libc_malloc(std::size_t bytes);
void *__libc_calloc(std::size_t count, std::size_t bytes);
void *__libc_realloc(void *block, std::size_t bytes);
void *__libc_memalign(std::size_t alignment, std::size_t bytes);
void *malloc(std::size_t bytes) {
  allocations += counting;
  return __libc_malloc(bytes);
}
void *calloc(std::size_t count, std::size_t bytes) {
  allocations += counting;
  return __libc_calloc(count, bytes);
}
void *realloc(void *block, std::size_t bytes) {
  allocations += counting;
  return __libc_realloc(block, bytes);
}
void *aligned_alloc(std::size_t alignment, std::size_t bytes) {
  allocations += counting;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void **block, std::size_t alignment, std::size_t bytes) {
  allocations += counting;
  *block = __libc_memalign(alignment, bytes);
  return *block ? 0 : 12; // ENOMEM
}
}
#endif

namespace doublet::testing {
namespace {

constexpr int kFrames = 24;

const Character &figure() {
  static const Character character = figure_character();
  return character;
}
/// The cloth alone, which is what most of this is about.
AnimateOptions cloth_alone() {
  AnimateOptions options;
  options.settle_seconds = 0.2;
  options.high = options.body = false;
  return options;
}
/// A player of the figure, settled in the motion's first pose.
Player ready(const AnimateOptions &options = cloth_alone());
MatrixRM march(int frames = kFrames, double fps = 40) {
  return marching(figure().actor.skeleton, frames, fps);
}
Player ready(const AnimateOptions &options) {
  Player player(figure(), options);
  player.reset(march().row(0));
  return player;
}
/// The same motion somewhere else: `angle` about the vertical through the origin, then `way`.
Eigen::VectorXd elsewhere(const Eigen::VectorXd &dofs, double angle, const Eigen::Vector3d &way) {
  Eigen::VectorXd out = dofs;
  const Eigen::Vector3d rest = figure().actor.skeleton.joints[0].rest, at = rest + dofs.head<3>();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  out.head<3>() = turn * at + way - rest;
  out[3] += angle;
  return out;
}
double rms(const Vertices &a, const Vertices &b) {
  return std::sqrt((a - b).rowwise().squaredNorm().mean());
}
/// Mean of the cloth's vertices.
Eigen::Vector3d cloth_centre(const Player &player) {
  return player.state().regions.at(0).positions.colwise().mean();
}

TEST(Player, PlaysWhatAnimatePlays) {
  const MatrixRM dofs = march();
  const AnimationResult clip = animate(figure(), {40, dofs});
  Player player(figure());
  for (int t = 0; t < kFrames; ++t) {
    const AnimationFrame &frame = t == 0 ? player.reset(dofs.row(t)) : player.step(dofs.row(t));
    ASSERT_EQ(frame.index, t);
    ASSERT_EQ(frame.surface, clip.surface[t]);
    ASSERT_EQ(frame.high, clip.high[t]);
    ASSERT_EQ(frame.body, clip.body[t]);
    ASSERT_EQ(frame.joints, clip.joints[t]);
  }
  player.reset(dofs.row(0)); // all over again
  EXPECT_EQ(player.step(dofs.row(1)).surface, clip.surface[1]);
}

/// Most of a second of marching in steps of other lengths ends where it ends in the character's own: the folds differ by what
/// they do between any two runs that are not the same bits (1.3 cm). In one piece of 1/120 s instead it were 2.5 cm.
TEST(Player, StepsOfAnyLengthGiveTheSameMotion) {
  const auto after_a_while = [](const std::vector<double> &steps) {
    Player player = ready();
    const MatrixRM poses = march(1201, 1200);
    double at = 0;
    for (std::size_t i = 0; at < 0.8 - 1e-9; ++i) {
      const double seconds = std::min(steps[i % steps.size()], 0.8 - at);
      at += seconds;
      player.step(poses.row(std::lround(at * 1200)), seconds);
    }
    return player.frame().surface;
  };
  const Vertices own = after_a_while({1.0 / 40});
  EXPECT_LT(rms(own, after_a_while({1.0 / 60})), 0.018);
  EXPECT_LT(rms(own, after_a_while({1.0 / 120})), 0.018);
  EXPECT_LT(rms(own, after_a_while({0.017, 0.009, 0.022})), 0.018);
  EXPECT_LT(rms(own, after_a_while({1.0 / 20})), 0.018);
  EXPECT_GT(rms(own, ready().frame().surface), 0.05); // the bound above says something
}

TEST(Player, LongStepIsSeveralWithThePoseBetween) {
  const MatrixRM dofs = march();
  const double substep = figure().solver.dt / figure().solver.cloth.substeps;
  Player pieces = ready();
  pieces.teleport(dofs.row(3));
  Player once = pieces;
  for (int i = 1; i <= 6; ++i)
    pieces.step(interpolate_pose(figure().actor.skeleton, dofs.row(3), dofs.row(9), i / 6.0), substep);
  EXPECT_LT(rms(once.step(dofs.row(9), 6 * substep).surface, pieces.frame().surface), 1e-6);
}

/// Friction and damping are shares of a frame, and are shared out over its pieces.
TEST(Player, FourSubstepsAreOneFrame) {
  const MatrixRM dofs = march();
  Player whole = ready();
  for (int t = 1; t < 10; ++t)
    whole.step(dofs.row(t));
  std::vector<pbd::Material> viscous = whole.materials();
  viscous[0].k_damping = viscous[0].k_friction = 0.8;
  whole.set_materials(viscous);
  Player pieces = whole;
  const Eigen::VectorXd still = dofs.row(9);
  whole.step(still);
  for (int i = 0; i < figure().solver.cloth.substeps; ++i)
    pieces.step(still, figure().solver.dt / figure().solver.cloth.substeps);
  EXPECT_LT(rms(whole.frame().surface, pieces.frame().surface), 1e-6);
}

TEST(Player, WindAndGravityAct) {
  const Eigen::VectorXd pose = march().row(0);
  Player still = ready(), blown = still, same = still, floating = still;
  blown.set_wind({6, 0, 0});
  same.set_gravity(figure().solver.cloth.gravity);
  floating.set_gravity({0, 9.81, 0});
  for (int t = 0; t < 40; ++t)
    for (Player *player : {&still, &blown, &same, &floating})
      player->step(pose);
  EXPECT_EQ(still.frame().surface, same.frame().surface);
  EXPECT_GT(cloth_centre(blown).x(), cloth_centre(still).x() + 0.01);
  EXPECT_GT(cloth_centre(floating).y(), cloth_centre(still).y() + 0.05);
}

TEST(Player, MaterialsAndProxiesMayChange) {
  const MatrixRM dofs = march();
  Player player = ready(), plain = player;
  std::vector<pbd::Material> heavy_air = player.materials();
  heavy_air[0].d_n = heavy_air[0].d_t = 8;
  player.set_materials(heavy_air);
  EXPECT_EQ(player.materials()[0].d_t, 8);
  EXPECT_NE(player.step(dofs.row(1)).surface, plain.step(dofs.row(1)).surface);

  std::vector<TaperedCapsule> thick = plain.proxies();
  for (TaperedCapsule &capsule : thick)
    capsule.r0 += 0.05, capsule.r1 += 0.05;
  Player wide = plain;
  wide.set_proxies(thick);
  for (int t = 0; t < 40; ++t) {
    plain.step(dofs.row(1));
    wide.step(dofs.row(1));
  }
  const auto spread = [](const Player &of) { return of.state().regions[0].positions.col(0).squaredNorm(); };
  EXPECT_GT(spread(wide), 1.05 * spread(plain));
  plain.set_proxies({});
  EXPECT_NO_THROW(plain.step(dofs.row(2)));
}

TEST(Player, TeleportTakesTheClothAlong) {
  const MatrixRM dofs = march();
  const Eigen::Vector3d way(100, 0, -20);
  Player here = ready(), there = here;
  for (int t = 1; t < 12; ++t) {
    here.step(dofs.row(t));
    there.step(dofs.row(t));
  }
  there.teleport(elsewhere(dofs.row(11), 1.2, way));
  const Eigen::Isometry3d moved = Eigen::Translation3d(way) * Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY());
  const auto apart = [&] {
    Vertices expected = here.frame().surface;
    for (Eigen::Index v = 0; v < expected.rows(); ++v)
      expected.row(v) = moved * Eigen::Vector3d(expected.row(v));
    return rms(expected, there.frame().surface);
  };
  EXPECT_LT(apart(), 1e-9);
  for (int t = 12; t < kFrames; ++t) {
    here.step(dofs.row(t));
    there.step(elsewhere(dofs.row(t), 1.2, way));
  }
  EXPECT_LT(apart(), 2e-3); // the order of sums is another in floats, no more
}

TEST(Player, GoesBackToASavedState) {
  const MatrixRM dofs = march();
  Player player = ready();
  player.step(dofs.row(1));
  const CharacterState saved = player.state();
  const Vertices first = player.step(dofs.row(2)).surface;
  player.teleport(dofs.row(1));
  player.set_state(saved);
  EXPECT_EQ(player.step(dofs.row(2)).surface, first);
}

/// Copies of a player far from each other, each in another pose, some of them in a wind.
void expect_together_as_alone(const Player &first, const std::vector<int> &counts) {
  constexpr int kSteps = 4;
  const int most = *std::max_element(counts.begin(), counts.end());
  const MatrixRM dofs = march();
  const auto pose = [&](int k, int t) { return elsewhere(dofs.row(t + 2 * k), 0.1 * k, {2.0 * k, 0, 0}); };
  const auto copies = [&](int count) {
    std::vector<Player> players(count, first);
    for (int k = 2; k < count; k += 3)
      players[k].set_wind({0, 0, 3});
    return players;
  };
  std::vector<Player> alone = copies(most);
  for (int t = 1; t < kSteps; ++t)
    for (int k = 0; k < most; ++k)
      alone[k].step(pose(k, t), 1.0 / 30);
  for (const int count : counts) {
    std::vector<Player> together = copies(count);
    std::vector<Player *> all;
    for (Player &player : together)
      all.push_back(&player);
    for (int t = 1; t < kSteps; ++t) {
      std::vector<Eigen::VectorXd> poses;
      for (int k = 0; k < count; ++k)
        poses.push_back(pose(k, t));
      step_players(all, poses, 1.0 / 30, 2);
    }
    for (int k = 0; k < count; ++k) {
      EXPECT_EQ(alone[k].frame().surface, together[k].frame().surface) << k << " of " << count;
      EXPECT_EQ(alone[k].frame().high, together[k].frame().high) << k << " of " << count;
      EXPECT_EQ(alone[k].frame().body, together[k].frame().body) << k << " of " << count;
    }
  }
}
TEST(Player, ManyTogetherMoveAsEachAlone) {
  AnimateOptions all_of_it;
  all_of_it.settle_seconds = 0.2;
  expect_together_as_alone(ready(all_of_it), {3, 5});
}
/// Lanes that are full and lanes that are not, one group and two.
TEST(SlowPlayer, AnyNumberTogetherMovesAsEachAlone) {
  expect_together_as_alone(ready(), {1, 8, 9});
}

TEST(Player, OneWhoseClothIsLostDoesNotHoldUpTheOthers) {
  const MatrixRM dofs = march();
  const Player first = ready();
  std::vector<Player> players(3, first);
  std::vector<Player *> all{&players[0], &players[1], &players[2]};
  Eigen::VectorXd beyond = dofs.row(1);
  beyond.head<3>().setConstant(1e300);
  const std::vector<Eigen::VectorXd> poses{dofs.row(1), beyond, dofs.row(2)};
  try {
    step_players(all, poses, 1.0 / 60);
    FAIL() << "expected an error";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("the cloth of player 1 "), std::string::npos) << error.what();
  }
  EXPECT_EQ(players[1].frame().surface, first.frame().surface);
  Player alone = first;
  EXPECT_EQ(players[2].frame().surface, alone.step(dofs.row(2), 1.0 / 60).surface);
  const std::vector<Eigen::VectorXd> again(3, dofs.row(2));
  EXPECT_NO_THROW(step_players(all, again, 1.0 / 60));
}

TEST(Player, WrongInputIsRefusedAndChangesNothing) {
  const MatrixRM dofs = march();
  Player player = ready(), untouched = player;
  Eigen::VectorXd broken = dofs.row(1);
  broken[4] = std::nan("");
  EXPECT_THROW(player.step(broken), std::invalid_argument);
  EXPECT_THROW(player.teleport(broken), std::invalid_argument);
  EXPECT_THROW(player.reset(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(player.step(dofs.row(1), 0), std::invalid_argument);
  EXPECT_THROW(player.step(dofs.row(1), std::nan("")), std::invalid_argument);
  EXPECT_THROW(player.set_materials({}), std::invalid_argument);
  EXPECT_THROW(player.set_wind({0, std::nan(""), 0}), std::invalid_argument);
  EXPECT_THROW(player.set_gravity({0, -2000, 0}), std::invalid_argument);
  EXPECT_THROW(player.set_proxies({{99, {0, 0, 0}, {0, 1, 0}, 0.1, 0.1}}), Error);
  EXPECT_THROW(player.set_state({}), std::invalid_argument);
  Player stranger = ready();
  std::vector<Player *> strangers{&player, &stranger}, twice{&player, &player};
  const std::vector<Eigen::VectorXd> poses{dofs.row(1), dofs.row(1)};
  EXPECT_THROW(step_players(strangers, poses, 0.025), std::invalid_argument);
  EXPECT_THROW(step_players(twice, poses, 0.025), std::invalid_argument);
  Player bare = player;
  bare.set_proxies({});
  std::vector<Player *> unlike{&player, &bare};
  try {
    step_players(unlike, poses, 0.025);
    ADD_FAILURE() << "expected an error";
  } catch (const std::invalid_argument &error) {
    EXPECT_NE(std::string(error.what()).find("found 0 of player 1 and "), std::string::npos) << error.what();
  }
  EXPECT_EQ(player.step(dofs.row(1)).surface, untouched.step(dofs.row(1)).surface);
}

Mesh cloth_of(const Player &player) {
  const CharacterSimulator simulator(player.character().actor, player.character().segmentation, {});
  return {player.state().regions[0].positions, simulator.regions()[0].model->faces()};
}
/// Faces of the cloth that pass through others.
int crossing(const Player &player) {
  const auto found = self_intersecting_faces(cloth_of(player));
  return static_cast<int>(std::count(found.begin(), found.end(), 1));
}
/// Proxies whose axis passes through the cloth.
int piercing(const Player &player) {
  const Mesh cloth = cloth_of(player);
  int count = 0;
  for (const TaperedCapsule &proxy : player.proxies()) {
    const Capsule c = pose_capsule(proxy, player.character().actor.skeleton, player.frame().world_from_rest);
    count += crosses_surface(c.p0, c.p1, cloth);
  }
  return count;
}
Player ready_to_be_caught(bool redrape_when_tangled) {
  AnimateOptions options = cloth_alone();
  options.redrape_when_tangled = redrape_when_tangled;
  return ready(options);
}
/// The same with every vertex of the cloth moved.
template <class Move> Player with_cloth_moved(bool redrape_when_tangled, const Move &move) {
  Player player = ready_to_be_caught(redrape_when_tangled);
  CharacterState state = player.state();
  Vertices &cloth = state.regions[0].positions;
  for (Eigen::Index v = 0; v < cloth.rows(); ++v)
    move(cloth.row(v));
  player.set_state(state);
  return player;
}
/// The lower skirt turned over: its front hangs behind the legs, its back before them.
Player turned_over(bool redrape_when_tangled) {
  const double middle = ready().frame().joints(0, 2);
  return with_cloth_moved(redrape_when_tangled, [&](auto x) { x[2] = x[1] < 0.85 ? 2 * middle - x[2] : x[2]; });
}
void hold(Player &player, double seconds) {
  for (int t = 0; t < std::lround(40 * seconds); ++t)
    player.step(march().row(0));
}

/// The most that an edge of the cloth is longer than at rest.
double longest(const Player &player, const Vertices &cloth) {
  const CharacterSimulator simulator(player.character().actor, player.character().segmentation, {});
  const pbd::ClothModel &model = *simulator.regions()[0].model;
  double most = 0;
  for (const Eigen::Vector2i &e : edge_topology(model.faces()).edges)
    most = std::max(most, (cloth.row(e[0]) - cloth.row(e[1])).norm() / (model.rest().row(e[0]) - model.rest().row(e[1])).norm());
  return most;
}
/// A wide lunge, turned about and elsewhere.
Eigen::VectorXd lunge() {
  const Skeleton &skeleton = figure().actor.skeleton;
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
  const auto set = [&](const std::string &joint, int component, double value) {
    dofs[skeleton.joints[skeleton.find(joint)].first_dof + component] = value;
  };
  set("l_hip", 0, -1.5);
  set("r_hip", 0, 0.9);
  set("l_knee", 0, 1.2);
  return elsewhere(dofs, 1, {2, 0, 1});
}

/// In a pose that is bent the rest shape would be stretched: cloth that began there would spring back through itself.
TEST(Player, ClothIsPutOnInTheRestPose) {
  AnimateOptions options = cloth_alone();
  options.settle_seconds = 0.025;
  Player player(figure(), options);
  player.reset(lunge());
  const CharacterSimulator simulator(figure().actor, figure().segmentation, figure().proxies);
  const Vertices carried = simulator.start(simulator.pose(lunge())).regions[0].positions;
  EXPECT_GT(longest(player, carried), 1.6);
  EXPECT_LT(longest(player, player.state().regions[0].positions), 1.4); // still on its way from the quick lunge
  EXPECT_EQ(crossing(player), 0);
}

TEST(Player, CaughtClothIsFreedWhileThePoseIsHeld) {
  Player freed = turned_over(true), left = turned_over(false);
  EXPECT_GT(crossing(freed), 20);
  hold(freed, 2);
  hold(left, 2);
  EXPECT_EQ(crossing(freed), 0);
  EXPECT_GT(crossing(left), 20);
}

/// What is drawn does not jump, and ends where the cloth is; copies and those in lanes go the same way.
TEST(Player, CaughtClothIsDrawnOnItsWay) {
  Player player = turned_over(true);
  hold(player, 0.7);
  Player copy = player, other = player;
  double fastest = 0, way = 0;
  const Vertices from = player.frame().surface;
  Vertices before = from;
  for (int t = 0; t < 24; ++t) {
    const Vertices now = player.step(march().row(0)).surface;
    fastest = std::max(fastest, (now - before).rowwise().norm().maxCoeff());
    way = std::max(way, (now - from).rowwise().norm().maxCoeff());
    before = now;
    EXPECT_EQ(copy.step(march().row(0)).surface, now) << t;
    std::vector<Player *> one{&other};
    step_players(one, std::vector<Eigen::VectorXd>{march().row(0)}, 0.025);
    EXPECT_EQ(other.frame().surface, now) << t;
  }
  EXPECT_GT(way, 0.1);
  EXPECT_LT(fastest, 0.15 * way);
  player.set_state(player.state()); // shows the cloth itself
  EXPECT_EQ(player.frame().surface, before);
}

/// Slanted, so that the legs come out at its side; it does not cross itself.
Player slanted(bool redrape_when_tangled) {
  return with_cloth_moved(redrape_when_tangled, [](auto x) { x[0] += 2 * std::max(0.0, 0.95 - x[1]); });
}
TEST(Player, ClothWithALimbThroughItIsFreed) {
  Player freed = slanted(true), left = slanted(false);
  EXPECT_EQ(crossing(freed), 0);
  EXPECT_GE(piercing(freed), 1);
  hold(freed, 2);
  hold(left, 2);
  EXPECT_EQ(piercing(freed), 0);
  EXPECT_GE(piercing(left), 1);
}
/// m, the most that what is drawn of the cloth is off what is simulated.
double drawn_off(const Player &player) {
  const CharacterSimulator simulator(player.character().actor, player.character().segmentation, {});
  const Vertices drawn = player.frame().surface(simulator.regions()[0].vertex_from_cloth, Eigen::all);
  return (drawn - player.state().regions[0].positions).rowwise().norm().maxCoeff();
}
/// What was caught is drawn on for a tenth of a second.
TEST(Player, ClothWithABoneThroughItIsPutOnAnewInMotion) {
  Player freed = slanted(true), left = slanted(false);
  const MatrixRM dofs = march(101);
  std::vector<int> late;
  for (Player *player : {&freed, &left})
    for (int t = 0; t < 60; ++t) {
      player->step(dofs.row(t + 1));
      if (drawn_off(*player) > 1e-6)
        late.push_back(t);
    }
  EXPECT_GE(late.size(), 2u);
  EXPECT_LE(late.size(), 4u); // frames of 1/40 s
  EXPECT_EQ(piercing(freed), 0);
  EXPECT_GE(piercing(left), 1);
}
/// It goes on as cloth, in the place of with its skin: legs that move apart would draw it out.
TEST(Player, ClothThatIsPutOnAnewInMotionIsNotDrawnOut) {
  Player player = slanted(true);
  const Skeleton &skeleton = figure().actor.skeleton;
  const int left = skeleton.joints[skeleton.find("l_hip")].first_dof, right = skeleton.joints[skeleton.find("r_hip")].first_dof;
  const CharacterSimulator simulator(figure().actor, figure().segmentation, {});
  const auto drawn = [&]() -> Vertices { return player.frame().surface(simulator.regions()[0].vertex_from_cloth, Eigen::all); };
  const MatrixRM dofs = march(101);
  int t = 0;
  while (drawn_off(player) < 1e-6 && t < 60)
    player.step(dofs.row(++t));
  ASSERT_LT(t, 60);
  const double before = longest(player, drawn());
  Eigen::VectorXd pose = dofs.row(t);
  for (int k = 0; k < 4; ++k) {
    pose[left] -= 0.2; // 8 rad/s
    pose[right] += 0.2;
    player.step(pose);
    EXPECT_LT(longest(player, drawn()), std::max(before, longest(player, player.state().regions[0].positions)) + 0.1) << k;
  }
}
/// A thigh that is raised in a jump comes out through the skirt; in the pose before that the cloth had been looked at.
TEST(Player, CaughtClothIsLookedForAgainAfterATeleport) {
  Player freed = ready_to_be_caught(true), left = ready_to_be_caught(false);
  const std::vector<std::string> &names = freed.character().actor.skeleton.dof_names;
  Eigen::VectorXd raised = march().row(0);
  raised[std::find(names.begin(), names.end(), "l_hip.x") - names.begin()] -= 1;
  for (Player *player : {&freed, &left}) {
    hold(*player, 1);
    player->teleport(raised);
    EXPECT_EQ(piercing(*player), 1);
    for (int t = 0; t < 60; ++t)
      player->step(raised);
  }
  EXPECT_EQ(piercing(freed), 0);
  EXPECT_EQ(piercing(left), 1);
}

/// In a heap, where every vertex has another's place.
TEST(Player, ClothThatIsAllInAKnotIsPutOnAnewInMotion) {
  const auto in_a_heap = [](bool redrape_when_tangled) {
    AnimateOptions options = cloth_alone();
    options.redrape_when_tangled = redrape_when_tangled;
    options.edge_collision = false; // which would move it apart in a second or two
    Player player = ready(options);
    CharacterState state = player.state();
    Vertices &cloth = state.regions[0].positions;
    for (Eigen::Index v = 0, n = cloth.rows(); v < n; ++v)
      cloth.row(v) = player.state().regions[0].positions.row(v * 101 % n);
    player.set_state(state);
    return player;
  };
  Player freed = in_a_heap(true), left = in_a_heap(false);
  const MatrixRM dofs = march(101);
  for (Player *player : {&freed, &left})
    for (int t = 0; t < 100; ++t)
      player->step(dofs.row(t + 1));
  EXPECT_LT(crossing(freed), 20);
  EXPECT_GT(crossing(left), 100);
}

/// All in a heap at the waist, above a rod that passes through any skirt that hangs.
TEST(Player, ClothInAKnotIsPutOnAnewThoughAProxyWillBeThroughIt) {
  const auto above_a_rod = [](bool redrape_when_tangled) {
    Player player = ready_to_be_caught(redrape_when_tangled);
    const Vertices hanging = player.state().regions[0].positions;
    const double top = hanging.col(1).maxCoeff(), low = hanging.col(1).minCoeff();
    CharacterState state = player.state();
    Vertices &cloth = state.regions[0].positions;
    for (Eigen::Index v = 0, n = cloth.rows(); v < n; ++v) {
      cloth.row(v) = hanging.row(v * 101 % n);
      cloth(v, 1) = top - 0.1 * (top - cloth(v, 1));
    }
    player.set_state(state);
    std::vector<TaperedCapsule> proxies = player.proxies();
    const Eigen::Vector3d middle(0, low + 0.1 - figure().actor.skeleton.joints[0].rest.y(), 0);
    proxies.push_back({0, middle, middle + Eigen::Vector3d::UnitZ(), 0.01, 0.01});
    player.set_proxies(proxies);
    return player;
  };
  Player freed = above_a_rod(true), left = above_a_rod(false);
  EXPECT_EQ(piercing(freed), 0);
  const MatrixRM dofs = march(101);
  for (Player *player : {&freed, &left})
    for (int t = 0; t < 60; ++t)
      player->step(dofs.row(t + 1));
  EXPECT_LT(crossing(freed), 20);
  EXPECT_GT(crossing(left), 100);
}

TEST(Player, ClothThatIsNotCaughtIsLeftAlone) {
  Player with = ready_to_be_caught(true), without = ready_to_be_caught(false);
  hold(with, 1.5);
  hold(without, 1.5);
  EXPECT_EQ(with.frame().surface, without.frame().surface);
}

#ifndef DOUBLET_OWN_MALLOC
/// 95 % of the cloth's vertices are slower, m/s.
double speed(const Player &player) {
  std::vector<double> speeds;
  for (const pbd::ClothState &cloth : player.state().regions)
    for (Eigen::Index i = 0; i < cloth.velocities.rows(); ++i)
      speeds.push_back(cloth.velocities.row(i).norm());
  std::sort(speeds.begin(), speeds.end());
  return speeds[speeds.size() * 95 / 100];
}

/// After the march, four seconds of its last pose.
Player held(double rest_damping, const Eigen::Vector3d &wind = {0, 0, 0}) {
  AnimateOptions options = cloth_alone();
  options.rest_damping = rest_damping;
  Player player = ready(options);
  std::vector<pbd::Material> swinging = player.materials();
  for (pbd::Material &material : swinging)
    material.d_n = material.d_t = material.k_damping = 0;
  player.set_materials(swinging);
  player.set_wind(wind);
  const MatrixRM motion = march();
  for (int t = 0; t < kFrames; ++t)
    player.step(motion.row(t));
  for (int t = 0; t < 160; ++t)
    player.step(motion.row(kFrames - 1));
  return player;
}

TEST(Player, ClothComesToRestWhileThePoseIsHeld) {
  EXPECT_GT(speed(held(0)), 0.02);
  EXPECT_LT(speed(held(AnimateOptions{}.rest_damping)), 0.002);
}

/// Contacts that never agree push cloth about for good, however it is damped.
TEST(Player, ClothAtRestStaysUntilSomethingChanges) {
  const Eigen::VectorXd pose = march().row(kFrames - 1);
  const Player resting = held(AnimateOptions{}.rest_damping);
  const Vertices there = resting.frame().surface;
  Player player = resting;
  EXPECT_EQ(player.step(pose).surface, there);
  EXPECT_EQ(player.step(pose, 0.01).surface, there);
  player.set_gravity(player.gravity()); // nothing new
  EXPECT_EQ(player.step(pose).surface, there);
  player.set_gravity({3, -9.81, 0});
  EXPECT_GT((player.step(pose).surface - there).cwiseAbs().maxCoeff(), 1e-4);
  player = resting;
  player.set_wind({0, 0, 2});
  EXPECT_GT((player.step(pose).surface - there).cwiseAbs().maxCoeff(), 1e-4);
  player = resting;
  std::vector<pbd::Material> stiff = player.materials();
  for (pbd::Material &material : stiff)
    material.k_bend = 1;
  player.set_materials(stiff);
  EXPECT_GT((player.step(pose).surface - there).cwiseAbs().maxCoeff(), 1e-5);
  player = resting;
  std::vector<Player *> one{&player};
  step_players(one, std::vector<Eigen::VectorXd>{pose}, 0.025);
  EXPECT_EQ(player.frame().surface, there);
}

namespace {

/// Cloth that goes to and fro by `way` (m) from frame to frame, as between contacts that never agree.
class Trembling : public pbd::ClothSolver {
public:
  Trembling(std::shared_ptr<const pbd::ClothModel> model, double way) : ClothSolver(std::move(model)), way_(way) {}

private:
  std::vector<int> advance(std::span<pbd::ClothState> states, std::span<const pbd::StepInputs>, std::span<const pbd::Material>,
                           int) const override {
    for (pbd::ClothState &state : states)
      state.positions.col(0).array() += frame_++ % 2 == 0 ? way_ : -way_;
    return {};
  }
  double way_;
  mutable int frame_ = 0;
};

} // namespace

TEST(Player, ClothThatTremblesStopsTheLaterTheFasterItIs) {
  const auto moves_after = [](double seconds, double way) {
    Player player(figure(), cloth_alone(), [way](auto model) { return std::make_shared<Trembling>(std::move(model), way); });
    const Eigen::VectorXd pose = march().row(0);
    player.reset(pose);
    for (int t = 0; t < std::lround(40 * seconds); ++t)
      player.step(pose);
    const Vertices before = player.frame().surface;
    return (player.step(pose).surface - before).cwiseAbs().maxCoeff() > 0;
  };
  EXPECT_FALSE(moves_after(2.0, 0.0005)); // 2 cm/s
  EXPECT_TRUE(moves_after(1.5, 0.002));   // 8 cm/s
  EXPECT_FALSE(moves_after(2.6, 0.002));
  EXPECT_TRUE(moves_after(3.5, 0.01)); // 40 cm/s, as cloth that falls
}

TEST(Player, WindKeepsClothFromRest) {
  const Eigen::Vector3d wind(0, 0, 2);
  EXPECT_EQ(held(6, wind).frame().surface, held(0, wind).frame().surface);
}

TEST(Player, ClothInMotionKnowsNoRest) {
  AnimateOptions none = cloth_alone();
  none.rest_damping = 0;
  Player with = ready(), without = ready(none);
  const MatrixRM motion = march();
  for (int t = 0; t < kFrames; ++t)
    EXPECT_EQ(with.step(motion.row(t)).surface, without.step(motion.row(t)).surface) << t;
}

TEST(Player, WarmFrameAllocatesNothing) {
  counting = true;
  allocations = 0;
  EXPECT_EQ(std::vector<int>(3).size(), 3u);
  counting = false;
  EXPECT_EQ(allocations, 1); // the counter counts
  const MatrixRM dofs = march(40);
  std::vector<Eigen::VectorXd> poses;
  for (int t = 0; t < dofs.rows(); ++t)
    poses.push_back(dofs.row(t));
  AnimateOptions options;
  options.settle_seconds = 0.2;
  Player player = ready(options);
  const CharacterState start = player.state();
  const auto play = [&] { // the same every time, so that no contact comes that was not there
    player.teleport(poses[0]);
    player.set_state(start);
    for (const Eigen::VectorXd &pose : poses) {
      player.step(pose);
      player.step(pose, 1.0 / 60); // with poses between
    }
  };
  play();
  play();
  allocations = 0;
  counting = true;
  play();
  counting = false;
  EXPECT_EQ(allocations, 0);
}
#endif

} // namespace
} // namespace doublet::testing
