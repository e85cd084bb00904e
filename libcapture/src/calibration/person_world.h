#pragma once
// Where the world of a bundle adjustment is: up, floor, scale.

#include "person_bundle.h"

namespace doublet::detail {

/// Turns, shifts and scales the world: +Y up, y = 0 the floor, she stands at the origin in the first of her standing moments,
/// looks along +Z, and is as tall (m) as was said. frames: those of the bundle's moments. Throws Error if she is never seen
/// standing.
void stand_upright(const std::vector<PersonView> &views, const std::vector<int> &frames, double height, PersonBundle &bundle);

} // namespace doublet::detail
