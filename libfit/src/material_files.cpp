#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/options/json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2; // 1: some of the solver's settings

/// Of a width at `unit` from the first (0) to the last (1): its position among those of the garment, 0 = the widest.
double width_position(const FitResult &result, double unit) {
  const double at = unit * (result.widths - 1);
  if (result.width_positions.empty())
    return at;
  const auto below = static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(result.widths - 1)));
  const std::size_t above = std::min(below + 1, result.width_positions.size() - 1);
  return std::lerp(result.width_positions[below], result.width_positions[above], at - static_cast<double>(below));
}

/// What belongs to one parameter of those searched, by name; of the width its position.
struct Named {
  const FitResult &result;
  double value(const RegionFit &region, Eigen::Index i, double unit) const {
    if (i == result.space.size())
      return width_position(result, unit);
    Eigen::VectorXd point = region.answer.head(result.space.size());
    point[i] = unit;
    const pbd::Material material = result.space.material(point);
    for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
      if (result.space.names[static_cast<std::size_t>(i)] == parameter.name)
        return material.*parameter.value;
    return 0;
  }
};

/// Intervals and correlations by name, and draws in box units as the search saw them.
void add_posterior(Json &entry, const FitResult &result, const RegionFit &region) {
  const Posterior &posterior = region.posterior;
  const std::vector<std::string> names = result.parameters();
  if (posterior.draws.rows() == 0)
    return;
  const Named named{result};
  const std::vector<Confidence> confidence = region.confidence();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    entry["interval"][names[i]] = {named.value(region, row, posterior.interval(row, 0)),
                                   named.value(region, row, posterior.interval(row, 1))};
    entry["confidence"][names[i]] = confidence_name(confidence[i]);
    for (std::size_t j = 0; j < names.size(); ++j)
      entry["correlation"][names[i]][names[j]] = posterior.correlation(row, static_cast<Eigen::Index>(j));
  }
  for (const auto &draw : posterior.draws.rowwise()) {
    Json values = Json::array();
    for (double unit : draw)
      values.push_back(std::round(1e4 * unit) / 1e4);
    entry["draws"].push_back(values);
  }
}

Json findings_of(const RegionFit &region, const ParameterSpace &space) {
  Json all = Json::array();
  for (const FitFinding &finding : region.findings(space))
    all.push_back({{"kind", finding_name(finding.kind)},
                   {"parameter", finding.parameter},
                   {"value", finding.value},
                   {"low", finding.low},
                   {"high", finding.high}});
  return all;
}

double read_parameter(const Json &region, const char *name, const std::string &where) {
  if (!region.contains("parameters") || !region["parameters"].contains(name) || !region["parameters"][name].is_number())
    throw Error(where + ": expected a number for parameter " + name + ", found none");
  return region["parameters"][name].get<double>();
}

/// The settings that a file names; those that one of version 1 leaves out are taken from `expected`.
SolverSettings read_solver(const Json &json, int version, const SolverSettings &expected) {
  SolverSettings solver = expected;
  if (version >= 2) {
    Json named = json.at("solver");
    named.at("cloth").emplace("over_relaxation", 1.0); // what files without them were fitted with
    named.at("cloth").emplace("edge_collision", false);
    options::from_json(named, solver);
  } else if (json.contains("solver")) {
    Json merged = options::to_json<Json>(expected);
    const Json &named = json["solver"];
    merged["dt"] = named.value("dt", expected.dt);
    merged["cloth"]["iterations"] = named.value("n_iter", Json(expected.cloth.iterations));
    merged["cloth"]["substeps"] = named.value("substeps", Json(expected.cloth.substeps));
    merged["cloth"]["stiffness"] = named.value("stiffness", "sweeps"); // there was no other
    merged["cloth"]["over_relaxation"] = 1.0;
    merged["cloth"]["edge_collision"] = false;
    options::from_json(merged, solver);
  }
  return solver;
}

