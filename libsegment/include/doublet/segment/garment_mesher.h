#pragma once
// The garment's own mesh: regular triangles, clean loops, no slits.

#include "doublet/core/context.h"
#include "doublet/core/garment.h"
#include "doublet/options/options.h"

#include <memory>

namespace doublet {

struct GarmentOptions {
  bool own_mesh = true;
  int vertices = 1400;
  double closing = 0.015;
  double smallest_hole = 0.02;
  double smallest_piece = 0.08;
  double smallest_edge = 0.15;
  /// Cloth hardly stretches, but folds: an edge is as long as the video shows it in this share of the time. How much of that is
  /// noise of the tracking, and how much of the motion the garment is spread out, differs from film to film, so that rest shapes
  /// of several shares are offered; the material search chooses the one that moves as filmed.
  std::vector<double> spreads = {0.1, 0.15, 0.2, 0.3, 0.45};
  double band = 0.0;
  static constexpr auto describe() {
    using namespace options;
    using O = GarmentOptions;
    return Description{
        "GarmentOptions",
        option(&O::own_mesh, "own_mesh",
               "off: the cloth is the loose part of the template, as in the paper, and as wide as its fullness"),
        option(&O::vertices, "vertices", Range{50, 200000}, "", "about, of all regions together; more fold finer and cost more"),
        option(&O::closing, "closing", Range{0, 1}, "m",
               "length scale of the diffusion that decides what is garment: narrower slits are closed, hems come out smooth"),
        option(&O::smallest_hole, "smallest_hole", Range{0, 10}, "m^2", "smaller holes are filled; 14 x 14 cm"),
        option(&O::smallest_piece, "smallest_piece", Range{0, 10}, "m^2",
               "smaller pieces move as skin; 28 x 28 cm, about a short sleeve"),
        option(&O::smallest_edge, "smallest_edge", Range{0, 10}, "m",
               "along the cut: shorter changes between hanging and free edge are noise of the template's mask"),
        option(&O::spreads, "spreads", Range{0, 1, Open::Both}, "",
               "shares of the time that a length may be exceeded: a width each, of which the video chooses; more is narrower"),
        option(&O::band, "band", Range{0, 1}, "m",
               "width of the attachment: across it cloth goes from following the skeleton to free; 0 = a seam"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

class GarmentMesher {
public:
  virtual ~GarmentMesher() = default;
  /// actor and segmentation: of the template; body: under it, in the scan pose (may be empty), tells skin from cloth where a hem
  /// brushes it; captured: the template's surface in all frames (may be empty). Throws std::invalid_argument if they do not
  /// belong together, Error on an unusable mesh. Without cloth, or with own_mesh off, a garment without vertices.
  virtual Garment mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
                       const Context &context) const = 0;
  static std::unique_ptr<GarmentMesher> create(const GarmentOptions &options = {});
};

Garment mesh_garment(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
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
