// What is wrong with a session, or with the result of a stage.
#pragma once

#include <string>

namespace doublet {

struct Finding {
  bool impossible = false; ///< nothing should be built on it; otherwise it is doubtful, and only said
  std::string text;        ///< one sentence that names expectation and finding
  std::string kind = {};   ///< a word for programs, such as "cloth_ends"; may be empty
};

} // namespace doublet
