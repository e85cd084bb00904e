#pragma once
// What the motion tells about each parameter: how much the energy changes when one moves alone, beside how much it changes
// anyway.

#include "doublet/fit/minimise.h"

#include <vector>

namespace doublet {

/// Around one part's answer. One-at-a-time screening as in Morris, "Factorial sampling plans for preliminary computational
/// experiments", Technometrics 33(2), 1991, with the steps around the answer instead of all over the box.
struct Influence {
  /// (n) root mean square change of the energy over four evenly spread values of this parameter, in the 0.4 of the box nearest
  /// the answer, the others at the answer; energy units.
  Eigen::VectorXd change;
  /// Standard deviation of the energy among samples that are the answer for all practical purposes (0.001 of the box away, one
  /// parameter at a time): what chaos adds. From the median absolute deviation, so that one steep parameter does not count as
  /// noise.
  double noise = 0;
  std::vector<int> rank; ///< (n) 1 = changes the energy most

  /// Whether the change is beyond the noise: more than 2.5 times. Were it noise alone, the mean square of four would reach that
  /// in one of 20000 cases (chi-square with 4 degrees of freedom), in one of 60 if the noise is underestimated by 30 %.
  static constexpr double kBeyondNoise = 2.5;
  bool exceeds_noise(int parameter) const { return change[parameter] > kBeyondNoise * noise; }
};

/// answers (R, n) in [0, 1], one row a part -> R. Costs 4 n + 12 evaluations, in one call. Multiplying an energy by a number
/// multiplies change and noise by it, and leaves rank and told as they are. Throws std::invalid_argument for another size, Error
/// if an energy is not finite.
std::vector<Influence> measure_influence(Objective &objective, const MatrixRM &answers, const Context &context = {});

} // namespace doublet
