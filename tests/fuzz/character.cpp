// character.glb, and the picture in it.
#include "doublet/animate/character_file.h"
#include "doublet/animate/parts/image_file.h"
#include "harness.h"

DOUBLET_HARNESS(character) {
  using namespace doublet;
  fuzz::expect_read_or_refused([path = fuzz::put("character.glb", input)] {
    if (const Character character = read_character(path); !character.texture.empty())
      decode_image(character.texture);
  });
}

#ifdef DOUBLET_LIBFUZZER
#include "glb_mutator.h"
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  return doublet::fuzz::mutate_glb(data, size, max_size, seed);
}
#endif
