#pragma once
// The measure behind the segmentation (Sect. 5): how much the distance to the opposite side of the surface varies over time.

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <vector>

namespace doublet {

struct OppositeOptions {
  int rays = 13;
  double cone = 0.35;
  double min_distance = 0.005;
  double min_cosine = 0.5;
  double trim = 0.05;
  static constexpr auto describe() {
    using namespace options;
    using O = OppositeOptions;
    return Description{
        "OppositeOptions",
        option(&O::rays, "rays", Range{1, 64}, "", "Number of rays per vertex: the paper's, along -n, and a ring around it",
               "The median of their deviations counts"),
        option(&O::cone, "cone", Range{0, 1.5, Open::Above}, "rad", "Half angle of the ring of rays"),
        option(&O::min_distance, "min_distance", at_least(0), "m", "Nearer hits do not count",
               "They are the vertex's own sheet (a fold), not the opposite side"),
        option(&O::min_cosine, "min_cosine", Range{-1, 1, Open::Above}, "",
               "Smallest cosine between ray and outward normal where the ray leaves", "A grazing hit slides along the surface"),
        option(&O::trim, "trim", Range{0, 0.5, Open::Above}, "",
               "Share of the frames left out at either end of the sorted distances; 0 = the paper's",
               "Lost tracking and extreme bends"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
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
OppositePoints find_opposite_points(const Mesh &pose, const Mask &face_valid, const OppositeOptions &options = {},
                                    const Context &context = {});

/// (V) m: trimmed standard deviation over all frames of |v_i - p_i|, median over the usable rays; NaN where fewer than half are
/// usable. With rays = 1 and trim = 0 this is the sigma(v_i) of eq. 1.
Eigen::VectorXd opposite_distance_deviation(const MeshSequence &sequence, const OppositePoints &points,
                                            const OppositeOptions &options = {}, const Context &context = {});

} // namespace doublet
