#include "doublet/animate/character_file.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/animate/surface_transfer.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "figure_character.h"
#include "support/error_of.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

using namespace doublet;
using namespace doublet::testing;

namespace {

MatrixRM as_float(const MatrixRM &m) {
  return m.cast<float>().cast<double>();
}

Character textured_character() {
  Character c = figure_character();
  Image image(16, 16, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<std::uint8_t>(37 * i);
  c.texture = encode_png(image);
  c.texcoords.resize(3 * c.high.faces.rows(), 2);
  for (Eigen::Index i = 0; i < c.texcoords.rows(); ++i)
    c.texcoords.row(i) << (i % 17) / 17.0, (i % 13) / 13.0;
  return c;
}

void expect_same(const Character &a, const Character &b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(as_float(a.actor.mesh.vertices) == b.actor.mesh.vertices);
  EXPECT_TRUE(a.actor.mesh.faces == b.actor.mesh.faces);
  EXPECT_TRUE(a.actor.face_valid == b.actor.face_valid);
  EXPECT_TRUE(as_float(a.actor.weights) == b.actor.weights);
  ASSERT_EQ(a.actor.skeleton.joint_count(), b.actor.skeleton.joint_count());
  EXPECT_EQ(a.actor.skeleton.dof_names, b.actor.skeleton.dof_names);
  EXPECT_EQ(a.actor.skeleton.lower, b.actor.skeleton.lower);
  for (int j = 0; j < a.actor.skeleton.joint_count(); ++j) {
    EXPECT_EQ(a.actor.skeleton.joints[j].name, b.actor.skeleton.joints[j].name);
    EXPECT_EQ(a.actor.skeleton.joints[j].rest, b.actor.skeleton.joints[j].rest);
    EXPECT_EQ(a.actor.skeleton.joints[j].axes, b.actor.skeleton.joints[j].axes);
  }
  EXPECT_TRUE(std::isnan(b.segmentation.sigma[0]));
  EXPECT_TRUE(as_float(a.segmentation.clothness) == b.segmentation.clothness);
  EXPECT_TRUE(a.segmentation.region == b.segmentation.region);
  EXPECT_EQ(a.segmentation.region_count, b.segmentation.region_count);
  ASSERT_EQ(a.proxies.size(), b.proxies.size());
  for (std::size_t i = 0; i < a.proxies.size(); ++i) {
    EXPECT_EQ(a.proxies[i].joint, b.proxies[i].joint);
    EXPECT_EQ(a.proxies[i].p1, b.proxies[i].p1);
    EXPECT_EQ(a.proxies[i].r0, b.proxies[i].r0);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  EXPECT_EQ(options::to_pairs(a.materials[0]), options::to_pairs(b.materials[0]));
  EXPECT_TRUE(as_float(a.segmentation.rest) == b.segmentation.rest);
  EXPECT_EQ(options::to_pairs(a.solver), options::to_pairs(b.solver));
  EXPECT_TRUE(as_float(a.body.vertices) == b.body.vertices);
  EXPECT_TRUE(as_float(a.body_weights) == b.body_weights);
  EXPECT_TRUE(a.body_shown == b.body_shown);
  EXPECT_EQ(a.body_model, b.body_model);
  EXPECT_TRUE(as_float(a.high.vertices) == b.high.vertices);
  EXPECT_TRUE(a.high.faces == b.high.faces);
  EXPECT_TRUE(a.high_valid == b.high_valid);
  EXPECT_TRUE(as_float(a.texcoords) == b.texcoords);
  EXPECT_TRUE(a.texture == b.texture);
}

} // namespace

TEST(CharacterFile, ComesBackAsItWas) {
  const TempFolder folder;
  Character c = textured_character();
  c.segmentation.rest = 1.1 * c.actor.mesh.vertices;
  c.solver = {1.0 / 30, {6, 4, pbd::Stiffness::Compliance, 1.4, 0.25, {0.5, -9, 1.0 / 3}, 0.1, 0.012, 0.003, false}};
  write_character(folder / "character.glb", c);
  const Character once = read_character(folder / "character.glb");
  expect_same(c, once);
  write_character(folder / "again.glb", once);
  EXPECT_TRUE(read_text(folder / "character.glb") == read_text(folder / "again.glb"));
}

TEST(CharacterFile, WithoutBodyTextureAndHighMesh) {
  const TempFolder folder;
  Character c = figure_character();
  c.body = Mesh{};
  c.body_weights.resize(0, 0);
  c.body_shown.clear();
  c.high = Mesh{};
  c.high_valid.clear();
  write_character(folder / "character.glb", c);
  const Character back = read_character(folder / "character.glb");
  EXPECT_EQ(back.body.faces.rows(), 0);
  EXPECT_EQ(back.high.faces.rows(), 0);
  EXPECT_TRUE(back.actor.mesh.faces == c.actor.mesh.faces);
}

/// Puts `to` in the place of what begins with `from` and is `length` long, padded with blanks: the file keeps its size.
void overwrite(std::string &text, const std::string &from, std::size_t length, std::string to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  ASSERT_LE(to.size(), length) << to;
  to.resize(length, ' ');
  text.replace(text.find(from), length, to);
}

TEST(CharacterFile, OlderOnesKnowNoRestShapeAndNoCompliance) {
  const TempFolder folder;
  Character c = figure_character();
  c.segmentation.rest = 1.1 * c.actor.mesh.vertices;
  c.solver = {1.0 / 30, {6, 4, pbd::Stiffness::Compliance, 1.4, 0.25, {0.5, -9, 1.0 / 3}, 0.1, 0.012, 0.003, false}};
  write_character(folder / "new.glb", c);
  std::string text = read_text(folder / "new.glb");
  overwrite(text, "\"rest\"", 6, "\"Xest\""); // a key that nobody asks for
  overwrite(text, "\"version\":2", 11, "\"version\":1");
  const std::size_t solver = text.find("\"solver\":");
  overwrite(text, "\"solver\":", text.find("}", text.find("}", solver) + 1) + 1 - solver,
            R"("solver":{"dt":0.02,"gravity":[0,-9,0],"iterations":7,"restitution":0.5,"selfCollision":false,)"
            R"("selfThickness":0.003,"substeps":2,"thickness":0.01})");
  write_text(folder / "old.glb", text);
  const Character old = read_character(folder / "old.glb");
  EXPECT_EQ(old.segmentation.rest.rows(), 0);
  const SolverSettings meant{0.02, {7, 2, pbd::Stiffness::Sweeps, 1.0, 1.0, {0, -9, 0}, 0.5, 0.01, 0.003, false}};
  EXPECT_EQ(options::to_pairs(old.solver), options::to_pairs(meant));
}

TEST(CharacterFile, ANewerOneIsRefusedInASentence) {
  const TempFolder folder;
  write_character(folder / "new.glb", figure_character());
  std::string text = read_text(folder / "new.glb");
  overwrite(text, "\"version\":2", 11, "\"version\":4");
  write_text(folder / "newer.glb", text);
  try {
    read_character(folder / "newer.glb");
    FAIL();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("expected version 1 to 3, found 4, which a newer doublet wrote"), std::string::npos)
        << error.what();
  }
}

TEST(CharacterFile, UnknownStiffnessIsNamedWithItsFile) {
  const TempFolder folder;
  Character c = figure_character();
  c.solver.cloth.stiffness = pbd::Stiffness::Compliance;
  write_character(folder / "good.glb", c);
  std::string text = read_text(folder / "good.glb");
  ASSERT_NE(text.find("compliance"), std::string::npos);
  text[text.find("compliance")] = 'X';
  write_text(folder / "bent.glb", text);
  try {
    read_character(folder / "bent.glb");
    FAIL();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("bent.glb"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("'Xompliance'"), std::string::npos) << error.what();
  }
}

TEST(CharacterFile, BrokenFilesAreNamed) {
  const TempFolder folder;
  EXPECT_THROW(read_character(folder / "none.glb"), FileNotFound);
  write_text(folder / "text.glb", "this is no binary glTF file, but long enough");
  EXPECT_THROW(read_character(folder / "text.glb"), Error);
  write_character(folder / "good.glb", figure_character());
  const std::string good = read_text(folder / "good.glb");
  for (const std::size_t size : {good.size() / 8, good.size() / 2, good.size() - 5}) {
    write_text(folder / "cut.glb", good.substr(0, size));
    try {
      read_character(folder / "cut.glb");
      ADD_FAILURE() << "read " << size << " of " << good.size() << " bytes";
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find("cut.glb"), std::string::npos);
    }
  }
  // Any one byte of the JSON changed: either it still reads, or it says what is wrong.
  std::string text = good;
  for (std::size_t at = 20; at < 6000; at += 61) {
    const char old = text[at];
    text[at] = old == '9' ? '1' : '9';
    write_text(folder / "bent.glb", text);
    text[at] = old;
    try {
      read_character(folder / "bent.glb");
    } catch (const Error &) {
    }
  }
}

