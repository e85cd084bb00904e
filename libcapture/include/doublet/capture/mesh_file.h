#pragma once
// Triangle meshes in files.

#include "doublet/core/mesh.h"

#include <filesystem>

namespace doublet {

/// .ply, .obj, .stl, .off, .glb: only vertices and faces are read; polygons become triangles, seams (coinciding open edges) are
/// closed, all meshes of a .glb scene become one mesh in metres. Throws FileNotFound, or Error naming the file if it is
/// malformed, truncated or (except STL) longer than its header says, or if the mesh is not usable (require_usable).
Mesh read_mesh(const std::filesystem::path &path);
/// The same formats except .glb, written atomically. Throws Error naming the file if the mesh is not usable, or the disk is full.
void write_mesh(const std::filesystem::path &path, const Mesh &mesh);

} // namespace doublet
