#pragma once
// Normal random numbers that do not depend on the standard library: std::normal_distribution may differ between vendors.

#include <cstdint>
#include <random>
#include <string>

namespace doublet {

/// N(0, 1) by Marsaglia's polar method (Marsaglia & Bray 1964) on the 64-bit Mersenne twister, whose sequence the C++ standard
/// fixes.
class NormalGenerator {
public:
  explicit NormalGenerator(std::uint64_t seed = 0) : engine_(seed) {}
  double normal();  ///< N(0, 1)
  double uniform(); ///< [0, 1), multiples of 2^-53
  /// The exact state as text; after restore() the sequence continues with the same numbers. restore() throws Error if the text is
  /// not a state.
  std::string state() const;
  void restore(const std::string &state);

private:
  std::mt19937_64 engine_;
  bool has_spare_ = false;
  double spare_ = 0;
};

} // namespace doublet
