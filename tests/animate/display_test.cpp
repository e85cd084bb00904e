#include "doublet/animate/baked_file.h"
#include "doublet/animate/motion_file.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/animate/renderer.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "doublet/files/npz.h"
#include "doublet/rays/ray_scene.h"
#include "figure_character.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

using namespace doublet;
using namespace doublet::testing;

namespace {

/// A pattern in space that an image can hold: B G R in [0, 1].
Eigen::Vector3d pattern(const Eigen::Vector3d &p) {
  return {0.5 + 0.5 * std::sin(15 * p.x()), 0.5 + 0.5 * std::sin(15 * p.y() + 1), 0.5 + 0.5 * std::sin(15 * p.z() + 2)};
}

/// The mesh in its pattern, without light, on black.
Image photograph(const Mesh &mesh, const Camera &camera) {
  const FaceBuffer buffer = rasterize(mesh.vertices, mesh.faces, camera);
  Image image(camera.width, camera.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const int f = buffer.face_at(x, y);
      if (f < 0)
        continue;
      const Eigen::Vector3d b = barycentric_at(mesh.vertices, mesh.faces, f, camera, Eigen::Vector2d(x, y));
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        p += b[k] * mesh.vertices.row(mesh.faces(f, k)).transpose();
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(255 * pattern(p)[c] + 0.5);
    }
  return image;
}
std::vector<Image> photographs(const Mesh &mesh, const CameraRig &cameras) {
  std::vector<Image> images;
  for (const Camera &camera : cameras)
    images.push_back(photograph(mesh, camera));
  return images;
}

Eigen::Vector3d centre_of(const Mesh &mesh, Eigen::Index face) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    centre += mesh.vertices.row(mesh.faces(face, k)).transpose() / 3;
  return centre;
}

std::vector<RenderMesh> grey_sphere() {
  const Mesh ball = sphere(0.5, {0, 1, 0});
  RenderMesh mesh;
  mesh.vertices = ball.vertices;
  mesh.faces = ball.faces;
  return {mesh};
}

/// The JSON chunk of a GLB.
std::string glb_json(const std::filesystem::path &path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return bytes.substr(20, length);
}

std::size_t count(const std::string &text, const std::string &word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++n;
  return n;
}

} // namespace

TEST(Renderer, SphereIsWhereTheCameraSeesItAndLitFromAbove) {
  RenderOptions options;
  options.floor = false;
  const Camera camera = look_at({0, 1, 3}, {0, 1, 0}, 300, 160, 120);
  const Image image = render(grey_sphere(), camera, options);
  EXPECT_EQ(image.at(2, 2, 0), static_cast<int>(options.background.z() * 255 + 0.5));
  EXPECT_GT(image.at(80, 20, 1), image.at(80, 100, 1) + 20); // top against bottom
  EXPECT_GT(image.at(105, 60, 1), image.at(55, 60, 1) + 10); // the light comes from +X
  int covered = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x)
      covered += image.at(x, y, 0) != image.at(0, 0, 0);
  const double radius = 300 * 0.5 / std::sqrt(9 - 0.25); // of the silhouette, pixels
  EXPECT_NEAR(covered, pi * radius * radius, 0.03 * pi * radius * radius);
}

TEST(Renderer, FloorIsDarkerUnderTheBody) {
  RenderOptions options;
  const Camera camera = look_at({0, 3, 4}, {0, 0, 0}, 200, 160, 120);
  const auto brightness = [](const Image &image, int x, int y) {
    return image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2);
  };
  std::vector<RenderMesh> low = grey_sphere();
  low[0].vertices.col(1).array() -= 0.5;
  low[0].vertices.col(2).array() -= 0.7;
  const Eigen::Vector2d contact = camera.project({0.05, 0, -0.35});
  const int x = static_cast<int>(contact.x()), y = static_cast<int>(contact.y());
  std::vector<RenderMesh> hidden = low; // the same body, not drawn: its shadow alone
  hidden[0].face_valid.assign(hidden[0].faces.rows(), 0);
  EXPECT_LT(brightness(render(hidden, camera, options), x, y), brightness(render({}, camera, options), x, y) - 20);
}

