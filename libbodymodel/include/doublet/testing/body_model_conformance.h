#pragma once
// What every BodyModel must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/bodymodel/body_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

namespace detail {

/// Largest difference, m, between a jacobian and central differences of `points` (vector -> (n, 3)).
template <class Points> double jacobian_error(const MatrixRM &jacobian, const Eigen::VectorXd &at, const Points &points) {
  constexpr double kStep = 1e-5;
  double largest = 0;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    Eigen::VectorXd up = at, down = at;
    up[k] += kStep, down[k] -= kStep;
    const Vertices slope = (points(up) - points(down)) / (2 * kStep);
    largest = std::max(largest,
                       (jacobian.col(k) - Eigen::Map<const Eigen::VectorXd>(slope.data(), slope.size())).cwiseAbs().maxCoeff());
  }
  return largest;
}

} // namespace detail

/// One sentence for each rule the model breaks: counts and indices agree, vertices are finite and the same at every call,
/// components and jacobians are the derivatives of what they belong to, a wrong number of coefficients is refused.
inline std::vector<std::string> body_model_violations(const BodyModel &model) {
  constexpr double kTolerance = 1e-6; // m per standard deviation
  std::vector<std::string> broken;
  const auto expect = [&](bool holds, const std::string &otherwise) {
    if (!holds)
      broken.push_back(otherwise);
  };
  try {
    const int n = model.vertex_count(), count = model.component_count();
    const Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd bent(count);
    for (int k = 0; k < count; ++k)
      bent[k] = 0.3 * std::sin(1.0 + k);
    const Vertices vertices = model.vertices(bent);
    if (vertices.rows() != n)
      return {"expected " + std::to_string(n) + " vertices, found " + std::to_string(vertices.rows())};
    expect(vertices.allFinite(), "vertices are not finite");
    expect(vertices == model.vertices(bent), "a second call gives other vertices");
    expect(model.shape_count() >= 0 && model.shape_count() <= count, "shape_count is not in [0, component_count]");
    expect(model.faces().size() == 0 || (model.faces().minCoeff() >= 0 && model.faces().maxCoeff() < n),
           "faces have indices that are no vertices");
    for (const auto &[name, vertex] : model.landmarks())
      expect(vertex >= 0 && vertex < n, "landmark " + name + " is no vertex");

    const Eigen::MatrixXd components = [&] {
      Eigen::MatrixXd columns(3 * n, count);
      for (int k = 0; k < count; ++k)
        columns.col(k) = Eigen::Map<const Eigen::VectorXd>(model.component(k).eval().data(), 3 * n);
      return columns;
    }();
    const auto all = [&](const Eigen::VectorXd &at) { return model.vertices(at); };
    expect(detail::jacobian_error(components, mean, all) < kTolerance,
           "component() is not the derivative of vertices() at the mean");
    const std::vector<int> chosen{n - 1, 0, n / 2};
    const BodyLinearisation at = model.linearise(bent, chosen);
    const auto few = [&](const Eigen::VectorXd &c) {
      const Vertices moved = model.vertices(c);
      Vertices points(3, 3);
      for (int i = 0; i < 3; ++i)
        points.row(i) = moved.row(chosen[i]);
      return points;
    };
    expect((at.points - few(bent)).cwiseAbs().maxCoeff() < 1e-9, "the points of linearise() are not those of vertices()");
    expect(detail::jacobian_error(at.jacobian, bent, few) < kTolerance, "the jacobian of linearise() is not its derivative");
    const BodyLinearisation joints = model.joints(bent);
    expect(joints.points.rows() == static_cast<Eigen::Index>(model.joint_names().size()),
           "joints() has another number of points than joint_names() of names");
    if (joints.points.rows() > 0)
      expect(detail::jacobian_error(joints.jacobian, bent, [&](const Eigen::VectorXd &c) { return model.joints(c).points; }) <
                 kTolerance,
             "the jacobian of joints() is not its derivative");
    try {
      model.vertices(Eigen::VectorXd::Zero(count + 1));
      broken.push_back("a wrong number of coefficients is not refused");
    } catch (const std::exception &) { // of whatever kind: Python has its own
    }
  } catch (const std::exception &error) {
    broken.push_back(std::string("the model threw: ") + error.what());
  }
  return broken;
}

} // namespace doublet::testing
