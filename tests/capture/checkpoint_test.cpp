// A capture that was stopped goes on where it was, to the same bits, and is led astray by no file.

#include "tracker_scene.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"
#include "doublet/files/files.h"
#include "support/temp_folder.h"

#include <cstring>
#include <gtest/gtest.h>
#include <map>

using namespace doublet;
using namespace tracker_scene;

namespace checkpoint_test {

/// Rendered once.
class Film : public FrameSource {
public:
  Film(const RiggedMesh &actor, const CameraRig &rig, const MatrixRM &dofs) : frames_(actor, rig, surfaces(actor, dofs)) {
    frames_.missing = [](int camera, int frame) { return camera == 1 && frame == 3; };
    for (int c = 0; c < camera_count(); ++c)
      for (int t = 0; t < frame_count(); ++t) {
        images[{c, t}] = frames_.image(c, t);
        masks[{c, t}] = frames_.mask(c, t);
      }
  }
  int frame_count() const override { return frames_.frame_count(); }
  int camera_count() const override { return frames_.camera_count(); }
  Image image(int camera, int frame) override { return images.at({camera, frame}); }
  Image mask(int camera, int frame) override { return masks.at({camera, frame}); }

  std::map<std::pair<int, int>, Image> images, masks;

private:
  Frames frames_;
};

/// Of all arrays of a result; not of the seconds.
std::string bits(const CaptureResult &result) {
  Fingerprint print;
  print.add(result.performance.dofs).add(result.performance.frames).add(result.observations.frames);
  for (const Vertices &surface : result.performance.surface.frames)
    print.add(surface);
  for (const Vertices &joints : result.performance.joints)
    print.add(joints);
  for (const auto &views : result.observations.views)
    for (const ViewObservation &view : views) {
      print.add(view.contour);
      for (const FeatureMatch &match : view.matches)
        print.add(match.previous).add(match.current);
    }
  const CaptureSummary &s = result.summary;
  print.add(s.rim_px).add(s.sift_px).add(s.silhouette_iou).add(s.views);
  print.add(Eigen::Vector2d(s.jitter_before, s.jitter_after));
  for (const LostLimb &lost : s.lost_limbs)
    print.add(lost.limb).add(Eigen::Vector4d(lost.frame, lost.before, lost.after, lost.recovered));
  for (const JointVisibility &joint : s.joints)
    print.add(joint.joint).add(Eigen::Vector3i(joint.seen, joint.inferred, joint.lost));
  return print.text();
}

/// A context that writes down what it is told, and may stop a run as soon as it has come on by a frame.
struct Watched {
  explicit Watched(bool stop = false, int threads = 2) {
    context.threads = threads;
    context.log = [this](const std::string &line) { log += line + "\n"; };
    context.progress = [this](const std::string &, double fraction) { progress.push_back(fraction); };
    context.cancelled = [this, stop] { return stop && progress.back() > progress.front(); };
  }
  bool said(const std::string &text) const { return log.find(text) != std::string::npos; }
  Context context;
  std::string log;
  std::vector<double> progress;
};

class CaptureCheckpoint : public ::testing::TestWithParam<int> {}; // the start frame

TEST_P(CaptureCheckpoint, EveryFrameGoesOnToTheSameBits) {
  constexpr int kFrames = 7, kSteps = 2 * kFrames;
  const RiggedMesh actor = figure();
  const CameraRig rig = ring(4, 160);
  MatrixRM dofs = motion(actor, kFrames);
  dofs.bottomRows(4).col(6).array() += 1.2; // a limb jumps, and is lost
  Film film(actor, rig, dofs);
  for (auto &[at, mask] : film.masks) // another is in no mask for a while, and is not found
    if (at.second >= 1 && at.second < 5)
      std::fill(mask.data.begin() + 110 * mask.width, mask.data.end(), 0);
  const doublet::testing::TempFolder folder;
  CaptureOptions options;
  const int start = options.start_frame = GetParam();
  options.limbs.lost_error = 0.008;
  options.limbs.annealing.particles = 10;
  options.limbs.annealing.iterations = 2;
  const auto capture = [&](const Context &context) {
    return PerformanceCapture::create(options)->capture(actor, rig, film, nullptr, context);
  };
  Watched first;
  const CaptureResult whole = capture(first.context);
  int recovered = 0;
  for (const LostLimb &lost : whole.summary.lost_limbs)
    recovered += lost.recovered;
  if (start == 0) { // from elsewhere the limb does not jump, as the start has it already
    EXPECT_GT(recovered, 0) << first.log;
  }
  EXPECT_LT(recovered, static_cast<int>(whole.summary.lost_limbs.size())) << first.log;
  EXPECT_GT(whole.observations.views[kFrames - 1][0].matches.size(), 3u);

  options.checkpoint = folder / "checkpoint";
  const std::string file = options.checkpoint.string();
  for (int step = 0; step < kSteps; ++step) {
    SCOPED_TRACE(step);
    Watched watched(true, 1 + step % 3);
    EXPECT_THROW(capture(watched.context), Cancelled); // at the beginning of the next frame, or at the end
    EXPECT_EQ(watched.progress.front(), static_cast<double>(step) / kSteps);
    const auto place = [&](int next) {
      if (next == kSteps)
        return std::string(" goes on after the last frame\n");
      const int k = next % kFrames, frame = k < kFrames - start ? start + k : kFrames - 1 - k;
      return " goes on at frame " + std::to_string(frame) + (next < kFrames ? "\n" : " of the second pass\n");
    };
    EXPECT_EQ(watched.said("capture: " + file + place(step)), step > 0) << watched.log;
    EXPECT_TRUE(watched.said("capture: stopped; " + file + place(step + 1))) << watched.log;
  }
  Watched watched;
  const CaptureResult resumed = capture(watched.context);
  EXPECT_TRUE(watched.said("goes on after the last frame"));
  EXPECT_EQ(watched.progress.front(), 1);
  EXPECT_EQ(bits(resumed), bits(whole));
  EXPECT_GT(resumed.summary.pose_seconds, 0); // of the runs before
  EXPECT_EQ(resumed.summary.start_frame, start);
  EXPECT_TRUE(std::filesystem::exists(options.checkpoint));
}

std::string at_frame(const ::testing::TestParamInfo<int> &start) {
  return "AtFrame" + std::to_string(start.param);
}
INSTANTIATE_TEST_SUITE_P(Start, CaptureCheckpoint, ::testing::Values(0), at_frame);
INSTANTIATE_TEST_SUITE_P(SlowStart, CaptureCheckpoint, ::testing::Values(2, 6), at_frame);

// What follows is tracked by pieces that cost nothing.

struct OneFeature : FeatureTracker {
  Features detect(const Image &, const Image &) const override { return {{{50, 50}}, MatrixRM::Zero(1, 4)}; }
  std::vector<std::pair<int, int>> match(const Features &before, const Features &here, double) const override {
    if (before.points.empty() || here.points.empty())
      return {};
    return {{0, 0}};
  }
};

/// What it returns depends on what is expected, so that a frame that was not taken in shows.
struct DriftingPose : PoseOptimizer {
  int calls = 0;
  PoseEstimate optimize(const PoseProblem &problem, const Context &) override {
    ++calls;
    PoseEstimate estimate;
    estimate.dofs = problem.predicted.array() + 0.01;
    return estimate;
  }
};

struct DriftingSurface : SurfaceRefiner {
  SurfaceEstimate refine(const SurfaceProblem &problem, const Context &) override {
    return {problem.base.rowwise() + Eigen::RowVector3d(0, 0, 0.002), 0, 0};
  }
};

struct CheapCapture : ::testing::Test {
  static constexpr int kFrames = 3, kSteps = 2 * kFrames;
  RiggedMesh actor = figure();
  CameraRig rig = ring(3, 96);
  Film film{actor, rig, motion(actor, kFrames)};
  doublet::testing::TempFolder folder;
  CaptureOptions options;
  int tracked = 0;         // frames of the last run
  std::string log;         // of the last run
  std::vector<long> sizes; // of the file at the beginning of each frame of the last run

