#pragma once
// A finished animation as a file for other programs.

#include "doublet/animate/animator.h"
#include "doublet/options/options.h"

#include <filesystem>

namespace doublet {

/// vertices (T, V, 3) f32 of M, faces (F, 3) i32, face_valid (F), joints (T, J, 3) f32, joint_names, dofs (T, D) f32, fps; and,
/// where the result has them, body_vertices (T, B, 3), body_faces (FB, 3), body_shown (FB), and high_vertices (T, VH, 3),
/// high_faces (FH, 3), high_valid (FH) of M_high. Written beside and renamed.
void write_baked_npz(const std::filesystem::path &path, const Character &character, const AnimationResult &animation);

struct BakedGlbOptions {
  double keys_per_second = 0;
  int max_keys = 400;
  static constexpr auto describe() {
    using namespace options;
    using O = BakedGlbOptions;
    return Description{
        "BakedGlbOptions",
        option(&O::keys_per_second, "keys_per_second", Range{0, 1000}, "1/s", "Shapes that are stored a second; 0 = one a frame",
               "Viewers blend between them; at 10 loose cloth is up to 2 cm off"),
        option(&O::max_keys, "max_keys", Range{2, 5000}, "", "Shapes that are stored at most",
               "A long clip gets fewer keys a second rather than a file of hundreds of megabytes"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Plays in any glTF 2.0 viewer that knows KHR_mesh_quantization: the joints as animated nodes, and skinned to them M_high in its
/// texture (M in colours where the result is without M_high) and the hidden body as the animation has it (tucked under the
/// cloth), with one morph target a key each. The shapes are relative to the bones, so that both follow these between keys; a key
/// holds the vertices that are not where the bones alone have them, 11 bytes each. Returns the number of keys.
int write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                    const BakedGlbOptions &options = {});

} // namespace doublet
