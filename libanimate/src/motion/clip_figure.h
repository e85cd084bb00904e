#pragma once
// The body of a clip: where its joints are, how it stands in the zero pose, and which axis of its world points up.

#include "doublet/animate/motion_file.h"

#include <map>
#include <string>

namespace doublet {

class ClipFigure {
public:
  /// `joints`: standard name -> joint of the clip, those that retargeting needs among them. The clip must outlive the figure.
  ClipFigure(const SourceMotion &clip, std::map<std::string, int> joints);

  Eigen::Vector3d at(const std::string &part, int t) const { return clip_.positions[t].row(joints.at(part)); }
  Eigen::Vector3d zero(const std::string &part) const { return zero_.row(joints.at(part)); }
  Eigen::Vector3d zero_trunk() const; ///< from the pelvis to the chest; of a trunk of one joint, from hips to shoulders
  double leg_length() const;          ///< mean of both, over the clip

  std::map<std::string, int> joints;
  Eigen::Vector3d zero_up; ///< axis along which the trunk stands in the zero pose
  bool zero_leans;         ///< trunk or hips are aslant: it is a frame of some motion, in which an exporter has left the nodes
  bool zero_is_stance;     ///< upright, legs down, arms not up. Exporters of bone-local frames have all bones along one axis
  Eigen::Vector3d up;      ///< axis of the world that points up

private:
  bool leans() const;
  bool is_stance() const;
  Eigen::Vector3d up_of_world() const;
  Eigen::Vector3d body_at(int t) const;
  bool stands_along(const Eigen::Vector3d &axis) const;
  struct Heights;
  Heights heights_along(const Eigen::Vector3d &axis) const;
  bool lies(const Eigen::Vector3d &if_up, const Eigen::Vector3d &mean) const;

  const SourceMotion &clip_;
  Vertices zero_;
};

} // namespace doublet
