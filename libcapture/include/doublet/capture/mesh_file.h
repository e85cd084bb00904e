#pragma once
// Triangle meshes in files.

#include "doublet/core/mesh.h"

#include <filesystem>

namespace doublet {

/// .ply, .obj, .stl, .off: vertices and faces, nothing else; polygons become fans of triangles. Throws FileNotFound, or Error
/// naming the file if it is malformed, truncated or longer than it says, or unless the mesh is usable (require_usable).
Mesh read_mesh(const std::filesystem::path &path);
/// Complete or not at all. Throws Error naming the file if the mesh is not usable, or the disk is full.
void write_mesh(const std::filesystem::path &path, const Mesh &mesh);

} // namespace doublet
