#include "doublet/animate/player.h"

#include "caught_cloth.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/motion.h"
#include "doublet/animate/parts/body_penetration.h"
#include "doublet/animate/parts/garment_penetration.h"
#include "doublet/animate/parts/skin_penetration.h"
#include "doublet/core/context.h"
#include "doublet/core/error.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace doublet {
namespace {

constexpr double kLongestStep = 1; // s
constexpr double kMostGravity = 1000;
// A held pose: all joints slower than this, for longer than kHeldAfter; then the damping grows for kRestGrows.
constexpr double kStill = 0.02, kHeldAfter = 0.25, kRestGrows = 1; // m/s, s, s
// Cloth that moves no faster than this then, on average over its vertices, stops within kStops; each second later it may be
// faster by kImpatient, because cloth that is pressed into a groin or an armpit by proxies that overlap would shake there for
// good.
constexpr double kAlmostStill = 0.03, kStops = 0.5, kImpatient = 0.1; // m/s, s, m/s^2
// A pose that is held for so long shows whether the cloth is caught; what is drawn then goes over to cloth that is not.
constexpr double kCaughtAfter = 0.75, kFreed = 0.5; // s
// In motion it is looked at now and then: cloth that is caught twice in a row does not come loose by itself. It is seen for less
// time then, for motion hides the change.
constexpr double kWatchEvery = 0.5, kFreedInMotion = 0.1; // s

const Character &checked(const Character &character) {
  validate_character(character);
  return character;
}

/// How a step is cut: whole, if it is the character's own; else into steps as near as can be to the substeps for which the
/// material was estimated, because shorter ones take less energy out of the cloth.
struct Cut {
  int count;
  double seconds; ///< of each
  int substeps;   ///< of each; 0 = the solver's
};
Cut cut_step(const SolverSettings &solver, double seconds) {
  if (!(seconds > 0 && seconds <= kLongestStep))
    throw std::invalid_argument("Player::step: expected seconds in (0, 1], found " + options::to_text(seconds));
  if (seconds == solver.dt)
    return {1, seconds, 0};
  const int count = std::max(1, static_cast<int>(std::lround(seconds / solver.dt * solver.cloth.substeps)));
  return {count, seconds / count, 1};
}

pbd::ClothOptions cloth_options(pbd::ClothOptions cloth, const AnimateOptions &options) {
  cloth.edge_collision |= options.edge_collision;
  return cloth;
}

void require_pose(const Character &character, const Eigen::VectorXd &dofs) {
  const int expected = character.actor.skeleton.dof_count();
  if (dofs.size() != expected || !dofs.allFinite())
    throw std::invalid_argument("Player: expected a pose of " + std::to_string(expected) + " finite numbers, found " +
                                (dofs.size() != expected ? std::to_string(dofs.size()) : "NaN or infinity"));
}

void require_vector(const Eigen::Vector3d &value, double most, const char *what, const char *unit) {
  if (!(value.cwiseAbs().maxCoeff() <= most) || !value.allFinite())
    throw std::invalid_argument(std::string("Player: expected ") + what + " within " + options::to_text(most) + " " + unit +
                                ", found (" + options::to_text(value.x()) + ", " + options::to_text(value.y()) + ", " +
                                options::to_text(value.z()) + ")");
}

} // namespace

/// What all copies of a player have in common.
struct Player::Shared {
  Character character;
  AnimateOptions options;
  CharacterSimulator simulator;
  std::optional<DisplaySurface> display;
  bool lifts_garment = false;
  std::optional<SkinBinding> body;
  detail::CaughtCloth caught_cloth;

  Shared(Character c, const AnimateOptions &o, const pbd::ClothSolverFactory &make_solver)
      : character(std::move(c)), options(o), simulator(checked(character).actor, character.segmentation, character.proxies,
                                                       cloth_options(character.solver.cloth, o), make_solver),
        caught_cloth(character, simulator) {
    options.validate();
    if (options.high && character.high.faces.rows() > 0)
      display.emplace(character);
    lifts_garment = display && options.resolve_body_penetration && GarmentPenetrationFix::applies_to(character);
    if ((options.body || lifts_garment) && character.body.faces.rows() > 0)
      body.emplace(character.body.vertices, character.body_weights);
  }
};

