#include "doublet/capture/parts/smoothing.h"

#include <Eigen/QR>
#include <algorithm>
#include <stdexcept>
#include <string>

namespace doublet {

MatrixRM savitzky_golay_weights(int window, int order) {
  if (window < 1 || window % 2 == 0 || order < 0 || order >= window)
    throw std::invalid_argument("savitzky_golay: window must be odd and larger than order, got window " + std::to_string(window) +
                                " and order " + std::to_string(order));
  Eigen::MatrixXd powers(window, order + 1);
  for (int i = 0; i < window; ++i)
    for (int k = 0; k <= order; ++k)
      powers(i, k) = std::pow((i - window / 2) / std::max(1., window / 2.), k);
  return powers * powers.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(window, window));
}

MatrixRM savitzky_golay(const MatrixRM &samples, int window, int order) {
  const MatrixRM weights = savitzky_golay_weights(window, order);
  const int frames = static_cast<int>(samples.rows());
  if (window == 1 || frames < window)
    return samples;
  MatrixRM smooth(samples.rows(), samples.cols());
  for (int t = 0; t < frames; ++t) {
    const int start = std::clamp(t - window / 2, 0, frames - window);
    smooth.row(t) = weights.row(t - start) * samples.middleRows(start, window);
  }
  return smooth;
}

double mean_second_difference(const MatrixRM &samples, int first_column, int column_count) {
  const int frames = static_cast<int>(samples.rows());
  if (frames < 3 || column_count < 1)
    return 0;
  const MatrixRM part = samples.middleCols(first_column, column_count);
  return (part.topRows(frames - 2) - 2 * part.middleRows(1, frames - 2) + part.bottomRows(frames - 2)).cwiseAbs().mean();
}

} // namespace doublet
