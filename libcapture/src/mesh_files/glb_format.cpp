// Binary glTF 2.0 as a scan: triangles of the meshes that the scene's nodes show, in their places. The only file here that
// includes TinyGLTF, which parses the file; of what it says about bytes nothing is believed.

#include "doublet/files/files.h"
#include "doublet/options/options.h"
#include "mesh_formats.h"
#include "mesh_parsing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <tiny_gltf.h>
#include <tuple>

namespace doublet::detail {
namespace {

using Eigen::Affine3d;

constexpr std::size_t kMostMeshBytes = 1 << 30, kMostMeshVertices = 50'000'000; // vertices: nodes may show one mesh many times
constexpr std::size_t kGlbHeader = 20;                                          // bytes: file's, and length and type of the JSON

class Scene {
public:
  Scene(const std::string &data, const std::string &source) : source_(source) {
    std::uint32_t length = 0, text = 0;
    if (data.size() < kGlbHeader || data.compare(0, 4, "glTF") != 0 || data.size() > kMostMeshBytes)
      fail("expected a binary glTF 2.0 file of at most 1 GiB, found another one");
    std::memcpy(&length, data.data() + 8, sizeof length);
    std::memcpy(&text, data.data() + 12, sizeof text);
    if (length > data.size() || text > data.size() - kGlbHeader)
      fail("expected " + std::to_string(length) + " bytes as its header says, found " + std::to_string(data.size()) +
           " (truncated?)");
    require_shallow_json(std::string_view(data).substr(kGlbHeader, text), source);
    load(data, length); // what stands behind is of others
  }

  Mesh mesh() {
    std::vector<bool> seen(model_.nodes.size(), false);
    for (int root : roots())
      show(root, seen);
    return growing_.mesh(source_);
  }

private:
  [[noreturn]] void fail(const std::string &what) const { throw Error(source_ + ": " + what); }

  void load(const std::string &data, std::uint32_t length) {
    tinygltf::TinyGLTF loader;
    // Pictures do not matter, and no other file is ever looked at.
    loader.SetImageLoader([](tinygltf::Image *, const int, std::string *, std::string *, int, int, const unsigned char *, int,
                             void *) { return true; },
                          nullptr);
    loader.SetFsCallbacks(
        {[](const std::string &, void *) { return false; }, [](const std::string &path, void *) { return path; },
         [](std::vector<unsigned char> *, std::string *, const std::string &, void *) { return false; },
         [](std::string *, const std::string &, const std::vector<unsigned char> &, void *) { return false; }, nullptr});
    std::string problem, remark;
    bool read = false;
    try {
      read = loader.LoadBinaryFromMemory(&model_, &problem, &remark, reinterpret_cast<const unsigned char *>(data.data()), length,
                                         "");
    } catch (const std::exception &error) {
      problem = error.what();
    }
    if (!read)
      fail("expected a binary glTF 2.0 file without other files, found: " + problem.substr(0, problem.find('\n')));
    for (const std::string &extension : model_.extensionsRequired)
      if (extension != "KHR_mesh_quantization" && !extension.starts_with("KHR_materials") &&
          !extension.starts_with("KHR_texture") && !extension.starts_with("EXT_texture"))
        fail("expected uncompressed meshes, found ones that need the extension " + extension);
  }

  /// Of the scene that is to be shown; of all nodes, where the file has no scene.
  std::vector<int> roots() const {
    const std::size_t shown = model_.defaultScene < 0 ? 0 : static_cast<std::size_t>(model_.defaultScene);
    if (shown < model_.scenes.size())
      return model_.scenes[shown].nodes;
    std::vector<bool> child(model_.nodes.size(), false);
    for (const tinygltf::Node &node : model_.nodes)
      for (int c : node.children)
        if (c >= 0 && static_cast<std::size_t>(c) < child.size())
          child[c] = true;
    std::vector<int> result;
    for (std::size_t n = 0; n < child.size(); ++n)
      if (!child[n])
        result.push_back(static_cast<int>(n));
    return result;
  }

  void show(int root, std::vector<bool> &seen) {
    std::vector<std::pair<int, Affine3d>> open{{root, Affine3d::Identity()}};
    while (!open.empty()) {
      const auto [index, parent] = open.back();
      open.pop_back();
      if (index < 0 || static_cast<std::size_t>(index) >= seen.size() || seen[index])
        fail("expected a tree of nodes, found node " + std::to_string(index) + " twice or out of range");
      seen[index] = true;
      const tinygltf::Node &node = model_.nodes[index];
      const Affine3d place = parent * local(node);
      if (!place.matrix().allFinite())
        fail("expected finite positions of nodes, found others at node '" + node.name + "'");
      if (node.mesh >= 0)
        add_mesh(node, place);
      for (int child : node.children)
        open.emplace_back(child, place);
    }
  }

  Affine3d local(const tinygltf::Node &node) const {
    const auto &[matrix, t, q, s] = std::tie(node.matrix, node.translation, node.rotation, node.scale);
    Affine3d result = Affine3d::Identity();
    if (matrix.size() == 16) {
      result.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
      return result;
    }
    if (t.size() == 3)
      result.translate(Eigen::Vector3d(t[0], t[1], t[2]));
    if (q.size() == 4)
      result.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
    if (s.size() == 3)
      result.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    return result;
  }

