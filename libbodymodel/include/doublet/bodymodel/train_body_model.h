#pragma once
// Learns the body model from registered meshes.

#include "doublet/core/context.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace doublet {

struct TrainOptions {
  int components = 100;
  double pose_floor = 0.07;
  std::vector<int> individuals;
  std::string name = "doublet-body";
  std::string licence = "CC0 1.0 Universal";
  std::string command;
  static constexpr auto describe() {
    using namespace options;
    using O = TrainOptions;
    return Description{
        "TrainOptions",
        option(&O::components, "components", at_least(1), "", "Number of shape components that are kept, at most meshes - 1",
               "100 keep 99.99 % of the shipped population's variance"),
        option(&O::pose_floor, "pose_floor", above(0), "rad", "Angle that is added in quadrature to every pose deviation",
               "So that joints which the population never bends sideways can follow a scan a little"),
        option(&O::individuals, "individuals", at_least(0), "", "Individuals to train on; empty = all",
               "The others are for leave-out tests"),
        option(&O::name, "name", "Name of the model"),
        option(&O::licence, "licence", "Licence of the population, which is copied into the file"),
        option(&O::command, "command", "Command that is recorded in the file"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

struct TrainSummary {
  int meshes = 0, vertices = 0, components = 0;
  double variance_kept = 0;     ///< fraction
  double reconstruction_mm = 0; ///< mean vertex error of the training set, unposed, before quantisation
};

/// population: registered meshes with skeleton, weights and poses (population.npz, arrays as docs/body-model.md lists).
/// Every mesh is unposed exactly (inverse dual quaternion blend) to its individual's rest pose; principal components of rest
/// vertices and rest joints together by the Gram matrix of the meshes (Turk & Pentland 1991); poses as whitened rotation vectors.
/// Writes `out` (.npz). Throws FileNotFound or Error naming file and array.
TrainSummary train_body_model(const std::filesystem::path &population, const std::filesystem::path &out,
                              const TrainOptions &options = {}, const Context &context = {});

} // namespace doublet
