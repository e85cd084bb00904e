#pragma once
// From a capture session to an animatable character: the stages, each reading and writing files of one folder (docs/formats.md),
// and the record of what is up to date.
//
//   Reconstruction reconstruction("session", "out", {.body_model = "body_model.npz"});
//   reconstruction.run_all();           // or run({"template", "rig"}); what is up to date is not run again
//   reconstruction.results().garment(); // what the stages made
//
// A stage of one's own takes the place of one of ours: replace().

#include "doublet/core/context.h"
#include "doublet/core/finding.h"
#include "doublet/fit/results.h"
#include "doublet/reconstruct/quality_checks.h"
#include "doublet/reconstruct/reconstruction_options.h"
#include "doublet/reconstruct/run_record.h"
#include "doublet/simulate/solver_settings.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

inline constexpr const char *kRefinedCalibration = "calibration.yml"; ///< written if the cameras were refined

class Reconstruction;

/// A stage: it reads and writes files in the folder of a reconstruction.
struct Stage {
  using Run = std::function<std::string(Reconstruction &)>;
  std::string name;
  std::vector<std::string> reads = {}, writes = {}; ///< files of the folder
  std::vector<std::string> may_read = {};           ///< optional inputs: files of the folder that are read if they exist
  std::vector<std::string> may_write = {}; ///< files of the folder that not every run writes; a run removes those of the last
  std::vector<std::string> continues_from = {}; ///< files of the folder from which an interrupted stage resumes
  std::vector<std::string> option_groups = {};  ///< groups that its results depend on, see for_each_group()
  /// Inputs from the session: "scan", "calibration", "joints", "keypoints", "images"; "description" = all of session.json; "name"
  /// and "scan_from_views" = only these values of it.
  std::vector<std::string> session_inputs = {};
  bool uses_seed = false, uses_body_model = false;
  bool needs_scan = true;  ///< refuses a session without scan and joints
  Run run = {};            ///< does the work; returns its summary, a JSON object as text that is recorded in run.json
  std::string runner = {}; ///< name of the implementation of `run`, for the record; empty = doublet's
};

/// check, template, rig, performance, segment, body, garment, fit, character.
std::vector<Stage> default_stages();

/// One reconstruction: session, output folder, options. Not thread-safe.
class Reconstruction {
public:
  /// Nothing is read or written yet. Throws std::invalid_argument for options that are out of their ranges.
  Reconstruction(Path session, Path out, ReconstructionOptions options = {}, Context context = {});
  Reconstruction(const Reconstruction &) = delete;
  Reconstruction &operator=(const Reconstruction &) = delete;
  virtual ~Reconstruction();

  ReconstructionOptions options;
  std::vector<Stage> stages; ///< in their order
  /// Receives one line for each event of a stage: whether it runs, its duration, what is doubtful. Default: the context's log.
  std::function<void(const std::string &)> announce;

  /// Replaces the implementation of a stage; `run` must write the same files. `runner`: its name, for the record. Throws
  /// std::invalid_argument if there is no such stage.
  void replace(const std::string &stage, Stage::Run run, const std::string &runner);

  /// Runs the named stages, in the reconstruction's order, unless they are up to date. `force`: runs them in any case, and
  /// overwrites files that another program made. Returns whether any stage ran. Throws Implausible if a result, old or new, is
  /// impossible (files stay written; not with options.keep_going, nor for files that another program made); Error if the folder
  /// contains results of another session, if the session has no scan or joints, or if another program made some of a stage's
  /// files and others are missing; FileNotFound naming the stage that writes a missing file; std::invalid_argument for an unknown
  /// name; whatever a stage throws. Completed results are kept in every case.
  bool run(const std::vector<std::string> &names, bool force = false);
  bool run_all(bool force = false);
  /// Findings about the stages of the last run(): doubtful results, and impossible ones that did not stop it.
  const std::vector<Finding> &findings() const { return findings_; }

  const Path &session_folder() const { return session_folder_; }
  const Path &out() const { return out_; }
  Path path(const std::string &file) const { return out_ / file; }
  const Context &context() const { return context_; } ///< the caller's; its log is also written to log.txt
  const Session &session();                           ///< read at the first call; read again by run() if its files have changed
  void set_session(Session session);                  ///< used instead of that in the folder
  void reread_session();                              ///< reads it again after its files were changed
  Session filmed(); ///< the session with the cameras of the captured performance: the refined ones, if there are any
  /// The extractor for cameras without ready masks, trained at the first call and again after `options.silhouette` was changed;
  /// null if all cameras have masks. Valid as long as this object.
  const SilhouetteExtractor *silhouettes();
  Results &results() { return results_; }
  RunRecord &record(); ///< read at the first call

  SolverSettings solver_settings(); ///< those for which materials are estimated
  FitOptions fit_options();         ///< options.fit with the seed of `options`

private:
  friend void fit_together(const std::vector<Reconstruction *> &reconstructions);
  Path session_folder_, out_;
  std::shared_ptr<bool> logging_; ///< to log.txt
  Context context_;
  std::optional<Session> session_;
  std::map<Path, std::filesystem::file_time_type> session_files_; ///< that it was read from, and when they were written
  std::optional<std::unique_ptr<SilhouetteExtractor>> silhouettes_;
  std::vector<std::pair<std::string, std::string>> silhouette_options_; ///< that they were trained with
  /// Of other sessions or options; somebody may still have them.
  std::vector<std::unique_ptr<SilhouetteExtractor>> former_silhouettes_;
  Results results_;
  std::optional<RunRecord> record_;
  std::vector<Finding> findings_;

  void reread_what_changed();
  void retire_silhouettes();
  void begin(bool needs_scan);
  void require_same_session();
  void require_start_in_take();
  bool run_if_needed(const Stage &stage, bool force);
  void compute(const Stage &stage, const StageBasis &basis, const std::string &reason);
  void judge(const Stage &stage);
  StageBasis basis_of(const Stage &stage);
  std::string name_in_session(const Path &path);
};

/// Estimates one material, and one width, for several takes of one garment, with the options and the seed of the first. Writes
/// material.json and fit_log.csv of every take, whose later stages must then be run again. An interrupted search is resumed.
/// Throws std::invalid_argument if the garments have no width in common.
void fit_together(const std::vector<Reconstruction *> &reconstructions);

} // namespace doublet
