#include "small_view.h"

#include <algorithm>

namespace doublet {
namespace {

Image sampled(const Image &mask, int width, int height) {
  Image small(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      small.at(x, y) =
          mask.at(static_cast<int>((x + 0.5) * mask.width / width), static_cast<int>((y + 0.5) * mask.height / height));
  return small;
}

} // namespace

std::vector<SmallView> small_views(const CameraRig &rig, const std::vector<Image> &masks, int size) {
  std::vector<SmallView> views(rig.size());
  for (size_t v = 0; v < rig.size(); ++v) {
    if (masks[v].empty())
      continue;
    const double scale = std::min(1.0, static_cast<double>(size) / std::max(rig[v].width, rig[v].height));
    views[v].camera =
        rig[v].resized(std::max(1, static_cast<int>(rig[v].width * scale)), std::max(1, static_cast<int>(rig[v].height * scale)));
    Image small = sampled(masks[v], views[v].camera.width, views[v].camera.height);
    if (std::any_of(small.data.begin(), small.data.end(), [](std::uint8_t p) { return p > 0; }))
      views[v].mask = std::move(small);
  }
  return views;
}

} // namespace doublet
