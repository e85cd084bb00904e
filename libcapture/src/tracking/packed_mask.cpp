#include "packed_mask.h"

#include <algorithm>

namespace doublet {

std::vector<PackedMask> pack(const std::vector<Image> &masks) {
  std::vector<PackedMask> packed;
  for (const Image &mask : masks) {
    packed.push_back({mask.width, mask.height, {}});
    std::uint8_t value = 0;
    for (auto at = mask.data.begin(); at != mask.data.end(); value = 255 - value) {
      const auto end = std::find_if(at, mask.data.end(), [&](std::uint8_t pixel) { return (pixel > 0) != (value > 0); });
      packed.back().runs.push_back(static_cast<int>(end - at));
      at = end;
    }
    packed.back().runs.shrink_to_fit();
  }
  return packed;
}

std::vector<Image> unpack(const std::vector<PackedMask> &packed) {
  std::vector<Image> masks;
  for (const PackedMask &mask : packed) {
    masks.emplace_back();
    if (mask.runs.empty())
      continue;
    masks.back() = Image(mask.width, mask.height, 1, 0);
    std::uint8_t value = 0;
    auto at = masks.back().data.begin();
    for (const int run : mask.runs) {
      at = std::fill_n(at, run, value);
      value = 255 - value;
    }
  }
  return masks;
}

} // namespace doublet
