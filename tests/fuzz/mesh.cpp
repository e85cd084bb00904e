// Meshes: a file of one of the four formats.
#include "doublet/capture/mesh_file.h"
#include "harness.h"

DOUBLET_HARNESS(mesh) {
  using namespace doublet;
  for (const auto &[name, content] : fuzz::files_of(input, {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.off"}))
    fuzz::expect_read_or_refused([path = fuzz::put(name, content)] { read_mesh(path); });
}
