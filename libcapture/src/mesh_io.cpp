#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/core/files.h"
#include "open3d_mesh.h"

#include <open3d/io/TriangleMeshIO.h>

namespace doublet {
namespace {

std::string known_extension(const std::filesystem::path &path) {
  std::string extension = path.extension().string();
  for (char &c : extension)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char *known : {".ply", ".obj", ".stl", ".off"})
    if (extension == known)
      return extension;
  throw Error(path.string() + ": expected a mesh file (.ply, .obj, .stl or .off), found the extension '" + extension + "'");
}

} // namespace

Mesh read_mesh(const std::filesystem::path &path) {
  const std::string extension = known_extension(path);
  if (!std::filesystem::is_regular_file(path))
    throw FileNotFound(path.string() + ": the mesh file does not exist");
  const detail::QuietOpen3D quiet;
  open3d::geometry::TriangleMesh mesh;
  bool read = false;
  try {
    read = open3d::io::ReadTriangleMesh(path.string(), mesh);
  } catch (const std::exception &e) {
    throw Error(path.string() + ": expected a triangle mesh, found a broken file (" + e.what() + ")");
  }
  if (!read || mesh.vertices_.empty() || mesh.triangles_.empty())
    throw Error(path.string() + ": expected a complete triangle mesh, found " + std::to_string(mesh.vertices_.size()) +
                " vertices and " + std::to_string(mesh.triangles_.size()) + " triangles" +
                (read ? "" : " in a broken or truncated file"));
  if (extension == ".stl")
    mesh.RemoveDuplicatedVertices(); // the format has no shared vertices
  Mesh out = detail::from_open3d(mesh);
  require_usable(out, path.string());
  return out;
}

void write_mesh(const std::filesystem::path &path, const Mesh &mesh) {
  const std::string extension = known_extension(path);
  require_usable(mesh, "the mesh for " + path.string());
  const detail::QuietOpen3D quiet;
  const auto out = detail::to_open3d(mesh);
  if (extension == ".stl")
    out->ComputeTriangleNormals(); // the format demands them
  write_atomically(path, [&](const std::filesystem::path &temporary) {
    std::filesystem::path typed = temporary;
    typed += extension; // Open3D goes by the extension
    if (!open3d::io::WriteTriangleMesh(typed.string(), *out))
      throw Error(path.string() + ": the mesh could not be written");
    std::filesystem::rename(typed, temporary);
  });
}

} // namespace doublet
