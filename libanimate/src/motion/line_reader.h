#pragma once
// Words of a text file with their line numbers, for parsers whose messages name the line.

#include "doublet/core/error.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace doublet {

inline std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct TextLine {
  int number = 0; ///< from 1
  std::vector<std::string> words;
};

class LineReader {
public:
  /// Lines without words are dropped; a '#' starts a comment if asked for.
  LineReader(const std::string &text, std::string source, bool comments) : source_(std::move(source)) {
    std::istringstream in(plain_text(text, source_));
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      if (comments)
        line.erase(std::min(line.find('#'), line.size()));
      TextLine parsed{number, {}};
      std::istringstream words(line);
      for (std::string word; words >> word;)
        parsed.words.push_back(word);
      if (!parsed.words.empty())
        lines_.push_back(std::move(parsed));
      last_number_ = number;
    }
  }
  bool done() const { return at_ >= lines_.size(); }
  const TextLine &peek(const std::string &expected) const {
    if (done())
      throw Error(source_ + ":" + std::to_string(last_number_) + ": expected " + expected + ", found the end of the file");
    return lines_[at_];
  }
  const TextLine &next(const std::string &expected) {
    const TextLine &line = peek(expected);
    ++at_;
    return line;
  }
  [[noreturn]] void fail(const TextLine &line, const std::string &expected) const {
    std::string found;
    for (const std::string &word : line.words)
      found += (found.empty() ? "" : " ") + word;
    if (found.size() > 80)
      found = found.substr(0, 77) + "...";
    throw Error(source_ + ":" + std::to_string(line.number) + ": expected " + expected + ", found '" + found + "'");
  }
  double number(const TextLine &line, std::size_t word, const std::string &expected) const {
    if (word >= line.words.size())
      fail(line, expected);
    const std::optional<double> value = parse_number(line.words[word]);
    if (!value || !std::isfinite(*value))
      fail(line, expected);
    return *value;
  }

private:
  std::string source_;
  std::vector<TextLine> lines_;
  std::size_t at_ = 0;
  int last_number_ = 0;
};

} // namespace doublet
