// Silhouettes by the difference to a background, and which method a session's cameras get.
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "doublet/files/files.h"
#include "support/temp_folder.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <regex>
#include <utility>

namespace doublet {
namespace background_test {

namespace fs = std::filesystem;
const fs::path kShipped = fs::path(DOUBLET_SOURCE_DIR) / "examples/data/session";

/// A room of coloured bands with noise; a disc at `x` (share of the width) and its shadow below, if `actor`.
Image room(bool actor, unsigned seed, Image *truth = nullptr, double x0 = 0.5, double light = 1) {
  constexpr int kSize = 240;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 3);
  Image image(kSize, kSize, 3);
  if (truth)
    *truth = Image(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double u = double(x) / kSize, v = double(y) / kSize;
      const bool inside = actor && std::hypot(u - x0, v - 0.4) < 0.1,
                 shadow = actor && std::hypot((u - x0) / 1.5, v - 0.8) < 0.06;
      Eigen::Vector3d bgr(100 + 60 * std::sin(40 * u), 120 + 50 * std::cos(23 * v), 110 + 40 * std::sin(31 * (u + v)));
      bgr *= light * (shadow ? 0.7 : 1.0);
      if (inside)
        bgr = u < x0 ? Eigen::Vector3d(20, 30, 200) : Eigen::Vector3d(230, 40, 20);
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(bgr[c] + noise(random), 0.0, 255.0));
      if (truth)
        truth->at(x, y) = inside ? 255 : 0;
    }
  return image;
}

TEST(Background, CleanPlatesTellTheActorFromHisShadow) {
  const auto extractor = SilhouetteExtractor::create(BackgroundOptions{});
  extractor->train(0, {room(false, 1)});
  extractor->train(1, {room(false, 1), Image(), room(false, 2), room(false, 3)});
  Image truth;
  for (double light : {1.0, 0.9, 1.1}) {
    const Image image = room(true, 9, &truth, 0.5, light);
    EXPECT_GT(mask_iou(extractor->extract(0, image), truth), 0.95) << light;
    EXPECT_GT(mask_iou(extractor->extract(1, image), truth), 0.95) << light;
  }
  BackgroundOptions options;
  options.shadow = 1; // shadows count as the actor
  const auto without = SilhouetteExtractor::create(options);
  without->train(0, {room(false, 1)});
  EXPECT_LT(mask_iou(without->extract(0, room(true, 9)), truth), 0.75);
}

TEST(Background, TheMedianOfAMovingActorsFramesIsAPlate) {
  std::vector<Image> frames;
  for (int f = 0; f < 9; ++f)
    frames.push_back(room(true, f, nullptr, 0.15 + 0.085 * f));
  const auto extractor = SilhouetteExtractor::create(BackgroundOptions{});
  extractor->train(0, frames);
  Image truth;
  const Image image = room(true, 30, &truth, 0.3);
  EXPECT_GT(mask_iou(extractor->extract(0, image), truth), 0.95);
  const Image empty = extractor->extract(0, room(false, 31));
  EXPECT_LT(std::count(empty.data.begin(), empty.data.end(), 255), 100); // of 57600
}

/// A wall, grey on the left and blue on the right; before it, if x0 >= 0, a figure in grey trousers and a red shirt.
Image two_walls(int x0, unsigned seed, Image *truth = nullptr) {
  constexpr int kSize = 240;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 3);
  Image image(kSize, kSize, 3);
  Image inside(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      Eigen::Vector3d bgr = x < kSize / 2 ? Eigen::Vector3d(120, 120, 120) : Eigen::Vector3d(200, 80, 40);
      if (x0 >= 0 && std::abs(x - x0) < 20 && std::abs(y - 120) < 60) {
        bgr = y < 120 ? Eigen::Vector3d(30, 30, 190) : Eigen::Vector3d(84, 84, 84); // the wall in a shadow of 0.7
        inside.at(x, y) = 255;
      }
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(bgr[c] + noise(random), 0.0, 255.0));
    }
  if (truth)
    *truth = inside;
  return image;
}

