#pragma once
// FNV-1a, 64 bits, over plain data: tells whether a checkpoint belongs to this problem.

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

namespace doublet {

class Fingerprint {
public:
  Fingerprint &bytes(const void *data, std::size_t size) {
    const auto *byte = static_cast<const unsigned char *>(data);
    for (std::size_t i = 0; i < size; ++i)
      hash_ = (hash_ ^ byte[i]) * 1099511628211ull;
    return *this;
  }
  template <class T, int R, int C, int O> Fingerprint &add(const Eigen::Matrix<T, R, C, O> &m) {
    return bytes(m.data(), sizeof(T) * static_cast<std::size_t>(m.size()));
  }
  Fingerprint &add(const std::vector<int> &values) { return bytes(values.data(), sizeof(int) * values.size()); }
  Fingerprint &add(std::initializer_list<double> values) { return bytes(values.begin(), sizeof(double) * values.size()); }
  Fingerprint &add(const std::string &text) { return bytes(text.data(), text.size()); }
  std::string text() const { return std::to_string(hash_); }

private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

} // namespace doublet
