#pragma once
// Video -> reference performance (Sect. 4; Gall et al. 2009): pose by rims and SIFT in Gauss-Newton over all cameras, Laplacian refinement.

#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <functional>
#include <memory>

namespace doublet {

struct CaptureOptions {
  int first_frame = 0, frame_count = -1;  ///< -1 = to the end
  bool use_sift = true;                   ///< off: silhouettes alone
  void validate() const;
};

struct CaptureSummary {
  std::vector<double> rim_px, sift_px;     ///< (T) mean residual per frame, pixels
  std::vector<double> silhouette_iou;      ///< (T) mean over cameras, of the refined surface against the measured masks
  double seconds_per_frame = 0;
};

struct CaptureResult {
  ReferencePerformance performance;
  Observations observations;
  CaptureSummary summary;
};

/// The swap point: (rigged mesh, rig, frames, context) -> reference performance and the 2D observations it used.
class PerformanceCapture {
public:
  virtual ~PerformanceCapture() = default;
  virtual CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames,
                                const SilhouetteExtractor *extractor, const Context &context) = 0;
  static std::unique_ptr<PerformanceCapture> create(const CaptureOptions &options = {});
};

}  // namespace doublet
