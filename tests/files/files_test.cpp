#include "doublet/files/files.h"

#include "doublet/core/error.h"
#include "doublet/files/npz.h"
#include "support/error_of.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <limits>

namespace doublet {

namespace {

using testing::error_of;
using testing::TempFolder;

int files_in(const TempFolder &folder) {
  return static_cast<int>(
      std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()));
}

} // namespace

/// While it lives no file may grow beyond so many bytes: what a full disk is to a writer.
class SmallDisk {
public:
  explicit SmallDisk(rlim_t bytes) : ignored_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  SmallDisk(const SmallDisk &) = delete;
  SmallDisk &operator=(const SmallDisk &) = delete;
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, ignored_);
  }

private:
  sighandler_t ignored_;
  rlimit before_{};
};

TEST(Files, AFullDiskIsAnErrorThatNamesTheFileAndLeavesTheOldOne) {
  const TempFolder folder;
  Npz npz;
  std::vector<double> noise(20000);
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = std::sin(1e5 * static_cast<double>(i * i));
  npz.set_f8("noise", {20000}, noise);
  write_text(folder / "a.txt", "old");
  write_text(folder / "a.npz", "old");
  const SmallDisk small(4096);
  const std::string text = error_of([&] { write_text(folder / "a.txt", std::string(100000, 'x')); });
  EXPECT_NE(text.find("a.txt: cannot be written: File too large"), std::string::npos) << text;
  const std::string archive = error_of([&] { npz.write(folder / "a.npz"); });
  EXPECT_NE(archive.find("a.npz: cannot be written: "), std::string::npos) << archive;
  EXPECT_EQ(read_text(folder / "a.txt") + read_text(folder / "a.npz"), "oldold");
  EXPECT_EQ(files_in(folder), 2);
}

TEST(Files, DevicesAndFoldersAreNotReplaced) {
  const TempFolder folder;
  EXPECT_NE(error_of([] { write_text("/dev/full", "x"); }).find("a device"), std::string::npos);
  EXPECT_NE(error_of([&] { write_text(folder.path(), "x"); }).find("a folder"), std::string::npos);
  EXPECT_NE(error_of([&] { write_text(folder / "a.txt/b.txt", "x"), write_text(folder / "a.txt/b.txt/c", "x"); }).find("folder"),
            std::string::npos);
}

TEST(Files, WritesAreCompleteOrNotThere) {
  const TempFolder folder;
  write_text(folder / "deep/er/a.txt", "one");
  write_text(folder / "a.txt", "old");
  EXPECT_THROW(write_atomically(folder / "a.txt",
                                [](const Path &temporary) {
                                  EXPECT_EQ(temporary.extension(), ".txt");
                                  std::ofstream(temporary) << "half";
                                  throw Error("no more");
                                }),
               Error);
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  EXPECT_EQ(files_in(folder), 2); // a.txt and deep: nothing is left behind
  write_text(folder / "a.txt", "new");
  EXPECT_EQ(read_text(folder / "a.txt"), "new");
  EXPECT_THROW(read_text(folder / "b.txt"), FileNotFound);
  EXPECT_THROW(read_text(folder.path()), Error);
  EXPECT_THROW(write_text(folder / "a.txt/b.txt", "x"), Error);
  EXPECT_THROW(write_text("/proc/none/x.txt", "x"), Error);
}

TEST(Files, ALinkStaysAndTheFileBehindItIsWritten) {
  const TempFolder folder;
  write_text(folder / "disk/blob", "old");
  std::filesystem::create_symlink("disk/blob", folder / "inner");
  std::filesystem::create_symlink("inner", folder / "a.txt");
  std::filesystem::create_symlink("disk/new/b.txt", folder / "b.txt"); // leads to nothing as yet
  write_atomically(folder / "a.txt", [&](const Path &temporary) {
    EXPECT_EQ(temporary.extension(), ".txt");
    EXPECT_EQ(temporary.parent_path(), folder / "disk"); // a rename stays on one disk
    std::ofstream(temporary) << "new";
  });
  write_text(folder / "b.txt", "first");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "a.txt") && std::filesystem::is_symlink(folder / "inner"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "b.txt"));
  EXPECT_EQ(read_text(folder / "disk/blob") + read_text(folder / "disk/new/b.txt"), "newfirst");

  std::filesystem::create_symlink("there", folder / "here");
  std::filesystem::create_symlink("here", folder / "there");
  EXPECT_NE(error_of([&] { write_text(folder / "here", "x"); }).find("here: expected a file to write, found links"),
            std::string::npos);
}

