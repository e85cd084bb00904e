#pragma once
// Mesh files in memory. Written here, because the readers at hand trust what a file says: a face of 4 corners, an index out of
// range or one byte too many ends Open3D's in a crash. Every count is held against the bytes that are there before anything is
// allocated; of the rest of a format (normals, colours, materials) nothing is read.
// parse_*: Error "SOURCE: expected ..., found ..." for anything malformed; corners may still be out of range (require_usable).
// Polygons become triangles: fans if they are convex.

#include "doublet/core/mesh.h"

#include <iosfwd>
#include <string>

namespace doublet::detail {

Mesh parse_ply(const std::string &data, const std::string &source);
Mesh parse_obj(const std::string &data, const std::string &source);
/// Equal corners become one vertex; bytes behind the last triangle mean nothing.
Mesh parse_stl(const std::string &data, const std::string &source);
Mesh parse_off(const std::string &data, const std::string &source);
/// Binary glTF: the triangles of all meshes that the scene shows, where its nodes put them.
Mesh parse_glb(const std::string &data, const std::string &source);

void print_ply(const Mesh &mesh, std::ostream &out); ///< binary, doubles
void print_obj(const Mesh &mesh, std::ostream &out);
void print_stl(const Mesh &mesh, std::ostream &out); ///< binary
void print_off(const Mesh &mesh, std::ostream &out);

} // namespace doublet::detail