/// What is a player's own.
struct Player::Playing {
  explicit Playing(const Shared &shared)
      : materials(shared.character.materials), proxies(shared.character.proxies), gravity(shared.character.solver.cloth.gravity) {
    const Character &character = shared.character;
    if (!shared.options.resolve_body_penetration)
      return;
    if (shared.lifts_garment)
      lift_garment.emplace(character);
    if (shared.options.body && shared.body &&
        std::any_of(character.body_shown.begin(), character.body_shown.end(), [](auto f) { return f != 0; }))
      tuck_body.emplace(character);
    if (shared.display && character.garment_subdivisions >= 0)
      tuck_skin.emplace(character, *shared.display);
  }

  /// Steps of the character's own length; gravity and wind are the player's, length and substeps those of the step at hand.
  StepEnvironment whole_frames(const Shared &shared) const { return {shared.character.solver.dt, wind, gravity, 0}; }
  StepEnvironment environment(const Cut &cut) const { return {cut.seconds, wind, gravity, cut.substeps}; }
  void pose(const Shared &shared, const Eigen::VectorXd &dofs, PosedFrame &out) const {
    shared.simulator.pose(dofs, out);
    set_capsules(shared, out);
  }
  void set_capsules(const Shared &shared, PosedFrame &out) const {
    pose_capsules(proxies, shared.character.actor.skeleton, out.world_from_rest, out.capsules);
  }

