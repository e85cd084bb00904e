#pragma once
// A texture laid out in charts: neighbouring triangles lie side by side in the image, so that few vertices have two places in it.
// The atlas of texture_baker.h gives every triangle a place of its own; as three times as many vertices move, files of motions
// would be five times the size.

#include "doublet/animate/character.h"

namespace doublet::detail {

struct ChartedTexture {
  TexCoords texcoords;    ///< (3 F, 2) per corner; 0 at faces that are not shown
  std::vector<int> chart; ///< (F) -1 = not shown
  Image image;            ///< B G R, as large as the one it is made of
};

/// The same picture on the same surface. `texcoords` (3 F, 2), `shown` (F) or empty. A chart is a connected piece of the surface
/// seen from one side, flattened without a fold onto a plane; charts have one scale and lie in shelves.
ChartedTexture chart_texture(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &texcoords,
                             const Image &image);

} // namespace doublet::detail
