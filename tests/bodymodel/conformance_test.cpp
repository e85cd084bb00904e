#include "doublet/testing/body_model_conformance.h"

#include <cmath>
#include <gtest/gtest.h>

namespace doublet {
namespace {

/// A triangle that grows with its first coefficient and, bent, no longer in a straight line with its second.
class Growing : public BodyModel {
public:
  explicit Growing(double bend) : bend_(bend) {}
  int vertex_count() const override { return 3; }
  int component_count() const override { return 2; }
  const Faces &faces() const override { return faces_; }
  Vertices vertices(const Eigen::VectorXd &c) const override {
    if (c.size() != 2 && bend_ == 0)
      throw std::invalid_argument("two coefficients");
    return Vertices::Constant(3, 3, 5 + bend_ * c[1] * c[1]) + c[0] * component(0) + c[1] * component(1);
  }
  Vertices component(int k) const override { return (k + 1.0) * Vertices::Identity(3, 3); }
  const std::map<std::string, int> &landmarks() const override { return landmarks_; }
  std::string name() const override { return "growing"; }

private:
  double bend_;
  Faces faces_ = (Faces(1, 3) << 0, 1, 2).finished();
  std::map<std::string, int> landmarks_{{"top", 2}};
};

TEST(Conformance, ALinearModelConforms) {
  for (const std::string &broken : testing::body_model_violations(Growing(0)))
    ADD_FAILURE() << broken;
}

/// One that bends, but leaves linearise() to its components, and takes any number of coefficients.
TEST(Conformance, TheKitCatchesAWrongJacobian) {
  const std::vector<std::string> broken = testing::body_model_violations(Growing(0.1));
  ASSERT_EQ(broken.size(), 2u);
  EXPECT_NE(broken[0].find("jacobian of linearise()"), std::string::npos) << broken[0];
  EXPECT_NE(broken[1].find("wrong number of coefficients"), std::string::npos) << broken[1];
}

} // namespace
} // namespace doublet
