#pragma once
// The scanned surface, its connected pieces, and regions.

#include "doublet/core/stage_values.h"

#include <cstdint>
#include <vector>

namespace doublet::detail {

/// The valid surface with the measures that segmenting needs.
struct Surface {
  const Vertices &vertices;
  Faces faces;
  Eigen::VectorXd areas;
  std::vector<std::vector<int>> neighbours;
  std::vector<char> seam; ///< touches an invalid face
  Eigen::VectorXi hole;   ///< (V) which connected set of invalid faces that is, -1 = none
  int size() const { return static_cast<int>(vertices.rows()); }
};

/// With the sheets of the mask extended (extend_invalid_faces). Throws std::invalid_argument if face_valid has another length.
Surface surface_of(const Mesh &pose, const std::vector<std::uint8_t> &face_valid);

struct Patch {
  std::vector<int> members;
  double area = 0;
};

/// Connected sets of the vertices chosen, by falling area (ties: lowest vertex first).
std::vector<Patch> connected_patches(const Surface &surface, const std::vector<char> &chosen);

template <typename Predicate> std::vector<char> choose(const Surface &surface, Predicate predicate) {
  std::vector<char> chosen(surface.size(), 0);
  for (int i = 0; i < surface.size(); ++i)
    chosen[i] = surface.areas[i] > 0 && predicate(i);
  return chosen;
}

/// Patches of either kind, 0 or 1, of the vertices that are `member` (V), that are smaller than `smallest` (m^2) go with what is
/// around them; what has none of the other kind around it stays.
void merge_small(const Surface &surface, const std::vector<char> &member, double smallest, std::vector<char> &kinds);

/// (V) diffused values of labels, 0 or 1, without what diffusion leaves far away; on no face, where it leaves NaN, 0.
Eigen::VectorXd snapped(const Eigen::VectorXd &values);

/// Regions of `result` out of its clothness: connected sets of clothness > 0, which do not connect through vertices of `parting`
/// (V, or empty = none). Those go with the region nearest along the cloth, and so does what they cut off that is smaller than
/// `smallest` (m^2).
void label_regions(const Surface &surface, const std::vector<char> &parting, Segmentation &result, double smallest = 0);

/// (V) vertices beside another region, which part both when they are labelled again.
std::vector<char> borders_of_regions(const Surface &surface, const Segmentation &segmentation);

} // namespace doublet::detail
