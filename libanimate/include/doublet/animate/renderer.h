#pragma once
// Pictures of characters without a graphics card: z-buffer, smooth normals, a key light and a soft sky, a floor with a soft
// shadow.

#include "doublet/animate/character.h"
#include "doublet/core/camera.h"
#include "doublet/options/options.h"

namespace doublet {

namespace detail {
class TexturePyramid;
}

/// One mesh of a picture. The colour comes from `texture` if there is one, else from `colours`, else from `colour`.
struct RenderMesh {
  Vertices vertices;                        ///< (V, 3) m
  Faces faces;                              ///< (F, 3)
  Mask face_valid;                          ///< (F), 0 = not drawn; empty = draw all
  Eigen::Vector3d colour{0.75, 0.75, 0.75}; ///< R G B in [0, 1]
  Vertices colours;                         ///< (V, 3) R G B in [0, 1], or empty
  TexCoords texcoords;                      ///< (3 F, 2) per corner, or empty
  std::shared_ptr<const Image> texture;     ///< B G R, or null
};

struct RenderOptions {
  Eigen::Vector3d background{0.93, 0.94, 0.96};
  bool floor = true;
  double floor_height = 0;
  double light = 0.75;
  Eigen::Vector3d light_direction{0.4, 1.0, 0.6};
  bool supersample = true;
  static constexpr auto describe() {
    using namespace options;
    using O = RenderOptions;
    return Description{
        "RenderOptions",
        option(&O::background, "background", Range{0, 1}, "", "Colour of the background, R G B"),
        option(&O::floor, "floor", "A grid is drawn at floor_height, with the soft shadow of the meshes"),
        option(&O::floor_height, "floor_height", Range{}, "m", "Height of the grid"),
        option(&O::light, "light", Range{0, 1}, "", "Share of the key light; the rest is the sky"),
        option(&O::light_direction, "light_direction", Range{}, "", "Direction to the light in the world, of any length but 0"),
        option(&O::supersample, "supersample", "Every pixel is the mean of 2 x 2 samples"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// B G R image of the camera's size. Throws std::invalid_argument if a mesh's arrays do not fit together.
Image render(const std::vector<RenderMesh> &meshes, const Camera &camera, const RenderOptions &options = {});

/// A camera that looks at `target` from `azimuth` (rad, 0 = from +Z, positive towards +X) and `elevation` (rad) so that a sphere
/// of `radius` (m) around the target fills the image's smaller side.
Camera orbit_camera(const Eigen::Vector3d &target, double radius, double azimuth, double elevation, int width, int height);

/// Renders one character in many frames: M_high (textured) or, if `high` is empty, M; and the body where cloth hid it in the
/// scan.
class CharacterRenderer {
public:
  explicit CharacterRenderer(const Character &character);
  /// The frame's meshes; `high` and `body` may be empty. Throws std::invalid_argument if the vertices are not this character's.
  std::vector<RenderMesh> meshes(const Vertices &surface, const Vertices &high, const Vertices &body) const;
  Image render(const Vertices &surface, const Vertices &high, const Vertices &body, const Camera &camera,
               const RenderOptions &options = {}) const;

private:
  void require_frame(const Vertices &surface, const Vertices &high, const Vertices &body) const;

  RenderMesh coarse_, high_, body_;
  std::shared_ptr<const detail::TexturePyramid> texture_; ///< of high_; null = none
};

} // namespace doublet
