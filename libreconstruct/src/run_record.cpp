#include "doublet/reconstruct/run_record.h"

#include "json.h"
#include "peak_memory.h"

#include "doublet/core/error.h"
#include "doublet/files/hash.h"
#include "doublet/version.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

namespace doublet {

using detail::Json;

namespace {

constexpr int kRecordFormat = 1; // a file that names none is of 1
constexpr const char *kStartAfresh = "; delete it to start afresh";

bool is_object_of_texts(const Json &entry, const char *name) {
  const Json part = entry.value(name, Json::object());
  return part.is_object() && std::all_of(part.begin(), part.end(), [](const Json &value) { return value.is_string(); });
}

template <class Is> bool is_absent_or(const Json &entry, const char *name, Is is) {
  return !entry.contains(name) || is(entry.at(name));
}

/// Has it the parts of a stage's entry? What is in its summary is looked at by who shows it.
bool is_entry(const Json &entry) {
  if (!entry.is_object() || !entry.contains("state") || !entry.at("state").is_string())
    return false;
  const auto number = [](const Json &value) { return value.is_number(); };
  const auto text = [](const Json &value) { return value.is_string(); };
  const auto object = [](const Json &value) { return value.is_object(); };
  const bool typed = is_object_of_texts(entry, "inputs") && is_object_of_texts(entry, "outputs") &&
                     is_absent_or(entry, "options", object) && is_absent_or(entry, "summary", object) &&
                     is_absent_or(entry, "seconds", number) && is_absent_or(entry, "peak_memory_mb", number) &&
                     is_absent_or(entry, "version", text) && is_absent_or(entry, "peak_memory_scope", text);
  const auto has = [&](std::initializer_list<const char *> names) {
    return std::all_of(names.begin(), names.end(), [&](const char *name) { return entry.contains(name); });
  };
  if (!typed || !has({"options", "inputs"}))
    return false;
  return entry.at("state") == "running" ||
         (entry.at("state") == "done" && has({"outputs", "summary", "seconds", "peak_memory_mb"}));
}

/// As one says it: a text without quotes.
std::string shown(const Json &object, const std::string &name) {
  if (!object.contains(name))
    return "none";
  const Json &value = object.at(name);
  return value.is_string() ? value.get<std::string>() : detail::text_of(value);
}

/// The first member that the one has and the other has not, or has otherwise; those of `one` first.
std::optional<std::string> first_difference(const Json &one, const Json &other) {
  for (const auto &[from, to] : {std::pair(&one, &other), std::pair(&other, &one)})
    for (const auto &[name, value] : from->items())
      if (!to->contains(name) || to->at(name) != value)
        return name;
  return std::nullopt;
}

Json rounded(Json summary) {
  for (Json &value : summary)
    if (value.is_number_float()) {
      const std::string text = options::to_text(value.get<double>(), 6);
      double number = 0;
      std::from_chars(text.data(), text.data() + text.size(), number);
      value = number;
    }
  return summary;
}

} // namespace

struct RunRecord::Data {
  Path out;
  Json json{{"format", kRecordFormat}, {"doublet", DOUBLET_VERSION}, {"stages", Json::object()}};
  struct Known {
    std::filesystem::file_time_type written;
    std::uintmax_t size;
    std::string hash;
  };
  std::map<Path, Known> hashes;
  std::optional<detail::PeakMemory> memory;
  std::chrono::steady_clock::time_point begun;

