// NumPy's format: a zip of .npy members, https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html

#include "doublet/files/npz.h"

#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <climits>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>

namespace doublet {

static_assert(std::endian::native == std::endian::little, "raw array data is little-endian");

namespace {

constexpr const char *kFormatName = "format";
constexpr std::uint64_t kMostExpansion = 1100; // of deflate: 1032, https://zlib.net/zlib_tech.html
// Of one array, in the place of that: what is larger and packs better has nothing in it but one number.
constexpr std::uint64_t kUsualExpansion = 100, kAnyway = 256 << 20; // bytes, whatever it expands from

using Bytes = std::vector<std::uint8_t>;
using Shape = std::vector<std::int64_t>;

std::string to_string(const Shape &shape) {
  std::string s = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    s += i ? ", " : "";
    s += shape[i] < 0 ? std::string("any") : std::to_string(shape[i]);
  }
  return s + (shape.size() == 1 ? ",)" : ")");
}

/// Product of the shape; nothing if an extent is negative or the product leaves 2^48, more than any file here can hold.
std::optional<std::int64_t> element_count(const Shape &shape) {
  std::int64_t n = 1;
  for (const std::int64_t e : shape) {
    if (e < 0 || (e > 0 && n > (std::int64_t{1} << 48) / e))
      return std::nullopt;
    n *= e;
  }
  return n;
}

/// Bytes an element takes in the file.
std::int64_t item_size(const std::string &type) {
  return (type[0] == 'U' ? 4 : 1) * std::stoll(type.substr(1));
}

bool numeric(const std::string &type) {
  return type[0] != 'U';
}
bool integer(const std::string &type) {
  return type[0] == 'i' || type[0] == 'u' || type[0] == 'b';
}

// --- reading

std::string utf8_from_utf32(const std::uint8_t *data, std::int64_t length) {
  std::string out;
  for (std::int64_t i = 0; i < length; ++i) {
    std::uint32_t c;
    std::memcpy(&c, data + 4 * i, 4);
    if (c == 0)
      break;
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xC0 | c >> 6);
      out += static_cast<char>(0x80 | (c & 0x3F));
    } else if (c < 0x10000) {
      out += static_cast<char>(0xE0 | c >> 12);
      out += static_cast<char>(0x80 | (c >> 6 & 0x3F));
      out += static_cast<char>(0x80 | (c & 0x3F));
    } else {
      out += static_cast<char>(0xF0 | (c >> 18 & 0x07));
      out += static_cast<char>(0x80 | (c >> 12 & 0x3F));
      out += static_cast<char>(0x80 | (c >> 6 & 0x3F));
      out += static_cast<char>(0x80 | (c & 0x3F));
    }
  }
  return out;
}

std::vector<std::uint32_t> utf32_from_utf8(const std::string &s) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < s.size();) {
    const auto lead = static_cast<std::uint8_t>(s[i++]);
    int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
    std::uint32_t c = more == 3 ? lead & 0x07 : more == 2 ? lead & 0x0F : more == 1 ? lead & 0x1F : lead;
    for (; more > 0 && i < s.size(); --more)
      c = c << 6 | (static_cast<std::uint8_t>(s[i++]) & 0x3F);
    out.push_back(c);
  }
  return out;
}

/// The text after "'key':" in the header's Python dictionary, leading blanks dropped.
std::optional<std::string> header_value(const std::string &header, const std::string &key) {
  const std::size_t at = header.find("'" + key + "':");
  if (at == std::string::npos)
    return std::nullopt;
  const std::size_t begin = header.find_first_not_of(' ', at + key.size() + 3);
  return begin == std::string::npos ? std::nullopt : std::optional(header.substr(begin));
}

/// Parses one .npy member; `where` is "FILE: array 'NAME'" for messages.
class NpyParser {
public:
  NpyParser(const Bytes &data, std::string where) : data_(data), where_(std::move(where)) {}

