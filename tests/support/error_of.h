#pragma once
#include "doublet/core/error.h"

#include <functional>
#include <string>

namespace doublet::testing {

/// What the call's Error says; empty if it throws none.
inline std::string error_of(const std::function<void()> &call) {
  try {
    call();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

} // namespace doublet::testing
