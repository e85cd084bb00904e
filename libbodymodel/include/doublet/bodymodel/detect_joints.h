#pragma once
// Joints and landmarks of a surface that has no annotations: the body model is fitted to it without any.

#include "doublet/bodymodel/body_fitter.h"

#include <utility>

namespace doublet {

struct DetectedJoints {
  std::vector<JointAnnotation> joints;              ///< the standard 24 joints, 36 degrees of freedom; rest pose, world, m
  std::map<std::string, Eigen::Vector3d> landmarks; ///< the standard names that the model knows; on the body's surface, m
  BodyFit fit;                                      ///< the body that they were read from
  /// How far body and surface are from each other over how far the body is that looks the other way: near 1, front and back were
  /// hard to tell apart; 0 if joints were seen.
  double facing_ambiguity = 0;
};

/// surface: a person, +Y up, dressed or not; face_valid (F): 0 = invented, empty = all valid; seen: joints by the names of
/// the model whose places are known, say from images, to about 3 cm (m), or none.
/// Start with joints: they say where the body is. Without: the person stands with arms and legs apart, in one piece. Of the five
/// points that are farthest along the surface from its middle and from each other the lowest two are the feet; of the others and
/// the next three the two farthest apart are the hands, and the highest of the rest is the head. Both sides that the person may
/// face are tried: the body is fitted as if all were skin, and twice again without the surface that stands off it. The one is
/// taken that stands less out of the surface and is less far from it (sum of both means). Whatever `options` say, surface and
/// ends deviate by at least 5 cm, as clothes do and points found so, and seen joints by 3 cm. Throws Error if the five are not
/// found, fewer than three joints are the model's, the model lacks a joint or landmark that is needed, or the body stays farther
/// from the surface than a person's can; else as BodyFitter::fit.
DetectedJoints detect_joints(const Mesh &surface, const Mask &face_valid, const BodyModel &model,
                             const BodyFitOptions &options = {}, const std::map<std::string, Eigen::Vector3d> &seen = {},
                             const Context &context = {});

// Deprecated names.
template <class... A> [[deprecated("use detect_joints")]] decltype(auto) find_body_marks(A &&...a) {
  return detect_joints(std::forward<A>(a)...);
}
using BodyMarks [[deprecated("use DetectedJoints")]] = DetectedJoints;

} // namespace doublet
