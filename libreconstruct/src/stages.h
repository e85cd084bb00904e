#pragma once
// The stages that default_stages() lists; each returns the numbers worth recording, and is in a file with those of its kind.

#include "json.h"

#include "doublet/reconstruct/reconstruction.h"

#include <string>
#include <vector>

namespace doublet::detail {

inline constexpr const char *kCaptureCheckpoint = "capture_checkpoint.bin", *kFitCheckpoint = "fit_checkpoint.txt";

Json run_check(Reconstruction &reconstruction);
Json run_template(Reconstruction &reconstruction);
Json run_rig(Reconstruction &reconstruction);
Json run_performance(Reconstruction &reconstruction);
Json run_segment(Reconstruction &reconstruction);
Json run_body(Reconstruction &reconstruction);
Json run_garment(Reconstruction &reconstruction);
Json run_fit(Reconstruction &reconstruction);
Json run_character(Reconstruction &reconstruction);

/// Of run_fit and fit_together.
Json fit_summary(const FitResult &result);

/// The stage of that name; throws std::invalid_argument if there is none.
Stage &stage_named(std::vector<Stage> &stages, const std::string &name);

/// Files of a session by the names that Stage::session_inputs has.
std::vector<Path> session_files(const Session &session, const std::string &kind);

} // namespace doublet::detail
