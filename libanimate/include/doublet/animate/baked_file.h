#pragma once
// A finished animation as a file for other programs.

#include "doublet/animate/animator.h"
#include "doublet/core/textured_faces.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace doublet {

/// vertices (T, V, 3) f32 of M, faces (F, 3) i32, face_valid (F), joints (T, J, 3) f32, joint_rotations (T, J, 4) f32 w x y z in
/// the world, joint_names, dofs (T, D) f32, fps; and, where the result has them, body_vertices (T, B, 3), body_faces (FB, 3),
/// body_shown (FB), and high_vertices (T, VH, 3), high_faces (FH, 3), high_valid (FH) of M_high. `drawn`: these faces are written
/// instead of M_high's, with only their vertices; empty = M_high's own. Written to a temporary file, then renamed. Throws
/// std::invalid_argument if the animation is not the character's, or `drawn` does not fit M_high.
void write_baked_npz(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                     const TexturedFaces &drawn = {});

struct BakedGlbOptions {
  double max_error = 1e-3;
  double keys_per_second = 0;
  int max_keys = 400;
  static constexpr auto describe() {
    using namespace options;
    using O = BakedGlbOptions;
    return Description{
        "BakedGlbOptions",
        option(&O::max_error, "max_error", Range{0, 0.1}, "m",
               "Error that the principal components may leave (RMS, of each mesh); 0 = one shape per key, exact",
               "At 1 mm the file has a third of the size, and no frame has to be left out"),
        option(&O::keys_per_second, "keys_per_second", Range{0, 1000}, "1/s", "Keys of the shapes per second; 0 = one per frame",
               "Viewers blend between them; at 10 loose cloth is up to 2 cm off"),
        option(&O::max_keys, "max_keys", Range{2, 5000}, "", "Largest number of shapes of a mesh",
               "A viewer keeps all of them. Beyond it the error is larger, or with one shape per key the keys are fewer"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Difference between what a viewer shows of a mesh and the animation, over all frames and vertices.
struct BakedMeshSummary {
  std::string name;     ///< of the node: surface, body
  int vertices = 0;     ///< in the file; a vertex on a seam of the texture counts twice
  int shapes = 0;       ///< morph targets
  double rms_error = 0; ///< m
  double error_95 = 0;  ///< m, 95 % quantile
  double max_error = 0; ///< m
};

struct BakedGlbSummary {
  int keys = 0; ///< times at which the weights of the shapes are stored
  std::vector<BakedMeshSummary> meshes;
};

/// A .glb that plays in any glTF 2.0 viewer with KHR_mesh_quantization: the joints as animated nodes; skinned to them, with morph
/// targets, M_high with its texture (or M with colours if the result has no M_high) and the hidden body as in the animation
/// (moved under the cloth). The shapes are relative to the bones, so that both meshes follow the bones between keys. A target
/// holds only the vertices that it moves, 8 to 11 bytes each. The extras of the meshes contain the numbers of the summary. Throws
/// std::invalid_argument if the animation is not the character's, Cancelled.
BakedGlbSummary write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                                const BakedGlbOptions &options = {}, const TexturedFaces &drawn = {},
                                const Context &context = {});

} // namespace doublet
