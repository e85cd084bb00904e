// The loops of ClothView, compiled with -mavx2 on x86-64.

#define DOUBLET_FIT_ISA avx2
#ifdef __AVX2__
#include "lane_loops.h"
#else
#include "lane_kernels.h"
#endif

namespace doublet::fit {

const LaneKernels *avx2_kernels([[maybe_unused]] int width) {
#ifdef __AVX2__
  return &avx2::kWidths[width];
#else
  return nullptr;
#endif
}

} // namespace doublet::fit
