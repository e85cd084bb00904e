#pragma once
// Which parts of the surface are loose cloth (Sect. 5, eq. 1).

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <memory>

namespace doublet {

struct SegmentOptions {
  double rigid_threshold = 0.010;  ///< t_rigid, m
  double cloth_threshold = 0.020;  ///< t_cloth, m
  double diffusion = 0.02;         ///< m, length scale of the implicit diffusion
  double smallest_region = 0.02;   ///< m^2, smaller islands of cloth are dropped and smaller holes filled
  void validate() const;
};

class ClothSegmenter {
public:
  virtual ~ClothSegmenter() = default;
  /// sequence: the captured surface; face_valid (F): rays that hit invalid triangles do not count.
  virtual Clothness segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid, const Context &context) const = 0;
  static std::unique_ptr<ClothSegmenter> create(const SegmentOptions &options = {});
};

Clothness segment_cloth(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                        const SegmentOptions &options = {}, const Context &context = {});

}  // namespace doublet
