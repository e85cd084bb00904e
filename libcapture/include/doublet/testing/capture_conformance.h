#pragma once
// What every part of the capture must do, for those who write their own: call these in a test of any framework and expect empty
// lists. Frames and problems are yours; tests/capture/conformance_test.cpp shows how little they need.

#include "doublet/capture/feature_tracker.h"
#include "doublet/capture/limb_search.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/capture/surface_refiner.h"
#include "doublet/core/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <stdexcept>
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

/// Of an image or none, and a mask or none.
inline std::vector<std::string> what_is_wrong(const Image &image, const Image &mask) {
  std::vector<std::string> wrong;
  if (!image.empty() && image.channels != 3)
    wrong.push_back("expected an image of 3 channels, found " + std::to_string(image.channels));
  if (!mask.empty() && !is_mask(mask))
    wrong.push_back("a mask has other values than 0 and 255, or more than one channel");
  if (!image.empty() && !mask.empty() && (image.width != mask.width || image.height != mask.height))
    wrong.push_back("image and mask differ in size");
  return wrong;
}

/// Mean overlap of a surface with the ready masks of a frame; 1 if there are none.
inline double overlap(const Vertices &surface, const Faces &faces, const CameraRig &rig, FrameSource &frames, int frame) {
  double sum = 0, count = 0;
  for (std::size_t camera = 0; camera < rig.size(); ++camera)
    if (const Image mask = frames.mask(static_cast<int>(camera), frame);
        mask.width == rig[camera].width && mask.height == rig[camera].height) {
      sum += mask_iou(silhouette(rasterize(surface, faces, rig[camera])), mask);
      count += 1;
    }
  return count > 0 ? sum / count : 1;
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

/// Every camera has frames; an image is empty or BGR, a mask is empty or of 0 and 255, both of one size per camera; a frame read
/// again after another one is the same; there is an image or a mask.
inline std::vector<std::string> frame_source_violations(FrameSource &frames) {
  return detail::tried("the source", [&](std::vector<std::string> &broken) {
    if (frames.camera_count() < 1 || frames.frame_count() < 1) {
      broken.push_back("expected at least one camera and one frame");
      return;
    }
    for (int camera = 0; camera < frames.camera_count(); ++camera) {
      const std::string where = "camera " + std::to_string(camera);
      const int last = frames.frame_count() - 1;
      const Image image = frames.image(camera, 0), mask = frames.mask(camera, 0);
      if (image.empty() && mask.empty())
        broken.push_back(where + ": frame 0 has neither an image nor a mask");
      const Image later = frames.image(camera, last), later_mask = frames.mask(camera, last);
      const auto wrong = detail::what_is_wrong(image, mask), wrong_later = detail::what_is_wrong(later, later_mask);
      for (const std::string &what : wrong.empty() ? wrong_later : wrong)
        broken.push_back(where + ": " + what);
      if (const std::size_t n = frames.keypoints(camera, 0).size(); n != 0 && n != static_cast<std::size_t>(kKeypoints))
        broken.push_back(where + ": frame 0 has " + std::to_string(n) + " keypoints, expected " + std::to_string(kKeypoints) +
                         ", or none");
      if (!image.empty() && !later.empty() && (image.width != later.width || image.height != later.height))
        broken.push_back(where + ": frames differ in size");
      if (!detail::same(image, frames.image(camera, 0)) || !detail::same(mask, frames.mask(camera, 0)))
        broken.push_back(where + ": frame 0 is another one after frame " + std::to_string(last) + " was read");
    }
  });
}

/// Trained with `training`, it returns a mask of the size of `image` with pixels of both kinds, the same one in a second call;
/// before training, or for an image of one channel, it throws.
inline std::vector<std::string> silhouette_extractor_violations(SilhouetteExtractor &extractor,
                                                                const std::vector<Image> &training, const Image &image) {
  return detail::tried("the extractor", [&](std::vector<std::string> &broken) {
    const auto refuses = [&](const Image &wrong, const std::string &what) {
      try {
        extractor.extract(0, wrong);
        broken.push_back(what + " is not refused");
      } catch (const std::exception &) { // of whatever kind: Python has its own
      }
    };
    refuses(image, "a camera that was not trained");
    extractor.train(0, training);
    const Image mask = extractor.extract(0, image);
    if (mask.width != image.width || mask.height != image.height || !detail::is_mask(mask))
      broken.push_back("expected a mask of 0 and 255 of the image's size");
    else if (const auto inside = std::count(mask.data.begin(), mask.data.end(), 255);
             inside == 0 || inside == static_cast<std::ptrdiff_t>(mask.data.size()))
      broken.push_back(inside ? "all of an image is taken for the actor" : "no actor is found in an image that shows one");
    if (!detail::same(mask, extractor.extract(0, image)))
      broken.push_back("a second call gives another mask");
    refuses(Image(image.width, image.height, 1), "an image of one channel");
  });
}

/// Features lie in the mask, have one descriptor each, and are the same in a second call; matches are valid indices, none used
/// twice, none farther than `reach`; an image with features matches itself.
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
    const auto matches = tracker.match(features, again, reach);
    const auto itself =
        std::count_if(matches.begin(), matches.end(), [](const auto &match) { return match.first == match.second; });
    if (itself == 0 || itself < static_cast<std::ptrdiff_t>(matches.size()) / 2)
      broken.push_back("an image does not match itself: of " + std::to_string(features.points.size()) + " features " +
                       std::to_string(itself) + " meet themselves");
    for (const auto &[a, b] : matches) {
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

/// A finite pose of all degrees of freedom, residuals of at least 0, the same bits from the same problem; a start that is 2 cm
/// off ends at the same pose; an actor that was modified in place is treated as another actor.
inline std::vector<std::string> pose_optimizer_violations(PoseOptimizer &optimizer, const PoseProblem &problem) {
  return detail::tried("the optimizer", [&](std::vector<std::string> &broken) {
    if (!problem.actor)
      throw std::invalid_argument("the problem has no actor");
    const PoseEstimate found = optimizer.optimize(problem, {}), again = optimizer.optimize(problem, {});
    if (found.dofs.size() != problem.start.size())
      broken.push_back("expected " + std::to_string(problem.start.size()) + " degrees of freedom, found " +
                       std::to_string(found.dofs.size()));
    if (!found.dofs.allFinite() || !(found.rim_px >= 0) || !(found.sift_px >= 0) || !(found.energy >= 0))
      broken.push_back("expected a finite pose and residuals of at least 0");
    if (found.dofs.size() != again.dofs.size() || found.dofs != again.dofs)
      broken.push_back("a second call gives other bits");
    PoseProblem beside = problem;
    beside.start[0] += 0.02;
    const PoseEstimate from_beside = optimizer.optimize(beside, {});
    if (from_beside.dofs.size() != found.dofs.size() || !(std::abs(from_beside.dofs[0] - found.dofs[0]) < 0.01))
      broken.push_back("what is seen does not draw the pose: a start 2 cm beside ends beside");
    const auto solved = [&](const RiggedMesh &actor) {
      PoseProblem own = problem;
      own.actor = &actor;
      return optimizer.optimize(own, {}).dofs;
    };
    RiggedMesh changed = *problem.actor;
    solved(changed);
    changed.weights = changed.weights.rowwise().reverse().eval();
    const RiggedMesh elsewhere = changed;
    const Eigen::VectorXd in_place = solved(changed), anew = solved(elsewhere); // in this order
    if (in_place != anew)
      broken.push_back("an actor whose weights were changed is taken for the one before");
  });
}

/// A finite surface of all vertices, residuals of at least 0, the same bits from the same problem; a base that is 2 cm off is
/// pulled back; an actor that was modified in place is treated as another actor.
inline std::vector<std::string> surface_refiner_violations(SurfaceRefiner &refiner, const SurfaceProblem &problem) {
  return detail::tried("the refiner", [&](std::vector<std::string> &broken) {
    if (!problem.actor)
      throw std::invalid_argument("the problem has no actor");
    const SurfaceEstimate found = refiner.refine(problem, {}), again = refiner.refine(problem, {});
    if (found.vertices.rows() != problem.base.rows())
      broken.push_back("expected " + std::to_string(problem.base.rows()) + " vertices, found " +
                       std::to_string(found.vertices.rows()));
    if (!found.vertices.allFinite() || !(found.rim_px >= 0) || !(found.sift_px >= 0))
      broken.push_back("expected a finite surface and residuals of at least 0");
    if (found.vertices.rows() != again.vertices.rows() || found.vertices != again.vertices)
      broken.push_back("a second call gives other bits");
    SurfaceProblem beside = problem;
    beside.base.col(0).array() += 0.02;
    const SurfaceEstimate from_beside = refiner.refine(beside, {});
    if (from_beside.vertices.rows() != found.vertices.rows() || !((from_beside.vertices - found.vertices).col(0).mean() < 0.015))
      broken.push_back("what is seen does not draw the surface: a base 2 cm beside stays beside");
    const auto refined = [&](const RiggedMesh &actor) {
      SurfaceProblem own = problem;
      own.actor = &actor;
      return refiner.refine(own, {}).vertices;
    };
    RiggedMesh changed = *problem.actor;
    refined(changed);
    changed.mesh.vertices.col(1) *= 1.5; // other areas and angles: another stiffness
    const RiggedMesh elsewhere = changed;
    const Vertices in_place = refined(changed), anew = refined(elsewhere); // in this order
    if (in_place != anew)
      broken.push_back("an actor whose mesh was changed is taken for the one before");
  });
}

/// A finite pose within the limits of the skeleton, in which only the lost limbs have moved, and which is closer to the masks if
/// they were in fact lost; nothing moves if `lost` is empty; the same bits from the same problem. `dofs` (D) within the limits;
/// `lost` from find_limbs(), not empty.
inline std::vector<std::string> limb_search_violations(LimbSearch &search, const LimbProblem &problem,
                                                       const Eigen::VectorXd &dofs, const std::vector<Limb> &lost) {
  return detail::tried("the search", [&](std::vector<std::string> &broken) {
    if (!problem.actor)
      throw std::invalid_argument("the problem has no actor");
    const Skeleton &skeleton = problem.actor->skeleton;
    const Eigen::VectorXd found = search.search(problem, dofs, lost, {}), again = search.search(problem, dofs, lost, {});
    if (found.size() != dofs.size() || !found.allFinite()) {
      broken.push_back("expected " + std::to_string(dofs.size()) + " finite degrees of freedom, found " +
                       std::to_string(found.size()));
      return;
    }
    std::vector<char> may_move(dofs.size(), 0);
    for (const Limb &limb : lost)
      for (int dof : limb.dofs)
        may_move[dof] = 1;
    for (Eigen::Index i = 0; i < found.size(); ++i) {
      if (!may_move[i] && found[i] != dofs[i])
        broken.push_back("degree of freedom " + std::to_string(i) + " is of no lost limb, and was moved");
      else if (found[i] < skeleton.lower[i] || found[i] > skeleton.upper[i])
        broken.push_back("degree of freedom " + std::to_string(i) + " is beyond its limits");
    }
    const LimbSearchOptions usual;
    const Eigen::VectorXd before = limb_errors(problem, dofs, lost, usual, {}),
                          after = limb_errors(problem, found, lost, usual, {});
    if (before.size() > 0 && before.maxCoeff() > usual.lost_error && !(after.sum() < before.sum()))
      broken.push_back("lost limbs are no nearer to the masks than they were");
    if (again.size() != found.size() || again != found)
      broken.push_back("a second call gives other bits");
    if (const Eigen::VectorXd kept = search.search(problem, dofs, {}, {}); kept.size() != dofs.size() || kept != dofs)
      broken.push_back("a pose without lost limbs was changed");
  });
}

/// A performance of the actor and observations of the same frames and all cameras, in the order of the video; its surface covers
/// the ready masks of the last frame, if there are any; the same bits in a second call; a rig with another number of cameras is
/// refused. Arguments as in PerformanceCapture::capture.
inline std::vector<std::string> performance_capture_violations(PerformanceCapture &capture, const RiggedMesh &actor,
                                                               const CameraRig &rig, FrameSource &frames,
                                                               const SilhouetteExtractor *extractor = nullptr) {
  return detail::tried("the capture", [&](std::vector<std::string> &broken) {
    const CaptureResult found = capture.capture(actor, rig, frames, extractor, {});
    try {
      require_performance(found.performance, actor, "performance");
    } catch (const std::exception &error) {
      broken.push_back(error.what());
      return;
    }
    const std::vector<int> &numbers = found.performance.frames;
    const std::size_t count = found.performance.surface.frames.size();
    if (numbers.size() != count || !std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>()) || numbers.front() < 0 ||
        numbers.back() >= frames.frame_count())
      broken.push_back("expected a frame number of the film for each frame, in rising order");
    else if (const double covered =
                 detail::overlap(found.performance.surface.frames.back(), actor.mesh.faces, rig, frames, numbers.back());
             covered < 0.5)
      broken.push_back("the captured surface is not where the cameras see the actor: it overlaps the masks of frame " +
                       std::to_string(numbers.back()) + " by " + std::to_string(covered));
    const Observations &seen = found.observations;
    if (seen.frames != numbers || seen.views.size() != count || seen.cameras.size() != rig.size())
      broken.push_back("expected observations of the same frames, and all cameras");
    for (const auto &views : seen.views)
      if (views.size() != rig.size()) {
        broken.push_back("expected one observation a camera and frame");
        break;
      }
    const CaptureResult again = capture.capture(actor, rig, frames, extractor, {});
    if (again.performance.surface.frames != found.performance.surface.frames || again.performance.dofs != found.performance.dofs)
      broken.push_back("a second call gives other bits");
    try {
      capture.capture(actor, CameraRig(rig.begin(), rig.end() - 1), frames, extractor, {});
      broken.push_back("a rig without one of the cameras is not refused");
    } catch (const std::exception &) { // of whatever kind: Python has its own
    }
  });
}

} // namespace doublet::testing