  /// Cloth that is put on in the rest pose and goes along from there to the pose of these dofs, and rests there.
  CharacterState drape_along(const Shared &shared, const Eigen::VectorXd &dofs) const {
    std::vector<PosedFrame> way;
    for (const Eigen::VectorXd &on_the_way : lead_in_poses(shared.character.actor.skeleton, dofs, shared.character.solver.dt))
      pose(shared, on_the_way, way.emplace_back());
    CharacterState cloth = shared.simulator.drape_along(way, materials, whole_frames(shared));
    for (pbd::ClothState &region : cloth.regions)
      region.velocities.setZero();
    return cloth;
  }
  /// Makes ready for piece `index` of a step to `dofs`.
  void aim(const Shared &shared, const Eigen::VectorXd &dofs, const Cut &cut, int index) {
    before.resize(state.regions.size());
    for (std::size_t r = 0; r < before.size(); ++r)
      before[r] = state.regions[r].positions;
    set_shares(cut.seconds / shared.character.solver.dt);
    if (index + 1 < cut.count)
      interpolate_pose(shared.character.actor.skeleton, frame.dofs, dofs, (index + 1.0) / cut.count, ahead);
    else
      ahead = dofs;
    pose(shared, ahead, next);
  }
  /// Friction and damping are shares of a whole frame's.
  void set_shares(double frames) {
    step_materials = materials;
    for (pbd::Material &material : step_materials)
      for (double *share : {&material.k_friction, &material.k_damping})
        *share = frames == 1 ? *share : 1 - std::pow(1 - *share, frames);
  }
  /// After a piece of a step.
  void arrive(const Shared &shared, const Cut &cut) {
    const double seconds = cut.seconds;
    come_to_rest(shared, seconds);
    go_on_with_caught(shared, cut);
    std::swap(posed, next);
    if (shared.options.redrape_when_tangled && !looked && held_seconds >= kCaughtAfter)
      redrape_when_tangled(shared, seconds, kFreed);
    if (shared.options.redrape_when_tangled)
      watch(shared, seconds);
  }
  /// Caught in motion, the cloth is put on anew, or that is tried after one second, two, four, ...
  void watch(const Shared &shared, double seconds) {
    watched_seconds += seconds;
    if (watched_seconds < kWatchEvery)
      return;
    watched_seconds = 0;
    const bool is_caught = shared.caught_cloth.is_caught(state, posed, surfaces);
    looks_caught = is_caught ? looks_caught + 1 : 0;
    if (looks_caught > 1 && std::has_single_bit(looks_caught) && redrape_when_tangled(shared, seconds, kFreedInMotion))
      looks_caught = 0;
  }
  /// Real cloth rubs itself to rest, whatever its drag and damping are; ours would swing on like a pendulum.
  void come_to_rest(const Shared &shared, double seconds) {
    const bool held = farthest_joint(shared) / seconds < kStill && wind.isZero();
    held_seconds = held ? held_seconds + seconds : 0;
    looked = looked && held;
    const double share = std::clamp((held_seconds - kHeldAfter) / kRestGrows, 0.0, 1.0);
    if (share > 0)
      for (pbd::ClothState &cloth : state.regions)
        cloth.velocities *= std::exp(-share * shared.options.rest_damping * seconds);
    const double still = kAlmostStill + kImpatient * std::max(0.0, held_seconds - kHeldAfter - kRestGrows);
    const bool almost_still = share == 1 && shared.options.rest_damping > 0 && cloth_way() / seconds < still;
    slow_seconds = almost_still ? slow_seconds + seconds : 0;
    if (slow_seconds > 0)
      stop(std::max(0.0, 1 - slow_seconds / kStops));
  }
  /// m, root of the mean square over the vertices in the step that ends.
  double cloth_way() const {
    double squares = 0;
    Eigen::Index count = 0;
    for (std::size_t r = 0; r < before.size(); ++r) {
      squares += (state.regions[r].positions - before[r]).squaredNorm();
      count += before[r].rows();
    }
    return std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(count, 1)));
  }
  /// Of what the cloth has moved in the step that ends a share is kept: contacts that never agree would push it about for good.
  void stop(double kept) {
    for (std::size_t r = 0; r < before.size(); ++r) {
      pbd::ClothState &cloth = state.regions[r];
      cloth.positions = before[r] + kept * (cloth.positions - before[r]);
      cloth.velocities *= kept;
    }
  }
  /// After a step of so many seconds: cloth that passes through itself, or has a limb through it, is put on anew if that is
  /// better, and what is drawn goes over to it within `freed` s. Was it?
  bool redrape_when_tangled(const Shared &shared, double seconds, double freed) {
    looked = true;
    const double faults = shared.caught_cloth.faults_of(state, posed);
    if (faults == 0)
      return false;
    CharacterState anew = drape_along(shared, ahead);
    if (shared.caught_cloth.faults_of(anew, posed) >= faults)
      return false;
    std::swap(caught, state);
    state = std::move(anew);
    move_as_skin(shared, seconds);
    caught_seconds = caught_for = freed;
    wake();
    looked = true;
    return true;
  }
  /// Cloth that stood still would be left behind by a body that moves on. `next` is where the step came from.
  void move_as_skin(const Shared &shared, double seconds) {
    for (std::size_t r = 0; r < state.regions.size(); ++r) {
      const std::vector<int> &vertices = shared.simulator.regions()[r].vertex_from_cloth;
      state.regions[r].velocities = (posed.skinned(vertices, Eigen::all) - next.skinned(vertices, Eigen::all)) / seconds;
    }
  }
  /// What was caught is simulated until it is no longer seen.
  void go_on_with_caught(const Shared &shared, const Cut &cut) {
    if (caught_seconds > 0) {
      CharacterState *const states[] = {&caught};
      const PosedFrame *const from[] = {&posed}, *const to[] = {&next};
      const std::vector<pbd::Material> *const of[] = {&step_materials};
      const StepEnvironment worlds[] = {environment(cut)};
      if (!shared.simulator.step_batch(states, from, to, of, worlds, 1).empty())
        caught_seconds = 0; // not finite
    }
    caught_seconds = std::max(0.0, caught_seconds - cut.seconds);
  }
  void draw_surface(const Shared &shared) {
    shared.simulator.surface(state, posed, frame.surface);
    const double left = caught_seconds / caught_for, share = left * left * (3 - 2 * left);
    for (std::size_t r = 0; share > 0 && r < caught.regions.size(); ++r) {
      const std::vector<int> &vertices = shared.simulator.regions()[r].vertex_from_cloth;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        auto drawn = frame.surface.row(vertices[i]);
        drawn += share * (caught.regions[r].positions.row(static_cast<Eigen::Index>(i)) - drawn);
      }
    }
  }
  /// Something has changed for the cloth: it moves again.
  void wake() {
    held_seconds = slow_seconds = 0;
    looked = false;
  }
  /// The cloth is another.
  void start_over() {
    wake();
    watched_seconds = 0;
    looks_caught = 0;
    caught_seconds = 0;
  }
  double farthest_joint(const Shared &shared) const { // m, in the step that ends
    double far = 0;
    const std::vector<Joint> &joints = shared.character.actor.skeleton.joints;
    for (std::size_t j = 0; j < joints.size(); ++j)
      far = std::max(far, (next.world_from_rest[j] * joints[j].rest - posed.world_from_rest[j] * joints[j].rest).norm());
    return far;
  }

  /// What is seen of the state.
  void show(const Shared &shared, const Eigen::VectorXd &dofs, int index) {
    const Character &character = shared.character;
    draw_surface(shared);
    if (!frame.surface.allFinite())
      throw Error("Player: the surface is not finite; expected a stable simulation");
    frame.index = index;
    frame.dofs = dofs;
    frame.world_from_rest = posed.world_from_rest;
    joint_positions(character.actor.skeleton, posed.world_from_rest, frame.joints);
    Vertices &body = shared.options.body ? frame.body : unseen_body;
    if (shared.body)
      shared.body->pose(posed.joints, body);
    if (lift_garment) {
      lifted = frame.surface;
      lift_garment->apply(body, lifted);
    }
    if (shared.display)
      shared.display->apply(lift_garment ? lifted : frame.surface, posed.joints, frame.high, display);
    if (tuck_body)
      tuck_body->apply(frame.surface, frame.body);
    if (tuck_skin)
      tuck_skin->apply(display, frame.high, frame.body);
  }

  std::vector<pbd::Material> materials, step_materials; ///< as given; of the step at hand
  std::vector<TaperedCapsule> proxies;
  Eigen::Vector3d wind = Eigen::Vector3d::Zero(), gravity;
  CharacterState state;
  PosedFrame posed, next;     ///< where it stands, and where it goes
  double held_seconds = 0;    ///< since the pose moved last
  double slow_seconds = 0;    ///< since the cloth is almost still in a held pose
  bool looked = false;        ///< whether the cloth is caught, since the pose or what pulls at the cloth changed last
  double watched_seconds = 0; ///< since the cloth was last looked at in motion
  unsigned looks_caught = 0;  ///< in how many looks up to that one it was caught
  std::vector<Mesh> surfaces; ///< of each region, for a while
  CharacterState caught;      ///< the cloth that was, and how long it will still be seen, of how long
  double caught_seconds = 0, caught_for = kFreed;
  std::vector<Vertices> before; ///< of each region, at the start of the step
  Eigen::VectorXd ahead;        ///< the pose that the step at hand goes to
  StepBuffers buffers;
  DisplayBuffers display;
  Vertices unseen_body; ///< posed, where the frame has none
  Vertices lifted;      ///< M, the garment lifted off the body
  std::optional<GarmentPenetrationFix> lift_garment;
  std::optional<BodyPenetrationFix> tuck_body;
  std::optional<SkinPenetrationFix> tuck_skin;
  AnimationFrame frame;
};

