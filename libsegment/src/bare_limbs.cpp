#include "bare_limbs.h"

#include "doublet/core/parts/edge_distances.h"

#include <algorithm>
#include <cmath>

namespace doublet::detail {
namespace {

constexpr double kStep = 0.03; // m, along the limb
constexpr int kAhead = 3;      // steps that must be wider: a hem, not a heel
constexpr double kWider = 1.5; // times the widest so far
constexpr double kLongest = 1; // m, no limb is

/// m, the surface's girth in each step of `way` (V): its area there by the step's length.
std::vector<double> girths(const Surface &surface, const Eigen::VectorXd &way) {
  std::vector<double> result(static_cast<std::size_t>(kLongest / kStep), 0.0);
  for (int v = 0; v < surface.size(); ++v)
    if (way[v] > 0 && way[v] < kStep * static_cast<double>(result.size()))
      result[static_cast<std::size_t>(way[v] / kStep)] += surface.areas[v] / kStep;
  return result;
}

/// Does a limb, or the neck, end at the joint? Not so the trunk, which the root carries.
bool is_end(const Skeleton &skeleton, int joint) {
  return skeleton.joints[joint].parent > 0 && is_leaf(skeleton, joint);
}

} // namespace

bool is_leaf(const Skeleton &skeleton, int joint) {
  return std::none_of(skeleton.joints.begin(), skeleton.joints.end(), [&](const Joint &j) { return j.parent == joint; });
}

std::vector<char> limb_below_hem(const Surface &surface, const std::vector<int> &end) {
  const Eigen::VectorXd way = edge_distances(surface.vertices, surface.neighbours, end, kLongest);
  const std::vector<double> girth = girths(surface, way);
  double widest = 0;
  for (std::size_t step = 1; step + kAhead <= girth.size(); ++step) {
    widest = std::max(widest, 0.5 * (girth[step - 1] + girth[step])); // of two, since a step has few vertices
    double ahead = 0;
    for (std::size_t k = step + 1; k <= step + kAhead && k < girth.size(); ++k)
      ahead += girth[k] / kAhead;
    if (ahead > kWider * widest)
      return choose(surface, [&](int v) { return way[v] <= kStep * static_cast<double>(step + 1); });
  }
  return {};
}

void strip_bare_limbs(const RiggedMesh &actor, const Mesh &pose, Segmentation &segmentation, const Context &context) {
  const Surface surface = surface_of(pose, actor.face_valid);
  bool stripped = false;
  for (int joint = 0; joint < actor.skeleton.joint_count(); ++joint) {
    if (!is_end(actor.skeleton, joint))
      continue;
    const auto share = actor.weights.col(actor.skeleton.joints[joint].parent); // of the bone that ends there
    const std::vector<char> at_end = choose(surface, [&](int v) { return share[v] > 0.5; });
    std::vector<int> end;
    double area = 0, cloth = 0;
    for (int v = 0; v < surface.size(); ++v)
      if (at_end[v]) {
        end.push_back(v);
        area += surface.areas[v];
        cloth += segmentation.clothness[v] > 0.5 ? surface.areas[v] : 0.0;
      }
    if (!(cloth > 0.5 * area))
      continue;
    const std::vector<char> limb = limb_below_hem(surface, end);
    for (std::size_t v = 0; v < limb.size(); ++v)
      if (limb[v])
        segmentation.clothness[static_cast<Eigen::Index>(v)] = 0;
    stripped |= !limb.empty();
    context.say("segment: " + actor.skeleton.joints[joint].name + " moved like cloth, " +
                (limb.empty() ? "and no hem was found above it" : "and counts as skin up to where it widens"));
  }
  if (stripped)
    label_regions(surface, borders_of_regions(surface, segmentation), segmentation);
}

} // namespace doublet::detail
