#pragma once
// A clip on a tree of nodes, as glTF and FBX have it, and what of it are a body's joints.

#include "bind_pose.h"
#include "doublet/animate/motion_file.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// A property of a node over time.
struct Track {
  enum class Between { Step, Linear, Cubic };
  using Floats = std::shared_ptr<const std::vector<float>>; ///< that several tracks may have in common
  Floats times_of,
      numbers; ///< s, ascending; `width` a key; of a cubic spline three times as many: slope before, value, slope after
  std::size_t width = 0;
  Between between = Between::Linear;

  const std::vector<float> &times() const { return *times_of; }
  Eigen::VectorXd key(std::size_t k) const { return numbers_at(k, 1); }
  Eigen::VectorXd at(double time) const; ///< before the first and behind the last as there
  bool moves() const;

private:
  Eigen::VectorXd numbers_at(std::size_t key, std::size_t part) const;
};

struct Node {
  std::string name;
  int parent = -1;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  bool bone = true; ///< draws nothing
  std::string part; ///< of a human, where the file says so
};

using Tracks = std::map<int, std::map<std::string, Track>>; ///< by node, then by "translation", "rotation", "scale"

struct NodeAnimation {
  std::string name;
  Tracks tracks;
};

struct NodeSkin {
  std::vector<int> joints;
  BindPose inverse_bind; ///< of the joints, or empty
};

/// Nodes name their parents in any order; every index is one of a node, every key of a rotation a unit quaternion.
struct NodeClip {
  std::string source; ///< file name, for messages
  std::vector<Node> nodes;
  std::vector<NodeSkin> skins;
  std::vector<NodeAnimation> animations;
};

constexpr std::size_t kMostSkins = 1000;

/// One of its animations on its body's joints, as motion_file.h says of .glb. Throws Error "source: ...".
SourceMotion sampled_motion(NodeClip clip, const std::string &animation);

} // namespace doublet