void check_version(const Json &json, const std::string &file) {
  const Json version = json.value("version", Json(1));
  if (!version.is_number_integer() || version < 1 || version > kVersion)
    throw Error(file + ": expected version 1 to " + std::to_string(kVersion) + " of material.json, found " + version.dump() +
                (version > kVersion ? ", which a newer doublet wrote" : ""));
}

void check_solver(const Json &json, const SolverSettings &expected, const std::string &file) {
  SolverSettings named;
  try {
    named = read_solver(json, json.value("version", 1), expected);
  } catch (const std::exception &error) { // of JSON, or out of range
    throw Error(file + ": solver: " + error.what());
  }
  try {
    require_same(expected, named, file);
  } catch (const std::invalid_argument &error) {
    throw Error(error.what());
  }
}

} // namespace

void write_materials(const Path &path, const FitResult &result) {
  Json json;
  json["version"] = kVersion;
  const std::vector<std::string> names = result.parameters();
  json["estimated"] = names;
  json["seed"] = result.seed;
  json["seconds"] = result.seconds;
  json["solver"] = options::to_json<Json>(result.solver);
  json["interrupted"] = result.interrupted;
  json["regions"] = Json::array();
  for (const RegionFit &region : result.regions) {
    Json entry;
    entry["parameters"] = options::to_json<Json>(region.material);
    if (region.width >= 0)
      entry["width"] = region.width;
    entry["energy"] = region.energy;
    if (std::isfinite(region.energy_noise))
      entry["energy_noise"] = region.energy_noise;
    if (std::isfinite(region.energy_at_centre))
      entry["energy_at_centre"] = region.energy_at_centre;
    entry["best_sample"] = {{"parameters", options::to_json<Json>(region.best)}, {"energy", region.best_energy}};
    for (std::size_t i = 0; i < names.size(); ++i)
      entry["deviations"][names[i]] = region.deviations[static_cast<Eigen::Index>(i)];
    for (Eigen::Index i = 0; i < region.answer_half_range.size(); ++i)
      entry["spread"][names[static_cast<std::size_t>(i)]] = region.answer_half_range[i];
    add_posterior(entry, result, region);
    entry["findings"] = findings_of(region, result.space);
    entry["evaluations"] = region.evaluations;
    entry["generations"] = region.generations;
    entry["stop_reason"] = region.stop_reason;
    json["regions"].push_back(entry);
  }
  write_text(path, json.dump(2) + "\n");
}

namespace {

/// material.json, with an array 'regions' and a version that is known.
Json read_fit(const Path &path) {
  Json json;
  try {
    json = Json::parse(read_json_text(path));
  } catch (const nlohmann::json::exception &error) {
    throw Error(path.string() + ": expected JSON, found: " + error.what());
  }
  if (!json.is_object() || !json.contains("regions") || !json["regions"].is_array())
    throw Error(path.string() + ": expected an array 'regions', found none");
  check_version(json, path.string());
  return json;
}

} // namespace

std::vector<double> read_widths(const Path &path) {
  const Json json = read_fit(path);
  std::vector<double> result;
  for (const Json &region : json["regions"]) {
    if (!region.is_object() || !region.contains("width"))
      continue;
    const Json &width = region["width"];
    if (!width.is_number() || width < 0 || width > 1000)
      throw Error(path.string() + ": region " + std::to_string(result.size()) +
                  ": width: expected a number of at least 0, found " + width.dump().substr(0, 40));
    result.push_back(width.get<double>());
  }
  if (!result.empty() && result.size() != json["regions"].size())
    throw Error(path.string() + ": expected a width for every region or none, found " + std::to_string(result.size()) + " of " +
                std::to_string(json["regions"].size()));
  return result;
}

std::vector<pbd::Material> read_materials(const Path &path, const std::optional<SolverSettings> &solver) {
  const Json json = read_fit(path);
  if (solver)
    check_solver(json, *solver, path.string());
  std::vector<pbd::Material> result;
  for (const Json &region : json["regions"]) {
    const std::string where = path.string() + ": region " + std::to_string(result.size());
    pbd::Material material;
    for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
      material.*parameter.value = read_parameter(region, parameter.name, where);
    try {
      pbd::validate(material);
    } catch (const std::invalid_argument &error) {
      throw Error(where + ": " + error.what());
    }
    result.push_back(material);
  }
  return result;
}

