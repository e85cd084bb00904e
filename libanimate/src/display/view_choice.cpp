// Which frame each face is taken from: a labelling, by alpha expansion.

#include "doublet/core/parts/labelling.h"
#include "face_views.h"

#include <algorithm>
#include <cmath>

namespace doublet::detail {
namespace {

/// Expands one label: the faces that take it lower the energy most (Boykov, Veksler, Zabih 2001; of a Potts model every
/// expansion is a minimum cut).
class Expansion {
public:
  explicit Expansion(FilmedFaces &filmed)
      : filmed_(filmed), beside_(filmed.views.size()), costs_(filmed.views.size()), node_(filmed.views.size(), -1) {
    find_borders();
    const Eigen::VectorXd areas = face_areas(filmed.mesh.vertices, filmed.mesh.faces);
    for (std::size_t f = 0; f < costs_.size(); ++f)
      for (const FaceView &view : filmed.views[f])
        costs_[f].push_back(areas[static_cast<Eigen::Index>(f)] * cost_of(view, filmed.views[f]));
  }

  /// The best view of every face for itself.
  void begin() {
    for (std::size_t f = 0; f < costs_.size(); ++f)
      if (!costs_[f].empty())
        filmed_.label[f] = filmed_.views[f][std::min_element(costs_[f].begin(), costs_[f].end()) - costs_[f].begin()].frame;
  }

  /// `faces` that have the view, with its index among theirs. True if any changed.
  bool expand(int label, const std::vector<ShownFace> &faces) {
    std::vector<ShownFace> nodes;
    for (const auto &[f, i] : faces)
      if (filmed_.label[f] != label) {
        node_[f] = static_cast<int>(nodes.size());
        nodes.push_back({f, i});
      }
    const LabellingEnergy energy = energy_of(label, nodes);
    const std::vector<char> taken = lowest_labelling(energy);
    bool changed = false;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      node_[nodes[n].face] = -1;
      if (taken[n])
        filmed_.label[nodes[n].face] = label;
      changed |= taken[n] != 0;
    }
    return changed;
  }

private:
  static constexpr double kSeam = 0.02; // m: what a metre of border costs, in square metres that are not seen
  struct Beside {
    int face;
    double cost;
  };

  /// What it costs that two faces are of different frames.
  void find_borders() {
    const Mesh &mesh = filmed_.mesh;
    const EdgeTopology topology = edge_topology(mesh.faces);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
      const auto [first, second] = std::pair(topology.edge_faces[e][0], topology.edge_faces[e][1]);
      if (second < 0 || filmed_.views[first].empty() || filmed_.views[second].empty())
        continue;
      const Eigen::Vector2i &ends = topology.edges[e];
      const double cost = kSeam * (mesh.vertices.row(ends[0]) - mesh.vertices.row(ends[1])).norm();
      beside_[first].push_back({second, cost});
      beside_[second].push_back({first, cost});
    }
  }

  /// 0 = the best view of the face, 1 = one that shows nothing.
  static double cost_of(const FaceView &view, const std::vector<FaceView> &views) {
    float best = 0;
    for (const FaceView &other : views)
      best = std::max(best, worth(other));
    return best > 0 ? 1 - worth(view) / best : 0;
  }

  double cost_now(int f) const {
    const auto &views = filmed_.views[f];
    for (std::size_t i = 0; i < views.size(); ++i)
      if (views[i].frame == filmed_.label[f])
        return costs_[f][i];
    return 0;
  }

  LabellingEnergy energy_of(int label, const std::vector<ShownFace> &nodes) const {
    LabellingEnergy energy;
    energy.gain.resize(static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const auto &[f, i] = nodes[n];
      double gain = cost_now(f) - costs_[f][i];
      for (const Beside &other : beside_[f]) {
        const bool same = filmed_.label[f] == filmed_.label[other.face];
        if (node_[other.face] < 0) // it stays
          gain += (same ? 0 : other.cost) - (filmed_.label[other.face] == label ? 0 : other.cost);
        else {
          gain += same ? 0 : other.cost / 2;
          if (f < other.face) {
            energy.edges.emplace_back(static_cast<int>(n), node_[other.face]);
            energy.cost.push_back(same ? other.cost : other.cost / 2);
          }
        }
      }
      energy.gain[static_cast<Eigen::Index>(n)] = gain;
    }
    return energy;
  }

  FilmedFaces &filmed_;
  std::vector<std::vector<Beside>> beside_;
  std::vector<std::vector<double>> costs_; ///< [F] of its views
  std::vector<int> node_;                  ///< [F] in the graph; -1 = not in it
};

} // namespace

void choose_views(FilmedFaces &filmed) {
  constexpr int kCycles = 3;
  filmed.label.assign(filmed.views.size(), -1);
  Expansion expansion(filmed);
  expansion.begin();
  const auto faces = faces_of_frames(filmed);
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    bool changed = false;
    for (std::size_t frame = 0; frame < faces.size(); ++frame)
      changed |= expansion.expand(static_cast<int>(frame), faces[frame]);
    if (!changed)
      break;
  }
}

} // namespace doublet::detail
