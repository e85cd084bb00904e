#pragma once
// Errors: broken files and impossible inputs throw doublet::Error; wrong arguments throw std::invalid_argument; a cancelled call
// throws doublet::Cancelled.
// The message names the file or argument, what was expected and what was found, in one sentence.

#include <exception>
#include <stdexcept>
#include <string>

namespace doublet {

/// The message as one line of valid UTF-8: it may quote a file that holds anything.
class Error : public std::runtime_error {
public:
  explicit Error(const std::string &message);
};

/// A file that is not there (Python: FileNotFoundError).
class FileNotFound : public Error {
public:
  using Error::Error;
};

/// The user asked to stop (Ctrl-C, or Context::cancelled returned true). Nothing that was written is lost. Not derived from
/// Error: code that catches Error in order to go on with the next item must not go on after Ctrl-C.
class Cancelled : public std::exception {
public:
  const char *what() const noexcept override { return "cancelled"; }
};

} // namespace doublet
