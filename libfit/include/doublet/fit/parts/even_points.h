#pragma once
// Points spread evenly over the box: Halton, "On the efficiency of certain quasi-random sequences of points", Numerische
// Mathematik 2, 1960.

#include "doublet/core/types.h"

namespace doublet {

/// (count, n) in (0, 1), numbers first, first + 1, ... of the sequence.
MatrixRM even_points(int count, int n, int first = 0);

} // namespace doublet
