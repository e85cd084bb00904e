#pragma once
// The body under the clothes (Sect. 5): fit of the statistical model to the exposed skin, collision proxies.

#include "doublet/bodymodel/body_model.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

struct BodyFitOptions {
  int iterations = 20;               ///< of ICP; the robust scale shrinks over the first two thirds
  double landmark_deviation = 0.015; ///< m, how far a clicked landmark is trusted
  double joint_deviation = 0.025;    ///< m, how far a marked joint is trusted: rigs differ in where a hip is
  double surface_deviation = 0.004;  ///< m, of skin around the model, per 4 cm^2 of surface (errors of the model are correlated)
  double scale_deviation =
      0.03; ///< relative, prior of the similarity's scale: stature is the model's, this is for units and children
  double outlier_scale = 0.010;   ///< m, final scale of the Geman-McClure weights (hair, shoes)
  double cloth_margin = 0.003;    ///< m, the body stays this far inside cloth
  double cloth_attraction = 0.03; ///< weight, against skin, of cloth within about outlier_scale of the body: it rests there
  void validate() const;
};

/// One of several scans of the same person: other clothes, other poses, even other units.
struct DressedScan {
  const RiggedMesh *actor;
  const Clothness *clothness;
  std::map<std::string, Eigen::Vector3d> landmarks; ///< name -> point on the surface, m
};

class BodyFitter {
public:
  virtual ~BodyFitter() = default;
  /// actor: surface in the scan pose; clothness: delta = 0 is skin, delta > 0 hides it; landmarks: name -> point on the surface
  /// (m). Landmarks and joints are matched by name to the model's; at least three must match. Throws Error naming what is
  /// missing.
  virtual BodyFit fit(const RiggedMesh &actor, const Clothness &clothness, const BodyModel &model,
                      const std::map<std::string, Eigen::Vector3d> &landmarks, const Context &context) const = 0;
  /// All scans together: one shape (BodyModel::shape_count()), for each scan its own pose and place. One fit a scan, in order.
  /// Throws Error as fit() does, naming the scan; the default throws std::logic_error, since a fitter need not know how.
  virtual std::vector<BodyFit> fit_together(const std::vector<DressedScan> &scans, const BodyModel &model,
                                            const Context &context) const;
  static std::unique_ptr<BodyFitter> create(const BodyFitOptions &options = {});
};

struct ProxyOptions {
  double clearance = 0.0;      ///< m, the capsules stand this much inside the body on average
  double cloth_margin = 0.004; ///< m, at least this far inside the cloth of the scan pose: resting cloth is never pushed
  int capsules_per_bone = 2;   ///< 1 to 3
  int iterations = 40;         ///< of the least squares
  void validate() const;
};
/// Tapered capsules for the bones where cloth can touch: bones with cloth over their body surface, and the next bones down the
/// chain. Empty if nothing is cloth.
std::vector<TaperedCapsule> fit_proxies(const BodyFit &fit, const RiggedMesh &actor, const Clothness &clothness,
                                        const ProxyOptions &options = {});

/// How well the capsules stand for the body.
struct ProxyStatistics {
  int capsules = 0;
  int samples = 0;            ///< body vertices under cloth
  double mean_distance = 0;   ///< m, mean |signed distance| of body vertices under cloth to the union of capsules
  double percentile95 = 0;    ///< m, of the same
  double largest_bulge = 0;   ///< m, how far a capsule stands out of the body at most (0 = nowhere)
  double cloth_clearance = 0; ///< m, smallest signed distance of the resting cloth to the capsules (negative = pushed)
};
ProxyStatistics proxy_statistics(const std::vector<TaperedCapsule> &capsules, const BodyFit &fit, const RiggedMesh &actor,
                                 const Clothness &clothness);

/// How far a fit can be trusted along one bone.
struct BodyRegion {
  std::string joint;    ///< that the bone hangs from
  double area = 0;      ///< m^2 of the body
  double exposed = 0;   ///< share of it whose nearest surface is skin
  double residual = 0;  ///< m, mean distance of that skin to the body; 0 where none is exposed
  double deviation = 0; ///< m, expected RMS error (BodyFit::deviation); 0 if the fitter told none
};
/// One a joint that has surface of its own, in the skeleton's order.
std::vector<BodyRegion> body_regions(const BodyFit &fit, const RiggedMesh &actor, const Clothness &clothness);

/// (B) 1 where the nearest surface of the actor is cloth (delta > 0): what is hidden in the scan.
std::vector<std::uint8_t> body_under_cloth(const Mesh &body, const RiggedMesh &actor, const Clothness &clothness);

} // namespace doublet
