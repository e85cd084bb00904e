#include "doublet/testing/cloth_segmenter_conformance.h"

#include <gtest/gtest.h>

namespace doublet {
namespace {

TEST(Conformance, OurSegmenterConforms) {
  const auto segmenter = ClothSegmenter::create();
  for (const std::string &broken : testing::cloth_segmenter_violations(*segmenter))
    ADD_FAILURE() << broken;
  const MeshSequence column = testing::detail::swaying_column();
  const Segmentation found = segmenter->segment({column, std::vector<std::uint8_t>(column.faces.rows(), 1)}, {});
  EXPECT_GE(found.region_count, 1); // the rules were tried on cloth
}

/// Calls everything cloth, counts its calls, takes anything.
class Careless : public ClothSegmenter {
public:
  Segmentation segment(const SegmentInputs &inputs, const Context &) const override {
    const Eigen::Index n = inputs.surface.frames[0].rows();
    return {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Constant(n, 1.5 / ++calls_), Eigen::VectorXi::Constant(n, -1), 1};
  }

private:
  mutable int calls_ = 0;
};

TEST(Conformance, TheKitCatchesACarelessSegmenter) {
  EXPECT_EQ(testing::cloth_segmenter_violations(Careless()).size(), 6u); // range, regions, swaying, rigid, bits, refusal
}

/// Ours, but a second answer is of one vertex.
class Forgetful : public ClothSegmenter {
public:
  Segmentation segment(const SegmentInputs &inputs, const Context &context) const override {
    Segmentation found = ClothSegmenter::create()->segment(inputs, context);
    if (++calls_ == 2) {
      found.clothness.conservativeResize(1);
      found.region.conservativeResize(1);
    }
    return found;
  }

private:
  mutable int calls_ = 0;
};

TEST(Conformance, TheKitCatchesASecondAnswerOfAnotherSize) {
  EXPECT_EQ(testing::cloth_segmenter_violations(Forgetful()), std::vector<std::string>{"a second call gives other bits"});
}

/// Nothing is cloth.
class Blind : public ClothSegmenter {
public:
  Segmentation segment(const SegmentInputs &inputs, const Context &) const override {
    if (inputs.surface.frames.size() < 2)
      throw std::invalid_argument("one frame");
    const Eigen::Index n = inputs.surface.frames[0].rows();
    return {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXi::Constant(n, -1), 0};
  }
};

TEST(Conformance, TheKitCatchesABlindSegmenter) {
  EXPECT_EQ(testing::cloth_segmenter_violations(Blind()),
            std::vector<std::string>{"what sways is no more cloth than what stands still"});
}

} // namespace
} // namespace doublet
