#include "session_check/checks.h"

namespace doublet::detail {
namespace {

constexpr double kFits = kScanPoseOverlap;  // of a silhouette with the scan
constexpr double kClearly = 0.05;           // by which one explanation is better than another
constexpr double kMirrorFits = 0.7;         // at least, for the images to be mirrored
constexpr const char *kWhere = "frame 0: "; // of the first frame alone: another one is chosen because it fits
constexpr const char *kAdvice = "; do scan, calibration and time belong together?";

/// Do both silhouettes fit the other camera, where neither fits its own?
bool is_swapped(const MatrixRM &table, int i, int j) {
  return table(i, j) > table(i, i) + kClearly && table(j, i) > table(j, j) + kClearly &&
         std::min(table(i, j), table(j, i)) > kFits;
}

Findings swapped_cameras(const Evidence &evidence, const std::vector<int> &seen) {
  const MatrixRM &table = evidence.found.overlaps;
  const CameraRig &rig = evidence.session.rig;
  Findings found;
  for (const int i : seen)
    for (const int j : seen)
      if (i < j && is_swapped(table, i, j))
        found.push_back({true, kWhere + ("expected videos in the order of the calibration, found that " + rig[i].name) + " and " +
                                   rig[j].name + " look swapped (overlap " + printed("%.2f", table(i, i)) + " and " +
                                   printed("%.2f", table(j, j)) + ", swapped " + printed("%.2f", table(i, j)) + " and " +
                                   printed("%.2f", table(j, i)) + ")"});
  return found;
}

Findings check_start(Evidence &evidence) {
  look_at(evidence, find_start_frame(evidence.scan, evidence.session.rig, evidence.frames, evidence.extractor, evidence.context));
  const StartFrame &start = *evidence.found.start;
  if (start.in_scan_pose())
    return {};
  const std::string nearest =
      "found none: nearest is frame " + std::to_string(start.frame) + " with an overlap of " + printed("%.2f", start.overlap);
  if (start.near_scan_pose())
    return {{false, "expected a frame in the scan's pose, " + printed("%g", kFits) + " at least, " + nearest +
                        ", and the pose is searched there"}};
  return {{true, "expected a frame in the scan's pose, or near it, " + nearest + kAdvice}};
}

} // namespace

Findings check_overlap(Evidence &evidence) {
  const std::vector<int> seen = evidence.seen();
  if (seen.empty())
    return {};
  std::vector<double> own, mirrored;
  std::vector<std::string> bad;
  for (const int c : seen) {
    own.push_back(evidence.found.overlaps(c, c));
    mirrored.push_back(evidence.mirrored[c]);
    if (own.back() < kFits)
      bad.push_back(evidence.session.rig[c].name + " " + printed("%.2f", own.back()));
  }
  const double middle = middle_of(own), in_mirror = middle_of(mirrored);
  if (in_mirror > std::max(middle + kClearly, kMirrorFits))
    return {{true, kWhere + std::string("expected images as the camera saw them, found mirrored ones (overlap with the scan ") +
                       printed("%.2f", in_mirror) + " when mirrored, " + printed("%.2f", middle) + " as they are)"}};
  if (Findings swapped = swapped_cameras(evidence, seen); !swapped.empty())
    return swapped;
  if (!bad.empty() && middle < kFits)
    return check_start(evidence);
  if (!bad.empty())
    return {{false, kWhere + ("expected scan and silhouettes to overlap by at least " + printed("%g", kFits)) + ", found " +
                        joined(bad) + kAdvice}};
  return {};
}

std::string describe_start(const std::optional<StartFrame> &start) {
  if (!start || !start->in_scan_pose())
    return "";
  const std::string overlap = printed("%.2f", start->overlap);
  if (start->frame == 0)
    return "frame 0 is in the scan's pose, but in another place: overlap " + overlap + " with the scan moved and turned";
  return "frame 0 is not in the scan's pose (overlap " + printed("%.2f", start->first_overlap) + "); frame " +
         std::to_string(start->frame) + " is (" + overlap + "), and tracking begins there and goes both ways";
}

} // namespace doublet::detail
