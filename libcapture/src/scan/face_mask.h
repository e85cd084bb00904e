#pragma once
#include "doublet/core/mesh.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::detail {

/// Throws std::invalid_argument naming the mask unless it has one value a face.
inline void expect_mask(const std::vector<std::uint8_t> &mask, const Mesh &mesh, const std::string &name) {
  if (static_cast<Eigen::Index>(mask.size()) != mesh.faces.rows())
    throw std::invalid_argument(name + ": expected one value for each of " + std::to_string(mesh.faces.rows()) +
                                " triangles, found " + std::to_string(mask.size()));
}

} // namespace doublet::detail
