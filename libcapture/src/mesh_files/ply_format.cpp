// http://paulbourke.net/dataformats/ply/: a header that names elements and their properties, then their values, as text or raw.

#include "mesh_formats.h"
#include "mesh_parsing.h"

#include "doublet/options/options.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <ostream>

namespace doublet::detail {

static_assert(std::endian::native == std::endian::little, "what is raw is written little-endian");

namespace {

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };
constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};

std::size_t bytes_of(Type type) {
  return kBytes[static_cast<std::size_t>(type)];
}
bool is_integer(Type type) {
  return type != Type::Float32 && type != Type::Float64;
}

struct Property {
  std::string name;
  Type type;
  bool list = false;
  Type count_type = Type::Uint8; ///< of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
  /// Bytes that a row takes at least.
  std::size_t least(bool text) const {
    std::size_t sum = 0;
    for (const Property &property : properties)
      sum += text ? 2 : bytes_of(property.list ? property.count_type : property.type);
    return sum;
  }
};

enum class Encoding { Text, Little, Big };

struct Header {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
};

Type read_type(Words &words) {
  static const std::vector<std::pair<std::string_view, Type>> names = {
      {"char", Type::Int8},     {"int8", Type::Int8},       {"uchar", Type::Uint8},    {"uint8", Type::Uint8},
      {"short", Type::Int16},   {"int16", Type::Int16},     {"ushort", Type::Uint16},  {"uint16", Type::Uint16},
      {"int", Type::Int32},     {"int32", Type::Int32},     {"uint", Type::Uint32},    {"uint32", Type::Uint32},
      {"float", Type::Float32}, {"float32", Type::Float32}, {"double", Type::Float64}, {"float64", Type::Float64}};
  const std::string_view word = words.next_on_line();
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto &name) { return name.first == word; });
  if (found == names.end())
    words.fail("a type such as float or int", word);
  return found->second;
}

Property read_property(Words &words) {
  Property property{"", Type::Float32};
  Words ahead = words;
  if (ahead.next_on_line() == "list") {
    words.next_on_line();
    property.list = true;
    property.count_type = read_type(words);
    if (!is_integer(property.count_type))
      words.fail("an integer type for the length of a list", "float");
  }
  property.type = read_type(words);
  property.name = words.next_on_line();
  if (property.name.empty())
    words.fail("the name of a property", "");
  return property;
}

Encoding read_encoding(Words &words) {
  const std::string_view word = words.next_on_line();
  if (word == "ascii")
    return Encoding::Text;
  if (word != "binary_little_endian" && word != "binary_big_endian")
    words.fail("the format ascii, binary_little_endian or binary_big_endian", word);
  return word == "binary_little_endian" ? Encoding::Little : Encoding::Big;
}

/// Leaves `words` behind end_header.
Header read_header(Words &words) {
  if (const std::string_view first = words.next(); first != "ply")
    words.fail("a PLY file", first);
  Header header;
  bool format = false;
  for (;;) {
    words.skip_line();
    const std::string_view key = words.next();
    if (key == "end_header")
      break;
    if (key == "comment" || key == "obj_info")
      continue;
    if (key == "format") {
      header.encoding = read_encoding(words);
      format = true;
    } else if (key == "element") {
      Element element{std::string(words.next_on_line()), 0, {}};
      element.count = words.count(words.next_on_line(), 1, "a number of elements");
      header.elements.push_back(element);
    } else if (key == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(words));
    } else {
      words.fail("format, element, property or end_header", key);
    }
  }
  if (!format)
    words.fail("a line 'format' in the header", "end_header");
  words.skip_line();
  return header;
}

/// Values of a text body.
class TextValues {
public:
  static constexpr bool kText = true;
  explicit TextValues(Words words) : words_(std::move(words)) {}
  double next(Type) { return words_.next_number("a value of an element"); }
  bool room_for(std::size_t, Type) const { return true; } // reading on ends with the file
  bool at_end() { return words_.next().empty(); }

private:
  Words words_;
};

/// Values of a raw body.
class RawValues {
public:
  static constexpr bool kText = false;
  RawValues(std::string_view body, bool big_endian, std::string source)
      : body_(body), big_endian_(big_endian), source_(std::move(source)) {}

