#include "doublet/capture/session_check.h"

#include "session_check/checks.h"

#include <algorithm>

namespace doublet {
namespace {

using Check = detail::Findings (*)(detail::Evidence &);

/// The cheap ones first.
std::vector<Check> checks_of(bool scanned) {
  using namespace detail;
  if (!scanned)
    return {check_rates, check_masks};
  return {check_scan, check_joints, check_calibration, check_rates, check_masks, check_overlap};
}

} // namespace

SessionCheck check_session(const Session &session, FrameSource &frames, const SilhouetteExtractor *extractor,
                           const Context &context) {
  detail::Evidence evidence = detail::gather_evidence(session, frames, extractor, context);
  std::vector<Finding> findings;
  for (const Check check : checks_of(evidence.scanned())) {
    context.throw_if_cancelled();
    const std::vector<Finding> more = check(evidence);
    findings.insert(findings.end(), more.begin(), more.end());
    if (std::any_of(more.begin(), more.end(), [](const Finding &finding) { return finding.impossible; }))
      break; // nothing is looked for in what cannot be
  }
  SessionCheck result = std::move(evidence.found);
  result.findings = std::move(findings);
  result.start_text = detail::describe_start(result.start);
  return result;
}

} // namespace doublet
