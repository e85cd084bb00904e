#pragma once
// Which parts of the surface are loose cloth (Sect. 5, eq. 1).

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"
#include "doublet/segment/fullness.h"
#include "doublet/segment/opposite_distance.h"

#include <memory>

namespace doublet {

struct SegmentOptions {
  double rigid_threshold = 0.0025;
  double cloth_threshold = 0.006;
  double diffusion = 0.03;
  double smallest_region = 0.08;
  double contrast = 1.5;
  double skin_colour = 2;
  double cloth_colour = 0.7;
  OppositeOptions opposite;
  static constexpr auto describe() {
    using namespace options;
    using O = SegmentOptions;
    return Description{
        "SegmentOptions",
        option(&O::rigid_threshold, "rigid_threshold", at_least(0), "m",
               "t_rigid: below, a vertex is rigid; captured skin has 1 to 3 mm, at 1.75 mm it passes for cloth in two of nine "
               "sessions"),
        option(
            &O::cloth_threshold, "cloth_threshold", at_least(0), "m",
            "t_cloth: above, a vertex is cloth; trouser legs, sleeves and the top of a skirt, which lie on the body, have 3 to "
            "10 mm, loose cloth 20 mm and more"),
        option(&O::diffusion, "diffusion", at_least(0), "m",
               "length scale of the implicit diffusion; about an edge of the 5000-triangle template"),
        option(&O::smallest_region, "smallest_region", at_least(0), "m^2",
               "smaller islands of cloth are dropped and smaller holes filled; 28 x 28 cm, about a short sleeve"),
        option(&O::contrast, "contrast", at_least(1), "",
               "beside cloth, what moves this many times as much as the skin around it is cloth, too; 1000 = off"),
        option(
            &O::skin_colour, "skin_colour", Range{0, 5}, "",
            "surface that looks like skin all over counts with exp(-skin_colour) of its deviation: nobody's forearm is cloth; 0 "
            "= off"),
        option(
            &O::cloth_colour, "cloth_colour", Range{0, 5}, "",
            "surface that looks like cloth all over counts with exp(cloth_colour) of its deviation: less, for a tight top may be "
            "of the same fabric; 0 = off"),
        option(&O::opposite, "opposite", "the rays to the other side"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

class ClothSegmenter {
public:
  virtual ~ClothSegmenter() = default;
  /// sequence: the captured surface; where it holds unposed frames, too, the smaller of both deviations counts: skin that a bent
  /// joint or a twisted spine deforms keeps its place in the scan pose, and skin that the skin weights misplace keeps its shape.
  /// And beside what these show to be cloth, what moves more than the skin around it counts, too (`contrast`). Where it holds
  /// colours, what looks like the stillest quarter of the surface has to move more to be cloth, what looks like the loosest less.
  /// face_valid (F): rays that hit invalid triangles do not count. Vertices on no valid face are rigid. Throws
  /// std::invalid_argument on fewer than two frames or sizes that disagree, Error on an unusable mesh.
  virtual Segmentation segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                               const Context &context) const = 0;
  static std::unique_ptr<ClothSegmenter> create(const SegmentOptions &options = {});
};

Segmentation segment_cloth(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                           const SegmentOptions &options = {}, const Context &context = {});

/// The surface in whose pose a segmentation is made, for that is the scan's: the performance's first frame if its joints are
/// within 0.15 rad (RMS over the degrees of freedom but the root's), otherwise the actor's own mesh. Throws as
/// require_performance().
Mesh segmented_pose(const RiggedMesh &actor, const ReferencePerformance &performance);

/// The whole stage for a captured performance: its frames are brought back to the scan pose, too (unposed_frames), after
/// segmented_pose() if that is none of them, `segmenter` is asked, and the cloth gets its fullness (estimate_fullness). Throws as
/// these do.
Segmentation segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance,
                                 const ClothSegmenter &segmenter, const FullnessOptions &fullness = {},
                                 const Context &context = {});

/// Segmentation from a deviation (V, m, NaN = unknown) alone: eq. 1, diffusion, holes and islands, regions.
Segmentation segmentation_from_deviation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                         const Eigen::VectorXd &sigma, const SegmentOptions &options = {});

/// options, with both thresholds raised together (up to eightfold): so far that rigid_threshold is 1.4 times the tenth centile of
/// sigma, what the capture makes of skin; and while what moves is more than half of the surface and has its top (+Y), or hangs
/// from nothing: then it is the noise of the capture (few cameras, a rough scan) that moves. The segmenter uses these. sigma as
/// above.
SegmentOptions fitting_thresholds(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma,
                                  const SegmentOptions &options = {});

/// What a segmentation found; log it where a number can disappoint.
struct SegmentSummary {
  int regions = 0;
  double cloth_area = 0;      ///< m^2, clothness > 0.5, over valid faces
  double transition_area = 0; ///< m^2, 0 < clothness <= 0.5
  double known_fraction = 0;  ///< of the vertices on valid faces: had a usable opposite ray
};
SegmentSummary summarise_segmentation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                      const Segmentation &segmentation);

} // namespace doublet