  double next(Type type) {
    switch (type) {
    case Type::Int8:
      return read<std::int8_t>();
    case Type::Uint8:
      return read<std::uint8_t>();
    case Type::Int16:
      return read<std::int16_t>();
    case Type::Uint16:
      return read<std::uint16_t>();
    case Type::Int32:
      return read<std::int32_t>();
    case Type::Uint32:
      return read<std::uint32_t>();
    case Type::Float32:
      return read<float>();
    default:
      return read<double>();
    }
  }
  bool room_for(std::size_t count, Type type) const { return count <= (body_.size() - at_) / bytes_of(type); }
  /// But for zeros and the end of a line, as some programs write.
  bool at_end() const { return body_.find_first_not_of(std::string_view("\0\r\n", 3), at_) == body_.npos; }

private:
  template <class T> double read() {
    if (body_.size() - at_ < sizeof(T))
      throw Error(source_ + ": expected more elements, found the end of the file (truncated?)");
    char raw[sizeof(T)];
    std::memcpy(raw, body_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (big_endian_)
      std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return static_cast<double>(value);
  }

  std::string_view body_;
  bool big_endian_;
  std::string source_;
  std::size_t at_ = 0;
};

template <class Values> class BodyReader {
public:
  BodyReader(Values values, std::size_t bytes, std::string source)
      : values_(std::move(values)), bytes_(bytes), source_(std::move(source)) {}

  Mesh read(const std::vector<Element> &elements) {
    for (const Element &element : elements) {
      const std::size_t least = element.least(Values::kText);
      // A number after the last one needs no blank.
      if (element.count > 0 && (least == 0 || element.count > (bytes_ + 1) / least))
        fail("expected " + std::to_string(element.count) + " elements '" + element.name + "', found " + std::to_string(bytes_) +
             " bytes for them");
      for (row_ = 0; row_ < element.count; ++row_)
        read_row(element);
    }
    if (!values_.at_end())
      fail("expected the end of the file after the last element, found more");
    return mesh_.mesh(source_);
  }

private:
  [[noreturn]] void fail(const std::string &what) const { throw Error(source_ + ": " + what); }

  void read_row(const Element &element) {
    const bool vertex = element.name == "vertex", face = element.name == "face";
    double point[3] = {0, 0, 0};
    bool polygon = false;
    for (const Property &property : element.properties) {
      if (property.list) {
        const bool corners = face && (property.name == "vertex_indices" || property.name == "vertex_index");
        read_list(property, corners);
        polygon = polygon || corners;
        continue;
      }
      const double value = values_.next(property.type);
      if (vertex && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        point[property.name[0] - 'x'] = value;
    }
    if (vertex)
      mesh_.add_vertex(point[0], point[1], point[2]);
    else if (polygon)
      mesh_.add_polygon(list_);
  }

  void read_list(const Property &property, bool corners) {
    const double length = values_.next(property.count_type);
    if (!(length >= 0) || length != std::floor(length) || length > static_cast<double>(bytes_) ||
        !values_.room_for(static_cast<std::size_t>(length), property.type))
      fail("expected a list '" + property.name + "' that the file has room for, found one of " + options::to_text(length) +
           " values at element " + std::to_string(row_));
    if (corners && length < 3)
      fail("expected faces of at least 3 corners, found " + std::to_string(static_cast<int>(length)) + " at face " +
           std::to_string(row_));
    if (corners)
      list_.clear(); // texture coordinates of the face may stand behind them
    for (std::size_t k = 0; k < static_cast<std::size_t>(length); ++k) {
      const double index = values_.next(property.type);
      if (corners)
        list_.push_back(as_corner(index));
    }
  }

  Values values_;
  std::size_t bytes_;
  std::string source_;
  GrowingMesh mesh_;
  std::vector<int> list_;
  std::size_t row_ = 0;
};

void require_mesh(const Header &header, const std::string &source) {
  const auto has = [&](const char *element, const char *property, bool list) {
    for (const Element &e : header.elements)
      for (const Property &p : e.properties)
        if (e.name == element && p.name == property && p.list == list)
          return true;
    return false;
  };
  for (const char *axis : {"x", "y", "z"})
    if (!has("vertex", axis, false))
      throw Error(source + ": expected vertices with x, y and z, found none with " + axis);
  if (!has("face", "vertex_indices", true) && !has("face", "vertex_index", true))
    throw Error(source + ": expected faces with a list vertex_indices, found none");
}

Mesh parse_usual(std::string_view data, const std::string &source) {
  Words words(data, source);
  const Header header = read_header(words);
  require_mesh(header, source);
  if (header.encoding == Encoding::Text)
    return BodyReader(TextValues(words), data.size() - words.position(), source).read(header.elements);
  const std::string_view body = data.substr(std::min(words.position() + 1, data.size())); // behind the line's end
  return BodyReader(RawValues(body, header.encoding == Encoding::Big, source), body.size(), source).read(header.elements);
}

/// Do lines end in \r alone, as old programs write them?
bool has_old_lines(std::string_view data) {
  return data.starts_with("ply\r") && !data.starts_with("ply\r\n");
}

std::string with_new_lines(std::string data) {
  constexpr std::string_view kEnd = "end_header\r";
  const std::size_t end = data.find(kEnd);
  const auto header = data.begin() + static_cast<std::ptrdiff_t>(end == data.npos ? data.size() : end + kEnd.size());
  const bool text = std::string_view(data.begin(), header).find("format ascii") != std::string_view::npos;
  std::replace(data.begin(), text ? data.end() : header, '\r', '\n');
  return data;
}

} // namespace

Mesh parse_ply(const std::string &file, const std::string &source) {
  std::string_view data = file;
  if (data.starts_with("\xEF\xBB\xBF"))
    data.remove_prefix(3);
  return has_old_lines(data) ? parse_usual(with_new_lines(std::string(data)), source) : parse_usual(data, source);
}

void print_ply(const Mesh &mesh, std::ostream &out) {
  out << "ply\nformat binary_little_endian 1.0\ncomment metres, written by doublet\nelement vertex " << mesh.vertices.rows()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.faces.rows()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(reinterpret_cast<const char *>(mesh.vertices.data()),
            static_cast<std::streamsize>(sizeof(double) * mesh.vertices.size()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    out.put(3);
    out.write(reinterpret_cast<const char *>(mesh.faces.data() + 3 * f), 3 * sizeof(int));
  }
}

} // namespace doublet::detail
