#include "doublet/animate/motion_file.h"
#include "harness.h"

DOUBLET_HARNESS(bvh) {
  using namespace doublet;
  fuzz::expect_read_or_refused([&] { validate(parse_bvh(std::string(input), "motion.bvh")); });
}
