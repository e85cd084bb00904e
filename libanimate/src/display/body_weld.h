#pragma once
// One surface of the scan's skin and of the body that goes on under a garment.

#include "doublet/core/mesh.h"

#include <optional>
#include <vector>

namespace doublet::detail {

constexpr double kTakenBack = 0.02; // m, of the scan's skin beside its end at a garment; if loops then match

struct WeldedSkin {
  Mesh mesh;                      ///< the scan's vertices first
  std::vector<int> body_vertices; ///< the body's vertex that each of the others is
};

/// The scan's skin and the body, both in the scan pose, made one surface as in Turk & Levoy 1994: the scan is taken back by about
/// 2 cm where it ends beside what `hidden` (B) tells to be hidden of the body, the body goes on there, moved to meet it and back
/// to its own place within 5 cm, and triangles join the loops in which the two end. Nothing if those do not belong together one
/// by one: a scan that ends somewhere else, a body that lies elsewhere.
std::optional<WeldedSkin> weld_body(const Mesh &skin, const Mesh &body, const std::vector<std::uint8_t> &hidden);

/// The scan's vertices that triangles join to the body's; those before `first_body_vertex` are the scan's.
std::vector<int> weld_vertices(const Faces &faces, Eigen::Index first_body_vertex);

} // namespace doublet::detail
