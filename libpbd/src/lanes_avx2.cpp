// The loops for eight simulations, and once more for one and four. Compiled with -mavx2 -mfma on x86-64.

#define DOUBLET_PBD_ISA avx2
#include "lane_solver.h"

namespace doublet::pbd {

#if defined(__AVX2__) && defined(__FMA__)
LaneGroup *make_group_1_avx2(const LaneModel &model) {
  return new LaneSolver<float>(model);
}
LaneGroup *make_group_4_avx2(const LaneModel &model) {
  return new LaneSolver<Pack<4>>(model);
}
LaneGroup *make_group_8(const LaneModel &model) {
  return new LaneSolver<Pack<8>>(model);
}
#endif

} // namespace doublet::pbd