TEST(Character, PartsMustFit) {
  Character c = figure_character();
  EXPECT_NO_THROW(validate_character(c));
  c.materials.clear();
  EXPECT_THROW(validate_character(c), Error);
  c = figure_character();
  c.body_shown.pop_back();
  EXPECT_THROW(validate_character(c), Error);
  c = figure_character();
  c.segmentation.rest = Vertices::Zero(5, 3);
  EXPECT_THROW(validate_character(c), std::invalid_argument);
  c = figure_character();
  c.texture = {1, 2, 3};
  EXPECT_THROW(validate_character(c), Error);
}

TEST(Character, BodyUnderTheSkirtIsShownAndHangsOnTheThighBones) {
  const Character c = figure_character();
  const Skeleton &skeleton = c.actor.skeleton;
  const auto hidden = hidden_by_cloth(c.actor, c.segmentation, c.body);
  for (Eigen::Index v = 0; v < c.body.vertices.rows(); ++v) {
    const Eigen::Vector3d p = c.body.vertices.row(v);
    EXPECT_NEAR(c.body_weights.row(v).sum(), 1, 1e-9);
    EXPECT_GE(c.body_weights.row(v).minCoeff(), 0);
    if (p.y() > 1.3 || p.y() < 0.35) {
      EXPECT_FALSE(hidden[v]) << p.transpose();
    }
    if (p.y() > 0.58 && p.y() < 0.72 && p.x() > 0.05 && p.x() < 0.2) {
      EXPECT_TRUE(hidden[v]) << p.transpose();
      EXPECT_GT(c.body_weights(v, skeleton.find("l_hip")), 0.8) << p.transpose();
      EXPECT_LT(c.body_weights(v, skeleton.find("r_hip")), 0.1) << p.transpose();
    }
  }
}

