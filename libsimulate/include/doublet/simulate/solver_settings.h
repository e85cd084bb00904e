#pragma once
// The settings of the cloth simulation, stored with every material in character.glb and material.json.

#include "doublet/pbd/cloth_solver.h"

namespace doublet {

/// Settings with which the cloth was simulated when its material was estimated; without them the parameters are meaningless.
struct SolverSettings {
  double dt = 1.0 / 40.0;
  pbd::ClothOptions cloth;
  static constexpr auto describe() {
    using namespace options;
    using O = SolverSettings;
    return Description{
        "SolverSettings",
        option(&O::dt, "dt", Range{0, 1, Open::Below}, "s", "Duration of one frame"),
        option(&O::cloth, "cloth", "Options of the cloth solver"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Throws std::invalid_argument naming the first setting that differs: "`where`: solver setting cloth.substeps: expected 4, found
/// 1".
inline void require_same(const SolverSettings &expected, const SolverSettings &found, const std::string &where) {
  const auto wanted = options::to_pairs(expected), given = options::to_pairs(found);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i] != given[i])
      options::throw_invalid(where + ": solver setting " + wanted[i].first, wanted[i].second, given[i].second);
}

} // namespace doublet
