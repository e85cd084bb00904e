#pragma once
// Elbows and knees that bend the wrong way: nobody's do, so the limb is elsewhere.

#include "doublet/capture/limb_search.h"

namespace doublet::detail {

/// Is an elbow or a knee of the limb (a flexion below a ball joint) bent beyond straight by more than 3 degrees?
bool bends_backwards(const Skeleton &skeleton, const Limb &limb, const Eigen::VectorXd &dofs);

/// The same with limits that let elbows and knees bend forwards only.
RiggedMesh forwards_only(RiggedMesh actor);

} // namespace doublet::detail
