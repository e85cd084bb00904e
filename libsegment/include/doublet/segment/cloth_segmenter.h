#pragma once
// Which parts of the surface are loose cloth (Sect. 5, eq. 1).

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"
#include "doublet/segment/opposite_distance.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

struct SegmentOptions {
  double even_odds = 3;
  double slope = 3;
  double even_gap = 0.0068;
  double gap_slope = 5;
  double colour = 3;
  double border = 0.12;
  double symmetry = 1;
  double min_region_area = 0.08;
  double diffusion = 0.03;
  bool thresholds = false;
  double rigid_threshold = 0.0025;
  double cloth_threshold = 0.006;
  OppositeOptions opposite;
  static constexpr auto describe() {
    using namespace options;
    using O = SegmentOptions;
    return Description{
        "SegmentOptions",
        option(&O::even_odds, "even_odds", at_least(1), "",
               "Deviation of equal odds for cloth and skin, in deviations of the stillest tenth of the surface",
               "Captured skin is at 1.5 in the median and below 3 nearly everywhere, loose cloth at 5 and more"),
        option(&O::slope, "slope", at_least(0), "", "Log odds of cloth that are gained for each factor of e in the deviation"),
        option(&O::even_gap, "even_gap", above(0), "m", "Distance of equal odds from a body that fits into the surface",
               "Skin is within 10 mm of it nearly everywhere, as the body keeps inside what may be cloth"),
        option(&O::gap_slope, "gap_slope", at_least(0), "",
               "Log odds of cloth that are gained for each factor of e in the distance from that body", "0 = it is not asked"),
        option(&O::colour, "colour", at_least(0), "", "Weight of the log likelihood ratio of the colours; 0 = motion alone",
               "With 0 no video is opened"),
        option(&O::border, "border", at_least(0), "m",
               "Cost of a metre of border, in square metres labelled against log odds of 1"),
        option(&O::symmetry, "symmetry", at_least(0), "",
               "Log odds that a place and its mirrored one are both cloth or both skin",
               "Nearly all garments are symmetric; 0 = off"),
        option(&O::min_region_area, "min_region_area", at_least(0), "m^2",
               "Garments that touch are told apart by colour if each is at least this large", "28 x 28 cm, about a short sleeve"),
        option(&O::diffusion, "diffusion", at_least(0), "m", "Length scale of the diffusion of the clothness",
               "Half of it smooths the border of the labels"),
        option(&O::thresholds, "thresholds", "Cloth is told by eq. 1 of the paper with its two thresholds; off = by the energy"),
        option(&O::rigid_threshold, "rigid_threshold", at_least(0), "m", "Threshold t_rigid of eq. 1: below, a vertex is rigid"),
        option(&O::cloth_threshold, "cloth_threshold", at_least(0), "m", "Threshold t_cloth of eq. 1: above, a vertex is cloth"),
        option(&O::opposite, "opposite", "Options of the rays to the other side"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// What a segmenter is given. Only the surface is needed.
struct SegmentInputs {
  MeshSequence surface; ///< as captured; the first frame is in the scan pose
  Mask face_valid = {}; ///< (F), empty = all: invalid faces close the surface but were never seen
  /// T x (V, 3) m, the frames brought back to the scan pose by the skeleton (canonical_frames): what still moves there, skinning
  /// does not explain. Empty = not known.
  std::vector<Vertices> canonical = {};
  /// (F k, 3) B G R, 0 to 255, of any k points spread over every face, face by face; NaN where no camera sees it
  /// (sample_colours() in texture_baker.h makes them). Empty = not known.
  Vertices colours = Vertices(0, 3);
  Eigen::VectorXd prior = {}; ///< (V) log odds of cloth before anything is seen (cloth_prior), or empty = 0
  /// (V) m, how far the scan stands off a body that fits into it (cloth_slack with the scan for the only frame), or empty = not
  /// known.
  Eigen::VectorXd gap = {};
  Eigen::VectorXi mirrored = {}; ///< (V) the vertex on the body's other side (mirrored_vertices), -1 = none; empty = not known
};

/// The swap point: captured surface in, what of it is cloth out.
/// Threads: segment() is const and may be called from several at once.
class ClothSegmenter {
public:
  virtual ~ClothSegmenter() = default;
  /// Vertices on no valid face are rigid. Throws std::invalid_argument on fewer than two frames or sizes that disagree, Error on
  /// an unusable mesh.
  virtual Segmentation segment(const SegmentInputs &inputs, const Context &context) const = 0;
  /// The minimum of one energy over skin and cloth: for each vertex its area times the log odds of cloth, from the prior, from
  /// how much its distance to the opposite side varies (eq. 1) in units of what the stillest tenth of the surface does, from how
  /// far it stands off a body within, and from its colour; for each edge the length of border it stands for; for each place that
  /// is not what its mirrored one is, its area. What skin and cloth look like is learnt from the surface itself.
  /// Segmentation::probability is the margin of the minimum as a probability.
  static std::unique_ptr<ClothSegmenter> create(const SegmentOptions &options = {});
};

Segmentation segment_cloth(const SegmentInputs &inputs, const SegmentOptions &options = {}, const Context &context = {});

/// The surface in whose pose a segmentation is made, for that is the scan's: the performance's first frame if its joints are
/// within 0.15 rad (RMS over the degrees of freedom but the root's), otherwise the actor's own mesh. Throws as
/// require_performance().
Mesh segmentation_pose(const RiggedMesh &actor, const ReferencePerformance &performance);

/// The whole stage for a captured performance: its frames are brought back to the scan pose, too (canonical_frames), after
/// segmentation_pose() if that is none of them; the prior is cloth_prior(), mirrored places are mirrored_vertices(); `colours` as
/// SegmentInputs::colours of the first captured frame, `body` one that fits into the actor's surface (as BodyFitter fits it to
/// dressed_all_over()), or both empty. `segmenter` is asked. Throws as these do.
Segmentation segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance,
                                 const ClothSegmenter &segmenter, const Vertices &colours = Vertices(0, 3), const Mesh &body = {},
                                 const Context &context = {});

/// Segmentation from a deviation (V, m, NaN = unknown) alone: the energy without prior and colours.
Segmentation segmentation_from_deviation(const Mesh &pose, const Mask &face_valid, const Eigen::VectorXd &sigma,
                                         const SegmentOptions &options = {});

/// What a segmentation found; log it where a number can disappoint.
struct SegmentSummary {
  int regions = 0;
  double cloth_area = 0;      ///< m^2, clothness > 0.5, over valid faces
  double transition_area = 0; ///< m^2, 0 < clothness <= 0.5
  double known_fraction = 0;  ///< of the vertices on valid faces: had a usable opposite ray
  double noise = 0;           ///< m, the deviation of the stillest tenth of the surface: how exact the capture is
  double uncertain_area = 0;  ///< of all, the share with a probability of cloth from 0.1 to 0.9; 0 if that is not known
};
SegmentSummary summarise_segmentation(const Mesh &pose, const Mask &face_valid, const Segmentation &segmentation);

/// The end of a limb (toes, a hand, the top of the head) that is cloth.
struct ClothEnd {
  std::string joint;
  double share = 0; ///< of the surface on the bone that ends there, over a half
};
/// Ends of limbs with more cloth than skin, in the order of the skeleton: a glove or a boot, or a mistake.
std::vector<ClothEnd> cloth_ends(const RiggedMesh &actor, const Segmentation &segmentation);

// Deprecated names.
template <class... A> [[deprecated("use segmentation_pose")]] decltype(auto) segmented_pose(A &&...a) {
  return segmentation_pose(std::forward<A>(a)...);
}

} // namespace doublet
