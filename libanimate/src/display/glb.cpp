#include "glb.h"

#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace doublet::glb {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxFileBytes = 1 << 30;
// glTF 2.0, sect. 4.4: magic, version, length; then chunks of length, type, data.
constexpr std::size_t kHeaderBytes = 12, kChunkBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

/// Bytes of a component; 0 = there is no such type.
std::size_t bytes_of(int component) {
  switch (component) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return 1;
  case TINYGLTF_COMPONENT_TYPE_SHORT:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return 2;
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
  case TINYGLTF_COMPONENT_TYPE_FLOAT:
    return 4;
  default:
    return 0;
  }
}

template <class T> float number_at(const char *bytes, bool normalised) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  if (!normalised || !std::numeric_limits<T>::is_integer)
    return static_cast<float>(value);
  return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float number_at(const char *bytes, int component, bool normalised) {
  switch (component) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return number_at<std::int8_t>(bytes, normalised);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return number_at<std::uint8_t>(bytes, normalised);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return number_at<std::int16_t>(bytes, normalised);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return number_at<std::uint16_t>(bytes, normalised);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    return number_at<std::uint32_t>(bytes, normalised);
  default:
    return number_at<float>(bytes, normalised);
  }
}

int components(int type) {
  return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
}

} // namespace

Writer::Writer() {
  model.asset.version = "2.0";
  model.asset.generator = "doublet";
  model.buffers.resize(1);
}