TEST(Renderer, NearerMeshWinsAndColoursInterpolate) {
  RenderOptions options;
  options.floor = false;
  std::vector<RenderMesh> meshes = grey_sphere();
  meshes.push_back(meshes[0]);
  meshes[0].colour = {1, 0, 0};
  meshes[1].colours = Vertices::Zero(meshes[1].vertices.rows(), 3);
  meshes[1].colours.col(2).setOnes();
  meshes[1].vertices.col(2).array() += 1;
  const Image image = render(meshes, look_at({0, 1, 4}, {0, 1, 0}, 200, 80, 80), options);
  EXPECT_GT(image.at(40, 40, 0), 100); // blue, in front
  EXPECT_EQ(image.at(40, 40, 2), 0);
}

TEST(Renderer, RefusesWhatDoesNotFit) {
  const Camera camera = look_at({0, 1, 3}, {0, 1, 0}, 100, 32, 32);
  std::vector<RenderMesh> meshes = grey_sphere();
  meshes[0].faces(0, 0) = 100000;
  EXPECT_THROW(render(meshes, camera), std::invalid_argument);
  meshes = grey_sphere();
  meshes[0].vertices(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(render(meshes, camera), std::invalid_argument);
  meshes = grey_sphere();
  meshes[0].face_valid = {1};
  EXPECT_THROW(render(meshes, camera), std::invalid_argument);
  meshes = grey_sphere();
  meshes[0].texture = std::make_shared<const Image>(4, 4, 3);
  EXPECT_THROW(render(meshes, camera), std::invalid_argument);
  EXPECT_THROW(orbit_camera({0, 0, 0}, -1, 0, 0, 10, 10), std::invalid_argument);
  EXPECT_NO_THROW(render({}, camera));
}

TEST(Renderer, OrbitCameraHoldsTheSphere) {
  const Camera camera = orbit_camera({1, 2, 3}, 0.5, 0.7, 0.3, 200, 100);
  EXPECT_TRUE(camera.project({1, 2, 3}).isApprox(Eigen::Vector2d(99.5, 49.5), 1e-9));
  EXPECT_GT(camera.project({1, 2.45, 3}).y(), 0);
  EXPECT_LT(camera.project({1, 2.45, 3}).y(), 10);
  EXPECT_GT(camera.centre().x(), 1);
}

TEST(TextureBaker, AtlasShowsWhatTheCamerasSaw) {
  const Mesh mesh = figure_surface(0.05);
  const CameraRig cameras = camera_ring(8, 480);
  const std::vector<Image> images = photographs(mesh, cameras);
  TextureOptions options;
  options.size = 1024;
  options.albedo = false; // the pattern has no light
  const BakedTexture baked = bake_texture(mesh, {}, cameras, images, {}, {}, options);
  ASSERT_EQ(baked.texcoords.rows(), 3 * mesh.faces.rows());
  EXPECT_GT(baked.texcoords.minCoeff(), 0);
  EXPECT_LT(baked.texcoords.maxCoeff(), 1);
  EXPECT_GT(baked.seen_fraction, 0.7);
  // The colour in the middle of every triangle, seen or filled, against the pattern there.
  std::vector<double> error;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d centre = centre_of(mesh, f);
    const Eigen::RowVector2d uv = baked.texcoords.middleRows(3 * f, 3).colwise().mean();
    const int x = static_cast<int>(uv.x() * options.size), y = static_cast<int>(uv.y() * options.size);
    double worst = 0;
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(baked.image.at(x, y, c) / 255.0 - pattern(centre)[c]));
    error.push_back(worst);
  }
  std::sort(error.begin(), error.end());
  EXPECT_LT(error[error.size() / 2], 0.04);
  EXPECT_LT(error[error.size() * 7 / 10], 0.10);
}