Player::Player(Character character, const AnimateOptions &options, const pbd::ClothSolverFactory &make_solver)
    : shared_(std::make_shared<const Shared>(std::move(character), options, make_solver)),
      playing_(std::make_unique<Playing>(*shared_)) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(shared_->character.actor.skeleton.dof_count());
  playing_->pose(*shared_, rest, playing_->posed);
  playing_->state = shared_->simulator.start(playing_->posed);
  playing_->show(*shared_, rest, 0);
}
Player::~Player() = default;
Player::Player(const Player &other) : shared_(other.shared_), playing_(std::make_unique<Playing>(*other.playing_)) {}
Player &Player::operator=(const Player &other) {
  return *this = Player(other);
}
Player::Player(Player &&) noexcept = default;
Player &Player::operator=(Player &&) noexcept = default;

const AnimationFrame &Player::reset(const Eigen::VectorXd &dofs) {
  require_pose(character(), dofs);
  Playing &p = *playing_;
  p.pose(*shared_, dofs, p.posed);
  p.start_over();
  p.state = shared_->options.settle_seconds > 0 ? p.drape_along(*shared_, dofs) : shared_->simulator.start(p.posed);
  const StepEnvironment world = p.whole_frames(*shared_);
  const auto frames = std::lround(shared_->options.settle_seconds / world.dt);
  for (long i = 0; i < frames; ++i)
    shared_->simulator.step(p.state, p.posed, p.posed, p.materials, world, p.buffers);
  for (pbd::ClothState &cloth : p.state.regions)
    cloth.velocities.setZero();
  p.show(*shared_, dofs, 0);
  return p.frame;
}

