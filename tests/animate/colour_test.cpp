// The texture's colours against a truth: light divided out, the screen and what is behind kept out.
#include "../../libanimate/src/display/silhouette_depth.h"
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
  Mesh ball;
  CameraRig cameras;
  std::vector<Image> images, masks;

  BeforeScreen(const Colour &actor, const Colour &screen, int size = 320, int rings = 24)
      : ball(sphere(0.4, {0, 0.9, 0}, rings, 2 * rings)), cameras(camera_ring(2, size)) {
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
  Vertices baked(double screen_margin) const {
    TextureOptions options;
    options.size = 1024;
    options.albedo = false;
    options.screen_margin = screen_margin;
    return face_colours(bake_texture(ball, {}, cameras, images, masks, {}, options));
  }
};

const Colour kCloth(40, 30, 150); // B G R

/// A ball of skin before a wall of cloth, of which every part is seen by one camera in front; another sees the ball beside the
/// wall. In the pictures the ball is `off` (m) to the right of where it is believed to be. Half a metre above it, the body wears
/// the same cloth.
struct HandBeforeSkirt {
  Mesh hand, shirt = sphere(0.1, {0, 1.5, 0.1}), believed;
  CameraRig cameras{look_at({0, 1, 2}, {0, 1, 0}, 1200, 800, 800), look_at({2, 1, 0.1}, {0, 1, 0.1}, 1200, 800, 800)};
  std::vector<Image> images;
  TextureOptions options;

