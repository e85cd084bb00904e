#include "doublet/reconstruct/reconstruction.h"

#include "doublet/core/error.h"
#include "doublet/reconstruct/quality_checks.h"
#include "support/error_of.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

namespace doublet {

namespace {

using testing::error_of;
using testing::TempFolder;

/// A stage that writes `output`, and counts how often it ran.
Stage writer(const std::string &name, const std::vector<std::string> &reads, const std::string &output, int &count) {
  return {.name = name, .reads = reads, .writes = {output}, .needs_scan = false, .run = [&count, output](Reconstruction &self) {
            ++count;
            write_text(self.path(output), output + std::to_string(self.options.capture.pose.iterations));
            return std::string("{}");
          }};
}

} // namespace

/// Two stages of which the second reads what the first writes.
class TwoStages : public ::testing::Test {
protected:
  TempFolder folder;
  int first = 0, second = 0;
  std::vector<std::string> said;

  std::unique_ptr<Reconstruction> make(ReconstructionOptions options = {}) {
    auto made = std::make_unique<Reconstruction>(folder.path() / "session", folder.path() / "out", options);
    Session session;
    session.folder = folder.path() / "session";
    session.fps = 40;
    made->set_session(session);
    made->announce = [this](const std::string &line) { said.push_back(line); };
    made->stages = {writer("one", {}, "a.txt", first), writer("two", {"a.txt"}, "b.txt", second)};
    made->stages[0].option_groups = {"pose"};
    return made;
  }
};

TEST_F(TwoStages, RunOnceAndAgainWhatAnOptionChanges) {
  EXPECT_TRUE(make()->run({"one", "two"}));
  EXPECT_FALSE(make()->run({"one", "two"}));
  EXPECT_EQ(std::pair(first, second), std::pair(1, 1));
  EXPECT_EQ(said.back(), "two: up to date");
  ReconstructionOptions options;
  options.capture.pose.iterations += 1;
  EXPECT_TRUE(make(options)->run({"one", "two"}));
  EXPECT_EQ(std::pair(first, second), std::pair(2, 2)) << "its file changed, and with it what the second stage reads";
  options.capture.limbs.annealing.seed += 1;
  options.texture.size *= 2;
  EXPECT_FALSE(make(options)->run({"one", "two"})) << "of other groups";
}

TEST_F(TwoStages, OtherFramesOfTheSameFilesAreAnotherTake) {
  const Path session = folder.path() / "session";
  std::vector<SessionCamera> cameras(2);
  for (SessionCamera &camera : cameras) {
    camera.name = &camera == &cameras[0] ? "left" : "right";
    camera.video = session / (camera.name + ".mp4");
    write_text(camera.video, camera.name);
  }
  const auto runs = [&](std::vector<SessionCamera> filmed, int frames) {
    auto made = make();
    Session changed = made->session();
    changed.cameras = std::move(filmed);
    changed.frame_count = frames;
    made->set_session(changed);
    made->stages[0].session_inputs = {"images"};
    return made->run({"one"});
  };
  EXPECT_TRUE(runs(cameras, 9));
  EXPECT_FALSE(runs(cameras, 9));
  EXPECT_TRUE(runs(cameras, 8));
  auto later = cameras;
  later[1].first_frame = 3;
  EXPECT_TRUE(runs(later, 8));
  EXPECT_NE(said[said.size() - 2].find("option session.right changed"), std::string::npos) << said[said.size() - 2];
  std::swap(later[0].video, later[1].video);
  EXPECT_TRUE(runs(later, 8));
  EXPECT_FALSE(runs(later, 8));
}

TEST_F(TwoStages, TheRateThatIsAskedForCounts) {
  const auto runs = [&](double fps) {
    ReconstructionOptions options;
    options.fps = fps;
    auto made = make(options);
    made->stages[0].option_groups = {"energy"};
    return made->run({"one"});
  };
  EXPECT_TRUE(runs(0));
  EXPECT_FALSE(runs(40)) << "as the session says";
  EXPECT_TRUE(runs(50));
  EXPECT_FALSE(runs(50));
}

TEST_F(TwoStages, WhatWasFoundOfAFileDoesNotCountForAnotherInItsPlace) {
  auto made = make();
  made->replace(
      "one",
      [](Reconstruction &self) {
        write_text(self.path("a.txt"), "a");
        return std::string(R"({"findings": [{"impossible": true, "text": "a head of cloth", "kind": "cloth_ends"}]})");
      },
      "");
  EXPECT_THROW(made->run({"one"}), Implausible);
  write_text(folder.path() / "out" / "a.txt", "by hand");
  EXPECT_TRUE(made->run({"one", "two"}));
  EXPECT_EQ(std::pair(made->findings().size(), second), std::pair(std::size_t{0}, 1));
}

TEST_F(TwoStages, AFileMadeElsewhereIsKept) {
  make()->run({"one"});
  write_text(folder.path() / "out" / "a.txt", "by hand");
  EXPECT_TRUE(make()->run({"one", "two"}));
  EXPECT_EQ(std::pair(first, second), std::pair(1, 1));
  EXPECT_NE(said[said.size() - 3].find("one: kept, a.txt was not written by this program"), std::string::npos);
  EXPECT_TRUE(make()->run({"one"}, true));
  EXPECT_EQ(first, 2);
}

TEST_F(TwoStages, WhatWasReadIsReadAgainFromAFileMadeElsewhere) {
  const auto write = [](const Path &path, int vertices) {
    RiggedMesh actor;
    actor.mesh.vertices.resize(vertices, 3);
    actor.mesh.faces.resize(vertices - 2, 3);
    for (int v = 0; v < vertices; ++v)
      actor.mesh.vertices.row(v) << v, v * v, 0;
    for (int f = 0; f < vertices - 2; ++f)
      actor.mesh.faces.row(f) << 0, f + 1, f + 2;
    actor.face_valid.assign(actor.mesh.faces.rows(), 1);
    actor.skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, 6}});
    actor.weights = MatrixRM::Ones(vertices, 1);
    write_actor(path, actor);
  };
  const Stage count{.name = "count", .reads = {"actor.npz"}, .needs_scan = false, .run = [](Reconstruction &self) {
                      return "{\"vertices\":" + std::to_string(self.results().actor().mesh.vertices.rows()) + "}";
                    }};
  auto made = make();
  made->stages = {count};
  for (const int vertices : {3, 30}) {
    write(made->path("actor.npz"), vertices);
    EXPECT_TRUE(made->run({"count"}));
    EXPECT_EQ(made->record().summary("count"), "{\"vertices\":" + std::to_string(vertices) + "}");
    EXPECT_EQ(made->results().actor().mesh.vertices.rows(), vertices) << "somebody looks at it";
  }
}

