#include "doublet/files/files.h"

#include "doublet/core/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace doublet {

namespace {

/// The file that a link leads to, whether it is there or not.
Path behind_links(const Path &path) {
  constexpr int kMostLinks = 40; // as Linux follows
  std::error_code error;
  Path target = path;
  for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
    if (links == kMostLinks)
      throw Error(path.string() + ": expected a file to write, found links that lead to each other");
    target = target.parent_path() / std::filesystem::read_symlink(target, error);
  }
  return target;
}

/// In `folder` and with the extension of `path` (writers choose formats by it); no other process or thread uses the same name.
Path temporary_in(const Path &folder, const Path &path) {
  static std::atomic<unsigned> counter{0};
  const std::string name = std::string(".") + path.stem().string() + "." + std::to_string(getpid()) + "-" +
                           std::to_string(counter++) + ".tmp" + path.extension().string();
  return folder / name;
}

void create_folder_of(const Path &path) {
  std::error_code error;
  if (path.has_parent_path())
    std::filesystem::create_directories(path.parent_path(), error);
  if (error)
    throw Error(path.string() + ": its folder cannot be made: " + error.message());
}

/// A rename would put a file in the place of a device or pipe.
void refuse_special(const Path &path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error(path.string() + ": expected a file to write, found " +
                (std::filesystem::is_directory(status) ? "a folder" : "a device or pipe"));
}

[[noreturn]] void fail_to_write(const Path &path, int code) {
  throw Error(path.string() +
              ": cannot be written: " + (code ? std::strerror(code) : "the disk is full, or there is no permission"));
}

/// What is still in memory goes to the disk, which may only now say that it is full.
void flush_to_disk(const Path &temporary, const Path &path) {
  const int file = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0)
    fail_to_write(path, errno);
  const int failed = ::fsync(file) != 0 && errno != EINVAL ? errno : 0; // EINVAL: a file system that knows no fsync
  ::close(file);
  if (failed)
    fail_to_write(path, failed);
}

} // namespace

void write_atomically(const Path &path, const std::function<void(const Path &)> &write) {
  refuse_special(path);
  const Path target = behind_links(path); // which is replaced, not the link
  create_folder_of(target);
  const Path temporary = temporary_in(target.parent_path(), path);
  std::error_code error;
  try {
    write(temporary);
    flush_to_disk(temporary, path);
  } catch (...) {
    std::filesystem::remove(temporary, error);
    throw;
  }
  std::filesystem::rename(temporary, target, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(path.string() + ": cannot be written: " + error.message());
  }
}

void write_stream(const Path &path, const std::function<void(std::ostream &)> &write) {
  write_atomically(path, [&](const Path &temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    if (out)
      write(out);
    out.close();
    if (!out)
      fail_to_write(path, errno);
  });
}

void write_text(const Path &path, const std::string &text) {
  write_stream(path, [&](std::ostream &out) { out << text; });
}

std::string read_text(const Path &path) {
  if (!std::filesystem::exists(path))
    throw FileNotFound(path.string() + ": no such file");
  if (std::filesystem::is_directory(path))
    throw Error(path.string() + ": expected a file, found a folder");
  if (!std::filesystem::is_regular_file(path))
    throw Error(path.string() + ": expected a file, found a device or pipe");
  std::ifstream in(path, std::ios::binary);
  // Not by way of a stringstream: without memory it ends the text early, and says nothing.
  std::string text, piece(1 << 16, '\0');
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0)
    text.append(piece, 0, static_cast<std::size_t>(in.gcount()));
  if (in.bad() || !in.eof())
    throw Error(path.string() + ": cannot be read");
  return text;
}

std::string plain_text(std::string text, const std::string &source) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error(source + ": expected text in ASCII or UTF-8, found UTF-16");
  if (text.starts_with("\xEF\xBB\xBF"))
    text.erase(0, 3);
  std::size_t to = 0;
  for (std::size_t from = 0; from < text.size(); ++from) {
    const bool ends = text[from] == '\r';
    text[to++] = ends ? '\n' : text[from];
    if (ends && from + 1 < text.size() && text[from + 1] == '\n')
      ++from;
  }
  text.resize(to);
  return text;
}

namespace {
constexpr int kDeepest = 64;
}

void require_shallow_json(std::string_view text, const std::string &source) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '[' || c == '{') && ++depth > kDeepest)
      throw Error(source + ": expected JSON of at most " + std::to_string(kDeepest) + " levels, found more");
    else if (!quoted && (c == ']' || c == '}'))
      --depth;
  }
}

namespace {

/// Levels of elements that are open at once, at most.
int deepest_element(std::string_view text) {
  int depth = 0, deepest = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    if (text[i] == '<' && text[i + 1] == '/')
      --depth;
    else if (text[i] == '<' && text[i + 1] != '!' && text[i + 1] != '?')
      deepest = std::max(deepest, ++depth);
    else if (text[i] == '/' && text[i + 1] == '>')
      --depth;
  return deepest;
}

int deepest_bracket(std::string_view text) {
  int depth = 0, deepest = 0;
  for (const char c : text)
    if (c == '[' || c == '{')
      deepest = std::max(deepest, ++depth);
    else if ((c == ']' || c == '}') && depth > 0)
      --depth;
  return deepest;
}

/// Every part of a dotted key is a table.
int longest_key(std::string_view text) {
  int dots = 0, longest = 0;
  for (const char c : text)
    if (c == '.')
      longest = std::max(longest, ++dots);
    else if (c == '=' || c == ',' || c == '{' || c == '}' || c == '\n')
      dots = 0;
  return longest;
}

} // namespace

void require_shallow(std::string_view text, Markup markup, const std::string &source) {
  int deepest = markup == Markup::Xml ? deepest_element(text) : deepest_bracket(text);
  if (markup == Markup::Toml)
    deepest = std::max(deepest, longest_key(text));
  if (deepest > kDeepest)
    throw Error(source + ": expected at most " + std::to_string(kDeepest) + " levels, found more");
}

std::string read_json_text(const Path &path) {
  std::string text = read_text(path);
  require_shallow_json(text, path.string());
  return text;
}

void require_format(int found, int newest, const std::string &source) {
  if (found >= 1 && found <= newest)
    return;
  const std::string known = newest == 1 ? "1" : "1 to " + std::to_string(newest);
  throw Error(source + ": expected format " + known + ", found " + std::to_string(found) +
              (found > newest ? ", which a newer version of doublet writes" : ""));
}

} // namespace doublet
