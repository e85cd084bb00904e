#pragma once
#include "doublet/core/image.h"

#include <vector>

namespace doublet {

/// A mask by the lengths of its runs, row after row: 0, 255, 0, ... A tenth of a percent of its pixels.
struct PackedMask {
  int width = 0, height = 0;
  std::vector<int> runs;
};

std::vector<PackedMask> pack(const std::vector<Image> &masks);
std::vector<Image> unpack(const std::vector<PackedMask> &packed);

} // namespace doublet