TEST(Background, WhatTheActorWearsIsKnownFromWhereItIsPlain) {
  const auto extractor = SilhouetteExtractor::create(BackgroundOptions{});
  extractor->train(0, {two_walls(-1, 1)});
  Image truth;
  const Image image = two_walls(60, 2, &truth);
  EXPECT_LT(mask_iou(extractor->extract(0, image), truth), 0.6); // the trousers could be a shadow
  extractor->learn_actor(0, {two_walls(60, 3), two_walls(170, 4), Image(), two_walls(180, 5)});
  EXPECT_GT(mask_iou(extractor->extract(0, image), truth), 0.95);
}

TEST(Background, TheOutlineIsWhereAMixedPixelIsHalfTheActors) {
  const auto extractor = SilhouetteExtractor::create(BackgroundOptions{});
  extractor->train(0, {Image(120, 120, 3, 100)});
  for (const int share : {10, 30, 70, 90}) { // %, of the actor in the column at 70
    Image image(120, 120, 3, 100), truth(120, 120, 1);
    for (int y = 30; y < 90; ++y)
      for (int x = 40; x <= 70; ++x) {
        const int of_actor = x < 70 ? 100 : share;
        truth.at(x, y) = of_actor > 50 ? 255 : 0;
        for (int c = 0; c < 3; ++c)
          image.at(x, y, c) = static_cast<std::uint8_t>(100 + (c == 2 ? 80 : -60) * of_actor / 100);
      }
    const Image mask = extractor->extract(0, image);
    for (int y = 40; y < 80; ++y)
      EXPECT_EQ(mask.at(70, y), truth.at(70, y)) << share << " % at row " << y;
  }
}

TEST(Background, WrongArgumentsThrow) {
  const auto extractor = SilhouetteExtractor::create(BackgroundOptions{});
  EXPECT_THROW(extractor->extract(0, room(true, 1)), std::invalid_argument);
  EXPECT_THROW(extractor->train(0, {}), std::invalid_argument);
  EXPECT_THROW(extractor->learn_actor(0, {room(true, 1)}), std::invalid_argument);
  EXPECT_THROW(extractor->train(0, {room(true, 1), Image(5, 5, 3)}), std::invalid_argument);
  EXPECT_NO_THROW(extractor->train(0, {Image(), room(false, 1), Image()})); // frames that a camera has not
  extractor->train(0, {room(false, 1)});
  EXPECT_THROW(extractor->extract(0, Image(5, 5, 3)), std::invalid_argument);
  EXPECT_THROW(extractor->extract(0, Image(240, 240, 1)), std::invalid_argument);
  BackgroundOptions options;
  options.smoothness = -1;
  EXPECT_THROW(SilhouetteExtractor::create(options), std::invalid_argument);
  SilhouetteOptions method;
  method.method = static_cast<SilhouetteMethod>(4);
  EXPECT_THROW(method.validate(), std::invalid_argument);
}

void write_ppm(const fs::path &path, const Image &bgr) {
  std::ofstream file(path, std::ios::binary);
  file << "P6 " << bgr.width << " " << bgr.height << " 255\n";
  for (std::size_t i = 0; i < bgr.data.size(); i += 3)
    file << bgr.data[i + 2] << bgr.data[i + 1] << bgr.data[i];
}

/// Three cameras in a room: one with a clean plate, one before a screen, one with neither; 240 x 240, 9 frames.
class ThreeCameras : public ::testing::Test {
protected:
  testing::TempFolder folder;
  std::vector<std::string> said;
  Context context;

  void SetUp() override {
    context.log = [this](const std::string &line) { said.push_back(line); };
    for (const char *name : {"joints.json", "scan.ply"})
      fs::copy_file(kShipped / name, folder / name);
    std::string calibration = std::regex_replace(read_text(kShipped / "calibration.yml"), std::regex(": 502"), ": 240");
    write_text(folder / "calibration.yml", calibration);
    for (int c = 0; c < 3; ++c) {
      fs::create_directory(folder.path() / ("cam" + std::to_string(c)));
      for (int f = 0; f < 9; ++f) {
        Image image = room(true, f, nullptr, 0.15 + 0.085 * f);
        if (c == 1)
          screen(image, f);
        write_ppm(folder.path() / ("cam" + std::to_string(c)) / (std::to_string(f) + ".ppm"), image);
      }
    }
    write_ppm(folder / "plate.ppm", room(false, 77));
    describe(R"(, "background": "plate.ppm")");
  }

