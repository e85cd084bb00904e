#include "doublet/core/parts/labelling.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace doublet {
namespace {

// Whole numbers: a flow of floating-point numbers would leave rests that depend on the order of the paths.
using Flow = std::int64_t;
using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using EdgeProperties = boost::property<
    boost::edge_capacity_t, Flow,
    boost::property<boost::edge_residual_capacity_t, Flow, boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>;
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, EdgeProperties>;

void connect(Graph &graph, int a, int b, Flow there, Flow back) {
  const auto forth = boost::add_edge(a, b, graph).first, reverse = boost::add_edge(b, a, graph).first;
  boost::put(boost::edge_capacity, graph, forth, there);
  boost::put(boost::edge_capacity, graph, reverse, back);
  boost::put(boost::edge_reverse, graph, forth, reverse);
  boost::put(boost::edge_reverse, graph, reverse, forth);
}

/// Units of flow in one of energy: as fine as 2^52 in all can be.
double resolution(const LabellingEnergy &energy) {
  double total = energy.gain.cwiseAbs().sum();
  for (const double cost : energy.cost)
    total += cost;
  return total > 0 ? std::ldexp(1.0, 52) / total : 1.0;
}

} // namespace

std::vector<char> lowest_labelling(const LabellingEnergy &energy) {
  const int n = static_cast<int>(energy.gain.size()), source = n, sink = n + 1;
  const double unit = resolution(energy);
  const auto flow = [&](double value) { return static_cast<Flow>(std::llround(unit * std::max(0.0, value))); };
  Graph graph(static_cast<std::size_t>(n) + 2);
  for (int v = 0; v < n; ++v) {
    if (energy.gain[v] > 0)
      connect(graph, source, v, flow(energy.gain[v]), 0);
    else if (energy.gain[v] < 0)
      connect(graph, v, sink, flow(-energy.gain[v]), 0);
  }
  for (std::size_t e = 0; e < energy.edges.size(); ++e)
    connect(graph, energy.edges[e][0], energy.edges[e][1], flow(energy.cost[e]), flow(energy.cost[e]));

  std::vector<boost::default_color_type> tree(boost::num_vertices(graph));
  const auto index = boost::get(boost::vertex_index, graph);
  std::vector<Traits::edge_descriptor> predecessor(tree.size());
  std::vector<long> distance(tree.size());
  boost::boykov_kolmogorov_max_flow(graph, boost::get(boost::edge_capacity, graph),
                                    boost::get(boost::edge_residual_capacity, graph), boost::get(boost::edge_reverse, graph),
                                    boost::make_iterator_property_map(predecessor.begin(), index),
                                    boost::make_iterator_property_map(tree.begin(), index),
                                    boost::make_iterator_property_map(distance.begin(), index), index, source, sink);
  std::vector<char> labels(n);
  for (int v = 0; v < n; ++v)
    labels[v] = tree[v] == boost::black_color; // what the source still reaches
  return labels;
}

Eigen::VectorXd labelling_margins(const LabellingEnergy &energy, const Eigen::VectorXd &weight, double largest, int steps) {
  Eigen::VectorXd margin = Eigen::VectorXd::Constant(energy.gain.size(), -largest);
  const double step = 2 * largest / steps;
  LabellingEnergy shifted = energy;
  for (int k = 0; k < steps; ++k) {
    const double shift = -largest + (k + 0.5) * step;
    shifted.gain = energy.gain - shift * weight;
    const std::vector<char> labels = lowest_labelling(shifted);
    for (Eigen::Index v = 0; v < margin.size(); ++v)
      if (labels[v])
        margin[v] = std::min(shift + step / 2, largest);
  }
  return margin;
}

} // namespace doublet
