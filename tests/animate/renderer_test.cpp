// What a picture must be like, however it is drawn.

#include "doublet/animate/renderer.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace doublet;
using namespace doublet::testing;

namespace {

/// A square of side 2 that looks towards +Z, cut into n x n squares of two triangles.
RenderMesh square(int n, double z = 0, double x = 0) {
  RenderMesh mesh;
  mesh.vertices.resize((n + 1) * (n + 1), 3);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      mesh.vertices.row(i * (n + 1) + j) << x - 1 + 2.0 * j / n, -1 + 2.0 * i / n, z;
  mesh.faces.resize(2 * n * n, 3);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.faces.row(2 * (i * n + j)) << a, b, d;
      mesh.faces.row(2 * (i * n + j) + 1) << a, d, c;
    }
  return mesh;
}

/// Red grows along x, green along y.
void colour_by_place(RenderMesh &mesh) {
  mesh.colours = Vertices::Zero(mesh.vertices.rows(), 3);
  mesh.colours.leftCols<2>() = (mesh.vertices.leftCols<2>().array() + 1) / 2;
}

RenderOptions plain() {
  RenderOptions options;
  options.floor = false;
  options.background = {0, 0, 0};
  return options;
}

int most_different(const Image &a, const Image &b) {
  int most = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i)
    most = std::max(most, std::abs(a.data[i] - b.data[i]));
  return most;
}

/// Texture of `size` x `size` texels, black and white in turn, over the whole square.
RenderMesh chequered(int size) {
  RenderMesh mesh = square(8);
  Image image(size, size, 3);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = (x + y) % 2 ? 255 : 0;
  mesh.texture = std::make_shared<const Image>(image);
  mesh.texcoords.resize(3 * mesh.faces.rows(), 2);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      mesh.texcoords.row(3 * f + k) = (mesh.vertices.row(mesh.faces(f, k)).head<2>().array() + 1) / 2;
  return mesh;
}

/// The darkest and the brightest of an image's middle.
std::pair<int, int> extremes(const Image &image) {
  int least = 255, most = 0;
  for (int y = image.height / 4; y < 3 * image.height / 4; ++y)
    for (int x = image.width / 4; x < 3 * image.width / 4; ++x) {
      least = std::min<int>(least, image.at(x, y, 1));
      most = std::max<int>(most, image.at(x, y, 1));
    }
  return {least, most};
}

} // namespace

TEST(Picture, ASurfaceLooksTheSameHoweverItIsCut) {
  const Camera camera = look_at({0.3, 0.2, 4}, {0, 0, 0}, 150, 120, 120);
  RenderMesh whole = square(1), cut = square(40);
  colour_by_place(whole);
  colour_by_place(cut);
  const Image few = render({whole}, camera, plain()), many = render({cut}, camera, plain());
  EXPECT_LE(most_different(few, many), 3); // two triangles are seen in turn where many meet in a pixel
  EXPECT_GT(many.at(90, 60, 2), many.at(30, 60, 2) + 50);
}

TEST(Picture, EdgesBetweenSurfacesAreSmooth) {
  RenderMesh red = square(8, 0.5, -1), blue = square(8);
  red.colour = {1, 0, 0};
  blue.colour = {0, 0, 1};
  const Camera camera = look_at({0.13, 0.02, 4}, {0.13, 0.3, 0}, 100, 80, 80);
  const Image image = render({red, blue}, camera, plain());
  RenderOptions coarse = plain();
  coarse.supersample = false;
  const Image hard = render({red, blue}, camera, coarse);
  const auto mixed = [](const Image &of) {
    int count = 0;
    for (int y = 20; y < 60; ++y)
      for (int x = 0; x < 80; ++x)
        count += of.at(x, y, 0) > 40 && of.at(x, y, 2) > 40;
    return count;
  };
  EXPECT_EQ(mixed(hard), 0);
  EXPECT_GT(mixed(image), 10);
}

TEST(Picture, TextureFromAfarIsItsMean) {
  const RenderMesh mesh = chequered(512);
  const double close = 8 * 200.0 * 512 / 2; // px, focal length: a texel is 8 px wide
  const auto [black, white] = extremes(render({mesh}, look_at({0, 0, 200}, {0, 0, 0}, close, 40, 40), plain()));
  EXPECT_LT(black, 40);
  EXPECT_GT(white, 170);
  const auto [least, most] = extremes(render({mesh}, look_at({0, 0, 4}, {0, 0, 0}, 120, 64, 64), plain()));
  EXPECT_LT(most - least, 12);
  EXPECT_NEAR((least + most) / 2.0, (black + white) / 2.0, 12);
}

