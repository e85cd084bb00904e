#pragma once
// Texture features and their matches from frame to frame (Sect. 4: SIFT, Lowe 2004).

#include "doublet/core/image.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <memory>
#include <utility>

namespace doublet {

/// Features of one image, N points.
struct Features {
  std::vector<Eigen::Vector2f> points; ///< pixels
  MatrixRM descriptors;                ///< (N, C); closeness is Euclidean distance
};

struct FeatureTrackerOptions {
  int budget = 500;
  int erode = 3;
  double ratio = 0.8;
  double max_displacement = 0.1;
  static constexpr auto describe() {
    using namespace options;
    using O = FeatureTrackerOptions;
    return Description{
        "FeatureTrackerOptions",
        option(&O::budget, "budget", at_least(1), "", "Number of features that are kept per image (the strongest)",
               "Time is proportional, 40 to 60 ms per image of 1004 x 1004; 500 suffice for the pose"),
        option(&O::erode, "erode", at_least(0), "px",
               "Features closer than this to the outline are dropped, at 1004 px image height", "They see background"),
        option(&O::ratio, "ratio", Range{0, 1, Open::Below}, "",
               "Largest ratio of the best to the second best descriptor distance (Lowe 2004, Sect. 7.1)"),
        option(&O::max_displacement, "max_displacement", above(0), "",
               "Largest displacement between two frames, as a share of the silhouette's height",
               "0.1 = 7 m/s for a person at 40 fps"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// The swap point: image and mask in, features out; two successive frames' features in, matches out.
/// Threads: both methods are const and are called from several at once, on one object.
class FeatureTracker {
public:
  virtual ~FeatureTracker() = default;
  /// `image` BGR or grey, `mask` 255 = actor, of one size.
  virtual Features detect(const Image &image, const Image &mask) const = 0;
  /// Pairs (index in previous, index in current), each index at most once; `reach` = largest displacement to consider, pixels.
  virtual std::vector<std::pair<int, int>> match(const Features &previous, const Features &current, double reach) const = 0;
  static std::unique_ptr<FeatureTracker> create(const FeatureTrackerOptions &options = {});
};

} // namespace doublet
