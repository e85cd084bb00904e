#pragma once
// Keeps the body under the clothes from showing through them.

#include "doublet/animate/character.h"
#include "doublet/core/parts/moving_surface.h"

namespace doublet {

/// Moves the vertices of the body's drawn faces under the surface where they protrude: under cloth from up to 6 cm outside to 10
/// mm deep; under skin, which the body was fitted to with such an error, from up to 12 mm outside to 3 mm deep. Affects only what
/// is drawn; it is needed because collision proxies are simpler than a body.
class BodyPenetrationFix {
public:
  explicit BodyPenetrationFix(const Character &character);
  /// surface (V, 3) M in a pose, body (B, 3) in the same; once warm, nothing is allocated.
  void apply(const Vertices &surface, Vertices &body);

private:
  Faces faces_;               ///< of M
  Eigen::VectorXd clothness_; ///< (V)
  std::vector<int> drawn_;    ///< vertices of the body ...
  std::vector<int> last_;     ///< ... and the face that was closest to each in the frame before; -1 = none
  MovingSurface surface_;
  Vertices normals_; ///< (V, 3) sums of the area vectors around
};

} // namespace doublet
