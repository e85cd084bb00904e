// The loops of ClothView, compiled for every processor of the architecture.

#define DOUBLET_FIT_ISA baseline
#include "lane_loops.h"

namespace doublet::fit {

const LaneKernels *baseline_kernels(int width) {
  return &baseline::kWidths[width];
}

} // namespace doublet::fit
