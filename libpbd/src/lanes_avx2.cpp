// The loops for eight simulations. Compiled with -mavx2 on x86-64.

#define DOUBLET_PBD_ISA avx2
#include "lane_solver.h"

namespace doublet::pbd {

LaneGroup *make_group_8([[maybe_unused]] const LaneModel &model) {
#ifdef __AVX2__
  return new LaneSolver<Pack<8>>(model);
#else
  return nullptr;
#endif
}

} // namespace doublet::pbd
