#pragma once
// The file that a capture which was stopped goes on from.

#include "tracked_frame.h"

#include "doublet/core/context.h"
#include "doublet/files/files.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// A line of text that says what it belongs to, and a record for every frame of every pass, appended as it is tracked: its
/// length, its bytes, a checksum over it and all before it. What a power cut or a kill leaves of the last one is recognised by
/// that.
class CaptureCheckpoint {
public:
  /// `path` empty = none: nothing is read or written. `problem`: a fingerprint of whatever the frames depend on but the images.
  CaptureCheckpoint(Path path, std::uint64_t problem) : path_(std::move(path)), problem_(problem), chain_(problem) {}

  bool used() const { return !path_.empty(); }
  const Path &path() const { return path_; }

  /// The frames up to the first record that is not whole, `most` at most. Says in the log why a file, or the end of one, is not
  /// used; what is not used is gone, and append() goes on from there. Throws Error if the file cannot be written.
  std::vector<TrackedFrame> read(std::size_t most, const Context &context);
  /// Empties the file.
  void start_over();
  /// Throws Error naming the file if it cannot be written (full disk).
  void append(const TrackedFrame &frame);

private:
  std::string header() const;
  std::string why_not(const std::string &start) const;
  std::vector<TrackedFrame> read_records(std::size_t most, const Context &context);
  std::uint64_t checksum(const std::string &bytes) const;

  Path path_;
  std::uint64_t problem_;
  std::uint64_t chain_; // checksum of all records so far
};

} // namespace doublet
