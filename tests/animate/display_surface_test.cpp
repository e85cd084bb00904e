#include "../../libanimate/src/display/hidden_skin.h"

#include "doublet/animate/character_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/garment_penetration.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/animate/parts/skin_penetration.h"
#include "doublet/animate/player.h"
#include "doublet/animate/renderer.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "doublet/files/files.h"
#include "doublet/rays/ray_scene.h"
#include "doublet/rays/surface_distance.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace doublet;
using namespace doublet::testing;

namespace {

constexpr double kRadius = 0.2, kHem = 0.5, kSeam = 0.985, kTop = 1.5;

/// A tube about the Y axis, dented by a fold of this depth (m) at angle 0.
Mesh folded_tube(double bottom, double top, int rings, int segments, double fold = 0) {
  Mesh mesh = tube(
      {0, bottom, 0}, {0, top, 0}, [](double) { return kRadius; }, rings, segments);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double angle = std::atan2(mesh.vertices(v, 2), mesh.vertices(v, 0));
    const double factor = 1 - fold / kRadius * std::exp(-angle * angle / 0.04);
    mesh.vertices(v, 0) *= factor;
    mesh.vertices(v, 2) *= factor;
  }
  return mesh;
}

struct Wearer {
  RiggedMesh actor;
  Segmentation segmentation;
  Mesh high;
};

Mesh leg(double x = 0, double radius = 0.1) {
  return tube(
      {x, 0.1, 0}, {x, kHem - 0.02, 0}, [&](double) { return radius; }, 20, 24);
}

/// A trunk whose lower half is a garment with a mesh of its own; the faces at the seam stay under it. The scan bridges the fold.
Wearer wearer(double fold = 0, const Mesh &legs = {}) {
  const Mesh upper = folded_tube(kHem, kTop, 30, 48), trunk = legs.faces.rows() > 0 ? join({upper, legs}) : upper,
             garment = folded_tube(kHem, kSeam, 14, 36, fold);
  Wearer result;
  RiggedMesh &actor = result.actor;
  actor.mesh = join({trunk, garment});
  actor.skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, {}}});
  actor.weights = MatrixRM::Ones(actor.mesh.vertices.rows(), 1);
  const Eigen::Index n = actor.mesh.vertices.rows(), bare = trunk.vertices.rows();
  for (Eigen::Index f = 0; f < actor.mesh.faces.rows(); ++f) {
    double top = 0;
    for (int k = 0; k < 3; ++k)
      top = std::max(top, actor.mesh.vertices(actor.mesh.faces(f, k), 1));
    actor.face_valid.push_back(f >= upper.faces.rows() || top > kSeam + 0.02);
  }
  Segmentation &cloth = result.segmentation;
  cloth.region_count = 1;
  cloth.sigma = cloth.clothness = Eigen::VectorXd::Zero(n);
  cloth.region = Eigen::VectorXi::Constant(n, -1);
  cloth.region.tail(n - bare).setZero();
  for (Eigen::Index v = bare; v < n; ++v)
    cloth.clothness[v] = actor.mesh.vertices(v, 1) < kSeam - 1e-6;
  cloth.rest = actor.mesh.vertices;
  result.high = folded_tube(kHem, kTop, 59, 101); // its triangles and M's have nothing in common
  if (legs.faces.rows() > 0)
    result.high = join({result.high, legs});
  return result;
}

Character character_of(const Wearer &w) {
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  return make_character(w.actor, w.segmentation, {}, {}, {pbd::Material{}}, {}, display.mesh, display.valid,
                        display.garment_subdivisions);
}

/// The faces [first, end) alone, with the vertices at `vertices`.
Mesh part_of(const Vertices &vertices, const Faces &faces, Eigen::Index first, Eigen::Index end) {
  return {vertices, faces.middleRows(first, end - first)};
}

/// (faces of the skin, faces of all) of a display mesh
std::pair<Eigen::Index, Eigen::Index> split(const Wearer &w, const DisplayMesh &display) {
  const Eigen::Index garment = 14 * 36 * 2, all = display.mesh.faces.rows();
  EXPECT_GE(w.actor.mesh.faces.rows(), garment);
  return {all - garment * (1 << (2 * display.garment_subdivisions)), all};
}

std::vector<int> range(Eigen::Index first, Eigen::Index end) {
  std::vector<int> numbers(end - first);
  std::iota(numbers.begin(), numbers.end(), static_cast<int>(first));
  return numbers;
}

/// The garment with its hem 4 cm lower, and 2 cm inside the leg.
Vertices narrowed(const Character &c) {
  Vertices narrow = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < narrow.rows(); ++v)
    if (c.segmentation.clothness[v] > 0) {
      narrow(v, 1) -= 0.04 * (kSeam - narrow(v, 1)) / (kSeam - kHem);
      const double low = std::min(1.0, (kSeam - narrow(v, 1)) / 0.3);
      narrow(v, 0) *= 1 - 0.6 * low;
      narrow(v, 2) *= 1 - 0.6 * low;
    }
  return narrow;
}

} // namespace

