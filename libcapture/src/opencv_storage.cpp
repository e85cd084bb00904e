#include "opencv_storage.h"

#include "frame_reader.h"

#include <cstdint>

namespace doublet::detail {

cv::FileStorage open_storage(const std::filesystem::path &path) {
  quiet_opencv();
  if (!std::filesystem::is_regular_file(path))
    throw FileNotFound(path.string() + ": the calibration does not exist");
  try {
    cv::FileStorage storage(path.string(), cv::FileStorage::READ);
    if (storage.isOpened())
      return storage;
  } catch (const cv::Exception &e) {
    throw Error(path.string() + ": expected an OpenCV calibration file (YAML), found a syntax error (" + e.err + ")");
  }
  throw Error(path.string() + ": expected an OpenCV calibration file (YAML), found one that OpenCV cannot open");
}

std::vector<double> numbers_of(const cv::FileNode &node) {
  // OpenCV makes a matrix of the size that the file says, and only then looks whether it has as many numbers: hence not by >>.
  const cv::FileNode list = node.isMap() ? node["data"] : node;
  if (!list.isSeq())
    return {};
  if (node.isMap() && !(node["rows"].isInt() && node["cols"].isInt() &&
                        static_cast<std::int64_t>(static_cast<int>(node["rows"])) * static_cast<int>(node["cols"]) ==
                            static_cast<std::int64_t>(list.size())))
    return {};
  std::vector<double> numbers;
  for (const cv::FileNode &number : list) {
    if (!number.isInt() && !number.isReal())
      return {};
    numbers.push_back(static_cast<double>(number));
  }
  return numbers;
}

void throw_unreadable(const std::filesystem::path &path, const std::exception &problem) {
  const auto *opencv = dynamic_cast<const cv::Exception *>(&problem);
  throw Error(path.string() + ": expected an OpenCV calibration file, found an entry that cannot be read (" +
              (opencv ? opencv->err : std::string(problem.what())) + ")");
}

} // namespace doublet::detail
