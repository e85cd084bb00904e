#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/options/json.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace doublet {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2; // 1: some of the solver's settings

void add_confidence(Json &entry, const RegionFit &region, const std::vector<std::string> &parameters) {
  const std::vector<Confidence> confidence = region.confidence();
  if (confidence.empty())
    return;
  entry["energy_noise"] = region.influence.noise;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    entry["influence"][parameters[i]] = {{"energy_change", region.influence.change[static_cast<Eigen::Index>(i)]},
                                         {"rank", region.influence.rank[i]},
                                         {"confidence", confidence_name(confidence[i])}};
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
    merged["cloth"]["iterations"] = named.value("n_iter", expected.cloth.iterations);
    merged["cloth"]["substeps"] = named.value("substeps", expected.cloth.substeps);
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
  json["estimated"] = result.parameters;
  json["seed"] = result.seed;
  json["seconds"] = result.seconds;
  json["solver"] = options::to_json<Json>(result.solver);
  json["interrupted"] = result.interrupted;
  json["regions"] = Json::array();
  for (const RegionFit &region : result.regions) {
    Json entry;
    entry["parameters"] = options::to_json<Json>(region.material);
    entry["energy"] = region.energy;
    if (std::isfinite(region.energy_at_centre))
      entry["energy_at_centre"] = region.energy_at_centre;
    entry["best_sample"] = {{"parameters", options::to_json<Json>(region.best)}, {"energy", region.best_energy}};
    for (std::size_t i = 0; i < result.parameters.size(); ++i)
      entry["deviations"][result.parameters[i]] = region.deviations[static_cast<Eigen::Index>(i)];
    for (Eigen::Index i = 0; i < region.spread.size(); ++i)
      entry["spread"][result.parameters[static_cast<std::size_t>(i)]] = region.spread[i];
    add_confidence(entry, region, result.parameters);
    entry["remarks"] = region.remarks(result.parameters);
    entry["evaluations"] = region.evaluations;
    entry["generations"] = region.generations;
    entry["stop_reason"] = region.stop_reason;
    json["regions"].push_back(entry);
  }
  write_text(path, json.dump(2) + "\n");
}

std::vector<pbd::Material> read_materials(const Path &path, const std::optional<SolverSettings> &solver) {
  Json json;
  try {
    json = Json::parse(read_json_text(path));
  } catch (const nlohmann::json::exception &error) {
    throw Error(path.string() + ": expected JSON, found: " + error.what());
  }
  if (!json.is_object() || !json.contains("regions") || !json["regions"].is_array())
    throw Error(path.string() + ": expected an array 'regions', found none");
  check_version(json, path.string());
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
  std::string text = "region,generation,evaluations,best,generation_best";
  for (const char *column : {"mean", "deviation"})
    for (const std::string &name : space.names)
      text += std::string(",") + column + "_" + name;
  text += ",seconds\n";
  for (const GenerationRow &row : log) {
    text += std::to_string(row.part) + "," + std::to_string(row.generation) + "," + std::to_string(row.evaluations) + "," +
            options::shown(row.best) + "," + options::shown(row.generation_best);
    const pbd::Material mean = space.material(row.mean);
    for (const std::string &name : space.names)
      for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
        if (name == parameter.name)
          text += ',' + options::shown(mean.*parameter.value);
    for (Eigen::Index i = 0; i < row.deviation.size(); ++i)
      text += ',' + options::shown(row.deviation[i]);
    text += ',' + options::shown(std::round(row.seconds * 1000) / 1000) + "\n";
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
