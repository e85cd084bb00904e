#pragma once
// Learns the body model from registered meshes.

#include "doublet/core/context.h"

#include <filesystem>
#include <string>
#include <vector>

namespace doublet {

struct TrainOptions {
  int components = 100;     ///< shape components kept, at most meshes - 1; 100 keep 99.99 % of the shipped population's variance
  double pose_floor = 0.07; ///< rad (4 degrees), added in quadrature to every pose deviation: joints that the population never
                            ///< bends sideways can still follow a scan a little
  std::vector<int> individuals; ///< train on these only (empty = all); the others are for leave-out tests
  std::string name = "doublet-body";
  std::string licence = "CC0 1.0 Universal"; ///< of the population; copied into the file
  std::string command;                       ///< recorded in the file
  void validate() const;
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
