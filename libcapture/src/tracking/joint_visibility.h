#pragma once
// Which joints a frame shows, counted over the take (JointVisibility).

#include "doublet/capture/limb_search.h"
#include "doublet/capture/performance_capture.h"

#include <vector>

namespace doublet::detail {

/// Adds a frame to what is counted. `visible`: what each camera sees of the surface; reliability (V); `lost`: names of the limbs
/// that were lost there and not found again.
void count_joints(const RiggedMesh &actor, const std::vector<FaceBuffer> &visible, const Eigen::VectorXd &reliability,
                  const std::vector<Limb> &limbs, const std::vector<std::string> &lost, std::vector<JointVisibility> &joints);
void say_what_was_hidden(const std::vector<JointVisibility> &joints, const Context &context);

} // namespace doublet::detail
