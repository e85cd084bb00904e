// Nonsense is found before anything runs: a person filmed by six cameras, one thing wrong at a time.

#include "doublet/capture/mesh_file.h"
#include "doublet/capture/session_check.h"
#include "doublet/core/rasterizer.h"
#include "doublet/core/skinning.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace session_check_test {

using namespace doublet;

constexpr int kSize = 160, kFrames = 20;

struct Filmed : FrameSource {
  int frame_count() const override { return kFrames; }
  int camera_count() const override { return cameras; }
  Image image(int, int) override { return {}; }
  Image mask(int camera, int frame) override { return mask_of(camera, frame); }
  int cameras = 0;
  std::function<Image(int, int)> mask_of;
};

/// Everything right; a test spoils one thing.
struct Scene {
  Skeleton skeleton = doublet::testing::figure_skeleton();
  Mesh scan;
  std::vector<Image> masks;
  Filmed film;
  Session session;
  doublet::testing::TempFolder folder;

  Scene() {
    const Eigen::VectorXd pose = posed({{"l_shoulder.z", 60}, {"r_hip.x", -30}, {"r_knee.flex", 40}}); // no mirror shows the same
    scan = doublet::testing::figure_surface(skeleton, pose, 0.045);
    session.folder = folder.path();
    session.name = "made up";
    session.scan = folder / "scan.ply";
    session.fps = 40;
    session.frame_count = kFrames;
    session.rig = doublet::testing::camera_ring(6, kSize);
    for (const Camera &camera : session.rig) {
      SessionCamera filmed;
      filmed.name = camera.name;
      filmed.masks = "masks";
      filmed.video_fps = 40;
      session.cameras.push_back(filmed);
    }
    session.joints = joint_annotations(skeleton);
    const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, pose));
    for (std::size_t j = 0; j < session.joints.size(); ++j)
      session.joints[j].position = joints.row(j);
    masks = shadows(scan);
    film.cameras = static_cast<int>(session.rig.size());
    film.mask_of = [this](int camera, int) { return masks[camera]; };
  }

  Eigen::VectorXd posed(const std::vector<std::pair<const char *, double>> &degrees) const {
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
    for (const auto &[name, angle] : degrees) {
      const auto at = std::find(skeleton.dof_names.begin(), skeleton.dof_names.end(), name);
      dofs[at - skeleton.dof_names.begin()] = angle * doublet::testing::pi / 180;
    }
    return dofs;
  }
  std::vector<Image> shadows(const Mesh &mesh) const {
    std::vector<Image> seen;
    for (const Camera &camera : session.rig)
      seen.push_back(silhouette(rasterize(mesh.vertices, mesh.faces, camera)));
    return seen;
  }
  SessionCheck check() {
    write_mesh(session.scan, scan);
    return check_session(session, film, nullptr, {});
  }
  /// Text of the only finding, which is impossible or not.
  std::string found(bool impossible) {
    const std::vector<Finding> findings = check().findings;
    EXPECT_EQ(findings.size(), 1u);
    if (findings.size() != 1)
      return "";
    EXPECT_EQ(findings[0].impossible, impossible) << findings[0].text;
    return findings[0].text;
  }
  std::string impossible() { return found(true); }
  std::string doubtful() { return found(false); }
  void nothing_found() {
    for (const Finding &finding : check().findings)
      ADD_FAILURE() << finding.text;
  }
};

bool says(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}
#define EXPECT_SAYS(text, part) EXPECT_TRUE(says(text, part)) << (text)

/// Moved within the image; what leaves it on one side comes back on the other.
Image rolled(const Image &mask, int right, int down) {
  Image result = mask;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      result.at((x + right) % mask.width, (y + down) % mask.height) = mask.at(x, y);
  return result;
}

TEST(SessionCheck, WhatIsRightHasNoFindings) {
  Scene scene;
  scene.nothing_found();
  const SessionCheck check = scene.check();
  EXPECT_EQ(check.frame(), 0);
  EXPECT_EQ(check.start_text, "");
  ASSERT_EQ(check.overlaps.rows(), 6);
  ASSERT_EQ(check.silhouettes.size(), 6u);
  for (int c = 0; c < 6; ++c) {
    EXPECT_EQ(check.overlaps(c, c), 1); // as small as they are, images stay
    EXPECT_EQ(check.silhouettes[c].data, scene.masks[c].data);
    EXPECT_EQ(check.shadows[c].data, scene.masks[c].data);
  }
  EXPECT_EQ(check.joints.rows(), static_cast<Eigen::Index>(scene.session.joints.size()));
}