  NpyArray parse() {
    const std::string header = read_header();
    NpyArray array;
    array.type = parse_type(header);
    array.shape = parse_shape(header);
    const auto fortran = header_value(header, "fortran_order");
    if (!fortran)
      fail("the header does not say in which order the elements are");
    read_elements(array);
    if (fortran->rfind("False", 0) != 0 && array.shape.size() > 1) {
      if (!numeric(array.type))
        fail("expected C order, found text in Fortran order (save numpy.ascontiguousarray(...))");
      to_c_order(array);
    }
    return array;
  }

private:
  [[noreturn]] void fail(const std::string &what) const { throw Error(where_ + ": " + what); }

  std::string read_header() {
    if (data_.size() < 10 || std::memcmp(data_.data(), "\x93NUMPY", 6) != 0)
      fail("expected a NumPy array, found other data");
    const bool long_length = data_[6] >= 2;
    std::uint32_t length = data_[8] | data_[9] << 8;
    offset_ = 10;
    if (long_length) {
      if (data_.size() < 12)
        fail("the header is truncated");
      std::memcpy(&length, data_.data() + 8, 4);
      offset_ = 12;
    }
    if (data_.size() - offset_ < length)
      fail("the header is truncated");
    const std::string header(data_.begin() + offset_, data_.begin() + offset_ + length);
    offset_ += length;
    return header;
  }

  std::string parse_type(const std::string &header) const {
    const auto value = header_value(header, "descr");
    if (!value || value->empty() || (*value)[0] != '\'')
      fail("expected a plain element type, found a structured one");
    const std::string descr = value->substr(1, value->find('\'', 1) - 1);
    if (descr.find('O') != std::string::npos)
      fail("expected numbers or text, found Python objects");
    if (!descr.empty() && descr[0] == '>')
      fail("expected little-endian data, found type '" + descr + "'");
    const std::string type = descr.empty() ? descr : descr.substr(std::strchr("<|=", descr[0]) ? 1 : 0);
    static const std::vector<std::string> known = {"f4", "f8", "i1", "u1", "b1", "i2", "u2", "i4", "u4", "i8", "u8"};
    const bool text =
        type.size() > 1 && type.size() < 9 && type[0] == 'U' && type.find_first_not_of("0123456789", 1) == std::string::npos;
    if (!text && std::find(known.begin(), known.end(), type) == known.end())
      fail("expected 4- or 8-byte floats, integers, bools or text, found type '" + descr + "'");
    return type;
  }

  Shape parse_shape(const std::string &header) const {
    const auto value = header_value(header, "shape");
    if (!value || (*value)[0] != '(' || value->find(')') == std::string::npos)
      fail("the header has no shape");
    Shape shape;
    const std::string inside = value->substr(1, value->find(')') - 1);
    for (std::size_t i = 0; i < inside.size();) {
      const std::size_t end = std::min(inside.find(',', i), inside.size());
      std::string number = inside.substr(i, end - i);
      number.erase(std::remove(number.begin(), number.end(), ' '), number.end());
      i = end + 1;
      if (number.empty())
        continue;
      if (number.size() > 15 || number.find_first_not_of("0123456789") != std::string::npos)
        fail("the header's shape (" + inside + ") is no list of sizes");
      shape.push_back(std::stoll(number));
    }
    return shape;
  }

  static void to_c_order(NpyArray &array) {
    const Bytes fortran = array.bytes;
    const std::int64_t each = item_size(array.type), count = array.size();
    std::vector<std::int64_t> index(array.shape.size(), 0);
    for (std::int64_t to = 0; to < count; ++to) {
      std::int64_t from = 0;
      for (std::size_t axis = index.size(); axis-- > 0;)
        from = from * array.shape[axis] + index[axis];
      std::copy_n(fortran.begin() + from * each, each, array.bytes.begin() + to * each);
      for (std::size_t axis = index.size(); axis-- > 0 && ++index[axis] == array.shape[axis];)
        index[axis] = 0;
    }
  }

  void read_elements(NpyArray &array) const {
    const auto count = element_count(array.shape);
    const std::int64_t have = static_cast<std::int64_t>(data_.size() - offset_), each = item_size(array.type);
    if (!count || (each > 0 && *count > have / each))
      fail("expected elements for shape " + to_string(array.shape) + ", found " + std::to_string(have) + " bytes");
    const std::uint8_t *begin = data_.data() + offset_;
    if (numeric(array.type)) {
      array.bytes.assign(begin, begin + *count * each);
      return;
    }
    if (*count > have && each == 0)
      fail("expected text for shape " + to_string(array.shape) + ", found none");
    for (std::int64_t i = 0; i < *count; ++i)
      array.strings.push_back(utf8_from_utf32(begin + i * each, each / 4));
  }

