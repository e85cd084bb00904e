#pragma once
// How a texture is laid out: in charts, pieces of the surface that lie in the image as they do on the surface, so that few
// vertices have two places in it.

#include "doublet/animate/character.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace doublet::detail {

/// A square image, and where the faces lie in it.
struct ChartLayout {
  int size = 0;           ///< px
  TexCoords texcoords;    ///< (3 F, 2) per corner; 0 at faces that are not shown
  std::vector<int> chart; ///< (F) -1 = not shown
  std::vector<int> owner; ///< (size * size) the face whose colour a pixel has; -1 = between charts

  Eigen::Vector2d corner(int face, int k) const { return size * texcoords.row(3 * face + k).transpose(); } ///< px
};

/// `shown` (F) or empty. A chart is a connected piece of the surface seen from one side, flattened without a fold onto a plane;
/// charts have one scale. Throws std::invalid_argument if the image cannot hold the charts.
ChartLayout lay_out_charts(const Mesh &mesh, const std::vector<std::uint8_t> &shown, int size);

/// Calls visit(x, y, barycentric coordinates) for the pixels that are the face's own.
template <class Visit> void for_texels(const ChartLayout &layout, int face, const Visit &visit);

/// Pixels between the charts take the colours of what is nearest, so that a picture made smaller keeps them.
void fill_between_charts(const ChartLayout &layout, Image &image);

/// Calls visit(x, y, barycentric coordinates) for the pixels whose centre is in the triangle.
template <class Visit> void for_pixels(const std::array<Eigen::Vector2d, 3> &t, const Visit &visit) {
  const Eigen::Vector2d ab = t[1] - t[0], ac = t[2] - t[0];
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (!(std::abs(area) > 1e-12))
    return;
  const auto [left, right] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
  const auto [low, high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
  for (int y = static_cast<int>(std::floor(low)); y <= static_cast<int>(high); ++y)
    for (int x = static_cast<int>(std::floor(left)); x <= static_cast<int>(right); ++x) {
      const Eigen::Vector2d p = Eigen::Vector2d(x + 0.5, y + 0.5) - t[0];
      const double b = (p.x() * ac.y() - p.y() * ac.x()) / area, c = (ab.x() * p.y() - ab.y() * p.x()) / area;
      if (b >= 0 && c >= 0 && b + c <= 1)
        visit(x, y, Eigen::Vector3d(1 - b - c, b, c));
    }
}

template <class Visit> void for_texels(const ChartLayout &layout, int face, const Visit &visit) {
  if (layout.chart[face] < 0)
    return;
  const auto is_own = [&](int x, int y) { return layout.owner[static_cast<std::size_t>(y) * layout.size + x] == face; };
  const std::array<Eigen::Vector2d, 3> t{layout.corner(face, 0), layout.corner(face, 1), layout.corner(face, 2)};
  bool any = false;
  for_pixels(t, [&](int x, int y, const Eigen::Vector3d &at) {
    any = true;
    if (is_own(x, y))
      visit(x, y, at);
  });
  for (int k = 0; k < 3 && !any; ++k) // slivers may be without a pixel's centre
    if (const auto x = static_cast<int>(t[k].x()), y = static_cast<int>(t[k].y()); is_own(x, y))
      visit(x, y, Eigen::Vector3d(Eigen::Vector3d::Unit(k)));
}

} // namespace doublet::detail
