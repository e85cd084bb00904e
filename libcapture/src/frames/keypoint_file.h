#pragma once

#include "doublet/capture/keypoints.h"
#include "doublet/capture/session.h"

#include <vector>

namespace doublet::detail {

/// keypoints.npz of a session: for each of `cameras` kKeypoints a frame, frame after frame of its file (docs/formats.md); none of
/// a camera that the file does not name. Throws Error if it names none of them, or has too few frames of one.
std::vector<std::vector<Keypoint>> read_keypoints(const std::filesystem::path &path, const std::vector<SessionCamera> &cameras,
                                                  int frame_count);

} // namespace doublet::detail