TEST(DisplaySurface, OfAGarmentAloneThereIsNoSkin) {
  Wearer w = wearer();
  w.segmentation.region.setZero();
  w.segmentation.clothness.setOnes();
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  EXPECT_GT(std::count(display.valid.begin(), display.valid.end(), 1), 0);
}

TEST(DisplaySurface, HemIsOneSmoothCurve) {
  const Wearer w = wearer();
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  ASSERT_EQ(display.garment_subdivisions, 1); // edges of 35 mm and 13 mm
  EXPECT_TRUE(std::all_of(display.valid.begin(), display.valid.end(), [](int v) { return v == 1; }));
  const EdgeTopology topology = edge_topology(display.mesh.faces);
  int edges = 0;
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const Eigen::RowVector3d p = display.mesh.vertices.row(topology.edges[e][0]);
    if (topology.edge_faces[e][1] >= 0 || p.y() > 0.7)
      continue;
    ++edges;
    EXPECT_NEAR(p.y(), kHem, 1e-9);
    EXPECT_NEAR(std::hypot(p.x(), p.z()), kRadius, 0.001);
  }
  EXPECT_EQ(edges, 2 * 36);
}

TEST(DisplaySurface, WhatTheMaskLeftOfTheSheetIsNotDrawn) {
  Wearer w = wearer();
  const auto sheet = [](int rings, int segments) { // looks down; its outer half was invented
    Mesh mesh = tube(
        {0, 0, 0}, {0, 1, 0}, [](double s) { return 0.08 + 0.12 * s; }, rings, segments);
    mesh.vertices.col(1).setConstant(kHem);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
      if (face_normals(mesh.vertices, mesh.faces.row(f))(0, 1) > 0)
        std::swap(mesh.faces(f, 1), mesh.faces(f, 2));
    return mesh;
  };
  const auto leg = [](int rings, int segments) {
    return tube(
        {0, 0, 0}, {0, kHem, 0}, [](double) { return 0.08; }, rings, segments);
  };
  const Mesh more = join({sheet(8, 40), leg(16, 20)});
  const Eigen::Index before = w.actor.mesh.vertices.rows(), count = more.vertices.rows();
  w.actor.mesh = join({w.actor.mesh, more});
  for (Eigen::Index f = 0; f < more.faces.rows(); ++f)
    w.actor.face_valid.push_back(f >= 8 * 40 * 2 || more.vertices.row(more.faces(f, 0)).norm() < std::hypot(0.14, kHem));
  w.actor.weights = MatrixRM::Ones(before + count, 1);
  const auto longer = [&](auto &values, auto value) {
    values.conservativeResize(before + count);
    values.tail(count).setConstant(value);
  };
  longer(w.segmentation.sigma, 0.0);
  longer(w.segmentation.clothness, 0.0);
  longer(w.segmentation.region, -1);
  w.segmentation.rest = w.actor.mesh.vertices;
  w.high = join({w.high, sheet(14, 60), leg(30, 40)});
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  const Vertices normals = face_normals(display.mesh.vertices, display.mesh.faces);
  int legs = 0;
  for (Eigen::Index f = 0; f < normals.rows(); ++f) {
    EXPECT_GT(normals(f, 1), -0.9);
    legs += display.mesh.vertices(display.mesh.faces(f, 0), 1) < kHem - 0.001;
  }
  EXPECT_EQ(legs, 30 * 40 * 2);

  const Mesh body = join({sheet(14, 60), leg(30, 40)}); // such as a shoulder beside an armhole
  const DisplayMesh of_the_body = build_display_mesh(w.actor, w.segmentation, w.high, body);
  EXPECT_GT((face_normals(of_the_body.mesh.vertices, of_the_body.mesh.faces).col(1).array() < -0.9).count(), 500);
}

