#pragma once
// Outlines of masks, measured or rendered, and nearest-point queries on them.

#include "doublet/core/image.h"

#include <Eigen/Core>
#include <vector>

namespace doublet {

/// Boundary of a mask. Arrays of one length N, about one entry per boundary pixel, in order along each loop.
struct Outline {
  std::vector<Eigen::Vector2f>
      points; ///< pixels; on the boundary itself, i.e. about half a pixel outside the last inside pixel's centre
  std::vector<Eigen::Vector2f> normals; ///< unit, pointing out of the mask
  std::vector<Eigen::Vector2i> pixels;  ///< the inside pixel each point belongs to
  bool empty() const { return points.empty(); }
};

/// Traces outer boundaries and holes (Suzuki & Abe 1985). The pixel steps are smoothed over 5 pixels. Points within `margin`
/// pixels of the image border are left out: there the image ends, not the actor. Loops of fewer than 12 pixels are noise and left
/// out, too.
Outline trace_outline(const Image &mask, int margin = 2);

/// The same for a mask of `width` x `height` whose inside pixels all lie in `part`; the first pixel of `part` is (x, y) of the
/// mask.
Outline trace_outline(const Image &part, int x, int y, int width, int height, int margin = 2);

/// Fills loops of boundary points to a mask (even-odd rule): the inverse of trace_outline, except for loops that are cut at the
/// image border. `points` as in Outline::points or ViewObservation::contour.
Image fill_outline(const std::vector<Eigen::Vector2f> &points, int width, int height);

/// Uniform grid over the points of an outline, which it copies; const calls are thread-safe.
class OutlineIndex {
public:
  OutlineIndex(const Outline &outline, int width, int height);
  /// Index of the closest point within `radius` pixels whose normal has at least `min_cosine` with `normal`; -1 if there is none.
  int nearest(const Eigen::Vector2f &point, const Eigen::Vector2f &normal, float radius, float min_cosine) const;

private:
  struct Entry {
    Eigen::Vector2f point, normal;
    int index; // in the outline
  };
  int columns_ = 0, rows_ = 0;
  std::vector<int> first_; // cell -> range of entries
  std::vector<Entry> entries_;
};

} // namespace doublet
