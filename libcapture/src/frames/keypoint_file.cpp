#include "keypoint_file.h"

#include "doublet/core/error.h"
#include "doublet/files/npz.h"

namespace doublet::detail {

std::vector<std::vector<Keypoint>> read_keypoints(const std::filesystem::path &path, const std::vector<SessionCamera> &cameras,
                                                  int frame_count) {
  std::vector<std::string> names;
  for (const SessionCamera &camera : cameras)
    names.push_back(camera.name);
  const Npz file = Npz::read(path, names);
  if (file.arrays.empty())
    throw Error(path.string() + ": expected keypoints of the session's cameras, an array of each one's name, found none");
  std::vector<std::vector<Keypoint>> keypoints(cameras.size());
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (!file.has(names[c]))
      continue;
    file.require_shape(names[c], {-1, kKeypoints, 3});
    const int needed = cameras[c].first_frame + frame_count;
    if (file.shape(names[c])[0] < needed)
      throw Error(path.string() + ": expected keypoints of " + std::to_string(needed) + " frames of camera '" + names[c] +
                  "', found " + std::to_string(file.shape(names[c])[0]));
    const std::vector<double> values = file.values(names[c]);
    for (std::size_t i = 0; i < values.size(); i += 3)
      keypoints[c].push_back({{values[i], values[i + 1]}, values[i + 2]});
  }
  return keypoints;
}

} // namespace doublet::detail
