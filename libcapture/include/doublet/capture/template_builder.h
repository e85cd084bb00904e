#pragma once
// Scan -> rigged template (Sect. 4): Poisson closing, suggestion of invalid triangles, decimation, skeleton, heat weights.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <vector>

namespace doublet {

struct TemplateOptions {
  int triangles = 5000;       ///< of M, as in the paper
  int high_triangles = 25000; ///< of M_high, for display
  int poisson_depth = 9;      ///< octree depth of the Poisson reconstruction
  double hole_gap =
      0.004; ///< m; a reconstructed point farther than this from the scan's surface lies over a hole (a scan is good to 1-2 mm)
  double density_drop =
      0.5; ///< octree levels; and the scan is this much sparser there than usual (one level = a quarter of the samples)
  double narrow_hole = 0.01; ///< m; parts of a hole narrower than this (unseen folds that run into the hem) stay valid
  double large_hole =
      0.025; ///< m^2; holes from this size on are suggested as invalid: more than a foot's sole, which is rightly closed
  double sheet_hole =
      0.005;             ///< m^2; so are holes from this size on that have two rims or more (garment and limb): a sheet at a hem
  void validate() const; ///< throws std::invalid_argument
};

/// The closed surface and its decimations.
struct Template {
  Mesh mesh, high;                                       ///< M and M_high
  std::vector<std::uint8_t> face_valid, high_face_valid; ///< 0 = suggested as invented over a large hole
  double invalid_area = 0;                               ///< m^2 of M
};

Template build_template(const Mesh &scan, const TemplateOptions &options = {}, const Context &context = {});

struct HeatWeightOptions {
  double c = 1.0; ///< H_ii = c / d^2, Baran & Popovic 2007
};
/// (V, J) skin weights by heat equilibrium, nearest visible bone(s); rows sum to one, no entry is negative.
MatrixRM heat_weights(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const Skeleton &skeleton,
                      const HeatWeightOptions &options = {}, const Context &context = {});

/// Everything at once: template, skeleton from the marks, weights.
RiggedMesh rig_template(const Template &surface, const std::vector<JointMark> &joints, const Context &context = {});

/// .ply, .obj, .stl, .off (Open3D). Throws FileNotFound or Error naming the file.
Mesh read_mesh(const std::filesystem::path &path);
void write_mesh(const std::filesystem::path &path, const Mesh &mesh);

} // namespace doublet
