#pragma once
// How far cloth moves away from the body. Cloth that never does is carried by the body, not simulated.

#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <vector>

namespace doublet {

/// (V) m: the distance from the body, outside it, that a vertex exceeds in 5 % of the frames; 0 = it lies on the body, or in it.
/// `body`: in the scan pose; `canonical`: T x (V, 3) m, the captured surface taken back to the scan pose (canonical_frames), at
/// least one frame. In parallel; the result does not depend on the number of threads. Throws Error on an unusable body or frames
/// that are not finite, std::invalid_argument on no frames, or frames of different sizes.
Eigen::VectorXd cloth_slack(const Mesh &body, const std::vector<Vertices> &canonical, const Context &context = {});

} // namespace doublet
