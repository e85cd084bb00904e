#pragma once
// What every part of the capture must do, for those who write their own: call these in a test of any framework and expect empty
// lists. Frames and problems are yours; tests/capture/conformance_test.cpp shows how little they need.

#include "doublet/capture/parts/feature_tracker.h"
#include "doublet/capture/parts/pose_optimizer.h"
#include "doublet/capture/parts/surface_refiner.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace doublet::testing {

namespace detail {

inline bool same(const Image &a, const Image &b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels && a.data == b.data;
}

inline bool is_mask(const Image &image) {
  return image.channels == 1 &&
         std::all_of(image.data.begin(), image.data.end(), [](std::uint8_t value) { return value == 0 || value == 255; });
}

/// What `rules` adds to the list, and a sentence if it throws.
inline std::vector<std::string> tried(const char *who, const std::function<void(std::vector<std::string> &)> &rules) {
  std::vector<std::string> broken;
  try {
    rules(broken);
  } catch (const std::exception &error) {
    broken.push_back(std::string(who) + " threw: " + error.what());
  }
  return broken;
}

} // namespace detail

/// Every camera has frames; an image is empty or BGR, a mask empty or of 0 and 255, both of one size a camera; a frame asked for
/// again, after another one, is the same; there is an image or a mask.
inline std::vector<std::string> frame_source_violations(FrameSource &frames) {
  return detail::tried("the source", [&](std::vector<std::string> &broken) {
    if (frames.camera_count() < 1 || frames.frame_count() < 1) {
      broken.push_back("expected at least one camera and one frame");
      return;
    }
    for (int camera = 0; camera < frames.camera_count(); ++camera) {
      const std::string where = "camera " + std::to_string(camera);
      const Image image = frames.image(camera, 0), mask = frames.mask(camera, 0);
      if (image.empty() && mask.empty())
        broken.push_back(where + ": frame 0 has neither an image nor a mask");
      if (!image.empty() && image.channels != 3)
        broken.push_back(where + ": expected an image of 3 channels, found " + std::to_string(image.channels));
      if (!mask.empty() && !detail::is_mask(mask))
        broken.push_back(where + ": a mask has other values than 0 and 255, or more than one channel");
      if (!image.empty() && !mask.empty() && (image.width != mask.width || image.height != mask.height))
        broken.push_back(where + ": image and mask differ in size");
      const int last = frames.frame_count() - 1;
      const Image later = frames.image(camera, last);
      if (!image.empty() && !later.empty() && (image.width != later.width || image.height != later.height))
        broken.push_back(where + ": frames differ in size");
      if (!detail::same(image, frames.image(camera, 0)) || !detail::same(mask, frames.mask(camera, 0)))
        broken.push_back(where + ": frame 0 is another one after frame " + std::to_string(last) + " was read");
    }
  });
}

/// Trained with `training`, it makes a mask of the size of `image`, the same one twice; before that, or from an image of one
/// channel, std::invalid_argument.
inline std::vector<std::string> silhouette_extractor_violations(SilhouetteExtractor &extractor,
                                                                const std::vector<Image> &training, const Image &image) {
  return detail::tried("the extractor", [&](std::vector<std::string> &broken) {
    const auto refuses = [&](const Image &wrong, const std::string &what) {
      try {
        extractor.extract(0, wrong);
        broken.push_back(what + " is not refused");
      } catch (const std::invalid_argument &) {
      }
    };
    refuses(image, "a camera that was not trained");
    extractor.train(0, training);
    const Image mask = extractor.extract(0, image);
    if (mask.width != image.width || mask.height != image.height || !detail::is_mask(mask))
      broken.push_back("expected a mask of 0 and 255 of the image's size");
    if (!detail::same(mask, extractor.extract(0, image)))
      broken.push_back("a second call gives another mask");
    refuses(Image(image.width, image.height, 1), "an image of one channel");
  });
}

/// Features lie in the mask, one descriptor each, the same ones twice; matches are indices, none twice, none beyond `reach`.
inline std::vector<std::string> feature_tracker_violations(const FeatureTracker &tracker, const Image &image, const Image &mask,
                                                           double reach) {
  return detail::tried("the tracker", [&](std::vector<std::string> &broken) {
    const Features features = tracker.detect(image, mask), again = tracker.detect(image, mask);
    if (features.descriptors.rows() != static_cast<Eigen::Index>(features.points.size()))
      broken.push_back("expected one descriptor a point");
    if (features.points != again.points || features.descriptors != again.descriptors)
      broken.push_back("a second call gives other features");
    for (const Eigen::Vector2f &p : features.points) {
      const int x = static_cast<int>(p.x() + 0.5f), y = static_cast<int>(p.y() + 0.5f);
      if (x < 0 || y < 0 || x >= mask.width || y >= mask.height || !mask.at(x, y)) {
        broken.push_back("a feature lies outside the mask");
        break;
      }
    }
    std::vector<char> used(features.points.size(), 0), met(used);
    for (const auto &[a, b] : tracker.match(features, again, reach)) {
      const int count = static_cast<int>(used.size());
      if (a < 0 || b < 0 || a >= count || b >= count || used[a]++ || met[b]++) {
        broken.push_back("a match has an index twice, or one that is no feature");
        break;
      }
      if ((features.points[a] - again.points[b]).norm() > reach) {
        broken.push_back("a match reaches farther than asked for");
        break;
      }
    }
  });
}

/// A finite pose of all degrees of freedom, residuals of at least 0, and the same bits from the same problem.
inline std::vector<std::string> pose_optimizer_violations(PoseOptimizer &optimizer, const PoseProblem &problem) {
  return detail::tried("the optimizer", [&](std::vector<std::string> &broken) {
    const PoseEstimate found = optimizer.optimize(problem, {}), again = optimizer.optimize(problem, {});
    if (found.dofs.size() != problem.start.size())
      broken.push_back("expected " + std::to_string(problem.start.size()) + " degrees of freedom, found " +
                       std::to_string(found.dofs.size()));
    if (!found.dofs.allFinite() || !(found.rim_px >= 0) || !(found.sift_px >= 0) || !(found.energy >= 0))
      broken.push_back("expected a finite pose and residuals of at least 0");
    if (found.dofs.size() != again.dofs.size() || found.dofs != again.dofs)
      broken.push_back("a second call gives other bits");
  });
}

/// A finite surface of all vertices, residuals of at least 0, and the same bits from the same problem.
inline std::vector<std::string> surface_refiner_violations(SurfaceRefiner &refiner, const SurfaceProblem &problem) {
  return detail::tried("the refiner", [&](std::vector<std::string> &broken) {
    const SurfaceEstimate found = refiner.refine(problem, {}), again = refiner.refine(problem, {});
    if (found.vertices.rows() != problem.base.rows())
      broken.push_back("expected " + std::to_string(problem.base.rows()) + " vertices, found " +
                       std::to_string(found.vertices.rows()));
    if (!found.vertices.allFinite() || !(found.rim_px >= 0) || !(found.sift_px >= 0))
      broken.push_back("expected a finite surface and residuals of at least 0");
    if (found.vertices.rows() != again.vertices.rows() || found.vertices != again.vertices)
      broken.push_back("a second call gives other bits");
  });
}

} // namespace doublet::testing
