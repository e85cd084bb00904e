#pragma once

#include "doublet/core/mesh.h"

#include <gtest/gtest.h>

namespace doublet::testing {

/// In one piece, and no more than the mesh needs.
inline void expect_manifold(const Mesh &mesh) {
  const MeshReport report = report_mesh(mesh);
  EXPECT_EQ(report.non_manifold_edges + report.degenerate_faces + report.unused_vertices, 0) << report.to_string();
  EXPECT_EQ(report.components, 1);
}

} // namespace doublet::testing
