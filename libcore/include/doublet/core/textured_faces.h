#pragma once
// Faces as they are drawn: a level of detail has other ones than the surface that it stands for, of the same vertices.

#include "doublet/core/types.h"

namespace doublet {

struct TexturedFaces {
  Faces faces; ///< (F, 3)
  /// (3 F, 2) texture coordinates of corners, glTF's convention; empty = none.
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> texcoords;
};

} // namespace doublet