TEST_F(TwoStages, AMissingInputNamesTheStageThatWritesIt) {
  EXPECT_NE(error_of([&] { make()->run({"two"}); }).find("a.txt is missing; stage 'one' writes it"), std::string::npos);
  EXPECT_THROW(make()->run({"three"}), std::invalid_argument);
}

TEST_F(TwoStages, AFileMadeElsewhereIsNotWrittenOverForOneThatIsMissing) {
  auto made = make();
  made->stages[0].writes.push_back("more.txt");
  made->stages[0].run = [](Reconstruction &self) {
    write_text(self.path("a.txt"), "a");
    write_text(self.path("more.txt"), "more");
    return std::string("{}");
  };
  write_text(made->path("a.txt"), "by hand");
  const std::string expected =
      "a.txt was not written by this program, and more.txt, which stage 'one' writes beside it, is missing";
  EXPECT_NE(error_of([&] { made->run({"one"}); }).find(expected), std::string::npos);
  EXPECT_EQ(read_text(made->path("a.txt")), "by hand");
  EXPECT_TRUE(made->run({"one"}, true));
  std::filesystem::remove(made->path("more.txt"));
  EXPECT_TRUE(made->run({"one"})) << "what is left is its own";
  std::filesystem::remove(made->path("more.txt"));
  write_text(made->path("a.txt"), "by hand once more");
  EXPECT_NE(error_of([&] { made->run({"one"}); }).find(expected), std::string::npos);
  write_text(made->path("more.txt"), "by hand, too");
  EXPECT_FALSE(made->run({"one"}));
}

