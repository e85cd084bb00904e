// A clip in a .glb: joints, keys and what lies between them.
#include "doublet/animate/motion_file.h"
#include "harness.h"

DOUBLET_HARNESS(gltf_motion) {
  using namespace doublet;
  fuzz::expect_read_or_refused([path = fuzz::put("clip.glb", input)] { validate(read_gltf_motion(path)); });
}

#ifdef DOUBLET_LIBFUZZER
#include "glb_mutator.h"
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  return doublet::fuzz::mutate_glb(data, size, max_size, seed);
}
#endif
