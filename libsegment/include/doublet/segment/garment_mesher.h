#pragma once
// The garment's own mesh: regular triangles, clean loops, no slits.

#include "doublet/core/context.h"
#include "doublet/core/garment.h"
#include "doublet/options/options.h"

#include <memory>

namespace doublet {

struct GarmentOptions {
  bool remesh = true;
  int vertices = 1400;
  double closing_length = 0.015;
  double min_hole_area = 0.02;
  double min_piece_area = 0.08;
  double min_edge_run = 0.15;
  /// Cloth hardly stretches, but folds: the rest length of an edge is the captured length that it exceeds in this share of the
  /// frames. Which share is right depends on the noise of the tracking and on how long the motion spreads the garment out, so one
  /// rest shape per share is made, and the material search chooses among them.
  std::vector<double> length_exceedances = {0.1, 0.15, 0.2, 0.3, 0.45};
  double attachment_width = 0.0;
  double snug_slack = 0.02;
  static constexpr auto describe() {
    using namespace options;
    using O = GarmentOptions;
    return Description{
        "GarmentOptions",
        option(&O::remesh, "remesh", "Cloth gets a regular mesh of its own; off = it is a part of the template, as in the paper"),
        option(&O::vertices, "vertices", Range{50, 200000}, "", "Approximate number of vertices of all regions together",
               "More fold finer and cost more"),
        option(&O::closing_length, "closing_length", Range{0, 1}, "m",
               "Length scale of the diffusion that decides what is garment",
               "Narrower slits are closed, and hems come out smooth"),
        option(&O::min_hole_area, "min_hole_area", Range{0, 10}, "m^2", "Smaller holes of the garment are filled", "14 x 14 cm"),
        option(&O::min_piece_area, "min_piece_area", Range{0, 10}, "m^2", "Smaller pieces move as skin",
               "28 x 28 cm, about a short sleeve"),
        option(&O::min_edge_run, "min_edge_run", Range{0, 10}, "m",
               "Shorter parts of the boundary take their neighbours' state (attached or free); waves are smoothed",
               "They are noise of the template's mask"),
        option(&O::length_exceedances, "length_exceedances", Range{0, 1, Open::Both}, "",
               "Shares of the frames in which an edge may be longer than at rest, one per width; larger is narrower",
               "The material search chooses the width that moves as in the video"),
        option(&O::attachment_width, "attachment_width", Range{0, 1}, "m",
               "Width of the band across which cloth goes from attached to free; 0 = a seam"),
        option(&O::snug_slack, "snug_slack", Range{0, 1}, "m",
               "The body carries cloth that is farther off in under 5 % of the frames; 0 = all cloth hangs free",
               "95 % of clinging cloth is captured below 21 mm, 95 % of a skirt or loose trouser legs above 20"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// The swap point: cloth of the template in, a garment's own mesh out.
/// Threads: mesh() is const and may be called from several at once.
class GarmentMesher {
public:
  virtual ~GarmentMesher() = default;
  /// actor and segmentation: of the template; body: under it, in the scan pose (may be empty), tells skin from cloth where a hem
  /// brushes it; captured: the template's surface in all frames (may be empty). Throws std::invalid_argument if they do not
  /// belong together, Error on an unusable mesh. Without cloth that hangs free, or with remesh off, a garment without vertices.
  virtual Garment mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
                       const Context &context) const = 0;
  static std::unique_ptr<GarmentMesher> create(const GarmentOptions &options = {});
};

Garment mesh_garment(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
                     const GarmentOptions &options = {}, const Context &context = {});

/// Numbers of a garment's mesh that can disappoint.
struct GarmentSummary {
  int vertices = 0, faces = 0, regions = 0;
  int loops = 0;             ///< boundaries; a skirt has two
  int hanging_loops = 0;     ///< that hang on the skeleton, at least in part
  double mean_edge = 0;      ///< m
  double smallest_angle = 0; ///< degrees, 1 % quantile over the triangles
};
GarmentSummary summarise_garment(const Garment &garment);

} // namespace doublet
