#pragma once
// A finished animation as a file for other programs.

#include "doublet/animate/animator.h"

#include <filesystem>

namespace doublet {

/// vertices (T, V, 3) f32 of M, faces (F, 3) i32, face_valid (F), joints (T, J, 3) f32, joint_names, dofs (T, D) f32, fps; and,
/// where the result has them, body_vertices (T, B, 3), body_faces (FB, 3), body_shown (FB). Written beside and renamed.
void write_baked_npz(const std::filesystem::path &path, const Character &character, const AnimationResult &animation);

struct BakedGlbOptions {
  double keys_per_second = 10; ///< 1/s, shapes of the surface that are stored; viewers blend linearly between them
  int most_keys = 300;         ///< a long clip gets fewer keys a second rather than a file of hundreds of megabytes
  void validate() const;       ///< throws std::invalid_argument naming option, range and value
};

/// Plays in any glTF 2.0 viewer: the joints as animated nodes, the hidden body skinned to them, and the surface of M (coloured
/// from the texture) as morph targets, one a key. About 24 bytes a vertex a key: M of 2500 vertices and 10 s at 10 keys a second
/// make 6 MB.
void write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                     const BakedGlbOptions &options = {});

} // namespace doublet
