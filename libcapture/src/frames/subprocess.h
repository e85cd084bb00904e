#pragma once
// A program that runs beside this one and is read from.

#include <cstdio>
#include <memory>
#include <string>
#include <sys/types.h>
#include <vector>

namespace doublet::detail {

/// Reads nothing, writes to output(). Ended, if it still runs, when the object goes. It does not see the terminal's Ctrl-C: the
/// one who waits for it does, and decides.
class Subprocess {
public:
  /// `command`: the program, looked for in PATH, and its arguments. Throws Error if it cannot be started, with `advice` if there
  /// is no such program.
  explicit Subprocess(const std::vector<std::string> &command, const std::string &advice = "");
  ~Subprocess();
  Subprocess(const Subprocess &) = delete;
  Subprocess &operator=(const Subprocess &) = delete;

  std::FILE *output() const { return output_.get(); } ///< its standard output
  std::FILE *notes() const { return notes_.get(); }   ///< what it writes to its file 3
  /// Waits for the end, for which output() should have been read to its own. True if the program was content.
  bool wait();
  std::string complaint(); ///< first line of its standard error, so far; without one empty

private:
  struct Close {
    void operator()(std::FILE *file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  File output_, notes_, complaints_;
  pid_t process_ = -1;
};

} // namespace doublet::detail
