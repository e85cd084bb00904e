#pragma once
// Errors: broken files and impossible inputs throw doublet::Error; wrong arguments throw std::invalid_argument. Who asked to stop
// gets doublet::Cancelled.
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

/// The user asked to stop (Ctrl-C, or Context::cancelled returned true). Nothing that was written is lost. No Error: who catches
/// one, to go on without a file or with the next item, does not go on after Ctrl-C.
class Cancelled : public std::exception {
public:
  const char *what() const noexcept override { return "cancelled"; }
};

} // namespace doublet
