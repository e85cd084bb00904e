#pragma once
// Colour histograms. The ratio of the likelihoods of a colour under two histograms tells to which a pixel belongs (Jones and
// Rehg, Statistical color models with application to skin detection, IJCV 2002).

#include <Eigen/Core>

namespace doublet {

/// Number of bins, over chromaticity and, coarsely because shading changes it, brightness.
int colour_bin_count();

/// The bin, in [0, colour_bin_count()), of a colour: B G R, 0 to 255.
int colour_bin(const Eigen::Vector3d &bgr);

/// (colour_bin_count()) likelihoods of the colours from their counts `seen` (same size; 0 or more, not all 0), smoothed and all
/// above 0. They sum to 1.1: an extra tenth is spread over all colours, so that a colour which neither of two histograms has
/// decides nothing.
Eigen::VectorXd colour_likelihoods(const Eigen::VectorXd &seen);

} // namespace doublet
