#include "doublet/core/files.h"

#include "doublet/core/error.h"

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <sstream>

namespace doublet {

namespace {

/// Beside `path` and with its extension (writers choose formats by it); no other process or thread uses the same name.
Path temporary_beside(const Path &path) {
  static std::atomic<unsigned> counter{0};
  const std::string name = std::string(".") + path.stem().string() + "." + std::to_string(getpid()) + "-" +
                           std::to_string(counter++) + ".tmp" + path.extension().string();
  return path.parent_path() / name;
}

void create_folder_of(const Path &path) {
  std::error_code error;
  if (path.has_parent_path())
    std::filesystem::create_directories(path.parent_path(), error);
  if (error)
    throw Error(path.string() + ": its folder cannot be made: " + error.message());
}

} // namespace

void write_atomically(const Path &path, const std::function<void(const Path &)> &write) {
  create_folder_of(path);
  const Path temporary = temporary_beside(path);
  std::error_code error;
  try {
    write(temporary);
  } catch (...) {
    std::filesystem::remove(temporary, error);
    throw;
  }
  std::filesystem::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(path.string() + ": cannot be written: " + error.message());
  }
}

void write_text(const Path &path, const std::string &text) {
  write_atomically(path, [&](const Path &temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out)
      throw Error(path.string() + ": cannot be written (disk full, or no permission?)");
  });
}

std::string read_text(const Path &path) {
  if (!std::filesystem::exists(path))
    throw FileNotFound(path.string() + ": no such file");
  if (std::filesystem::is_directory(path))
    throw Error(path.string() + ": expected a file, found a folder");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in)
    throw Error(path.string() + ": cannot be read");
  return text.str();
}

} // namespace doublet
