#pragma once
// A texture for M_high from the images of a take: every texel from the frames and cameras that see it best.

#include "doublet/animate/character.h"
#include "doublet/core/camera.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace doublet {

struct TextureOptions {
  int size = 2048;
  int frames = 16;
  double facing_power = 4;
  double grazing = 0.2;
  double depth_margin = 0.01;
  double edge_margin = 0.02;
  double screen_margin = 0.025;
  double label_margin = 0.05;
  bool albedo = true;
  static constexpr auto describe() {
    using namespace options;
    using O = TextureOptions;
    return Description{
        "TextureOptions",
        option(&O::size, "size", Range{64, 16384}, "px", "Width and height of the image",
               "In 2048, a pixel of a person is about 1.1 mm wide"),
        option(&O::frames, "frames", Range{1, 64}, "", "Largest number of frames of the take that are used",
               "The time is proportional"),
        option(&O::facing_power, "facing_power", Range{0, 64}, "",
               "Weight of a camera: the cosine between normal and ray to this power"),
        option(&O::grazing, "grazing", Range{0, 1, Open::Above}, "", "Cameras below this cosine have no weight",
               "They see the mixed pixels of the silhouette"),
        option(&O::depth_margin, "depth_margin", above(0), "m", "A point this far behind the z-buffer's surface is hidden"),
        option(&O::edge_margin, "edge_margin", Range{0, 1}, "m", "A point this close to the edge of an occluder is ignored",
               "Legs at a hem"),
        option(&O::screen_margin, "screen_margin", Range{0, 0.5}, "",
               "Pixels of the screen's colour are ignored this far inside the silhouette; 0 = they are used",
               "A share of the image's smaller side, more where the actor has almost none of the colour: gaps between fingers"),
        option(&O::label_margin, "label_margin", Range{0, 0.5}, "m",
               "Body and garment do not take each other's colour if seen this close together; 0 = they may",
               "Where they are 3 cm apart in depth: hands in front of a skirt"),
        option(&O::albedo, "albedo", "The light of the images is divided out of the texture; off = as photographed",
               "A renderer can then light it"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// What a face belongs to.
enum class SurfaceLabel : std::uint8_t { Body, Garment };

struct BakedTexture {
  TexCoords texcoords;      ///< (3 F, 2) per corner
  Image image;              ///< B G R
  double seen_fraction = 0; ///< share of the drawn surface's area that at least one camera saw
};

/// One image (B G R) per camera, empty = camera without one. `masks`: one silhouette per camera (255 = actor), or none at all.
/// Pixels outside the silhouette, those that show a screen through a gap, and those within 3 pixels of either are ignored, so
/// that the colour of the background does not get onto fingers.
struct FrameImages {
  std::vector<Image> images, masks;
};

/// A moving surface, and the images of the take that show it.
struct FilmedSurface {
  int frame_count = 0;
  std::function<Vertices(int)> vertices;  ///< (V, 3) m, where the surface is in the images of a frame; called from any thread
  std::function<FrameImages(int)> images; ///< called from the calling thread, at most once per frame, in ascending order
};

/// The frames that together show most of the surface (greedy; Nemhauser, Wolsey, Fisher 1978), ascending: always the first, at
/// most options.frames in all.
std::vector<int> choose_texture_frames(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras,
                                       const FilmedSurface &filmed, const TextureOptions &options = {},
                                       const Context &context = {});

/// `mesh`: the texture is laid out on it, best in a pose without self-contact; `face_valid` (F) or empty. What no camera sees is
/// filled from its neighbours on the surface. `face_labels` (F) or empty: for label_margin, which keeps the colours of body and
/// garment apart. Throws Error on unusable meshes, std::invalid_argument if sizes do not fit.
BakedTexture bake_texture(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras, const FilmedSurface &filmed,
                          const std::vector<SurfaceLabel> &face_labels = {}, const TextureOptions &options = {},
                          const Context &context = {});

/// The same from one frame, in whose images `mesh` is shown as it is.
BakedTexture bake_texture(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras, const std::vector<Image> &images,
                          const std::vector<Image> &masks = {}, const std::vector<SurfaceLabel> &face_labels = {},
                          const TextureOptions &options = {}, const Context &context = {});

/// Colours at 10 points of every face, for SegmentInputs::colours: (10 F, 3) B G R, 0 to 255, as photographed (`albedo` is
/// ignored), NaN where no camera sees the point. Arguments and errors as in bake_texture() from one frame, without labels.
Vertices sample_colours(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras, const std::vector<Image> &images,
                        const std::vector<Image> &masks = {}, const TextureOptions &options = {}, const Context &context = {});

/// Bakes the texture of a character's M_high from a take and stores it in the character as JPEG; `filmed`: vertices (V, 3) of the
/// captured surface M. The hidden body gets the colour of the skin beyond the garment's free boundary, such as legs below a hem,
/// and the texture blends into it. Returns the share of the surface that was seen. Throws Error if the character has no M_high.
double texture_character(Character &character, const FilmedSurface &filmed, const CameraRig &cameras,
                         const TextureOptions &options = {}, const Context &context = {});

/// The same from one frame, in which the captured surface is `surface` (V, 3).
double texture_character(Character &character, const Vertices &surface, const CameraRig &cameras,
                         const std::vector<Image> &images, const std::vector<Image> &masks = {},
                         const TextureOptions &options = {}, const Context &context = {});

} // namespace doublet
