#pragma once
// A 64 bit hash of plain data, to check whether a checkpoint belongs to this problem. FNV-1a, but eight bytes at a time and with
// the high bits folded back into the low ones, since a performance has hundreds of megabytes.

#include "doublet/options/options.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace doublet {

class Fingerprint {
public:
  /// The length is hashed, too, so that data which moves from one array to the next changes the hash.
  Fingerprint &bytes(const void *data, std::size_t size) {
    word(size);
    const auto *byte = static_cast<const unsigned char *>(data);
    for (std::size_t i = 0; i < size; i += sizeof(std::uint64_t)) {
      std::uint64_t next = 0;
      std::memcpy(&next, byte + i, std::min(size - i, sizeof next));
      word(next);
    }
    return *this;
  }
  template <class T, int R, int C, int O> Fingerprint &add(const Eigen::Matrix<T, R, C, O> &m) {
    return bytes(m.data(), sizeof(T) * static_cast<std::size_t>(m.size()));
  }
  /// A list of numbers or fixed-size vectors.
  template <class T> Fingerprint &add(const std::vector<T> &values) { return bytes(values.data(), sizeof(T) * values.size()); }
  Fingerprint &add(const std::string &text) { return bytes(text.data(), text.size()); }
  /// Every option, including nested ones.
  template <options::Described T> Fingerprint &add(const T &object) {
    for (const auto &[name, value] : options::to_pairs(object))
      add(name).add(value);
    return *this;
  }
  std::uint64_t value() const { return hash_; }
  std::string text() const { return std::to_string(hash_); }

private:
  void word(std::uint64_t next) {
    hash_ = (hash_ ^ next) * 1099511628211ull;
    hash_ ^= hash_ >> 32;
  }
  std::uint64_t hash_ = 14695981039346656037ull;
};

} // namespace doublet
