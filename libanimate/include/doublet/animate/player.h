#pragma once
// Interactive simulation of a character: a pose in, a surface out, one frame at a time (Sect. 6.1 and 7). For games and viewers;
// animate() plays whole clips with it.

#include "doublet/animate/character.h"
#include "doublet/options/options.h"
#include "doublet/pbd/cloth_solver.h"
#include "doublet/simulate/character_simulator.h"

#include <memory>
#include <optional>
#include <span>

namespace doublet {

struct AnimateOptions {
  double settle_seconds = 1.0;
  double rest_damping = 6.0;
  bool edge_collision = true;
  bool redrape_when_tangled = true;
  bool high = true;
  bool body = true;
  bool resolve_arm_penetration = true;
  bool resolve_body_penetration = true;
  static constexpr auto describe() {
    using namespace options;
    using O = AnimateOptions;
    return Description{
        "AnimateOptions",
        option(&O::settle_seconds, "settle_seconds", Range{0, 60}, "s",
               "The cloth falls into place in the first pose for this long before the animation starts"),
        option(&O::rest_damping, "rest_damping", Range{0, 100}, "1/s",
               "Damping of cloth in still air that is reached within 1 s while a pose is held; 0 = off",
               "It grows from 0.25 s after the last motion on"),
        option(&O::edge_collision, "edge_collision", "Edges of the cloth collide with edges, and crossings are moved apart",
               "Whatever the character's solver says"),
        option(&O::redrape_when_tangled, "redrape_when_tangled",
               "The garment is draped anew when it is tangled, in a held pose or for long in motion",
               "When a pose is held for 0.75 s and over 0.5 % of the faces cross or a limb is through the cloth; in motion, when "
               "it is all in a knot or a bone is through it for 0.5 s. The new state is used if it is better, and blended in "
               "over 0.5 s, in motion over 0.1 s"),
        option(&O::high, "high", "The animation has the display surface M_high, too"),
        option(&O::body, "body", "The animation has the body under the clothes, too"),
        option(&O::resolve_arm_penetration, "resolve_arm_penetration",
               "animate() turns the shoulders until forearms and hands are clear of the body, with room for cloth",
               "Another person's clip presses the arms into a wider body. Player leaves its poses as they are"),
        option(&O::resolve_body_penetration, "resolve_body_penetration",
               "The drawn body is moved under the surface where it would protrude",
               "Proxies are simpler than the body, so cloth may rest a little inside it"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

struct AnimationFrame {
  int index = 0;
  Eigen::VectorXd dofs;       ///< (D)
  Transforms world_from_rest; ///< (J)
  Vertices joints;            ///< (J, 3) m
  Vertices surface;           ///< (V, 3) M
  Vertices high;              ///< (VH, 3) M_high, or empty
  Vertices body;              ///< (B, 3), or empty
};

/// Cost, and use in the loop of a game: docs/player.md. Not to be used from two threads at once; a copy is independent and shares
/// only what never changes.
class Player {
public:
  /// Starts in the rest pose, with the cloth at rest there but not settled: begin with reset(). make_solver: as in
  /// CharacterSimulator. Throws Error naming the part that does not fit.
  explicit Player(Character character, const AnimateOptions &options = {}, const pbd::ClothSolverFactory &make_solver = {});
  ~Player();
  Player(const Player &);
  Player &operator=(const Player &);
  Player(Player &&) noexcept;
  Player &operator=(Player &&) noexcept;

  // A pose is dofs (D), a row of Motion::dofs. Each of these returns frame(). They throw std::invalid_argument unless the pose
  // has D finite values, and Error if the cloth is not finite after a step: it then stays where it last was, which may be within
  // the step, and reset() recovers. After the first calls nothing is allocated.

  /// Restarts in this pose: the cloth is draped from the rest pose to it and settles for AnimateOptions::settle_seconds. If that
  /// is 0, it is its skinned rest shape.
  const AnimationFrame &reset(const Eigen::VectorXd &dofs);
  /// Advances to this pose by the character's own time step, Character::solver.dt.
  const AnimationFrame &step(const Eigen::VectorXd &dofs);
  /// Advances to this pose by `seconds`, in (0, 1], interpolating the pose, in steps as close as possible to the substeps for
  /// which the material was estimated (dt / substeps, 1/160 s by default): so the cloth moves alike at every frame rate.
  const AnimationFrame &step(const Eigen::VectorXd &dofs, double seconds);
  /// Jumps to this pose; the cloth and its velocities move rigidly with the root.
  const AnimationFrame &teleport(const Eigen::VectorXd &dofs);

  const AnimationFrame &frame() const; ///< the latest
  const Character &character() const;  ///< as it was given

  // What may change between two steps. They throw std::invalid_argument for an invalid value and then change nothing.
  void set_materials(const std::vector<pbd::Material> &materials); ///< one per cloth region
  void set_wind(const Eigen::Vector3d &wind);                      ///< m/s
  void set_gravity(const Eigen::Vector3d &gravity);                ///< m/s^2, within 1000
  void set_proxies(const std::vector<TaperedCapsule> &proxies);    ///< Error if one names no joint of the skeleton
  const std::vector<pbd::Material> &materials() const;
  const Eigen::Vector3d &wind() const;
  const Eigen::Vector3d &gravity() const;
  const std::vector<TaperedCapsule> &proxies() const;

  /// Positions and velocities of the cloth; keep a copy to return to it. set_state() sets the cloth, not the pose, and throws
  /// std::invalid_argument unless the state is finite and fits this character.
  const CharacterState &state() const;
  void set_state(const CharacterState &state);

private:
  struct Shared;
  struct Playing;
  friend void step_players(std::span<Player *const>, std::span<const Eigen::VectorXd>, double, int);
  std::shared_ptr<const Shared> shared_;
  std::unique_ptr<Playing> playing_;
};

/// player.step(dofs, seconds) for several copies of one player, side by side in the lanes of SIMD registers and on up to
/// `threads` threads, with the same bits. Throws std::invalid_argument unless all are copies of one player with the same number
/// of proxies, there is one pose for each and no player occurs twice; Error naming the first player whose cloth is not finite,
/// after the others have been stepped: its cloth stays where it last was.
void step_players(std::span<Player *const> players, std::span<const Eigen::VectorXd> dofs, double seconds, int threads = 1);

} // namespace doublet