  explicit HandBeforeSkirt(double off, double flatness = 1) : hand(sphere(0.06)) {
    hand.vertices.col(2) *= flatness;
    hand.vertices.rowwise() += Eigen::RowVector3d(0, 1, flatness < 1 ? 0.01 : 0.1);
    Mesh skirt = grid(0.6, 0.6, 60, 60), there = hand;
    skirt.vertices =
        Vertices(skirt.vertices * Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix().transpose());
    skirt.vertices.col(1).array() += 1;
    believed = join({hand, shirt, skirt});
    there.vertices.col(0).array() += off;
    paint(join({there, shirt, skirt}), [](const Colour &) { return kSkin; });
    options.albedo = false;
    options.edge_margin = 0;
    options.size = 1024;
  }
  /// What the cameras see of `mesh`; a hand has the colours `skin` of its points in space.
  void paint(const Mesh &mesh, const std::function<Colour(const Eigen::Vector3d &)> &skin) {
    images.clear();
    for (const Camera &camera : cameras) {
      const FaceBuffer seen = rasterize(mesh.vertices, mesh.faces, camera);
      Image image(camera.width, camera.height, 3);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          if (const int f = seen.face_at(x, y); f >= 0) {
            const Eigen::Vector3d centre = mesh.vertices(mesh.faces.row(f).transpose(), Eigen::all).colwise().mean();
            for (int c = 0; c < 3; ++c)
              image.at(x, y, c) = static_cast<std::uint8_t>((is_hand(f) ? skin(centre) : kCloth)[c]);
          }
      images.push_back(image);
    }
  }
  bool is_hand(Eigen::Index f) const { return f < hand.faces.rows(); }
  bool is_body(Eigen::Index f) const { return f < hand.faces.rows() + shirt.faces.rows(); }
  std::vector<SurfaceLabel> labels() const {
    std::vector<SurfaceLabel> of_faces;
    for (Eigen::Index f = 0; f < believed.faces.rows(); ++f)
      of_faces.push_back(is_body(f) ? SurfaceLabel::Body : SurfaceLabel::Garment);
    return of_faces;
  }
  BakedTexture baked(const std::vector<SurfaceLabel> &of_faces, const Context &context = {}) const {
    return bake_texture(believed, {}, cameras, images, {}, of_faces, options, context);
  }
  /// How far off the worst of the hand's faces is, and of what is of cloth.
  std::pair<double, double> worst(const BakedTexture &texture) const {
    const Vertices colours = face_colours(texture);
    double of_hand = 0, of_skirt = 0;
    for (Eigen::Index f = 0; f < colours.rows(); ++f) {
      double &most = is_hand(f) ? of_hand : of_skirt;
      most = std::max(most, (colours.row(f).transpose() - (is_hand(f) ? kSkin : kCloth)).cwiseAbs().maxCoeff());
    }
    return {of_hand, of_skirt};
  }
  /// In the middle of any face.
  bool labels_change_nothing() const { return face_colours(baked(labels())) == face_colours(baked({})); }
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
  const Vertices albedo = face_colours(bake_texture(mesh, {}, cameras, images, masks, {}, options));
  options.albedo = false;
  const Vertices photographed = face_colours(bake_texture(mesh, {}, cameras, images, masks, {}, options));
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

/// The same between an arm and the body: too deep for screen_margin.
TEST(TextureColours, AGapDeepInsideAMaskIsNotPainted) {
  BeforeScreen scene(kSkin, kGreenScreen, 1280, 48);
  const Eigen::Vector2i middle = scene.cameras[0].project({0, 0.9, 0}).cast<int>();
  for (int y = -8; y < 8; ++y)
    for (int x = -8; x < 8; ++x)
      for (int c = 0; c < 3; ++c)
        scene.images[0].at(middle.x() + x, middle.y() + y, c) = static_cast<std::uint8_t>(kGreenScreen[c]);
  const auto greenest = [](const Vertices &colours) { return (colours.col(1) - colours.col(2)).maxCoeff(); };
  EXPECT_GT(greenest(scene.baked(0)), 0);
  EXPECT_LT(greenest(scene.baked(0.01)), kSkin[1] - kSkin[2] + 5);
}

/// Two pictures of skin in the middle of a green screen, with a square of green in each, `sides` pixels wide, and a pixel near
/// the rim of the first. 20,000 pixels of each mask lie deep.
struct TwoViews {
  std::vector<Image> images, masks;
  explicit TwoViews(std::array<int, 2> sides) {
    for (int c = 0; c < 2; ++c) {
      images.emplace_back(260, 260, 3);
      masks.emplace_back(260, 260, 1);
      for (int y = 0; y < 260; ++y)
        for (int x = 0; x < 260; ++x) {
          const bool inside = std::min({x, y, 259 - x, 259 - y}) >= 50,
                     green = x >= 120 && x < 120 + sides[c] && y >= 120 && y < 120 + sides[c];
          masks[c].at(x, y, 0) = inside ? 255 : 0;
          for (int k = 0; k < 3; ++k)
            images[c].at(x, y, k) =
                static_cast<std::uint8_t>((inside && !green && !(x == 53 && y == 100) ? kSkin : kGreenScreen)[k]);
        }
    }
  }
};

TEST(TextureColours, WhatTheActorWearsIsToldByAllCamerasTogether) {
  const auto left = [](const TwoViews &views) { // of the first mask: near the rim, deep inside
    const Image mask = detail::without_screen(views.images, views.masks, 0.035)[0];
    return std::array{mask.at(53, 100, 0) > 0, mask.at(120, 120, 0) > 0};
  };
  EXPECT_EQ(left(TwoViews({5, 0})), (std::array{false, false})); // a gap
  EXPECT_EQ(left(TwoViews({15, 0})), (std::array{false, true})); // 1.1 % of the one, half of that of both
  EXPECT_EQ(left(TwoViews({15, 15})), (std::array{true, true})); // worn
}

/// Skin that is lit from above, but for a spot below that is as bright as the top: divided by the light there it would be white.
TEST(TextureColours, WhatIsTooBrightForItsNormalKeepsItsHue) {
  BeforeScreen scene(kSkin, kBlueScreen);
  for (std::size_t k = 0; k < scene.images.size(); ++k) {
    const Camera &camera = scene.cameras[k];
    const double top = camera.project({0, 1.3, 0}).y(), bottom = camera.project({0, 0.5, 0}).y();
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double light = std::clamp(1 - 0.8 * (y - top) / (bottom - top), 0.2, 1.0), spot = std::abs(x - camera.width / 2);
        if (scene.masks[k].at(x, y, 0) && !(light > 0.33 && light < 0.45 && spot < 12))
          for (int c = 0; c < 3; ++c)
            scene.images[k].at(x, y, c) = static_cast<std::uint8_t>(light * kSkin[c]);
      }
  }
  TextureOptions options;
  options.size = 1024;
  const Vertices colours = face_colours(bake_texture(scene.ball, {}, scene.cameras, scene.images, scene.masks, {}, options));
  EXPECT_EQ(colours.col(2).maxCoeff(), 255);
  for (Eigen::Index f = 0; f < colours.rows(); ++f)
    if (colours(f, 2) > 250) {
      EXPECT_NEAR(colours(f, 1) / colours(f, 2), kSkin[1] / kSkin[2], 0.06) << f;
    }
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
  const Vertices colours = face_colours(bake_texture(believed, {}, {camera}, {image}, {}, {}, options));
  EXPECT_LT(colours.topRows(ball.faces.rows()).col(2).maxCoeff(), 5);
}

