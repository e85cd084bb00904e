#include "start_pose.h"

#include "doublet/capture/start_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace doublet::detail {
namespace {

[[noreturn]] void refuse_to_start(const std::string &found) {
  throw Error("capture: expected a frame in the scan's pose, or one in which the pose can be found, found none (" + found +
              "); do scan, calibration and videos belong together? start_frame names a frame that is near the scan's pose");
}

FoundPose pose_in(const TrackingJob &job, TakeMeasurements &measurements, const Eigen::VectorXd &reliability,
                  const KeypointPlaces &places, int video_frame) {
  const std::vector<ViewMeasurement> views = measurements.look(video_frame - job.options.first_frame, nullptr);
  const std::vector<Image> masks = masks_of(views);
  std::vector<Outline> outlines;
  for (const ViewMeasurement &view : views)
    outlines.push_back(view.outline);
  const StartProblem problem{&job.actor, &job.rig, &outlines, &masks, reliability, places.points(seen_joints(views, job.rig))};
  return search_pose(problem, *job.parts.pose, *job.parts.limbs, job.options.limbs, job.context);
}

void begin_at(const TrackingJob &job, int video_frame, const Eigen::VectorXd &dofs, StartPose &start) {
  if (video_frame != job.frame(start.t))
    start.views.clear();
  start.t = video_frame - job.options.first_frame;
  start.dofs = dofs;
}

/// The pose in the first of the frames where it is beyond doubt which way the actor faces, or in the one that leaves the least.
/// What a garment hides is where the scan has it, so that the most alike comes first.
void search_pose_in(const TrackingJob &job, TakeMeasurements &measurements, const Eigen::VectorXd &reliability,
                    const KeypointPlaces &places, const std::vector<LikelyStart> &likely, StartPose &start) {
  constexpr double kUsable = 0.35; // wrong pixels against those of the actor: a wide skirt that flies has 0.2
  constexpr double kDoubt = 0.85;  // wrong against rival; 0.3 to 0.7 where the actor faces the right way
  FoundPose best;
  double doubt = 2, least_wrong = 1;
  for (const LikelyStart &one : likely) {
    const FoundPose found = pose_in(job, measurements, reliability, places, one.frame);
    least_wrong = std::min(least_wrong, found.wrong);
    if (found.wrong > kUsable || found.wrong / found.rival >= doubt)
      continue;
    best = found;
    doubt = found.wrong / found.rival;
    begin_at(job, one.frame, found.dofs, start);
    start.searched = true;
    if (doubt < kDoubt)
      break;
  }
  if (doubt > 1)
    refuse_to_start("with the best one " + options::to_text(std::round(100 * least_wrong), 3) +
                    " % of the silhouettes are wrong");
  job.say("the pose was found in frame %d, where %.0f %% of the silhouettes are wrong; it goes on from there, and back",
          job.frame(start.t), 100 * best.wrong);
  if (doubt >= kDoubt)
    job.say("which way the actor faces is in doubt: turned round, %.0f %% are wrong", 100 * best.rival);
}

} // namespace

StartPose find_start_pose(const TrackingJob &job, TakeMeasurements &measurements, const Eigen::VectorXd &reliability,
                          const KeypointPlaces &places, double &seconds) {
  constexpr int kTries = 3;
  const int first = job.options.first_frame;
  const bool given = job.options.start_frame >= 0;
  StartPose start;
  start.t = given ? job.options.start_frame - first : 0;
  start.views = measurements.look(start.t, job.tracker());
  const Stopwatch watch(seconds);
  const PlacedPose placed = first_pose(job.actor, job.rig, masks_of(start.views), job.context);
  start.dofs = placed.dofs;
  if (placed.overlap >= kScanPoseOverlap)
    return start;
  std::vector<LikelyStart> likely{{job.frame(start.t), placed}};
  if (!given)
    likely = frames_like_the_scan(job.actor, job.rig, job.frames, job.extractor, first, job.count, kTries, job.context);
  if (likely.empty() || likely.front().placed.overlap == 0)
    return start; // fewer than two cameras: nothing tells one place from another
  const double best = likely.front().placed.overlap;
  job.say("frame %d is not in the scan's pose (overlap %.2f, expected %.1f)", job.frame(start.t), placed.overlap,
          kScanPoseOverlap);
  if (best < kNearScanPose && !given)
    refuse_to_start("at best frame " + std::to_string(likely.front().frame) + " overlaps the scan by " +
                    options::to_text(best, 2) + ", expected " + options::to_text(kNearScanPose, 2));
  if (best >= kScanPoseOverlap) {
    begin_at(job, likely.front().frame, likely.front().placed.dofs, start);
    job.say("frame %d is (overlap %.2f); it goes on from there, and back", job.frame(start.t), best);
  } else {
    search_pose_in(job, measurements, reliability, places, likely, start);
  }
  return start;
}

} // namespace doublet::detail
