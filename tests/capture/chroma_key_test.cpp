// Chroma key: synthetic screens of any hue, and the shipped session.
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace doublet {
namespace chroma_key_test {

struct Scene {
  Image image, truth;
};

/// A grey-and-red disc before a screen that darkens towards the bottom, with a shadow at 60 % brightness and noise.
Scene disc(const Eigen::Vector3d &screen, int size = 240, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 3);
  Scene scene{Image(size, size, 3), Image(size, size, 1)};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size, v = static_cast<double>(y) / size;
      const bool actor = std::hypot(u - 0.5, v - 0.45) < 0.2, shadow = std::hypot((u - 0.5) / 3, v - 0.8) < 0.06;
      Eigen::Vector3d bgr = screen * (1.1 - 0.4 * v) * (shadow ? 0.6 : 1.0);
      if (actor)
        bgr = u < 0.5 ? Eigen::Vector3d(90, 90, 90) : Eigen::Vector3d(40, 40, 150);
      for (int c = 0; c < 3; ++c)
        scene.image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(bgr[c] + noise(random), 0.0, 255.0));
      scene.truth.at(x, y) = actor ? 255 : 0;
    }
  return scene;
}

TEST(ChromaKey, FindsAnyScreenColour) {
  for (const Eigen::Vector3d &screen :
       {Eigen::Vector3d(60, 160, 40), Eigen::Vector3d(170, 70, 40), Eigen::Vector3d(160, 50, 170)}) {
    const Scene scene = disc(screen);
    const auto key = SilhouetteExtractor::create();
    key->train(0, {scene.image});
    EXPECT_GT(mask_iou(key->extract(0, scene.image), scene.truth), 0.99) << screen.transpose();
  }
}

TEST(ChromaKey, EveryCameraHasItsOwnKey) {
  const Scene green = disc({60, 160, 40}), blue = disc({170, 70, 40});
  const auto key = SilhouetteExtractor::create();
  key->train(0, {green.image, Image(), green.image}); // an image that dropped out is passed over
  key->train(7, {blue.image});
  EXPECT_GT(mask_iou(key->extract(0, green.image), green.truth), 0.99);
  EXPECT_GT(mask_iou(key->extract(7, blue.image), blue.truth), 0.99);
  EXPECT_LT(mask_iou(key->extract(7, green.image), green.truth), 0.5);
}

TEST(ChromaKey, SmallBlobsAndHolesGo) {
  Scene scene = disc({60, 160, 40}, 1004);
  const auto paint = [&](int x0, int y0, int size, int from_x, int from_y) {
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        for (int c = 0; c < 3; ++c)
          scene.image.at(x0 + x, y0 + y, c) = scene.image.at(from_x + x, from_y + y, c);
  };
  paint(100, 100, 10, 450, 450); // 100 px of actor in the screen
  paint(200, 100, 20, 450, 450); // 400 px: stays
  paint(450, 420, 10, 50, 50);   // 100 px of screen in the actor
  paint(480, 480, 20, 50, 50);   // 400 px: stays
  const auto key = SilhouetteExtractor::create();
  key->train(0, {scene.image});
  const Image mask = key->extract(0, scene.image);
  EXPECT_EQ(mask.at(105, 105), 0);
  EXPECT_EQ(mask.at(210, 110), 255);
  EXPECT_EQ(mask.at(455, 425), 255);
  EXPECT_EQ(mask.at(490, 490), 0);
}

TEST(ChromaKey, WithoutAScreenItSaysSo) {
  const Scene grey = disc({120, 125, 118});
  const auto key = SilhouetteExtractor::create();
  try {
    key->train(3, {grey.image});
    FAIL() << "a grey wall was taken for a screen";
  } catch (const Error &e) {
    EXPECT_NE(std::string(e.what()).find("camera 3"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("mask"), std::string::npos);
  }
}

TEST(ChromaKey, AnEmptyStageIsAllScreen) {
  Scene scene = disc({60, 160, 40});
  const auto key = SilhouetteExtractor::create();
  for (int y = 0; y < scene.image.height; ++y) // screen over the actor
    for (int x = 0; x < scene.image.width; ++x)
      if (scene.truth.at(x, y))
        for (int c = 0; c < 3; ++c)
          scene.image.at(x, y, c) = scene.image.at(3, y, c);
  key->train(0, {scene.image});
  const Image mask = key->extract(0, scene.image);
  EXPECT_EQ(std::count(mask.data.begin(), mask.data.end(), 255), 0);
}

TEST(ChromaKey, WrongArgumentsThrow) {
  const Scene scene = disc({60, 160, 40});
  const auto key = SilhouetteExtractor::create();
  EXPECT_THROW(key->extract(0, scene.image), std::invalid_argument); // not trained
  EXPECT_THROW(key->train(0, {}), std::invalid_argument);
  EXPECT_THROW(key->train(0, {scene.truth}), std::invalid_argument); // one channel
  key->train(0, {scene.image});
  EXPECT_THROW(key->extract(0, scene.truth), std::invalid_argument);
  EXPECT_THROW(key->extract(0, Image()), std::invalid_argument);
  ChromaKeyOptions options;
  options.min_blob_area = -1;
  EXPECT_THROW(SilhouetteExtractor::create(options), std::invalid_argument);
}

TEST(ChromaKey, ShippedSession) {
  const std::filesystem::path folder = std::filesystem::path(DOUBLET_SOURCE_DIR) / "examples/data/session";
  const Session session = read_session(folder);
  const auto frames = FrameSource::open(session);
  // The true masks of the session read as a session of masks: one image in ten.
  Session truth = session;
  for (SessionCamera &camera : truth.cameras)
    camera.masks = folder / "ground_truth/masks" / (camera.name + "_%04d.png");
  const auto masks = FrameSource::open(truth);
  const auto key = SilhouetteExtractor::create();
  for (int camera : {0, 5}) {
    key->train(camera, {frames->image(camera, 0), frames->image(camera, 50), frames->image(camera, 100)});
    for (int frame : {0, 50, 100})
      // A boundary that is half a pixel off costs 3 % at this size.
      EXPECT_GT(mask_iou(key->extract(camera, frames->image(camera, frame)), masks->mask(camera, frame)), 0.96)
          << camera << " " << frame;
  }
}

} // namespace chroma_key_test
} // namespace doublet
