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

inline constexpr const char *kRefinedCalibration = "calibration.yml"; ///< written if the take showed that the session's was off

class Reconstruction;

/// What reads and writes files of a reconstruction's folder.
struct Stage {
  using Run = std::function<std::string(Reconstruction &)>;
  std::string name;
  std::vector<std::string> reads = {}, writes = {}; ///< files of the folder
  std::vector<std::string> may_read = {};           ///< files of it that count as inputs if they are there
  std::vector<std::string> continues_from = {};     ///< files of it that a stage that was stopped goes on from
  std::vector<std::string> option_groups = {};      ///< that its results depend on, see for_each_group()
  /// "scan", "calibration", "joints", "keypoints", "images"; "description", all of session.json, or "name" and "scan_from_views",
  /// these values of it alone.
  std::vector<std::string> session_inputs = {};
  bool uses_seed = false, uses_body_model = false;
  bool needs_scan = true;  ///< a session without scan and joints is refused
  Run run = {};            ///< the work; returns a JSON object as text: the numbers worth recording in run.json
  std::string runner = {}; ///< whose `run` it is, for the record; empty = doublet's
};

/// check, template, rig, performance, segment, body, garment, fit, character.
std::vector<Stage> default_stages();

/// One reconstruction: where from, where to, how. Not thread-safe.
class Reconstruction {
public:
  /// Nothing is read or written yet. Throws std::invalid_argument for options that are out of their ranges.
  Reconstruction(Path session, Path out, ReconstructionOptions options = {}, Context context = {});
  Reconstruction(const Reconstruction &) = delete;
  Reconstruction &operator=(const Reconstruction &) = delete;
  virtual ~Reconstruction();

  ReconstructionOptions options;
  std::vector<Stage> stages; ///< in their order
  /// One line about each stage, whether it runs, how long it took, what is doubtful; by default to the context's log.
  std::function<void(const std::string &)> announce;

  /// Puts `run` in the place of a stage's; it must write the same files. `runner`: its name, for the record. Throws
  /// std::invalid_argument if there is no such stage.
  void replace(const std::string &stage, Stage::Run run, const std::string &runner);

  /// Stages by name, in the reconstruction's order, each unless it is up to date; `force`: in any case, and over files that were
  /// made elsewhere. Returns whether any ran. Throws Implausible if a result, old or new, cannot be true (what was written stays;
  /// not with options.keep_going, nor of files that were made elsewhere); Error if the folder has the results of another session,
  /// if the session has no scan or joints, if some of a stage's files were made elsewhere and others are missing; FileNotFound
  /// naming the stage that writes a missing file; std::invalid_argument for an unknown name; whatever a stage throws. Nothing
  /// that was computed is lost.
  bool run(const std::vector<std::string> &names, bool force = false);
  bool run_all(bool force = false);
  /// What the stages that were asked for found doubtful, or impossible and were not stopped by.
  const std::vector<Finding> &findings() const { return findings_; }

  const Path &session_folder() const { return session_folder_; }
  const Path &out() const { return out_; }
  Path path(const std::string &file) const { return out_ / file; }
  const Context &context() const { return context_; } ///< the caller's; what is logged is also in log.txt
  const Session &session();                           ///< read at the first call; by run() if its files were written since
  void set_session(Session session);                  ///< in the place of the folder's
  void reread_session();                              ///< after its files were changed
  Session filmed(); ///< the session with the cameras that the performance was captured with: the refined ones, if there are any
  /// Trained at the first call, and anew after `options.silhouette` were changed, for the cameras without ready masks; null if
  /// all have some. Lives as long as this object.
  const SilhouetteExtractor *silhouettes();
  Results &results() { return results_; }
  RunRecord &record(); ///< read at the first call

  SolverSettings solver_settings(); ///< without which materials mean nothing
  FitOptions fit_options();         ///< with seed and frame rate

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

/// One material, and one width, for several takes of one garment, with the options and the seed of the first: material.json and
/// fit_log.csv of every take, whose later stages are then to be run again. A search that was stopped goes on. Throws
/// std::invalid_argument if the garments cannot be equally wide.
void fit_together(const std::vector<Reconstruction *> &reconstructions);

} // namespace doublet
