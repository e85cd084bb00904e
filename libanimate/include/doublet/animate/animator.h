#pragma once
// Animates a character with a motion (Sect. 7).

#include "doublet/animate/motion.h"
#include "doublet/animate/player.h"

#include <functional>
#include <utility>

namespace doublet {

/// Resamples the motion to the character's own rate 1/dt, for which its material was estimated, plays it with a Player, and calls
/// `frame` once per frame, in order; no frame is kept. make_solver: as in CharacterSimulator. Throws Error naming the frame if
/// the cloth is no longer finite. Returns the number of frames.
int animate(const Character &character, const Motion &motion, const AnimateOptions &options,
            const std::function<void(const AnimationFrame &)> &frame, const Context &context = {},
            const pbd::ClothSolverFactory &make_solver = {});

/// (B, 3) the body of a frame, moved under the surface (V, 3) as BodyPenetrationFix does (parts/body_penetration.h).
Vertices resolve_body_penetration(const Character &character, const Vertices &surface, Vertices body);

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

// Deprecated names.
template <class... A> [[deprecated("use resolve_body_penetration")]] decltype(auto) tuck_body(A &&...a) {
  return resolve_body_penetration(std::forward<A>(a)...);
}

} // namespace doublet
