#pragma once
// The shapes of a baked mesh as glTF has them: what is added to the mesh's own vertices and normals, by weights that change.

#include "bone_shapes.h"

#include "doublet/core/context.h"

namespace doublet {

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kMostSteps = 32767; ///< of 16 bits

/// Before the bones move it, the mesh at a key is its own vertices and its weights times the targets; normals alike.
struct MorphTargets {
  Floats3 own, own_normals; ///< m; unit
  double step = 0;          ///< m
  FloatRows steps, turns;   ///< (targets, 3 vertices) whole numbers: of `step`, within kMostSteps; of 127ths, within 127
  Eigen::MatrixXf weights;  ///< (keys, targets) in [0, 1]
};

/// A target a key, exact; the mesh's own are the first key's.
MorphTargets key_shapes(const BoundMesh &mesh, const std::vector<int> &keys, const Context &context);

/// As many principal components of the shapes at the keys (of many keys: about those, found in some of them) as leave an error of
/// `max_error` m (RMS over keys and vertices), what rounding adds included; at most `max_targets` - 1, and one target that is
/// always there. The mesh's own vertices are the mean. Normals are those that go best with the weights of the shapes.
MorphTargets principal_shapes(const BoundMesh &mesh, const std::vector<int> &keys, double max_error, int max_targets,
                              const Context &context);

/// [frames x vertices] m, how far each vertex is from its place in the animation, in every frame.
std::vector<double> errors(const BoundMesh &mesh, const MorphTargets &targets, const std::vector<int> &keys,
                           const Context &context);

} // namespace doublet