TEST(TextureLabels, HandAndSkirtKeepTheirOwnColours) {
  for (double off : {0.01, 0.02}) { // of the latter, one in ten looks at a hand sees the skirt
    const HandBeforeSkirt scene(off);
    const auto [hand, skirt] = scene.worst(scene.baked({}));
    EXPECT_GT(hand, 80);
    EXPECT_GT(skirt, 80);
    const auto [own_hand, own_skirt] = scene.worst(scene.baked(scene.labels()));
    EXPECT_LT(own_hand, 5) << off;
    EXPECT_LT(own_skirt, 5) << off;
  }
}

TEST(TextureLabels, ChangeNothingUnlessBothAreThereWithinReach) {
  HandBeforeSkirt scene(0.01);
  const std::vector<std::uint8_t> without = scene.baked({}).image.data;
  for (SurfaceLabel one : {SurfaceLabel::Body, SurfaceLabel::Garment})
    EXPECT_TRUE(scene.baked(std::vector(scene.labels().size(), one)).image.data == without);
  for (double reach : {0.0, 0.001}) {
    scene.options.label_margin = reach;
    EXPECT_TRUE(scene.labels_change_nothing()) << reach;
  }
}

TEST(TextureLabels, WhatTouchesIsLeftAsItIs) {
  HandBeforeSkirt scene(0.01, 0.15); // within 2 cm of the skirt
  scene.cameras.pop_back();          // which sees all of the skirt edge-on
  scene.images.pop_back();
  EXPECT_GT(scene.worst(scene.baked({})).first, 80);
  EXPECT_TRUE(scene.labels_change_nothing());
}

TEST(TextureLabels, ColoursThatAreUsualOnTheirOwnOrOnNeitherStay) {
  HandBeforeSkirt scene(0);
  scene.paint(scene.believed, [](const Eigen::Vector3d &at) { return std::abs(at.y() - 1) < 0.012 ? kCloth : kSkin; });
  EXPECT_TRUE(scene.labels_change_nothing());
  const Colour ring(200, 40, 30);
  const Eigen::Vector3d finger(-0.03, 1, 0.152);
  scene.paint(scene.believed, [&](const Eigen::Vector3d &at) { return (at - finger).norm() < 0.012 ? ring : kSkin; });
  EXPECT_TRUE(scene.labels_change_nothing());
  scene.paint(scene.believed, [&](const Eigen::Vector3d &at) { return at.x() < -0.04 ? kCloth : kSkin; });
  EXPECT_FALSE(scene.labels_change_nothing()); // as if the skirt were seen there
}

TEST(TextureLabels, SameBitsForAnyNumberOfThreads) {
  const HandBeforeSkirt scene(0.01);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_TRUE(scene.baked(scene.labels(), one).image.data == scene.baked(scene.labels(), two).image.data);
}

TEST(TextureLabels, RefusesLabelsThatDoNotFit) {
  const HandBeforeSkirt scene(0);
  EXPECT_THROW(scene.baked({SurfaceLabel::Body, SurfaceLabel::Garment}), std::invalid_argument);
}
