// OBJ, STL and OFF; PLY has a file of its own.

#include "mesh_formats.h"
#include "doublet/files/files.h"
#include "mesh_parsing.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <ostream>

namespace doublet::detail {
namespace {

constexpr std::size_t kStlHeader = 84, kStlFacet = 50, kStlLooked = 1024; // bytes

/// The shortest decimal that reads back to the same number.
std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

void print_rows(const char *prefix, const Vertices &rows, std::ostream &out) {
  for (Eigen::Index v = 0; v < rows.rows(); ++v)
    out << prefix << shortest(rows(v, 0)) << ' ' << shortest(rows(v, 1)) << ' ' << shortest(rows(v, 2)) << '\n';
}

/// "7", "7/1", "7//2" or "-1/..": from 1, or from the last vertex backwards.
int obj_corner(const Words &words, std::string_view word, std::size_t vertices) {
  const double index = words.number(word.substr(0, word.find('/')), "corners of a face");
  if (index == 0 || index != std::floor(index))
    words.fail("corners of a face, counted from 1", word);
  return as_corner(index > 0 ? index - 1 : static_cast<double>(vertices) + index);
}

/// Vertices that are given several times, once a facet.
class SharedVertices {
public:
  explicit SharedVertices(const std::string &source) : source_(source) {}

  int find(const std::array<float, 3> &point) {
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2])) // NaN has no place in a map
      throw Error(source_ + ": expected finite coordinates, found others at triangle " + std::to_string(mesh.corners.size() / 3));
    const auto [at, fresh] = index_.try_emplace(point, static_cast<int>(index_.size()));
    if (fresh)
      mesh.add_vertex(point[0], point[1], point[2]);
    return at->second;
  }
  GrowingMesh mesh;

private:
  const std::string &source_;
  std::map<std::array<float, 3>, int> index_;
};

Mesh parse_stl_text(const std::string &data, const std::string &source) {
  Words words(data, source);
  SharedVertices shared(source);
  const auto is = [](std::string_view word, std::string_view expected) {
    return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                      [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
  };
  const auto require = [&](std::string_view word, const char *expected) {
    if (!is(word, expected))
      words.fail(expected, word);
  };
  for (std::string_view key = words.next(); !key.empty(); key = words.next()) {
    if (is(key, "solid") || is(key, "endsolid")) {
      words.skip_line();
      continue;
    }
    const bool padding = key.find_first_not_of(std::string_view("\0\x1A", 2)) == key.npos; // DOS ended its texts so
    if (padding && words.next().empty())
      break;
    require(key, "facet");
    std::string_view word = words.next();
    for (int skipped = 0; skipped < 4 && !is(word, "outer"); ++skipped) // its normal follows from the corners
      word = words.next();
    require(word, "outer");
    require(words.next(), "loop");
    std::vector<int> corners;
    for (int k = 0; k < 3; ++k) {
      require(words.next(), "vertex");
      std::array<float, 3> point{};
      for (float &x : point)
        x = static_cast<float>(words.next_number("three coordinates"));
      corners.push_back(shared.find(point));
    }
    require(words.next(), "endloop");
    require(words.next(), "endfacet");
    shared.mesh.add_polygon(corners);
  }
  return shared.mesh.mesh(source);
}

/// Binary files begin with any 80 bytes, "solid" among them, but their count has zeros, which no text has.
bool is_stl_text(const std::string &start) {
  const std::size_t begin = start.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  std::string word = start.substr(std::min(start.find_first_not_of(" \t\r\n", begin), start.size()), 5);
  for (char &c : word)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word == "solid" && start.find('\0') == std::string::npos;
}

std::size_t attribute_bytes(const std::string &data, std::size_t facet) {
  std::uint16_t bytes = 0;
  std::memcpy(&bytes, data.data() + facet + kStlFacet - sizeof bytes, sizeof bytes);
  return bytes;
}

/// Some programs put as many bytes behind a triangle as its last two say, most a colour there, or nothing: these are attributes
/// if the file is as long as they say.
bool has_attributes(const std::string &data, std::size_t count) {
  std::size_t at = kStlHeader;
  for (std::size_t f = 0; f < count; ++f) {
    if (data.size() - at < kStlFacet)
      return false;
    const std::size_t behind = attribute_bytes(data, at);
    if (data.size() - at - kStlFacet < behind)
      return false;
    at += kStlFacet + behind;
  }
  return at == data.size();
}

/// Finite, with a normal of length 1 or none: other bytes are no triangle.
bool is_facet(const std::string &data, std::size_t at) {
  std::array<float, 12> numbers;
  std::memcpy(numbers.data(), data.data() + at, sizeof numbers);
  const float length = std::hypot(numbers[0], numbers[1], numbers[2]);
  return std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); }) &&
         (length == 0 || std::abs(length - 1) < 0.01F);
}

/// Triangles behind those that the header counts, as programs leave them that count before they are done; none if anything else
/// is behind, or zeros.
std::size_t uncounted(const std::string &data, std::size_t needed) {
  if ((data.size() - needed) % kStlFacet != 0 || data.find_first_not_of('\0', needed) == data.npos)
    return 0;
  for (std::size_t at = needed; at < data.size(); at += kStlFacet)
    if (!is_facet(data, at))
      return 0;
  return (data.size() - needed) / kStlFacet;
}

} // namespace

