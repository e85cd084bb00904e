#pragma once
// The garment's own mesh: regular triangles, clean loops, no slits.

#include "doublet/core/context.h"
#include "doublet/core/garment.h"

#include <memory>

namespace doublet {

struct GarmentOptions {
  bool own_mesh = true; ///< off: the cloth is the part of the template that is loose, as in the paper
  int vertices = 1400;  ///< about, of all regions together; more fold finer and cost more
  /// m, length scale of the diffusion that decides what is garment: slits narrower than this are closed, hems come out smooth.
  double closing = 0.015;
  double smallest_hole = 0.02;  ///< m^2: holes that are smaller are filled (14 x 14 cm)
  double smallest_piece = 0.08; ///< m^2: pieces that are smaller move as skin (28 x 28 cm, about a short sleeve)
  /// m, along the cut between garment and skin: shorter changes between hanging and free edge are noise of the template's mask.
  double smallest_edge = 0.15;
  /// Cloth hardly stretches, but folds: an edge is as long as the video shows it in this share of the time (and the mesh as
  /// regular as it is when the garment is spread out). Less follows the tracking's errors.
  double spread = 0.15;
  double band = 0.0;     ///< m, width of the attachment: across it cloth goes from following the skeleton to free; 0 = a seam
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

class GarmentMesher {
public:
  virtual ~GarmentMesher() = default;
  /// actor and clothness: of the template; body: under it, in the scan pose (may be empty), tells skin from cloth where a hem
  /// brushes it; captured: the template's surface in all frames (may be empty). Throws std::invalid_argument if they do not
  /// belong together, Error on an unusable mesh. Without cloth, or with own_mesh off, a garment without vertices.
  virtual Garment mesh(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
                       const Context &context) const = 0;
  static std::unique_ptr<GarmentMesher> create(const GarmentOptions &options = {});
};

Garment mesh_garment(const RiggedMesh &actor, const Clothness &clothness, const Mesh &body, const MeshSequence &captured,
                     const GarmentOptions &options = {}, const Context &context = {});

/// What the mesher made; log it where a number can disappoint.
struct GarmentSummary {
  int vertices = 0, faces = 0, regions = 0;
  int loops = 0;             ///< boundaries; a skirt has two
  int hanging_loops = 0;     ///< that hang on the skeleton, at least in part
  double mean_edge = 0;      ///< m
  double smallest_angle = 0; ///< degrees, 1 % quantile over the triangles
};
GarmentSummary summarise_garment(const Garment &garment);

} // namespace doublet
