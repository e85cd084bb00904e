#pragma once
// What the tracker learns of the surface beyond its skeleton: where it lies off its skinned place, and how firm it is.

#include "doublet/capture/pose_optimizer.h"

#include <utility>
#include <vector>

namespace doublet::detail {

/// How far each vertex usually lies from its skinned position, learnt as the frames come: the mean square of all frames so far,
/// or of the last ten if that is larger, spread over neighbours.
class ClothDeviation {
public:
  /// `loose`: m, the deviation at which a vertex is half as reliable as a firm one.
  ClothDeviation(const RiggedMesh &actor, double loose);
  void learn(const Vertices &refined, const Vertices &skinned);
  /// Starts again from what all frames together say: the median, so that a limb that was lost for a while does not pass for
  /// cloth.
  void settle(const std::vector<Vertices> &offsets);
  /// (V) in (0, 1]: 1 / (1 + (d / loose)^2).
  Eigen::VectorXd reliability() const;
  /// (V) in [0, 1): what is not reliable.
  Eigen::VectorXd looseness() const { return 1 - reliability().array(); }

private:
  Eigen::VectorXd spread(const Eigen::VectorXd &d) const;

  std::vector<std::pair<int, int>> edges_;
  double loose_;
  Eigen::VectorXd all_, recent_; // m^2
  int frames_ = 5;               // the expectation counts as five frames
};

/// (V, 3) m, the surface minus the actor's mesh in the rest pose of each vertex's blended bone.
Vertices rest_offset(const RiggedMesh &actor, const Transforms &blend, const Vertices &surface);

/// The non-rigid part of the motion, frame by frame, and what of it is expected at the next one.
class SurfaceMemory {
public:
  /// `decay`: what of the loose part is expected of the next frame.
  SurfaceMemory(const RiggedMesh &actor, double loose, double decay, int count);
  /// Takes in the refined surface of frame index t, over what skinning alone makes of its pose.
  void learn(int t, const Vertices &refined, const PosedSurface &skinned);
  /// A second pass begins, knowing what is loose: with the offset of frame index t if it is one, else with none.
  void start_again(int t);
  Eigen::VectorXd reliability() const { return deviation_.reliability(); }
  const ClothDeviation &deviation() const { return deviation_; }
  const Vertices &expected() const { return expected_; }
  void expect(Vertices offset) { expected_ = std::move(offset); }
  const std::vector<Vertices> &offsets() const { return offsets_; }

private:
  const RiggedMesh &actor_;
  double decay_;
  ClothDeviation deviation_;
  Vertices expected_;             // (V, 3) m, rest pose
  std::vector<Vertices> offsets_; // T x (V, 3) m, refined, rest pose; empty until the frame is tracked
};

} // namespace doublet::detail
