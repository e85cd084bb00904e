#pragma once
// Which parts of the surface are loose cloth (Sect. 5, eq. 1).

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/segment/fullness.h"
#include "doublet/segment/opposite_distance.h"

#include <memory>

namespace doublet {

struct SegmentOptions {
  /// t_rigid, m: what markerless tracking leaves on the skin of trunk and limbs (its true sigma is 1 to 4 mm).
  double rigid_threshold = 0.003;
  /// t_cloth, m: half way, at 6 mm, most skin stays below and the upper part of a skirt, which lies on the hips, above; loose
  /// cloth has 20 mm and more.
  double cloth_threshold = 0.009;
  double diffusion = 0.03; ///< m, length scale of the implicit diffusion
  /// m^2 (28 x 28 cm, about a short sleeve): smaller islands of cloth are dropped and smaller holes filled.
  double smallest_region = 0.08;
  OppositeOptions opposite; ///< the rays
  void validate() const;
};

class ClothSegmenter {
public:
  virtual ~ClothSegmenter() = default;
  /// sequence: the captured surface; where it holds unposed frames, too, the smaller of both deviations counts: skin that a bent
  /// joint or a twisted spine deforms keeps its place in the scan pose, and skin that the skin weights misplace keeps its shape.
  /// face_valid (F): rays that hit invalid triangles do not count. Vertices on no valid face are rigid. Throws
  /// std::invalid_argument on fewer than two frames or sizes that disagree, Error on an unusable mesh.
  virtual Clothness segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                            const Context &context) const = 0;
  static std::unique_ptr<ClothSegmenter> create(const SegmentOptions &options = {});
};

Clothness segment_cloth(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                        const SegmentOptions &options = {}, const Context &context = {});

/// The whole stage for a captured performance: its frames are brought back to the scan pose, too (unposed_frames), `segmenter` is
/// asked, and the cloth gets its fullness (estimate_fullness). Throws as these do.
Clothness segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance, const ClothSegmenter &segmenter,
                              const FullnessOptions &fullness = {}, const Context &context = {});

/// Clothness from a deviation (V, m, NaN = unknown) alone: eq. 1, diffusion, holes and islands, regions.
Clothness clothness_from_deviation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma,
                                   const SegmentOptions &options = {});

/// What a segmentation found; log it where a number can disappoint.
struct SegmentSummary {
  int regions = 0;
  double cloth_area = 0;      ///< m^2, clothness > 0.5, over valid faces
  double transition_area = 0; ///< m^2, 0 < clothness <= 0.5
  double known_fraction = 0;  ///< of the vertices on valid faces: had a usable opposite ray
};
SegmentSummary summarise_segmentation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Clothness &clothness);

} // namespace doublet
