#include "scanned_laplacian.h"

namespace doublet {

std::vector<Triplet> scanned_laplacian(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid) {
  constexpr double kInvented = 1e-3; // share of an invented triangle
  std::vector<Triplet> entries;
  for (const bool valid : {false, true}) {
    std::vector<int> chosen;
    for (int f = 0; f < mesh.faces.rows(); ++f)
      if ((face_valid.empty() || face_valid[f] != 0) == valid)
        chosen.push_back(f);
    const Faces faces = mesh.faces(chosen, Eigen::all);
    if (faces.rows() == 0)
      continue;
    for (const Triplet &t : cotangent_laplacian(mesh.vertices, faces))
      entries.push_back({t.row, t.col, t.value * (valid ? 1.0 : kInvented)});
  }
  return entries;
}

} // namespace doublet
