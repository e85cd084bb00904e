#include "camera_choice.h"

#include <algorithm>
#include <stdexcept>

namespace doublet {
namespace {

class ChosenFrames : public FrameSource {
public:
  ChosenFrames(FrameSource &all, std::vector<int> cameras) : all_(all), cameras_(std::move(cameras)) {}
  int frame_count() const override { return all_.frame_count(); }
  int camera_count() const override { return static_cast<int>(cameras_.size()); }
  Image image(int camera, int frame) override { return all_.image(cameras_.at(camera), frame); }
  Image mask(int camera, int frame) override { return all_.mask(cameras_.at(camera), frame); }
  std::vector<Keypoint> keypoints(int camera, int frame) override { return all_.keypoints(cameras_.at(camera), frame); }

private:
  FrameSource &all_;
  std::vector<int> cameras_;
};

class ChosenExtractor : public SilhouetteExtractor {
public:
  ChosenExtractor(const SilhouetteExtractor &all, std::vector<int> cameras) : all_(all), cameras_(std::move(cameras)) {}
  void train(int, const std::vector<Image> &) override {
    throw std::logic_error("the extractor of some cameras is trained as a whole, before they are chosen");
  }
  Image extract(int camera, const Image &image) const override { return all_.extract(cameras_.at(camera), image); }
  Image refine(int camera, const Image &image, const Image &mask) const override {
    return all_.refine(cameras_.at(camera), image, mask);
  }

private:
  const SilhouetteExtractor &all_;
  std::vector<int> cameras_;
};

std::vector<int> find_cameras(const std::vector<std::string> &names, const CameraRig &rig) {
  std::vector<int> cameras;
  for (int c = 0; c < static_cast<int>(rig.size()); ++c)
    if (names.empty() || std::find(names.begin(), names.end(), rig[c].name) != names.end())
      cameras.push_back(c);
  for (const std::string &name : names) {
    if (std::none_of(rig.begin(), rig.end(), [&](const Camera &c) { return c.name == name; })) {
      std::string known;
      for (const Camera &c : rig)
        known += (known.empty() ? "" : ", ") + c.name;
      throw std::invalid_argument("CaptureOptions: cameras names '" + name + "', the rig has " + known);
    }
    if (std::count(names.begin(), names.end(), name) > 1)
      throw std::invalid_argument("CaptureOptions: cameras names '" + name + "' twice");
  }
  return cameras;
}

} // namespace

CameraChoice::CameraChoice(const std::vector<std::string> &names, const CameraRig &rig, FrameSource &frames,
                           const SilhouetteExtractor *extractor) {
  const std::vector<int> cameras = find_cameras(names, rig);
  for (int c : cameras)
    rig_.push_back(rig[c]);
  frames_ = std::make_unique<ChosenFrames>(frames, cameras);
  if (extractor)
    extractor_ = std::make_unique<ChosenExtractor>(*extractor, cameras);
}

} // namespace doublet
