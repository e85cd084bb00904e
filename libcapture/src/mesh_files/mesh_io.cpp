#include "doublet/capture/mesh_file.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "mesh_formats.h"
#include "mesh_parsing.h"

namespace doublet {
namespace {

struct MeshFormat {
  const char *extension;
  Mesh (*parse)(const std::string &data, const std::string &source);
  void (*print)(const Mesh &mesh, std::ostream &out);
};

const MeshFormat &format_of(const std::filesystem::path &path) {
  static constexpr MeshFormat kFormats[] = {{".ply", detail::parse_ply, detail::print_ply},
                                            {".obj", detail::parse_obj, detail::print_obj},
                                            {".stl", detail::parse_stl, detail::print_stl},
                                            {".off", detail::parse_off, detail::print_off},
                                            {".glb", detail::parse_glb, nullptr}};
  std::string extension = path.extension().string();
  for (char &c : extension)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const MeshFormat &format : kFormats)
    if (extension == format.extension)
      return format;
  throw Error(path.string() + ": expected a mesh file (.ply, .obj, .stl, .off or .glb), found the extension '" + extension + "'");
}

} // namespace

Mesh read_mesh(const std::filesystem::path &path) {
  const MeshFormat &format = format_of(path);
  const Mesh mesh = detail::without_seams(format.parse(read_text(path), path.string()));
  require_usable(mesh, path.string());
  return mesh;
}

void write_mesh(const std::filesystem::path &path, const Mesh &mesh) {
  const MeshFormat &format = format_of(path);
  if (!format.print)
    throw Error(path.string() + ": expected a mesh file to write (.ply, .obj, .stl or .off), found '" + format.extension + "'");
  require_usable(mesh, "the mesh for " + path.string());
  write_stream(path, [&](std::ostream &out) { format.print(mesh, out); });
}

} // namespace doublet
