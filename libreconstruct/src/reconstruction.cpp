#include "doublet/reconstruct/reconstruction.h"

#include "stages.h"

#include "doublet/options/json.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace doublet {

using detail::Json;

namespace {

/// `context`, whose log is also written to a file as soon as *logging.
Context with_log_file(const Context &context, const Path &file, const std::shared_ptr<bool> &logging) {
  Context result = context;
  result.log = [log = context.log, file, logging](const std::string &line) {
    if (*logging && !(std::ofstream(file, std::ios::app) << line << '\n' << std::flush))
      throw Error(file.string() + ": cannot be written: " + std::strerror(errno));
    if (log)
      log(line);
  };
  return result;
}

bool contains(const std::vector<std::string> &names, const std::string &name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "group.name" -> value of every option in these groups; those of a group inside another are its own.
Json listed_options(const ReconstructionOptions &options, const std::vector<std::string> &groups) {
  Json listed = Json::object();
  std::vector<std::string> all;
  for_each_group(options, [&](const char *group, const auto &) { all.push_back(group); });
  for_each_group(options, [&](const std::string &group, const auto &values) {
    if (!contains(groups, group))
      return;
    const Json own = options::to_json<Json>(values);
    for (const auto &[name, value] : own.items())
      if (!(contains(all, name) && value.is_object()) && !is_derived_option(group, name))
        listed[group + "." + name] = value;
  });
  return listed;
}

/// Frames a second.
double rate_of(const ReconstructionOptions &options, const Session &session) {
  return options.fps > 0 ? options.fps : session.fps;
}

/// Which frames of which files are the take's, for the files do not say. `named`: as the record calls a file.
void list_film(const Session &session, const std::function<std::string(const Path &)> &named, Json &listed) {
  listed["session.frame_count"] = session.frame_count;
  for (const SessionCamera &camera : session.cameras) {
    Json &film = listed["session." + camera.name] = {{"first_frame", camera.first_frame}};
    const auto add = [&](const char *kind, const Path &file) {
      if (!file.empty())
        film[kind] = named(file);
    };
    add("video", camera.video);
    add("masks", camera.masks);
    add("background", camera.background);
  }
}

/// Files of an earlier run that a run of the stage need not write: set aside, and brought back if it does not come to its end.
class FormerFiles {
public:
  FormerFiles(const Path &out, const std::vector<std::string> &names) {
    for (const std::string &name : names)
      if (std::filesystem::exists(out / name)) {
        files_.push_back(out / name);
        std::filesystem::rename(out / name, aside(out / name));
      }
  }
  FormerFiles(const FormerFiles &) = delete;
  FormerFiles &operator=(const FormerFiles &) = delete;
  ~FormerFiles() {
    std::error_code gone;
    for (const Path &file : files_)
      std::filesystem::rename(aside(file), file, gone);
  }
  void forget() {
    for (const Path &file : files_)
      std::filesystem::remove(aside(file));
    files_.clear();
  }

private:
  std::vector<Path> files_;
  static Path aside(const Path &file) { return file.string() + ".before"; }
};

} // namespace

Stage &detail::stage_named(std::vector<Stage> &stages, const std::string &name) {
  std::string known;
  for (Stage &stage : stages) {
    if (stage.name == name)
      return stage;
    known += (known.empty() ? "" : ", ") + stage.name;
  }
  throw std::invalid_argument("stage '" + name + "': expected one of " + known);
}

Reconstruction::Reconstruction(Path session, Path out, ReconstructionOptions chosen, Context context)
    : options(std::move(chosen)), stages(default_stages()), session_folder_(std::move(session)), out_(std::move(out)),
      logging_(std::make_shared<bool>(false)), context_(with_log_file(context, out_ / "log.txt", logging_)), results_(out_) {
  for_each_group(options, [](const char *, const auto &group) { options::validate(group); });
  announce = [this](const std::string &line) { context_.log_line(line); };
}

Reconstruction::~Reconstruction() = default;

void Reconstruction::replace(const std::string &stage, Stage::Run run, const std::string &runner) {
  Stage &replaced = detail::stage_named(stages, stage);
  replaced.run = std::move(run);
  replaced.runner = runner;
}

const Session &Reconstruction::session() {
  if (!session_) {
    session_ = read_session(session_folder_);
    for (const char *kind : {"description", "calibration", "joints"})
      for (const Path &file : detail::session_files(*session_, kind))
        session_files_[file] = std::filesystem::last_write_time(file);
  }
  return *session_;
}

void Reconstruction::set_session(Session session) {
  reread_session();
  session_ = std::move(session);
}

void Reconstruction::reread_session() {
  session_.reset();
  session_files_.clear();
  retire_silhouettes(); // trained on the cameras and clean plates that there were
}

/// What a person has written since, the record would take for what was read.
void Reconstruction::reread_what_changed() {
  std::error_code gone; // which is no time that a file was written at
  const auto changed = [&](const auto &known) { return std::filesystem::last_write_time(known.first, gone) != known.second; };
  if (std::any_of(session_files_.begin(), session_files_.end(), changed))
    reread_session();
  results_.forget();
}

void Reconstruction::retire_silhouettes() {
  if (silhouettes_)
    former_silhouettes_.push_back(std::move(*silhouettes_));
  silhouettes_.reset();
}

Session Reconstruction::filmed() {
  const Path refined = path(kRefinedCalibration);
  return std::filesystem::exists(refined) ? recalibrated(session(), refined) : session();
}

const SilhouetteExtractor *Reconstruction::silhouettes() {
  auto asked = options::to_pairs(options.silhouette);
  if (asked != silhouette_options_) // which the record says that they are of
    retire_silhouettes();
  silhouette_options_ = std::move(asked);
  if (!silhouettes_)
    silhouettes_ = session_silhouettes(session(), *FrameSource::open(session()), options.silhouette, context_);
  return silhouettes_->get();
}

RunRecord &Reconstruction::record() {
  if (!record_)
    record_.emplace(out_);
  return *record_;
}

SolverSettings Reconstruction::solver_settings() {
  return {1 / rate_of(options, session()), options.cloth};
}

FitOptions Reconstruction::fit_options() {
  FitOptions fit = options.fit;
  fit.seed = options.seed;
  return fit;
}

bool Reconstruction::run_all(bool force) {
  reread_what_changed();
  announce(session().name + ": " + std::to_string(session().cameras.size()) + " cameras, " +
           std::to_string(session().frame_count) + " frames at " + options::to_text(session().fps, 6) + " fps");
  std::vector<std::string> names;
  for (const Stage &stage : stages)
    names.push_back(stage.name);
  return run(names, force);
}

bool Reconstruction::run(const std::vector<std::string> &names, bool force) {
  bool needs_scan = false, ran = false;
  findings_.clear();
  for (const std::string &name : names)
    needs_scan |= detail::stage_named(stages, name).needs_scan;
  begin(needs_scan);
  for (const Stage &stage : stages) {
    if (!contains(names, stage.name))
      continue;
    ran |= run_if_needed(stage, force);
    if (record().foreign_outputs(stage.name, stage.writes).empty()) // the record knows nothing of what another program wrote
      judge(stage);
  }
  return ran;
}

/// Writes what the whole run was asked to do.
void Reconstruction::begin(bool needs_scan) {
  if (std::filesystem::exists(out_) && !std::filesystem::is_directory(out_))
    throw Error(out_.string() + ": expected a folder for the results, found a file");
  reread_what_changed();
  require_same_session();
  require_start_in_take();
  if (needs_scan)
    require_scanned(session());
  std::filesystem::create_directories(out_);
  *logging_ = true;
  RunRecord &run = record();
  run.set("session", detail::text_of(session().folder.string()));
  run.set("seed", Json(options.seed).dump());
  run.set("threads", Json(context_.threads).dump());
  const bool configured = !options.configuration.empty();
  run.set("config", configured
                        ? detail::text_of({{"file", options.configuration.string()}, {"hash", run.hash(options.configuration)}})
                        : "null");
  run.save();
}

/// A folder of results is of one session, which may have been moved but is the same in every file that was read. One folder has
/// many names, where there are links.
void Reconstruction::require_same_session() {
  const std::string before = record().text("session"), prefix = "session/";
  std::error_code not_there;
  if (before.empty() || Path(before) == session().folder || std::filesystem::equivalent(before, session().folder, not_there))
    return;
  for (const auto &[name, known] : record().inputs()) {
    if (name.rfind(prefix, 0) != 0)
      continue;
    const Path file = session().folder / name.substr(prefix.size());
    if (!std::filesystem::exists(file) || record().hash(file) != known)
      throw Error(out_.string() + " holds results of " + before + ", which is not " + session().folder.string() +
                  "; choose another folder");
  }
}

/// Tracking cannot begin in a frame that is not tracked.
void Reconstruction::require_start_in_take() {
  const int first = options.capture.first_frame, count = options.capture.frame_count, start = options.capture.start_frame;
  if (start < 0)
    return;
  const int last = (count < 0 ? session().frame_count : first + count) - 1;
  if (start < first || start > last)
    throw std::invalid_argument("capture.start_frame: expected one of the frames " + std::to_string(first) + " to " +
                                std::to_string(last) + ", found " + std::to_string(start));
}

bool Reconstruction::run_if_needed(const Stage &stage, bool force) {
  const StageBasis basis = basis_of(stage);
  if (force) {
    if (record().is_done(stage.name)) // else the forced run was stopped, and goes on
      for (const std::string &name : stage.continues_from)
        std::filesystem::remove(path(name));
    compute(stage, basis, "forced");
    return true;
  }
  const std::vector<std::string> foreign = record().foreign_outputs(stage.name, stage.writes);
  if (!foreign.empty()) {
    for (const std::string &name : stage.writes)
      if (!std::filesystem::exists(path(name))) // the stage would write over what is somebody's
        throw Error(path(foreign.front()).string() + " was not written by this program, and " + name + ", which stage '" +
                    stage.name + "' writes beside it, is missing; write it, too, or delete " + foreign.front() +
                    " (or --force) to compute both");
    announce(stage.name + ": kept, " + foreign.front() +
             " was not written by this program (delete it, or --force, to compute it)");
    return false;
  }
  const std::string reason = record().reason_to_run(stage.name, basis, stage.writes);
  if (reason.empty()) {
    announce(stage.name + ": up to date");
    return false;
  }
  compute(stage, basis, reason);
  return true;
}

void Reconstruction::compute(const Stage &stage, const StageBasis &basis, const std::string &reason) {
  announce(stage.name + ": running (" + reason + ")");
  context_.log_line("== " + stage.name);
  record().begin(stage.name, basis);
  std::string summary;
  FormerFiles former(out_, stage.may_write);
  try {
    summary = stage.run(*this);
    former.forget();
  } catch (...) {
    try {
      record().stop(stage.name, stage.writes);
    } catch (const std::exception &) { // of a full disk, say: what the stage threw tells more
    }
    throw;
  }
  results_.forget();
  record().end(stage.name, summary, stage.writes);
  announce(stage.name + ": done in " + record().duration_text(stage.name));
}

void Reconstruction::judge(const Stage &stage) {
  std::vector<Finding> found;
  try {
    found = quality_findings(stage.name, record().summary(stage.name));
  } catch (const Error &error) {
    throw Error(record().path().string() + ": " + error.what() + "; delete it to start afresh");
  }
  for (const Finding &finding : found) {
    if (finding.impossible && !options.keep_going)
      throw Implausible(stage.name + ": " + finding.text + " (--keep-going goes on with it)");
    announce(stage.name + ": " + (finding.impossible ? "impossible" : "doubtful") + ": " + finding.text);
    findings_.push_back(finding);
  }
}

StageBasis Reconstruction::basis_of(const Stage &stage) {
  StageBasis basis;
  for (const std::string &name : stage.reads) {
    if (!std::filesystem::exists(path(name))) {
      const auto writes_it = [&](const Stage &other) { return contains(other.writes, name); };
      const auto writer = std::find_if(stages.begin(), stages.end(), writes_it);
      throw FileNotFound(path(name).string() + " is missing; stage '" + (writer == stages.end() ? "?" : writer->name) +
                         "' writes it");
    }
    basis.inputs[name] = record().hash(path(name));
  }
  for (const std::string &name : stage.may_read)
    if (std::filesystem::exists(path(name)))
      basis.inputs[name] = record().hash(path(name));
  for (const std::string &kind : stage.session_inputs)
    for (const Path &file : detail::session_files(session(), kind))
      basis.inputs["session/" + name_in_session(file)] = record().hash(file);
  if (stage.uses_body_model) {
    if (!std::filesystem::exists(options.body_model))
      throw FileNotFound(options.body_model.string() + " (the body model) does not exist");
    basis.inputs["body model"] = record().hash(options.body_model);
  }
  Json listed = listed_options(options, stage.option_groups);
  if (contains(stage.session_inputs, "images"))
    list_film(
        session(), [&](const Path &file) { return name_in_session(file); }, listed);
  if (contains(stage.session_inputs, "name"))
    listed["session.name"] = session().name;
  if (contains(stage.session_inputs, "scan_from_views"))
    listed["session.scan_from_views"] = session().scan_from_views;
  if (stage.uses_seed)
    listed["seed"] = options.seed;
  if (contains(stage.option_groups, "energy"))
    listed["fps"] = rate_of(options, session());
  if (!stage.runner.empty()) // its results are not those of ours
    listed["run"] = stage.runner;
  basis.options = detail::text_of(listed);
  return basis;
}

/// Relative to the session's folder, or as it is: a session may name a video that lies elsewhere.
std::string Reconstruction::name_in_session(const Path &path) {
  const Path relative = path.lexically_relative(session().folder);
  const bool inside = !relative.empty() && *relative.begin() != "..";
  return (inside ? relative : path).generic_string();
}

} // namespace doublet
