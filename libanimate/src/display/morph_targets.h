#pragma once
// The shapes of a baked mesh as glTF has them: what is added to the mesh's own vertices and normals, by weights that change.

#include "bone_shapes.h"

#include "doublet/core/context.h"

namespace doublet {

constexpr int kMostSteps = 32767;                ///< of 16 bits
constexpr double kLeastStep = 1e-3 / kMostSteps; ///< m, so that shapes that do not differ have one

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Before the bones move it, the mesh at a key is its own vertices and its weights times the targets; normals alike.
struct MorphTargets {
  Floats3 own, own_normals; ///< m; unit
  FloatRows steps, turns;   ///< (targets, 3 vertices) m; of normals
  Eigen::MatrixXf weights;  ///< (keys, targets) in [-1, 1]
};

/// A target a key, exact; the mesh's own are the first key's.
MorphTargets key_shapes(const BoundMesh &mesh, const std::vector<int> &keys, const Context &context);

/// As many principal components of the shapes at the keys as leave an error of `max_error` m (RMS over keys and vertices), their
/// rounding to `step` m included, but not more than `max_targets`. The mesh's own vertices are the mean. Normals are those that
/// go best with the weights of the shapes.
MorphTargets principal_shapes(const BoundMesh &mesh, const std::vector<int> &keys, double max_error, double step, int max_targets,
                              const Context &context);

/// m, the largest coordinate of a target.
double farthest(const MorphTargets &targets);
/// Rounds to whole numbers: steps of `step` m, at most kMostSteps of them, and 127ths of a unit normal, at most 127.
void round_targets(MorphTargets &targets, double step);

/// [frames x vertices] m, how far each vertex of rounded targets is from its place in the animation, in every frame.
std::vector<double> errors(const BoundMesh &mesh, const MorphTargets &rounded, const std::vector<int> &keys, double step,
                           const Context &context);

} // namespace doublet
