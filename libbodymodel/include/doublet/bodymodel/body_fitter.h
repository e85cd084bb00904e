#pragma once
// The body under the clothes (Sect. 5): fit of the statistical model to the exposed skin.

#include "doublet/bodymodel/body_model.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

struct BodyFitOptions {
  int iterations = 20;
  double landmark_deviation = 0.015;
  double joint_deviation = 0.025;
  double surface_deviation = 0.004;
  double scale_deviation = 0.03;
  double outlier_scale = 0.010;
  double cloth_margin = 0.003;
  double cloth_attraction = 0.03;
  static constexpr auto describe() {
    using namespace options;
    using O = BodyFitOptions;
    return Description{
        "BodyFitOptions",
        option(&O::iterations, "iterations", at_least(1), "", "Number of ICP iterations",
               "The robust scale shrinks over the first two thirds"),
        option(&O::landmark_deviation, "landmark_deviation", above(0), "m", "Expected error of a clicked landmark",
               "Cauchy weights reduce the influence of errors above three times that"),
        option(&O::joint_deviation, "joint_deviation", above(0), "m", "Expected error of a marked joint",
               "Skeletons differ in where a hip is"),
        option(&O::surface_deviation, "surface_deviation", above(0), "m",
               "Expected error of the model on skin, for each 4 cm^2 of surface", "Errors of the model are correlated"),
        option(&O::scale_deviation, "scale_deviation", above(0), "", "Expected relative deviation of the overall scale from 1",
               "The model varies in stature; this is for units and children"),
        option(&O::outlier_scale, "outlier_scale", above(0), "m", "Final scale of the Geman-McClure weights of the surface",
               "Hair and shoes are outliers"),
        option(&O::cloth_margin, "cloth_margin", at_least(0), "m", "The body stays at least this far inside cloth"),
        option(&O::cloth_attraction, "cloth_attraction", Range{0, 1}, "",
               "Weight of cloth within about outlier_scale of the body, against that of skin",
               "Where cloth is that close it rests on the body"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// One of several scans of the same person: other clothes, other poses, even other units.
struct ClothedScan {
  const RiggedMesh *actor;
  const Segmentation *segmentation;
  std::map<std::string, Eigen::Vector3d> landmarks; ///< name -> point on the surface, m
};

/// The swap point: clothed scan in, body under the clothes out.
/// Threads: all methods are const and may be called from several at once.
class BodyFitter {
public:
  virtual ~BodyFitter() = default;
  /// actor: surface in the scan pose; segmentation: delta = 0 is skin, delta > 0 hides it; landmarks: name -> point on the
  /// surface (m). Landmarks and joints are matched by name to the model's; at least three must match. Throws Error naming what is
  /// missing.
  virtual BodyFit fit(const RiggedMesh &actor, const Segmentation &segmentation, const BodyModel &model,
                      const std::map<std::string, Eigen::Vector3d> &landmarks, const Context &context) const = 0;
  /// All scans together: one shape (BodyModel::shape_count()), for each scan its own pose and place. One fit per scan, in order.
  /// Throws Error as fit() does, naming the scan; the default throws std::logic_error, since a fitter need not know how.
  virtual std::vector<BodyFit> fit_together(const std::vector<ClothedScan> &scans, const BodyModel &model,
                                            const Context &context) const;
  /// The built-in one: robust ICP over the model's coefficients. Throws std::invalid_argument as BodyFitOptions::validate().
  static std::unique_ptr<BodyFitter> create(const BodyFitOptions &options = {});
};

/// How far a fit can be trusted along one bone.
struct BodyRegion {
  std::string joint;    ///< that the bone hangs from
  double area = 0;      ///< m^2 of the body
  double exposed = 0;   ///< share of it whose nearest surface is skin
  double residual = 0;  ///< m, mean distance of that skin to the body; 0 where none is exposed
  double deviation = 0; ///< m, expected RMS error (BodyFit::deviation); 0 if that is not known
};
/// One for each joint that has surface of its own, in the skeleton's order.
std::vector<BodyRegion> body_regions(const BodyFit &fit, const RiggedMesh &actor, const Segmentation &segmentation);

/// (B) 1 where the nearest surface of the actor is cloth (delta > 0): what is hidden in the scan.
Mask body_under_cloth(const Mesh &body, const RiggedMesh &actor, const Segmentation &segmentation);

// Deprecated names.
using DressedScan [[deprecated("use ClothedScan")]] = ClothedScan;

} // namespace doublet
