#include "doublet/animate/parts/surface_transfer.h"

#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr int kTriangles = 8; // per fine vertex: the closest one and the ring around it, as far as it counts

struct Frame {
  Vector3d origin, u, v, normal;
};

Frame frame_of(const Vertices &vertices, const Faces &faces, int f) {
  Frame frame;
  frame.origin = vertices.row(faces(f, 0));
  frame.u = Vector3d(vertices.row(faces(f, 1))) - frame.origin;
  frame.v = Vector3d(vertices.row(faces(f, 2))) - frame.origin;
  const Vector3d n = frame.u.cross(frame.v);
  frame.normal = n.norm() > 0 ? Vector3d(n.normalized()) : Vector3d::Zero();
  return frame;
}

/// Solves p = origin + u a + v b + h normal.
Vector3d local_coordinates(const Frame &frame, const Vector3d &p) {
  Eigen::Matrix3d axes;
  axes << frame.u, frame.v, frame.normal;
  return axes.inverse() * (p - frame.origin);
}

std::vector<std::vector<int>> faces_at_vertices(const Faces &faces, int vertices, const std::vector<std::uint8_t> &valid) {
  std::vector<std::vector<int>> result(vertices);
  for (int f = 0; f < faces.rows(); ++f)
    if (valid[f])
      for (int k = 0; k < 3; ++k)
        result[faces(f, k)].push_back(f);
  return result;
}

/// One a face: all of them, where none are given.
std::vector<std::uint8_t> one_a_face(const std::vector<std::uint8_t> &valid, Eigen::Index faces, const std::string &what) {
  if (!valid.empty() && static_cast<Eigen::Index>(valid.size()) != faces)
    throw Error("SurfaceTransfer: " + what + " has " + std::to_string(valid.size()) + " entries, expected " +
                std::to_string(faces));
  return valid.empty() ? std::vector<std::uint8_t>(faces, 1) : valid;
}

/// Triangles that are too thin have no usable frame.
void take_out_slivers(const Mesh &mesh, std::vector<std::uint8_t> &valid) {
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const Frame frame = frame_of(mesh.vertices, mesh.faces, f);
    const double longest = std::max({frame.u.norm(), frame.v.norm(), (frame.u - frame.v).norm()});
    if (!(frame.u.cross(frame.v).norm() > 0.02 * longest * longest))
      valid[f] = 0;
  }
}

} // namespace

