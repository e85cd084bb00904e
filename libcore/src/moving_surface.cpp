#include "doublet/core/parts/moving_surface.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr int kLeaf = 4;               // faces
constexpr double kRounding = 1 + 1e-9; // of a distance to a box, so that no face is missed that is as near as the best

/// Of a point to a box. Without max(), which is a jump in WebAssembly: x + |x| is 2 max(x, 0), exactly, and of the two ways out
/// of the box along an axis one is 0.
double squared_distance(const Vector3d &p, const Eigen::Array3d &low, const Eigen::Array3d &high) {
  const Eigen::Array3d below = low - p.array(), above = p.array() - high;
  return 0.25 * ((below + below.abs()) + (above + above.abs())).matrix().squaredNorm();
}

} // namespace

MovingSurface::MovingSurface(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid)
    : vertices_(mesh.vertices), faces_(mesh.faces), valid_(face_valid) {
  require_usable(mesh, "MovingSurface");
  if (valid_.empty())
    valid_.assign(mesh.faces.rows(), 1);
  if (static_cast<Eigen::Index>(valid_.size()) != mesh.faces.rows())
    throw std::invalid_argument("MovingSurface: expected " + std::to_string(mesh.faces.rows()) +
                                " entries in face_valid, found " + std::to_string(valid_.size()));
  Vertices centres(mesh.faces.rows(), 3);
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    centres.row(f) = (vertices_.row(faces_(f, 0)) + vertices_.row(faces_(f, 1)) + vertices_.row(faces_(f, 2))) / 3;
    if (valid_[f])
      order_.push_back(f);
  }
  if (order_.empty())
    throw Error("MovingSurface: all " + std::to_string(mesh.faces.rows()) + " faces are invalid");
  add(0, static_cast<int>(order_.size()), centres);
  fit();
}

/// Faces order_[first, last): halved at the median of their centres, across the longest side of the box of those.
void MovingSurface::add(int first, int last, const Vertices &centres) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  if (last - first <= kLeaf) {
    nodes_[node].first = first;
    nodes_[node].last = last;
  } else {
    Eigen::RowVector3d low = centres.row(order_[first]), high = low;
    for (int i = first; i < last; ++i) {
      low = low.cwiseMin(centres.row(order_[i]));
      high = high.cwiseMax(centres.row(order_[i]));
    }
    Eigen::Index axis;
    (high - low).maxCoeff(&axis);
    const int middle = (first + last) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](int a, int b) {
      return centres(a, axis) != centres(b, axis) ? centres(a, axis) < centres(b, axis) : a < b;
    });
    add(first, middle, centres);
    add(middle, last, centres);
  }
  nodes_[node].skip = static_cast<int>(nodes_.size());
}

void MovingSurface::fit() {
  for (int n = static_cast<int>(nodes_.size()) - 1; n >= 0; --n) {
    Node &node = nodes_[n];
    if (node.last == 0) {
      const Node &left = nodes_[n + 1], &right = nodes_[left.skip];
      node.low = left.low.min(right.low);
      node.high = left.high.max(right.high);
      continue;
    }
    node.low = node.high = vertices_.row(faces_(order_[node.first], 0)).transpose().array();
    for (int i = node.first; i < node.last; ++i)
      for (int k = 0; k < 3; ++k) {
        const Eigen::Array3d corner = vertices_.row(faces_(order_[i], k)).transpose().array();
        node.low = node.low.min(corner);
        node.high = node.high.max(corner);
      }
  }
}

void MovingSurface::move_to(const Vertices &vertices) {
  if (vertices.rows() != vertices_.rows())
    throw std::invalid_argument("MovingSurface: expected " + std::to_string(vertices_.rows()) + " vertices, found " +
                                std::to_string(vertices.rows()));
  if (!vertices.allFinite())
    throw std::invalid_argument("MovingSurface: expected finite vertices, found NaN or infinity");
  vertices_ = vertices;
  fit();
}

void MovingSurface::try_face(int face, const Vector3d &p, Point &best) const {
  const Vector3d a = vertices_.row(faces_(face, 0)), b = vertices_.row(faces_(face, 1)), c = vertices_.row(faces_(face, 2));
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const Vector3d bary = closest_on_triangle(ab.dot(ap), ac.dot(ap), ab.dot(bp), ac.dot(bp), ab.dot(cp), ac.dot(cp));
  const Vector3d at = bary[0] * a + bary[1] * b + bary[2] * c;
  const double distance = (at - p).norm();
  if (distance < best.distance || (distance == best.distance && face < best.face))
    best = {face, at, bary, distance};
}

std::optional<MovingSurface::Point> MovingSurface::closest(const Vector3d &point, double within, int hint) const {
  if (!point.allFinite() || !(within > 0))
    throw std::invalid_argument("MovingSurface: expected a finite point and a distance above 0");
  if (hint >= static_cast<int>(valid_.size()) || (hint >= 0 && !valid_[hint]))
    throw std::invalid_argument("MovingSurface: expected the hint to be a valid face, found " + std::to_string(hint));
  Point best{-1, Vector3d::Zero(), Vector3d::Zero(), within};
  if (hint >= 0)
    try_face(hint, point, best);
  for (int n = 0; n < static_cast<int>(nodes_.size());) {
    const Node &node = nodes_[n];
    if (squared_distance(point, node.low, node.high) > best.distance * best.distance * kRounding) {
      n = node.skip;
      continue;
    }
    for (int i = node.first; i < node.last; ++i)
      try_face(order_[i], point, best);
    ++n;
  }
  return best.face < 0 ? std::nullopt : std::optional<Point>(best);
}

} // namespace doublet
