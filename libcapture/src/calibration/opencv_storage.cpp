#include "opencv_storage.h"

#include "doublet/files/files.h"
#include "frames/frame_reader.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string_view>

namespace doublet::detail {
namespace {

/// How often "- " stands behind itself, each of them a list within the one before.
std::size_t lists_within(const std::string &line) {
  std::size_t most = 0, run = 0;
  for (const char c : line)
    if (c == '-')
      most = std::max(most, ++run);
    else if (c != ' ' && c != '\t')
      run = 0;
  return most;
}

/// Throws for what sends OpenCV's parsers down without end: they recurse at every bracket, element and indent, and take their
/// time for base64.
void require_plain(const std::filesystem::path &path, const std::string &text) {
  constexpr std::size_t kMostBytes = 64 << 20, kDeepestIndent = 256, kDeepestLists = 64;
  if (text.size() > kMostBytes)
    throw Error(path.string() + ": expected a calibration of at most 64 MiB, found " + std::to_string(text.size()) + " bytes");
  for (const char *binary : {"!!binary", "$base64$", "type_id=\"binary\"", "type_id='binary'"})
    if (text.find(binary) != std::string::npos)
      throw Error(path.string() + ": expected numbers written out, found base64");
  require_shallow(text, Markup::Brackets, path.string());
  require_shallow(text, Markup::Xml, path.string());
  if (!text.starts_with("%YAML"))
    return;
  std::istringstream lines(text);
  int number = 1;
  for (std::string line; std::getline(lines, line); ++number)
    if (std::min(line.find_first_not_of("\t -"), line.size()) > kDeepestIndent || lists_within(line) > kDeepestLists)
      throw Error(path.string() + ":" + std::to_string(number) + ": expected at most " + std::to_string(kDeepestIndent) +
                  " columns of indent and " + std::to_string(kDeepestLists) + " lists, found more");
}

/// Throws unless a file of YAML is one mapping or list, a line an entry. Of what follows the first one OpenCV's parser takes "-
/// x" for the beginning of nothing, and looks at it for ever.
void require_one_collection(const std::filesystem::path &path, const std::string &text) {
  constexpr std::string_view kEnds("\r\0", 2); // of a line, to that parser
  std::istringstream lines(text);
  std::optional<std::size_t> indent; // of the first entry
  bool over = false;
  int number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    line.resize(std::min(line.size(), line.find_first_of(kEnds)));
    if (number == 1 && !line.starts_with("%YAML"))
      return; // XML or JSON
    const std::size_t column = line.find_first_not_of(" \t");
    if (column == line.npos || line[column] == '#' || (!indent && (line[0] == '%' || line == "---")))
      continue;
    if (indent && !over && line == "...") {
      over = true;
      continue;
    }
    const bool marks = line.starts_with("---") || line.starts_with("...");
    if (marks || (indent ? over || column < *indent : line.find_first_of("{[!&*|>", column) == column))
      throw Error(path.string() + ":" + std::to_string(number) + ": expected one mapping in the file, a line an entry, found '" +
                  line.substr(column, 20) + "'");
    if (!indent)
      indent = column;
  }
}

} // namespace

cv::FileStorage open_storage(const std::filesystem::path &path) {
  quiet_opencv();
  if (!std::filesystem::is_regular_file(path))
    throw FileNotFound(path.string() + ": the calibration does not exist");
  std::string text = read_text(path);
  const bool marked = text.starts_with("\xEF\xBB\xBF"); // as editors write it
  if (marked)
    text.erase(0, 3);
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  if (begin == text.size() || std::string_view("%{[<").find(text[begin]) == std::string_view::npos)
    throw Error(path.string() + ": expected an OpenCV file, which begins with %YAML, < or {, found another format (Python's "
                                "json.dump writes one that is read)");
  require_plain(path, text);
  require_one_collection(path, text);
  try {
    // OpenCV stumbles over the mark, takes what follows a question mark for parameters, and no name with the end of a line.
    const bool by_text = marked || path.string().find_first_of("?\n") != std::string::npos;
    cv::FileStorage storage(by_text ? text : path.string(),
                            by_text ? cv::FileStorage::READ | cv::FileStorage::MEMORY : static_cast<int>(cv::FileStorage::READ));
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
  const auto add = [&numbers](const cv::FileNode &number) {
    if (number.isInt() || number.isReal())
      numbers.push_back(static_cast<double>(number));
    return number.isInt() || number.isReal();
  };
  for (const cv::FileNode &entry : list)
    if (entry.isSeq()) { // a row of a matrix, as Python writes them in JSON
      for (const cv::FileNode &number : entry)
        if (!add(number))
          return {};
    } else if (!add(entry)) {
      return {};
    }
  return numbers;
}

void throw_unreadable(const std::filesystem::path &path, const std::exception &problem) {
  const auto *opencv = dynamic_cast<const cv::Exception *>(&problem);
  throw Error(path.string() + ": expected an OpenCV calibration file, found an entry that cannot be read (" +
              (opencv ? opencv->err : std::string(problem.what())) + ")");
}

} // namespace doublet::detail
