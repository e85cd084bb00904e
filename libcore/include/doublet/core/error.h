#pragma once
// Errors: broken files and impossible inputs throw doublet::Error; wrong arguments throw std::invalid_argument.
// The message names the file or argument, what was expected and what was found, in one sentence.

#include <stdexcept>
#include <string>

namespace doublet {

class Error : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// A file that is not there (Python: FileNotFoundError).
class FileNotFound : public Error {
public:
  using Error::Error;
};

/// The user asked to stop (Ctrl-C, or Context::cancelled returned true). Nothing that was written is lost.
class Cancelled : public Error {
public:
  Cancelled() : Error("cancelled") {}
};

} // namespace doublet
