#pragma once
// Binary labelling energies on a graph, and their exact minima.

#include <Eigen/Core>

#include <vector>

namespace doublet {

/// E(L) = sum over edges (a, b) with L_a != L_b of their cost - sum over vertices with L_v = 1 of their gain.
struct LabellingEnergy {
  Eigen::VectorXd gain;               ///< (V) of label 1 over label 0; finite, of any sign
  std::vector<Eigen::Vector2i> edges; ///< (E) pairs of vertices
  std::vector<double> cost;           ///< (E) at least 0
};

/// (V) the labels of the lowest energy, by a minimum cut (Boykov and Kolmogorov, An experimental comparison of min-cut/max-flow
/// algorithms, PAMI 2004; Boost's). Ties get label 0.
std::vector<char> lowest_labelling(const LabellingEnergy &energy);

/// (V) in [-largest, largest]: the margin of each label. With s * weight (V, at least 0) subtracted from all gains, vertex v has
/// label 1 for every s below its margin and 0 above: the minima for increasing s are nested (Gallo et al., A fast parametric
/// maximum flow algorithm, SIAM 1989). Resolution 2 * largest / steps; for an odd number of steps the margin is above 0 exactly
/// where the label is 1.
Eigen::VectorXd labelling_margins(const LabellingEnergy &energy, const Eigen::VectorXd &weight, double largest, int steps);

} // namespace doublet
