#pragma once
// Exact state as JSON: nlohmann writes the shortest decimal that reads back to the same double.

#include "doublet/core/error.h"
#include "doublet/core/types.h"

#include <nlohmann/json.hpp>

namespace doublet::state {

using Json = nlohmann::json;

template <class Derived> Json to_json(const Eigen::MatrixBase<Derived> &matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      rows.push_back(matrix(row, column));
  return rows;
}

inline MatrixRM matrix(const Json &values, Eigen::Index rows, Eigen::Index columns) {
  if (static_cast<Eigen::Index>(values.size()) != rows * columns)
    throw Error("optimiser state: expected " + std::to_string(rows * columns) + " numbers, found " +
                std::to_string(values.size()));
  MatrixRM result(rows, columns);
  for (Eigen::Index i = 0; i < rows * columns; ++i)
    result.data()[i] = values[i].get<double>();
  return result;
}

inline Eigen::VectorXd vector(const Json &values, Eigen::Index size) {
  return matrix(values, size, 1).col(0);
}

/// Calls read(json), turning what the parser throws into an Error that says what was expected.
template <class Read> void read(const std::string &text, const char *expected, const Read &read) {
  try {
    const Json json = Json::parse(text);
    if (json.value("kind", "") != expected)
      throw Error(std::string("optimiser state: expected kind '") + expected + "', found '" + json.value("kind", "") + "'");
    read(json);
  } catch (const nlohmann::json::exception &error) {
    throw Error(std::string("optimiser state: expected a saved '") + expected + "', found: " + error.what());
  }
}

} // namespace doublet::state