TEST(DisplaySurface, BridgedFoldIsNotFollowed) {
  const Wearer w = wearer(0.08);
  const Character c = character_of(w);
  const auto [skin, all] = split(w, build_display_mesh(w.actor, w.segmentation, w.high));
  const Mesh garment = part_of(w.actor.mesh.vertices, w.actor.mesh.faces, 30 * 48 * 2, w.actor.mesh.faces.rows());
  const Mesh cloth = submesh(c.high, range(skin, all));
  EXPECT_LT(distances_to_surface(cloth.vertices, garment).maxCoeff(), 0.012); // the scan is 80 mm away in the fold
  // The fold opens: what is drawn opens with it.
  Vertices opened = w.actor.mesh.vertices;
  const Mesh open = folded_tube(kHem, kSeam, 14, 36);
  opened.bottomRows(open.vertices.rows()) = open.vertices;
  const Vertices high = DisplaySurface(c).apply(opened);
  const double longest = mean_edge_length(open.vertices, open.faces);
  for (Eigen::Index f = skin; f < all; ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((high.row(c.high.faces(f, k)) - high.row(c.high.faces(f, (k + 1) % 3))).norm(), longest);
}

TEST(DisplaySurface, SkinGoesOnUnderTheSeam) {
  const Wearer w = wearer();
  const Character c = character_of(w);
  const auto [skin, all] = split(w, build_display_mesh(w.actor, w.segmentation, w.high));
  double lowest = kTop;
  for (Eigen::Index f = 0; f < skin; ++f)
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d p = c.high.vertices.row(c.high.faces(f, k));
      const double radius = std::hypot(p.x(), p.z());
      lowest = std::min(lowest, p.y());
      if (p.y() > kSeam) {
        EXPECT_NEAR(radius, kRadius, 1e-9);
      } else {
        EXPECT_LT(radius, kRadius - 0.0005);
      }
    }
  EXPECT_LT(lowest, kSeam - 0.005);
  EXPECT_GT(lowest, kSeam - 0.06);
  // In motion it is brought there; above, it does not care what the cloth does.
  Vertices swung = w.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < swung.rows(); ++v)
    if (w.segmentation.clothness[v] > 0)
      swung(v, 0) += 0.02;
  const DisplaySurface surface(c);
  const Vertices before = surface.apply(w.actor.mesh.vertices);
  DisplayBuffers buffers;
  Vertices after, none;
  surface.apply(swung, after, buffers);
  SkinPenetrationFix(c).apply(buffers, after, none);
  const Mesh swung_cloth = submesh({after, c.high.faces}, range(skin, all));
  const RayScene scene(swung_cloth);
  const Vertices normals = face_normals(swung_cloth.vertices, swung_cloth.faces);
  const auto above = [&](const Eigen::Vector3d &p) { // m over the cloth
    const ClosestPoint at = scene.closest(p);
    return (p - at.point).dot(normals.row(at.face));
  };
  double moved = 0;
  for (Eigen::Index f = 0; f < all; ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = c.high.faces(f, k);
      if (f < skin && before(v, 1) > kSeam) {
        EXPECT_EQ(after.row(v), before.row(v));
      } else if (f < skin) {
        EXPECT_LT(above(after.row(v)), 0);
      } else {
        moved = std::max(moved, after(v, 0) - before(v, 0));
      }
    }
  EXPECT_NEAR(moved, 0.02, 1e-3);
}

TEST(DisplaySurface, ExactInTheScanPoseAndUnderRigidMotion) {
  const Character c = character_of(wearer(0.05));
  const DisplaySurface surface(c);
  EXPECT_LT((surface.apply(c.actor.mesh.vertices) - c.high.vertices).cwiseAbs().maxCoeff(), 1e-6);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::RowVector3d shift(0.3, -1, 2);
  const auto moved = [&](const Vertices &v) { return Vertices((v * turn.transpose()).rowwise() + shift); };
  EXPECT_LT((surface.apply(moved(c.actor.mesh.vertices)) - moved(c.high.vertices)).cwiseAbs().maxCoeff(), 1e-6);
  const MatrixRM weights = surface.sample(c.actor.weights);
  EXPECT_EQ(weights.rows(), c.high.vertices.rows());
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-6);
}

namespace {

const Eigen::Vector3d kLeg(60, 90, 180); // B G R

/// A dark garment and trunk, down to its hem, and legs, of which the uppermost `shadow` m are darker.
struct Photographs {
  CameraRig cameras;
  std::vector<Image> images;
  explicit Photographs(double shadow, double at_hem = kHem) {
    for (int k = 0; k < 4; ++k) {
      cameras.push_back(orbit_camera({0, 0.7, 0}, 1.0, k * 1.57, 0, 300, 300));
      Image image(300, 300, 3, 30);
      const double hem = cameras.back().project({0, at_hem, 0}).y(), lit = cameras.back().project({0, at_hem - shadow, 0}).y();
      for (int y = static_cast<int>(hem); y < 300; ++y)
        for (int x = 0; x < 300; ++x)
          for (int c = 0; c < 3; ++c)
            image.at(x, y, c) = static_cast<std::uint8_t>((y < lit ? 0.6 : 1.0) * kLeg[c]);
      images.push_back(image);
    }
  }
};

/// Mean red of the legs' texels between two depths (m) below the hem.
double red_of_legs(Character &c, const Photographs &seen, const TextureOptions &options, double from, double to) {
  texture_character(c, c.actor.mesh.vertices, seen.cameras, seen.images, {}, options);
  const Image texture = decode_image(c.texture);
  double sum = 0, count = 0;
  for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f) {
    const double below = kHem - c.high.vertices(c.high.faces.row(f).transpose(), 1).mean();
    if (!c.high_valid[f] || below < from || below > to)
      continue;
    const Eigen::RowVector2d uv = c.texcoords.middleRows(3 * f, 3).colwise().mean() * texture.width;
    sum += texture.at(static_cast<int>(uv.x()), static_cast<int>(uv.y()), 2);
    ++count;
  }
  return sum / count;
}

} // namespace

TEST(DisplaySurface, LegsDoNotTakeTheColourOfAHemThatHungLower) {
  const Photographs seen(0, kHem - 0.06);
  Character c = character_of(wearer(0, leg()));
  TextureOptions options;
  options.albedo = false;
  EXPECT_GT(red_of_legs(c, seen, options, 0.03, 0.05), 0.8 * kLeg[2]);
  options.label_margin = 0;
  EXPECT_LT(red_of_legs(c, seen, options, 0.03, 0.05), 0.7 * kLeg[2]);
}

