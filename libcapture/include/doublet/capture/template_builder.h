#pragma once
// Scan -> rigged template (Sect. 4): Poisson closing, suggestion of invalid triangles, decimation, skeleton and weights.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <vector>

namespace doublet {

struct TemplateOptions {
  int triangles = 5000;
  int high_triangles = 25000;
  int poisson_depth = 9;
  double hole_gap = 0.004;
  double density_drop = 0.5;
  double narrow_hole = 0.03;
  double large_hole = 0.025;
  double sheet_hole = 0.005;
  static constexpr auto describe() {
    using namespace options;
    using O = TemplateOptions;
    return Description{
        "TemplateOptions",
        option(&O::triangles, "triangles", at_least(100), "", "Number of triangles of the template M", "As in the paper"),
        option(&O::high_triangles, "high_triangles", at_least(100), "",
               "Number of triangles of the display surface M_high, at least as many as of M"),
        option(&O::poisson_depth, "poisson_depth", Range{4, 12}, "", "Octree depth of the Poisson reconstruction",
               "9 = cells of 3.6 mm for a person"),
        option(&O::hole_gap, "hole_gap", above(0), "m",
               "A reconstructed point lies over a hole if it is farther than this from the scan's surface",
               "A scan is good to 1 or 2 mm"),
        option(&O::density_drop, "density_drop", at_least(0), "octree levels",
               "A point lies over a hole if the scan is also this much sparser there than usual",
               "One level less means a quarter of the samples"),
        option(&O::narrow_hole, "narrow_hole", at_least(0), "m",
               "Narrower folds that open at the hem and were not scanned stay valid"),
        option(&O::large_hole, "large_hole", above(0), "m^2", "Holes from this size on are suggested as invalid",
               "More than the sole of a foot, which is closed correctly"),
        option(&O::sheet_hole, "sheet_hole", above(0), "m^2",
               "Holes with two borders or more are suggested as invalid from this size on",
               "Garment and limb: a closing surface at a hem"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// The closed surface and its decimations.
struct Template {
  Mesh mesh, high;                  ///< M and M_high
  Mask face_valid, high_face_valid; ///< 0 = suggested as invented over a large hole
};

Template build_template(const Mesh &scan, const TemplateOptions &options = {}, const Context &context = {});

/// Quality of one of the surfaces.
struct SurfaceQuality {
  int triangles = 0;
  int self_intersections = 0;                         ///< triangles that pass through another one
  double invalid_area = 0;                            ///< m^2
  double smallest_angle = 0, first_centile_angle = 0; ///< degrees; of the triangles' smallest angles, the least and the 1 % point
  double scan_mean = 0, scan_max = 0;                 ///< m, distance of the scan's vertices to the surface
  double mean_to_scan = 0,
         max_to_scan = 0; ///< m, distance of the valid surface (corners, middles of edges and faces) to the scan
};
struct TemplateSummary {
  SurfaceQuality mesh, high;
};
/// Measures a template, with its mask as it is now, against the scan that it was made from. The larger of scan_max and
/// max_to_scan is the Hausdorff distance of the valid surface, at the samples. Throws Error, or std::invalid_argument on a mask
/// of the wrong length.
TemplateSummary summarise_template(const Template &surface, const Mesh &scan, const Context &context = {});

/// template_suggestion.npz (docs/formats.md): the masks of both surfaces.
void write_template_suggestion(const std::filesystem::path &path, const Template &surface);

/// The whole rig: template, skeleton from the annotated joints, skin weights.
RiggedMesh rig_template(const Template &surface, const std::vector<JointAnnotation> &joints, const Context &context = {});

} // namespace doublet
