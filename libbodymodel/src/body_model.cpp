#include "doublet/bodymodel/body_model.h"

namespace doublet {

BodyLinearisation BodyModel::linearise(const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) const {
  const Vertices all = vertices(coefficients);
  const int n = static_cast<int>(chosen.size());
  BodyLinearisation result{Vertices(n, 3), MatrixRM(3 * n, component_count())};
  for (int i = 0; i < n; ++i)
    result.points.row(i) = all.row(chosen[i]);
  for (int k = 0; k < component_count(); ++k) {
    const Vertices direction = component(k);
    for (int i = 0; i < n; ++i)
      result.jacobian.block<3, 1>(3 * i, k) = direction.row(chosen[i]).transpose();
  }
  return result;
}

BodyLinearisation BodyModel::joints(const Eigen::VectorXd &) const {
  return {Vertices(0, 3), MatrixRM(0, component_count())};
}

} // namespace doublet