TEST(DisplaySurface, HiddenBodyTakesTheColourOfTheSkinBelowTheHem) {
  Character c = character_of(wearer(0, leg()));
  const Eigen::Vector3d before = c.body_colour;
  const Eigen::Vector3d leg = (kLeg.reverse() / 255).array().pow(2.2);
  for (double shadow : {0.0, 0.06}) {
    const Photographs seen(shadow);
    texture_character(c, c.actor.mesh.vertices, seen.cameras, seen.images);
    EXPECT_LT((c.body_colour - leg).norm(), 0.02) << c.body_colour.transpose();
    Character legless = character_of(wearer());
    texture_character(legless, legless.actor.mesh.vertices, seen.cameras, seen.images);
    EXPECT_EQ(legless.body_colour, before);
  }
}

TEST(DisplaySurface, EachHiddenThighIsAsItsLegBelowTheHem) {
  const double kApart = 0.1; // of each leg from the middle
  Character c = character_of(wearer(0, join({leg(kApart, 0.06), leg(-kApart, 0.06)})));
  const Eigen::Vector3d bare(130, 160, 210), legging(90, 40, 30); // B G R
  Image picture(2, 2, 3, 0);
  TexCoords texcoords(3 * c.high.faces.rows(), 2);
  for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f) {
    const int side = c.high.vertices.row(c.high.faces(f, 0)).x() > 0;
    texcoords.middleRows(3 * f, 3).rowwise() = Eigen::RowVector2d(0.25 + 0.5 * side, 0.25);
  }
  for (int k = 0; k < 3; ++k) {
    picture.at(0, 0, k) = static_cast<std::uint8_t>(bare[k]);
    picture.at(1, 0, k) = static_cast<std::uint8_t>(legging[k]);
  }
  const detail::HiddenSkin skin(c, detail::beyond_free_edges(c), texcoords, picture);
  ASSERT_TRUE(skin.is_known());
  for (double above : {-0.05, 0.0, 0.03}) {
    EXPECT_LT((skin.at({-kApart - 0.06, kHem + above, 0}).colour - bare).norm(), 3) << above;
    EXPECT_LT((skin.at({kApart + 0.06, kHem + above, 0}).colour - legging).norm(), 3) << above;
  }
  EXPECT_LT((skin.at({0, kHem + 0.2, 0}).colour - (bare + legging) / 2).norm(), 3);
  EXPECT_NEAR(skin.at({kApart + 0.06, kHem - 0.12, 0}).distance, 0.1, 1e-6);
}

TEST(DisplaySurface, SkinInTheGarmentsShadowGoesOverIntoTheHidden) {
  const Photographs seen(0.1);
  Character c = character_of(wearer(0, leg()));
  const auto red = [&](bool albedo, double from, double to) {
    TextureOptions options;
    options.albedo = albedo;
    return red_of_legs(c, seen, options, from, to);
  };
  EXPECT_LT(red(false, 0.03, 0.06), 0.7 * kLeg[2]);
  EXPECT_GT(red(true, 0.03, 0.06), 0.8 * kLeg[2]);
  EXPECT_NEAR(red(true, 0.2, 0.3), kLeg[2], 12);
}

TEST(DisplaySurface, WithoutAGarmentOfItsOwnTheScanIsDrawnWhereMIsValid) {
  Wearer w = wearer();
  w.segmentation.rest.resize(0, 3);
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  EXPECT_EQ(display.garment_subdivisions, -1);
  EXPECT_TRUE(display.mesh.vertices == w.high.vertices && display.mesh.faces == w.high.faces);
}

