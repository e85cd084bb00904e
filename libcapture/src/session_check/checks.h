#pragma once
// The checks of a session. Each returns what it finds, and may rest on what those before it found possible.

#include "session_check/evidence.h"

namespace doublet::detail {

using Findings = std::vector<Finding>;

Findings check_scan(Evidence &evidence);
Findings check_joints(Evidence &evidence);
/// Units first: a camera in millimetres is a kilometre away, and the person a dot that it sees all of.
Findings check_calibration(Evidence &evidence);
/// What the containers say. Cameras that disagree are not synchronous; one rate for all may be slow motion.
Findings check_rates(Evidence &evidence);
/// Ready masks at a few frames, silhouettes at the first that the camera filmed.
Findings check_masks(Evidence &evidence);
/// A take need not begin in the scan's pose, nor where the scan stands: where nothing fits, it is looked for.
Findings check_overlap(Evidence &evidence);

/// In words; empty if the scan fits frame 0 as it stands, or no frame is in its pose.
std::string describe_start(const std::optional<StartFrame> &start);

/// "; it looks like millimetres": the unit in which `length` is nearest to a `usual` one in metres; empty if none comes near.
std::string likely_unit(double length, double usual);

} // namespace doublet::detail