int Writer::view(const void *data, std::size_t bytes, Use use) {
  std::vector<unsigned char> &buffer = model.buffers[0].data;
  buffer.resize((buffer.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = bytes;
  view.target = use == Use::Vertices  ? TINYGLTF_TARGET_ARRAY_BUFFER
                : use == Use::Indices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER
                                      : 0;
  buffer.resize(buffer.size() + bytes);
  std::memcpy(buffer.data() + view.byteOffset, data, bytes);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int Writer::accessor(int view, int component, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

int Writer::floats(const std::vector<float> &values, int type, Use use, bool with_bounds) {
  const int n = components(type);
  const int index =
      accessor(view(values.data(), values.size() * sizeof(float), use), TINYGLTF_COMPONENT_TYPE_FLOAT, type, values.size() / n);
  if (with_bounds) {
    tinygltf::Accessor &a = model.accessors[index];
    a.minValues.assign(values.begin(), values.begin() + n);
    a.maxValues = a.minValues;
    for (std::size_t i = 0; i < values.size(); ++i) {
      a.minValues[i % n] = std::min<double>(a.minValues[i % n], values[i]);
      a.maxValues[i % n] = std::max<double>(a.maxValues[i % n], values[i]);
    }
  }
  return index;
}

int Writer::vectors(const Vertices &rows, Use use, bool with_bounds) {
  return floats(std::vector<float>(rows.data(), rows.data() + rows.size()), TINYGLTF_TYPE_VEC3, use, with_bounds);
}

int Writer::matrix(const MatrixRM &values) {
  return floats(std::vector<float>(values.data(), values.data() + values.size()), TINYGLTF_TYPE_SCALAR, Use::Data);
}

int Writer::bytes(const std::vector<std::uint8_t> &values, int type, Use use) {
  return accessor(view(values.data(), values.size(), use), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, type,
                  values.size() / components(type));
}

int Writer::shorts(const std::vector<std::uint16_t> &values, int type, Use use) {
  return accessor(view(values.data(), values.size() * 2, use), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, type,
                  values.size() / components(type));
}

int Writer::integers(const std::vector<std::uint32_t> &values, Use use) {
  return accessor(view(values.data(), values.size() * 4, use), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                  values.size());
}

int Writer::faces(const Faces &faces, Use use) {
  return integers(std::vector<std::uint32_t>(faces.data(), faces.data() + faces.size()), use);
}

int Writer::image(const std::vector<std::uint8_t> &file) {
  tinygltf::Image image;
  image.bufferView = view(file.data(), file.size(), Use::Data);
  image.mimeType = file.size() > 1 && file[0] == 0xFF ? "image/jpeg" : "image/png";
  model.images.push_back(image);
  return static_cast<int>(model.images.size()) - 1;
}

Writer::SparseRows Writer::sparse_rows(const std::vector<int> &rows, std::size_t count) {
  if (count <= std::numeric_limits<std::uint16_t>::max()) {
    const std::vector<std::uint16_t> small(rows.begin(), rows.end());
    return {view(small.data(), small.size() * 2, Use::Data), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, rows.size(), count};
  }
  return {view(rows.data(), rows.size() * 4, Use::Data), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, rows.size(), count};
}

template <class T> int Writer::sparse(const SparseRows &rows, const std::vector<T> &values, int component, bool normalised) {
  tinygltf::Accessor a;
  a.componentType = component;
  a.normalized = normalised;
  a.type = TINYGLTF_TYPE_VEC3;
  a.count = rows.count;
  a.sparse.isSparse = true;
  a.sparse.count = static_cast<int>(rows.rows);
  a.sparse.indices.bufferView = rows.view;
  a.sparse.indices.byteOffset = 0;
  a.sparse.indices.componentType = rows.component;
  a.sparse.values.bufferView = view(values.data(), values.size() * sizeof(T), Use::Data);
  a.sparse.values.byteOffset = 0;
  const bool some_are_zero = rows.rows < rows.count;
  a.minValues.assign(3, some_are_zero ? 0.0 : std::numeric_limits<double>::max());
  a.maxValues.assign(3, some_are_zero ? 0.0 : std::numeric_limits<double>::lowest());
  for (std::size_t i = 0; i < values.size(); ++i) {
    a.minValues[i % 3] = std::min<double>(a.minValues[i % 3], values[i]);
    a.maxValues[i % 3] = std::max<double>(a.maxValues[i % 3], values[i]);
  }
  model.accessors.push_back(a);
  return static_cast<int>(model.accessors.size()) - 1;
}

int Writer::sparse_vectors(const SparseRows &rows, const std::vector<std::int8_t> &values, bool normalised) {
  return sparse(rows, values, TINYGLTF_COMPONENT_TYPE_BYTE, normalised);
}

int Writer::sparse_vectors(const SparseRows &rows, const std::vector<std::int16_t> &values) {
  return sparse(rows, values, TINYGLTF_COMPONENT_TYPE_SHORT, false);
}

void Writer::save(const std::filesystem::path &path) {
  write_stream(path, [&](std::ostream &out) {
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, out, false, true))
      throw Error(path.string() + ": cannot be written");
  });
}

Reader::Reader(const std::filesystem::path &path) : source_(path.string()), content_(read_text(path)) {
  if (content_.size() < kHeaderBytes + 2 * kChunkBytes || content_.size() > kMaxFileBytes)
    fail("expected a GLB of " + std::to_string(kHeaderBytes + 2 * kChunkBytes) + " bytes to 1 GiB, found " +
         std::to_string(content_.size()) + " bytes");
  if (content_.compare(0, 4, "glTF") != 0 || word(4) != 2)
    fail("expected a binary glTF 2.0 file, found another one");
  if (word(8) > content_.size())
    fail("expected " + std::to_string(word(8)) + " bytes as its header says, found " + std::to_string(content_.size()) +
         " (truncated?)");
  content_.resize(std::max<std::size_t>(word(8), kHeaderBytes + 2 * kChunkBytes)); // what stands behind is of others
  const std::string_view text = chunk(kHeaderBytes, kJsonChunk, "JSON");
  binary_ = chunk(kHeaderBytes + kChunkBytes + text.size(), kBinaryChunk, "binary");
  require_shallow_json(text, source_);
  try {
    gltf_ = json::parse(text);
    for (const json &buffer : gltf_.value("buffers", json::array()))
      refuse_outside("buffers", buffer);
  } catch (const json::exception &problem) {
    fail(std::string("expected a binary glTF 2.0 file, found: ") + problem.what());
  }
}

void Reader::fail(const std::string &what) const {
  throw Error(source_ + ": " + what);
}

std::uint32_t Reader::word(std::size_t at) const {
  std::uint32_t value;
  std::memcpy(&value, content_.data() + at, sizeof value);
  return value;
}

std::string_view Reader::chunk(std::size_t at, std::uint32_t type, const char *name) const {
  if (content_.size() - at < kChunkBytes || word(at + 4) != type || word(at) > content_.size() - at - kChunkBytes)
    fail(std::string("expected a ") + name + " chunk at byte " + std::to_string(at) + ", found none that ends inside the file");
  return std::string_view(content_).substr(at + kChunkBytes, word(at));
}

void Reader::refuse_outside(const char *list, const json &entry) const {
  if (entry.contains("uri"))
    fail(std::string("expected all data inside the file, found ") + list + " with the URI " +
         entry.at("uri").dump(-1, ' ', true).substr(0, 60));
}

const json &Reader::entry(const char *list, const json &index) const {
  const json &entries = gltf_.at(list);
  const auto i = index.is_number_integer() ? index.get<std::int64_t>() : -1;
  if (!entries.is_array() || i < 0 || i >= static_cast<std::int64_t>(entries.size()))
    fail(std::string("expected one of the ") + std::to_string(entries.size()) + " " + list + ", found number " + index.dump());
  return entries[static_cast<std::size_t>(i)];
}

std::size_t Reader::size(const json &object, const char *key) const {
  const json value = object.value(key, json(std::size_t{0}));
  if (!value.is_number_unsigned() || value.get<std::size_t>() > content_.size())
    fail(std::string("expected ") + key + " to be a number of at most " + std::to_string(content_.size()) + ", found " +
         value.dump().substr(0, 60));
  return value.get<std::size_t>();
}

std::string_view Reader::view(const json &index) const {
  const json &view = entry("bufferViews", index);
  const std::size_t offset = size(view, "byteOffset"), length = size(view, "byteLength");
  if (size(view, "buffer") != 0 || view.contains("byteStride") || offset > binary_.size() || length > binary_.size() - offset)
    fail("buffer view " + index.dump() + " reaches beyond the binary chunk, or is not tightly packed");
  return binary_.substr(offset, length);
}

template <class T> std::vector<T> Reader::read(int accessor, int component) const try {
  const json &a = entry("accessors", accessor);
  const std::string_view bytes = view(a.at("bufferView"));
  const std::string type = a.at("type").get<std::string>();
  const std::size_t n = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
  if (a.at("componentType") != component || n == 0 || a.contains("sparse"))
    fail("expected accessor " + std::to_string(accessor) + " to hold plain values of component type " +
         std::to_string(component) + ", found " + a.at("componentType").dump() + " " + type);
  const std::size_t count = size(a, "count") * n, offset = size(a, "byteOffset");
  if (offset > bytes.size() || count > (bytes.size() - offset) / sizeof(T))
    fail("accessor " + std::to_string(accessor) + " reaches beyond its buffer view");
  std::vector<T> values(count);
  if (count > 0)
    std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T));
  return values;
} catch (const json::exception &problem) {
  fail("accessor " + std::to_string(accessor) + " is malformed: " + problem.what());
}