TEST(DisplaySurface, FileHoldsTheSubdivision) {
  const TempFolder folder;
  const Character c = character_of(wearer());
  write_character(folder / "c.glb", c);
  const Character back = read_character(folder / "c.glb");
  EXPECT_EQ(back.garment_subdivisions, 1);
  write_character(folder / "again.glb", back);
  EXPECT_LT((DisplaySurface(back).apply(c.actor.mesh.vertices) - c.high.vertices).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(DisplaySurface, RefusesWhatDoesNotFit) {
  Character c = character_of(wearer());
  EXPECT_THROW(DisplaySurface(c).apply(Vertices(3, 3)), std::invalid_argument);
  EXPECT_THROW(DisplaySurface(c).sample(MatrixRM(3, 3)), std::invalid_argument);
  for (const int levels : {-2, 0, 2, 99}) {
    c.garment_subdivisions = levels;
    EXPECT_THROW(validate_character(c), Error) << levels;
  }
  EXPECT_THROW(DisplaySurface(Character{}), Error);
}

TEST(DisplaySurface, InnerSideIsDrawn) {
  const Character c = character_of(wearer());
  const CharacterRenderer renderer(c);
  RenderOptions options;
  options.floor = false;
  const Camera below = orbit_camera({0, 1, 0}, 0.6, 0, -1.2, 100, 100);
  const FaceBuffer buffer = rasterize(c.high.vertices, c.high.faces, below);
  const Image image = renderer.render(c.actor.mesh.vertices, c.high.vertices, {}, below, options);
  const auto background = static_cast<int>(options.background.z() * 255 + 0.5);
  int inside = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const int f = buffer.face_at(x, y);
      if (f < 0)
        continue;
      const Eigen::Vector3d a = c.high.vertices.row(c.high.faces(f, 0)), b = c.high.vertices.row(c.high.faces(f, 1)),
                            d = c.high.vertices.row(c.high.faces(f, 2));
      if ((b - a).cross(d - a).dot(below.centre() - a) < 0) {
        ++inside;
        EXPECT_NE(image.at(x, y, 0), background);
      }
    }
  EXPECT_GT(inside, 200);
}

namespace {

/// In a body that is a leg up to the garment's seam, and the trunk above it.
Character with_body(const Wearer &w) {
  BodyFit body;
  body.model = "leg";
  body.body = tube(
      {0, 0.05, 0}, {0, kTop, 0},
      [](double s) {
        const double y = 0.05 + s * (kTop - 0.05);
        return y > kSeam ? kRadius : 0.1 + 0.1 * std::max(0.0, (y - 0.8) / (kSeam - 0.8));
      },
      80, 32);
  const DisplayMesh display = build_display_mesh(w.actor, w.segmentation, w.high);
  return make_character(w.actor, w.segmentation, body, {}, {pbd::Material{}}, {}, display.mesh, display.valid,
                        display.garment_subdivisions);
}

} // namespace

TEST(DisplaySurface, WhatIsAroundTheChartsOfHiddenSkinIsItsColour) {
  const Photographs seen(0.1);
  Character c = with_body(wearer(0, leg()));
  texture_character(c, c.actor.mesh.vertices, seen.cameras, seen.images);
  const Image texture = decode_image(c.texture);
  const auto at = [&](const Eigen::RowVector2d &uv, int dx, int dy) { // R
    return texture.at(static_cast<int>(uv.x() * texture.width) + dx, static_cast<int>(uv.y() * texture.height) + dy, 2);
  };
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  int texels = 0, off = 0;
  for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f)
    for (int k = 0; k < 3 && hidden[f] && c.high_valid[f]; ++k) {
      const int inside = at(c.texcoords.middleRows(3 * f, 3).colwise().mean(), 0, 0);
      texels += 9;
      for (int dy : {-1, 0, 1})
        for (int dx : {-1, 0, 1})
          off += std::abs(at(c.texcoords.row(3 * f + k), dx, dy) - inside) > 30;
    }
  ASSERT_GT(texels, 1000);
  EXPECT_LT(off, 0.03 * texels); // at a seam skin goes over into it
}

TEST(DisplaySurface, ScanAndHiddenBodyAreOneClosedSurface) {
  const Character c = with_body(wearer(0, leg()));
  ASSERT_FALSE(c.high_body.empty());
  EXPECT_EQ(std::count(c.body_shown.begin(), c.body_shown.end(), 0), c.body.faces.rows()); // nothing is drawn beside it
  const Eigen::Index skin = c.high.faces.rows() - 14 * 36 * 2 * (1 << (2 * c.garment_subdivisions));
  const EdgeTopology topology = edge_topology(c.high.faces.topRows(skin));
  for (std::size_t e = 0; e < topology.edges.size(); ++e)
    if (topology.edge_faces[e][1] < 0) {
      const double y = c.high.vertices(topology.edges[e][0], 1);
      EXPECT_TRUE(y < 0.15 || y > kTop - 0.05) << y; // the tubes' own ends
    }
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  for (Eigen::Index f = 0; f < skin; ++f)
    if (hidden[f]) {
      EXPECT_LT(c.high.vertices(c.high.faces.row(f).transpose(), 1).maxCoeff(), kSeam); // it does not show above the garment
    }
  const DisplaySurface surface(c);
  EXPECT_LT((surface.apply(c.actor.mesh.vertices) - c.high.vertices).cwiseAbs().maxCoeff(), 1e-6);
  const MatrixRM weights = surface.skin_weights(c.actor.weights);
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-9);
  const TempFolder folder;
  write_character(folder / "c.glb", c);
  EXPECT_EQ(read_character(folder / "c.glb").high_body, c.high_body);
  EXPECT_NE(read_text(folder / "c.glb").find("\"version\":3"), std::string::npos); // others would draw the body wrongly
  Character wrong = c;
  wrong.high_body[0] = static_cast<int>(c.body.vertices.rows());
  EXPECT_THROW(validate_character(wrong), Error);
}

TEST(DisplaySurface, SkinOfTheScanGoesUnderAGarmentThatIsNarrowerThanTheLeg) {
  const Character c = with_body(wearer(0, leg()));
  ASSERT_FALSE(c.high_body.empty());
  const Vertices narrow = narrowed(c);
  const DisplaySurface surface(c);
  DisplayBuffers buffers;
  Vertices high, none;
  surface.apply(narrow, high, buffers);
  const RayScene cloth({buffers.cloth, Faces(c.high.faces.bottomRows(14 * 36 * 2 * (1 << (2 * c.garment_subdivisions))).array() -
                                             static_cast<int>(c.high.vertices.rows() - buffers.cloth.rows()))});
  const auto outside = [&] {
    int count = 0;
    for (Eigen::Index v = 0; v < high.rows() - buffers.cloth.rows(); ++v) {
      const Eigen::Vector3d p = high.row(v), away(p.x(), 0, p.z());
      count += p.y() > kHem - 0.03 && p.y() < 0.75 && cloth.cast(p, -away.normalized(), 1e-6, 0.06).has_value();
    }
    return count;
  };
  EXPECT_GT(outside(), 50);
  SkinPenetrationFix(c).apply(buffers, high, none);
  EXPECT_EQ(outside(), 0);
}

