#include "doublet/core/parts/key_colour.h"
#include "doublet/core/parts/quantile.h"

#include <array>
#include <numbers>

namespace doublet {
namespace {

using Form = Eigen::Vector3d;

/// Colour differences, ITU-R BT.601.
Form blueness() {
  return 0.564 * (Form(1, 0, 0) - KeyColour::luma_form());
}
Form redness() {
  return 0.713 * (Form(0, 0, 1) - KeyColour::luma_form());
}

constexpr int kBins = 72, kReach = 4; // 5 degrees a bin, +-20 degrees

std::array<std::vector<Form>, kBins> by_hue(const std::vector<Form> &pixels) {
  constexpr double kSaturated = 12; // of 128: above the chroma noise of grey walls under coloured light
  const Form blue = blueness(), red = redness();
  std::array<std::vector<Form>, kBins> bins;
  for (const Form &bgr : pixels) {
    const double cb = blue.dot(bgr), cr = red.dot(bgr);
    if (std::hypot(cb, cr) < kSaturated)
      continue;
    const double turn = std::atan2(cr, cb) / (2 * std::numbers::pi) + 1;
    bins[static_cast<int>(turn * kBins) % kBins].push_back(bgr);
  }
  return bins;
}

} // namespace

SharedHue shared_hue(const std::vector<Form> &pixels) {
  const auto bins = by_hue(pixels);
  int best = 0;
  std::size_t best_count = 0;
  for (int b = 0; b < kBins; ++b) {
    std::size_t count = 0;
    for (int d = -kReach; d <= kReach; ++d)
      count += bins[(b + d + kBins) % kBins].size();
    if (count > best_count) {
      best = b;
      best_count = count;
    }
  }
  SharedHue shared;
  for (int d = -kReach; d <= kReach; ++d) {
    const auto &bin = bins[(best + d + kBins) % kBins];
    shared.pixels.insert(shared.pixels.end(), bin.begin(), bin.end());
  }
  shared.share = pixels.empty() ? 0 : static_cast<double>(shared.pixels.size()) / pixels.size();
  return shared;
}

KeyColour key_colour(const std::vector<Form> &screen) {
  const Form blue = blueness(), red = redness(), light = KeyColour::luma_form();
  std::vector<double> cb, cr, luma;
  for (const Form &bgr : screen) {
    cb.push_back(blue.dot(bgr));
    cr.push_back(red.dot(bgr));
    luma.push_back(light.dot(bgr));
  }
  const Eigen::Vector2d colour(median(cb), median(cr)), hue = colour.normalized();
  KeyColour key;
  key.along = hue.x() * blue + hue.y() * red;
  key.across = -hue.y() * blue + hue.x() * red;
  key.luma = median(luma);
  key.scale = 2 * key.luma / colour.norm();
  return key;
}

} // namespace doublet