TEST(TextureBaker, SampledColoursAreThoseOfTheirFaces) {
  const Mesh mesh = figure_surface(0.05);
  const CameraRig cameras = camera_ring(8, 480);
  const std::vector<Image> images = photographs(mesh, cameras);
  std::vector<std::uint8_t> valid(mesh.faces.rows(), 1);
  valid[7] = 0;
  const Vertices colours = sample_colours(mesh, valid, cameras, images);
  const Eigen::Index each = colours.rows() / mesh.faces.rows();
  ASSERT_EQ(colours.rows(), 10 * mesh.faces.rows());
  EXPECT_TRUE(colours.middleRows(7 * each, each).array().isNaN().all());
  std::vector<double> error;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if (const auto of_face = colours.middleRows(f * each, each); of_face.allFinite()) {
      error.push_back((of_face.colwise().mean().transpose() / 255 - pattern(centre_of(mesh, f))).cwiseAbs().maxCoeff());
    }
  EXPECT_GT(error.size(), 0.6 * static_cast<double>(mesh.faces.rows()));
  std::sort(error.begin(), error.end());
  EXPECT_LT(error[error.size() / 2], 0.04);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const auto bits = [&](const Context &context) {
    Vertices sampled = sample_colours(mesh, valid, cameras, images, {}, {}, context);
    return sampled.unaryExpr([](double value) { return std::isnan(value) ? -1.0 : value; }).eval();
  };
  EXPECT_EQ(bits(one), bits(two));
  EXPECT_TRUE(sample_colours(mesh, {}, cameras, std::vector<Image>(8)).array().isNaN().all()); // no image at all
  EXPECT_THROW(sample_colours(mesh, {}, cameras, {images[0]}), std::invalid_argument);
}

TEST(TextureBaker, BackdropOutsideTheMaskDoesNotCount) {
  const Mesh mesh = sphere(0.5, {0, 0.9, 0});
  const CameraRig cameras = camera_ring(2, 200); // front and back: the sides are only seen at the rim
  Mesh larger = mesh;                            // the surface is believed to be larger than it was: its rim sees the backdrop
  larger.vertices.col(0) *= 1.15;
  larger.vertices.col(2) *= 1.15;
  std::vector<Image> images, masks;
  for (const Camera &camera : cameras) {
    masks.push_back(silhouette(rasterize(mesh.vertices, mesh.faces, camera)));
    Image image(camera.width, camera.height, 3);
    for (std::size_t i = 0; i < masks.back().data.size(); ++i)
      image.data[3 * i + (masks.back().data[i] ? 2 : 1)] = 255; // red ball, green backdrop
    images.push_back(image);
  }
  const auto greenest = [&](const BakedTexture &baked) {
    int most = 0;
    for (Eigen::Index i = 0; i < baked.texcoords.rows(); ++i) {
      const int x = static_cast<int>(baked.texcoords(i, 0) * 512), y = static_cast<int>(baked.texcoords(i, 1) * 512);
      most = std::max<int>(most, baked.image.at(x, y, 1));
    }
    return most;
  };
  TextureOptions options;
  options.size = 512;
  options.grazing = 0.01;
  EXPECT_GT(greenest(bake_texture(larger, {}, cameras, images, {}, {}, options)), 100);
  EXPECT_LT(greenest(bake_texture(larger, {}, cameras, images, masks, {}, options)), 5);
}

TEST(TextureBaker, WhatIsJustBehindAnEdgeDoesNotCount) {
  const Mesh wall = tube(
                 {0, 0, 0}, {0, 2, 0}, [](double) { return 0.3; }, 120, 160),
             ball = sphere(0.12, {0, 1, 0.6});
  const Mesh truth = join({wall, sphere(0.13, {0, 1, 0.6})}), believed = join({wall, ball}); // the ball was larger
  const Camera camera = look_at({0, 1, 3}, {0, 1, 0}, 1200, 800, 800);
  const FaceBuffer seen = rasterize(truth.vertices, truth.faces, camera);
  Image image(800, 800, 3);
  for (int y = 0; y < 800; ++y)
    for (int x = 0; x < 800; ++x)
      if (seen.face_at(x, y) >= wall.faces.rows())
        image.at(x, y, 2) = 255; // a red ball before a black wall
  const auto reddest = [&](double edge_margin) {
    TextureOptions options;
    options.size = 2048;
    options.edge_margin = edge_margin;
    const BakedTexture baked = bake_texture(believed, {}, {camera}, {image}, {}, {}, options);
    int most = 0;
    for (Eigen::Index i = 0; i < 3 * wall.faces.rows(); ++i)
      most = std::max<int>(most, baked.image.at(static_cast<int>(baked.texcoords(i, 0) * 2048),
                                                static_cast<int>(baked.texcoords(i, 1) * 2048), 2));
    return most;
  };
  EXPECT_GT(reddest(0), 200);
  EXPECT_LT(reddest(0.02), 20);
}

