// The texture's colours against a truth: light divided out, the screen and what is behind kept out.
#include "doublet/animate/parts/irradiance.h"
#include "doublet/animate/renderer.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/core/rasterizer.h"
#include "support/figure.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

using namespace doublet;
using namespace doublet::testing;

namespace {

using Colour = Eigen::Vector3d;
const Colour kSkin(110, 140, 200), kGreenScreen(60, 180, 40), kBlueScreen(180, 70, 40); // B G R

std::size_t pixel_of(const Image &image, double u, double v) {
  return 3 * (static_cast<std::size_t>(v * image.height) * image.width + static_cast<std::size_t>(u * image.width));
}

/// (F, 3) B G R in the middle of every face.
Vertices face_colours(const BakedTexture &baked) {
  Vertices colours(baked.texcoords.rows() / 3, 3);
  for (Eigen::Index f = 0; f < colours.rows(); ++f) {
    const Eigen::RowVector2d uv = baked.texcoords.middleRows(3 * f, 3).colwise().mean();
    const std::size_t at = pixel_of(baked.image, uv.x(), uv.y());
    for (int c = 0; c < 3; ++c)
      colours(f, c) = baked.image.data[at + c];
  }
  return colours;
}

/// 10 %, 50 % and 90 % of a channel's ratio to the truth, over the faces.
std::array<double, 3> ratios(const Vertices &found, const Vertices &truth, int channel) {
  const Eigen::VectorXd ratio = found.col(channel).cwiseQuotient(truth.col(channel));
  const std::vector<double> values(ratio.begin(), ratio.end());
  return {quantile(values, 0.1), quantile(values, 0.5), quantile(values, 0.9)};
}

/// Unit normals all around, and what they show of patches of 20 in one of five albedos.
ShadedPoints shaded_points(const std::function<Colour(const Eigen::Vector3d &)> &light) {
  constexpr int kPoints = 2000, kPatch = 20;
  ShadedPoints points;
  points.normals = Vertices::Random(kPoints, 3);
  points.normals.rowwise().normalize();
  points.colours.resize(kPoints, 3);
  points.weights = Eigen::VectorXd::Ones(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double albedo = i % 7 == 0 ? 0.03 : 0.1 * (1 + i / kPatch % 5); // every seventh is a spot
    points.patches.push_back(i / kPatch);
    points.colours.row(i) = albedo * light(points.normals.row(i)).transpose();
  }
  return points;
}

/// A ball of skin before a screen; the mask is the ball's, whatever the picture shows in it.
struct BeforeScreen {
  Mesh ball = sphere(0.4, {0, 0.9, 0}, 24, 48);
  CameraRig cameras = camera_ring(2, 320);
  std::vector<Image> images, masks;

  BeforeScreen(const Colour &actor, const Colour &screen) {
    for (const Camera &camera : cameras) {
      masks.push_back(silhouette(rasterize(ball.vertices, ball.faces, camera)));
      Image image(camera.width, camera.height, 3);
      for (std::size_t i = 0; i < masks.back().data.size(); ++i)
        for (int c = 0; c < 3; ++c)
          image.data[3 * i + c] = static_cast<std::uint8_t>((masks.back().data[i] ? actor : screen)[c]);
      images.push_back(image);
    }
  }
  /// The screen, as wide as between two fingers, shows through near the left rim of every picture.
  void open_gap(const Colour &screen) {
    for (Image &image : images)
      for (int y = 150; y < 170; ++y) {
        int x = 0;
        while (image.at(x, y, 2) == image.at(0, y, 2))
          ++x;
        for (int c = 0; c < 3; ++c)
          image.at(x + 6, y, c) = image.at(x + 7, y, c) = static_cast<std::uint8_t>(screen[c]);
      }
  }
  /// Every second band of 8 rows is darker.
  void darken_bands() {
    for (std::size_t c = 0; c < images.size(); ++c)
      for (std::size_t i = 0; i < masks[c].data.size(); ++i)
        if (masks[c].data[i] && i / static_cast<std::size_t>(images[c].width) / 8 % 2)
          for (int k = 0; k < 3; ++k)
            images[c].data[3 * i + k] = static_cast<std::uint8_t>(0.6 * images[c].data[3 * i + k]);
  }
  Vertices baked(double screen_reach) const {
    TextureOptions options;
    options.size = 1024;
    options.albedo = false;
    options.screen_reach = screen_reach;
    return face_colours(bake_texture(ball, {}, cameras, images, masks, options));
  }
};

} // namespace

TEST(Irradiance, OfAKnownLightIsFoundThroughSpotsAndPatches) {
  const Eigen::Vector3d sun = Eigen::Vector3d(0.5, 0.7, -0.4).normalized();
  const auto light = [&](const Eigen::Vector3d &n) -> Colour { // warm key light, cold surroundings
    return Colour(0.5, 0.45, 0.4) + std::max(0.0, n.dot(sun)) * Colour(0.5, 0.55, 0.6);
  };
  const ShadedPoints points = shaded_points(light);
  const Irradiance found = estimate_irradiance(points);
  double sum = 0;
  for (Eigen::Index i = 0; i < points.normals.rows(); ++i) {
    const Colour expected = light(points.normals.row(i)), at = found.at(points.normals.row(i));
    ASSERT_LE(at.maxCoeff(), 1);
    ASSERT_LT((at - expected).cwiseAbs().maxCoeff(), 0.15) << points.normals.row(i); // what order 2 cannot follow
    sum += (at - expected).cwiseAbs().mean();
  }
  EXPECT_LT(sum / points.normals.rows(), 0.05);
}

