#pragma once

namespace doublet::pbd {

/// Times its length at rest that an edge of cloth may be: in our solver, where edges collide, and as it is drawn.
constexpr double kLongestStretch = 1.8;

} // namespace doublet::pbd
