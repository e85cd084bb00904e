#pragma once
// run.json: what was run, on what, with which options, how long it took; and from it, what need not run again.

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
/// not changed since they were written; outputs that this program did not write (made by another, or edited) are kept.
class RunRecord {
public:
  /// Throws Error naming run.json if it is none; stages in it that something else wrote are left out.
  explicit RunRecord(Path out);
  RunRecord(RunRecord &&) noexcept;
  RunRecord &operator=(RunRecord &&) noexcept;
  ~RunRecord();

  Path path() const;
  std::string json() const; ///< all of it
  /// A member of the whole, such as "seed"; `value` is JSON as text. Written to the file by save() and with the next stage.
  void set(const std::string &name, const std::string &value);
  std::string text(const std::string &name) const; ///< a member that is a text; empty if there is none
  void save() const;

  /// SHA-256 of a file, or of all that is in a folder; of a file that has not changed since, from memory.
  const std::string &hash(const Path &path);
  std::string summary(const std::string &stage) const; ///< JSON object as text; "{}" if the stage did not run
  bool is_done(const std::string &stage) const;
  std::map<std::string, std::string> inputs() const; ///< name -> SHA-256, of all stages
  /// Those of `outputs` that exist but are not what this program last wrote.
  std::vector<std::string> foreign_outputs(const std::string &stage, const std::vector<std::string> &outputs);
  /// Why the stage must run, in words; empty if it is up to date.
  std::string reason_to_run(const std::string &stage, const StageBasis &basis, const std::vector<std::string> &outputs) const;

  /// The stage runs from here; time and peak memory are measured.
  void begin(const std::string &stage, const StageBasis &basis);
  /// It is done. `summary`: a JSON object as text, whose numbers are rounded to six digits.
  void end(const std::string &stage, const std::string &summary, const std::vector<std::string> &outputs);
  /// It was stopped and runs again, unless somebody else writes its outputs: those that there are now are its own.
  void stop(const std::string &stage, const std::vector<std::string> &outputs);
  std::string duration_text(const std::string &stage) const; ///< "12.3 s, peak memory 456 MB" of a stage that is done

private:
  struct Data;
  std::unique_ptr<Data> data_;
};

} // namespace doublet
