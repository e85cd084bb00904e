#pragma once
// Files of OpenCV's FileStorage (YAML, XML, JSON), read so that a damaged one ends in a sentence.

#include "doublet/core/error.h"

#include <filesystem>
#include <opencv2/core/persistence.hpp>
#include <string>
#include <vector>

namespace doublet::detail {

cv::FileStorage open_storage(const std::filesystem::path &path);
/// A matrix, or a list of numbers, or of rows of them; empty if the node is neither, or has not as many numbers as it says.
std::vector<double> numbers_of(const cv::FileNode &node);
/// Error for what OpenCV's parser, or the standard library in it, threw while `path` was read.
[[noreturn]] void throw_unreadable(const std::filesystem::path &path, const std::exception &problem);

/// read(storage) of a file; every exception that is not ours becomes Error naming it.
template <class Read> auto read_storage(const std::filesystem::path &path, Read &&read) try {
  const cv::FileStorage storage = open_storage(path);
  return read(storage);
} catch (const Error &) {
  throw;
} catch (const std::exception &problem) {
  throw_unreadable(path, problem);
}

} // namespace doublet::detail