TEST(DisplaySurface, WhatIsOfAnArmStaysWhereItIsBeforeAGarmentThatIsOfTheTrunk) {
  Character c = with_body(wearer(0, leg()));
  c.actor.skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, {}}, {"l_shoulder", "pelvis", {0, 1.3, 0}, 3}});
  c.actor.weights = MatrixRM::Zero(c.actor.mesh.vertices.rows(), 2);
  for (Eigen::Index v = 0; v < c.actor.weights.rows(); ++v)
    c.actor.weights(v, c.segmentation.region[v] < 0) = 1; // what was a leg is an arm
  c.body_weights = MatrixRM::Zero(c.body.vertices.rows(), 2);
  c.body_weights.col(1).setOnes();
  const Vertices narrow = narrowed(c);
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(narrow, high, buffers);
  const Vertices before = high;
  SkinPenetrationFix(c).apply(buffers, high, none);
  EXPECT_EQ((high - before).cwiseAbs().maxCoeff(), 0);
}

/// The valleys of pleats lie in the leg: its triangles neither bridge them nor come out of a pleat's other side.
TEST(DisplaySurface, SkinGoesStraightInUnderPleats) {
  const Character c = with_body(wearer(0, leg()));
  ASSERT_FALSE(c.high_body.empty());
  Vertices pleated = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < pleated.rows(); ++v)
    if (c.segmentation.clothness[v] > 0) {
      const double angle = std::atan2(pleated(v, 2), pleated(v, 0)), low = std::min(1.0, (kSeam - pleated(v, 1)) / 0.2);
      const double factor = 1 - low * (1 - (0.095 + 0.06 * std::cos(9 * angle)) / kRadius);
      pleated(v, 0) *= factor;
      pleated(v, 2) *= factor;
    }
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(pleated, high, buffers);
  const Eigen::Index cloth_faces = 14 * 36 * 2 * (1 << (2 * c.garment_subdivisions));
  const Faces skin = c.high.faces.topRows(c.high.faces.rows() - cloth_faces);
  const RayScene cloth({buffers.cloth, Faces(c.high.faces.bottomRows(cloth_faces).array() -
                                             static_cast<int>(c.high.vertices.rows() - buffers.cloth.rows()))});
  const auto outside = [&] { // of the faces' middles and the edges'
    int count = 0;
    for (Eigen::Index f = 0; f < skin.rows(); ++f)
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d a = high.row(skin(f, k % 3)), b = high.row(skin(f, (k + 1) % 3)),
                              d = high.row(skin(f, (k + 2) % 3)),
                              p = k < 3 ? Eigen::Vector3d((a + b) / 2) : Eigen::Vector3d((a + b + d) / 3);
        const Eigen::Vector3d in = -Eigen::Vector3d(p.x(), 0, p.z()).normalized();
        count += p.y() > kHem + 0.05 && p.y() < 0.75 && cloth.cast(p, in, 1e-6, 0.06).has_value();
      }
    return count;
  };
  EXPECT_GT(outside(), 1000);
  SkinPenetrationFix(c).apply(buffers, high, none);
  EXPECT_EQ(outside(), 0);
}

TEST(DisplaySurface, SkinIsNotPulledOutUnderAGarmentThatLiesInsideOut) {
  const Character c = with_body(wearer(0, leg()));
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(c.actor.mesh.vertices, high, buffers);
  buffers.cloth_normals *= -1; // as of a hem thrown up over the hip
  const Vertices before = high;
  SkinPenetrationFix(c).apply(buffers, high, none);
  EXPECT_LT((high - before).rowwise().norm().maxCoeff(), 1e-9);
}

namespace {

Mesh drawn_garment(const Character &c, const Vertices &cloth) {
  return {cloth, Faces(c.high.faces.bottomRows(14 * 36 * 2 * (1 << (2 * c.garment_subdivisions))).array() -
                       static_cast<int>(c.high.vertices.rows() - cloth.rows()))};
}

/// Of the skin's vertices between these heights, those before the garment's outer side.
int before_the_garment(const Character &c, const Vertices &high, const Vertices &drawn, double low, double top) {
  const RayScene cloth(drawn_garment(c, drawn));
  int count = 0;
  for (Eigen::Index v = 0; v < high.rows() - drawn.rows(); ++v) {
    const Eigen::Vector3d p = high.row(v), in = -Eigen::Vector3d(p.x(), 0, p.z()).normalized();
    count += p.y() > low && p.y() < top && cloth.cast(p, in, 1e-6, 0.06).has_value();
  }
  return count;
}

/// In a body that lifts the garment.
Character with_capsule() {
  Character c = with_body(wearer(0, leg()));
  c.proxies = {{0, {0, -0.8, 0}, {0, -0.1, 0}, 0.08, 0.08}};
  return c;
}

/// The garment as a tube of this radius from 15 cm below its seam on.
Vertices of_radius(const Character &c, double radius) {
  Vertices surface = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < surface.rows(); ++v)
    if (c.segmentation.clothness[v] > 0) {
      const double low = std::min(1.0, (kSeam - surface(v, 1)) / 0.15), factor = 1 - low * (1 - radius / kRadius);
      surface(v, 0) *= factor;
      surface(v, 2) *= factor;
    }
  return surface;
}

} // namespace

