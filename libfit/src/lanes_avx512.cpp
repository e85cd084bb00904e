// The loops of ClothView, compiled with -mavx512f on x86-64.

#define DOUBLET_FIT_ISA avx512
#ifdef __AVX512F__
#include "lane_loops.h"
#else
#include "lane_kernels.h"
#endif

namespace doublet::fit {

const LaneKernels *avx512_kernels([[maybe_unused]] int width) {
#ifdef __AVX512F__
  return &avx512::kWidths[width];
#else
  return nullptr;
#endif
}

} // namespace doublet::fit
