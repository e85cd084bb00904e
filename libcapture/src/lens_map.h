#pragma once
// Images as the pinhole camera of the same K would have taken them.

#include "doublet/capture/calibration_file.h"

#include <opencv2/core.hpp>
#include <optional>

namespace doublet::detail {

class LensMap {
public:
  LensMap(const Camera &camera, const Lens &lens);
  /// What the lens did not see, beyond the picture's edge, has the edge's colour: a screen goes on there.
  cv::Mat image(const cv::Mat &filmed) const;
  /// What the lens did not see is not the actor.
  cv::Mat mask(const cv::Mat &filmed) const;

private:
  cv::Mat x_y_, fraction_; // cv::remap's fixed-point maps
};

/// Of each camera of the session; empty where the lens has nothing to undo. Throws std::invalid_argument if the session has
/// neither no lenses nor one for each of its cameras.
std::vector<std::optional<LensMap>> lens_maps(const std::vector<Camera> &rig, const std::vector<Lens> &lenses);

} // namespace doublet::detail
