#pragma once
// The person's skin, kept from showing through a garment as it is drawn.

#include "doublet/animate/display_surface.h"
#include "doublet/core/parts/moving_surface.h"

namespace doublet {

/// Brings what is drawn of the person near a garment under it, where it stands out by up to 6 cm: the hidden body, and the scan's
/// skin up to 30 cm beyond the garment's free edges along itself, as legs below a hem; 10 mm deep, less where the garment hangs.
/// Beyond a free edge it may stand out by as much as it is away from it, so that no fringe of skin covers the edge. Capsules,
/// which keep the simulated cloth off, are simpler than legs. A matter of display only.
class SkinPenetrationFix {
public:
  /// The character must have M_high with a garment, else Error.
  explicit SkinPenetrationFix(const Character &character);
  /// `drawn` and `high` as DisplaySurface::apply() has left them, `body` (B, 3) or empty; once warm, nothing is allocated.
  void apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body);

private:
  struct Tucked {
    int vertex;
    int last = -1; ///< the face of the garment that was closest in the frame before; -1 = none
  };
  void tuck(const Vertices &normals, std::vector<Tucked> &vertices, Vertices &positions) const;
  std::vector<Tucked> skin_, body_; ///< of M_high, of the body
  Faces faces_;                     ///< of the garment as it is drawn
  Eigen::VectorXd depths_;          ///< m under each of its vertices
  std::vector<std::array<std::uint8_t, 3>> edges_; ///< (F) is the edge opposite corner k a free one?
  MovingSurface garment_;
};

} // namespace doublet