  /// Green wherever the room shows.
  static void screen(Image &image, int frame) {
    Image truth;
    room(true, frame, &truth, 0.15 + 0.085 * frame);
    for (int i = 0; i < 240 * 240; ++i)
      if (!truth.data[i])
        for (int c = 0; c < 3; ++c)
          image.data[3 * i + c] = c == 1 ? 170 : 50;
  }

  void describe(const std::string &first, const std::string &session = R"("background": "a room, one screen")") {
    write_text(folder / "session.json", R"({"name": "room", "fps": 25, "frame_count": 9, "cameras": [
      {"name": "cam0", "video": "cam0/%d.ppm")" +
                                            first + R"(}, {"name": "cam1", "video": "cam1/%d.ppm"},
      {"name": "cam2", "video": "cam2/%d.ppm"}], "calibration": "calibration.yml", "scan": "scan.ply",
      "markers": "joints.json", )" + session +
                                            "}");
  }

  bool was_said(const std::string &text) const {
    for (const std::string &line : said)
      if (line.find(text) != std::string::npos)
        return true;
    return false;
  }
};

TEST_F(ThreeCameras, EveryCameraGetsTheMethodThatFits) {
  const Session session = read_session(folder.path());
  const auto frames = FrameSource::open(session);
  const auto extractor = session_silhouettes(session, *frames, {}, context);
  EXPECT_TRUE(was_said("cam0: difference to its clean plate"));
  EXPECT_TRUE(was_said("cam1: key colour"));
  EXPECT_TRUE(was_said("cam2: difference to the median of its frames"));
  Image truth;
  room(true, 2, &truth, 0.15 + 0.085 * 2);
  for (int c = 0; c < 3; ++c)
    EXPECT_GT(mask_iou(extractor->extract(c, frames->image(c, 2)), truth), 0.95) << c;
}

TEST_F(ThreeCameras, OnAnyNumberOfThreadsLearnTheSame) {
  const Session session = read_session(folder.path());
  const auto masks = [&](int threads) {
    const auto frames = FrameSource::open(session);
    context.threads = threads;
    double last = -1;
    context.progress = [&](const std::string &, double fraction) { EXPECT_GT(fraction, std::exchange(last, fraction)); };
    const auto extractor = session_silhouettes(session, *frames, {}, context);
    EXPECT_EQ(last, 1);
    std::vector<std::vector<std::uint8_t>> found;
    for (int c = 0; c < 3; ++c)
      found.push_back(extractor->extract(c, frames->image(c, 2)).data);
    return found;
  };
  const auto one_by_one = masks(1);
  const std::vector<std::string> then_said = std::exchange(said, {});
  EXPECT_EQ(masks(2), one_by_one);
  EXPECT_EQ(said, then_said);
  EXPECT_EQ(masks(3), one_by_one);
}

TEST_F(ThreeCameras, AMethodThatDoesNotFitIsRefused) {
  const Session session = read_session(folder.path());
  const auto frames = FrameSource::open(session);
  SilhouetteOptions options;
  options.method = SilhouetteMethod::Plates;
  EXPECT_THROW(session_silhouettes(session, *frames, options, context), Error); // cam1 has none
  options.method = SilhouetteMethod::Key;
  EXPECT_THROW(session_silhouettes(session, *frames, options, context), Error); // cam0 has no screen
  options.method = SilhouetteMethod::Median;
  EXPECT_NE(session_silhouettes(session, *frames, options, context), nullptr);
}

