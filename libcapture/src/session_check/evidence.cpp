#include "session_check/evidence.h"

#include "doublet/capture/mesh_file.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/core/rasterizer.h"
#include "frames/frame_reader.h"
#include "placed.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet::detail {
namespace {

constexpr int kCheckedSize = 500; // px, larger side of the images that are compared
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Camera small_camera(const Camera &camera) {
  const double scale = std::min(1.0, static_cast<double>(kCheckedSize) / std::max(camera.width, camera.height));
  const auto side = [&](int full) { return std::max(1, static_cast<int>(std::lround(scale * full))); };
  return camera.resized(side(camera.width), side(camera.height));
}

/// The pixels of which half and more is inside.
Image small_mask(const Image &mask, int width, int height) {
  if (mask.empty())
    return {};
  const cv::Mat full(mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t *>(mask.data.data()));
  cv::Mat result;
  cv::resize(full > 0, result, {width, height}, 0, 0, cv::INTER_AREA);
  return to_image(result > 127);
}

Image mirror_image(Image mask) {
  for (int y = 0; y < mask.height; ++y)
    std::reverse(mask.data.begin() + static_cast<std::ptrdiff_t>(y) * mask.width,
                 mask.data.begin() + static_cast<std::ptrdiff_t>(y + 1) * mask.width);
  return mask;
}

double share_of(const Image &mask) {
  if (mask.empty())
    return kNone;
  return static_cast<double>(std::count_if(mask.data.begin(), mask.data.end(), [](std::uint8_t p) { return p > 0; })) /
         static_cast<double>(mask.data.size());
}

bool can_be_actor(double share) {
  return kNoActor < share && share < kAllActor;
}

/// (N, 3) points of the scan where it is placed in that frame.
Vertices in_place(const Evidence &evidence, const Vertices &points) {
  return evidence.found.start ? placed(points, evidence.found.start->world_from_scan) : points;
}

void compare_with_scan(Evidence &evidence, const std::vector<Image> &masks) {
  SessionCheck &found = evidence.found;
  const int count = static_cast<int>(found.rig.size());
  const Vertices vertices = in_place(evidence, evidence.scan.vertices);
  found.shadows.resize(count);
  parallel_for(evidence.context, count,
               [&](int c) { found.shadows[c] = silhouette(rasterize(vertices, evidence.scan.faces, found.rig[c])); });
  found.overlaps = MatrixRM::Constant(count, count, kNone);
  evidence.mirrored = Eigen::VectorXd::Constant(count, kNone);
  parallel_for(evidence.context, count, [&](int i) {
    if (!can_be_actor(evidence.shares[i]))
      return;
    for (int j = 0; j < count; ++j)
      found.overlaps(i, j) = mask_iou(small_mask(masks[i], found.rig[j].width, found.rig[j].height), found.shadows[j]);
    evidence.mirrored[i] = mask_iou(mirror_image(found.silhouettes[i]), found.shadows[i]);
  });
}

void look_at_frame(Evidence &evidence) {
  SessionCheck &found = evidence.found;
  const int count = static_cast<int>(found.rig.size());
  std::vector<Image> masks(count);
  found.silhouettes.resize(count);
  evidence.shares.resize(count);
  parallel_for(evidence.context, count, [&](int c) {
    masks[c] = read_view(evidence.frames, c, found.frame(), evidence.extractor).mask;
    found.silhouettes[c] = small_mask(masks[c], found.rig[c].width, found.rig[c].height);
    evidence.shares[c] = share_of(masks[c]);
  });
  Vertices joints(evidence.session.joints.size(), 3);
  for (Eigen::Index j = 0; j < joints.rows(); ++j)
    joints.row(j) = evidence.session.joints[j].position;
  found.joints = in_place(evidence, joints);
  if (evidence.scanned())
    compare_with_scan(evidence, masks);
}

} // namespace

std::vector<int> Evidence::seen() const {
  std::vector<int> cameras;
  for (int c = 0; c < static_cast<int>(shares.size()); ++c)
    if (can_be_actor(shares[c]))
      cameras.push_back(c);
  return cameras;
}

Evidence gather_evidence(const Session &session, FrameSource &frames, const SilhouetteExtractor *extractor,
                         const Context &context) {
  if (session.rig.empty() || session.cameras.size() != session.rig.size() ||
      frames.camera_count() != static_cast<int>(session.rig.size()) || frames.frame_count() < 1)
    throw std::invalid_argument("check_session: expected frames of the session's " + std::to_string(session.rig.size()) +
                                " cameras, found " + std::to_string(frames.frame_count()) + " of " +
                                std::to_string(frames.camera_count()));
  Evidence evidence{session, frames, extractor, context};
  if (!session.scan.empty())
    evidence.scan = read_mesh(session.scan);
  std::transform(session.rig.begin(), session.rig.end(), std::back_inserter(evidence.found.rig), small_camera);
  look_at_frame(evidence);
  return evidence;
}

void look_at(Evidence &evidence, const StartFrame &start) {
  evidence.found.start = start;
  look_at_frame(evidence);
}

double actor_share(const Evidence &evidence, int camera, int frame) {
  if (frame == evidence.found.frame())
    return evidence.shares[camera];
  return share_of(read_view(evidence.frames, camera, frame, evidence.extractor).mask);
}

double middle_of(const std::vector<double> &values) {
  return 0.5 * (quantile(values, 0.5) + median(values));
}

} // namespace doublet::detail
