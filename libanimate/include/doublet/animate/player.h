#pragma once
// A character that is moved as it is watched: a pose in, a surface out, a frame at a time (Sect. 6.1 and 7). For games and
// viewers; animate() plays whole clips with it.

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
               "animate() turns shoulders so far that forearms and hands are clear of the body, with room for cloth",
               "Another person's clip presses the arms into a wider body. A player takes its poses as they are"),
        option(&O::resolve_body_penetration, "resolve_body_penetration",
               "The body is drawn under the surface where it would stand out of it",
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

/// What it costs and how it is used in a game's loop: docs/player.md. Not to be used from two threads at once; a copy is a
/// character of its own, which shares what never changes.
class Player {
public:
  /// Throws Error naming the part that does not fit. make_solver: as of CharacterSimulator. Stands in the rest pose, cloth at
  /// rest there but not settled: begin with reset().
  explicit Player(Character character, const AnimateOptions &options = {}, const pbd::ClothSolverFactory &make_solver = {});
  ~Player();
  Player(const Player &);
  Player &operator=(const Player &);
  Player(Player &&) noexcept;
  Player &operator=(Player &&) noexcept;

  // A pose is dofs (D), as a Motion has them; std::invalid_argument unless it is that long and finite. Each of these returns
  // frame(). Error if the cloth comes out not finite: it then stays where it last was, which may be within the step, and reset()
  // helps. Once warm, nothing is allocated.

  /// Begins anew in this pose: the cloth, put on in the rest pose, falls into place for AnimateOptions::settle_seconds. If that
  /// is 0, it is its rest shape carried to this pose.
  const AnimationFrame &reset(const Eigen::VectorXd &dofs);
  /// Goes on to this pose in the character's own time step, Character::solver.dt.
  const AnimationFrame &step(const Eigen::VectorXd &dofs);
  /// Goes on to this pose in `seconds`, in (0, 1], in steps as near as can be to the substeps for which the material was
  /// estimated (dt / substeps, 1/160 s by default), the pose interpolated: so the cloth moves alike at every frame rate.
  const AnimationFrame &step(const Eigen::VectorXd &dofs, double seconds);
  /// Stands in this pose at once; the cloth is carried along with the root as one rigid body, with its speed.
  const AnimationFrame &teleport(const Eigen::VectorXd &dofs);

  const AnimationFrame &frame() const; ///< the last
  const Character &character() const;  ///< as it was given

  // What may change between two steps. std::invalid_argument if a value is none, and nothing has changed.
  void set_materials(const std::vector<pbd::Material> &materials); ///< one per cloth region
  void set_wind(const Eigen::Vector3d &wind);                      ///< m/s
  void set_gravity(const Eigen::Vector3d &gravity);                ///< m/s^2, within 1000
  void set_proxies(const std::vector<TaperedCapsule> &proxies);    ///< Error if one names no joint of the skeleton
  const std::vector<pbd::Material> &materials() const;
  const Eigen::Vector3d &wind() const;
  const Eigen::Vector3d &gravity() const;
  const std::vector<TaperedCapsule> &proxies() const;

  /// Positions and velocities of the cloth: keep them to go back. set_state() throws std::invalid_argument unless they are of
  /// this character, and finite; it moves the cloth alone, not the pose.
  const CharacterState &state() const;
  void set_state(const CharacterState &state);

private:
  struct Shared;
  struct Playing;
  friend void step_players(std::span<Player *const>, std::span<const Eigen::VectorXd>, double, int);
  std::shared_ptr<const Shared> shared_;
  std::unique_ptr<Playing> playing_;
};

/// player.step(dofs, seconds) for copies of one player, side by side in the lanes of the processor's registers and on up to
/// `threads` threads, with the same bits. Throws std::invalid_argument unless all are copies of one with as many proxies, there
/// is a pose for each and none is there twice; Error naming the first whose cloth came out not finite, after the others have been
/// stepped: that one stays where it last was.
void step_players(std::span<Player *const> players, std::span<const Eigen::VectorXd> dofs, double seconds, int threads = 1);

} // namespace doublet
