// A texture of several frames: what one hides is of another; how it is laid out.
#include "../../libanimate/src/display/texture_charts.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/core/rasterizer.h"
#include "support/figure.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

using namespace doublet;
using namespace doublet::testing;

namespace {

using Eigen::Vector3d;

/// B G R, 0 to 255, of a place of the sheet.
Vector3d sheet_pattern(double x, double y) {
  return {128 + 100 * std::sin(40 * x), 128 + 100 * std::sin(40 * y + 1), 128 + 100 * std::sin(25 * (x - y))};
}

/// A sheet of 0.6 m that looks to two cameras, in its pattern. Folded, all that is right of the middle lies behind the left.
struct FoldingSheet {
  Mesh flat = grid(0.6, 0.6, 48, 48);
  CameraRig cameras{look_at({0.2, 1, 2}, {0, 1, 0}, 900, 600, 600), look_at({-0.2, 1.1, 2}, {0, 1, 0}, 900, 600, 600)};
  TextureOptions options;
  std::vector<Vertices> frames;
  std::vector<double> brightness;
  std::vector<int> read;

  FoldingSheet() {
    flat.vertices = Vertices(flat.vertices * Eigen::AngleAxisd(pi / 2, Vector3d::UnitX()).toRotationMatrix().transpose());
    flat.vertices.col(1).array() += 1;
    options.albedo = false;
    options.size = 1024;
  }
  Vertices folded() const {
    Vertices at = flat.vertices;
    for (Eigen::Index v = 0; v < at.rows(); ++v)
      if (at(v, 0) > 0)
        at.row(v) = Eigen::RowVector3d(-at(v, 0), at(v, 1), -0.1);
    return at;
  }
  void add(const Vertices &vertices, double bright = 1) {
    frames.push_back(vertices);
    brightness.push_back(bright);
  }
  Image photograph(const Vertices &vertices, const Camera &camera, double bright) const {
    const FaceBuffer buffer = rasterize(vertices, flat.faces, camera);
    Image image(camera.width, camera.height, 3);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (const int f = buffer.face_at(x, y); f >= 0) {
          const Vector3d b = barycentric_at(vertices, flat.faces, f, camera, Eigen::Vector2d(x, y));
          const Vector3d at = flat.vertices({flat.faces(f, 0), flat.faces(f, 1), flat.faces(f, 2)}, Eigen::all).transpose() * b;
          for (int c = 0; c < 3; ++c)
            image.at(x, y, c) = static_cast<std::uint8_t>(bright * sheet_pattern(at.x(), at.y())[c] + 0.5);
        }
    return image;
  }
  FilmedSurface filmed() {
    return {static_cast<int>(frames.size()), [this](int t) { return frames[t]; },
            [this](int t) {
              read.push_back(t);
              FrameImages found;
              for (const Camera &camera : cameras)
                found.images.push_back(photograph(frames[t], camera, brightness[t]));
              return found;
            }};
  }
  BakedTexture baked(const Context &context = {}) { return bake_texture(flat, {}, cameras, filmed(), {}, options, context); }
  /// Largest difference to the pattern, in a channel, in the middles of the faces between two x, off the sheet's rim.
  double worst(const BakedTexture &texture, double from, double to) const {
    double most = 0;
    for (int f = 0; f < flat.faces.rows(); ++f) {
      const Vector3d at =
          (flat.vertices.row(flat.faces(f, 0)) + flat.vertices.row(flat.faces(f, 1)) + flat.vertices.row(flat.faces(f, 2))) / 3;
      if (at.x() < from || at.x() > to || std::abs(at.x()) > 0.27 || std::abs(at.y() - 1) > 0.27)
        continue;
      const Eigen::RowVector2d uv = texture.texcoords.middleRows(3 * f, 3).colwise().mean() * texture.image.width;
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(texture.image.at(static_cast<int>(uv.x()), static_cast<int>(uv.y()), c) -
                                       sheet_pattern(at.x(), at.y())[c]));
    }
    return most;
  }
};

} // namespace

TEST(TextureOfATake, WhatTheFirstFrameHidesIsOfAnother) {
  FoldingSheet sheet;
  for (int t = 0; t < 5; ++t)
    sheet.add(t == 3 ? sheet.flat.vertices : sheet.folded());
  sheet.options.frames = 1;
  const BakedTexture first = sheet.baked();
  EXPECT_GT(sheet.worst(first, 0.05, 1), 150); // filled from beside
  EXPECT_LT(sheet.worst(first, -1, -0.05), 20);
  EXPECT_LT(first.seen_fraction, 0.6);
  sheet.options.frames = 2;
  const BakedTexture two = sheet.baked();
  EXPECT_EQ(sheet.read, (std::vector<int>{0, 0, 3}));
  EXPECT_LT(sheet.worst(two, -1, 1), 20);
  EXPECT_GT(two.seen_fraction, 0.85);
}

