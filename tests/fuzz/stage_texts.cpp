// The files between stages that are JSON.
#include "doublet/fit/material_estimator.h"
#include "harness.h"

DOUBLET_HARNESS(stage_texts) {
  using namespace doublet;
  static const Skeleton skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, 6}, {"spine", "pelvis", {0, 1.2, 0}, 3}});
  for (const auto &[name, content] : fuzz::files_of(input, {"proxies.json", "material.json"})) {
    const Path path = fuzz::put(name, content);
    fuzz::expect_read_or_refused([&name = name, &path] {
      if (name == "proxies.json")
        read_proxies(path, skeleton);
      else
        read_materials(path);
    });
  }
}
