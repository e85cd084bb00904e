#pragma once
// The key colour of a screen behind the actor, and how much of it a pixel shows.

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace doublet {

/// How much a pixel looks like the screen: 1 = screen, 0 = no trace of its hue. With p the chroma along the key's hue and q
/// across it (a "keyer" in chroma space: Jack, Video Demystified, ch. 7), keyness = (p - |q|) / (Y + Y_key), scaled to 1 at the
/// key colour. Dividing by the luma gives shadowed parts of the screen a high keyness; Y_key in the sum gives dark, noisy pixels
/// a low one.
struct KeyColour {
  /// ITU-R BT.601 luma as a linear form of (B, G, R).
  static Eigen::Vector3d luma_form() { return {0.114, 0.587, 0.299}; }

  Eigen::Vector3d along, across; ///< chroma along and across the key's hue, as linear forms of (B, G, R)
  double luma = 0, scale = 0;

  double keyness(const Eigen::Vector3d &bgr) const {
    return (along.dot(bgr) - std::abs(across.dot(bgr))) / (luma_form().dot(bgr) + luma) * scale;
  }
};

/// The most frequent hue of the saturated pixels, within 20 degrees.
struct SharedHue {
  double share = 0;                    ///< of all pixels
  std::vector<Eigen::Vector3d> pixels; ///< B G R, 0 to 255
};
SharedHue shared_hue(const std::vector<Eigen::Vector3d> &pixels);

/// The key colour of these pixels (at least one) of a screen: the median of their chroma and luma.
KeyColour key_colour(const std::vector<Eigen::Vector3d> &screen);

} // namespace doublet
