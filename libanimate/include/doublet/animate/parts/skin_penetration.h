#pragma once
// Keeps the person's skin from showing through the drawn garment.

#include "doublet/animate/display_surface.h"
#include "doublet/core/parts/moving_surface.h"

#include <array>
#include <optional>

namespace doublet {

/// Moves drawn skin under the garment where it protrudes by up to 3 cm: the hidden body, and the scan's skin up to 30 cm (along
/// the surface) beyond the garment's free boundary, such as legs below a hem. It ends 20 mm deep, less at the garment's boundary.
/// Beyond a free boundary it may protrude by as much as its distance from the boundary, so that no fringe of skin covers the hem.
/// Other skin, such as a back over which a skirt is thrown, goes 2 mm under cloth that lies up to 15 mm inside it. Only the part
/// of the garment that is worn over the same limb counts (left arm, right arm, the rest): a hand in front of a skirt is not under
/// it, nor a hip under a sleeve. Vertices move straight inwards and neighbours under the garment move along, so that no triangle
/// bridges a fold. Skin on which the garment lies inside out stays. Affects only what is drawn; a garment that lies deeper inside
/// the body must be lifted first, see GarmentPenetrationFix.
class SkinPenetrationFix {
public:
  /// How skin lies to a garment in the scan pose: covered by it, near its free boundary, or neither.
  enum class Cover : std::uint8_t { Worn, BeyondHem, Bare };
  /// The character must have M_high with a garment, else Error.
  explicit SkinPenetrationFix(const Character &character) : SkinPenetrationFix(character, DisplaySurface(character)) {}
  /// The same with the character's display surface, for callers that have made it.
  SkinPenetrationFix(const Character &character, const DisplaySurface &display);
  /// `drawn` and `high` as filled by DisplaySurface::apply(), `body` (B, 3) or empty; allocates nothing after the first call.
  void apply(const DisplayBuffers &drawn, Vertices &high, Vertices &body);

private:
  enum class Edge : std::uint8_t { Inner, Free, Seam, Cut };
  struct Tucked {
    int vertex;
    Cover cover;
    int limb;                                      ///< number of its sheet
    int last = -1;                                 ///< the face of the garment that was closest before; -1 = none
    bool covered = false;                          ///< it has garment before it, not merely beside it
    double in = 0;                                 ///< m, how far it goes inwards
    Eigen::Vector3d own = Eigen::Vector3d::Zero(); ///< its own normal
  };
  struct Part {
    std::vector<Tucked> vertices;
    Faces faces; ///< between them, numbers into them; so the edges
    std::vector<Eigen::Vector2i> edges;
    void bound(const Faces &all, Eigen::Index mesh_vertices);
    void find_normals(const Vertices &positions);
  };
  /// A point beside the garment.
  struct Beside {
    double out = 0;                  ///< m, by how much it stands out, along the normal
    bool covered = false;            ///< the garment's closest point is not of an edge
    Eigen::Vector3d normal{0, 0, 0}; ///< the garment's there; 0 = none is near
  };
  /// The part of the garment that is worn over a limb; no surface if none is.
  struct Sheet {
    std::optional<MovingSurface> surface;
    std::vector<std::array<Edge, 3>> edges; ///< (F) opposite each corner
  };
  void add_sheet(const Vertices &cloth, const Eigen::VectorXd &share, const EdgeTopology &topology,
                 const std::vector<std::array<Edge, 3>> &edges);
  Beside beside(const Sheet &sheet, const Eigen::Vector3d &point, const Vertices &normals, Cover cover,
                const Eigen::Vector3d &own, int &last) const;
  void find_way_in(const Vertices &normals, const Vertices &positions, Tucked &tucked) const;
  static void take_neighbours_along(Part &part, const Vertices &positions);
  void tuck(const Vertices &normals, Part &part, Vertices &positions) const;

  Part skin_, body_;          ///< of M_high, of the body
  Faces faces_;               ///< of the garment as it is drawn
  Eigen::VectorXd depths_;    ///< m under each of its vertices
  std::vector<Sheet> sheets_; ///< of it, over the rest of the person, the left arm, the right
};

} // namespace doublet
