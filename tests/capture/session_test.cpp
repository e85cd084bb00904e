// Reading sessions, whole and broken: the shipped one, with one thing changed at a time.
#include "doublet/capture/session.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "support/temp_folder.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>

namespace doublet {
namespace session_test {

namespace fs = std::filesystem;
const fs::path kShipped = fs::path(DOUBLET_SOURCE_DIR) / "examples/data/session";

/// A copy of the shipped session of which tests may break single files.
class SessionFiles : public ::testing::Test {
protected:
  testing::TempFolder folder;

  void SetUp() override {
    for (const char *name : {"session.json", "calibration.yml", "joints.json"})
      fs::copy_file(kShipped / name, folder / name);
    for (const char *name : {"scan.ply", "motion.bvh"})
      fs::create_symlink(kShipped / name, folder / name);
    fs::create_directory(folder / "videos");
    for (const auto &entry : fs::directory_iterator(kShipped / "videos"))
      fs::create_symlink(entry.path(), folder.path() / "videos" / entry.path().filename());
  }

  void replace(const std::string &name, const std::string &pattern, const std::string &with) {
    const std::string text = read_text(folder / name), changed = std::regex_replace(text, std::regex(pattern), with);
    ASSERT_NE(text, changed) << pattern;
    write_text(folder / name, changed);
  }