TEST(TextureBaker, HandsOfACharacterDoNotTakeItsSkirtsColour) {
  Character c = figure_character();
  const auto on_hand = [&](Eigen::Index v) { return std::abs(c.high.vertices(v, 0)) > 0.48; };
  Vertices there = c.high.vertices; // the hands were held 3 cm higher
  for (Eigen::Index v = 0; v < there.rows(); ++v)
    there(v, 1) += on_hand(v) ? 0.03 : 0;
  const Eigen::Index skin_faces = figure_surface(0.025).faces.rows();
  const CameraRig cameras = camera_ring(8, 480);
  std::vector<Image> images, masks;
  for (const Camera &camera : cameras) {
    const FaceBuffer seen = rasterize(there, c.high.faces, camera, c.high_valid);
    masks.push_back(silhouette(seen));
    images.emplace_back(camera.width, camera.height, 3, 200);
    for (std::size_t i = 0; i < seen.face.size(); ++i)
      if (seen.face[i] >= skin_faces)
        images.back().data[3 * i] = images.back().data[3 * i + 1] = 20; // a red skirt, white skin
  }
  const auto red_faces = [&](double label_margin) {
    TextureOptions options;
    options.albedo = false;
    options.label_margin = label_margin;
    texture_character(c, c.actor.mesh.vertices, cameras, images, masks, options);
    const Image texture = decode_image(c.texture);
    int red = 0;
    for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f) {
      const Eigen::RowVector2d at = c.texcoords.middleRows(3 * f, 3).colwise().mean() * texture.width;
      red += on_hand(c.high.faces(f, 0)) && texture.at(static_cast<int>(at.x()), static_cast<int>(at.y()), 1) < 150;
    }
    return red;
  };
  EXPECT_GT(red_faces(0), 30);
  EXPECT_EQ(red_faces(0.05), 0);
}

TEST(TextureBaker, SameBitsForAnyNumberOfThreads) {
  const Mesh mesh = figure_surface(0.06);
  const CameraRig cameras = camera_ring(4, 200);
  const std::vector<Image> images = photographs(mesh, cameras);
  TextureOptions options;
  options.size = 512;
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_TRUE(bake_texture(mesh, {}, cameras, images, {}, {}, options, one).image.data ==
              bake_texture(mesh, {}, cameras, images, {}, {}, options, two).image.data);
}

TEST(TextureBaker, RefusesWhatDoesNotFit) {
  const Mesh mesh = sphere(0.5);
  const CameraRig cameras = camera_ring(2, 64);
  const std::vector<Image> images(2, Image(64, 64, 3));
  TextureOptions options;
  options.size = 64;
  Mesh loose = mesh; // a chart a triangle
  for (Eigen::Index i = 0; i < loose.faces.size(); ++i)
    loose.faces.data()[i] = static_cast<int>(i);
  loose.vertices = Vertices::Random(loose.faces.size(), 3);
  EXPECT_THROW(bake_texture(loose, {}, cameras, images, {}, {}, options), std::invalid_argument); // no room
  options.size = 512;
  EXPECT_NO_THROW(bake_texture(mesh, {}, cameras, images, {}, {}, options));
  EXPECT_NO_THROW(bake_texture(mesh, {}, cameras, std::vector<Image>(2), {}, {}, options)); // no image at all: grey
  EXPECT_THROW(bake_texture(mesh, {}, cameras, {images[0]}, {}, {}, options), std::invalid_argument);
  EXPECT_THROW(bake_texture(mesh, {}, cameras, {images[0], Image(32, 64, 3)}, {}, {}, options), std::invalid_argument);
  EXPECT_THROW(bake_texture(mesh, {}, cameras, images, {Image(64, 64, 1)}, {}, options), std::invalid_argument);
  EXPECT_THROW(bake_texture(Mesh{}, {}, cameras, images, {}, {}, options), Error);
  Character bare;
  EXPECT_THROW(texture_character(bare, {}, cameras, images), Error);
}

TEST(BakedFile, ABroadcastRateComesBack) {
  const TempFolder folder;
  Character c = figure_character();
  for (const double rate : {24.0, 30.0, 60.0}) {
    c.solver.dt = 1.001 / rate;
    write_baked_glb(folder / "a.glb", c, animate(c, {1 / c.solver.dt, marching(c.actor.skeleton, 9, rate)}));
    const SourceMotion clip = read_motion_file(folder / "a.glb");
    EXPECT_NEAR(clip.fps, rate / 1.001, 1e-9) << rate;
    EXPECT_EQ(clip.frame_count(), 9) << rate;
  }
}