TEST(Files, ActorRoundTrip) {
  const TempFolder folder;
  RiggedMesh actor = testing::figure_actor(0.06);
  actor.face_valid[3] = 0;
  write_actor(folder / "actor.npz", actor);
  const RiggedMesh read = read_actor(folder / "actor.npz");
  EXPECT_TRUE(read.mesh.vertices.isApprox(actor.mesh.vertices, 1e-6));
  EXPECT_EQ(read.mesh.faces, actor.mesh.faces);
  EXPECT_EQ(read.face_valid, actor.face_valid);
  EXPECT_LT((read.weights - actor.weights).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((read.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(read.skeleton.dof_names, actor.skeleton.dof_names);
  for (int j = 0; j < actor.skeleton.joint_count(); ++j) {
    const Joint &a = actor.skeleton.joints[j], &b = read.skeleton.joints[j];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.first_dof, b.first_dof);
    ASSERT_EQ(a.axes.size(), b.axes.size());
    for (std::size_t k = 0; k < a.axes.size(); ++k)
      EXPECT_LT((a.axes[k] - b.axes[k]).norm(), 1e-5) << a.name;
  }
  write_actor(folder / "again.npz", read); // written, read and written again: the same, but for the weights' last bit
  for (const auto &[name, array] : Npz::read(folder / "again.npz").arrays) {
    if (name != "weights") {
      EXPECT_TRUE(array.bytes == Npz::read(folder / "actor.npz").arrays.at(name).bytes) << name;
    }
  }
}

TEST(Files, SayTheirFormatAndRefuseANewerOne) {
  const TempFolder folder;
  const RiggedMesh actor = testing::figure_actor(0.08);
  write_actor(folder / "actor.npz", actor);
  Npz npz = Npz::read(folder / "actor.npz");
  ASSERT_TRUE(npz.has("format"));
  EXPECT_EQ(npz.integers("format"), std::vector<int>{kFileFormat});
  npz.arrays.erase("format");
  npz.write(folder / "before.npz"); // files of before had no number
  EXPECT_NO_THROW(read_actor(folder / "before.npz"));
  for (const int format : {0, kFileFormat + 1}) {
    npz.set_i4("format", {1}, {format});
    npz.write(folder / "other.npz");
    const std::string error = error_of([&] { read_actor(folder / "other.npz"); });
    EXPECT_NE(error.find("other.npz: expected format 1, found " + std::to_string(format)), std::string::npos) << error;
    EXPECT_EQ(error.find("newer version of doublet") != std::string::npos, format > kFileFormat) << error;
  }
  write_text(folder / "proxies.json", R"({"format": 2, "capsules": []})");
  EXPECT_THROW(read_proxies(folder / "proxies.json", actor.skeleton), Error);
  write_text(folder / "proxies.json", R"({"capsules": []})");
  EXPECT_TRUE(read_proxies(folder / "proxies.json", actor.skeleton).empty());
}

TEST(Files, ActorRefusesInconsistentContent) {
  const TempFolder folder;
  const RiggedMesh actor = testing::figure_actor(0.08);
  write_actor(folder / "actor.npz", actor);
  const auto changed = [&](const std::function<void(Npz &)> &change) {
    Npz npz = Npz::read(folder / "actor.npz");
    change(npz);
    npz.write(folder / "changed.npz");
    return error_of([&] { read_actor(folder / "changed.npz"); });
  };
  EXPECT_EQ(changed([](Npz &) {}), "");
  EXPECT_NE(changed([](Npz &n) { n.arrays.erase("faces"); }).find("changed.npz: expected an array 'faces'"), std::string::npos);
  EXPECT_NE(changed([](Npz &n) { n.set_i4("faces", {1, 3}, {0, 1, 99999999}); }).find("out of range"), std::string::npos);
  EXPECT_NE(changed([](Npz &n) { n.set_b1("face_valid", {1}); }).find("'face_valid': expected shape"), std::string::npos);
  EXPECT_NE(changed([&](Npz &n) {
              n.set_f4("weights", n.shape("weights"), std::vector<double>(actor.weights.size(), 0.5));
            }).find("'weights'"),
            std::string::npos);
  EXPECT_NE(changed([](Npz &n) { n.set_text("dof_names", {"pelvis.tx"}); }).find("'dof_names'"), std::string::npos);
  EXPECT_NE(changed([](Npz &n) {
              std::vector<std::string> names = n.text("dof_names");
              names[7] = "tail.x";
              n.set_text("dof_names", names);
            }).find("'dof_names'"),
            std::string::npos);
  EXPECT_NE(changed([](Npz &n) {
              std::vector<int> parents = n.integers("joint_parents");
              parents[1] = 5;
              n.set_i4("joint_parents", {24}, parents);
            }).find("'joint_parents'"),
            std::string::npos);
  RiggedMesh broken = actor;
  broken.weights.conservativeResize(3, 3);
  EXPECT_THROW(write_actor(folder / "x.npz", broken), std::invalid_argument);
  EXPECT_THROW(read_actor(folder / "none.npz"), FileNotFound);
}

TEST(Files, PerformanceRoundTrip) {
  const TempFolder folder;
  const RiggedMesh actor = testing::figure_actor(0.08);
  ReferencePerformance p;
  p.surface.faces = actor.mesh.faces;
  p.dofs = MatrixRM::Random(3, 36);
  p.frames = {4, 5, 7};
  for (int t = 0; t < 3; ++t) {
    p.surface.frames.push_back(actor.mesh.vertices.array() + t);
    p.joints.push_back(joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, p.dofs.row(t))));
  }
  write_performance(folder / "performance.npz", p);
  const ReferencePerformance q = read_performance(folder / "performance.npz", actor);
  EXPECT_EQ(q.frames, p.frames);
  EXPECT_TRUE(q.dofs.isApprox(p.dofs, 1e-6));
  EXPECT_EQ(q.surface.faces, actor.mesh.faces);
  for (int t = 0; t < 3; ++t) {
    EXPECT_TRUE(q.surface.frames[t].isApprox(p.surface.frames[t], 1e-6));
    EXPECT_TRUE(q.joints[t].isApprox(p.joints[t], 1e-6));
  }
  const RiggedMesh other = testing::figure_actor(0.09);
  EXPECT_NE(error_of([&] { read_performance(folder / "performance.npz", other); }).find("array 'vertices': expected shape"),
            std::string::npos);
  p.frames.pop_back();
  EXPECT_THROW(write_performance(folder / "x.npz", p), std::invalid_argument);
}