TEST_F(TwoStages, AStageOfOnesOwnIsNotTakenForOurs) {
  make()->run({"one", "two"});
  auto other = make();
  other->replace(
      "two",
      [](Reconstruction &self) {
        write_text(self.path("b.txt"), "mine");
        return std::string(R"({"number": 5})");
      },
      "my_stage");
  EXPECT_TRUE(other->run({"two"}));
  EXPECT_FALSE(other->run({"two"}));
  EXPECT_EQ(other->record().summary("two"), R"({"number":5})");
  EXPECT_TRUE(make()->run({"two"})) << "the results of theirs are not ours";
  EXPECT_NE(said[said.size() - 2].find("option run changed from my_stage to none"), std::string::npos);
  EXPECT_THROW(other->replace("three", {}, ""), std::invalid_argument);
}

TEST_F(TwoStages, AResultThatCannotBeTrueStops) {
  const auto impossible = [](Reconstruction &self) {
    write_text(self.path("a.txt"), "a");
    return std::string(R"({"findings": [{"impossible": true, "text": "a head of cloth", "kind": "cloth_ends"}]})");
  };
  auto strict = make();
  strict->replace("one", impossible, "");
  EXPECT_THROW(strict->run({"one", "two"}), Implausible);
  EXPECT_TRUE(std::filesystem::exists(strict->path("a.txt")));
  EXPECT_EQ(second, 0);
  EXPECT_THROW(strict->run({"one"}), Implausible) << "nor when it is up to date";
  ReconstructionOptions options;
  options.keep_going = true;
  auto lenient = make(options);
  lenient->replace("one", impossible, "");
  lenient->run({"one", "two"});
  ASSERT_EQ(lenient->findings().size(), 1u);
  EXPECT_EQ(lenient->findings()[0].kind, "cloth_ends");
  EXPECT_EQ(second, 1);
}

TEST_F(TwoStages, WhatThrowsIsRecordedAsStopped) {
  auto broken = make();
  broken->replace(
      "one", [](Reconstruction &) -> std::string { throw Cancelled(); }, "");
  EXPECT_THROW(broken->run({"one"}), Cancelled);
  said.clear();
  EXPECT_TRUE(make()->run({"one"}));
  EXPECT_EQ(said[0], "one: running (the last run was stopped here)");
}

TEST_F(TwoStages, WhatIsWrittenElsewhereAfterAStageWasStoppedIsKept) {
  auto stopped = make();
  stopped->replace(
      "one", [](Reconstruction &) -> std::string { throw Cancelled(); }, "");
  EXPECT_THROW(stopped->run({"one"}), Cancelled);
  write_text(folder.path() / "out" / "a.txt", "by hand");
  EXPECT_TRUE(make()->run({"one", "two"}));
  EXPECT_EQ(std::pair(first, second), std::pair(0, 1));
  EXPECT_EQ(read_text(folder.path() / "out" / "a.txt"), "by hand");
}

TEST_F(TwoStages, AnotherSessionIsRefused) {
  std::filesystem::create_directories(folder.path() / "session");
  write_text(folder.path() / "session" / "session.json", "{}");
  auto made = make();
  made->stages[0].session_inputs = {"description"};
  made->run({"one"});
  std::filesystem::copy(folder.path() / "session", folder.path() / "moved");
  auto again = [&](const char *name) {
    auto other = make();
    other->stages[0].session_inputs = {"description"};
    Session session = other->session();
    session.folder = folder.path() / name;
    other->set_session(session);
    return other->run({"one"});
  };
  EXPECT_FALSE(again("moved")) << "the same files in another place";
  std::filesystem::create_directories(folder.path() / "another");
  write_text(folder.path() / "another" / "session.json", "{\"name\": 1}");
  EXPECT_NE(error_of([&] { again("another"); }).find("choose another folder"), std::string::npos);
}

TEST_F(TwoStages, ATakeCountsOnceInAFitOfSeveral) {
  const auto one = make(), same = make();
  EXPECT_THROW(fit_together({one.get(), same.get()}), std::invalid_argument);
}

