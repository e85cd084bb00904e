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
  bool free_caught = true;
  bool high = true;
  bool body = true;
  bool tuck_body = true;
  static constexpr auto describe() {
    using namespace options;
    using O = AnimateOptions;
    return Description{
        "AnimateOptions",
        option(&O::settle_seconds, "settle_seconds", Range{0, 60}, "s",
               "the cloth falls into place in the first pose before the animation starts"),
        option(
            &O::rest_damping, "rest_damping", Range{0, 100}, "1/s",
            "of the cloth while the pose is held, in still air: from 0.25 s after the last motion it grows to this within 1 s; "
            "0 = off"),
        option(
            &O::edge_collision, "edge_collision",
            "edges of the cloth collide with edges, too, and cloth that has passed through itself is moved apart, whatever the "
            "character's solver says"),
        option(
            &O::free_caught, "free_caught",
            "when the pose has been held for 0.75 s, cloth that passes through itself (more than 0.5 % of its faces) or has a "
            "limb through it is put on anew, if that is better, and drawn on its way there for 0.5 s; in motion, cloth that is "
            "all in a knot for 0.5 s"),
        option(&O::high, "high", "also M_high"),
        option(&O::body, "body", "also the body under the clothes"),
        option(&O::tuck_body, "tuck_body",
               "draw the body under the surface where it stands out: proxies are simpler, so cloth may rest a little inside it"),
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
  // frame(). Error if the cloth comes out not finite: it then stays as it was, and reset() helps. Once warm, nothing is
  // allocated.

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
  void set_materials(const std::vector<pbd::Material> &materials); ///< one a cloth region
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
/// `threads` threads, with the same bits. Throws std::invalid_argument unless all are copies of one, there is a pose for each and
/// none is there twice; Error naming the first whose cloth came out not finite, after the others have been stepped: that one
/// stays as it was.
void step_players(std::span<Player *const> players, std::span<const Eigen::VectorXd> dofs, double seconds, int threads = 1);

} // namespace doublet