  void add_mesh(const tinygltf::Node &node, const Affine3d &place) {
    if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
      fail("expected one of " + std::to_string(model_.meshes.size()) + " meshes, found number " + std::to_string(node.mesh));
    const tinygltf::Mesh &mesh = model_.meshes[node.mesh];
    if (node.skin >= 0)
      fail("expected a static scan, found the mesh '" + mesh.name + "' on a skeleton; apply its pose");
    for (const std::vector<double> *weights : {&mesh.weights, &node.weights})
      if (std::any_of(weights->begin(), weights->end(), [](double w) { return w != 0; }))
        fail("expected a scan without morph targets in use, found some at the mesh '" + mesh.name + "'; apply them");
    for (const tinygltf::Primitive &primitive : mesh.primitives) {
      const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
      const auto position = primitive.attributes.find("POSITION");
      if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end())
        continue; // points and lines
      const int first = static_cast<int>(growing_.coordinates.size() / 3);
      const std::size_t count = add_vertices(position->second, place);
      add_triangles(mode, primitive.indices < 0 ? std::vector<double>() : numbers(primitive.indices, TINYGLTF_TYPE_SCALAR), count,
                    first, place.linear().determinant() < 0);
    }
  }

  std::size_t add_vertices(int accessor, const Affine3d &place) {
    const std::vector<double> points = numbers(accessor, TINYGLTF_TYPE_VEC3);
    if (growing_.coordinates.size() + points.size() > 3 * kMostMeshVertices)
      fail("expected at most " + options::to_text(static_cast<double>(kMostMeshVertices)) + " vertices, found more");
    for (std::size_t v = 0; v + 2 < points.size(); v += 3) {
      const Eigen::Vector3d p = place * Eigen::Vector3d(points.data() + v);
      growing_.add_vertex(p.x(), p.y(), p.z());
    }
    return points.size() / 3;
  }

  void add_triangles(int mode, std::vector<double> indices, std::size_t count, int first, bool mirrored) {
    if (indices.empty())
      for (std::size_t v = 0; v < count; ++v)
        indices.push_back(static_cast<double>(v));
    if (growing_.corners.size() + 3 * indices.size() > 6 * kMostMeshVertices)
      fail("expected at most " + options::to_text(2.0 * static_cast<double>(kMostMeshVertices)) + " triangles, found more");
    const auto corner = [&](std::size_t i) {
      if (!(indices[i] >= 0 && indices[i] < static_cast<double>(count) && indices[i] == std::floor(indices[i])))
        fail("expected vertices from 0 to " + std::to_string(count) + ", found number " + options::to_text(indices[i]));
      return first + static_cast<int>(indices[i]);
    };
    const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    for (std::size_t i = 0; i + 2 < indices.size(); i += step) {
      const bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
      int a = corner(mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i), b = corner(i + 1), c = corner(i + 2);
      if (odd != mirrored)
        std::swap(b, c);
      if (a != b && b != c && a != c) // strips are joined by such
        growing_.corners.insert(growing_.corners.end(), {a, b, c});
    }
  }

  /// The numbers of an accessor; normalised integers as what they mean.
  std::vector<double> numbers(int accessor, int type) const {
    const std::string what = "accessor " + std::to_string(accessor);
    if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size())
      fail("expected one of " + std::to_string(model_.accessors.size()) + " accessors, found number " + std::to_string(accessor));
    const tinygltf::Accessor &a = model_.accessors[accessor];
    if (a.type != type || a.sparse.isSparse || a.bufferView < 0 ||
        static_cast<std::size_t>(a.bufferView) >= model_.bufferViews.size())
      fail("expected " + what + " to be plain numbers of the type " + std::to_string(type) + " in a buffer view, found another");
    const tinygltf::BufferView &view = model_.bufferViews[a.bufferView];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
      fail(what + " is of a buffer that is not there");
    const std::vector<unsigned char> &bytes = model_.buffers[view.buffer].data;
    const int each = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType)),
              width = type == TINYGLTF_TYPE_VEC3 ? 3 : 1;
    if (each <= 0)
      fail("expected " + what + " to have a component type of glTF, found " + std::to_string(a.componentType));
    const std::size_t row = static_cast<std::size_t>(each * width), stride = view.byteStride > 0 ? view.byteStride : row;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset || a.byteOffset > view.byteLength ||
        stride < row ||
        (a.count > 0 && (view.byteLength - a.byteOffset < row || a.count - 1 > (view.byteLength - a.byteOffset - row) / stride)))
      fail(what + " reaches beyond its buffer view");
    std::vector<double> result;
    for (std::size_t i = 0; i < a.count; ++i)
      for (int k = 0; k < width; ++k)
        result.push_back(
            component(bytes.data() + view.byteOffset + a.byteOffset + i * stride + static_cast<std::size_t>(k * each),
                      a.componentType, a.normalized));
    return result;
  }

  template <class T> static double as(const unsigned char *bytes, bool normalised) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    const auto number = static_cast<double>(value);
    return normalised ? std::max(number / static_cast<double>(std::numeric_limits<T>::max()), -1.0) : number;
  }

  double component(const unsigned char *bytes, int type, bool normalised) const {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return as<std::int8_t>(bytes, normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return as<std::uint8_t>(bytes, normalised);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return as<std::int16_t>(bytes, normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return as<std::uint16_t>(bytes, normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return as<std::uint32_t>(bytes, normalised);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return as<float>(bytes, false);
    default:
      fail("expected a component type of glTF, found " + std::to_string(type));
    }
  }

  std::string source_;
  tinygltf::Model model_;
  GrowingMesh growing_;
};

} // namespace

Mesh parse_glb(const std::string &data, const std::string &source) {
  return Scene(data, source).mesh();
}

} // namespace doublet::detail
