#include "silhouette_depth.h"

#include "doublet/core/parts/key_colour.h"

#include <algorithm>
#include <numbers>
#include <optional>

namespace doublet::detail {
namespace {

constexpr double kScreenShare = 0.5; // of what is outside the mask
constexpr double kTint = 0.05;       // of the key colour's chroma
constexpr double kWornKeyness = 0.25;
// Of the pixels deep inside all masks: from so many on the actor wears that colour, up to so many it is a gap, not a pattern.
constexpr double kWorn = 0.01, kGap = 0.002;

Eigen::Vector3d pixel(const Image &image, std::size_t i) {
  return {double(image.data[3 * i]), double(image.data[3 * i + 1]), double(image.data[3 * i + 2])};
}

/// Within 60 degrees of the screen's hue: of a green screen, greener than red and than blue, which skin is not unless a good
/// quarter of the pixel shows the screen.
bool screen_tinted(const KeyColour &screen, const Eigen::Vector3d &bgr) {
  const double beyond = std::numbers::sqrt3 * screen.along.dot(bgr) - std::abs(screen.across.dot(bgr));
  return beyond * screen.scale > kTint * (KeyColour::luma_form().dot(bgr) + screen.luma);
}

std::optional<KeyColour> screen_colour(const Image &image, const Image &mask) {
  constexpr std::size_t kEvery = 5; // pixels are many
  std::vector<Eigen::Vector3d> outside;
  for (std::size_t i = 0; i < mask.data.size(); i += kEvery)
    if (mask.data[i] == 0)
      outside.push_back(pixel(image, i));
  const SharedHue hue = shared_hue(outside);
  if (hue.pixels.empty() || hue.share < kScreenShare)
    return std::nullopt;
  return key_colour(hue.pixels);
}

} // namespace

std::vector<int> silhouette_depth(const Image &mask) {
  const int w = mask.width, h = mask.height;
  std::vector<int> depth(mask.data.size());
  const auto relax = [&](int x, int y, int dx, int dy) {
    int &here = depth[static_cast<std::size_t>(y) * w + x];
    if (x + dx >= 0 && x + dx < w)
      here = std::min(here, depth[static_cast<std::size_t>(y) * w + x + dx] + 1);
    if (y + dy >= 0 && y + dy < h)
      here = std::min(here, depth[static_cast<std::size_t>(y + dy) * w + x] + 1);
  };
  for (std::size_t i = 0; i < depth.size(); ++i)
    depth[i] = mask.data[i] == 0 ? 0 : w + h;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      relax(x, y, -1, -1);
  for (int y = h - 1; y >= 0; --y)
    for (int x = w - 1; x >= 0; --x)
      relax(x, y, 1, 1);
  return depth;
}

std::vector<Image> without_screen(const std::vector<Image> &images, const std::vector<Image> &masks, double reach) {
  std::vector<Image> shallow_out = masks, all_out = masks; // without what is tinted near the rim; and without gaps deeper inside
  std::size_t deep = 0, worn = 0;
  for (std::size_t c = 0; c < masks.size(); ++c) {
    if (images[c].empty() || masks[c].empty())
      continue;
    const std::optional<KeyColour> screen = screen_colour(images[c], masks[c]);
    if (!screen || reach <= 0)
      continue;
    const std::vector<int> depth = silhouette_depth(masks[c]);
    const double shallow = reach * std::min(masks[c].width, masks[c].height);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] == 0)
        continue;
      const Eigen::Vector3d bgr = pixel(images[c], i);
      if (depth[i] <= shallow && screen_tinted(*screen, bgr))
        shallow_out[c].data[i] = all_out[c].data[i] = 0;
      if (depth[i] <= shallow)
        continue;
      ++deep;
      if (screen->keyness(bgr) > kWornKeyness) {
        ++worn;
        all_out[c].data[i] = 0;
      }
    }
  }
  const double share = static_cast<double>(worn) / static_cast<double>(std::max<std::size_t>(deep, 1));
  return share > kWorn ? masks : share > kGap ? shallow_out : all_out;
}

} // namespace doublet::detail
