#include "camera_check.h"

#include "first_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <utility>
#include <vector>

namespace doublet::detail {
namespace {

constexpr double kLeastPart = 0.1; // of a frame, in which a limb moves by millimetres

CalibrationProblem calibration_problem(const CameraEvidence &evidence, const Eigen::VectorXd &reliability) {
  CalibrationProblem problem;
  problem.actor = &evidence.job.actor;
  problem.given = evidence.studio.given;
  problem.rig = evidence.job.rig;
  problem.reliability = reliability;
  return problem;
}

/// Does the actor stand where the scan was made, as far as the given cameras tell?
bool where_the_scan_is(const CameraEvidence &evidence, int t) {
  constexpr double kNear = 0.05, kNearlyTurned = 0.1; // m, rad
  const int root = root_joint(evidence.job.actor.skeleton).first_dof;
  const Eigen::VectorXd pose = evidence.poses.row(t);
  return pose.segment<3>(root).norm() < kNear && pose.segment<3>(root + 3).norm() < kNearlyTurned;
}

/// A problem, and the outlines that its moments look at.
struct FilmedProblem {
  CalibrationProblem problem;
  std::deque<std::vector<Outline>> outlines;
  /// The frame index t, in the pose of a row.
  void add_moment(const CameraEvidence &evidence, int t, int row, Vertices offset, bool in_scan_pose) {
    outlines.push_back(evidence.measured.outlines_at(t));
    problem.moments.push_back({row, &outlines.back(), std::move(offset), in_scan_pose});
  }
  void add_start(const CameraEvidence &evidence, int row) {
    const int start = evidence.order.start;
    add_moment(evidence, start, row, Vertices(0, 3), where_the_scan_is(evidence, start));
  }
};

CalibrationEstimate by_take(const CameraEvidence &evidence, const Eigen::VectorXd &reliability) {
  FilmedProblem filmed{calibration_problem(evidence, reliability), {}};
  filmed.problem.poses = evidence.poses;
  const Eigen::VectorXd loose = 1 - reliability.array();
  const CalibrationRefinementOptions &options = evidence.job.options.calibration;
  const int count = evidence.job.count, moments = std::min(options.moments, count);
  for (int k = 0; k < moments; ++k) {
    const int t = static_cast<int>((2 * k + 1) * static_cast<long>(count) / (2 * moments));
    filmed.add_moment(evidence, t, t, loose.asDiagonal() * evidence.memory.offsets()[t], false);
  }
  if (!evidence.start_searched)
    filmed.add_start(evidence, evidence.order.start);
  return refine_calibration(filmed.problem, options, evidence.job.context);
}

} // namespace

CalibrationEstimate cameras_by_start(const CameraEvidence &evidence) {
  FilmedProblem filmed{calibration_problem(evidence, evidence.memory.reliability()), {}};
  filmed.problem.poses = evidence.poses.row(evidence.order.start);
  filmed.problem.timed = false;
  filmed.add_start(evidence, 0);
  return refine_calibration(filmed.problem, evidence.job.options.calibration, evidence.job.context);
}

CalibrationEstimate cameras_by_take(const CameraEvidence &evidence) {
  const CaptureOptions &options = evidence.job.options;
  ClothDeviation settled = evidence.memory.deviation();
  settled.settle(evidence.memory.offsets());
  const Eigen::VectorXd learnt = settled.reliability(),
                        expected = ClothDeviation(evidence.job.actor, options.cloth_deviation_scale).reliability();
  CalibrationEstimate timed;
  if (options.calibration.late > 0)
    timed = by_take(evidence, learnt.cwiseMax(expected));
  if (delayed(timed))
    return timed;
  CalibrationEstimate found = by_take(evidence, learnt);
  for (size_t v = 0; v < timed.cameras.size(); ++v) {
    found.cameras[v].late = timed.cameras[v].late;
    found.cameras[v].late_sure = timed.cameras[v].late_sure;
  }
  return found;
}

bool delayed(const CalibrationEstimate &found) {
  return std::any_of(found.cameras.begin(), found.cameras.end(),
                     [](const RefinedCamera &camera) { return std::abs(camera.late) > 0.5; });
}

Eigen::VectorXd parts_of_a_frame(const CalibrationEstimate &found) {
  constexpr double kClearly = 3; // standard deviations
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(found.cameras.size()));
  for (Eigen::Index v = 0; v < parts.size(); ++v) {
    const RefinedCamera &camera = found.cameras[static_cast<std::size_t>(v)];
    const double part = camera.late - std::round(camera.late);
    if (std::abs(part) > std::max(kLeastPart, kClearly * camera.late_sure))
      parts[v] = part;
  }
  return parts.isZero(0) ? Eigen::VectorXd() : parts;
}

bool timed_otherwise(const CalibrationEstimate &found, const Studio &studio) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(found.cameras.size())),
                        parts = parts_of_a_frame(found);
  return ((parts.size() > 0 ? parts : none) - (studio.parts.size() > 0 ? studio.parts : none)).cwiseAbs().maxCoeff() > kLeastPart;
}

bool clearly_off(const CalibrationEstimate &found, const Studio &studio, double min_change) {
  constexpr double kClearly = 2; // standard deviations
  const auto seen = [](const RefinedCamera &camera) { return camera.seen; };
  return std::count_if(found.cameras.begin(), found.cameras.end(), seen) >= 3 && found.after_px < found.before_px &&
         (studio.moved ? found.change > min_change / 2 : found.change > std::max(min_change, kClearly * found.sure));
}

void move_cameras(Studio &studio, const CamerasMoved &moved, const Context &context) {
  const CalibrationEstimate &found = moved.found;
  if (!moved.late_alone) {
    studio.rig = found.rig;
    studio.moved = true;
  }
  ++studio.refined;
  studio.by_take = studio.by_take || moved.by_take;
  studio.found = found.cameras;
  studio.parts = parts_of_a_frame(found);
  std::string late;
  for (size_t v = 0; v < studio.rig.size(); ++v) {
    const double part = studio.parts.size() > 0 ? studio.parts[static_cast<Eigen::Index>(v)] : 0;
    studio.delays[v] += static_cast<int>(std::lround(found.cameras[v].late));
    if (studio.delays[v] + part != 0)
      late += (late.empty() ? "" : ", ") + studio.rig[v].name + " by " + options::to_text(studio.delays[v] + part, 3);
    studio.found[v].delay = studio.delays[v];
    studio.found[v].late = studio.delays[v] + part;
  }
  char line[160];
  std::snprintf(line, sizeof line, "the calibration is %.1f mm off on the actor (outlines %.2f px, %.2f when refined)",
                1000 * found.change, found.before_px, found.after_px);
  const std::string cameras = moved.late_alone ? "the calibration stays as it is" : line;
  context.log_line("capture: " + cameras + (late.empty() ? "" : "; frames late: " + late) + "; tracking starts again");
}

} // namespace doublet::detail
