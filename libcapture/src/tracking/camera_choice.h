#pragma once

#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"

#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// Some of a session's cameras, numbered anew; rig, frames and extractor that go together. Refers to what it was made from.
class CameraChoice {
public:
  /// `names` in any order, empty = all; the cameras keep the rig's order. Throws std::invalid_argument naming a camera that is
  /// unknown or given twice.
  CameraChoice(const std::vector<std::string> &names, const CameraRig &rig, FrameSource &frames,
               const SilhouetteExtractor *extractor);
  const CameraRig &rig() const { return rig_; }
  FrameSource &frames() const { return *frames_; }
  const SilhouetteExtractor *extractor() const { return extractor_.get(); }

private:
  CameraRig rig_;
  std::unique_ptr<FrameSource> frames_;
  std::unique_ptr<SilhouetteExtractor> extractor_;
};

} // namespace doublet
