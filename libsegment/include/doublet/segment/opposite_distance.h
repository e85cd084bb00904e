#pragma once
// The measure behind the segmentation (Sect. 5): how much the distance to the opposite side of the surface varies over time.

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"

#include <cstdint>
#include <vector>

namespace doublet {

struct OppositeOptions {
  double min_distance = 0.005; ///< m, nearer hits are the vertex's own sheet (a fold), not the opposite side
  double min_cosine = 0.5;     ///< between the ray and the outward normal where it leaves: a grazing hit slides along the surface
  double trim = 0.05; ///< fraction of the frames left out at either end of the sorted distances (lost tracking, extreme bends)
  void validate() const;
};

/// Where the ray from each vertex leaves the surface, as a material point.
struct OppositePoints {
  Eigen::VectorXi face; ///< (V) -1 = no usable hit: missed, grazing, an invalid face, or the vertex is on no valid face
  Vertices barycentric; ///< (V, 3) of the face's corners
};

/// Rays from v_i along -n_i in the given pose against the whole mesh, invalid faces included (they close it, but do not count
/// when hit). n_i is the normal over the valid faces. face_valid (F), empty = all valid. Throws Error on an unusable mesh.
OppositePoints find_opposite_points(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                    const OppositeOptions &options = {}, const Context &context = {});

/// (V) m: trimmed standard deviation over all frames of |v_i - p_i|; NaN where there is no opposite point.
/// With trim = 0 this is the sigma(v_i) of eq. 1.
Eigen::VectorXd opposite_distance_deviation(const MeshSequence &sequence, const OppositePoints &points,
                                            const OppositeOptions &options = {}, const Context &context = {});

} // namespace doublet
