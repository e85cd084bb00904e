#pragma once
// The frame at which tracking begins, and the pose there.

#include "start_search.h"
#include "take_measurements.h"

#include <vector>

namespace doublet::detail {

struct StartPose {
  int t = 0;                          ///< frame index
  Eigen::VectorXd dofs;               ///< (D)
  bool searched = false;              ///< the pose is not the scan's
  std::vector<ViewMeasurement> views; ///< of that frame, with features; empty = not measured
};

/// The first frame, or the one asked for, if the scan pose fits there; otherwise the frame of the take where it fits best. Where
/// it fits nowhere, the pose is searched in the frames that come nearest. `reliability` (V): before anything was seen. Throws
/// Error if there is none.
StartPose find_start_pose(const TrackingJob &job, TakeMeasurements &measurements, const Eigen::VectorXd &reliability,
                          const KeypointPlaces &places, double &seconds);

} // namespace doublet::detail
