#pragma once
// Exact state as JSON: nlohmann writes the shortest decimal that reads back to the same double.

#include "doublet/core/error.h"
#include "doublet/core/types.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

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

/// A number of things, at least 0.
inline int count(const Json &value) {
  if (!value.is_number_integer() || value.get<std::int64_t>() < 0 || value.get<std::int64_t>() > std::numeric_limits<int>::max())
    throw Error("optimiser state: expected a count, found " + value.dump().substr(0, 40));
  return value.get<int>();
}

/// What the parser says, without the text that it quotes: that may be the whole file.
inline std::string reason(const nlohmann::json::exception &error) {
  const std::string text = error.what();
  return text.substr(0, std::min(text.find("; last read"), std::size_t{160}));
}

/// Calls read(json), turning what the parser throws into an Error that says what was expected.
template <class Read> void read(const std::string &text, const char *expected, const Read &read) {
  try {
    const Json json = Json::parse(text);
    if (const std::string kind = json.value("kind", ""); kind != expected)
      throw Error(std::string("optimiser state: expected kind '") + expected + "', found '" + kind.substr(0, 40) + "'");
    read(json);
  } catch (const nlohmann::json::exception &error) {
    throw Error(std::string("optimiser state: expected a saved '") + expected + "', found: " + reason(error));
  }
}

} // namespace doublet::state
