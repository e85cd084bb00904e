#pragma once
// How often colours occur on something. The ratio of two such histograms tells what a colour is of (Jones and Rehg, Statistical
// color models with application to skin detection, IJCV 2002).

#include <Eigen/Core>

namespace doublet {

/// Number of bins, over colour alone and, coarsely, brightness, which shading changes.
int colour_bin_count();

/// The bin, in [0, colour_bin_count()), of a colour: B G R, 0 to 255.
int colour_bin(const Eigen::Vector3d &bgr);

/// (colour_bin_count()) how likely each colour is, from how often it was seen (as many; 0 or more, not all 0): smoothed, and none
/// impossible. Sums to 1.1: a tenth more is spread over all colours, so that one that two histograms lack tells nothing.
Eigen::VectorXd colour_likelihoods(const Eigen::VectorXd &seen);

} // namespace doublet
