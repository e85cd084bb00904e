#pragma once
// Which of several garments is the filmed one, before its material is known: beyond the paper.

#include "doublet/fit/material_objective.h"
#include "doublet/options/options.h"

#include <vector>

namespace doublet {

/// The rest shape of a garment follows from how much of the video's motion it must allow for (see the garment mesher's `spread`),
/// and that share differs from film to film. So several are tried on the video, each with the same ordinary materials. Then, at
/// the spread that was taken, several widths of the band that it hangs from (the mesher's `band`).
struct TrialOptions {
  std::vector<double> spreads = {0.15, 0.25, 0.35, 0.5};
  std::vector<double> bands = {0, 0.05};
  int materials = 64;
  double margin = 0.1; ///< chaos alone moves what 16 materials cost by 5 to 10 %, 64 by less
  static constexpr auto describe() {
    using namespace options;
    using O = TrialOptions;
    return Description{
        "TrialOptions",
        option(&O::spreads, "spreads", Range{0, 1, Open::Both}, "",
               "tried in the place of the mesher's own, the one of the lowest energy is taken; one = that one, untried, none = "
               "the mesher's"),
        option(&O::bands, "bands", Range{0, 1}, "m", "likewise in the place of the mesher's band, at the spread that was taken"),
        option(&O::materials, "materials", Range{4, 4096}, "",
               "that each is tried with, in groups of eight side by side; the mean of the lowest quarter counts"),
        option(&O::margin, "margin", Range{0, 1}, "",
               "share by which another must cost less than the first to be taken in its place"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// (count, n) points of the box, spread evenly (Halton, "On the efficiency of certain quasi-random sequences of points",
/// Numerische Mathematik 2, 1960), but of cloth that does not stretch. `share` (from 0): which `count` of the sequence, so that
/// searches side by side begin with different ones. Throws std::invalid_argument for a wrong space, a count outside [4, 4096] or
/// a share outside [0, 100000].
MatrixRM trial_samples(const ParameterSpace &space, int count, int share = 0);

/// (R) what the regions of a garment cost, pixels^2: the mean of the lowest quarter of E_fit over trial_samples(). Lower where
/// some ordinary material moves the garment as the filmed one moves. Throws std::invalid_argument as trial_samples() does.
Eigen::VectorXd trial_energy(const MaterialObjective &objective, int materials, const Context &context = {});

/// Which of the garments to take for what they cost: the cheapest if it costs less than the first by more than the margin, else
/// the first. Throws std::invalid_argument if there is none or a cost is not finite.
std::size_t chosen_garment(const std::vector<double> &energies, const TrialOptions &trial = {});

/// Of one garment, in one call: the sum over its regions; 0 if it has none. `performance`: dressed in it.
double garment_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                      const Observations &observations, const TrialOptions &trial = {}, const EnergyOptions &energy = {},
                      const ParameterSpace &space = {}, const Context &context = {});

} // namespace doublet
