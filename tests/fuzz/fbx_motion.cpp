// A clip in FBX, text or binary.
#include "doublet/animate/motion_file.h"
#include "harness.h"

DOUBLET_HARNESS(fbx_motion) {
  using namespace doublet;
  fuzz::expect_read_or_refused([path = fuzz::put("clip.fbx", input)] { validate(read_fbx_motion(path)); });
}
