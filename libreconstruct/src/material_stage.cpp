// Sect. 6: the material and the width of a garment, from one take or several.

#include "stages.h"

#include "doublet/core/garment.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <stdexcept>

namespace doublet {

namespace {

/// The garment at these positions among the widths that it offers, the same of every region; the one it has where there are none.
std::vector<Garment> garments_at(const Garment &offered, const std::vector<double> &positions) {
  if (positions.empty())
    return {choose_widths(offered)};
  std::vector<Garment> garments;
  for (const double position : positions)
    garments.push_back(choose_widths(offered, std::vector<double>(offered.region_count, position)));
  return garments;
}

} // namespace

void fit_together(const std::vector<Reconstruction *> &reconstructions) {
  if (reconstructions.empty())
    throw std::invalid_argument("fit_together: expected a reconstruction or more, found none");
  std::set<Path> outs;
  for (const Reconstruction *each : reconstructions)
    if (!outs.insert(std::filesystem::weakly_canonical(each->out())).second)
      throw std::invalid_argument("fit_together: expected every take once, found " + each->out().string() + " twice");
  const SolverSettings solver = reconstructions[0]->solver_settings();
  for (Reconstruction *each : reconstructions)
    require_same(solver, each->solver_settings(), "fit_together: " + each->out().string());
  std::vector<Garment> offered;
  std::size_t count = SIZE_MAX;
  for (Reconstruction *each : reconstructions) {
    each->begin(true);
    offered.push_back(each->results().offered_garment());
    count = std::min(count, offered.back().widths.size());
  }
  std::vector<std::vector<double>> positions(reconstructions.size());
  if (count > 1)
    positions = common_widths(offered, static_cast<int>(count));
  std::vector<FilmedTake> films;
  std::vector<Take> takes;
  detail::Json folders = detail::Json::array();
  for (std::size_t k = 0; k < reconstructions.size(); ++k) {
    films.push_back(
        reconstructions[k]->results().take(reconstructions[k]->solver_settings(), garments_at(offered[k], positions[k])));
    folders.push_back(std::filesystem::canonical(reconstructions[k]->out()).string());
  }
  for (const FilmedTake &film : films)
    takes.push_back(film.take());

  Reconstruction &first = *reconstructions[0];
  const Stage &stage = detail::stage_named(first.stages, "fit");
  FitOptions fit = first.fit_options();
  fit.log = first.path("fit_log.csv");
  fit.checkpoint = first.path(detail::kFitCheckpoint);
  for (Reconstruction *each : reconstructions)
    each->record().begin(stage.name, each->basis_of(stage));
  const FitResult result = estimate_material(takes, fit, first.context());
  detail::Json summary = detail::fit_summary(result);
  summary["takes"] = folders;
  for (std::size_t k = 0; k < reconstructions.size(); ++k) {
    Reconstruction &each = *reconstructions[k];
    write_materials(each.path("material.json"), positions[k].empty() ? result : result.at_positions(positions[k]));
    if (&each != &first)
      std::filesystem::copy_file(fit.log, each.path("fit_log.csv"), std::filesystem::copy_options::overwrite_existing);
    each.results().forget();
    each.record().end(stage.name, detail::text_of(summary), stage.writes);
  }
}

namespace detail {

Json run_fit(Reconstruction &reconstruction) {
  FitOptions options = reconstruction.fit_options();
  const Path material = reconstruction.path("material.json");
  options.log = reconstruction.path("fit_log.csv");
  options.checkpoint = reconstruction.path(kFitCheckpoint); // stays: a search with a larger budget goes on from it
  bool kept = false;
  options.on_generation = [&, shown = options.on_generation](const FitResult &so_far) {
    write_materials(material, so_far); // whatever stops the search now, the best so far is there
    kept = true;
    if (shown)
      shown(so_far);
  };
  try {
    const FilmedTake take = reconstruction.results().take(reconstruction.solver_settings());
    const FitResult result = estimate_material({take.take()}, options, reconstruction.context());
    write_materials(material, result);
    return fit_summary(result);
  } catch (...) {
    if (kept)
      reconstruction.announce("fit: stopped; material.json has the best material so far");
    throw;
  }
}

Json fit_summary(const FitResult &result) {
  Json numbers{{"regions", result.regions.size()}};
  const auto add = [&](const char *name, auto value) {
    numbers[name] = Json::array();
    for (const RegionFit &region : result.regions)
      numbers[name].push_back(value(region));
  };
  add("energy_px2", [](const RegionFit &region) { return region.energy; });
  add("energy_noise_px2", [](const RegionFit &region) { return region.energy_noise; });
  numbers["widths"] = result.chosen_widths();
  add("energy_at_centre_px2", [](const RegionFit &region) { return region.energy_at_centre; });
  add("evaluations", [](const RegionFit &region) { return region.evaluations; });
  add("stop_reason", [](const RegionFit &region) { return region.stop_reason; });
  return numbers;
}

} // namespace detail
} // namespace doublet