TEST(Files, SegmentationAndBodyRoundTrip) {
  const TempFolder folder;
  Segmentation c;
  c.sigma = Eigen::Vector4d(0.001, std::numeric_limits<double>::quiet_NaN(), 0.02, 0.03);
  c.clothness = Eigen::Vector4d(0, 0, 0.5, 1);
  c.region = Eigen::Vector4i(-1, -1, 1, 0);
  c.region_count = 2;
  write_segmentation(folder / "segmentation.npz", c);
  const Segmentation d = read_segmentation(folder / "segmentation.npz");
  EXPECT_TRUE(std::isnan(d.sigma[1]));
  EXPECT_NEAR(d.sigma[3], 0.03, 1e-8);
  EXPECT_EQ(d.clothness, c.clothness);
  EXPECT_EQ(d.region, c.region);
  EXPECT_EQ(d.region_count, 2);
  Npz npz = Npz::read(folder / "segmentation.npz");
  npz.set_f4("clothness", {4}, {1.5, 0, 0.5, 1});
  npz.write(folder / "segmentation.npz");
  EXPECT_THROW(read_segmentation(folder / "segmentation.npz"), Error);
  c.clothness[0] = 1.5;
  EXPECT_THROW(write_segmentation(folder / "segmentation.npz", c), Error);

  BodyFit fit{testing::sphere(1), Eigen::VectorXd::Random(7), "pca-2024 \xE2\x80\x93 abc", 0.004};
  fit.deviation = Eigen::VectorXd::Constant(fit.body.vertices.rows(), 0.01);
  write_body(folder / "body.npz", fit);
  const BodyFit back = read_body(folder / "body.npz");
  EXPECT_EQ(back.model, fit.model);
  EXPECT_NEAR(back.residual, 0.004, 1e-9);
  EXPECT_TRUE(back.deviation.isApprox(fit.deviation, 1e-6));
  EXPECT_TRUE(back.coefficients.isApprox(fit.coefficients, 1e-6));
  EXPECT_TRUE(back.body.vertices.isApprox(fit.body.vertices, 1e-6));
}