/// Weights of a body of which all hangs under a garment.
MatrixRM hidden_weights(const Mesh &garment, const Mesh &body, const Skeleton &skeleton,
                        const std::vector<TaperedCapsule> &capsules) {
  const Eigen::Index vertices = garment.vertices.rows();
  RiggedMesh actor;
  actor.mesh = garment;
  actor.face_valid.assign(garment.faces.rows(), 1);
  actor.weights = MatrixRM::Zero(vertices, skeleton.joint_count());
  actor.weights.col(0).setOnes();
  actor.skeleton = skeleton;
  Segmentation cloth;
  cloth.sigma = Eigen::VectorXd::Zero(vertices);
  cloth.clothness = Eigen::VectorXd::Ones(vertices);
  cloth.region = Eigen::VectorXi::Zero(vertices);
  cloth.region_count = 1;
  return transfer_weights(actor, cloth, body, capsules);
}

TEST(Character, AHiddenChestDoesNotHangOnTheArms) {
  // Its sides are nearer to the bones of the upper arms than to the spine, and well inside the capsules of the trunk.
  const Mesh dress = cylinder({0, 0.9, 0}, {0, 1.6, 0}, 0.4), chest = sphere(0.15, {0, 1.22, 0}, 12, 24);
  const Skeleton skeleton = figure_skeleton();
  const int shoulder = skeleton.find("l_shoulder");
  EXPECT_GT(hidden_weights(dress, chest, skeleton, {}).col(shoulder).maxCoeff(), 0.2);
  EXPECT_LT(hidden_weights(dress, chest, skeleton, figure_capsules(skeleton)).col(shoulder).maxCoeff(), 1e-6);
}

TEST(Character, HiddenSkinHangsOnTheNextBoneNoFartherThanItIsThick) {
  const Mesh dress = cylinder({0, -0.1, 0}, {0, 1.1, 0}, 0.3), limb = cylinder({0, 0.02, 0}, {0, 0.98, 0}, 0.1, 40, 24);
  const Skeleton skeleton =
      make_skeleton({{"pelvis", "", {0, 0, 0}, {}}, {"spine", "pelvis", {0, 0.5, 0}, 3}, {"chest", "spine", {0, 1, 0}, {}}});
  const std::vector<TaperedCapsule> capsules{{0, {0, 0, 0}, {0, 0.5, 0}, 0.1, 0.1}, {1, {0, 0, 0}, {0, 0.5, 0}, 0.1, 0.1}};
  const MatrixRM weights = hidden_weights(dress, limb, skeleton, capsules);
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double above = limb.vertices(v, 1) - 0.5, radius = std::hypot(limb.vertices(v, 0), limb.vertices(v, 2));
    if (radius > 0.09 && std::abs(above) > 0.1) {
      EXPECT_LT(weights(v, above > 0 ? 0 : 1), 0.1) << above;
    }
  }
}