TEST(DisplaySurface, AGarmentInsideTheBodyIsLiftedOntoIt) {
  const Character c = with_capsule();
  const auto radii = [&](double radius) { // of the garment 25 to 40 cm below its seam, lifted: the least and the most
    Vertices surface = of_radius(c, radius);
    const Vertices before = surface;
    GarmentPenetrationFix(c).apply(c.body.vertices, surface);
    Eigen::Array2d found(1, 0);
    for (Eigen::Index v = 0; v < surface.rows(); ++v) {
      const double below = kSeam - surface(v, 1), at = std::hypot(surface(v, 0), surface(v, 2));
      if (c.segmentation.clothness[v] > 0 && below > 0.25 && below < 0.4)
        found = Eigen::Array2d(std::min(found[0], at), std::max(found[1], at));
      if (c.segmentation.clothness[v] == 0) { // the skin, and where it hangs
        EXPECT_EQ(surface.row(v), before.row(v)) << v;
      }
    }
    return found;
  };
  for (const double radius : {0.082, 0.09, 0.1}) { // in a leg of 0.1
    EXPECT_GT(radii(radius)[0], 0.103) << radius;
    EXPECT_LT(radii(radius)[1], 0.1045) << radius;
  }
  for (const double radius : {0.06, 0.07}) { // less the deeper it is, to nothing
    EXPECT_GE(radii(radius)[0], radius - 1e-9);
    EXPECT_LT(radii(radius)[1], radius == 0.06 ? 0.0615 : 0.09);
  }
  EXPECT_NEAR(radii(0.11)[0], 0.11, 1e-9); // outside it is left alone
}

TEST(DisplaySurface, NeighboursThatAreLiftedToTwoSidesStayTogether) {
  Character c = with_capsule();
  c.body.vertices.col(2) *= 0.25; // 2.5 cm thin: what lies in its middle is lifted by as much to either side
  Vertices surface = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < surface.rows(); ++v)
    if (c.segmentation.clothness[v] > 0)
      surface(v, 2) = v % 2 == 0 ? 0.003 : -0.003;
  const Vertices before = surface;
  GarmentPenetrationFix(c).apply(c.body.vertices, surface);
  const Vertices lifted = surface - before;
  EXPECT_GT(lifted.rowwise().norm().maxCoeff(), 0.01);
  for (const Eigen::Vector2i &edge : edge_topology(c.actor.mesh.faces).edges)
    if (c.segmentation.clothness[edge[0]] > 0 && c.segmentation.clothness[edge[1]] > 0) {
      const double length = (before.row(edge[0]) - before.row(edge[1])).norm();
      EXPECT_LT((lifted.row(edge[0]) - lifted.row(edge[1])).norm(), 0.8 * length);
    }
}

TEST(DisplaySurface, WhatAGarmentHangsByIsNotLifted) {
  const Character c = with_capsule();
  Vertices surface = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < surface.rows(); ++v)
    if (c.segmentation.clothness[v] > 0 && kSeam - surface(v, 1) < 0.04) // close to the seam, and in the hip
      surface.row(v) << 0.85 * surface(v, 0), kSeam - 0.005, 0.85 * surface(v, 2);
  const Vertices before = surface;
  GarmentPenetrationFix(c).apply(c.body.vertices, surface);
  EXPECT_GT((surface - before).rowwise().norm().maxCoeff(), 0.02);
  for (Eigen::Index v = 0; v < surface.rows(); ++v)
    if (c.segmentation.clothness[v] == 0) {
      ASSERT_EQ(surface.row(v), before.row(v)) << v;
    }
}

TEST(DisplaySurface, ArmsAndBonesWithoutACapsuleLiftNoGarment) {
  Character c = with_capsule();
  EXPECT_TRUE(GarmentPenetrationFix::applies_to(c));
  Character no_capsule = c, no_garment = c, arm = c;
  no_capsule.proxies.clear();
  no_garment.garment_subdivisions = -1;
  no_garment.high_body.clear();
  arm.actor.skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, {}}, {"l_shoulder", "pelvis", {0, 1.3, 0}, 3}});
  arm.actor.weights = MatrixRM::Zero(c.actor.weights.rows(), 2);
  arm.actor.weights.col(0).setOnes();
  arm.body_weights = MatrixRM::Zero(c.body_weights.rows(), 2);
  arm.body_weights.col(1).setOnes();
  arm.proxies[0].joint = 1;
  for (const Character &other : {no_capsule, no_garment, arm}) {
    EXPECT_FALSE(GarmentPenetrationFix::applies_to(other));
    EXPECT_THROW(GarmentPenetrationFix{other}, Error);
  }
}