TEST(Files, ProxiesRoundTripAndNameWhatIsWrong) {
  const TempFolder folder;
  const Skeleton s = testing::figure_skeleton();
  const std::vector<TaperedCapsule> capsules = testing::figure_capsules(s);
  write_proxies(folder / "proxies.json", capsules, s);
  const std::vector<TaperedCapsule> read = read_proxies(folder / "proxies.json", s);
  ASSERT_EQ(read.size(), capsules.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].joint, capsules[i].joint);
    EXPECT_EQ(read[i].p0, capsules[i].p0);
    EXPECT_EQ(read[i].p1, capsules[i].p1);
    EXPECT_EQ(read[i].r1, capsules[i].r1);
  }
  const auto error = [&](const std::string &text) {
    write_text(folder / "bad.json", text);
    return error_of([&] { read_proxies(folder / "bad.json", s); });
  };
  EXPECT_NE(error(R"({"capsules": [{"joint": "l_tail", "p0": [0,0,0], "p1": [0,1,0], "r0": 1, "r1": 1}]})")
                .find("bad.json: capsule 0: skeleton: unknown joint 'l_tail'"),
            std::string::npos);
  EXPECT_NE(
      error(R"({"capsules": [{"joint": "head", "p0": [0,0], "p1": [0,1,0], "r0": 1, "r1": 1}]})").find("p0: expected three"),
      std::string::npos);
  EXPECT_NE(error(R"({"capsules": [{"joint": "head", "p0": [0,0,0], "p1": [0,1,0], "r0": -1, "r1": 1}]})").find("radii"),
            std::string::npos);
  EXPECT_NE(error(R"({"capsules": [{"joint": 5}]})").find("joint's name"), std::string::npos);
  EXPECT_NE(error(R"({"capsules": [7]})").find("'joint'"), std::string::npos);
  EXPECT_NE(error(R"({"capsules": 7})").find("list"), std::string::npos);
  EXPECT_NE(error("[]").find("'capsules'"), std::string::npos);
  EXPECT_NE(error(R"({"capsules": [)").find("JSON"), std::string::npos);
}

TEST(Files, ObservationsRoundTrip) {
  const TempFolder folder;
  Observations o;
  o.cameras = testing::camera_ring(2);
  o.cameras[1].distortion << -0.1, 0.02, 1e-3, 2e-3, 0.5;
  o.frames = {0, 1, 3};
  o.views.assign(3, std::vector<ViewObservation>(2));
  o.views[0][1].contour = {{1.5f, 2}, {3, 4}};
  o.views[2][0].contour = {{5, 6.25f}};
  o.views[2][1].matches = {{{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}};
  write_observations(folder / "observations.npz", o);
  const Observations p = read_observations(folder / "observations.npz");
  EXPECT_EQ(p.frames, o.frames);
  ASSERT_EQ(p.cameras.size(), 2u);
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(p.cameras[c].name, o.cameras[c].name);
    EXPECT_EQ(p.cameras[c].K, o.cameras[c].K);
    EXPECT_EQ(p.cameras[c].R, o.cameras[c].R);
    EXPECT_EQ(p.cameras[c].t, o.cameras[c].t);
    EXPECT_EQ(p.cameras[c].distortion, o.cameras[c].distortion);
    EXPECT_EQ(p.cameras[c].width, o.cameras[c].width);
    for (int t = 0; t < 3; ++t) {
      EXPECT_EQ(p.views[t][c].contour, o.views[t][c].contour);
      ASSERT_EQ(p.views[t][c].matches.size(), o.views[t][c].matches.size());
      for (std::size_t k = 0; k < p.views[t][c].matches.size(); ++k) {
        EXPECT_EQ(p.views[t][c].matches[k].previous, o.views[t][c].matches[k].previous);
        EXPECT_EQ(p.views[t][c].matches[k].current, o.views[t][c].matches[k].current);
      }
    }
  }
  Npz npz = Npz::read(folder / "observations.npz");
  npz.set_i4("match_offsets", {7}, {0, 0, 0, 9, 0, 0, 2});
  npz.write(folder / "bad.npz");
  EXPECT_NE(error_of([&] { read_observations(folder / "bad.npz"); }).find("match_offsets"), std::string::npos);
  o.views.pop_back();
  EXPECT_THROW(write_observations(folder / "x.npz", o), std::invalid_argument);
}

} // namespace doublet