TEST(SessionCheck, LargeImagesAreComparedSmall) {
  Scene scene;
  scene.session.rig = doublet::testing::camera_ring(6, 1004);
  scene.masks = scene.shadows(scene.scan);
  const SessionCheck check = scene.check();
  EXPECT_TRUE(check.findings.empty());
  for (int c = 0; c < 6; ++c) {
    EXPECT_EQ(check.rig[c].width, 500);
    EXPECT_EQ(check.silhouettes[c].height, 500);
    EXPECT_GT(check.overlaps(c, c), 0.99);
  }
}

TEST(SessionCheck, ScansInAnotherUnitAreSaidToBe) {
  for (const auto &[factor, unit] : {std::pair{1000.0, "millimetres"}, {100.0, "centimetres"}, {39.37, "inches"}}) {
    Scene scene;
    scene.scan.vertices *= factor;
    const std::string text = scene.impossible();
    EXPECT_SAYS(text, "scan.ply: expected a person of 0.5 to 2.6 m");
    EXPECT_SAYS(text, unit);
  }
}

TEST(SessionCheck, AScanThatLiesDown) {
  Scene scene;
  const Eigen::Matrix3d down = Eigen::AngleAxisd(doublet::testing::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  scene.scan.vertices *= down;
  EXPECT_SAYS(scene.impossible(), "stands along y");
}

TEST(SessionCheck, JointsInMillimetres) {
  Scene scene;
  for (JointAnnotation &joint : scene.session.joints)
    joint.position *= 1000;
  const std::string text = scene.impossible();
  EXPECT_SAYS(text, "expected marks spread over the scan's");
  EXPECT_SAYS(text, "millimetres");
}

TEST(SessionCheck, JointsBesideTheScan) {
  Scene scene;
  for (JointAnnotation &joint : scene.session.joints)
    joint.position.x() += 0.6;
  EXPECT_SAYS(scene.impossible(), "more than 50 mm outside");
}

TEST(SessionCheck, OneJointOutsideIsOnlyDoubtful) {
  Scene scene;
  const auto hand =
      std::find_if(scene.session.joints.begin(), scene.session.joints.end(), [](const auto &j) { return j.name == "l_hand"; });
  hand->position.z() += 0.4;
  EXPECT_SAYS(scene.doubtful(), "found 1 of 24 more than 50 mm outside (l_hand by ");
}

TEST(SessionCheck, CalibrationInMillimetres) {
  Scene scene;
  for (Camera &camera : scene.session.rig)
    camera.t *= 1000;
  const std::string text = scene.impossible();
  EXPECT_SAYS(text, "the calibration of made up: expected cameras 0.3 to 100 m from the scan");
  EXPECT_SAYS(text, "millimetres");
}

TEST(SessionCheck, CamerasThatLookAwayAreNamed) {
  for (const int count : {2, 4}) {
    Scene scene;
    const Eigen::DiagonalMatrix<double, 3> about(-1, 1, -1);
    for (int c = 0; c < count; ++c) {
      scene.session.rig[c].R = about * scene.session.rig[c].R;
      scene.session.rig[c].t = about * scene.session.rig[c].t;
    }
    const std::vector<Finding> findings = scene.check().findings;
    ASSERT_FALSE(findings.empty());
    EXPECT_SAYS(findings[0].text, count == 2 ? "outside that of cam0, cam1" : "outside that of cam0, cam1, cam2, cam3");
    EXPECT_FALSE(says(findings[0].text, "cam4"));
    EXPECT_EQ(findings[0].impossible, count == 4);
  }
}

TEST(SessionCheck, SwappedCamerasAreNamed) {
  Scene scene;
  std::swap(scene.masks[0], scene.masks[1]);
  const std::string text = scene.impossible();
  EXPECT_SAYS(text, "frame 0: expected videos in the order of the calibration, found that cam0 and cam1 look swapped");
  EXPECT_SAYS(text, "swapped 1.00 and 1.00)");
}

TEST(SessionCheck, MirroredImages) {
  Scene scene;
  for (Image &mask : scene.masks)
    for (int y = 0; y < kSize; ++y)
      std::reverse(mask.data.begin() + y * kSize, mask.data.begin() + (y + 1) * kSize);
  EXPECT_SAYS(scene.impossible(), "mirrored ones (overlap with the scan 1.00 when mirrored, ");
}

TEST(SessionCheck, SilhouettesOfSomethingElse) {
  Scene scene;
  for (Image &mask : scene.masks)
    mask = rolled(mask, 60, 0);
  EXPECT_SAYS(scene.impossible(), "overlap");
}

TEST(SessionCheck, OneCameraThatDoesNotFitIsDoubtful) {
  Scene scene;
  scene.masks[2] = rolled(scene.masks[2], 0, 12);
  const std::string text = scene.doubtful();
  EXPECT_SAYS(text, "frame 0: expected scan and silhouettes to overlap by at least 0.8, found cam2 0.");
  EXPECT_FALSE(says(text, "cam1"));
}

TEST(SessionCheck, MasksOfOneColour) {
  for (const auto &[value, wrong] : {std::pair{0, "nothing"}, {255, "the whole image"}}) {
    Scene scene;
    scene.masks[3] = Image(kSize, kSize, 1, static_cast<std::uint8_t>(value));
    EXPECT_EQ(scene.impossible(),
              std::string("camera cam3: expected masks that show a person, found ") + wrong + " in 5 of the 5 looked at");
  }
}

TEST(SessionCheck, SilhouettesAreLookedAtInTheFirstFrameAlone) {
  Scene scene;
  scene.session.cameras[3].masks.clear();
  scene.film.mask_of = [&](int camera, int frame) { return camera == 3 && frame > 0 ? Image() : scene.masks[camera]; };
  scene.nothing_found();
  scene.masks[3] = Image(kSize, kSize, 1);
  EXPECT_SAYS(scene.impossible(), "camera cam3: expected silhouettes that show a person, found nothing in 1 of the 1");
}

TEST(SessionCheck, ACameraIsLookedAtWhereItFilmed) {
  for (const bool ready : {false, true})
    for (const int late : {-3, 3}) {
      Scene scene;
      scene.session.cameras[3].late = late;
      if (!ready)
        scene.session.cameras[3].masks.clear();
      scene.film.mask_of = [&](int camera, int frame) {
        const int own = frame + late;
        return camera == 3 && (own < 0 || own >= kFrames) ? Image() : scene.masks[camera];
      };
      scene.nothing_found();
    }
}

TEST(SessionCheck, MostMasksMissing) {
  Scene scene;
  scene.film.mask_of = [&](int camera, int frame) { return camera == 1 && frame > 4 ? Image() : scene.masks[camera]; };
  EXPECT_EQ(scene.impossible(), "camera cam1: expected masks for every frame, found none in 4 of the 5 looked at");
}

TEST(SessionCheck, SomebodyWhoWalksOffIsDoubtful) {
  Scene scene;
  scene.film.mask_of = [&](int camera, int frame) {
    return camera == 1 && frame == kFrames - 1 ? Image(kSize, kSize, 1) : scene.masks[camera];
  };
  EXPECT_EQ(scene.doubtful(), "camera cam1: expected masks that show a person, found nothing in 1 of the 5 looked at");
}

TEST(SessionCheck, FrameRates) {
  Scene scene;
  scene.session.cameras[2].video_fps = 30;
  EXPECT_EQ(scene.impossible(), "videos: expected one frame rate, found cam2 30 and 40 in the others");
  for (SessionCamera &camera : scene.session.cameras)
    camera.video_fps = 30;
  EXPECT_EQ(scene.doubtful(), "session.json: expected the videos' frame rate 30, found 40");
  for (SessionCamera &camera : scene.session.cameras)
    camera.video_fps = 0; // no container says one
  scene.nothing_found();
  scene.session.cameras[0].video_fps = 25;
  scene.session.cameras[1].video_fps = 30;
  EXPECT_EQ(scene.impossible(), "videos: expected one frame rate, found cam0 25 and 30 in the others");
}

TEST(SessionCheck, WithoutAScanRatesAndSilhouettesAreLookedAt) {
  Scene scene;
  scene.session.scan.clear();
  scene.session.joints.clear();
  const auto check = [&] { return check_session(scene.session, scene.film, nullptr, {}); };
  EXPECT_TRUE(check().findings.empty());
  EXPECT_TRUE(check().shadows.empty());
  EXPECT_EQ(check().silhouettes.size(), 6u);
  scene.masks[3] = Image(kSize, kSize, 1);
  EXPECT_EQ(check().findings.size(), 1u);
}

TEST(SessionCheck, NothingIsLookedForInWhatCannotBe) {
  Scene scene;
  scene.scan.vertices *= 1000;
  scene.masks[3] = Image(kSize, kSize, 1);
  EXPECT_SAYS(scene.impossible(), "scan.ply");
}

TEST(SessionCheck, FramesOfOtherCamerasAreRefused) {
  Scene scene;
  scene.film.cameras = 5;
  EXPECT_THROW(scene.check(), std::invalid_argument);
  scene.session.cameras.clear();
  scene.session.rig.clear();
  scene.film.cameras = 0;
  EXPECT_THROW(scene.check(), std::invalid_argument);
}

/// Frames in which the person stands as in the scan, half a metre off; in all others bent, with both arms up.
void take(Scene &scene, const std::function<bool(int)> &stands, const Mesh *other = nullptr) {
  Mesh there = scene.scan;
  there.vertices.rowwise() += Eigen::RowVector3d(0.2, 0, -0.3);
  const Mesh bent = doublet::testing::figure_surface(
      scene.skeleton, scene.posed({{"l_shoulder.z", 120}, {"r_shoulder.z", -120}, {"l_hip.x", -80}, {"l_knee.flex", 90}}), 0.045);
  scene.film.mask_of = [stands, fits = scene.shadows(there), rest = scene.shadows(other ? *other : bent)](int camera, int frame) {
    return stands(frame) ? fits[camera] : rest[camera];
  };
}

TEST(SessionCheck, ATakeThatBeginsInAnotherPoseIsComparedWhereItIsTheScans) {
  Scene scene;
  take(scene, [](int frame) { return frame == 12 || frame == 13; });
  const SessionCheck check = scene.check();
  EXPECT_TRUE(check.findings.empty());
  EXPECT_EQ(check.frame(), 12);
  EXPECT_SAYS(check.start_text, "frame 0 is not in the scan's pose (overlap 0.");
  EXPECT_SAYS(check.start_text, "; frame 12 is (0.");
  for (int c = 0; c < 6; ++c)
    EXPECT_GT(check.overlaps(c, c), 0.8);
  EXPECT_NEAR(check.joints(0, 0) - scene.session.joints[0].position.x(), 0.2, 0.03);
}

TEST(SessionCheck, ATakeThatBeginsElsewhereBeginsThere) {
  Scene scene;
  take(scene, [](int) { return true; });
  const SessionCheck check = scene.check();
  EXPECT_TRUE(check.findings.empty());
  EXPECT_EQ(check.frame(), 0);
  EXPECT_SAYS(check.start_text, "frame 0 is in the scan's pose, but in another place: overlap ");
}

TEST(SessionCheck, ATakeThatIsNeverInTheScansPoseIsDoubtful) {
  Scene scene;
  take(scene, [](int) { return false; });
  EXPECT_SAYS(scene.doubtful(), "expected a frame in the scan's pose, 0.8 at least, found none: nearest is frame ");
  EXPECT_EQ(scene.check().start_text, "");
}

TEST(SessionCheck, ATakeOfSomethingElseIsImpossible) {
  Scene scene;
  const Mesh bar = capsule_mesh({{{-0.9, 0.2, 0}, {0.9, 0.2, 0}, 0.1, 0.1}});
  take(
      scene, [](int) { return false; }, &bar);
  EXPECT_SAYS(scene.impossible(), "or near it, found none");
}

TEST(SessionCheck, ATakeThatFitsIsNotSearched) {
  Scene scene;
  std::set<int> asked;
  scene.film.mask_of = [&](int camera, int frame) {
    if (camera == 0)
      asked.insert(frame);
    return scene.masks[camera];
  };
  EXPECT_FALSE(scene.check().start);
  EXPECT_EQ(asked, (std::set<int>{0, 5, 10, 14, 19})); // where ready masks are looked at
}

} // namespace session_check_test