TEST(Picture, TextureIsWhereItsCoordinatesSay) {
  RenderMesh mesh = chequered(3); // odd: the halves of its levels are not all of one size
  const Camera camera = look_at({0, 0, 4}, {0, 0, 0}, 190, 120, 120);
  const Image image = render({mesh}, camera, plain());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector2d at = camera.project({-1 + (2 * j + 1) / 3.0, -1 + (2 * i + 1) / 3.0, 0});
      const int seen = image.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())), 1);
      EXPECT_EQ(seen > 128, (i + j) % 2 == 1) << i << " " << j << " " << seen;
    }
}

TEST(Picture, TheInnerSideIsDarker) {
  RenderOptions options = plain();
  options.light = 0; // the sky alone, from above: the same from both sides of what stands upright
  const int outside = render({square(4)}, look_at({0, 0, 4}, {0, 0, 0}, 50, 32, 32), options).at(16, 16, 1),
            inside = render({square(4)}, look_at({0, 0, -4}, {0, 0, 0}, 50, 32, 32), options).at(16, 16, 1);
  EXPECT_NEAR(inside, 0.6 * outside, 2);
}

TEST(Picture, TheFloorFadesExponentially) {
  RenderOptions options;
  options.background = {1, 1, 1};
  const Camera camera = look_at({0.25, 1, 2}, {0.25, 0, 0}, 150, 160, 160);
  const Image image = render({}, camera, options);
  const Eigen::Vector3d eye = camera.centre();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Eigen::Vector3d ray = camera.ray_direction({x, y}).normalized();
      if (ray.y() > -0.01)
        continue;
      const Eigen::Vector3d spot = eye - eye.y() / ray.y() * ray;
      const auto from_line = [](double at) { return std::abs(at - 0.5 * std::round(2 * at)) / 0.006; };
      const double line = std::min(from_line(spot.x()), from_line(spot.z()));
      const double floor = 0.86 - 0.10 * std::exp(-0.5 * line * line), left = std::exp(-(spot - eye).norm() / 12);
      EXPECT_NEAR(image.at(x, y, 1), 255 * (1 - left * (1 - floor)), 0.7) << x << " " << y;
    }
}

TEST(Picture, TheFloorHasAGridAndEndsAtTheHorizon) {
  RenderOptions options;
  const Camera camera = look_at({0.25, 1, 2}, {0.25, 0, 0}, 150, 160, 160);
  const Image image = render({}, camera, options);
  const auto brightness = [&](double x, double z) {
    const Eigen::Vector2d at = camera.project({x, 0, z});
    return static_cast<int>(image.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())), 1));
  };
  EXPECT_LT(brightness(0.25, 0.5) + 5, brightness(0.25, 0.25)); // a line every half metre, along both axes
  EXPECT_LT(brightness(0.5, 0.25) + 5, brightness(0.25, 0.25));
  const auto sky = static_cast<int>(options.background.y() * 255 + 0.5);
  EXPECT_LT(brightness(0.25, 0.25), sky);
  const Image level = render({}, look_at({0, 1, 0}, {0, 1, -5}, 150, 160, 160), options);
  EXPECT_EQ(level.at(80, 20, 1), sky);
  EXPECT_LT(level.at(80, 150, 1), sky);
  const Image from_below = render({}, look_at({0, -1, 0}, {0, -3, -1}, 150, 160, 160), options);
  EXPECT_EQ(extremes(from_below), std::pair(sky, sky));
}

TEST(Picture, ALensThatHardlyBendsSeesTheSame) {
  RenderMesh mesh = square(10);
  colour_by_place(mesh);
  const Camera camera = look_at({0.4, 1.2, 3}, {0, 0.2, 0}, 150, 120, 120);
  Camera bent = camera;
  bent.distortion[0] = 1e-9;
  RenderOptions options;
  options.floor_height = -0.5;
  EXPECT_LE(most_different(render({mesh}, camera, options), render({mesh}, bent, options)), 1);
}