Mesh parse_obj(const std::string &data, const std::string &source) {
  const std::string text = plain_text(data, source);
  Words words(text, source, true);
  GrowingMesh mesh;
  std::vector<int> corners;
  for (std::string_view key = words.next(); !key.empty(); words.skip_line(), key = words.next()) {
    if (key == "v") {
      double point[3];
      for (double &x : point)
        x = words.next_number_on_line("three coordinates");
      mesh.add_vertex(point[0], point[1], point[2]);
    } else if (key == "f") {
      corners.clear();
      for (std::string_view word = words.next_on_line(); !word.empty(); word = words.next_on_line())
        corners.push_back(obj_corner(words, word, mesh.coordinates.size() / 3));
      if (corners.size() < 3)
        words.fail("a face of at least 3 corners", std::to_string(corners.size()) + " corners");
      mesh.add_polygon(corners);
    }
  }
  return mesh.mesh(source);
}

Mesh parse_stl(const std::string &data, const std::string &source) {
  if (const std::string start = data.substr(0, kStlLooked); is_stl_text(start) || start.starts_with("\xFF\xFE"))
    return parse_stl_text(plain_text(data, source), source);
  std::uint32_t count = 0;
  if (data.size() >= kStlHeader)
    std::memcpy(&count, data.data() + kStlHeader - sizeof count, sizeof count);
  const std::size_t needed = kStlHeader + kStlFacet * static_cast<std::size_t>(count);
  if (data.size() < needed || data.size() < kStlHeader)
    throw Error(source + ": expected an STL file of " + std::to_string(needed) + " bytes for its " + std::to_string(count) +
                " triangles, found " + std::to_string(data.size()) + " bytes");
  const bool gaps = data.size() > needed && has_attributes(data, count);
  const std::size_t triangles = gaps ? count : count + uncounted(data, needed);
  SharedVertices shared(source);
  std::size_t at = kStlHeader;
  for (std::size_t f = 0; f < triangles; ++f) {
    std::array<std::array<float, 3>, 3> points;
    std::memcpy(points.data(), data.data() + at + sizeof points[0], sizeof points);
    std::vector<int> corners;
    for (const std::array<float, 3> &point : points)
      corners.push_back(shared.find(point));
    shared.mesh.add_polygon(corners);
    at += kStlFacet + (gaps ? attribute_bytes(data, at) : 0);
  }
  return shared.mesh.mesh(source);
}

Mesh parse_off(const std::string &data, const std::string &source) {
  const std::string text = plain_text(data, source);
  Words words(text, source);
  const std::string_view magic = words.next();
  if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF")
    words.fail("an OFF file", magic);
  constexpr std::size_t kLeast = 6; // bytes of a row: three numbers and what separates them
  std::string_view first = words.next_on_line();
  const std::size_t vertices =
      words.count(first.empty() || first.starts_with('#') ? words.next_line() : first, kLeast, "a number of vertices");
  const std::size_t faces = words.count(words.next_on_line(), kLeast, "a number of faces");
  GrowingMesh mesh;
  for (std::size_t v = 0; v < vertices; ++v) {
    const double x = words.number(words.next_line(), "three coordinates");
    const double y = words.next_number_on_line("three coordinates"), z = words.next_number_on_line("three coordinates");
    mesh.add_vertex(x, y, z);
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const std::size_t size = words.count(words.next_line(), 2, "a number of corners");
    if (size < 3)
      words.fail("a face of at least 3 corners", std::to_string(size) + " corners");
    std::vector<int> corners;
    for (std::size_t k = 0; k < size; ++k)
      corners.push_back(as_corner(words.next_number_on_line("corners of a face")));
    mesh.add_polygon(corners);
  }
  return mesh.mesh(source);
}

void print_obj(const Mesh &mesh, std::ostream &out) {
  out << "# metres, written by doublet\n";
  print_rows("v ", mesh.vertices, out);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    out << "f " << mesh.faces(f, 0) + 1 << ' ' << mesh.faces(f, 1) + 1 << ' ' << mesh.faces(f, 2) + 1 << '\n';
}

void print_stl(const Mesh &mesh, std::ostream &out) {
  std::string header = "metres, written by doublet"; // not "solid": that is a text file
  header.resize(kStlHeader - sizeof(std::uint32_t));
  out << header;
  const auto count = static_cast<std::uint32_t>(mesh.faces.rows());
  out.write(reinterpret_cast<const char *>(&count), sizeof count);
  const Vertices normals = face_normals(mesh.vertices, mesh.faces);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    std::array<char, kStlFacet> facet{};
    Eigen::Matrix<float, 4, 3, Eigen::RowMajor> rows;
    rows.row(0) = normals.row(f).cast<float>();
    for (int k = 0; k < 3; ++k)
      rows.row(k + 1) = mesh.vertices.row(mesh.faces(f, k)).cast<float>();
    std::memcpy(facet.data(), rows.data(), sizeof(float) * rows.size());
    out.write(facet.data(), facet.size());
  }
}

void print_off(const Mesh &mesh, std::ostream &out) {
  out << "OFF\n" << mesh.vertices.rows() << ' ' << mesh.faces.rows() << " 0\n";
  print_rows("", mesh.vertices, out);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    out << "3 " << mesh.faces(f, 0) << ' ' << mesh.faces(f, 1) << ' ' << mesh.faces(f, 2) << '\n';
}

} // namespace doublet::detail