TEST(DisplaySurface, APlayerDrawsTheSameWithAndWithoutTheBodyBesideIt) {
  Character c = with_capsule();
  c.solver.cloth.gravity.setZero();
  AnimateOptions alone, as_it_is;
  alone.body = false;
  as_it_is.resolve_body_penetration = false;
  Player whole(c), skin(c, alone), untouched(c, as_it_is);
  for (Player *player : {&whole, &skin, &untouched}) {
    CharacterState state = player->state();
    Vertices &cloth = state.regions[0].positions;
    for (Eigen::Index v = 0; v < cloth.rows(); ++v)
      if (kSeam - cloth(v, 1) > 0.2)
        cloth.row(v) = Eigen::RowVector3d(0.45 * cloth(v, 0), cloth(v, 1), 0.45 * cloth(v, 2)); // 1 cm inside the leg
    player->set_state(state);
  }
  EXPECT_EQ(skin.frame().body.rows(), 0);
  EXPECT_EQ(whole.frame().high, skin.frame().high);
  EXPECT_EQ(whole.frame().surface, untouched.frame().surface); // a matter of display
  EXPECT_GT((whole.frame().high - untouched.frame().high).bottomRows(1000).rowwise().norm().maxCoeff(), 0.01);
}

/// A hip that bulges beside cloth that goes inwards from its seam: nothing of the garment is nearer than the seam.
TEST(DisplaySurface, TheBodyGoesUnderCloseToTheSeam) {
  const Character c = with_body(wearer(0, leg()));
  Vertices waisted = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < waisted.rows(); ++v)
    if (c.segmentation.clothness[v] > 0) {
      waisted(v, 0) *= 0.8;
      waisted(v, 2) *= 0.8;
    }
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(waisted, high, buffers);
  const double low = 0.968, top = 0.982;
  for (Eigen::Index v = 0; v < high.rows() - buffers.cloth.rows(); ++v)
    if (high(v, 1) > low && high(v, 1) < top) {
      const double factor = 0.215 / std::hypot(high(v, 0), high(v, 2));
      high(v, 0) *= factor;
      high(v, 2) *= factor;
    }
  EXPECT_GT(before_the_garment(c, high, buffers.cloth, low, top), 20);
  SkinPenetrationFix(c).apply(buffers, high, none);
  EXPECT_EQ(before_the_garment(c, high, buffers.cloth, low, top), 0);
}

/// A skirt thrown up over the trunk, as it hangs turned upside down about the seam, its outer side out.
TEST(DisplaySurface, SkinThatNoGarmentCoversGoesUnderClothThatLiesInIt) {
  const Character c = with_body(wearer(0, leg()));
  const auto thrown_up = [&](double radius) {
    Vertices surface = c.actor.mesh.vertices;
    for (Eigen::Index v = 0; v < surface.rows(); ++v)
      if (c.segmentation.clothness[v] > 0)
        surface.row(v) << surface(v, 0) * radius / kRadius, 2 * kSeam - surface(v, 1), -surface(v, 2) * radius / kRadius;
    return surface;
  };
  SkinPenetrationFix fix(c);
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(thrown_up(kRadius - 0.01), high, buffers);
  EXPECT_GT(before_the_garment(c, high, buffers.cloth, 1.1, 1.4), 500);
  fix.apply(buffers, high, none);
  EXPECT_EQ(before_the_garment(c, high, buffers.cloth, 1.1, 1.4), 0);
  for (const double radius : {kRadius - 0.04, kRadius + 0.01}) { // farther in than that, and outside
    DisplaySurface(c).apply(thrown_up(radius), high, buffers);
    const Vertices before = high;
    fix.apply(buffers, high, none);
    for (Eigen::Index v = 0; v < high.rows() - buffers.cloth.rows(); ++v)
      if (before(v, 1) > 1.1 && before(v, 1) < 1.4) {
        ASSERT_EQ(high.row(v), before.row(v)) << radius;
      }
  }
}

/// A skirt that flares out of the skin like a dish, its outer side up: the waist above it keeps its shape.
TEST(DisplaySurface, SkinBesideClothThatNoGarmentCoversStays) {
  const Character c = with_body(wearer(0, leg()));
  Vertices dish = c.actor.mesh.vertices;
  for (Eigen::Index v = 0; v < dish.rows(); ++v)
    if (c.segmentation.clothness[v] > 0) {
      const double along = (kSeam - dish(v, 1)) / (kSeam - kHem), factor = (0.1 + 0.2 * along) / kRadius;
      dish.row(v) << factor * dish(v, 0), 1.227 - 0.054 * along, factor * dish(v, 2);
    }
  DisplayBuffers buffers;
  Vertices high, none;
  DisplaySurface(c).apply(dish, high, buffers);
  const Vertices before = high;
  SkinPenetrationFix(c).apply(buffers, high, none);
  for (Eigen::Index v = 0; v < high.rows() - buffers.cloth.rows(); ++v)
    if (before(v, 1) > 1.1 && before(v, 1) < 1.4) {
      ASSERT_EQ(high.row(v), before.row(v));
    }
}