TEST(SurfaceTransfer, ExactAtRestAndUnderRigidMotion) {
  const Mesh coarse = sphere(0.5, {0, 1, 0}, 12, 24), fine = sphere(0.51, {0, 1, 0}, 40, 80);
  const SurfaceTransfer transfer(coarse, {}, fine, {});
  EXPECT_LT((transfer.apply(coarse.vertices) - fine.vertices).cwiseAbs().maxCoeff(), 1e-6);
  const Eigen::Isometry3d move = Eigen::Translation3d(1, -2, 3) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized());
  const auto moved = [&](const Vertices &v) -> Vertices { return (move * v.transpose()).transpose(); };
  EXPECT_LT((transfer.apply(moved(coarse.vertices)) - moved(fine.vertices)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SurfaceTransfer, FollowsABendSmoothly) {
  const Mesh coarse = cylinder({0, 0, 0}, {0, 1, 0}, 0.1, 20, 16), fine = cylinder({0, 0, 0}, {0, 1, 0}, 0.1, 80, 64);
  const SurfaceTransfer transfer(coarse, {}, fine, {});
  const auto bent = [](Vertices v) {
    for (Eigen::Index i = 0; i < v.rows(); ++i) {
      const double a = 0.8 * v(i, 1), r = 1 / 0.8 + v(i, 0); // a circular arc of 0.8 rad
      v.row(i) << r * std::cos(a) - 1 / 0.8, r * std::sin(a), v(i, 2);
    }
    return v;
  };
  const Vertices followed = transfer.apply(bent(coarse.vertices)), expected = bent(fine.vertices);
  EXPECT_LT((followed - expected).rowwise().norm().maxCoeff(), 0.004);
}

TEST(SurfaceTransfer, ValidBindsToValid) {
  // Two parallel sheets 2 cm apart; the lower one is invalid and moves away: the fine sheet between must follow the upper one
  // alone.
  Mesh upper = grid(1, 1, 10, 10), lower = grid(1, 1, 10, 10), fine = grid(0.9, 0.9, 30, 30);
  lower.vertices.col(1).array() -= 0.02;
  fine.vertices.col(1).array() -= 0.015;
  const Mesh coarse = join({upper, lower});
  std::vector<std::uint8_t> valid(coarse.faces.rows(), 1);
  std::fill(valid.begin() + upper.faces.rows(), valid.end(), 0);
  const SurfaceTransfer transfer(coarse, valid, fine, {});
  Vertices moved = coarse.vertices;
  moved.bottomRows(lower.vertices.rows()).array() += 5;
  EXPECT_LT((transfer.apply(moved) - fine.vertices).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SurfaceTransfer, RefusesBrokenMeshes) {
  const Mesh good = sphere(1), empty;
  EXPECT_THROW(SurfaceTransfer(empty, {}, good, {}), Error);
  EXPECT_THROW(SurfaceTransfer(good, {}, empty, {}), Error);
  EXPECT_THROW(SurfaceTransfer(good, std::vector<std::uint8_t>(good.faces.rows(), 0), good, {}), Error);
  EXPECT_THROW(SurfaceTransfer(good, std::vector<std::uint8_t>(3, 1), good, {}), Error);
  EXPECT_THROW(SurfaceTransfer(good, {}, good, {}).apply(Vertices(3, 3)), std::invalid_argument);
}

TEST(ImageFile, AnImageLargerThanItsBytesCanHoldIsRefused) {
  const Image image(16, 16, 3);
  std::vector<std::uint8_t> png = encode_png(image), jpeg = encode_jpeg(image);
  constexpr std::uint8_t kFrame[] = {0xFF, 0xC0};
  png[17] = png[21] = 2; // 131088 x 131088
  const auto frame = std::search(jpeg.begin(), jpeg.end(), std::begin(kFrame), std::end(kFrame));
  ASSERT_LT(frame + 9, jpeg.end());
  frame[5] = frame[7] = 0xFF; // 65296 x 65296
  for (const auto &bytes : {png, jpeg}) {
    const std::string said = error_of([&] { decode_image(bytes); });
    EXPECT_NE(said.find("that its " + std::to_string(bytes.size()) + " bytes can hold"), std::string::npos) << said;
  }
}

TEST(ImageFile, PngIsLossless) {
  Image image(7, 5, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<std::uint8_t>(11 * i);
  const Image back = decode_image(encode_png(image));
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.data, image.data);
  EXPECT_THROW(decode_image({1, 2, 3, 4}), Error);
  EXPECT_THROW(encode_png(Image()), std::invalid_argument);
}