  const Bytes &data_;
  std::string where_;
  std::size_t offset_ = 0;
};

std::string zip_message(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string message = zip_error_strerror(&error);
  zip_error_fini(&error);
  return message;
}

using Zip = std::unique_ptr<zip_t, decltype(&zip_discard)>;
using ZipFile = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

Zip open_zip(const std::filesystem::path &path) {
  int code = 0;
  zip_t *zip = zip_open(path.c_str(), ZIP_RDONLY, &code);
  if (!zip)
    throw Error(path.string() + ": expected an .npz archive, found none that can be opened (truncated?): " + zip_message(code));
  return Zip(zip, &zip_discard);
}

/// Unpacks one member piece by piece: the size written in the archive is not to be trusted with an allocation. `room`: bytes that
/// all members together may still have; many can name the same packed bytes.
Bytes unpack(zip_t *zip, zip_uint64_t index, std::uint64_t &room, const std::string &where) {
  const ZipFile file(zip_fopen_index(zip, index, 0), &zip_fclose);
  if (!file)
    throw Error(where + ": cannot be unpacked: " + zip_strerror(zip));
  zip_stat_t stated;
  zip_stat_init(&stated);
  zip_stat_index(zip, index, 0, &stated);
  const auto require_filled = [&](std::uint64_t size) {
    if (size > kAnyway + kUsualExpansion * stated.comp_size)
      throw Error(where + ": expected numbers that fill the array, found more than " + std::to_string(size >> 20) +
                  " MiB out of " + std::to_string(stated.comp_size) + " bytes");
  };
  require_filled(stated.size); // before any memory is taken
  const auto piece = static_cast<std::size_t>(std::clamp<zip_uint64_t>(stated.size, 1 << 10, (1 << 20) - 1) + 1);
  Bytes data;
  for (;;) {
    const std::size_t filled = data.size();
    data.resize(filled + piece);
    const zip_int64_t n = zip_fread(file.get(), data.data() + filled, piece);
    if (n < 0)
      throw Error(where + ": the data is damaged or truncated: " + zip_file_strerror(file.get()));
    data.resize(filled + static_cast<std::size_t>(n));
    if (static_cast<std::uint64_t>(n) > room)
      throw Error(where + ": expected no more than deflate can pack into a file of this size, found more");
    room -= static_cast<std::uint64_t>(n);
    require_filled(data.size());
    if (n == 0)
      return data;
  }
}

// --- conversion

template <class T, class Out> void append(const NpyArray &array, std::vector<Out> &out) {
  out.reserve(array.bytes.size() / sizeof(T));
  for (std::size_t i = 0; i + sizeof(T) <= array.bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, array.bytes.data() + i, sizeof(T));
    out.push_back(static_cast<Out>(value));
  }
}

template <class Out> std::vector<Out> converted(const NpyArray &array) {
  std::vector<Out> out;
  const std::string &t = array.type;
  // clang-format off
  if (t == "f4") append<float>(array, out);
  else if (t == "f8") append<double>(array, out);
  else if (t == "i1") append<std::int8_t>(array, out);
  else if (t == "u1" || t == "b1") append<std::uint8_t>(array, out);
  else if (t == "i2") append<std::int16_t>(array, out);
  else if (t == "u2") append<std::uint16_t>(array, out);
  else if (t == "i4") append<std::int32_t>(array, out);
  else if (t == "u4") append<std::uint32_t>(array, out);
  else if (t == "i8") append<std::int64_t>(array, out);
  else if (t == "u8") append<std::uint64_t>(array, out);
  // clang-format on
  return out;
}

const NpyArray &find(const Npz &npz, const std::string &name) {
  const auto it = npz.arrays.find(name);
  if (it != npz.arrays.end())
    return it->second;
  std::string there;
  for (const auto &[key, array] : npz.arrays)
    there += (there.empty() ? "" : ", ") + key;
  throw Error(npz.source + ": expected an array '" + name + "', found only: " + (there.empty() ? "nothing" : there));
}