void write_fit_log(const Path &path, const std::vector<GenerationRow> &log, const ParameterSpace &space) {
  std::vector<std::string> names = space.names;
  if (!log.empty() && log[0].mean.size() > space.size())
    names.push_back("width"); // 0 = the widest, 1 = the narrowest
  std::string text = "region,generation,evaluations,best,generation_best";
  for (const char *column : {"mean", "deviation"})
    for (const std::string &name : names)
      text += std::string(",") + column + "_" + name;
  text += ",seconds\n";
  for (const GenerationRow &row : log) {
    text += std::to_string(row.part) + "," + std::to_string(row.generation) + "," + std::to_string(row.evaluations) + "," +
            options::to_text(row.best) + "," + options::to_text(row.generation_best);
    const pbd::Material mean = space.material(row.mean.head(space.size()));
    for (const std::string &name : space.names)
      for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
        if (name == parameter.name)
          text += ',' + options::to_text(mean.*parameter.value);
    for (Eigen::Index i = space.size(); i < row.mean.size(); ++i)
      text += ',' + options::to_text(row.mean[i]);
    for (Eigen::Index i = 0; i < row.deviation.size(); ++i)
      text += ',' + options::to_text(row.deviation[i]);
    text += ',' + options::to_text(std::round(row.seconds * 1000) / 1000) + "\n";
  }
  write_text(path, text);
}

void write_simulated(const Path &path, const std::vector<Vertices> &frames, Eigen::Index actor_vertices) {
  if (frames.empty())
    throw std::invalid_argument("write_simulated: frames: expected at least one, found none");
  if (actor_vertices < 1 || actor_vertices > frames[0].rows())
    throw std::invalid_argument("write_simulated: actor_vertices: expected a number in [1, " + std::to_string(frames[0].rows()) +
                                "], found " + std::to_string(actor_vertices));
  require_frames(frames, frames[0].rows(), "write_simulated");
  Npz npz;
  const auto set_rows = [&](const char *name, Eigen::Index first, Eigen::Index count) {
    std::vector<double> values;
    values.reserve(frames.size() * static_cast<std::size_t>(3 * count));
    for (const Vertices &frame : frames)
      values.insert(values.end(), frame.data() + 3 * first, frame.data() + 3 * (first + count));
    npz.set_f4(name, {static_cast<std::int64_t>(frames.size()), count, 3}, values);
  };
  set_rows("vertices", 0, actor_vertices);
  if (frames[0].rows() > actor_vertices)
    set_rows("garment", actor_vertices, frames[0].rows() - actor_vertices);
  npz.write(path, kFileFormat);
}

std::vector<Vertices> read_simulated(const Path &path) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  npz.require_shape("vertices", {-1, -1, 3});
  const std::int64_t count = npz.shape("vertices")[0], actor = npz.shape("vertices")[1];
  if (actor == 0)
    throw Error(path.string() + ": array 'vertices': expected at least one vertex, found none");
  if (npz.has("garment"))
    npz.require_shape("garment", {count, -1, 3});
  const std::int64_t garment = npz.has("garment") ? npz.shape("garment")[1] : 0;
  const std::vector<double> of_actor = npz.values("vertices"),
                            of_garment = garment ? npz.values("garment") : std::vector<double>();
  std::vector<Vertices> frames(static_cast<std::size_t>(count), Vertices(actor + garment, 3));
  for (std::int64_t t = 0; t < count; ++t) {
    frames[t].topRows(actor) = Eigen::Map<const Vertices>(of_actor.data() + t * actor * 3, actor, 3);
    frames[t].bottomRows(garment) = Eigen::Map<const Vertices>(of_garment.data() + t * garment * 3, garment, 3);
  }
  return frames;
}

} // namespace doublet
