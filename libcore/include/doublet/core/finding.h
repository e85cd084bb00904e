// What is wrong with a session, or with the result of a stage.
#pragma once

#include <string>

namespace doublet {

struct Finding {
  bool impossible = false; ///< the run stops; false = doubtful: it is reported, and the run goes on
  std::string text;        ///< one sentence that names expectation and finding
  std::string kind = {};   ///< a word for programs, such as "cloth_ends"; may be empty
};

} // namespace doublet
