#pragma once

#include <filesystem>
#include <random>
#include <string>

namespace doublet::testing {

/// A folder that goes when the test goes.
class TempFolder {
public:
  TempFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("doublet-test-" + std::to_string(std::random_device{}()) + "-" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directories(path_);
  }
  TempFolder(const TempFolder &) = delete;
  TempFolder &operator=(const TempFolder &) = delete;
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path &path() const { return path_; }
  std::filesystem::path operator/(const std::string &name) const { return path_ / name; }

private:
  std::filesystem::path path_;
};

} // namespace doublet::testing
