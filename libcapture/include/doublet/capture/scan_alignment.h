#pragma once
// Alignment of a raw scan, in any unit, with any up axis, with its floor, to the person as seen by the cameras.

#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <string>

namespace doublet {

/// The scan in the world of the cameras, and what was detected about it.
struct AlignedScan {
  Mesh mesh;           ///< m, +Y up; without floor, specks and surroundings
  std::string unit;    ///< of the scan: "m", "cm", "mm" or "inches"
  std::string up;      ///< its axis that points up: "+x" ... "-z"
  bool floor = false;  ///< it contained a floor, which was removed
  double distance = 0; ///< m to the hull, mean over the nearest four fifths of the surface
};

/// `scan`: one person, in one of those units, upright along one of its axes, perhaps on a floor, in the pose of the hull. `hull`:
/// m, +Y up, from the cameras (scan_from_views). Unit and axis follow from the hull's height; the pose is the best of 36
/// headings, refined by trimmed iterative closest points (Besl & McKay 1992). Throws std::invalid_argument if no placement is
/// close, Error if a mesh is not usable.
AlignedScan align_scan(const Mesh &scan, const Mesh &hull, const Context &context = {});

} // namespace doublet
