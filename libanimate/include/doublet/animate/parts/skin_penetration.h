#pragma once
// The person's skin, kept from showing through a garment as it is drawn.

#include "doublet/animate/display_surface.h"
#include "doublet/core/parts/moving_surface.h"

#include <array>

namespace doublet {

/// Brings what is drawn of the person near a garment under it, where it stands out by up to 6 cm: the hidden body, and the scan's
/// skin up to 30 cm beyond the garment's free edges along itself, as legs below a hem; 10 mm deep, less where the garment hangs.
/// Beyond a free edge it may stand out by as much as it is away from it, so that no fringe of skin covers the edge. Faces that
/// bridge a fold of the garment go under it with their corners. Capsules, which keep the simulated cloth off, are simpler than
/// legs. A matter of display only.
class SkinPenetrationFix {
public:
  /// The character must have M_high with a garment, else Error.
  explicit SkinPenetrationFix(const Character &character);
  /// `drawn` and `high` as DisplaySurface::apply() has left them, `body` (B, 3) or empty; once warm, nothing is allocated.
  void apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body);

private:
  enum class Edge : std::uint8_t { Inner, Free, Seam };
  struct Tucked {
    int vertex;
    int last = -1;                                    ///< the face of the garment that was closest before; -1 = none
    double moved = 0;                                 ///< m, for faces across folds
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< of the garment there; 0 = none
  };
  /// By how much a point is to move, along `normal`, the garment's there.
  double outside(const Eigen::Vector3d &point, const Vertices &normals, int &last, Eigen::Vector3d &normal) const;
  void tuck(const Vertices &normals, std::vector<Tucked> &vertices, Vertices &positions) const;
  void tuck_across_folds(const Vertices &normals, Vertices &positions);

  std::vector<Tucked> skin_, body_;        ///< of M_high, of the body
  Faces skin_faces_;                       ///< between those of M_high, numbers into skin_
  Faces faces_;                            ///< of the garment as it is drawn
  Eigen::VectorXd depths_;                 ///< m under each of its vertices
  std::vector<std::array<Edge, 3>> edges_; ///< (F) opposite each corner
  MovingSurface garment_;
};

} // namespace doublet
