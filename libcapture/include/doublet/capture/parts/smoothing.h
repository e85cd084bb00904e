#pragma once
// Smoothing in time (Sect. 4) and the measure of what it removes.

#include "doublet/core/types.h"

namespace doublet {

/// Savitzky & Golay 1964: every column of `samples` (T, C) is replaced by the least-squares polynomial of degree `order` over
/// `window` (odd) frames, evaluated at the frame; at the ends the polynomial of the first or last full window. A window of 1, or
/// T < window, changes nothing.
MatrixRM savitzky_golay(const MatrixRM &samples, int window, int order);

/// (window, window): row i = the filter's weights for the value at the i-th frame of the window.
MatrixRM savitzky_golay_weights(int window, int order);

/// Mean |x[t-1] - 2 x[t] + x[t+1]| over frames and the given columns; 0 if T < 3.
double mean_second_difference(const MatrixRM &samples, int first_column, int column_count);

} // namespace doublet
