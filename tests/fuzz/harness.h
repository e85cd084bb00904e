#pragma once
// What the harnesses of the readers share. A harness reads one input, whatever its bytes: DOUBLET_HARNESS(name) { ... input ...
// }. Linked with libFuzzer it is that library's; linked with replay.cpp it is one of the table that a test runs over its corpus.

#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unistd.h>

namespace doublet::fuzz {

using Harness = void (*)(std::string_view input);

#ifdef DOUBLET_LIBFUZZER
#define DOUBLET_HARNESS(name)                                                                                                    \
  static void fuzz_##name(std::string_view input);                                                                               \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {                                            \
    fuzz_##name({reinterpret_cast<const char *>(data), size});                                                                   \
    return 0;                                                                                                                    \
  }                                                                                                                              \
  static void fuzz_##name(std::string_view input)
#else
std::map<std::string, Harness> &harnesses();
#define DOUBLET_HARNESS(name)                                                                                                    \
  static void fuzz_##name(std::string_view input);                                                                               \
  static const bool added_##name = doublet::fuzz::harnesses().emplace(#name, &fuzz_##name).second;                               \
  static void fuzz_##name(std::string_view input)
#endif

/// Where this process keeps the files that are read; run.sh has TMPDIR in memory, and removes it.
inline Path folder() {
  static const Path path = std::filesystem::temp_directory_path() / ("doublet-fuzz-" + std::to_string(getpid()));
  return path;
}

inline Path put(const std::string &name, std::string_view content) {
  const Path path = folder() / name;
  std::filesystem::create_directories(path.parent_path());
  std::FILE *file =
      std::fopen(path.c_str(), "wb"); // not write_text(): a disk is waited for there, a thousand times a second here
  if (!file || std::fwrite(content.data(), 1, content.size(), file) != content.size() || std::fclose(file) != 0)
    std::abort();
  return path;
}

/// Inputs of several files: each begins with a line "==== NAME", of the names that the harness knows. What is before is dropped.
inline std::map<std::string, std::string> files_of(std::string_view input, const std::set<std::string> &known) {
  constexpr std::string_view kMark = "==== ";
  std::map<std::string, std::string> files;
  std::string *file = nullptr;
  for (std::size_t at = 0; at < input.size();) {
    const std::size_t end = std::min(input.find('\n', at), input.size() - 1) + 1;
    const std::string_view line = input.substr(at, end - at);
    const std::string name(line.starts_with(kMark) ? line.substr(kMark.size(), line.size() - kMark.size() - 1) : "");
    if (known.count(name))
      file = &files[name];
    else if (file)
      file->append(line);
    at = end;
  }
  return files;
}

/// A reader takes a file, or says in one sentence why not. Anything else ends the process.
template <class Read> void expect_read_or_refused(Read read) {
  constexpr std::size_t kLongest = 500; // as in mutate.py, the path not counted
  std::string said;
  try {
    read();
    return;
  } catch (const Error &error) { // FileNotFound, too
    said = error.what();
  } catch (const std::invalid_argument &error) {
    said = error.what();
  } // anything else, std::bad_alloc too, is nobody's to catch
  for (std::size_t at; (at = said.find(folder().string())) != std::string::npos;)
    said.erase(at, folder().string().size());
  if (!said.empty() && said.size() <= kLongest && said.find('\n') == std::string::npos)
    return;
  std::fprintf(stderr, "expected a sentence of at most %zu characters in one line, found: %s\n", kLongest, said.c_str());
  std::abort();
}

} // namespace doublet::fuzz
