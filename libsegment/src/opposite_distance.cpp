#include "doublet/segment/opposite_distance.h"

#include "doublet/core/error.h"
#include "doublet/core/ray_scene.h"
#include "valid_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

void check_frames(const MeshSequence &sequence, const OppositePoints &points) {
  if (sequence.frames.size() < 2)
    throw std::invalid_argument("opposite_distance_deviation: expected at least 2 frames, found " +
                                std::to_string(sequence.frames.size()));
  for (std::size_t t = 0; t < sequence.frames.size(); ++t) {
    if (sequence.frames[t].rows() != points.face.size())
      throw std::invalid_argument("opposite_distance_deviation: frame " + std::to_string(t) + " has " +
                                  std::to_string(sequence.frames[t].rows()) + " vertices, expected " +
                                  std::to_string(points.face.size()));
    if (!sequence.frames[t].allFinite())
      throw Error("mesh sequence: frame " + std::to_string(t) + " holds vertices that are not finite");
  }
}

} // namespace

void OppositeOptions::validate() const {
  if (!(min_distance >= 0))
    throw std::invalid_argument("OppositeOptions: min_distance must be >= 0 m, found " + std::to_string(min_distance));
  if (!(min_cosine >= -1 && min_cosine < 1))
    throw std::invalid_argument("OppositeOptions: min_cosine must be in [-1, 1), found " + std::to_string(min_cosine));
  if (!(trim >= 0 && trim < 0.5))
    throw std::invalid_argument("OppositeOptions: trim must be in [0, 0.5), found " + std::to_string(trim));
}

OppositePoints find_opposite_points(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const OppositeOptions &options,
                                    const Context &context) {
  options.validate();
  require_usable(pose, "first frame of the mesh sequence");
  if (!face_valid.empty() && static_cast<long>(face_valid.size()) != pose.faces.rows())
    throw std::invalid_argument("face_valid: expected " + std::to_string(pose.faces.rows()) + " entries, one a face, found " +
                                std::to_string(face_valid.size()));
  const RayScene scene(pose);
  const Vertices normals = vertex_normals(pose.vertices, valid_faces(pose.faces, face_valid));
  const Vertices outward = face_normals(pose.vertices, pose.faces);
  const int n = static_cast<int>(pose.vertices.rows());
  OppositePoints points{Eigen::VectorXi::Constant(n, -1), Vertices::Zero(n, 3)};
  parallel_for(context, n, [&](int i) {
    const Eigen::Vector3d direction = -normals.row(i).transpose();
    if (direction.squaredNorm() < 0.5)
      return;
    const auto hit = scene.cast(pose.vertices.row(i).transpose(), direction, options.min_distance);
    if (!hit || (!face_valid.empty() && !face_valid[hit->face]) || outward.row(hit->face).dot(direction) < options.min_cosine)
      return;
    points.face[i] = hit->face;
    points.barycentric.row(i) = hit->barycentric.transpose();
  });
  return points;
}

Eigen::VectorXd opposite_distance_deviation(const MeshSequence &sequence, const OppositePoints &points,
                                            const OppositeOptions &options, const Context &context) {
  options.validate();
  check_frames(sequence, points);
  const int n = static_cast<int>(points.face.size());
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  parallel_for(context, n, [&](int i) {
    if (points.face[i] < 0)
      return;
    const Eigen::Vector3i corners = sequence.faces.row(points.face[i]).transpose();
    std::vector<double> distances;
    distances.reserve(sequence.frames.size());
    for (const Vertices &frame : sequence.frames) {
      Eigen::RowVector3d opposite = Eigen::RowVector3d::Zero();
      for (int k = 0; k < 3; ++k)
        opposite += points.barycentric(i, k) * frame.row(corners[k]);
      distances.push_back((frame.row(i) - opposite).norm());
    }
    sigma[i] = trimmed_deviation(distances, options.trim);
  });
  return sigma;
}

} // namespace doublet
