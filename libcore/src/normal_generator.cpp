#include "doublet/core/parts/normal_generator.h"

#include "doublet/core/error.h"

#include <bit>
#include <cmath>
#include <sstream>

namespace doublet {

double NormalGenerator::uniform() {
  return static_cast<double>(engine_() >> 11) * 0x1.0p-53;
}

double NormalGenerator::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double x, y, squared;
  do {
    x = 2 * uniform() - 1;
    y = 2 * uniform() - 1;
    squared = x * x + y * y;
  } while (squared >= 1 || squared == 0);
  const double factor = std::sqrt(-2 * std::log(squared) / squared);
  spare_ = y * factor;
  has_spare_ = true;
  return x * factor;
}

std::string NormalGenerator::state() const {
  std::ostringstream out;
  out << engine_ << ' ' << has_spare_ << ' ' << std::bit_cast<std::uint64_t>(spare_);
  return out.str();
}

void NormalGenerator::restore(const std::string &state) {
  std::istringstream in(state);
  std::mt19937_64 engine;
  bool has_spare = false;
  std::uint64_t spare = 0;
  if (!(in >> engine >> has_spare >> spare))
    throw Error("random generator state: expected a state written by NormalGenerator::state(), found other text");
  engine_ = engine;
  has_spare_ = has_spare;
  spare_ = std::bit_cast<double>(spare);
}

} // namespace doublet