  CheapCapture() {
    options.find_lost_limbs = false;
    options.refine_cameras = false; // poses that drift on purpose would move them
    options.checkpoint = folder / "checkpoint";
  }

  CaptureResult run(bool own_surface = true) {
    CaptureParts parts;
    const auto pose = std::make_shared<DriftingPose>();
    parts.features = std::make_shared<OneFeature>();
    parts.pose = pose;
    if (own_surface)
      parts.surface = std::make_shared<DriftingSurface>();
    Watched watched;
    watched.context.progress = [this](const std::string &, double fraction) {
      sizes.resize(std::lround(kSteps * fraction) + 1);
      sizes.back() = size();
    };
    CaptureResult result = PerformanceCapture::create(options, parts)->capture(actor, rig, film, nullptr, watched.context);
    tracked = pose->calls;
    log = watched.log;
    return result;
  }

  long size() const {
    return std::filesystem::exists(options.checkpoint) ? static_cast<long>(std::filesystem::file_size(options.checkpoint)) : 0;
  }

  /// Runs with the file that there is: it is not used, `why`, and the result is that of a run without.
  void expect_not_used(const std::string &why, bool own_surface = true) {
    const std::string result = bits(run(own_surface));
    EXPECT_EQ(tracked, kSteps);
    EXPECT_NE(log.find(options.checkpoint.string() + " " + why + "; starting over"), std::string::npos) << log;
    const Path file = std::exchange(options.checkpoint, Path());
    EXPECT_EQ(result, bits(run(own_surface)));
    options.checkpoint = file;
    run(own_surface);
    EXPECT_EQ(tracked, 0) << "what was written in its place is used";
  }
};

TEST_F(CheapCapture, AFinishedOneIsNotTrackedAgain) {
  const std::string whole = bits(run());
  EXPECT_EQ(tracked, kSteps);
  EXPECT_EQ(bits(run()), whole);
  EXPECT_EQ(tracked, 0);
}

TEST_F(CheapCapture, WithoutAFileNothingIsWritten) {
  options.checkpoint.clear();
  run();
  EXPECT_EQ(log.find("goes on"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_F(CheapCapture, OfADamagedFileTheWholeFramesAreUsed) {
  const std::string whole = bits(run()), file = read_text(options.checkpoint);
  const std::vector<long> starts = sizes;
  ASSERT_EQ(starts.size(), kSteps + 1u); // and the end
  ASSERT_GT(starts[1], starts[0] + 30000);
  const auto expect_used = [&](int frames, const std::string &damaged) {
    write_text(options.checkpoint, damaged);
    EXPECT_EQ(bits(run()), whole);
    EXPECT_EQ(tracked, kSteps - frames);
    EXPECT_EQ(read_text(options.checkpoint).size(), file.size());
  };
  for (int k = 0; k < kSteps; ++k) {
    SCOPED_TRACE(k);
    const long middle = (starts[k] + starts[k + 1]) / 2;
    for (const long at : {starts[k], starts[k] + 8, middle, starts[k + 1] - 1}) {
      std::string flipped = file;
      flipped[at] = static_cast<char>(flipped[at] ^ 0x55);
      expect_used(k, flipped);
      EXPECT_NE(log.find("is damaged or cut short after " + std::to_string(k) + " frames"), std::string::npos) << log;
    }
    expect_used(k, file.substr(0, middle));
    expect_used(k, file.substr(0, middle) + std::string(file.size() - middle, '\0')); // as a power cut leaves it
  }
  // A frame of its own right, in the wrong place.
  const auto record = [&](int k) { return file.substr(starts[k], starts[k + 1] - starts[k]); };
  expect_used(1, file.substr(0, starts[1]) + record(2) + record(1) + file.substr(starts[3]));
}

TEST_F(CheapCapture, AFileOfSomethingElseIsNotUsed) {
  run();
  const std::string file = read_text(options.checkpoint), header = file.substr(0, file.find('\n') + 1);
  for (const std::string &other : {std::string(), std::string("PK\3\4"), std::string(100000, 'x'), header.substr(0, 20),
                                   header.substr(0, header.size() - 1), std::string("doublet capture checkpoint, format ")}) {
    SCOPED_TRACE(other.substr(0, 60));
    write_text(options.checkpoint, other);
    run();
    EXPECT_EQ(tracked, kSteps);
    EXPECT_NE(log.find("starting over"), std::string::npos) << log;
  }
  for (const char *format : {"0", "1", "-1", "99999999999999999999"}) {
    std::string other = file;
    write_text(options.checkpoint, other.replace(file.find(" 2,"), 2, std::string(" ") + format));
    run();
    EXPECT_EQ(tracked, kSteps);
    EXPECT_NE(log.find(" is of format "), std::string::npos) << log;
  }
}

TEST_F(CheapCapture, AForgedFrameIsNotUsed) {
  const std::string whole = bits(run()), file = read_text(options.checkpoint), header = file.substr(0, sizes[0]);
  const std::uint64_t problem = std::stoull(header.substr(header.find("problem ") + 8));
  const auto with_record = [&](const std::string &bytes) {
    const std::uint64_t size = bytes.size(), sum = Fingerprint().bytes(&problem, sizeof problem).add(bytes).value();
    return header + std::string(reinterpret_cast<const char *>(&size), 8) + bytes +
           std::string(reinterpret_cast<const char *>(&sum), 8);
  };
  const std::string frame = file.substr(sizes[0] + 8, sizes[1] - sizes[0] - 16);
  ASSERT_EQ(with_record(frame), file.substr(0, sizes[1])); // the right checksums
  std::string no_number = frame, no_length = frame;
  std::memset(no_number.data() + frame.size() / 2, 0xFF, 64);
  std::memset(no_length.data() + 13, 0xFF, 8);
  for (const std::string &forged : {std::string(), frame.substr(1), frame + "x", no_number, no_length}) {
    write_text(options.checkpoint, with_record(forged));
    EXPECT_EQ(bits(run()), whole);
    EXPECT_EQ(tracked, kSteps);
    EXPECT_NE(log.find("damaged"), std::string::npos) << log;
  }
}

TEST_F(CheapCapture, ThatOfOtherOptionsIsNotUsed) {
  run();
  options.offset_decay = 0.5;
  expect_not_used("belongs to other data or options");
  options.pose.sift_weight = 2; // of a nested group
  expect_not_used("belongs to other data or options");
  options.first_frame = 1, options.frame_count = 2;
  run();
  EXPECT_EQ(tracked, 4);
  EXPECT_NE(log.find("belongs to other data or options; starting over"), std::string::npos);
}

TEST_F(CheapCapture, ThatOfAnotherActorOrRigIsNotUsed) {
  run();
  actor.weights(5, 0) -= 1e-9;
  expect_not_used("belongs to other data or options");
  actor.skeleton.joints[1].rest.x() += 1e-9;
  expect_not_used("belongs to other data or options");
  rig[2].distortion[0] += 1e-9;
  expect_not_used("belongs to other data or options");
}

TEST_F(CheapCapture, ThatOfOtherPiecesIsNotUsed) {
  run();
  expect_not_used("belongs to other data or options", false);
}

TEST_F(CheapCapture, ThatOfOtherImagesIsNotUsed) {
  run();
  film.images[{2, 1}].data[1000] ^= 1;
  expect_not_used("was made from other images");
  film.masks[{0, 2}].data[300] ^= 255;
  expect_not_used("was made from other images");
}

TEST_F(CheapCapture, AFileThatCannotBeWrittenIsNamed) {
  std::filesystem::create_directories(options.checkpoint);
  try {
    run();
    FAIL() << "a folder is no file";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find(options.checkpoint.string()), std::string::npos) << error.what();
  }
}

} // namespace checkpoint_test
