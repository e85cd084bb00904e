#pragma once
// Triangle meshes in files.

#include "doublet/core/mesh.h"

#include <filesystem>

namespace doublet {

/// .ply, .obj, .stl, .off, .glb: vertices and faces, nothing else; polygons become triangles, seams (open edges at one place) are
/// closed, what a scene of .glb shows is one mesh in metres. Throws FileNotFound, or Error naming the file if it is malformed or
/// truncated, or (but for STL) longer than it says, or unless the mesh is usable (require_usable).
Mesh read_mesh(const std::filesystem::path &path);
/// All of these but .glb, complete or not at all. Throws Error naming the file if the mesh is not usable, or the disk is full.
void write_mesh(const std::filesystem::path &path, const Mesh &mesh);

} // namespace doublet