const AnimationFrame &Player::step(const Eigen::VectorXd &dofs) {
  return step(dofs, character().solver.dt);
}

const AnimationFrame &Player::step(const Eigen::VectorXd &dofs, double seconds) {
  const Cut cut = cut_step(character().solver, seconds);
  require_pose(character(), dofs);
  Playing &p = *playing_;
  for (int i = 0; i < cut.count; ++i) {
    p.aim(*shared_, dofs, cut, i);
    shared_->simulator.step(p.state, p.posed, p.next, p.step_materials, p.environment(cut), p.buffers);
    p.arrive(*shared_, cut);
  }
  p.show(*shared_, dofs, p.frame.index + 1);
  return p.frame;
}

const AnimationFrame &Player::teleport(const Eigen::VectorXd &dofs) {
  require_pose(character(), dofs);
  Playing &p = *playing_;
  p.pose(*shared_, dofs, p.next);
  shared_->simulator.move_rigidly(p.state, p.posed, p.next);
  if (p.caught_seconds > 0)
    shared_->simulator.move_rigidly(p.caught, p.posed, p.next);
  std::swap(p.posed, p.next);
  p.wake();
  p.show(*shared_, dofs, p.frame.index + 1);
  return p.frame;
}

const AnimationFrame &Player::frame() const {
  return playing_->frame;
}
const Character &Player::character() const {
  return shared_->character;
}

void Player::set_materials(const std::vector<pbd::Material> &materials) {
  const std::size_t expected = shared_->simulator.regions().size();
  if (materials.size() != expected)
    throw std::invalid_argument("Player: expected " + std::to_string(expected) + " materials, one per cloth region, found " +
                                std::to_string(materials.size()));
  for (const pbd::Material &material : materials)
    pbd::validate(material);
  playing_->materials = materials;
  playing_->wake();
}
void Player::set_wind(const Eigen::Vector3d &wind) {
  require_vector(wind, 1000, "a wind", "m/s");
  if (wind != playing_->wind)
    playing_->wake();
  playing_->wind = wind;
}
void Player::set_gravity(const Eigen::Vector3d &gravity) {
  require_vector(gravity, kMostGravity, "a gravity", "m/s^2");
  if (gravity != playing_->gravity)
    playing_->wake();
  playing_->gravity = gravity;
}
void Player::set_proxies(const std::vector<TaperedCapsule> &proxies) {
  require_proxies(proxies, character().actor.skeleton, "Player");
  playing_->proxies = proxies;
  playing_->wake();
  playing_->set_capsules(*shared_, playing_->posed);
}
const std::vector<pbd::Material> &Player::materials() const {
  return playing_->materials;
}
const Eigen::Vector3d &Player::wind() const {
  return playing_->wind;
}
const Eigen::Vector3d &Player::gravity() const {
  return playing_->gravity;
}
const std::vector<TaperedCapsule> &Player::proxies() const {
  return playing_->proxies;
}

