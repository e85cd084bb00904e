#include "doublet/animate/motion.h"

#include "doublet/options/options.h"
#include "require_motion.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

constexpr int kMostFrames = 10'000'000; // more than a day at the rates of cloth
constexpr double kEnd = 0.05; // of a frame, by which a clip may end early and still show its last: files have rounded rates

} // namespace

void require_motion(const Skeleton &skeleton, const Motion &motion, const std::string &who) {
  if (!(motion.fps > 0) || !std::isfinite(motion.fps))
    throw std::invalid_argument(who + ": motion.fps must be positive, found " + options::to_text(motion.fps));
  if (motion.dofs.rows() == 0 || motion.dofs.cols() != skeleton.dof_count() || !motion.dofs.allFinite())
    throw std::invalid_argument(who + ": motion.dofs must be finite, (T > 0, " + std::to_string(skeleton.dof_count()) +
                                "), found (" + std::to_string(motion.dofs.rows()) + ", " + std::to_string(motion.dofs.cols()) +
                                ")");
}

bool has_steps(const Motion &motion) {
  return motion.fps >= 0.1 && motion.fps <= 10000;
}
void require_steps(const Skeleton &skeleton, const Motion &motion, const std::string &who) {
  require_motion(skeleton, motion, who);
  if (!has_steps(motion))
    throw std::invalid_argument(who + ": motion.fps must be in [0.1, 10000], found " + options::to_text(motion.fps));
}

Motion resample(const Skeleton &skeleton, const Motion &motion, double fps) {
  require_motion(skeleton, motion, "resample");
  if (!(fps > 0) || !std::isfinite(fps))
    throw std::invalid_argument("resample: fps must be positive, found " + options::to_text(fps));
  const Eigen::Index last = motion.dofs.rows() - 1;
  if (!(last / motion.fps * fps < kMostFrames))
    throw std::invalid_argument("resample: expected at most " + std::to_string(kMostFrames) + " frames, found " +
                                options::to_text(last / motion.fps * fps, 4) + " at " + options::to_text(fps) + " 1/s");
  const auto count = static_cast<Eigen::Index>(std::floor(last / motion.fps * fps + kEnd)) + 1;
  Motion result{fps, MatrixRM(count, motion.dofs.cols())};
  for (Eigen::Index t = 0; t < count; ++t) {
    const double at = std::min<double>(t / fps * motion.fps, last);
    const auto i = std::min<Eigen::Index>(static_cast<Eigen::Index>(at), std::max<Eigen::Index>(last - 1, 0));
    const Eigen::VectorXd a = motion.dofs.row(i), b = motion.dofs.row(std::min(i + 1, last));
    result.dofs.row(t) = interpolate_pose(skeleton, a, b, at - i);
  }
  return result;
}

Motion blend_in(const Skeleton &skeleton, const Motion &motion, double hold_seconds, double blend_seconds) {
  require_motion(skeleton, motion, "blend_in");
  if (!(hold_seconds >= 0) || !(blend_seconds >= 0) || hold_seconds + blend_seconds > 3600)
    throw std::invalid_argument("blend_in: hold_seconds and blend_seconds must be in [0, 3600], found " +
                                options::to_text(hold_seconds) + " and " + options::to_text(blend_seconds));
  const auto hold = static_cast<Eigen::Index>(std::lround(hold_seconds * motion.fps));
  const auto blend = static_cast<Eigen::Index>(std::lround(blend_seconds * motion.fps));
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(motion.dofs.cols()), first = motion.dofs.row(0);
  Motion result{motion.fps, MatrixRM::Zero(hold + blend + motion.dofs.rows(), motion.dofs.cols())};
  for (Eigen::Index t = 0; t < blend; ++t) {
    const double x = static_cast<double>(t) / blend;
    result.dofs.row(hold + t) = interpolate_pose(skeleton, rest, first, x * x * (3 - 2 * x));
  }
  result.dofs.bottomRows(motion.dofs.rows()) = motion.dofs;
  return result;
}

} // namespace doublet
