#include "doublet/core/parts/face_neighbours.h"

namespace doublet {

std::vector<std::vector<int>> face_neighbours(const Faces &faces) {
  std::vector<std::vector<int>> beside(static_cast<std::size_t>(faces.rows()));
  for (const Eigen::Vector2i &pair : edge_topology(faces).edge_faces)
    if (pair.minCoeff() >= 0) {
      beside[pair[0]].push_back(pair[1]);
      beside[pair[1]].push_back(pair[0]);
    }
  return beside;
}

} // namespace doublet
