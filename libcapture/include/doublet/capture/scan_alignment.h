#pragma once
// A scan as a scanner leaves it, in any unit, on any axis, with its floor, brought to where the cameras see the person.

#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <string>

namespace doublet {

/// The scan in the world of the cameras, and what was found out about it.
struct AlignedScan {
  Mesh mesh;           ///< m, +Y up; without floor, specks and surroundings
  std::string unit;    ///< of the scan: "m", "cm", "mm" or "inches"
  std::string up;      ///< its axis that points up: "+x" ... "-z"
  bool floor = false;  ///< the person stood on one
  double distance = 0; ///< m to the hull, mean over the nearest four fifths of the surface
};

/// `scan`: of one person, in one of those units, upright along one of its axes, perhaps on a floor, in the pose of the hull.
/// `hull`: m, +Y up, what the cameras see (scan_from_views). Units and axis follow from the hull's height, the place from the
/// nearest of 36 headings, refined (iterative closest points; Besl & McKay 1992, trimmed). Throws std::invalid_argument if no
/// placement is near, Error if a mesh is not usable.
AlignedScan align_scan(const Mesh &scan, const Mesh &hull, const Context &context = {});

} // namespace doublet
