#pragma once
// A texture for M_high from the images of one frame. No unwrapping: every triangle has its own cell in the atlas.

#include "doublet/animate/character.h"
#include "doublet/core/camera.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <vector>

namespace doublet {

struct TextureOptions {
  int size = 2048;
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
        option(&O::size, "size", Range{64, 16384}, "px", "Width and height of the atlas",
               "In 2048, 25k triangles get cells of about 18 pixels"),
        option(&O::facing_power, "facing_power", Range{0, 64}, "",
               "Cameras count by the cosine between normal and ray to this power"),
        option(&O::grazing, "grazing", Range{0, 1, Open::Above}, "", "Cameras below this cosine do not count",
               "They see the silhouette's mixed pixels"),
        option(&O::depth_margin, "depth_margin", above(0), "m", "A point this far behind the z-buffer's surface is hidden"),
        option(&O::edge_margin, "edge_margin", Range{0, 1}, "m",
               "A point does not count this close to the edge of something in front of it", "Legs at a hem"),
        option(&O::screen_margin, "screen_margin", Range{0, 0.5}, "",
               "Pixels of the screen's colour do not count this far inside the silhouette; 0 = they do",
               "A share of the image's smaller side, and deeper where the actor has next to none of the colour: gaps between "
               "fingers"),
        option(&O::label_margin, "label_margin", Range{0, 0.5}, "m",
               "Body and garment do not take each other's colour where seen this close together; 0 = they may",
               "Where they are 3 cm apart in depth: hands before a skirt"),
        option(&O::albedo, "albedo", "The light of the images is divided out of the texture; off = as photographed",
               "Whoever draws it can then light it"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// What a face is of.
enum class SurfaceLabel : std::uint8_t { Body, Garment };

struct BakedTexture {
  TexCoords texcoords;      ///< (3 F, 2) per corner
  Image image;              ///< B G R
  double seen_fraction = 0; ///< share of the drawn surface's area that at least one camera saw
};

/// `masks`: one silhouette a camera (255 = actor), or none at all; what lies outside, shows a screen through a gap, or is on
/// the rim (3 pixels) of either does not count, so that the backdrop does not get onto fingers. `mesh` stands as in the images;
/// `face_valid` (F) or empty; one image (B G R) a camera, an empty image = camera without one. What no camera sees is filled
/// from its neighbours on the surface. `face_labels` (F) or empty: what keeps the colours of body and garment apart
/// (label_margin). Throws Error, std::invalid_argument if sizes do not fit.
BakedTexture bake_texture(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras, const std::vector<Image> &images,
                          const std::vector<Image> &masks = {}, const std::vector<SurfaceLabel> &face_labels = {},
                          const TextureOptions &options = {}, const Context &context = {});

/// Colours at 10 points of every face, for SegmentInputs::colours: (10 F, 3) B G R, 0 to 255, as photographed whatever `albedo`
/// says, NaN where no camera sees it. Arguments and errors as of bake_texture(), without labels.
Vertices sample_colours(const Mesh &mesh, const Mask &face_valid, const CameraRig &cameras, const std::vector<Image> &images,
                        const std::vector<Image> &masks = {}, const TextureOptions &options = {}, const Context &context = {});

/// Bakes the texture of a character's M_high from the frame whose captured surface is `surface` (V, 3), and puts it into the
/// character as JPEG. The hidden body takes the colour of the skin beyond the garment's free edges, of legs below a hem, and
/// the texture goes over into it. Returns the share of the surface that was seen. Throws Error if the character has no M_high.
double texture_character(Character &character, const Vertices &surface, const CameraRig &cameras,
                         const std::vector<Image> &images, const std::vector<Image> &masks = {},
                         const TextureOptions &options = {}, const Context &context = {});

} // namespace doublet
