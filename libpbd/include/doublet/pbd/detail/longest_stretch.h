#pragma once

namespace doublet::pbd::detail {

/// Times its length at rest that an edge of cloth may be: of our solver, where edges collide, and of what is drawn from its
/// state.
constexpr double kLongestStretch = 1.8;

} // namespace doublet::pbd::detail