TEST(Irradiance, OfEvenLightIsOne) {
  const Irradiance found = estimate_irradiance(shaded_points([](const Eigen::Vector3d &) { return Colour(0.8, 0.8, 0.8); }));
  for (const Eigen::Vector3d &n : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0.6, 0.8)})
    EXPECT_LT((found.at(n) - Colour::Ones()).cwiseAbs().maxCoeff(), 0.03) << found.at(n).transpose();
  EXPECT_EQ(estimate_irradiance({}).at({0, 1, 0}), Colour(1, 1, 1));
}

TEST(Irradiance, OfOneDirectionIsNotExtrapolated) {
  ShadedPoints points = shaded_points([](const Eigen::Vector3d &) { return Colour(0.5, 0.5, 0.5); });
  points.normals.rowwise() = Eigen::RowVector3d(0, 0, 1);
  EXPECT_EQ(estimate_irradiance(points).at({0, -1, 0}), Colour(1, 1, 1));
}

TEST(Irradiance, RefusesWhatDoesNotFit) {
  ShadedPoints points = shaded_points([](const Eigen::Vector3d &) { return Colour(0.5, 0.5, 0.5); });
  points.colours(3, 1) = 0;
  EXPECT_THROW(estimate_irradiance(points), std::invalid_argument);
  points.colours(3, 1) = 0.5;
  points.patches.pop_back();
  EXPECT_THROW(estimate_irradiance(points), std::invalid_argument);
}

TEST(TextureColours, AlbedoIsTheTruthOfALitPerson) {
  RenderMesh person;
  const Mesh mesh = figure_surface(0.04);
  person.vertices = mesh.vertices;
  person.faces = mesh.faces;
  person.colours.resize(mesh.vertices.rows(), 3); // R G B: skin, and a shirt in two colours
  for (Eigen::Index v = 0; v < person.colours.rows(); ++v) {
    const Eigen::Vector3d p = mesh.vertices.row(v);
    const bool shirt = p.y() > 0.95 && p.y() < 1.35, stripe = std::fmod(p.y(), 0.1) < 0.05;
    person.colours.row(v) = !shirt   ? Eigen::RowVector3d(0.7, 0.5, 0.4)
                            : stripe ? Eigen::RowVector3d(0.6, 0.6, 0.6)
                                     : Eigen::RowVector3d(0.2, 0.3, 0.6);
  }
  const CameraRig cameras = camera_ring(8, 400);
  RenderOptions studio;
  studio.floor = false;
  std::vector<Image> images, masks;
  for (const Camera &camera : cameras) {
    images.push_back(render({person}, camera, studio));
    masks.push_back(silhouette(rasterize(mesh.vertices, mesh.faces, camera)));
  }
  Vertices truth(mesh.faces.rows(), 3); // B G R
  for (Eigen::Index f = 0; f < truth.rows(); ++f)
    truth.row(f) = 255 * person.colours(mesh.faces.row(f).transpose(), Eigen::all).colwise().mean().reverse();
  TextureOptions options;
  options.size = 1024;
  const Vertices albedo = face_colours(bake_texture(mesh, {}, cameras, images, masks, options));
  options.albedo = false;
  const Vertices photographed = face_colours(bake_texture(mesh, {}, cameras, images, masks, options));
  for (int c = 0; c < 3; ++c) {
    const auto [dark, middle, bright] = ratios(photographed, truth, c);
    EXPECT_GT(bright / dark, 1.9);
    const auto [low, centre, high] = ratios(albedo, truth, c);
    EXPECT_LT(high / low, 1.3) << "channel " << c << ": " << low << " " << centre << " " << high;
  }
}

TEST(TextureColours, AGapBetweenFingersIsNotPainted) {
  BeforeScreen scene(kSkin, kGreenScreen);
  scene.open_gap(kGreenScreen);
  const auto greenest = [](const Vertices &colours) { return (colours.col(1) - colours.col(2)).maxCoeff(); };
  EXPECT_GT(greenest(scene.baked(0)), 0); // greener than red
  EXPECT_LT(greenest(scene.baked(0.05)), kSkin[1] - kSkin[2] + 5);
}

TEST(TextureColours, AGreenGarmentStaysGreen) {
  const Colour shirt(70, 150, 60);
  for (const Colour &screen : {kBlueScreen, kGreenScreen, Colour(120, 120, 120)}) {
    BeforeScreen scene(shirt, screen);
    scene.darken_bands();
    EXPECT_EQ(scene.baked(0.05), scene.baked(0)) << screen.transpose();
  }
}

TEST(TextureColours, WhatIsBehindAnEdgeDoesNotCount) {
  const Mesh wall = tube(
      {0, 0, 0}, {0, 2, 0}, [](double) { return 0.3; }, 60, 80);
  const Mesh ball = sphere(0.12, {0, 1, 0.6}), smaller = sphere(0.117, {0, 1, 0.6});
  const Mesh truth = join({smaller, wall}), believed = join({ball, wall});
  const Camera camera = look_at({0, 1, 3}, {0, 1, 0}, 900, 600, 600);
  const FaceBuffer seen = rasterize(truth.vertices, truth.faces, camera);
  Image image(600, 600, 3);
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 600; ++x)
      image.at(x, y, seen.face_at(x, y) >= smaller.faces.rows() ? 2 : 0) = 200; // a blue ball before a red wall
  TextureOptions options;
  options.albedo = false;
  const Vertices colours = face_colours(bake_texture(believed, {}, {camera}, {image}, {}, options));
  EXPECT_LT(colours.topRows(ball.faces.rows()).col(2).maxCoeff(), 5);
}