TEST(BakedFile, AnAnimationIsNamedAfterItsFile) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 3, 40)});
  for (const auto &[file, name] : {std::pair{"slow waltz.glb", "slow waltz"}, {"caf\xc3\xa9.glb", "caf\xc3\xa9"}}) {
    write_baked_glb(folder / file, c, animation);
    EXPECT_EQ(read_motion_file(folder / file).animations, std::vector<std::string>{name});
  }
  EXPECT_NO_THROW(write_baked_glb(folder / "caf\xe9.glb", c, animation)); // Latin-1
}

TEST(BakedFile, NpzHoldsTheAnimation) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 9, 40)});
  write_baked_npz(folder / "a.npz", c, animation);
  const Npz npz = Npz::read(folder / "a.npz");
  npz.require_shape("vertices", {9, c.actor.mesh.vertices.rows(), 3});
  npz.require_shape("faces", {c.actor.mesh.faces.rows(), 3});
  npz.require_shape("joints", {9, c.actor.skeleton.joint_count(), 3});
  EXPECT_EQ(npz.values("fps"), std::vector<double>{40});
  EXPECT_FLOAT_EQ(static_cast<float>(npz.values("vertices")[5]), static_cast<float>(animation.surface[0](1, 2)));
  EXPECT_EQ(npz.text("joint_names")[0], "pelvis");
}

TEST(BakedFile, AnAnimationOfAnotherCharacterIsRefused) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 9, 40)});
  ASSERT_FALSE(animation.body.empty());
  for (const auto frames : {&AnimationResult::surface, &AnimationResult::body, &AnimationResult::joints}) {
    AnimationResult wrong = animation;
    for (Vertices &frame : wrong.*frames)
      frame.conservativeResize(5, 3);
    EXPECT_THROW(write_baked_npz(folder / "a.npz", c, wrong), std::invalid_argument);
    EXPECT_THROW(write_baked_glb(folder / "a.glb", c, wrong), std::invalid_argument);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(BakedFile, GlbHasOneShapeAKey) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 41, 40)});
  BakedGlbOptions few;
  few.max_error = 0;
  few.keys_per_second = 10; // of 40 frames a second: 0, 4, ..., 40
  EXPECT_EQ(write_baked_glb(folder / "a.glb", c, animation, few).keys, 11);
  const std::string json = glb_json(folder / "a.glb");
  EXPECT_EQ(count(json, "\"JOINTS_0\""), 2u); // surface and body follow the bones between the keys, too
  EXPECT_EQ(count(json, "\"path\":\"weights\""), 2u);
  EXPECT_EQ(count(json, "\"doubleSided\":true"), 1u); // the inner side of cloth
  EXPECT_EQ(count(json, "\"path\":\"translation\""), 1u);
  EXPECT_EQ(count(json, "\"NORMAL\""), 24u); // two meshes and eleven targets each
  few.max_keys = 5;
  write_baked_glb(folder / "b.glb", c, animation, few);
  EXPECT_LE(count(glb_json(folder / "b.glb"), "\"NORMAL\""), 14u);
  EXPECT_LT(std::filesystem::file_size(folder / "b.glb"), std::filesystem::file_size(folder / "a.glb"));
  few = {};
  few.max_error = 0;
  const BakedGlbSummary every = write_baked_glb(folder / "every.glb", c, animation, few);
  ASSERT_EQ(every.meshes.size(), 2u);
  EXPECT_EQ(every.meshes[1].shapes, 41);
  EXPECT_LT(every.meshes[0].max_error, 1e-4);
  EXPECT_EQ(count(glb_json(folder / "every.glb"), "\"NORMAL\""), 84u);
  few.keys_per_second = -1;
  EXPECT_THROW(write_baked_glb(folder / "c.glb", c, animation, few), std::invalid_argument);
  EXPECT_THROW(write_baked_glb(folder / "c.glb", c, AnimationResult{}), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.glb"));
}

