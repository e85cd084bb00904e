// From a capture session to an animatable character, in C++: the stages that `doublet reconstruct` runs, to the same files
// (docs/formats.md). What is up to date is not run again.
//   reconstruct SESSION OUT body_model.npz

#include "doublet/core/error.h"
#include "doublet/reconstruct/reconstruction.h"

#include <cstdio>

int main(int count, char **arguments) try {
  if (count != 4)
    throw doublet::Error("usage: reconstruct SESSION OUT body_model.npz");
  doublet::ReconstructionOptions options;
  options.body_model = arguments[3];
  doublet::Reconstruction reconstruction(arguments[1], arguments[2], options);
  reconstruction.announce = [](const std::string &line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  reconstruction.run_all();
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
