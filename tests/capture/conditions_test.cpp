// What sessions do to a tracker: fewer cameras, motion blur, no colour.

#include "tracker_scene.h"

#include <gtest/gtest.h>

using namespace doublet;
using namespace tracker_scene;

namespace conditions_test {

double joint_error(const CaptureResult &result, const RiggedMesh &actor, const MatrixRM &truth) {
  double sum = 0;
  for (int t = 0; t < truth.rows(); ++t)
    sum += mean_distance(result.performance.joints[t],
                         joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, truth.row(t))));
  return sum / truth.rows();
}

/// Masks of an open shutter: a pixel is actor where the actor covers it for half of the exposure or more. No images.
class Blurred : public FrameSource {
public:
  Blurred(const RiggedMesh &actor, const CameraRig &rig, const MatrixRM &substeps, int exposure)
      : sharp_(actor, rig, surfaces(actor, substeps)), exposure_(exposure) {}
  int frame_count() const override { return sharp_.frame_count() / exposure_; }
  int camera_count() const override { return sharp_.camera_count(); }
  Image image(int, int) override { return {}; }
  Image mask(int camera, int frame) override {
    Image mask = sharp_.mask(camera, frame * exposure_);
    std::vector<int> covered(mask.data.size(), 0);
    for (int k = 0; k < exposure_; ++k) {
      const Image part = sharp_.mask(camera, frame * exposure_ + k);
      for (size_t p = 0; p < covered.size(); ++p)
        covered[p] += part.data[p] > 0;
    }
    for (size_t p = 0; p < covered.size(); ++p)
      mask.data[p] = 2 * covered[p] >= exposure_ ? 255 : 0;
    return mask;
  }

private:
  Frames sharp_;
  int exposure_;
};

TEST(Conditions, MotionBlurredSilhouettesAlone) {
  constexpr int kExposure = 5, kFrames = 8;
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  MatrixRM substeps(kFrames * kExposure, actor.skeleton.dof_count()), truth(kFrames, actor.skeleton.dof_count());
  const MatrixRM fine = motion(actor, kFrames + 1);
  for (int t = 0; t < kFrames; ++t) {
    for (int k = 0; k < kExposure; ++k)
      substeps.row(t * kExposure + k) = fine.row(t) + k / double(kExposure) * (fine.row(t + 1) - fine.row(t));
    truth.row(t) = substeps.row(t * kExposure + kExposure / 2); // the middle of the exposure
  }
  Blurred frames(actor, rig, substeps, kExposure);
  const CaptureResult result = PerformanceCapture::create()->capture(actor, rig, frames, nullptr, Context());
  EXPECT_LT(joint_error(result, actor, truth), 0.012); // a pixel is 11 mm on the figure
  EXPECT_TRUE(result.summary.lost_limbs.empty());
}

TEST(Conditions, SomeOfTheCameras) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  const MatrixRM dofs = motion(actor, 3);
  Frames all(actor, rig, surfaces(actor, dofs));
  CaptureOptions options;
  options.cameras = {"cam6", "cam0", "cam3", "cam5"};
  const CaptureResult chosen = PerformanceCapture::create(options)->capture(actor, rig, all, nullptr, Context());
  const CameraRig some = {rig[0], rig[3], rig[5], rig[6]}; // the rig's order
  Frames only(actor, some, surfaces(actor, dofs));
  const CaptureResult alone = PerformanceCapture::create()->capture(actor, some, only, nullptr, Context());
  EXPECT_EQ(chosen.performance.dofs, alone.performance.dofs);
  ASSERT_EQ(chosen.observations.cameras.size(), 4u);
  EXPECT_EQ(chosen.observations.cameras[1].name, "cam3");
  EXPECT_EQ(chosen.observations.views[2].size(), 4u);
  EXPECT_LT(joint_error(chosen, actor, dofs), 0.012);
  options.cameras = {"cam0", "cam9"};
  EXPECT_THROW(PerformanceCapture::create(options)->capture(actor, rig, all, nullptr, Context()), std::invalid_argument);
  options.cameras = {"cam0", "cam0"};
  EXPECT_THROW(PerformanceCapture::create(options)->capture(actor, rig, all, nullptr, Context()), std::invalid_argument);
}

} // namespace conditions_test
