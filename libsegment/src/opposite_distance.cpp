#include "doublet/segment/opposite_distance.h"

#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

double trimmed_deviation(std::vector<double> &distances, double trim) {
  std::sort(distances.begin(), distances.end());
  const int n = static_cast<int>(distances.size());
  const int cut = std::min(static_cast<int>(trim * n), (n - 2) / 2);
  double sum = 0, squares = 0;
  for (int i = cut; i < n - cut; ++i)
    sum += distances[i];
  const double mean = sum / (n - 2 * cut);
  for (int i = cut; i < n - cut; ++i)
    squares += (distances[i] - mean) * (distances[i] - mean);
  return std::sqrt(squares / (n - 2 * cut));
}

double ray_deviation(const MeshSequence &sequence, int vertex, const OppositePoints &points, int ray, double trim) {
  const Eigen::RowVector3i corners = sequence.faces.row(points.face[ray]);
  std::vector<double> distances;
  distances.reserve(sequence.frames.size());
  for (const Vertices &frame : sequence.frames) {
    Eigen::RowVector3d opposite = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k)
      opposite += points.barycentric(ray, k) * frame.row(corners[k]);
    distances.push_back((frame.row(vertex) - opposite).norm());
  }
  return trimmed_deviation(distances, trim);
}

/// Ray k of a vertex: k = 0 along -n, the others on a cone around it, counted from an edge of the mesh so that they turn with it.
Eigen::Vector3d ray_direction(const Eigen::Vector3d &inward, const Eigen::Vector3d &edge, int k, int rays, double cone) {
  const Eigen::Vector3d tangent = edge - edge.dot(inward) * inward;
  if (k == 0 || tangent.norm() < 1e-12)
    return inward;
  const Eigen::Vector3d u = tangent.normalized(), w = inward.cross(u);
  const double phi = 2 * std::numbers::pi * k / (rays - 1);
  return std::cos(cone) * inward + std::sin(cone) * (std::cos(phi) * u + std::sin(phi) * w);
}

void check_frames(const MeshSequence &sequence, const OppositePoints &points) {
  if (sequence.frames.size() < 2)
    throw std::invalid_argument("opposite_distance_deviation: expected at least 2 frames, found " +
                                std::to_string(sequence.frames.size()));
  for (std::size_t t = 0; t < sequence.frames.size(); ++t) {
    if (sequence.frames[t].rows() * points.rays != points.face.size())
      throw std::invalid_argument("opposite_distance_deviation: frame " + std::to_string(t) + " has " +
                                  std::to_string(sequence.frames[t].rows()) + " vertices, expected " +
                                  std::to_string(points.face.size() / points.rays));
    if (!sequence.frames[t].allFinite())
      throw Error("mesh sequence: frame " + std::to_string(t) + " holds vertices that are not finite");
  }
}

} // namespace

OppositePoints find_opposite_points(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const OppositeOptions &options,
                                    const Context &context) {
  options.validate();
  require_usable(pose, "first frame of the mesh sequence");
  if (!face_valid.empty() && static_cast<long>(face_valid.size()) != pose.faces.rows())
    throw std::invalid_argument("face_valid: expected " + std::to_string(pose.faces.rows()) + " entries, one per face, found " +
                                std::to_string(face_valid.size()));
  const RayScene scene(pose);
  const Faces valid = valid_faces(pose.faces, face_valid);
  const Vertices normals = vertex_normals(pose.vertices, valid), outward = face_normals(pose.vertices, pose.faces);
  const std::vector<std::vector<int>> neighbours = vertex_neighbours(valid, static_cast<int>(pose.vertices.rows()));
  const int n = static_cast<int>(pose.vertices.rows()), rays = options.rays;
  OppositePoints points{rays, Eigen::VectorXi::Constant(n * rays, -1), Vertices::Zero(n * rays, 3)};
  parallel_for(context, n, [&](int i) {
    const Eigen::Vector3d origin = pose.vertices.row(i), inward = -normals.row(i).transpose();
    if (inward.squaredNorm() < 0.5 || neighbours[i].empty())
      return;
    const Eigen::Vector3d edge = pose.vertices.row(neighbours[i][0]).transpose() - origin;
    for (int k = 0; k < rays; ++k) {
      const Eigen::Vector3d direction = ray_direction(inward, edge, k, rays, options.cone);
      const auto hit = scene.cast(origin, direction, options.min_distance);
      if (!hit || (!face_valid.empty() && !face_valid[hit->face]) || outward.row(hit->face).dot(direction) < options.min_cosine)
        continue;
      points.face[i * rays + k] = hit->face;
      points.barycentric.row(i * rays + k) = hit->barycentric.transpose();
    }
  });
  return points;
}

Eigen::VectorXd opposite_distance_deviation(const MeshSequence &sequence, const OppositePoints &points,
                                            const OppositeOptions &options, const Context &context) {
  options.validate();
  check_frames(sequence, points);
  const int n = static_cast<int>(points.face.size()) / points.rays;
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  parallel_for(context, n, [&](int i) {
    std::vector<double> deviations;
    for (int ray = i * points.rays; ray < (i + 1) * points.rays; ++ray)
      if (points.face[ray] >= 0)
        deviations.push_back(ray_deviation(sequence, i, points, ray, options.trim));
    const std::size_t middle = deviations.size() / 2;
    if (2 * static_cast<int>(deviations.size()) < points.rays)
      return;
    std::nth_element(deviations.begin(), deviations.begin() + middle, deviations.end());
    sigma[i] = deviations[middle];
  });
  return sigma;
}

} // namespace doublet