  Path file() const { return out / "run.json"; }
  void read();
  void read_again(const std::string &own = {});
  void save(const std::string &own = {});
  /// Of a stage; null if it never ran.
  const Json *entry(const std::string &stage) const {
    const Json &stages = json.at("stages");
    return stages.contains(stage) ? &stages.at(stage) : nullptr;
  }
};

void RunRecord::Data::read() {
  try {
    json = Json::parse(read_json_text(file()));
  } catch (const Json::exception &error) {
    throw Error(file().string() + " is not valid JSON (" + error.what() + ")" + kStartAfresh);
  }
  if (!json.is_object() || !json.value("stages", Json::object()).is_object())
    throw Error(file().string() + ": expected an object with 'stages', found another" + kStartAfresh);
  if (const Json format = json.value("format", Json(kRecordFormat)); format != kRecordFormat)
    throw Error(file().string() + ": expected format " + std::to_string(kRecordFormat) + ", found " +
                format.dump().substr(0, 40) + ", of another version of doublet");
  if (json.contains("session") && !json.at("session").is_string())
    throw Error(file().string() + ": expected 'session' to be a folder, found another" + kStartAfresh);
  json["format"] = kRecordFormat;
  const Json found = json.value("stages", Json::object());
  Json kept = Json::object(); // an entry that something else wrote is none
  for (const auto &[name, stage] : found.items())
    if (is_entry(stage))
      kept[name] = stage;
  json["stages"] = kept;
}

/// Takes over what other commands have written since about stages other than `own`: of two that run at a time in one folder, such
/// as a report during a long search, neither must forget what the other has made.
void RunRecord::Data::read_again(const std::string &own) {
  if (!std::filesystem::exists(file()))
    return;
  Json mine = json;
  read();
  Json stages = json.at("stages");
  if (mine.at("stages").contains(own))
    stages[own] = mine.at("stages").at(own);
  json = std::move(mine);
  json["stages"] = std::move(stages);
}

void RunRecord::Data::save(const std::string &own) {
  read_again(own);
  write_text(file(), detail::text_of(json, 1) + "\n");
}

RunRecord::RunRecord(Path out) : data_(std::make_unique<Data>()) {
  data_->out = std::move(out);
  if (std::filesystem::exists(path()))
    data_->read();
}
RunRecord::RunRecord(RunRecord &&) noexcept = default;
RunRecord &RunRecord::operator=(RunRecord &&) noexcept = default;
RunRecord::~RunRecord() = default;

Path RunRecord::path() const {
  return data_->file();
}

std::string RunRecord::json() const {
  return detail::text_of(data_->json);
}

void RunRecord::set(const std::string &name, const std::string &value) {
  data_->json[name] = Json::parse(value);
}

std::string RunRecord::text(const std::string &name) const {
  return data_->json.value(name, std::string());
}

void RunRecord::save() const {
  data_->save();
}

const std::string &RunRecord::hash(const Path &path) {
  if (!std::filesystem::exists(path))
    throw FileNotFound(path.string() + ": no such file");
  const bool folder = std::filesystem::is_directory(path);
  const auto written = std::filesystem::last_write_time(path);
  const std::uintmax_t size = folder ? 0 : std::filesystem::file_size(path);
  auto &known = data_->hashes[path];
  if (folder || known.hash.empty() || known.written != written || known.size != size)
    known = {written, size, hash_files(path)};
  return known.hash;
}

std::string RunRecord::summary(const std::string &stage) const {
  const Json *entry = data_->entry(stage);
  return entry ? detail::text_of(entry->value("summary", Json::object())) : "{}";
}

bool RunRecord::is_done(const std::string &stage) const {
  const Json *entry = data_->entry(stage);
  return entry && entry->at("state") == "done";
}

std::map<std::string, std::string> RunRecord::inputs() const {
  std::map<std::string, std::string> all;
  for (const Json &stage : data_->json.at("stages"))
    for (const auto &[name, hash] : stage.at("inputs").items())
      all[name] = hash;
  return all;
}

std::vector<std::string> RunRecord::foreign_outputs(const std::string &stage, const std::vector<std::string> &outputs) {
  data_->read_again();
  const Json *entry = data_->entry(stage);
  if (entry && entry->at("state") == "running" && !entry->contains("stopped")) // it runs, or was killed: they may be its own
    return {};
  const Json written = entry ? entry->value("outputs", Json::object()) : Json::object();
  std::vector<std::string> foreign;
  for (const std::string &name : outputs)
    if (std::filesystem::exists(data_->out / name) && written.value(name, std::string()) != hash(data_->out / name))
      foreign.push_back(name);
  return foreign;
}

std::string RunRecord::reason_to_run(const std::string &stage, const StageBasis &basis,
                                     const std::vector<std::string> &outputs) const {
  const Json *entry = data_->entry(stage);
  if (!entry)
    return "first run";
  if (entry->at("state") != "done")
    return "the last run was stopped here";
  for (const std::string &name : outputs)
    if (!std::filesystem::exists(data_->out / name))
      return name + " is missing";
  if (const std::string version = shown(*entry, "version"); version != DOUBLET_VERSION)
    return "made by version " + version;
  const Json options = Json::parse(basis.options), &before = entry->at("options");
  if (const auto name = first_difference(options, before))
    return "option " + *name + " changed from " + shown(before, *name) + " to " + shown(options, *name);
  const auto input = first_difference(Json(basis.inputs), entry->at("inputs"));
  return input ? *input + " changed" : "";
}

void RunRecord::begin(const std::string &stage, const StageBasis &basis) {
  data_->json["doublet"] = DOUBLET_VERSION;
  data_->json["stages"][stage] = {{"state", "running"},
                                  {"version", DOUBLET_VERSION},
                                  {"options", Json::parse(basis.options)},
                                  {"inputs", Json(basis.inputs)},
                                  {"outputs", Json::object()}};
  data_->save(stage);
  data_->memory.emplace();
  data_->begun = std::chrono::steady_clock::now();
}

void RunRecord::end(const std::string &stage, const std::string &summary, const std::vector<std::string> &outputs) {
  const Json numbers = Json::parse(summary, nullptr, false);
  if (!numbers.is_object()) // as an entry it would not be read again, and what the stage wrote be taken for somebody else's
    throw std::invalid_argument("RunRecord::end: expected a JSON object as the summary of stage '" + stage + "', found " +
                                summary.substr(0, 60));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - data_->begun).count();
  Json &entry = data_->json["stages"][stage];
  entry["seconds"] = std::round(100 * seconds) / 100;
  entry["peak_memory_mb"] = data_->memory->megabytes();
  entry["peak_memory_scope"] = data_->memory->scope();
  entry["summary"] = rounded(numbers);
  for (const std::string &name : outputs)
    entry["outputs"][name] = hash(data_->out / name);
  entry["state"] = "done";
  data_->save(stage);
}

void RunRecord::stop(const std::string &stage, const std::vector<std::string> &outputs) {
  Json &entry = data_->json["stages"][stage];
  for (const std::string &name : outputs)
    if (std::filesystem::exists(data_->out / name))
      entry["outputs"][name] = hash(data_->out / name);
  entry["stopped"] = true;
  data_->save(stage);
}

std::string RunRecord::duration_text(const std::string &stage) const {
  const Json *entry = data_->entry(stage);
  if (!entry)
    return "";
  char text[80];
  std::snprintf(text, sizeof text, "%.1f s, peak memory %.0f MB", entry->at("seconds").get<double>(),
                entry->at("peak_memory_mb").get<double>());
  return text;
}

} // namespace doublet
