// The loops for one simulation, and for four in the registers that every processor of the architecture has (SSE2, NEON).

#include "lane_solver.h"

namespace doublet::pbd {

LaneGroup *make_group_1(const LaneModel &model) {
  return new LaneSolver<float>(model);
}
LaneGroup *make_group_4(const LaneModel &model) {
  return new LaneSolver<Pack<4>>(model);
}

} // namespace doublet::pbd
