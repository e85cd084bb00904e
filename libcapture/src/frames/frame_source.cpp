#include "doublet/capture/session.h"
#include "doublet/core/error.h"
#include "frame_reader.h"
#include "keypoint_file.h"
#include "lens_map.h"

#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

namespace doublet {
namespace {

using detail::to_image;

/// What a recorder writes for a camera that fails: black, or any other colour, but for the codec's noise.
bool single_colour(const cv::Mat &bgr) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(bgr, mean, deviation);
  return deviation[0] < 1.5 && deviation[1] < 1.5 && deviation[2] < 1.5;
}

/// From 128 on is actor: survives lossy mask videos and label images that mark parts with different greys.
Image to_mask(const cv::Mat &bgr) {
  cv::Mat grey, mask;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::threshold(grey, mask, 127, 255, cv::THRESH_BINARY);
  return to_image(mask);
}

class SessionFrames : public FrameSource {
public:
  explicit SessionFrames(const Session &session)
      : session_(session), maps_(session.cameras.size()), videos_(session.cameras.size()), masks_(session.cameras.size()) {
    if (!session.keypoints.empty())
      keypoints_ = detail::read_keypoints(session.keypoints, session.cameras, session.frame_count);
  }

  int frame_count() const override { return session_.frame_count; }
  int camera_count() const override { return static_cast<int>(session_.cameras.size()); }

  Image image(int camera, int frame) override {
    check(camera, frame);
    const cv::Mat mat = read(session_.cameras[camera].video, videos_[camera], in_file(camera, frame));
    check_size(mat, camera, frame, session_.cameras[camera].video);
    if (mat.empty() || single_colour(mat))
      return {};
    const detail::LensMap *lens = lens_of(camera);
    return to_image(lens ? lens->image(mat) : mat);
  }

  Image mask(int camera, int frame) override {
    check(camera, frame);
    const cv::Mat mat = read(session_.cameras[camera].masks, masks_[camera], in_file(camera, frame));
    check_size(mat, camera, frame, session_.cameras[camera].masks);
    if (mat.empty())
      return {};
    const detail::LensMap *lens = lens_of(camera);
    return to_mask(lens ? lens->mask(mat) : mat);
  }

  std::vector<Keypoint> keypoints(int camera, int frame) override {
    check(camera, frame);
    const int number = in_file(camera, frame);
    if (keypoints_.empty() || keypoints_[camera].empty() || number < 0)
      return {};
    const auto first = keypoints_[camera].begin() + std::ptrdiff_t{number} * kKeypoints;
    std::vector<Keypoint> found(first, first + kKeypoints);
    if (const detail::LensMap *lens = lens_of(camera))
      for (Keypoint &keypoint : found)
        if (keypoint.counts())
          keypoint.pixel = lens->pixel(keypoint.pixel);
    return found;
  }

private:
  void check(int camera, int frame) const {
    if (camera < 0 || camera >= camera_count())
      throw std::invalid_argument("camera: expected 0 to " + std::to_string(camera_count() - 1) + ", found " +
                                  std::to_string(camera));
    if (frame < 0 || frame >= frame_count())
      throw std::invalid_argument("frame: expected 0 to " + std::to_string(frame_count() - 1) + ", found " +
                                  std::to_string(frame));
  }

  /// The number in the file; below 0 where a camera that is late, or early, was not filming.
  int in_file(int camera, int frame) const {
    const int own = frame + session_.cameras[camera].late;
    return own < 0 || own >= session_.frame_count ? -1 : own + session_.cameras[camera].first_frame;
  }

  static cv::Mat read(const std::filesystem::path &path, std::unique_ptr<detail::FrameReader> &reader, int frame) try {
    if (path.empty() || frame < 0)
      return {};
    if (!reader)
      reader = detail::FrameReader::open(path);
    return reader->read(frame);
  } catch (const cv::Exception &e) {
    throw Error(path.string() + ": frame " + std::to_string(frame) + " cannot be read (" + e.err + ")");
  }

  /// What is to be undone; null if nothing is.
  const detail::LensMap *lens_of(int camera) {
    if (session_.lenses.empty() || !session_.lenses[camera].needs_undistortion())
      return nullptr;
    if (!maps_[camera])
      maps_[camera].emplace(session_.rig[camera], session_.lenses[camera]);
    return &*maps_[camera];
  }

  void check_size(const cv::Mat &mat, int camera, int frame, const std::filesystem::path &path) const {
    const Camera &expected = session_.rig[camera];
    if (!mat.empty() && (mat.cols != expected.width || mat.rows != expected.height))
      throw Error(path.string() + ": expected " + std::to_string(expected.width) + " x " + std::to_string(expected.height) +
                  " pixels, found " + std::to_string(mat.cols) + " x " + std::to_string(mat.rows) + " at frame " +
                  std::to_string(frame));
  }

  Session session_;
  std::vector<std::optional<detail::LensMap>> maps_;                 // made when first needed
  std::vector<std::unique_ptr<detail::FrameReader>> videos_, masks_; // opened when first asked for
  std::vector<std::vector<Keypoint>> keypoints_; // [cameras] of the frames of its file; none if there are none
};

} // namespace

std::vector<Keypoint> FrameSource::keypoints(int, int) {
  return {};
}

std::unique_ptr<FrameSource> FrameSource::open(const Session &session) {
  if (session.rig.size() != session.cameras.size())
    throw std::invalid_argument("session: expected one calibrated camera for each of its " +
                                std::to_string(session.cameras.size()) + " cameras, found " + std::to_string(session.rig.size()));
  if (!session.lenses.empty() && session.lenses.size() != session.cameras.size())
    throw std::invalid_argument("session: expected no lenses, or one for each of its " + std::to_string(session.cameras.size()) +
                                " cameras, found " + std::to_string(session.lenses.size()));
  return std::make_unique<SessionFrames>(session);
}

} // namespace doublet