const CharacterState &Player::state() const {
  return playing_->state;
}
void Player::set_state(const CharacterState &state) {
  shared_->simulator.require_state(state, "Player::set_state");
  for (const pbd::ClothState &cloth : state.regions)
    if (!cloth.positions.allFinite() || !cloth.velocities.allFinite())
      throw std::invalid_argument("Player::set_state: expected finite positions and velocities, found NaN or infinity");
  playing_->state = state;
  playing_->start_over();
  playing_->show(*shared_, playing_->frame.dofs, playing_->frame.index);
}

void step_players(std::span<Player *const> players, std::span<const Eigen::VectorXd> dofs, double seconds, int threads) {
  if (players.empty() && dofs.empty())
    return;
  if (players.size() != dofs.size())
    throw std::invalid_argument("step_players: expected a pose for each player, found " + std::to_string(dofs.size()) +
                                " poses and " + std::to_string(players.size()) + " players");
  std::vector<Player *> distinct(players.begin(), players.end());
  std::sort(distinct.begin(), distinct.end());
  if (std::adjacent_find(distinct.begin(), distinct.end()) != distinct.end())
    throw std::invalid_argument("step_players: expected every player once, found one twice");
  const Player::Shared &shared = *players[0]->shared_;
  for (std::size_t i = 0; i < players.size(); ++i) {
    if (players[i]->shared_.get() != &shared)
      throw std::invalid_argument("step_players: expected copies of one player, found player " + std::to_string(i) +
                                  " of another character");
    require_pose(shared.character, dofs[i]);
    const std::size_t proxies = players[i]->proxies().size(), first = players[0]->proxies().size();
    if (proxies != first)
      throw std::invalid_argument("step_players: expected as many proxies of every player, found " + std::to_string(proxies) +
                                  " of player " + std::to_string(i) + " and " + std::to_string(first) + " of the first");
  }
  const Cut cut = cut_step(shared.character.solver, seconds);
  Context context;
  context.threads = std::max(1, threads);
  std::vector<int> moving(players.size()); // those whose cloth is finite
  std::iota(moving.begin(), moving.end(), 0);
  const auto in_parallel = [&](const std::function<void(Player::Playing &, const Eigen::VectorXd &)> &work) {
    parallel_for(context, static_cast<int>(moving.size()), [&](int k) { work(*players[moving[k]]->playing_, dofs[moving[k]]); });
  };
  for (int i = 0; i < cut.count; ++i) {
    in_parallel([&](Player::Playing &p, const Eigen::VectorXd &to) { p.aim(shared, to, cut, i); });
    std::vector<CharacterState *> states;
    std::vector<const PosedFrame *> before, after;
    std::vector<const std::vector<pbd::Material> *> materials;
    std::vector<StepEnvironment> worlds;
    for (const int k : moving) {
      Player::Playing &p = *players[k]->playing_;
      states.push_back(&p.state);
      before.push_back(&p.posed);
      after.push_back(&p.next);
      materials.push_back(&p.step_materials);
      worlds.push_back(p.environment(cut));
    }
    std::vector<char> failed(moving.size(), 0);
    for (const DivergedRegion &one : shared.simulator.step_batch(states, before, after, materials, worlds, context.threads))
      failed[one.character] = 1;
    std::vector<int> going_on;
    for (std::size_t k = 0; k < moving.size(); ++k)
      if (!failed[k]) {
        players[moving[k]]->playing_->arrive(shared, cut);
        going_on.push_back(moving[k]);
      }
    moving.swap(going_on);
  }
  in_parallel([&](Player::Playing &p, const Eigen::VectorXd &to) { p.show(shared, to, p.frame.index + 1); });
  for (int k = 0; k < static_cast<int>(players.size()); ++k)
    if (!std::binary_search(moving.begin(), moving.end(), k))
      throw Error("step_players: the cloth of player " + std::to_string(k) +
                  " came out with a position or velocity that is not finite; expected a stable simulation");
}

} // namespace doublet
