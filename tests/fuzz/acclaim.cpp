// A skeleton and a motion for it.
#include "doublet/animate/motion_file.h"
#include "harness.h"

DOUBLET_HARNESS(acclaim) {
  using namespace doublet;
  auto files = fuzz::files_of(input, {"person.asf", "person.amc"});
  fuzz::expect_read_or_refused(
      [&] { validate(parse_acclaim(files["person.asf"], files["person.amc"], "person.asf", "person.amc")); });
}