TEST(TextureOfATake, FramesInOtherLightMeetWithoutASeam) {
  FoldingSheet sheet;
  sheet.add(sheet.folded());
  sheet.add(sheet.flat.vertices, 0.7);
  const BakedTexture texture = sheet.baked();
  // A column of faces on each side of the fold, where one frame goes over into the other, against the pattern's own step.
  std::map<int, std::pair<Vector3d, int>> columns;
  for (int f = 0; f < sheet.flat.faces.rows(); ++f) {
    const Vector3d at = (sheet.flat.vertices.row(sheet.flat.faces(f, 0)) + sheet.flat.vertices.row(sheet.flat.faces(f, 1)) +
                         sheet.flat.vertices.row(sheet.flat.faces(f, 2))) /
                        3;
    if (std::abs(at.y() - 1) > 0.2)
      continue;
    const Eigen::RowVector2d uv = texture.texcoords.middleRows(3 * f, 3).colwise().mean() * texture.image.width;
    auto &[sum, count] =
        columns.try_emplace(static_cast<int>(std::floor(at.x() / 0.0125)), Vector3d(Vector3d::Zero()), 0).first->second;
    for (int c = 0; c < 3; ++c)
      sum[c] += texture.image.at(static_cast<int>(uv.x()), static_cast<int>(uv.y()), c) / sheet_pattern(at.x(), at.y())[c];
    ++count;
  }
  double step = 0;
  for (int column = -12; column < 11; ++column)
    step =
        std::max(step, (columns[column].first / columns[column].second - columns[column + 1].first / columns[column + 1].second)
                           .cwiseAbs()
                           .maxCoeff());
  EXPECT_LT(step, 0.13); // of 0.3
}

TEST(TextureOfATake, ACameraGoesOverIntoAnotherTowardsTheBorderOfItsView) {
  FoldingSheet sheet;
  sheet.cameras[1] = look_at({-0.6, 1, 2}, {-0.6, 1, 0}, 900, 600, 600); // up to x = 0.067
  std::vector<Image> images;
  for (int bright : {200, 100})
    images.emplace_back(600, 600, 3, static_cast<std::uint8_t>(bright));
  const BakedTexture texture = bake_texture(sheet.flat, {}, sheet.cameras, images, {}, {}, sheet.options);
  const Eigen::RowVector2d low = texture.texcoords.colwise().minCoeff() * texture.image.width,
                           high = texture.texcoords.colwise().maxCoeff() * texture.image.width;
  constexpr int kRim = 40; // px; there a camera sees the backdrop beside the sheet
  int most = 0;
  for (int y = static_cast<int>(low.y()) + kRim; y < static_cast<int>(high.y()) - kRim; ++y)
    for (int x = static_cast<int>(low.x()) + kRim; x < static_cast<int>(high.x()) - kRim; ++x)
      most = std::max({most, std::abs(texture.image.at(x + 1, y, 0) - texture.image.at(x, y, 0)),
                       std::abs(texture.image.at(x, y + 1, 0) - texture.image.at(x, y, 0))});
  EXPECT_GT(most, 0);
  EXPECT_LT(most, 8);
}

TEST(TextureOfATake, OneFrameOfATakeIsThatFrame) {
  FoldingSheet sheet;
  sheet.add(sheet.flat.vertices);
  const FrameImages images = sheet.filmed().images(0);
  const BakedTexture one = bake_texture(sheet.flat, {}, sheet.cameras, images.images, {}, {}, sheet.options);
  EXPECT_TRUE(sheet.baked().image.data == one.image.data);
}

TEST(TextureOfATake, SameBitsForAnyNumberOfThreads) {
  FoldingSheet sheet;
  sheet.options.albedo = true;
  sheet.add(sheet.folded());
  sheet.add(sheet.flat.vertices, 0.7);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_TRUE(sheet.baked(one).image.data == sheet.baked(two).image.data);
}

TEST(TextureOfATake, RefusesWhatDoesNotFit) {
  FoldingSheet sheet;
  EXPECT_THROW(sheet.baked(), std::invalid_argument); // no frame
  sheet.add(sheet.flat.vertices.topRows(7));
  EXPECT_THROW(sheet.baked(), std::invalid_argument);
}

TEST(TextureCharts, LieApartAndVerticesAreSeldomThereTwice) {
  const Mesh person = figure_surface(0.025);
  std::vector<std::uint8_t> shown(person.faces.rows(), 1);
  shown[5] = 0;
  const detail::ChartLayout layout = detail::lay_out_charts(person, shown, 1024);
  EXPECT_EQ(layout.chart[5], -1);
  EXPECT_GT(layout.texcoords.topRows(15).minCoeff(), 0);
  std::vector<int> claimed(1024 * 1024, 0);
  std::set<std::tuple<int, double, double>> places;
  for (int f = 0; f < person.faces.rows(); ++f) {
    if (!shown[f])
      continue;
    for (int k = 0; k < 3; ++k)
      places.emplace(person.faces(f, k), layout.texcoords(3 * f + k, 0), layout.texcoords(3 * f + k, 1));
    detail::for_pixels({layout.corner(f, 0), layout.corner(f, 1), layout.corner(f, 2)},
                       [&](int x, int y, const Vector3d &b) { claimed[1024 * y + x] += b.minCoeff() > 1e-6; });
  }
  EXPECT_LT(static_cast<double>(places.size()), 1.35 * static_cast<double>(person.vertices.rows()));
  // Charts are flattened where they do not lie over themselves to a pixel.
  EXPECT_LT(std::count_if(claimed.begin(), claimed.end(), [](int times) { return times > 1; }), 200);
  EXPECT_GT(std::count_if(claimed.begin(), claimed.end(), [](int times) { return times > 0; }), 1024 * 1024 / 5);
}

TEST(TextureCharts, WhatLiesBetweenThemIsLikeThem) {
  const Mesh ball = sphere(0.5);
  const detail::ChartLayout layout = detail::lay_out_charts(ball, {}, 256);
  Image image(256, 256, 3, 0);
  for (int f = 0; f < ball.faces.rows(); ++f)
    detail::for_texels(layout, f, [&](int x, int y, const Vector3d &) { image.at(x, y, 1) = 200; });
  detail::fill_between_charts(layout, image);
  for (std::size_t i = 0; i < layout.owner.size(); ++i)
    ASSERT_EQ(image.data[3 * i + 1], 200);
}
