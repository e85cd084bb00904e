#pragma once
// Faces to be drawn: a level of detail has other faces than the surface it replaces, but the same vertices.

#include "doublet/core/types.h"

namespace doublet {

struct TexturedFaces {
  Faces faces; ///< (F, 3)
  /// (3 F, 2) texture coordinates of corners, glTF's convention; empty = none.
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> texcoords;
};

} // namespace doublet
