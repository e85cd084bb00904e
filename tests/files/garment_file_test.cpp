#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "support/error_of.h"
#include "support/garment_scene.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

namespace doublet {

using testing::empty_garment;
using testing::TempFolder;
using Scene = testing::GarmentScene;

TEST(GarmentFile, ComesBackAsItWas) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "garment.npz", s.garment);
  const Garment back = read_garment(folder / "garment.npz", s.actor);
  EXPECT_TRUE(back.mesh.vertices.isApprox(s.garment.mesh.vertices, 1e-7));
  EXPECT_EQ(back.mesh.faces, s.garment.mesh.faces);
  EXPECT_EQ(back.region, s.garment.region);
  EXPECT_EQ(back.region_count, 2);
  EXPECT_EQ(back.clothness, s.garment.clothness);
  EXPECT_TRUE(back.rest.isApprox(s.garment.rest, 1e-7));
  EXPECT_EQ(back.actor_face, s.garment.actor_face);
  EXPECT_EQ(back.barycentric, s.garment.barycentric);
  EXPECT_EQ(back.replaced_faces, s.garment.replaced_faces);
}

TEST(GarmentFile, EmptyOneToo) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "garment.npz", empty_garment(s.actor));
  const Garment back = read_garment(folder / "garment.npz", s.actor);
  EXPECT_EQ(back.mesh.vertices.rows(), 0);
  EXPECT_EQ(back.mesh.faces.rows(), 0);
  EXPECT_EQ(back.rest.rows(), 0);
  EXPECT_EQ(back.region_count, 0);
  EXPECT_EQ(back.replaced_faces.size(), s.actor.face_valid.size());
  EXPECT_EQ(dress(s.actor, s.segmentation, back).actor.mesh.vertices, s.actor.mesh.vertices);
}

TEST(GarmentFile, SaysWhatIsCarriedIfItIsKnown) {
  const TempFolder folder;
  Scene s;
  write_garment(folder / "older.npz", s.garment);
  EXPECT_EQ(read_garment(folder / "older.npz", s.actor).attachment.size(), 0);
  for (Garment garment : {s.garment, empty_garment(s.actor)}) {
    garment.attachment = Eigen::VectorXd::LinSpaced(s.bare(), 0, 1);
    write_garment(folder / "garment.npz", garment);
    EXPECT_TRUE(read_garment(folder / "garment.npz", s.actor).attachment.isApprox(garment.attachment, 1e-7));
  }
}

TEST(GarmentFile, DamagedOnesAreRefusedByName) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "good.npz", s.garment);
  const auto said = [&](const std::function<void(Npz &)> &damage) {
    Npz npz = Npz::read(folder / "good.npz");
    damage(npz);
    npz.write(folder / "bad.npz");
    return testing::error_of([&] { read_garment(folder / "bad.npz", s.actor); });
  };
  const auto contains = [](const std::string &text, const std::string &part) {
    EXPECT_NE(text.find("bad.npz"), std::string::npos) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  for (const char *array : {"vertices", "faces", "region", "clothness", "rest", "actor_face", "barycentric", "covers"})
    contains(said([&](Npz &npz) { npz.arrays.erase(array); }), array);
  contains(said([](Npz &npz) { npz.set_i4("region", {5}, std::vector<int>(5, 0)); }), "region");
  contains(said([](Npz &npz) { npz.set_f4("rest", {3, 6}, std::vector<double>(18, 0)); }), "rest");
  contains(said([](Npz &npz) { npz.set_f4("barycentric", {6, 2}, std::vector<double>(12, 0.5)); }), "barycentric");
  contains(said([](Npz &npz) { npz.set_i4("actor_face", {6}, std::vector<int>(6, 1 << 30)); }), "vertex 0");
  contains(said([](Npz &npz) { npz.set_i4("faces", {1, 3}, {0, 1, 6}); }), "bad.npz");
  contains(said([](Npz &npz) { npz.set_f4("attachment", {2}, {0, 1}); }), "attachment");
  contains(said([&](Npz &npz) { npz.set_f4("attachment", {s.bare()}, std::vector<double>(s.bare(), 2)); }), "attachment");
  contains(said([](Npz &npz) { npz.set_b1("covers", std::vector<std::uint8_t>(3, 0)); }), "covers");
  EXPECT_THROW(read_garment(folder / "none.npz", s.actor), FileNotFound);
}

TEST(GarmentFile, OfAnotherActorIsRefusedEvenIfEmpty) {
  const TempFolder folder;
  const Scene s;
  RiggedMesh other = s.actor;
  other.mesh = testing::sphere(0.5, {0, 0, 0}, 12, 20);
  other.face_valid.assign(other.mesh.faces.rows(), 1);
  write_garment(folder / "garment.npz", s.garment);
  write_garment(folder / "empty.npz", empty_garment(s.actor));
  for (const char *name : {"garment.npz", "empty.npz"}) {
    const std::string text = testing::error_of([&] { read_garment(folder / name, other); });
    EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_NE(text.find("'covers'"), std::string::npos) << text;
  }
}

TEST(GarmentFile, WriterRefusesUnequalLengths) {
  const TempFolder folder;
  Scene s;
  s.garment.rest.conservativeResize(5, 3);
  EXPECT_THROW(write_garment(folder / "garment.npz", s.garment), std::invalid_argument);
}

} // namespace doublet
