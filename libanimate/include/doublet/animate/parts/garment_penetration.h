#pragma once
// Keeps the garment from being drawn inside the body.

#include "doublet/animate/character.h"
#include "doublet/core/parts/moving_surface.h"

namespace doublet {

/// Lifts garment vertices that lie inside the fitted body to 4 mm above it: fully from depths up to 2 cm, partly from deeper
/// ones, not from more than 4 cm. Neighbouring vertices of the garment move along, and two that are lifted apart, as in a groin,
/// are both lifted less, so that an edge grows by at most 0.7 times its length; vertices where the garment is attached stay.
/// Needed because the capsules that the simulated cloth collides with are simpler than a body, most of all where it bends. Arms,
/// and bones without a capsule, lift nothing. Affects only what is drawn.
class GarmentPenetrationFix {
public:
  /// True if the character has a garment with a mesh of its own, and a body with faces that can lift it.
  static bool applies_to(const Character &character);
  /// Throws Error where it does not apply.
  explicit GarmentPenetrationFix(const Character &character);
  /// body (B, 3) in a pose, surface (V, 3) M in the same; once warm, nothing is allocated.
  void apply(const Vertices &body, Vertices &surface);

private:
  struct Lifted {
    int vertex;                                   ///< of M
    bool hangs;                                   ///< the garment hangs there
    int last = -1;                                ///< the face of the body that was closest before; -1 = none
    Eigen::Vector3d by = Eigen::Vector3d::Zero(); ///< m
  };
  /// Between two of garment_.
  struct Edge {
    int a, b;
    double rest; ///< m
  };
  double slope(const Edge &edge, const Vertices &surface) const;
  void find_way_out(const Vertices &body, const Vertices &surface, Lifted &lifted) const;
  void take_neighbours_along(const Vertices &surface);
  void bring_neighbours_together(const Vertices &surface);

  std::vector<Lifted> garment_;
  std::vector<Edge> edges_;
  Faces body_faces_;
  MovingSurface body_;
};

} // namespace doublet
