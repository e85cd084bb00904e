#pragma once
// The pose in which a mesh was bound to its joints (glTF 2.0, Sect. 3.7.3).

#include <Eigen/Geometry>

#include <map>
#include <vector>

namespace doublet {

/// Of a skin's joints, by node: from the mesh's own axes to the joint's.
using BindPose = std::map<int, Eigen::Affine3d>;

/// How these joints were turned in the world; none if they stand so (`place`, `rest` of all nodes), or if the skin's bones are
/// others than the nodes'. `above`: of a node, the nearest joint, -1 = none.
std::map<int, Eigen::Quaterniond> turns_of_bind_pose(const BindPose &inverse, const std::vector<int> &above,
                                                     const std::vector<Eigen::Affine3d> &place,
                                                     const std::vector<Eigen::Quaterniond> &rest);

} // namespace doublet