  /// Reading must fail within seconds, with one sentence that has all the words.
  template <class E = Error> void expect_failure(const std::vector<std::string> &words) {
    const auto start = std::chrono::steady_clock::now();
    try {
      read_session(folder.path());
      ADD_FAILURE() << "the session was read";
    } catch (const E &e) {
      for (const std::string &word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << "'" << word << "' is missing in: " << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  }
};

TEST(Session, ShippedSessionIsRead) {
  const Session session = read_session(kShipped);
  EXPECT_EQ(session.cameras.size(), 8U);
  EXPECT_EQ(session.rig.size(), 8U);
  EXPECT_GE(session.frame_count, 80);
  EXPECT_EQ(session.fps, 40);
  EXPECT_EQ(session.rig[3].name, "cam3");
  EXPECT_EQ(session.rig[3].width, 502);
  EXPECT_NEAR(session.rig[0].centre().norm(), session.rig[0].t.norm(), 1e-9);
  EXPECT_EQ(session.joints.size(), 24U);
  EXPECT_EQ(make_skeleton(session.joints).dof_count(), 36);
  EXPECT_EQ(session.landmarks.size(), 10U);
  EXPECT_TRUE(fs::exists(session.scan));
  EXPECT_TRUE(fs::exists(session.new_motion));
}

TEST(Session, FramesAreTheSameInAnyOrder) {
  const Session session = read_session(kShipped);
  const auto forward = FrameSource::open(session), jumping = FrameSource::open(session);
  std::vector<Image> images;
  for (int f = 0; f < 70; ++f)
    images.push_back(forward->image(2, f));
  for (int f : {69, 3, 40, 41, 41, 0, 33, 64})
    EXPECT_EQ(jumping->image(2, f).data, images[f].data) << f;
  EXPECT_EQ(images[0].channels, 3);
  EXPECT_EQ(images[0].width, 502);
  EXPECT_NE(images[0].data, images[60].data);
  EXPECT_TRUE(forward->mask(2, 0).empty());
  // The screen is green: BGR, not RGB.
  EXPECT_GT(images[0].at(5, 5, 1), images[0].at(5, 5, 0) + 20);
  EXPECT_GT(images[0].at(5, 5, 1), images[0].at(5, 5, 2) + 20);
}

TEST(Session, ACameraMayBeginLater) {
  Session session = read_session(kShipped);
  const auto plain = FrameSource::open(session);
  session.cameras[2].first_frame = 5;
  const auto later = FrameSource::open(session);
  EXPECT_EQ(later->image(2, 0).data, plain->image(2, 5).data);
  EXPECT_EQ(later->image(1, 0).data, plain->image(1, 0).data);
}

TEST(Session, FramesOutsideThrow) {
  const auto frames = FrameSource::open(read_session(kShipped));
  EXPECT_THROW(frames->image(0, -1), std::invalid_argument);
  EXPECT_THROW(frames->image(0, frames->frame_count()), std::invalid_argument);
  EXPECT_THROW(frames->image(8, 0), std::invalid_argument);
  EXPECT_THROW(frames->mask(-1, 0), std::invalid_argument);
}

TEST_F(SessionFiles, TheCopyIsRead) {
  EXPECT_EQ(read_session(folder.path()).cameras.size(), 8U);
}

TEST_F(SessionFiles, MissingFolderOrDescription) {
  EXPECT_THROW(read_session(folder / "nowhere"), FileNotFound);
  fs::remove(folder / "session.json");
  expect_failure<FileNotFound>({"session.json"});
}

TEST_F(SessionFiles, MissingVideo) {
  fs::remove(folder.path() / "videos/cam4.mp4");
  expect_failure<FileNotFound>({"cam4.mp4", "session.json"});
}

TEST_F(SessionFiles, MissingScanOrMotion) {
  fs::remove(folder / "motion.bvh");
  expect_failure<FileNotFound>({"motion.bvh"});
  replace("session.json", ",?\\s*\"new_motion\": \"motion.bvh\"", "");
  EXPECT_TRUE(read_session(folder.path()).new_motion.empty());
  fs::remove(folder / "scan.ply");
  expect_failure<FileNotFound>({"scan.ply"});
}

TEST_F(SessionFiles, CalibrationLacksACamera) {
  replace("calibration.yml", "cam6_", "camera6_");
  expect_failure({"calibration.yml", "'cam6'", "camera6"});
}

TEST_F(SessionFiles, CalibrationIsBroken) {
  replace("calibration.yml", "cam2_R", "cam2_Q");
  expect_failure({"calibration.yml", "cam2_R"});
  write_text(folder / "calibration.yml", "%YAML:1.0\n---\ncam0_K: [ 1, 2\n");
  expect_failure({"calibration.yml"});
  write_text(folder / "calibration.yml", "");
  expect_failure({"calibration.yml"});
}

TEST_F(SessionFiles, CalibrationOfAnotherSize) {
  replace("calibration.yml", "cam1_image_width: 502", "cam1_image_width: 1004");
  expect_failure({"cam1.mp4", "1004", "502"});
}

TEST_F(SessionFiles, TellWhetherTheScanIsOfTheViews) {
  EXPECT_FALSE(read_session(folder.path()).scan_from_views);
  replace("session.json", "\"frame_count\": 128", "\"frame_count\": 128, \"scan_from_views\": true");
  EXPECT_TRUE(read_session(folder.path()).scan_from_views);
  replace("session.json", "\"scan_from_views\": true", "\"scan_from_views\": \"yes\"");
  expect_failure({"session.json", "scan_from_views", "true or false", "yes"});
}

TEST_F(SessionFiles, FirstFrame) {
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 50");
  replace("session.json", "\"name\": \"cam3\"", "\"first_frame\": 7, \"name\": \"cam3\"");
  EXPECT_EQ(read_session(folder.path()).cameras[3].first_frame, 7);
  replace("session.json", "\"first_frame\": 7", "\"first_frame\": 700");
  expect_failure({"cam3.mp4", "750 frames"});
  replace("session.json", "\"first_frame\": 700", "\"first_frame\": -1");
  expect_failure({"session.json", "cam3", "first_frame", "-1"});
}

TEST_F(SessionFiles, NumbersOfFramesAreWhole) {
  replace("session.json", "\"name\": \"cam3\"", "\"first_frame\": 2.5, \"name\": \"cam3\"");
  expect_failure({"session.json", "cam3", "first_frame", "a number of frames", "2.5"});
  replace("session.json", "\"first_frame\": 2.5", "\"first_frame\": 2.0");
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 4294967346"); // 50, were it cut to 32 bits
  expect_failure({"session.json", "frame_count", "4294967346"});
  replace("session.json", "4294967346", "true");
  expect_failure({"session.json", "frame_count", "true"});
  replace("session.json", "\"frame_count\": true", "\"frame_count\": 50");
  EXPECT_EQ(read_session(folder.path()).cameras[3].first_frame, 2);
}

TEST_F(SessionFiles, TruncatedVideo) {
  // The index stands at the front of these files, so that half a file still opens and states all its frames.
  const fs::path video = folder.path() / "videos/cam7.mp4";
  fs::remove(video);
  fs::copy_file(kShipped / "videos/cam7.mp4", video);
  fs::resize_file(video, fs::file_size(video) / 2);
  expect_failure({"cam7.mp4", "truncated"});
  fs::resize_file(video, 400); // within the index
  expect_failure({"cam7.mp4"});
  write_text(video, "");
  expect_failure({"cam7.mp4"});
}

TEST_F(SessionFiles, VideoWithTooFewFrames) {
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 500");
  expect_failure({"cam0.mp4", "500", "128"});
}

TEST_F(SessionFiles, UnknownParentOfAJoint) {
  replace("joints.json", "\"parent\": \"l_knee\"", "\"parent\": \"l_kneee\"");
  expect_failure({"joints.json", "l_ankle", "l_kneee"});
}

TEST_F(SessionFiles, KeypointsAreWhereThePinholeSeesThem) {
  replace("session.json", "\"name\": \"cam1\"", "\"first_frame\": 2, \"name\": \"cam1\"");
  replace("session.json", "\"frame_count\": 128", "\"frame_count\": 100, \"keypoints\": \"keypoints.npz\"");
  replace("calibration.yml", "cam2_K:", "cam2_lens: fisheye\ncam2_K:");
  replace("calibration.yml", R"(cam2_distortion: !!opencv-matrix\s+rows: 1\s+cols: 5\s+dt: d\s+data: \[[^\]]*\])",
          "cam2_distortion: !!opencv-matrix\n  rows: 1\n  cols: 4\n  dt: d\n  data: [0.1, 0.01, 0., 0.]");
  const auto write = [&](int frames, int joints) {
    Npz file;
    for (const char *name : {"cam0", "cam1", "cam2"}) {
      std::vector<double> values;
      for (int i = 0; i < frames * joints; ++i)
        values.insert(values.end(), {100.0 + i / joints, 200.0 + i % joints, 0.9});
      file.set_f4(name, {frames, joints, 3}, values);
    }
    file.write(folder / "keypoints.npz");
  };
  expect_failure<FileNotFound>({"session.json", "keypoints.npz"});
  write(101, kKeypoints);
  expect_failure({"keypoints.npz", "102 frames of camera 'cam1'", "found 101"});
  write(102, 5);
  expect_failure({"keypoints.npz", "cam0", "(102, 5, 3)"});
  write(102, kKeypoints);
  const Session session = read_session(folder.path());
  const auto frames = FrameSource::open(session);
  EXPECT_EQ(frames->keypoints(0, 7).at(3).pixel, Eigen::Vector2d(107, 203));
  EXPECT_NEAR(frames->keypoints(0, 7).at(3).confidence, 0.9, 1e-6);
  EXPECT_EQ(frames->keypoints(1, 7).at(3).pixel, Eigen::Vector2d(109, 203)); // it begins two frames later
  EXPECT_TRUE(frames->keypoints(3, 7).empty());
  const Eigen::Vector2d pinhole = frames->keypoints(2, 7).at(3).pixel;
  const Camera &camera = session.rig[2];
  const Eigen::Vector3d ray = camera.K.inverse() * pinhole.homogeneous();
  const CalibratedCamera filmed{camera, session.lenses[2], 0};
  EXPECT_LT((filmed.project(camera.R.transpose() * (ray - camera.t)) - Eigen::Vector2d(107, 203)).norm(), 1e-3);
  EXPECT_GT((pinhole - Eigen::Vector2d(107, 203)).norm(), 0.5);
  Npz other;
  other.set_f4("cam9", {1}, {0});
  other.write(folder / "keypoints.npz");
  expect_failure({"keypoints.npz", "an array of each one's name, found none"});
}

TEST_F(SessionFiles, BadJoints) {
  replace("joints.json", "\"parent\": null", "\"parent\": \"head\"");
  expect_failure({"joints.json"}); // no root
  write_text(folder / "joints.json", R"({"joints": {"a": {"position": [0, "x", 0], "parent": null}}})");
  expect_failure({"joints.json", "'a'", "position"});
  write_text(folder / "joints.json", R"({"joints": {"a": {"parent": null}}})");
  expect_failure({"joints.json", "position"});
  write_text(folder / "joints.json", R"({"joints": {"a": {"position": [0, 0, 0], "parent": null}}, "landmarks": [1]})");
  expect_failure({"joints.json"});
  write_text(folder / "joints.json", "{\"joints\": ");
  expect_failure({"joints.json"});
}

TEST_F(SessionFiles, BadDescriptions) {
  for (const std::string text :
       {"", "[]", "{}", "{\"name\": 1}", R"({"name": "a", "fps": 0, "frame_count": 3})",
        R"({"name": "a", "fps": "x", "frame_count": 3})", R"({"name": "a", "fps": 25, "frame_count": 0})",
        R"({"name": "a", "fps": 25, "frame_count": 3, "cameras": {}})",
        R"({"name": "a", "fps": 25, "frame_count": 3, "cameras": [3]})",
        R"({"name": "a", "fps": 25, "frame_count": 3, "cameras": [{"name": "c"}]})"}) {
    write_text(folder / "session.json", text);
    expect_failure({"session.json"});
  }
  fs::copy_file(kShipped / "session.json", folder / "session.json", fs::copy_options::overwrite_existing);
  replace("session.json", "\"name\": \"cam3\"", "\"name\": \"cam2\"");
  expect_failure({"session.json", "cam2", "twice"});
}

TEST_F(SessionFiles, MasksWithoutVideosAreASession) {
  // The shipped ground truth has a mask for one frame in ten; between them the camera has dropped out.
  fs::remove_all(folder / "videos");
  fs::create_directory_symlink(kShipped / "ground_truth/masks", folder / "masks");
  replace("session.json", ",\\s*\"video\": \"[^\"]*\"", "");
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 121");
  const Session session = read_session(folder.path());
  EXPECT_TRUE(session.cameras[0].video.empty());
  const auto frames = FrameSource::open(session);
  EXPECT_TRUE(frames->image(1, 0).empty());
  EXPECT_TRUE(frames->mask(1, 5).empty());
  const Image mask = frames->mask(1, 50);
  ASSERT_FALSE(mask.empty());
  EXPECT_EQ(mask.channels, 1);
  const auto actor = std::count(mask.data.begin(), mask.data.end(), 255),
             background = std::count(mask.data.begin(), mask.data.end(), 0);
  EXPECT_EQ(actor + background, 502 * 502);
  EXPECT_GT(actor, 5000);

  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 140");
  expect_failure<FileNotFound>({"masks", "140"});
}

TEST_F(SessionFiles, MasksMayBeNamedBesideVideos) {
  fs::create_directory_symlink(kShipped / "ground_truth/masks", folder / "silhouettes");
  replace("session.json", "\"videos/cam0.mp4\"", "\"videos/cam0.mp4\", \"masks\": \"silhouettes/cam0_%04d.png\"");
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 121");
  const auto frames = FrameSource::open(read_session(folder.path()));
  EXPECT_FALSE(frames->mask(0, 10).empty());
  EXPECT_FALSE(frames->image(0, 10).empty());
  EXPECT_TRUE(frames->mask(1, 10).empty());
  replace("session.json", "silhouettes/cam0_", "silhouettes/camera0_");
  expect_failure<FileNotFound>({"camera0_%04d.png"});
}

TEST_F(SessionFiles, AFolderMayBeCalledLikeASeries) {
  fs::create_directory_symlink(kShipped / "ground_truth/masks", folder / "silhouettes");
  replace("session.json", "\"videos/cam0.mp4\"", "\"videos/cam0.mp4\", \"masks\": \"silhouettes/cam0_%04d.png\"");
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 121");
  const testing::TempFolder other;
  for (const char *name : {"100% cotton", "take %d"}) {
    const fs::path inside = other / name;
    fs::copy(folder.path(), inside, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    const auto frames = FrameSource::open(read_session(inside));
    EXPECT_FALSE(frames->mask(0, 10).empty());
    EXPECT_FALSE(frames->image(1, 10).empty());
  }
}

TEST_F(SessionFiles, ImageFoldersAreVideos) {
  // Two images of the right size in a text format that needs no library; numbered from 1.
  fs::create_directory(folder / "cam0");
  for (int frame : {1, 2}) {
    std::ofstream image(folder.path() / "cam0" / (std::to_string(frame) + ".ppm"));
    image << "P6 502 502 255\n" << std::string(502 * 251 * 3, static_cast<char>(40 * frame)) << std::string(502 * 251 * 3, '\0');
  }
  replace("session.json", "videos/cam0.mp4", "cam0/%d.ppm");
  replace("session.json", "\"frame_count\": [0-9]+", "\"frame_count\": 2");
  const auto frames = FrameSource::open(read_session(folder.path()));
  EXPECT_EQ(frames->image(0, 0).at(7, 7), 40);
  EXPECT_EQ(frames->image(0, 1).at(7, 7), 80);
  const auto again = FrameSource::open(read_session(folder.path()));
  fs::resize_file(folder.path() / "cam0/2.ppm", 100);
  expect_failure({"2.ppm"});
  for (int time = 0; time < 2; ++time)
    EXPECT_THROW(again->image(0, 1), Error) << "it is no camera that dropped out, however often it is asked";
  replace("session.json", "cam0/%d.ppm", "cam0");
  EXPECT_THROW(read_session(folder.path()), Error); // a folder is no video
}

} // namespace session_test
} // namespace doublet