TEST_F(ThreeCameras, PlatesAreFoundByFolderAndPattern) {
  EXPECT_TRUE(read_session(folder.path()).cameras[1].background.empty()); // a description is no file
  describe("", R"("background": "plates/{camera}.png")");
  EXPECT_THROW(read_session(folder.path()), FileNotFound);
  describe("", R"("background": "PLATES.JPG")"); // no description, either
  EXPECT_THROW(read_session(folder.path()), FileNotFound);
  describe("", R"("background": "{camera}/{camera}_clean.ppm")");
  for (const std::string &name : std::vector<std::string>{"cam0", "cam1", "cam2"})
    write_ppm(folder / name / (name + "_clean.ppm"), room(false, 77));
  EXPECT_EQ(read_session(folder.path()).cameras[1].background, folder / "cam1/cam1_clean.ppm");
  describe(R"(, "background": "nowhere.png")");
  EXPECT_THROW(read_session(folder.path()), FileNotFound);
  write_ppm(folder / "small.ppm", Image(10, 10, 3));
  describe(R"(, "background": "small.ppm")");
  EXPECT_THROW(read_session(folder.path()), Error);
}

TEST_F(ThreeCameras, ABlackFrameIsACameraThatDroppedOut) {
  write_ppm(folder / "cam2/3.ppm", Image(240, 240, 3, 4));
  fs::remove(folder / "cam2/5.ppm");
  const Session session = read_session(folder.path());
  const auto frames = FrameSource::open(session);
  EXPECT_TRUE(frames->image(2, 3).empty());
  EXPECT_TRUE(frames->image(2, 5).empty());
  EXPECT_FALSE(frames->image(2, 4).empty());
}

/// One camera with ready masks whose outlines are off by some pixels, another way in every frame.
class ReadyMasks : public FrameSource {
public:
  explicit ReadyMasks(bool walks) : walks_(walks) {}
  int frame_count() const override { return 9; }
  int camera_count() const override { return 1; }
  Image image(int, int frame) override { return room(true, static_cast<unsigned>(frame), nullptr, place(frame)); }
  Image mask(int, int frame) override { return moved(truth(frame), frame % 3 - 1, 3 * (frame % 2) - 2); }
  Image truth(int frame) const {
    Image mask;
    room(true, 0, &mask, place(frame));
    return mask;
  }
  /// The session that it is of, and how it is refined.
  std::unique_ptr<SilhouetteExtractor> extractor(double error) {
    Session session;
    session.cameras.resize(1);
    session.cameras[0].video = "images";
    session.cameras[0].masks = "masks";
    SilhouetteOptions options;
    options.mask_error = error * 1004 / 240;
    return session_silhouettes(session, *this, options, {});
  }

private:
  double place(int frame) const { return walks_ ? 0.2 + 0.07 * frame : 0.5; }
  static Image moved(const Image &mask, int right, int down) {
    Image result(mask.width, mask.height, 1, 0);
    for (int y = 5; y < mask.height - 5; ++y)
      for (int x = 5; x < mask.width - 5; ++x)
        result.at(x, y) = mask.at(x - right, y - down);
    return result;
  }
  bool walks_;
};

TEST(ReadyMasks, TheirOutlinesAreBroughtToTheImages) {
  for (const bool walks : {true, false}) { // behind who stands still nobody sees the room
    ReadyMasks frames(walks);
    const auto extractor = frames.extractor(2.5);
    for (int f : {2, 4, 8}) {
      EXPECT_LT(mask_iou(frames.mask(0, f), frames.truth(f)), 0.93) << f;
      EXPECT_GT(mask_iou(read_view(frames, 0, f, extractor.get()).mask, frames.truth(f)), 0.97) << f;
    }
  }
}

TEST(ReadyMasks, FarFromTheirOutlinesNothingChanges) {
  ReadyMasks frames(true);
  const auto extractor = frames.extractor(2.5);
  const Image image = frames.image(0, 4), nobody(240, 240, 1, 0);
  EXPECT_EQ(extractor->refine(0, image, nobody).data, nobody.data); // whoever is there, she is not the actor
  Image wide = nobody;                                              // she, and 20 pixels all around
  const auto away = [](int x, int y) { return std::hypot(x - 0.48 * 240, y - 0.4 * 240); };
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x)
      wide.at(x, y) = away(x, y) < 44 ? 255 : 0;
  const Image refined = extractor->refine(0, image, wide);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x)
      if (away(x, y) < 35 || away(x, y) > 44) {
        ASSERT_EQ(refined.at(x, y), wide.at(x, y)) << x << " " << y;
      }
}

