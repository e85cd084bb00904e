#include "doublet/segment/parts/diffusion.h"

#include "doublet/core/parts/sparse_solve.h"
#include "doublet/options/options.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

/// Per component of `faces`: does it hold a known value?
std::vector<char> components_known(const Eigen::VectorXi &component, int count, const Eigen::VectorXd &values) {
  std::vector<char> known(count, 0);
  for (int i = 0; i < values.size(); ++i)
    if (component[i] >= 0 && std::isfinite(values[i]))
      known[component[i]] = 1;
  return known;
}

} // namespace

Eigen::VectorXd diffuse_on_surface(const Vertices &vertices, const Faces &faces, const Eigen::VectorXd &values, double length) {
  const int n = static_cast<int>(vertices.rows());
  if (values.size() != n)
    throw std::invalid_argument("diffuse_on_surface: expected " + std::to_string(n) + " values, one per vertex, found " +
                                std::to_string(values.size()));
  if (!(length >= 0))
    throw std::invalid_argument("diffuse_on_surface: length must be >= 0, found " + options::to_text(length));
  int count = 0;
  const Eigen::VectorXi component = vertex_components(faces, n, &count);
  const std::vector<char> known = components_known(component, count, values);
  const Eigen::VectorXd areas = vertex_areas(vertices, faces);
  const double mean_area = n > 0 ? areas.sum() / n : 0;
  // Unknown values need t > 0 to be reached; a thousandth of the mean area spreads the known ones by far less than an edge.
  const double t = std::max(length * length, 1e-3 * mean_area);

  std::vector<Eigen::Triplet<double>> triplets;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  auto solved = [&](int i) { return component[i] >= 0 && known[component[i]]; };
  auto couple = [&](int a, int b, double weight) {
    triplets.emplace_back(a, a, weight);
    triplets.emplace_back(a, b, -weight);
  };
  for (const Triplet &entry : cotangent_laplacian(vertices, faces))
    if (entry.row != entry.col && std::isfinite(entry.value) && solved(entry.row))
      couple(entry.row, entry.col, t * std::abs(entry.value));
  for (const Eigen::Vector2i &edge : edge_topology(faces).edges)
    if (solved(edge[0])) { // a trickle along every edge, where obtuse triangles clamp the cotangents to zero
      couple(edge[0], edge[1], 1e-6 * t);
      couple(edge[1], edge[0], 1e-6 * t);
    }
  for (int i = 0; i < n; ++i) {
    const double mass = !solved(i) ? 1.0 : std::isfinite(values[i]) ? std::max(areas[i], 1e-6 * mean_area) : 0.0;
    triplets.emplace_back(i, i, mass);
    right[i] = mass > 0 && std::isfinite(values[i]) ? mass * values[i] : 0.0;
  }
  Eigen::VectorXd result = solve_symmetric(triplets, right, "diffuse_on_surface: the diffusion over the mesh");
  for (int i = 0; i < n; ++i)
    if (!solved(i))
      result[i] = std::numeric_limits<double>::quiet_NaN();
  return result;
}

} // namespace doublet
