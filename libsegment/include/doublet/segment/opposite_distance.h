#pragma once
// The measure behind the segmentation (Sect. 5): how much the distance to the opposite side of the surface varies over time.

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"

#include <cstdint>
#include <vector>

namespace doublet {

struct OppositeOptions {
  int rays = 13;      ///< per vertex: the one along -n of the paper and a ring around it; the median of their deviations counts
  double cone = 0.35; ///< rad, half angle of the ring (20 degrees)
  double min_distance = 0.005; ///< m, nearer hits are the vertex's own sheet (a fold), not the opposite side
  double min_cosine = 0.5;     ///< between the ray and the outward normal where it leaves: a grazing hit slides along the surface
  double trim = 0.05; ///< fraction of the frames left out at either end of the sorted distances (lost tracking, extreme bends)
  void validate() const;
};

/// Where the rays from each vertex leave the surface, as material points.
struct OppositePoints {
  int rays = 1;
  Eigen::VectorXi face; ///< (V * rays) -1 = no usable hit: missed, grazing, an invalid face, or the vertex is on no valid face
  Vertices barycentric; ///< (V * rays, 3) of the face's corners
};

/// Rays from v_i along -n_i, and around it, in the given pose against the whole mesh, invalid faces included (they close it, but
/// do not count when hit). n_i is the normal over the valid faces. face_valid (F), empty = all valid. Throws Error on an unusable
/// mesh.
OppositePoints find_opposite_points(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                    const OppositeOptions &options = {}, const Context &context = {});

/// (V) m: trimmed standard deviation over all frames of |v_i - p_i|, median over the usable rays; NaN where fewer than half are
/// usable. With rays = 1 and trim = 0 this is the sigma(v_i) of eq. 1.
Eigen::VectorXd opposite_distance_deviation(const MeshSequence &sequence, const OppositePoints &points,
                                            const OppositeOptions &options = {}, const Context &context = {});

} // namespace doublet
