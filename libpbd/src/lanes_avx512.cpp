// The loops for sixteen simulations. Compiled with -mavx512f on x86-64.

#define DOUBLET_PBD_ISA avx512
#include "lane_solver.h"

namespace doublet::pbd {

LaneGroup *make_group_16([[maybe_unused]] const LaneModel &model) {
#ifdef __AVX512F__
  return new LaneSolver<Pack<16>>(model);
#else
  return nullptr;
#endif
}

} // namespace doublet::pbd
