#pragma once
// What every Objective must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/fit/minimise.h"

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

/// One sentence for each rule that the objective breaks: energies (S, R) are finite at the centre and corners of the box and in
/// between, for one sample and for several, and not all equal; a sample has the same energy in every call, whatever the other
/// samples are; samples with a wrong number of columns are refused. Calls evaluate() six times, with at most 11 samples.
inline std::vector<std::string> objective_violations(Objective &objective) {
  std::vector<std::string> broken;
  try {
    const int parts = objective.part_count(), width = parts * objective.parameter_count();
    if (parts < 1 || objective.parameter_count() < 1)
      return {"expected at least one part and one parameter, found " + std::to_string(parts) + " and " +
              std::to_string(objective.parameter_count())};
    std::mt19937 random(7);
    MatrixRM samples(11, width); // more than fit in a batch of eight
    samples.row(0).setConstant(0.5);
    samples.row(1).setZero();
    samples.row(2).setOnes();
    for (int i = 3; i < samples.rows(); ++i)
      for (int j = 0; j < width; ++j)
        samples(i, j) = random() / 4294967296.0;
    const MatrixRM energies = objective.evaluate(samples, {});
    if (energies.rows() != samples.rows() || energies.cols() != parts || !energies.allFinite())
      return {"evaluate() must return finite energies (" + std::to_string(samples.rows()) + ", " + std::to_string(parts) +
              "), found (" + std::to_string(energies.rows()) + ", " + std::to_string(energies.cols()) + ")"};
    for (int part = 0; part < parts; ++part)
      if ((energies.col(part).array() == energies(0, part)).all())
        broken.push_back("part " + std::to_string(part) + ": every sample costs the same");
    const auto costs = [&](const MatrixRM &asked, const MatrixRM &expected, const std::string &otherwise) {
      const MatrixRM found = objective.evaluate(asked, {});
      if (found.rows() != expected.rows() || found.cols() != expected.cols() || found != expected)
        broken.push_back(otherwise);
    };
    costs(samples, energies, "the same samples have other energies when they are asked about again");
    costs(samples.colwise().reverse(), energies.colwise().reverse(), "energies depend on the order of the samples");
    costs(samples.topRows(1), energies.topRows(1), "a sample alone has another energy than among others");
    const auto refused = [&](const MatrixRM &wrong, const std::string &what) {
      try {
        objective.evaluate(wrong, {});
        broken.push_back(what + " are not refused");
      } catch (const std::exception &) { // of whatever kind: Python has its own
      }
    };
    refused(MatrixRM::Constant(1, width + 1, 0.5), "samples with a parameter too many");
    refused(MatrixRM::Constant(1, width - 1, 0.5), "samples with a parameter too few");
  } catch (const std::exception &error) {
    broken.push_back(std::string("the objective threw: ") + error.what());
  }
  return broken;
}

} // namespace doublet::testing
