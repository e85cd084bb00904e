#pragma once
// A character and a motion give a new animation (Sect. 7).

#include "doublet/animate/character.h"
#include "doublet/animate/motion.h"
#include "doublet/options/options.h"
#include "doublet/pbd/cloth_solver.h"

#include <functional>

namespace doublet {

struct AnimateOptions {
  double settle_seconds = 1.0;
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

/// Calls `frame` once a frame, in order, and keeps nothing. The motion is resampled to the character's own rate 1/dt first,
/// because its material holds for that step only. make_solver: as of CharacterSimulator. Throws Error naming the frame if the
/// simulation leaves the finite numbers. Returns the number of frames.
int animate(const Character &character, const Motion &motion, const AnimateOptions &options,
            const std::function<void(const AnimationFrame &)> &frame, const Context &context = {},
            const pbd::ClothSolverFactory &make_solver = {});

/// The body of a frame with the vertices of its drawn faces brought under the surface (V, 3) where they stand out of it: 10 mm
/// deep and from up to 6 cm outside under cloth; 3 mm deep and from up to 12 mm outside under skin, where the two are the same
/// surface, fitted with that error. A matter of display only.
Vertices tuck_body(const Character &character, const Vertices &surface, Vertices body);

/// The whole animation in memory.
struct AnimationResult {
  double fps = 0;
  MatrixRM dofs;                 ///< (T, D)
  std::vector<Vertices> surface; ///< T x (V, 3) M
  std::vector<Vertices> joints;  ///< T x (J, 3)
  std::vector<Vertices> high;    ///< T x (VH, 3), or empty
  std::vector<Vertices> body;    ///< T x (B, 3), or empty
};
AnimationResult animate(const Character &character, const Motion &motion, const AnimateOptions &options = {},
                        const Context &context = {}, const pbd::ClothSolverFactory &make_solver = {});

} // namespace doublet