/// The same masks; images that tell nothing.
class MasksOfNoise : public ReadyMasks {
public:
  MasksOfNoise() : ReadyMasks(true) {}
  Image image(int, int frame) override {
    std::mt19937 random(static_cast<unsigned>(frame));
    Image image(240, 240, 3);
    for (std::uint8_t &value : image.data)
      value = static_cast<std::uint8_t>(random() % 256);
    return image;
  }
};

TEST(ReadyMasks, StayWhereTheImageTellsNothing) {
  MasksOfNoise frames;
  const auto extractor = frames.extractor(2.5);
  for (int f : {2, 4, 8})
    EXPECT_GT(mask_iou(read_view(frames, 0, f, extractor.get()).mask, frames.mask(0, f)), 0.9) << f;
}

TEST(ReadyMasks, AreTakenAsTheyAreOnRequest) {
  ReadyMasks frames(true);
  EXPECT_EQ(read_view(frames, 0, 4, frames.extractor(0).get()).mask.data, frames.mask(0, 4).data);
  EXPECT_EQ(read_view(frames, 0, 4, nullptr).mask.data, frames.mask(0, 4).data);
  EXPECT_EQ(read_view(frames, 0, 4, SilhouetteExtractor::create().get()).mask.data, frames.mask(0, 4).data);
}

/// The same camera, whose mask is missing at a frame, beside one that has none at all.
class MasksWithAGap : public ReadyMasks {
public:
  MasksWithAGap() : ReadyMasks(true) {}
  int camera_count() const override { return 2; }
  Image mask(int camera, int frame) override { return camera == 0 && frame != 4 ? ReadyMasks::mask(0, frame) : Image(); }
};

TEST(ReadyMasks, WhereOneIsMissingTheCameraDropsOut) {
  MasksWithAGap frames;
  Session session;
  session.cameras.resize(2);
  session.cameras[0].video = session.cameras[1].video = "images";
  session.cameras[0].masks = "masks";
  SilhouetteOptions options;
  options.method = SilhouetteMethod::Median;
  const auto extractor = session_silhouettes(session, frames, options, {});
  EXPECT_EQ(read_view(frames, 0, 3, extractor.get()).mask.data, frames.mask(0, 3).data);
  EXPECT_TRUE(read_view(frames, 0, 4, extractor.get()).mask.empty());
  EXPECT_FALSE(read_view(frames, 1, 4, extractor.get()).mask.empty());
  session.cameras.pop_back(); // nor is there a method that would have to be trained
  const auto untrained = session_silhouettes(session, frames, {}, {});
  ASSERT_NE(untrained, nullptr);
  EXPECT_TRUE(read_view(frames, 0, 4, untrained.get()).mask.empty());
}

TEST(ReadyMasks, ThatDoNotFitTheImageAreRefused) {
  ReadyMasks frames(true);
  const auto extractor = frames.extractor(2.5);
  EXPECT_THROW(extractor->refine(0, frames.image(0, 1), Image(5, 5, 1)), std::invalid_argument);
  EXPECT_THROW(extractor->refine(0, Image(240, 240, 1), frames.mask(0, 1)), std::invalid_argument);
  EXPECT_TRUE(extractor->extract(0, frames.image(0, 1)).empty()); // where the mask is missing the camera drops out
  EXPECT_THROW(extractor->extract(1, frames.image(0, 1)), std::invalid_argument);
}

class MasksOfAnotherSize : public ReadyMasks {
public:
  MasksOfAnotherSize() : ReadyMasks(true) {}
  Image mask(int, int) override { return Image(240, 1, 1, 255); }
};

TEST(ReadyMasks, OfAnotherSizeAreRefusedBeforeTheyAreLearntFrom) {
  MasksOfAnotherSize frames;
  EXPECT_THROW(frames.extractor(2.5), Error);
}

} // namespace background_test
} // namespace doublet
