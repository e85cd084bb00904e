#include "doublet/animate/surface_transfer.h"

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

void multiply(const SparseRows &weights, const PaddedRows &rows, Eigen::Ref<Vertices> out) {
  if (weights.cols() != rows.rows() || weights.rows() != out.rows())
    throw std::invalid_argument("multiply: expected (" + std::to_string(out.rows()) + ", " + std::to_string(rows.rows()) +
                                ") weights, found (" + std::to_string(weights.rows()) + ", " + std::to_string(weights.cols()) +
                                ")");
  const int *first = weights.outerIndexPtr(), *column = weights.innerIndexPtr();
  const double *weight = weights.valuePtr();
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = first[i]; k < first[i + 1]; ++k)
      sum += weight[k] * rows.row(column[k]).transpose();
    out.row(i) = sum.head<3>();
  }
}

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
  std::vector<Eigen::Triplet<double>> weights;
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
      const Vector3d local = local_coordinates(frame_of(coarse.vertices, coarse.faces, f), p);
      const int row = static_cast<int>(i);
      weights.emplace_back(row, coarse.faces(f, 0), share * (1 - local[0] - local[1]));
      weights.emplace_back(row, coarse.faces(f, 1), share * local[0]);
      weights.emplace_back(row, coarse.faces(f, 2), share * local[1]);
      weights.emplace_back(row, coarse_vertices_ + f, share * local[2]);
    }
  }
  weights_.resize(fine.vertices.rows(), coarse_vertices_ + coarse.faces.rows());
  weights_.setFromTriplets(weights.begin(), weights.end());
}

Vertices SurfaceTransfer::apply(const Vertices &coarse) const {
  Vertices fine(weights_.rows(), 3);
  PaddedRows buffer;
  apply(coarse, fine, buffer);
  return fine;
}

void SurfaceTransfer::apply(const Vertices &coarse, Eigen::Ref<Vertices> fine, PaddedRows &buffer) const {
  if (coarse.rows() != coarse_vertices_)
    throw std::invalid_argument("SurfaceTransfer::apply: coarse has " + std::to_string(coarse.rows()) + " vertices, expected " +
                                std::to_string(coarse_vertices_));
  if (fine.rows() != weights_.rows())
    throw std::invalid_argument("SurfaceTransfer::apply: fine has " + std::to_string(fine.rows()) + " rows, expected " +
                                std::to_string(weights_.rows()));
  if (!coarse.allFinite())
    throw std::invalid_argument("SurfaceTransfer::apply: coarse: expected finite positions, found NaN or infinity");
  buffer.resize(weights_.cols(), 4);
  for (int v = 0; v < coarse_vertices_; ++v)
    buffer.row(v) << coarse(v, 0), coarse(v, 1), coarse(v, 2), 0;
  for (int f = 0; f < coarse_faces_.rows(); ++f) {
    const Vector3d normal = frame_of(coarse, coarse_faces_, f).normal;
    buffer.row(coarse_vertices_ + f) << normal[0], normal[1], normal[2], 0;
  }
  multiply(weights_, buffer, fine);
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