TEST_F(TwoStages, TakesOfOtherRatesAreNotFittedTogether) {
  const auto one = make();
  Reconstruction faster(folder.path() / "session", folder.path() / "faster");
  Session session = one->session();
  session.fps = 50;
  faster.set_session(session);
  try {
    fit_together({one.get(), &faster});
    FAIL();
  } catch (const std::invalid_argument &error) {
    EXPECT_NE(std::string(error.what()).find("faster: solver setting dt: expected 0.025, found 0.02"), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "faster"));
}

TEST_F(TwoStages, FindingsAreThoseOfTheLastRun) {
  auto made = make();
  std::string findings = R"({"findings": [{"impossible": false, "text": "a hat of cloth", "kind": "cloth_ends"}]})";
  made->replace(
      "one",
      [&](Reconstruction &self) {
        write_text(self.path("a.txt"), "a");
        return findings;
      },
      "");
  for (const bool force : {true, false}) {
    made->run({"one"}, force);
    EXPECT_EQ(made->findings().size(), 1u);
  }
  findings = "{}";
  made->run({"one"}, true);
  EXPECT_TRUE(made->findings().empty());
}

TEST_F(TwoStages, ValuesOfTheSessionCountWhereTheyAreAskedFor) {
  const auto runs = [&](const std::string &name, bool scan_from_views) {
    auto made = make();
    Session session = made->session();
    session.name = name;
    session.scan_from_views = scan_from_views;
    made->set_session(session);
    made->stages[0].session_inputs = {"name"};
    made->stages[1].session_inputs = {"scan_from_views"};
    const std::pair before(first, second);
    made->run({"one", "two"});
    return std::pair(first - before.first, second - before.second);
  };
  EXPECT_EQ(runs("dance", false), std::pair(1, 1));
  EXPECT_EQ(runs("walk", false), std::pair(1, 0));
  EXPECT_EQ(runs("walk", true), std::pair(0, 1));
  EXPECT_EQ(runs("walk", true), std::pair(0, 0));
}

TEST_F(TwoStages, WhatIsLoggedIsInAFile) {
  auto made = make();
  made->replace(
      "one",
      [](Reconstruction &self) {
        self.context().log_line("one: half way");
        write_text(self.path("a.txt"), "a");
        return std::string("{}");
      },
      "");
  made->context().log_line("before the folder is there");
  made->run({"one"});
  EXPECT_EQ(read_text(folder.path() / "out" / "log.txt"), "== one\none: half way\n");
}

TEST(Stages, EachReadsWhatOneBeforeItWrites) {
  std::set<std::string> written, groups;
  const ReconstructionOptions options;
  for_each_group(options, [&](const char *name, const auto &) { groups.insert(name); });
  for (const Stage &stage : default_stages()) {
    for (const std::string &name : stage.reads)
      EXPECT_TRUE(written.count(name)) << stage.name << " reads " << name;
    for (const std::string &group : stage.option_groups)
      EXPECT_TRUE(groups.count(group)) << stage.name << " has options of " << group;
    written.insert(stage.writes.begin(), stage.writes.end());
  }
}

TEST(QualityChecks, NumbersBeyondTheirLimitsAreFound) {
  for (const Limit &limit : quality_limits()) {
    const double step = limit.impossible < limit.doubtful ? -1e-3 : 1e-3;
    EXPECT_FALSE(limit.check(limit.doubtful));
    EXPECT_NE(limit.passed(limit.doubtful), "");
    const auto doubtful = limit.check(limit.doubtful + step);
    ASSERT_TRUE(doubtful) << limit.number;
    EXPECT_FALSE(doubtful->impossible);
    EXPECT_EQ(doubtful->kind, limit.number);
    if (std::isfinite(limit.impossible)) {
      EXPECT_TRUE(limit.check(limit.impossible + step)->impossible);
    }
  }
  EXPECT_TRUE(quality_findings("body", "{}").empty());
  EXPECT_EQ(quality_findings("body", R"({"residual_mm": 21})").size(), 1u);
  EXPECT_TRUE(quality_findings("fit", R"({"residual_mm": 21})").empty());
  EXPECT_THROW(quality_findings("body", R"({"residual_mm": "far"})"), Error);
}

} // namespace doublet
