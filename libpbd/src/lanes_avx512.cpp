// The loops for sixteen simulations. Compiled with -mavx512f -mfma on x86-64.

#define DOUBLET_PBD_ISA avx512
#include "lane_solver.h"

namespace doublet::pbd {

#ifdef __AVX512F__
LaneGroup *make_group_16(const LaneModel &model) {
  return new LaneSolver<Pack<16>>(model);
}
LaneGroup *make_group_8_avx512(const LaneModel &model) {
  return new LaneSolver<Pack<8>>(model);
}
#endif

} // namespace doublet::pbd