SurfaceTransfer::SurfaceTransfer(const Mesh &coarse, const std::vector<std::uint8_t> &coarse_valid, const Mesh &fine,
                                 const std::vector<std::uint8_t> &fine_valid)
    : coarse_faces_(coarse.faces), coarse_vertices_(static_cast<int>(coarse.vertices.rows())) {
  require_usable(coarse, "coarse mesh");
  require_usable(fine, "fine mesh");
  std::vector<std::uint8_t> valid = one_a_face(coarse_valid, coarse.faces.rows(), "coarse_valid");
  const std::vector<std::uint8_t> drawn = one_a_face(fine_valid, fine.faces.rows(), "fine_valid");
  std::vector<std::uint8_t> whole(coarse.faces.rows(), 1);
  take_out_slivers(coarse, valid);
  take_out_slivers(coarse, whole);
  if (std::all_of(valid.begin(), valid.end(), [](std::uint8_t v) { return v == 0; }))
    throw Error("SurfaceTransfer: expected valid triangles with an area in the coarse mesh, found none");
  std::vector<bool> shown(fine.vertices.rows(), false);
  for (int f = 0; f < fine.faces.rows(); ++f)
    if (drawn[f])
      for (int k = 0; k < 3; ++k)
        shown[fine.faces(f, k)] = true;

  const RayScene valid_scene(coarse, valid), whole_scene(coarse, whole);
  const auto valid_ring = faces_at_vertices(coarse.faces, coarse_vertices_, valid);
  const auto whole_ring = faces_at_vertices(coarse.faces, coarse_vertices_, whole);
  const double edge = mean_edge_length(coarse.vertices, coarse.faces);
  closest_.resize(fine.vertices.rows(), 3);
  first_.push_back(0);
  std::vector<std::pair<double, int>> near;
  for (Eigen::Index i = 0; i < fine.vertices.rows(); ++i) {
    const Vector3d p = fine.vertices.row(i);
    const ClosestPoint hit = (shown[i] ? valid_scene : whole_scene).closest(p);
    closest_face_.push_back(hit.face);
    closest_.row(i) = hit.barycentric;
    const Vector3d normal = frame_of(coarse.vertices, coarse.faces, hit.face).normal;
    near.clear();
    for (int k = 0; k < 3; ++k)
      for (int f : (shown[i] ? valid_ring : whole_ring)[coarse.faces(hit.face, k)]) {
        const Frame frame = frame_of(coarse.vertices, coarse.faces, f);
        const Vector3d centre = frame.origin + (frame.u + frame.v) / 3;
        // Gaussian in the distance, over the mean edge; triangles that turn away from the closest one count less.
        const double d = (p - centre).norm() / edge;
        near.emplace_back(-std::exp(-d * d) * std::max(0.05, frame.normal.dot(normal)), f);
      }
    std::sort(near.begin(), near.end(), [](const auto &a, const auto &b) { return a.second < b.second; });
    near.erase(std::unique(near.begin(), near.end(), [](const auto &a, const auto &b) { return a.second == b.second; }),
               near.end());
    std::sort(near.begin(), near.end());
    near.resize(std::min<std::size_t>(near.size(), kTriangles));
    double sum = 0;
    for (const auto &entry : near)
      sum -= entry.first;
    for (const auto &[weight, f] : near) {
      const double share = sum > 1e-30 ? -weight / sum : 1.0 / near.size();
      bindings_.push_back(
          {f, static_cast<float>(share), local_coordinates(frame_of(coarse.vertices, coarse.faces, f), p).cast<float>()});
    }
    first_.push_back(static_cast<int>(bindings_.size()));
  }
}

Vertices SurfaceTransfer::apply(const Vertices &coarse) const {
  if (coarse.rows() != coarse_vertices_)
    throw std::invalid_argument("SurfaceTransfer::apply: coarse has " + std::to_string(coarse.rows()) + " vertices, expected " +
                                std::to_string(coarse_vertices_));
  if (!coarse.allFinite())
    throw std::invalid_argument("SurfaceTransfer::apply: coarse: expected finite positions, found NaN or infinity");
  std::vector<Frame> frames(coarse_faces_.rows());
  for (int f = 0; f < coarse_faces_.rows(); ++f)
    frames[f] = frame_of(coarse, coarse_faces_, f);
  Vertices fine(first_.size() - 1, 3);
  for (Eigen::Index i = 0; i < fine.rows(); ++i) {
    Vector3d sum = Vector3d::Zero();
    double weights = 0; // stored as float: divided out again, so that a translation carries over exactly
    for (int b = first_[i]; b < first_[i + 1]; ++b) {
      const Binding &binding = bindings_[b];
      const Frame &frame = frames[binding.face];
      sum += binding.weight *
             (frame.origin + binding.local[0] * frame.u + binding.local[1] * frame.v + binding.local[2] * frame.normal);
      weights += binding.weight;
    }
    fine.row(i) = sum / weights;
  }
  return fine;
}

MatrixRM SurfaceTransfer::sample(const MatrixRM &coarse_values) const {
  if (coarse_values.rows() != coarse_vertices_)
    throw std::invalid_argument("SurfaceTransfer::sample: coarse_values has " + std::to_string(coarse_values.rows()) +
                                " rows, expected " + std::to_string(coarse_vertices_));
  MatrixRM result(closest_.rows(), coarse_values.cols());
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    result.row(i).setZero();
    for (int k = 0; k < 3; ++k)
      result.row(i) += closest_(i, k) * coarse_values.row(coarse_faces_(closest_face_[i], k));
  }
  return result;
}

} // namespace doublet
