#include "session_check/checks.h"

#include "doublet/core/parts/quantile.h"

#include <cmath>

namespace doublet::detail {
namespace {

constexpr double kNearest = 0.3, kUsualDistance = 4, kFarthest = 100; // m, of cameras
constexpr double kInPicture = 0.02;                                   // share of the scan that a camera must see
constexpr double kSameRate = 0.02;                                    // share by which frame rates may differ

/// Share of the vertices that the camera sees, distortion aside.
double share_in_picture(const Camera &camera, const Vertices &vertices) {
  int inside = 0;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const Eigen::Vector3d local = camera.R * vertices.row(v).transpose() + camera.t;
    if (local.z() <= 1e-6)
      continue;
    const Eigen::Vector3d pixel = camera.K * (local / local.z());
    inside += pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera.width && pixel.y() < camera.height;
  }
  return static_cast<double>(inside) / static_cast<double>(vertices.rows());
}

} // namespace

Findings check_calibration(Evidence &evidence) {
  const Vertices &vertices = evidence.scan.vertices;
  const CameraRig &rig = evidence.session.rig;
  const Eigen::Vector3d centre = vertices.colwise().mean();
  std::vector<double> distances;
  for (const Camera &camera : rig)
    distances.push_back((camera.centre() - centre).norm());
  const double away = middle_of(distances);
  const std::string where = "the calibration of " + evidence.session.name + ": expected ";
  if (!(kNearest < away && away < kFarthest))
    return {{true, where + "cameras " + printed("%g", kNearest) + " to " + printed("%g", kFarthest) + " m from the scan, found " +
                       printed("%.4g", away) + " m" + likely_unit(away, kUsualDistance)}};
  std::vector<std::string> blind;
  for (const Camera &camera : rig)
    if (share_in_picture(camera, vertices) < kInPicture)
      blind.push_back(camera.name);
  if (blind.empty())
    return {};
  return {
      {2 * blind.size() > rig.size(), where + "the scan in every camera's picture, found it outside that of " + joined(blind)}};
}

Findings check_rates(Evidence &evidence) {
  std::vector<double> rates; // of those that say one
  for (const SessionCamera &camera : evidence.session.cameras)
    if (camera.video_fps > 0)
      rates.push_back(camera.video_fps);
  if (rates.empty())
    return {};
  const double usual = median(rates), fps = evidence.session.fps; // of two cameras one's: between them lies that of none
  const auto differs = [&](double rate) { return std::abs(rate - usual) > kSameRate * usual; };
  std::vector<std::string> others;
  for (const SessionCamera &camera : evidence.session.cameras)
    if (camera.video_fps > 0 && differs(camera.video_fps))
      others.push_back(camera.name + " " + printed("%.4g", camera.video_fps));
  if (!others.empty())
    return {
        {true, "videos: expected one frame rate, found " + joined(others) + " and " + printed("%.4g", usual) + " in the others"}};
  if (differs(fps))
    return {
        {false, "session.json: expected the videos' frame rate " + printed("%.4g", usual) + ", found " + printed("%.4g", fps)}};
  return {};
}

} // namespace doublet::detail
