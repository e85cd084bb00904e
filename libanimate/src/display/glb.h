#pragma once
// The little of glTF 2.0 that the files of this library share. Internal: the only headers that see TinyGLTF are this one's
// includers.

#include "doublet/core/types.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace doublet::glb {

enum class Use { Data, Vertices, Indices }; ///< what a buffer view is for (its `target`)

/// Appends arrays to a model as one accessor with its own buffer view each; returns the accessor's index.
class Writer {
public:
  Writer();
  tinygltf::Model model;

  /// `type` is TINYGLTF_TYPE_*; with_bounds writes min and max (required for positions and key times).
  int floats(const std::vector<float> &values, int type, Use use, bool with_bounds = false);
  int vectors(const Vertices &rows, Use use, bool with_bounds = false);
  int matrix(const MatrixRM &values); ///< scalars, row by row
  int bytes(const std::vector<std::uint8_t> &values, int type = TINYGLTF_TYPE_SCALAR, Use use = Use::Data);
  int shorts(const std::vector<std::uint16_t> &values, int type, Use use);
  int integers(const std::vector<std::uint32_t> &values, Use use);
  int faces(const Faces &faces, Use use);
  int image(const std::vector<std::uint8_t> &file); ///< returns the image's index

  /// Rows of accessors that are 0 elsewhere, ascending; several accessors can share them.
  struct SparseRows {
    int view, component;
    std::size_t rows, count; ///< count: of the whole accessor
  };
  SparseRows sparse_rows(const std::vector<int> &rows, std::size_t count);
  /// Values (rows, 3) at those rows as morph targets have them with KHR_mesh_quantization; normalised bytes mean k / 127, others
  /// k. With min and max.
  int sparse_vectors(const SparseRows &rows, const std::vector<std::int8_t> &values, bool normalised);
  int sparse_vectors(const SparseRows &rows, const std::vector<std::int16_t> &values);

  void save(const std::filesystem::path &path); ///< complete or not at all

private:
  int view(const void *data, std::size_t bytes, Use use);
  int accessor(int view, int component, int type, std::size_t count);
  template <class T> int sparse(const SparseRows &rows, const std::vector<T> &values, int component, bool normalised);
};

/// Arrays out of a GLB. Of glTF it knows what character files need, and reads nothing else: JSON, accessors and images in the
/// file's own binary chunk, every one held against the bytes that are there before it is read. A broken file, and one that
/// names other files, throws Error naming it.
class Reader {
public:
  explicit Reader(const std::filesystem::path &path);
  Reader(const Reader &) = delete; // binary_ points into content_
  const nlohmann::json &gltf() const { return gltf_; }
  [[noreturn]] void fail(const std::string &what) const;

  std::vector<float> floats(int accessor) const;
  /// Of any component type; normalised integers as what they mean, strided, sparse and absent ones as the standard has them.
  std::vector<float> numbers(int accessor) const;
  std::size_t size() const { return content_.size(); } ///< bytes
  std::vector<std::uint8_t> bytes(int accessor) const;
  std::vector<std::uint32_t> integers(int accessor) const;
  Vertices vectors(int accessor) const;
  MatrixRM matrix(int accessor, Eigen::Index columns) const;
  Faces faces(int accessor) const;
  std::vector<std::uint8_t> image(int index) const; ///< the image file's bytes

private:
  std::uint32_t word(std::size_t at) const;
  std::string_view chunk(std::size_t at, std::uint32_t type, const char *name) const;
  void refuse_outside(const char *list, const nlohmann::json &entry) const;
  const nlohmann::json &entry(const char *list, const nlohmann::json &index) const;
  std::size_t size(const nlohmann::json &object, const char *key) const;
  std::string_view view(const nlohmann::json &index) const;
  template <class T> std::vector<T> read(int accessor, int component) const;
  struct Rows {
    int component;
    std::size_t count, width, offset; ///< width: components a row
    bool normalised;
  };
  Rows rows_of(const nlohmann::json &accessor) const;
  std::string_view strided(const nlohmann::json &index, std::size_t &stride) const;
  std::vector<float> gather(const nlohmann::json &view, const Rows &rows) const;
  std::string source_, content_;
  std::string_view binary_; ///< of content_
  nlohmann::json gltf_;
};

} // namespace doublet::glb
