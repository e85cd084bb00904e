#include "doublet/animate/motion_file.h"

#include "doublet/options/options.h"
#include "nearest_axes.h"

#include <cmath>
#include <stdexcept>

namespace doublet {

Vertices SourceMotion::zero_positions() const {
  Vertices result(joints.size(), 3);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    result.row(j) = joints[j].offset;
    if (joints[j].parent >= 0)
      result.row(j) += result.row(joints[j].parent);
  }
  return result;
}

void validate(const SourceMotion &motion) {
  const auto require = [](bool right, const std::string &what) {
    if (!right)
      throw std::invalid_argument("SourceMotion: " + what);
  };
  const std::size_t joints = motion.joints.size();
  require(joints > 0 && !motion.positions.empty(), "expected at least one joint and one frame, found " + std::to_string(joints) +
                                                       " and " + std::to_string(motion.positions.size()));
  require(motion.fps >= kLowestRate && motion.fps <= kHighestRate,
          "expected fps in [0.1, 100000], found " + options::to_text(motion.fps));
  require(motion.up.isZero() || motion.up == nearest_axis(motion.up),
          "expected up to be an axis, such as 0 0 1, or 0 0 0, found " + options::to_text(motion.up.x()) + " " +
              options::to_text(motion.up.y()) + " " + options::to_text(motion.up.z()));
  for (std::size_t j = 0; j < joints; ++j) {
    const int parent = motion.joints[j].parent;
    require(j == 0 ? parent == -1 : parent >= 0 && parent < static_cast<int>(j),
            "expected one root (parent -1) and then parents before their children, found parent " + std::to_string(parent) +
                " at joint " + std::to_string(j));
    require(motion.joints[j].offset.allFinite(), "expected finite offsets, found others at joint " + std::to_string(j));
  }
  require(motion.rotations.size() == motion.positions.size(), "expected rotations for " +
                                                                  std::to_string(motion.positions.size()) + " frames, found " +
                                                                  std::to_string(motion.rotations.size()));
  for (std::size_t t = 0; t < motion.positions.size(); ++t) {
    const std::string frame = " at frame " + std::to_string(t);
    require(motion.positions[t].rows() == static_cast<Eigen::Index>(joints) && motion.rotations[t].size() == joints,
            "expected positions and rotations of " + std::to_string(joints) + " joints, found others" + frame);
    require(motion.positions[t].allFinite(), "expected finite positions, found others" + frame);
    for (const Eigen::Quaterniond &q : motion.rotations[t])
      require(std::abs(q.norm() - 1) < 1e-3,
              "expected unit quaternions, found one of length " + options::to_text(q.norm(), 4) + frame);
  }
}

} // namespace doublet
