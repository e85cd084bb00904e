#include "doublet/reconstruct/run_record.h"

#include "doublet/core/error.h"
#include "support/error_of.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace doublet {

namespace {

using testing::error_of;
using testing::TempFolder;

const StageBasis kBasis{{{"actor.npz", "abc"}}, R"({"segment.diffusion": 0.02})"};
const std::vector<std::string> kOutputs{"segmentation.npz"};

} // namespace

/// A folder in which the stage `segment` is done.
class RunRecordOfOneStage : public ::testing::Test {
protected:
  TempFolder folder;
  void SetUp() override {
    RunRecord record(folder.path());
    record.begin("segment", kBasis);
    write_text(folder.path() / "segmentation.npz", "result");
    record.end("segment", R"({"regions": 1, "noise_mm": 0.12345678})", kOutputs);
  }
  std::string reason(const StageBasis &basis = kBasis) const {
    return RunRecord(folder.path()).reason_to_run("segment", basis, kOutputs);
  }
};

TEST_F(RunRecordOfOneStage, IsUpToDate) {
  EXPECT_EQ(reason(), "");
  const RunRecord record(folder.path());
  EXPECT_TRUE(record.is_done("segment"));
  EXPECT_EQ(record.summary("segment"), R"({"regions":1,"noise_mm":0.123457})");
  EXPECT_EQ(record.summary("fit"), "{}");
  EXPECT_EQ(record.inputs(), kBasis.inputs);
}

TEST_F(RunRecordOfOneStage, RunsAgainAfterAnythingChanged) {
  EXPECT_EQ(reason({kBasis.inputs, R"({"segment.diffusion": 0.03})"}), "option segment.diffusion changed from 0.02 to 0.03");
  EXPECT_EQ(reason({kBasis.inputs, "{}"}), "option segment.diffusion changed from 0.02 to none");
  EXPECT_EQ(reason({kBasis.inputs, R"({"segment.diffusion": 0.02, "run": "mine"})"}), "option run changed from none to mine");
  EXPECT_EQ(reason({{{"actor.npz", "abd"}}, kBasis.options}), "actor.npz changed");
  EXPECT_EQ(reason({{{"actor.npz", "abc"}, {"more", "x"}}, kBasis.options}), "more changed");
  std::filesystem::remove(folder.path() / "segmentation.npz");
  EXPECT_EQ(reason(), "segmentation.npz is missing");
}

TEST_F(RunRecordOfOneStage, KnowsWhatOthersHaveWritten) {
  RunRecord record(folder.path());
  EXPECT_TRUE(record.foreign_outputs("segment", kOutputs).empty());
  write_text(folder.path() / "segmentation.npz", "edited by hand");
  EXPECT_EQ(record.foreign_outputs("segment", kOutputs), kOutputs);
  EXPECT_EQ(RunRecord(folder.path()).foreign_outputs("segment", kOutputs), kOutputs);
}

TEST_F(RunRecordOfOneStage, KnowsWhatAnotherCommandMakesMeanwhile) {
  RunRecord longer(folder.path());
  longer.begin("fit", kBasis);
  RunRecord shorter(folder.path());
  shorter.begin("segment", {kBasis.inputs, R"({"segment.diffusion": 0.03})"});
  write_text(folder.path() / "segmentation.npz", "another result");
  shorter.end("segment", "{}", kOutputs);
  EXPECT_TRUE(longer.foreign_outputs("segment", kOutputs).empty()) << "it is our own";
  write_text(folder.path() / "material.json", "cotton");
  longer.end("fit", "{}", {"material.json"});
  RunRecord after(folder.path());
  EXPECT_TRUE(after.is_done("fit") && after.is_done("segment"));
  EXPECT_TRUE(after.foreign_outputs("segment", kOutputs).empty());
  EXPECT_EQ(reason(), "option segment.diffusion changed from 0.03 to 0.02");
}

TEST(RunRecord, AStageThatWasStoppedRunsAgain) {
  const TempFolder folder;
  RunRecord(folder.path()).begin("segment", kBasis);
  RunRecord record(folder.path());
  EXPECT_EQ(record.reason_to_run("segment", kBasis, kOutputs), "the last run was stopped here");
  write_text(folder.path() / "segmentation.npz", "half");
  EXPECT_TRUE(record.foreign_outputs("segment", kOutputs).empty()) << "it is our own";
}

TEST(RunRecord, OfAStageThatWasStoppedItKnowsWhatOthersHaveWrittenSince) {
  const TempFolder folder;
  RunRecord stopped(folder.path());
  stopped.begin("segment", kBasis);
  write_text(folder.path() / "segmentation.npz", "half");
  stopped.stop("segment", kOutputs);
  RunRecord record(folder.path());
  EXPECT_EQ(record.reason_to_run("segment", kBasis, kOutputs), "the last run was stopped here");
  EXPECT_TRUE(record.foreign_outputs("segment", kOutputs).empty());
  write_text(folder.path() / "segmentation.npz", "made by another program");
  EXPECT_EQ(record.foreign_outputs("segment", kOutputs), kOutputs);
  record.begin("segment", kBasis);
  EXPECT_TRUE(record.foreign_outputs("segment", kOutputs).empty()) << "it runs again";
}

TEST(RunRecord, NamesABrokenFile) {
  for (const char *text : {"{", "[]", R"({"stages": 1})", R"({"session": 1, "stages": {}})", R"({"format": 7, "stages": {}})"}) {
    const TempFolder folder;
    write_text(folder.path() / "run.json", text);
    EXPECT_NE(error_of([&] { RunRecord{folder.path()}; }).find("run.json"), std::string::npos) << text;
  }
}

TEST_F(RunRecordOfOneStage, RefusesASummaryThatItCouldNotReadAgain) {
  for (const char *summary : {"null", "[1]", "\"done\"", "", "{"}) {
    RunRecord record(folder.path());
    record.begin("segment", kBasis);
    EXPECT_THROW(record.end("segment", summary, kOutputs), std::invalid_argument) << summary;
    EXPECT_EQ(reason(), "the last run was stopped here");
  }
}

TEST(RunRecord, LeavesOutEntriesThatSomethingElseWrote) {
  const TempFolder folder;
  write_text(folder.path() / "run.json", R"({"stages": {"a": 1, "b": {"state": "done"}, "c": {"state": 5},
    "d": {"state": "running", "options": {}, "inputs": {"x": 1}}, "e": {"state": "running", "options": {}, "inputs": {}}}})");
  const RunRecord record(folder.path());
  for (const char *stage : {"a", "b", "c", "d"})
    EXPECT_EQ(record.reason_to_run(stage, kBasis, {}), "first run") << stage;
  EXPECT_EQ(record.reason_to_run("e", kBasis, {}), "the last run was stopped here");
}

TEST(RunRecord, HashIsThatOfTheContent) {
  const TempFolder folder;
  RunRecord record(folder.path());
  write_text(folder.path() / "a", "abc"); // the example of FIPS 180-2
  EXPECT_EQ(record.hash(folder.path() / "a"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  std::filesystem::create_directory(folder.path() / "images");
  write_text(folder.path() / "images" / "0.png", "one");
  const std::string before = record.hash(folder.path() / "images");
  std::filesystem::rename(folder.path() / "images" / "0.png", folder.path() / "images" / "1.png");
  EXPECT_NE(record.hash(folder.path() / "images"), before) << "names count";
  EXPECT_THROW(record.hash(folder.path() / "none"), FileNotFound);
}

} // namespace doublet