Reader::Rows Reader::rows_of(const json &accessor) const {
  const std::string type = accessor.at("type").get<std::string>();
  const std::size_t width = type == "SCALAR" ? 1
                            : type == "VEC2" ? 2
                            : type == "VEC3" ? 3
                            : type == "VEC4" ? 4
                            : type == "MAT4" ? 16
                                             : 0;
  const int component = accessor.at("componentType").get<int>();
  if (width == 0 || bytes_of(component) == 0)
    fail("expected an accessor of numbers, vectors or 4 x 4 matrices, found component type " + std::to_string(component) +
         " and " + type);
  return {component, size(accessor, "count"), width, size(accessor, "byteOffset"), accessor.value("normalized", false)};
}

std::string_view Reader::strided(const json &index, std::size_t &stride) const {
  const json &view = entry("bufferViews", index);
  const json extensions = view.value("extensions", json::object());
  for (const char *name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (size(view, "buffer") != 0 && extensions.contains(name)) // the buffer is what a reader of the extension fills
      fail(std::string("expected uncompressed numbers, found ones that need the extension ") + name);
  const std::size_t offset = size(view, "byteOffset"), length = size(view, "byteLength");
  if (size(view, "buffer") != 0 || offset > binary_.size() || length > binary_.size() - offset)
    fail("buffer view " + index.dump() + " reaches beyond the binary chunk");
  if (view.contains("byteStride"))
    stride = size(view, "byteStride");
  return binary_.substr(offset, length);
}

std::vector<float> Reader::gather(const json &view, const Rows &rows) const {
  const std::size_t each = bytes_of(rows.component), row = each * rows.width;
  if (row == 0)
    fail("expected a component type of glTF, found " + std::to_string(rows.component));
  std::size_t stride = row;
  const std::string_view bytes = strided(view, stride);
  if (stride < row || rows.offset > bytes.size() ||
      (rows.count > 0 && (bytes.size() - rows.offset < row || (rows.count - 1) > (bytes.size() - rows.offset - row) / stride)))
    fail("an accessor of " + std::to_string(rows.count) + " rows reaches beyond its buffer view " + view.dump());
  std::vector<float> values;
  values.reserve(rows.count * rows.width);
  for (std::size_t i = 0; i < rows.count; ++i)
    for (std::size_t k = 0; k < rows.width; ++k)
      values.push_back(number_at(bytes.data() + rows.offset + i * stride + k * each, rows.component, rows.normalised));
  return values;
}

std::vector<float> Reader::numbers(int accessor) const try {
  const json &a = entry("accessors", accessor);
  const Rows rows = rows_of(a);
  std::vector<float> values =
      a.contains("bufferView") ? gather(a.at("bufferView"), rows) : std::vector<float>(rows.count * rows.width, 0.0f);
  if (!a.contains("sparse"))
    return values;
  const json &sparse = a.at("sparse"), &where = sparse.at("indices"), &what = sparse.at("values");
  const std::size_t count = size(sparse, "count");
  const std::vector<float> at =
      gather(where.at("bufferView"), {where.at("componentType").get<int>(), count, 1, size(where, "byteOffset"), false});
  const std::vector<float> put =
      gather(what.at("bufferView"), {rows.component, count, rows.width, size(what, "byteOffset"), rows.normalised});
  for (std::size_t i = 0; i < count; ++i) {
    if (!(at[i] >= 0 && at[i] < static_cast<float>(rows.count)))
      fail("accessor " + std::to_string(accessor) + " puts values at a row that it does not have");
    std::copy_n(put.begin() + static_cast<std::ptrdiff_t>(i * rows.width), rows.width,
                values.begin() + static_cast<std::ptrdiff_t>(at[i]) * static_cast<std::ptrdiff_t>(rows.width));
  }
  return values;
} catch (const json::exception &problem) {
  fail("accessor " + std::to_string(accessor) + " is malformed: " + problem.what());
}

std::vector<float> Reader::floats(int accessor) const {
  return read<float>(accessor, TINYGLTF_COMPONENT_TYPE_FLOAT);
}

std::vector<std::uint8_t> Reader::bytes(int accessor) const {
  return read<std::uint8_t>(accessor, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE);
}

std::vector<std::uint32_t> Reader::integers(int accessor) const {
  return read<std::uint32_t>(accessor, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
}

Vertices Reader::vectors(int accessor) const {
  const std::vector<float> values = floats(accessor);
  if (values.size() % 3 != 0)
    fail("expected accessor " + std::to_string(accessor) + " to hold vectors of 3");
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(values.data(), values.size() / 3, 3)
      .cast<double>();
}

MatrixRM Reader::matrix(int accessor, Eigen::Index columns) const {
  const std::vector<float> values = floats(accessor);
  if (columns <= 0 || values.size() % columns != 0)
    fail("expected accessor " + std::to_string(accessor) + " to hold rows of " + std::to_string(columns) + ", found " +
         std::to_string(values.size()) + " values");
  using Floats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Floats>(values.data(), values.size() / columns, columns).cast<double>();
}

Faces Reader::faces(int accessor) const {
  const std::vector<std::uint32_t> values = integers(accessor);
  if (values.size() % 3 != 0)
    fail("expected accessor " + std::to_string(accessor) + " to hold triangles");
  Faces faces(values.size() / 3, 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] > 0x7FFFFFFF)
      fail("accessor " + std::to_string(accessor) + " holds a vertex index of " + std::to_string(values[i]));
    faces.data()[i] = static_cast<int>(values[i]);
  }
  return faces;
}

std::vector<std::uint8_t> Reader::image(int index) const try {
  const json &image = entry("images", index);
  refuse_outside("images", image);
  const std::string_view bytes = view(image.at("bufferView"));
  return {bytes.begin(), bytes.end()};
} catch (const json::exception &problem) {
  fail("image " + std::to_string(index) + " is malformed: " + problem.what());
}

} // namespace doublet::glb
