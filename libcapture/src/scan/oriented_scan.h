#pragma once
#include "doublet/core/mesh.h"

namespace doublet::detail {

/// The scan with its faces turned outward: faces joined by an edge run the same way round, as most of their area did, and the
/// scan as a whole, about the centres of its parts, encloses a positive volume.
Mesh oriented_scan(const Mesh &scan);

} // namespace doublet::detail
