#pragma once
// What the parsers of mesh files share.

#include "doublet/core/error.h"
#include "doublet/core/mesh.h"
#include "doublet/core/parts/number_text.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace doublet::detail {

/// A mesh as it is read, corner by corner.
struct GrowingMesh {
  std::vector<double> coordinates; ///< 3 a vertex
  std::vector<int> corners;        ///< 3 a triangle

  void add_vertex(double x, double y, double z) { coordinates.insert(coordinates.end(), {x, y, z}); }
  /// A fan of triangles; what is not convex is cut in another way when all vertices are known.
  void add_polygon(const std::vector<int> &polygon) {
    if (polygon.size() > 3)
      polygons.push_back({corners.size(), polygon.size()});
    for (std::size_t k = 2; k < polygon.size(); ++k)
      corners.insert(corners.end(), {polygon[0], polygon[k - 1], polygon[k]});
  }
  Mesh mesh(const std::string &source); ///< for messages

private:
  struct Polygon {
    std::size_t first, size; ///< of corners, as a fan; of the polygon
  };
  std::vector<Polygon> polygons;
};

/// The polygon (at least 4 corners) as triangles, the same number as a fan has; empty if a fan is right: if it is convex, or no
/// polygon at all.
std::vector<int> cut_polygon(const std::vector<double> &coordinates, const std::vector<int> &polygon);

/// Vertices at one place, on edges that end there from both sides, become one: files with texture have seams, the surface none.
Mesh without_seams(const Mesh &mesh);

/// An index as a corner; what no vertex can have stays out of range.
inline int as_corner(double index) {
  return index >= 0 && index < std::numeric_limits<int>::max() ? static_cast<int>(index) : -1;
}

/// Words of a text, with the line for messages. `continued`: a line that ends in \\ goes on in the next, # ends its words (OBJ).
class Words {
public:
  Words(std::string_view text, std::string source, bool continued = false)
      : text_(text), source_(std::move(source)), continued_(continued) {}

  /// The next word on any line; empty at the end of the file.
  std::string_view next() { return word(true); }
  /// The next word on this line; empty at its end.
  std::string_view next_on_line() { return word(false); }
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n')
      ++at_;
  }
  /// Skips to the first word of a line that is neither empty nor a comment; empty at the end of the file.
  std::string_view next_line() {
    skip_line();
    std::string_view first = next();
    while (first.starts_with('#')) {
      skip_line();
      first = next();
    }
    return first;
  }
  double number(std::string_view text, const char *expected) const {
    const std::optional<double> value = parse_number(text);
    if (!value)
      fail(expected, text);
    return *value;
  }
  double next_number(const char *expected) { return number(next(), expected); }
  double next_number_on_line(const char *expected) { return number(next_on_line(), expected); }
  /// A number of things, each of which takes at least `least` bytes.
  std::size_t count(std::string_view text, std::size_t least, const char *expected) const {
    const double value = number(text, expected);
    if (!(value >= 0) || value != std::floor(value))
      fail(expected, text);
    if (value > static_cast<double>(text_.size() / least))
      fail((std::string(expected) + " that the file has room for").c_str(), text);
    return static_cast<std::size_t>(value);
  }
  [[noreturn]] void fail(const std::string &expected, std::string_view found) const {
    throw Error(source_ + ":" + std::to_string(line_) + ": expected " + expected + ", found " +
                (found.empty() ? "the end" : "'" + printable(found) + "'"));
  }
  std::size_t position() const { return at_; }

private:
  static std::string printable(std::string_view word) {
    std::string text(word.substr(0, 40));
    for (char &c : text)
      c = c >= ' ' && c <= '~' ? c : '?';
    return text;
  }
  std::string_view word(bool over_lines) {
    constexpr std::string_view kBlank = " \t\r\v\f";
    while (at_ < text_.size() && (goes_on() || kBlank.find(text_[at_]) != kBlank.npos || (over_lines && text_[at_] == '\n'))) {
      at_ += goes_on();
      line_ += text_[at_++] == '\n';
    }
    const std::size_t begin = at_;
    if (continued_ && !over_lines && at_ < text_.size() && text_[at_] == '#')
      return {};
    while (at_ < text_.size() && text_[at_] != '\n' && !goes_on() && kBlank.find(text_[at_]) == kBlank.npos)
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// Is this the end of a line that goes on in the next?
  bool goes_on() const { return continued_ && text_.substr(at_, 2) == "\\\n"; }

  std::string_view text_;
  std::string source_;
  bool continued_;
  std::size_t at_ = 0;
  int line_ = 1;
};

} // namespace doublet::detail
