#pragma once
#include "doublet/capture/scan_from_views.h"

namespace doublet::detail {

/// (V, 3) the hull's vertices, moved inward along their normals to where the cameras that see them agree best: normalised
/// correlation of patches of the surface, made smooth over the mesh by belief propagation (Felzenszwalb & Huttenlocher 2006).
Vertices photo_consistent(const Mesh &hull, const CameraRig &rig, const std::vector<CameraView> &views,
                          const ViewScanOptions &options, const Context &context);

} // namespace doublet::detail
