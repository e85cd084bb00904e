#pragma once

#include "doublet/capture/session.h"

#include <utility>

namespace doublet {

/// Frames of cameras some of which are late: what they show `delays` frames later belongs to this one. Before a camera's first
/// frame and after its last one it shows nothing. Refers to what it was made from.
class DelayedFrames : public FrameSource {
public:
  DelayedFrames(FrameSource &all, std::vector<int> delays) : all_(all), delays_(std::move(delays)) {}
  int frame_count() const override { return all_.frame_count(); }
  int camera_count() const override { return all_.camera_count(); }
  Image image(int camera, int frame) override { return filmed(camera, frame) ? all_.image(camera, at(camera, frame)) : Image(); }
  Image mask(int camera, int frame) override { return filmed(camera, frame) ? all_.mask(camera, at(camera, frame)) : Image(); }
  std::vector<Keypoint> keypoints(int camera, int frame) override {
    return filmed(camera, frame) ? all_.keypoints(camera, at(camera, frame)) : std::vector<Keypoint>();
  }

private:
  int at(int camera, int frame) const { return frame + delays_.at(static_cast<std::size_t>(camera)); }
  bool filmed(int camera, int frame) const { return at(camera, frame) >= 0 && at(camera, frame) < all_.frame_count(); }

  FrameSource &all_;
  std::vector<int> delays_;
};

} // namespace doublet
