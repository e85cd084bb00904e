#pragma once
// The shape that a garment's lengths come from, out of all captured frames.

#include "doublet/core/mesh.h"

#include <vector>

namespace doublet::detail {

/// (N, 3) m. A scan shows a garment hanging in folds, of which it bridges those that it cannot see into: made of it, a skirt is
/// too narrow to fly. Cloth hardly stretches, so what the video shows it spanning, it has. `scan` (N, 3): the mesh in the scan
/// pose; `frames`: in the captured frames (none: the answer is `scan`, untangled), of which it is spread out in number `wide`;
/// `attached`: the vertices that the garment hangs from.
///  1. The frames are smoothed (Taubin 1995, which does not shrink): their roughness would count as length.
///  2. An edge gets the length that it exceeds in the share `exceedance` of the frames.
///  3. The smoothest surface with these lengths (bending against springs), from the wide frame: a metric that is not smooth
///  crumples.
///  4. The way from the attachment is known from the scan, where cloth hangs straight: edges lead away from it as far as there.
///  5. Blown up around the body in the scan pose: cloth that begins there folds by itself, without knots, and holds what it held.
///  Where it passes through itself even so, or a triangle lies folded on the next one, it is smoothed until it does not, or 24
///  times: cloth in a knot at rest never leaves it, and what is drawn of a folded triangle is stretched when that opens.
Vertices rest_shape(const Faces &faces, const Vertices &scan, const std::vector<Vertices> &frames, int wide,
                    const std::vector<int> &attached, double exceedance);

} // namespace doublet::detail
