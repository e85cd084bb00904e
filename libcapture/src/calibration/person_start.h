#pragma once
// Where a bundle adjustment of cameras and joints begins.

#include "person_bundle.h"

namespace doublet::detail {

/// Cameras and joints that are about right: the best of several beginnings, which differ in the first two cameras and in the
/// focal length where it is not known. frames: those whose joints count. Throws Error naming the camera that finds no place.
PersonBundle begin_bundle(const std::vector<PersonView> &views, const std::vector<int> &frames,
                          const PersonCalibrationOptions &options, const Context &context);

} // namespace doublet::detail
