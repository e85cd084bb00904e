#pragma once
// NumPy .npz archives: read and written whole (libzip behind it).

#include <climits>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "doublet/core/types.h"

namespace doublet {

/// One array in C order. `type` is NumPy's: "f4" "f8" "i1" "u1" "b1" "i2" "u2" "i4" "i8" or "U<n>" (UTF-32 strings, decoded into
/// `strings`).
struct NpyArray {
  std::string type;
  std::vector<std::int64_t> shape;
  std::vector<std::uint8_t> bytes;  ///< raw little-endian data unless strings
  std::vector<std::string> strings; ///< UTF-8, only for "U"
  std::int64_t size() const;        ///< product of shape
};

class Npz {
public:
  Npz() = default;
  /// `wanted`: names of the arrays to read (empty = all); missing ones are skipped. Fortran order is converted to C order. Throws
  /// FileNotFound, or Error naming the file if it is not an npz file, is truncated, an array to be read holds objects, or its
  /// array `format` (see write) is above `newest_format`.
  static Npz read(const std::filesystem::path &path, const std::vector<std::string> &wanted = {}, int newest_format = INT_MAX);
  /// Writes atomically. Throws Error if that fails (full disk). `format` > 0: the format number of the file, stored as an array
  /// of that name; a file without it has format 1.
  void write(const std::filesystem::path &path, int format = 0) const;

  bool has(const std::string &name) const { return arrays.count(name) > 0; }
  /// Throws Error naming file, array, expected and found shape (-1 in `shape` = any) or type.
  MatrixRM matrix(const std::string &name) const;            ///< any numeric 1-D or 2-D array
  std::vector<double> values(const std::string &name) const; ///< any numeric array, flattened
  std::vector<int> integers(const std::string &name) const;  ///< any integer or bool array, flattened
  std::vector<std::string> text(const std::string &name) const;
  std::vector<std::int64_t> shape(const std::string &name) const;
  [[noreturn]] void reject(const std::string &what) const; ///< throws Error: the file's name, then `what`
  void require_shape(const std::string &name, const std::vector<std::int64_t> &shape) const;

  void set_f4(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<double> &values);
  void set_f8(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<double> &values);
  void set_i4(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<int> &values);
  void set_b1(const std::string &name, const Mask &values);
  void set_text(const std::string &name, const std::vector<std::string> &values);

  std::map<std::string, NpyArray> arrays;
  std::string source; ///< file name, for messages
};

} // namespace doublet