const NpyArray &find_of_kind(const Npz &npz, const std::string &name, bool (*kind)(const std::string &), const char *expected) {
  const NpyArray &array = find(npz, name);
  if (!kind(array.type))
    throw Error(npz.source + ": array '" + name + "': expected " + expected + ", found type '" + array.type + "'");
  return array;
}

// --- writing

template <class T, class In>
NpyArray make_array(const std::string &name, const char *type, const Shape &shape, const std::vector<In> &values) {
  const auto count = element_count(shape);
  if (!count || *count != static_cast<std::int64_t>(values.size()))
    throw std::invalid_argument("Npz: array '" + name + "': " + std::to_string(values.size()) + " values do not fill shape " +
                                to_string(shape));
  NpyArray array{type, shape, Bytes(values.size() * sizeof(T)), {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T value = static_cast<T>(values[i]);
    std::memcpy(array.bytes.data() + i * sizeof(T), &value, sizeof(T));
  }
  return array;
}

Bytes npy_member(const NpyArray &array) {
  const std::string order = item_size(array.type) == 1 ? "|" : "<";
  std::string header =
      "{'descr': '" + order + array.type + "', 'fortran_order': False, 'shape': " + to_string(array.shape) + ", }";
  header.append(63 - (10 + header.size()) % 64, ' '); // data starts at a multiple of 64
  header += '\n';
  const std::string start = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size() & 0xFF) +
                            static_cast<char>(header.size() >> 8) + header;
  Bytes out(start.begin(), start.end());
  out.insert(out.end(), array.bytes.begin(), array.bytes.end());
  const std::int64_t width = item_size(array.type) / 4;
  for (const std::string &s : array.strings) {
    std::vector<std::uint32_t> text = utf32_from_utf8(s);
    text.resize(width, 0);
    const auto *raw = reinterpret_cast<const std::uint8_t *>(text.data());
    out.insert(out.end(), raw, raw + 4 * text.size());
  }
  return out;
}

/// `path`: for messages, `temporary`: where to.
void write_zip(const std::filesystem::path &temporary, const std::filesystem::path &path,
               const std::map<std::string, Bytes> &members) {
  int code = 0;
  Zip zip(zip_open(temporary.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code), &zip_discard);
  if (!zip)
    throw Error(path.string() + ": cannot be written: " + zip_message(code));
  for (const auto &[name, data] : members) {
    zip_source_t *source = zip_source_buffer(zip.get(), data.data(), data.size(), 0);
    const zip_int64_t index = source ? zip_file_add(zip.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8) : -1;
    if (index < 0) {
      zip_source_free(source);
      throw Error(path.string() + ": cannot add '" + name + "': " + zip_strerror(zip.get()));
    }
    zip_set_file_compression(zip.get(), index, ZIP_CM_DEFLATE, 6);
    zip_file_set_dostime(zip.get(), index, 0, 0x21, 0); // always 1980-01-01: the same arrays make the same file
  }
  if (zip_close(zip.get()) < 0)
    throw Error(path.string() + ": cannot be written: " + zip_strerror(zip.get()));
  zip.release();
}

} // namespace

std::int64_t NpyArray::size() const {
  return element_count(shape).value_or(0);
}

Npz Npz::read(const std::filesystem::path &path, const std::vector<std::string> &wanted, int newest_format) {
  if (!std::filesystem::exists(path))
    throw FileNotFound(path.string() + ": no such file");
  if (!std::filesystem::is_regular_file(path))
    throw Error(path.string() + ": expected a file, found a folder, device or pipe");
  const Zip zip = open_zip(path);
  Npz npz;
  npz.source = path.string();
  std::uint64_t room = kMostExpansion * std::filesystem::file_size(path);
  const zip_int64_t count = zip_get_num_entries(zip.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char *raw = zip_get_name(zip.get(), i, 0);
    std::string name = raw ? raw : "";
    if (!name.ends_with(".npy"))
      throw Error(npz.source + ": expected only .npy members, found '" + name + "'");
    name.resize(name.size() - 4);
    const bool is_wanted = wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    if (!is_wanted && name != kFormatName)
      continue;
    const std::string where = npz.source + ": array '" + name + "'";
    npz.arrays[name] = NpyParser(unpack(zip.get(), i, room, where), where).parse();
  }
  if (newest_format < INT_MAX && npz.has(kFormatName)) {
    npz.require_shape(kFormatName, {1});
    require_format(npz.integers(kFormatName)[0], newest_format, npz.source);
  }
  return npz;
}

