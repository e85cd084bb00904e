#pragma once

#include "doublet/core/types.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// The faces with face_valid[f] != 0; all of them if the mask is empty.
inline Faces valid_faces(const Faces &faces, const std::vector<std::uint8_t> &face_valid) {
  Faces kept(faces.rows(), 3);
  int count = 0;
  for (int f = 0; f < faces.rows(); ++f)
    if (face_valid.empty() || face_valid[f])
      kept.row(count++) = faces.row(f);
  return kept.topRows(count);
}

} // namespace doublet
