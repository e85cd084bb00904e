#pragma once
// Limbs that the local optimisation has lost: found by their own error, sought globally (Sect. 4; Gall et al. 2009,
// Sect. 4.2-4.3).

#include "doublet/capture/particle_annealing.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/core/context.h"
#include "doublet/core/image.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// A chain of the skeleton between two forks, or from a fork to an end: an arm, a leg, the trunk, neck and head.
struct Limb {
  std::string name;        ///< of its first joint
  std::vector<int> joints; ///< parents first
  std::vector<int> dofs;   ///< of these joints, in order; never empty
};

/// The limbs of a skeleton by its topology, parents before children. A joint forks if two or more of its branches can move on
/// their own; branches without freedom belong to the limb they hang on. The root is no limb: it moves everything.
std::vector<Limb> find_limbs(const Skeleton &skeleton);

/// One frame. Arrays over views have one entry per camera; a view with an empty mask takes no part.
struct LimbProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Image> *masks = nullptr; ///< measured; 255 = actor
  Vertices offset;                           ///< (V, 3) m, rest pose: expected non-rigid offset; may be empty
  Eigen::VectorXd reliability;               ///< (V) in [0, 1]: weight of a vertex in the pose; low on loose cloth
  Eigen::VectorXd predicted;                 ///< (D) pose predicted from the previous frames
  std::vector<SeenPoint> points = {};        ///< joints that keypoints show
};

struct LimbSearchOptions {
  int raster_size = 160;
  double lost_error = 0.02;
  double max_error = 0.3;
  double deviation = 0.7;
  double smoothness = 0.02;
  double keypoint_weight = 0.3;
  ParticleAnnealingOptions annealing;
  static constexpr auto describe() {
    using namespace options;
    using O = LimbSearchOptions;
    return Description{
        "LimbSearchOptions",
        option(&O::raster_size, "raster_size", at_least(64), "px", "Longest side of the masks and renderings that are compared",
               "An arm is 3 to 4 px wide"),
        option(&O::lost_error, "lost_error", above(0), "m", "A limb with a larger error counts as lost",
               "Tracked limbs have a few mm, an arm 30 degrees off has 4 cm"),
        option(&O::max_error, "max_error", above(0), "m", "Cap on the error of a pixel"),
        option(&O::deviation, "deviation", above(0), "rad", "Standard deviation of the first particles around the prediction"),
        option(&O::smoothness, "smoothness", at_least(0), "",
               "Weight of (angle - prediction)^2 / deviation^2 against the share of the limb's area"),
        option(&O::keypoint_weight, "keypoint_weight", at_least(0), "",
               "Weight of joints that are max_error beyond their keypoints, against the wrong pixels",
               "They decide where silhouettes do not: a limb that is 10 cm off has more wrong pixels"),
        option(&O::annealing, "annealing", "Options of the particles"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Error (limbs), m, of each limb in the pose `dofs` (D): distances of its rendered pixels that lie outside the masks to these,
/// plus distances of unexplained mask pixels to the rendering, summed and divided by the number of the limb's pixels. Each
/// connected set of unexplained pixels is assigned to the limb whose bones are nearest in the image. Pixels are weighted by
/// reliability, so that flying cloth does not make a limb count as lost.
Eigen::VectorXd limb_errors(const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &limbs,
                            const LimbSearchOptions &options, const Context &context);

/// Overlap energy of a pose: pixels rendered outside the masks plus mask pixels not covered, divided by the mask pixels, mean
/// over the views; plus LimbSearchOptions::keypoint_weight times the error of joints with keypoints. 0 = perfect agreement.
double overlap_energy(const LimbProblem &problem, const Eigen::VectorXd &dofs, const LimbSearchOptions &options,
                      const Context &context);

/// The swap point: a pose with lost limbs in, a better pose out; may only change the degrees of freedom of these limbs.
/// Threads: one call at a time, frame after frame.
class LimbSearch {
public:
  virtual ~LimbSearch() = default;
  /// `lost`: in the order of find_limbs(). Returns a pose (D), within the joint limits.
  virtual Eigen::VectorXd search(const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &lost,
                                 const Context &context) = 0;
  /// Interacting simulated annealing, one limb after the other; the energy is the overlap error in the limb's own pixels and the
  /// distance to the prediction.
  static std::unique_ptr<LimbSearch> create(const LimbSearchOptions &options = {});
};

} // namespace doublet