void Npz::write(const std::filesystem::path &path, int format) const {
  std::map<std::string, Bytes> members;
  if (format > 0) {
    Npz number;
    number.set_i4(kFormatName, {1}, {format});
    members[std::string(kFormatName) + ".npy"] = npy_member(number.arrays.at(kFormatName));
  }
  for (const auto &[name, array] : arrays)
    members[name + ".npy"] = npy_member(array);
  write_atomically(path, [&](const std::filesystem::path &temporary) { write_zip(temporary, path, members); });
}

std::vector<double> Npz::values(const std::string &name) const {
  return converted<double>(find_of_kind(*this, name, numeric, "numbers"));
}

MatrixRM Npz::matrix(const std::string &name) const {
  const Shape found = shape(name);
  if (found.empty() || found.size() > 2)
    throw Error(source + ": array '" + name + "': expected one or two dimensions, found shape " + to_string(found));
  const std::vector<double> flat = values(name);
  return Eigen::Map<const MatrixRM>(flat.data(), found[0], found.size() == 2 ? found[1] : 1);
}

std::vector<int> Npz::integers(const std::string &name) const {
  const NpyArray &array = find_of_kind(*this, name, integer, "integers");
  if (array.type == "u8" || array.type == "u4") {
    for (const std::uint64_t v : converted<std::uint64_t>(array))
      if (v > INT_MAX)
        throw Error(source + ": array '" + name + "': expected 32-bit integers, found " + std::to_string(v));
  }
  const std::vector<std::int64_t> wide = converted<std::int64_t>(array);
  for (const std::int64_t v : wide)
    if (v < INT_MIN || v > INT_MAX)
      throw Error(source + ": array '" + name + "': expected 32-bit integers, found " + std::to_string(v));
  return {wide.begin(), wide.end()};
}

std::vector<std::string> Npz::text(const std::string &name) const {
  return find_of_kind(
             *this, name, [](const std::string &type) { return !numeric(type); }, "text")
      .strings;
}

std::vector<std::int64_t> Npz::shape(const std::string &name) const {
  return find(*this, name).shape;
}

void Npz::reject(const std::string &what) const {
  throw Error(source + ": " + what);
}

void Npz::require_shape(const std::string &name, const std::vector<std::int64_t> &expected) const {
  const Shape found = shape(name);
  bool same = found.size() == expected.size();
  for (std::size_t i = 0; same && i < found.size(); ++i)
    same = expected[i] < 0 || expected[i] == found[i];
  if (!same)
    throw Error(source + ": array '" + name + "': expected shape " + to_string(expected) + ", found " + to_string(found));
}

void Npz::set_f4(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<double> &values) {
  arrays[name] = make_array<float>(name, "f4", shape, values);
}

void Npz::set_f8(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<double> &values) {
  arrays[name] = make_array<double>(name, "f8", shape, values);
}

void Npz::set_i4(const std::string &name, const std::vector<std::int64_t> &shape, const std::vector<int> &values) {
  arrays[name] = make_array<std::int32_t>(name, "i4", shape, values);
}

void Npz::set_b1(const std::string &name, const std::vector<std::uint8_t> &values) {
  std::vector<bool> bits(values.begin(), values.end());
  arrays[name] = make_array<std::uint8_t>(name, "b1", {static_cast<std::int64_t>(values.size())},
                                          std::vector<int>(bits.begin(), bits.end()));
}

void Npz::set_text(const std::string &name, const std::vector<std::string> &values) {
  std::size_t longest = 1; // NumPy has no text of width zero
  for (const std::string &s : values)
    longest = std::max(longest, utf32_from_utf8(s).size());
  arrays[name] = {std::string("U").append(std::to_string(longest)), {static_cast<std::int64_t>(values.size())}, {}, values};
}

} // namespace doublet
