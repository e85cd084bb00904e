#pragma once
// Plausibility check of a session: scan, joints, calibration and silhouettes against each other at frame 0 if it shows the scan's
// pose, otherwise at the frame that comes nearest.

#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/capture/start_frame.h"
#include "doublet/core/context.h"
#include "doublet/core/finding.h"

#include <optional>
#include <string>
#include <vector>

namespace doublet {

/// What is wrong with a session, and the frame of C cameras that it was looked at in.
struct SessionCheck {
  std::vector<Finding> findings;   ///< in the order of the checks, which end with the first that finds something impossible
  std::optional<StartFrame> start; ///< where a capture begins, if the scan does not fit frame 0 as placed
  std::string start_text;          ///< the same in words; empty without it, or if no frame is in the scan's pose
  CameraRig rig;                   ///< (C) the session's cameras, resized to at most 500 pixels
  std::vector<Image> silhouettes;  ///< (C) measured, as `rig` sees them, 255 = actor; empty where a camera shows none
  std::vector<Image> shadows; ///< (C) silhouettes of the scan, placed as in `start`, rendered with `rig`; empty without a scan
  MatrixRM overlaps; ///< (C, C) IoU of the measured silhouette of camera i with the scan's in camera j; NaN without either, or if
                     ///< the measured one cannot be a person's; (0, 0) without a scan
  Vertices joints;   ///< (J, 3) m, the session's, placed as the scan is
  int frame() const { return start ? start->frame : 0; } ///< of the frame source
};

/// Checks units, position and pose of the scan, that joints lie inside it and cameras see it, frame rates, that silhouettes can
/// be a person's, and whether they overlap the scan as filmed, mirrored, or with two cameras swapped; without a scan only rates
/// and silhouettes. `extractor` null: only ready masks are used. Throws std::invalid_argument if frames and session do not fit
/// together, and as read_mesh and find_start_frame do.
SessionCheck check_session(const Session &session, FrameSource &frames, const SilhouetteExtractor *extractor,
                           const Context &context);

} // namespace doublet
