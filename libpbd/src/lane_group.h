#pragma once
// Simulations of one model that step together, one in each lane: the door between the solver, which is compiled for every
// processor, and the loops, which are compiled once for each instruction set (lanes_*.cpp). Data and virtual functions alone: see
// lane.h.

#include "lane_model.h"

namespace doublet::pbd {

/// One substep's numbers, in each lane.
template <class T> struct Substep {
  T h;                     ///< s
  T k_bend, k_stretch;     ///< per iteration; the compliances of the kernels where the model is compliant
  T bend_relaxation;       ///< where the model is compliant, see soft_bend_multiplier
  T k_friction, k_damping; ///< per substep
  T half_dn_h, tangential_factor;
  T wind[3];    ///< m/s
  T gravity[3]; ///< m/s^2
};

class LaneGroup {
public:
  LaneGroup();
  virtual ~LaneGroup();
  virtual int lanes() const = 0;

  // Arrays to be filled in before the first substep, coordinate k of vertex i in lane l at [i vertex_stride + k lanes + l].
  virtual int vertex_stride() const = 0;
  virtual float *positions() = 0;
  virtual float *velocities() = 0;
  // The same with [(i 3 + k) lanes + l], i an index into the model's followers.
  virtual float *targets_start() = 0; ///< of the frame
  virtual float *targets_end() = 0;
  // Value j of capsule i in lane l at [(i value_count + j) lanes + l], the values of CapsuleMotion<float>.
  virtual float *capsules(int count) = 0;
  // Value j in lane l at [j lanes + l], the values of Substep<float>.
  virtual float *substep() = 0;

  /// At the start of a frame: finds where the cloth has passed through itself.
  virtual void find_knots() = 0;
  /// One substep, at whose end the fraction `end` of the frame has passed.
  virtual void advance(float end) = 0;
  /// In each lane 0, or not a number if one of its positions or velocities is not finite.
  virtual const float *zero_if_finite() = 0;
};

/// Caller owns the result. The last five exist on x86-64 alone, and ask for AVX2 with FMA and for AVX-512 (F and VL).
LaneGroup *make_group_1(const LaneModel &model);
LaneGroup *make_group_4(const LaneModel &model);
LaneGroup *make_group_1_avx2(const LaneModel &model);
LaneGroup *make_group_4_avx2(const LaneModel &model);
LaneGroup *make_group_8(const LaneModel &model);
LaneGroup *make_group_8_avx512(const LaneModel &model);
LaneGroup *make_group_16(const LaneModel &model);

// What the loops ask of the rest of the program.

/// 64-byte aligned.
void *lane_allocate(unsigned long bytes);
void lane_free(void *block);
/// Angular velocity (3), 1/s, of a body with this inertia (xx, xy, xz, yy, yz, zz) and angular momentum (3) about its centre.
void lane_spin(const float *inertia, const float *momentum, float *spin);

} // namespace doublet::pbd
