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
  double diffusion = 0.015;
  OppositeOptions opposite;
  static constexpr auto describe() {
    using namespace options;
    using O = SegmentOptions;
    return Description{
        "SegmentOptions",
        option(&O::even_odds, "even_odds", at_least(1), "",
               "Deviation at which the motion term is 0, as a multiple of the noise (10 % quantile of deviation)",
               "Captured skin is at 1.5 in the median and below 3 nearly everywhere, loose cloth at 5 and more"),
        option(&O::slope, "slope", at_least(0), "", "Log odds of cloth that are gained for each factor of e in the deviation"),
        option(&O::even_gap, "even_gap", above(0), "m",
               "Distance from a body fitted inside the scan at which the distance term is 0",
               "Skin is within 10 mm of it nearly everywhere, as the body keeps inside what may be cloth"),
        option(&O::gap_slope, "gap_slope", at_least(0), "",
               "Log odds of cloth that are gained for each factor of e in the distance from that body",
               "0 = the distance is not used"),
        option(&O::colour, "colour", at_least(0), "",
               "Weight of the log likelihood ratio of the colours; 0 = colours are not used", "With 0 no video is opened"),
        option(&O::border, "border", at_least(0), "m",
               "Cost of a metre of border: that of labelling so many square metres against log odds of 1"),
        option(&O::symmetry, "symmetry", at_least(0), "", "Log odds that a vertex and its mirror image have the same label",
               "Nearly all garments are symmetric; 0 = off"),
        option(&O::diffusion, "diffusion", at_least(0), "m",
               "Length scale of the diffusion that smooths the border of the labels"),
        option(&O::opposite, "opposite", "Options of the rays to the other side"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Input of a segmenter. Only the surface is required.
struct SegmentInputs {
  MeshSequence surface; ///< as captured; the first frame is the scan, or in its pose
  Mask face_valid = {}; ///< (F), empty = all: invalid faces close the surface but were never seen
  /// T x (V, 3) m, the frames transformed back to the scan pose by the skeleton (canonical_frames): motion that remains there is
  /// not explained by skinning. Empty = not known.
  std::vector<Vertices> canonical = {};
  /// (F k, 3) B G R, 0 to 255, of any k points spread over every face, face by face; NaN where no camera sees it
  /// (sample_colours() in texture_baker.h makes them). Empty = not known.
  Vertices colours = Vertices(0, 3);
  Eigen::VectorXd prior = {}; ///< (V) prior log odds of cloth (cloth_prior), or empty = 0
  /// (V) m, distance of the scan from a body that is fitted inside it (cloth_slack with the scan for the only frame); empty = not
  /// known.
  Eigen::VectorXd gap = {};
  Eigen::VectorXi mirrored = {}; ///< (V) the vertex on the body's other side (mirrored_vertices), -1 = none; empty = not known
};

/// The swap point: captured surface in, labels of cloth and skin out.
/// Threads: segment() is const and may be called from several at once.
class ClothSegmenter {
public:
  virtual ~ClothSegmenter() = default;
  /// Vertices on no valid face are rigid. Throws std::invalid_argument on fewer than two frames or sizes that disagree, Error on
  /// an unusable mesh.
  virtual Segmentation segment(const SegmentInputs &inputs, const Context &context) const = 0;
  /// The built-in one: the exact minimum of an energy over labels skin and cloth (docs/segmentation.md). A cloth vertex
  /// gains its area times its log odds, the sum of four terms: deviation of the distance to the opposite side (eq. 1) over its 10
  /// % quantile, distance from a body within, colour (whose histograms are learnt from the surface itself), prior. A border costs
  /// its length; a vertex that is labelled otherwise than its mirror image costs its area. Segmentation::probability is the
  /// logistic function of the margin of the minimum (labelling_margins). Throws std::invalid_argument as
  /// SegmentOptions::validate().
  static std::unique_ptr<ClothSegmenter> create(const SegmentOptions &options = {});
};

/// ClothSegmenter::create(options)->segment(inputs, context).
Segmentation segment_cloth(const SegmentInputs &inputs, const SegmentOptions &options = {}, const Context &context = {});

/// The whole stage for a captured performance: its frames, after the scan itself, and these brought back to the scan pose
/// (canonical_frames); the prior is cloth_prior(), mirrored places are mirrored_vertices(); `colours` as SegmentInputs::colours
/// of the first captured frame, `body` one that fits into the actor's surface (as BodyFitter fits it to dressed_all_over()), or
/// both empty. `segmenter` is asked. Throws as these do.
Segmentation segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance,
                                 const ClothSegmenter &segmenter, const Vertices &colours = Vertices(0, 3), const Mesh &body = {},
                                 const Context &context = {});

/// Segmentation from a deviation (V, m, NaN = unknown) alone: the energy without prior, body, colours and mirror images. Throws
/// std::invalid_argument on wrong sizes, Error on an unusable mesh.
Segmentation segmentation_from_deviation(const Mesh &pose, const Mask &face_valid, const Eigen::VectorXd &sigma,
                                         const SegmentOptions &options = {});

/// What a segmentation found; log it where a number can disappoint.
struct SegmentSummary {
  int regions = 0;
  double cloth_area = 0;      ///< m^2, clothness > 0.5, over valid faces
  double transition_area = 0; ///< m^2, 0 < clothness <= 0.5
  double known_fraction = 0;  ///< share of the vertices on valid faces whose sigma is known
  double noise = 0;           ///< m, 10 % quantile of sigma: how much the capture itself moves the surface
  double uncertain_area = 0;  ///< share of the area with a probability of cloth from 0.1 to 0.9; 0 if that is not known
};
SegmentSummary summarise_segmentation(const Mesh &pose, const Mask &face_valid, const Segmentation &segmentation);

/// The end of a limb (toes, a hand, the top of the head) that is cloth.
struct ClothEnd {
  std::string joint;
  double share = 0; ///< of the surface that moves with that end, above 0.5
};
/// Ends of limbs with more cloth than skin, in the order of the skeleton: a glove or a boot, or a mistake.
std::vector<ClothEnd> cloth_ends(const RiggedMesh &actor, const Segmentation &segmentation);

} // namespace doublet
