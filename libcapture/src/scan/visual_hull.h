#pragma once
#include "doublet/capture/scan_from_views.h"

namespace doublet::detail {

/// Points on a surface and the unit normals there, which point outward.
struct OrientedPoints {
  Vertices points, normals;
};

/// The visual hull of the silhouettes where it crosses the edges of a grid; `body`, if not null: no farther from it than the
/// outlines are. Throws as scan_from_views() does.
OrientedPoints visual_hull(const CameraRig &rig, const std::vector<CameraView> &views, const Mesh *body,
                           const ViewScanOptions &options, const Context &context);

} // namespace doublet::detail
