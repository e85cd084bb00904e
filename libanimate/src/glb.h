#pragma once
// The little of glTF 2.0 that the files of this library share. Internal: the only headers that see TinyGLTF are this one's
// includers.

#include "doublet/core/types.h"

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <string>
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

  void save(const std::filesystem::path &path); ///< complete or not at all

private:
  int view(const void *data, std::size_t bytes, Use use);
  int accessor(int view, int component, int type, std::size_t count);
};

/// Arrays out of a loaded model. Every access is checked: a broken file throws Error naming it.
class Reader {
public:
  explicit Reader(const std::filesystem::path &path);
  const tinygltf::Model &model() const { return model_; }
  const std::string &extensions_json() const { return model_.extensions_json_string; }
  [[noreturn]] void fail(const std::string &what) const;

  std::vector<float> floats(int accessor) const;
  std::vector<std::uint8_t> bytes(int accessor) const;
  std::vector<std::uint32_t> integers(int accessor) const;
  Vertices vectors(int accessor) const;
  MatrixRM matrix(int accessor, Eigen::Index columns) const;
  Faces faces(int accessor) const;
  std::vector<std::uint8_t> image(int index) const; ///< the image file's bytes

private:
  template <class T> std::vector<T> read(int accessor, int component) const;
  std::string source_;
  tinygltf::Model model_;
};

} // namespace doublet::glb