TEST(BakedFile, PrincipalShapesKeepTheError) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 41, 40)});
  BakedGlbOptions options;
  int last = 41;
  for (const double error : {3e-4, 1e-3, 5e-3}) {
    options.max_error = error;
    const BakedGlbSummary summary = write_baked_glb(folder / "a.glb", c, animation, options);
    EXPECT_EQ(summary.keys, 41);
    ASSERT_EQ(summary.meshes.size(), 2u);
    for (const BakedMeshSummary &mesh : summary.meshes) {
      EXPECT_LT(mesh.rms_error, error) << mesh.name;
      EXPECT_LE(mesh.error_95, mesh.max_error);
    }
    EXPECT_GT(summary.meshes[0].rms_error, 0.5 * error); // no more shapes than it takes
    EXPECT_LT(summary.meshes[0].shapes, last);
    last = summary.meshes[0].shapes;
  }
  options.max_keys = 2;
  const BakedGlbSummary few = write_baked_glb(folder / "few.glb", c, animation, options);
  EXPECT_EQ(few.meshes[0].shapes, 2);
  EXPECT_GT(few.meshes[0].rms_error, 5e-3); // and the summary says so
  EXPECT_EQ(count(glb_json(folder / "few.glb"), "\"rms_error\""), 2u);
}

TEST(SlowBakedFile, ALongClipKeepsTheError) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult played = animate(c, {40, marching(c.actor.skeleton, 41, 40)});
  for (const int frames : {2400, 4800}) { // from the shapes of all keys, and from those of some
    AnimationResult clip;
    clip.fps = played.fps;
    clip.dofs.resize(frames, played.dofs.cols());
    for (int t = 0; t < frames; ++t) {
      clip.dofs.row(t) = played.dofs.row(t % 41);
      clip.joints.push_back(played.joints[t % 41]);
      clip.surface.push_back(played.surface[t % 41]);
      clip.surface.back().col(1) += 0.01 * std::sin(0.02 * t) * played.surface[0].col(0); // no two alike
    }
    const BakedGlbSummary summary = write_baked_glb(folder / "long.glb", c, clip);
    EXPECT_EQ(summary.keys, frames);
    EXPECT_LT(summary.meshes[0].rms_error, 1e-3);
  }
}

TEST(BakedFile, OneFrameHasNoShapes) {
  const TempFolder folder;
  const Character c = figure_character();
  const AnimationResult animation = animate(c, {40, marching(c.actor.skeleton, 1, 40)});
  AnimationResult one = animation;
  one.dofs = animation.dofs.topRows(1);
  for (std::vector<Vertices> *frames : {&one.surface, &one.joints, &one.high, &one.body})
    if (!frames->empty())
      frames->resize(1);
  const BakedGlbSummary summary = write_baked_glb(folder / "one.glb", c, one);
  EXPECT_EQ(summary.keys, 1);
  for (const BakedMeshSummary &mesh : summary.meshes) {
    EXPECT_EQ(mesh.shapes, 0);
    EXPECT_LT(mesh.max_error, 1e-5);
  }
  EXPECT_EQ(count(glb_json(folder / "one.glb"), "\"weights\""), 0u);
}

TEST(Animator, DrawnBodyStaysUnderTheCloth) {
  const Character c = figure_character();
  Vertices surface = c.actor.mesh.vertices, body = c.body.vertices;
  for (Eigen::Index v = 0; v < body.rows(); ++v) // thighs 3 cm too thick at the height where the skirt is narrow
    if (body(v, 1) > 0.85 && body(v, 1) < 0.95) {
      body(v, 0) *= 1.35;
      body(v, 2) *= 1.35;
    }
  const RayScene scene({surface, c.actor.mesh.faces}, c.actor.face_valid);
  const Vertices normals = face_normals(surface, c.actor.mesh.faces);
  const auto outside = [&](const Vertices &positions) {
    int n = 0;
    for (Eigen::Index f = 0; f < c.body.faces.rows(); ++f)
      for (int k = 0; k < 3 && c.body_shown[f]; ++k) {
        const Eigen::Vector3d p = positions.row(c.body.faces(f, k));
        const ClosestPoint at = scene.closest(p);
        n += c.segmentation.clothness[c.actor.mesh.faces(at.face, 0)] > 0 && (p - at.point).dot(normals.row(at.face)) > 1e-4;
      }
    return n;
  };
  EXPECT_GT(outside(body), 10);
  EXPECT_EQ(outside(resolve_body_penetration(c, surface, body)), 0);
}
