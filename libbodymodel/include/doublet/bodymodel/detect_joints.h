#pragma once
// Joints and landmarks of a surface without annotations: the body model is fitted to it without any.

#include "doublet/bodymodel/body_fitter.h"

#include <utility>

namespace doublet {

struct DetectedJoints {
  std::vector<JointAnnotation> joints;              ///< the standard 24 joints, 36 degrees of freedom; rest pose, world, m
  std::map<std::string, Eigen::Vector3d> landmarks; ///< the standard names that the model knows; on the body's surface, m
  BodyFit fit;                                      ///< the body that they were read from
  /// Distance between body and surface, divided by that of the body fitted to face the other way: near 1, front and back could
  /// hardly be distinguished; 0 if `seen` was given.
  double facing_ambiguity = 0;
};

/// surface: a person, +Y up, dressed or not; face_valid (F): 0 = invented, empty = all valid; seen: names of the model's joints
/// -> positions (m) known to about 3 cm, for instance from images; may be empty. With `seen`, these joints place the body.
/// Without, the person must stand with arms and legs apart and the surface must be one piece: of the five points that are
/// farthest along the surface from its middle and from each other, the lowest two are the feet; of the others and the next three,
/// the two farthest apart are the hands, and the highest of the rest is the head. Both directions that the person may face are
/// tried: the body is fitted as if all were skin, and twice again without the surface that lies off it. The result is the body
/// with the smaller sum of two means: how far it protrudes from the surface, and its distance from it. Whatever `options` say,
/// the expected error is at least 5 cm for the surface (clothes) and for the ends of limbs, and 3 cm for seen joints. Throws
/// Error if the five points are not found, fewer than three joints are the model's, the model lacks a joint or landmark that is
/// needed, or the body stays farther from the surface than a person's can; else as BodyFitter::fit.
DetectedJoints detect_joints(const Mesh &surface, const Mask &face_valid, const BodyModel &model,
                             const BodyFitOptions &options = {}, const std::map<std::string, Eigen::Vector3d> &seen = {},
                             const Context &context = {});

// Deprecated names.
template <class... A> [[deprecated("use detect_joints")]] decltype(auto) find_body_marks(A &&...a) {
  return detect_joints(std::forward<A>(a)...);
}
using BodyMarks [[deprecated("use DetectedJoints")]] = DetectedJoints;

} // namespace doublet
