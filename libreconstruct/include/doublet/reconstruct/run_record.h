#pragma once
// run.json: stages that were run, their inputs, options and durations; used to decide which stages must run again.

#include "doublet/files/files.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// What the results of a stage depend on.
struct StageBasis {
  std::map<std::string, std::string> inputs; ///< name -> SHA-256
  std::string options = "{}";                ///< a JSON object as text: "group.name" -> value
};

/// The record of one folder of results. A stage is up to date if its outputs exist and its options, inputs and the version have
/// not changed since they were written; outputs that another program made or changed are kept.
class RunRecord {
public:
  /// Throws Error naming run.json if it is malformed; entries of stages that are not in the format of this program are left out.
  explicit RunRecord(Path out);
  RunRecord(RunRecord &&) noexcept;
  RunRecord &operator=(RunRecord &&) noexcept;
  ~RunRecord();

  Path path() const;
  std::string json() const; ///< the whole record
  /// Sets a top-level member, such as "seed"; `value` is JSON as text. Written to the file by save() and with the next stage.
  void set(const std::string &name, const std::string &value);
  std::string text(const std::string &name) const; ///< a member that is a text; empty if there is none
  void save() const;

  /// SHA-256 of a file, or of all files in a folder; cached for files that have not changed.
  const std::string &hash(const Path &path);
  std::string summary(const std::string &stage) const; ///< JSON object as text; "{}" if the stage did not run
  bool is_done(const std::string &stage) const;
  std::map<std::string, std::string> inputs() const; ///< name -> SHA-256, of all stages
  /// Those of `outputs` that exist but were not last written by this program.
  std::vector<std::string> foreign_outputs(const std::string &stage, const std::vector<std::string> &outputs);
  /// Why the stage must run, as text; empty if it is up to date.
  std::string reason_to_run(const std::string &stage, const StageBasis &basis, const std::vector<std::string> &outputs) const;

  /// Marks the start of a stage; time and peak memory are measured from here.
  void begin(const std::string &stage, const StageBasis &basis);
  /// Marks its end. `summary`: a JSON object as text, whose numbers are rounded to six digits.
  void end(const std::string &stage, const std::string &summary, const std::vector<std::string> &outputs);
  /// Marks an interruption: the stage will run again unless another program writes its outputs; outputs that exist now count as
  /// its own.
  void stop(const std::string &stage, const std::vector<std::string> &outputs);
  std::string duration_text(const std::string &stage) const; ///< "12.3 s, peak memory 456 MB" of a stage that is done

private:
  struct Data;
  std::unique_ptr<Data> data_;
};

} // namespace doublet
