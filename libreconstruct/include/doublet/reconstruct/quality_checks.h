#pragma once
// Limits beyond which a result is doubtful or impossible.

#include "doublet/core/error.h"
#include "doublet/core/finding.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace doublet {

/// Thrown when a result is impossible.
class Implausible : public Error {
public:
  using Error::Error;
};

/// The limits of a number in a stage's summary: lower limits if `impossible` < `doubtful`, otherwise upper ones.
struct Limit {
  const char *stage, *number;
  double doubtful, impossible;
  const char *meaning, *advice;
  std::string expected() const; ///< "expected at least 0.85"
  std::optional<Finding> check(double value) const;
  std::string passed(double value) const; ///< a sentence if the number is within the limits, otherwise empty
};

/// The limits of all stages, docs/cli.md.
std::span<const Limit> quality_limits();

/// The findings about a finished stage, from its summary (a JSON object as text, see Stage::run): those that the stage reported,
/// and numbers beyond their limits. Throws Error if the summary is malformed.
std::vector<Finding> quality_findings(const std::string &stage, const std::string &summary);
/// The value of "findings" in the summary of a stage: a JSON array as text.
std::string findings_to_json(const std::vector<Finding> &findings);

} // namespace doublet
