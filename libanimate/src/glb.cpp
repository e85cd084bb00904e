#include "glb.h"

#include "doublet/core/error.h"
#include "doublet/core/files.h"

#include <cstring>
#include <fstream>

namespace doublet::glb {
namespace {

constexpr int kMaxFileBytes = 1 << 30;

int components(int type) {
  return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
}

/// Images are kept as the file they are.
bool keep_image(tinygltf::Image *image, const int, std::string *, std::string *, int, int, const unsigned char *bytes, int size,
                void *) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
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

void Writer::save(const std::filesystem::path &path) {
  write_atomically(path, [&](const std::filesystem::path &temporary) {
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToFile(&model, temporary.string(), true, true, false, true))
      throw Error(path.string() + ": cannot be written");
  });
}

Reader::Reader(const std::filesystem::path &path) : source_(path.string()) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file)
    throw FileNotFound(source_ + ": no such file");
  const auto size = static_cast<long long>(file.tellg());
  if (size < 20 || size > kMaxFileBytes)
    fail("expected a GLB of 20 bytes to 1 GiB, found " + std::to_string(size) + " bytes");
  std::vector<unsigned char> content(static_cast<std::size_t>(size));
  file.seekg(0);
  file.read(reinterpret_cast<char *>(content.data()), size);
  if (!file || std::memcmp(content.data(), "glTF", 4) != 0)
    fail("expected a binary glTF 2.0 file");
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_image, nullptr);
  loader.SetStoreOriginalJSONForExtrasAndExtensions(true);
  std::string error, warning;
  bool loaded = false;
  try {
    loaded = loader.LoadBinaryFromMemory(&model_, &error, &warning, content.data(), static_cast<unsigned>(size));
  } catch (const std::exception &problem) {
    error = problem.what();
  }
  if (!loaded)
    fail("expected a binary glTF 2.0 file, found: " + error.substr(0, error.find('\n')));
}

void Reader::fail(const std::string &what) const {
  throw Error(source_ + ": " + what);
}

template <class T> std::vector<T> Reader::read(int accessor, int component) const {
  const auto in = [](int i, std::size_t n) { return i >= 0 && static_cast<std::size_t>(i) < n; };
  if (!in(accessor, model_.accessors.size()) || !in(model_.accessors[accessor].bufferView, model_.bufferViews.size()))
    fail("expected an accessor with data, found index " + std::to_string(accessor));
  const tinygltf::Accessor &a = model_.accessors[accessor];
  const tinygltf::BufferView &v = model_.bufferViews[a.bufferView];
  const int n = components(a.type);
  if (a.componentType != component || n <= 0 || v.byteStride != 0 || !in(v.buffer, model_.buffers.size()))
    fail("expected accessor " + std::to_string(accessor) + " to hold tightly packed values of component type " +
         std::to_string(component) + ", found " + std::to_string(a.componentType));
  const std::vector<unsigned char> &data = model_.buffers[v.buffer].data;
  if (a.count > data.size())
    fail("accessor " + std::to_string(accessor) + " reaches beyond its buffer");
  const std::size_t bytes = a.count * static_cast<std::size_t>(n) * sizeof(T);
  if (v.byteOffset > data.size() || v.byteLength > data.size() - v.byteOffset || a.byteOffset > v.byteLength ||
      bytes > v.byteLength - a.byteOffset)
    fail("accessor " + std::to_string(accessor) + " reaches beyond its buffer");
  std::vector<T> values(a.count * n);
  if (bytes > 0)
    std::memcpy(values.data(), data.data() + v.byteOffset + a.byteOffset, bytes);
  return values;
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

std::vector<std::uint8_t> Reader::image(int index) const {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.images.size())
    fail("expected an image, found index " + std::to_string(index));
  return model_.images[index].image;
}

} // namespace doublet::glb
