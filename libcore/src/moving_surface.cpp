#include "doublet/core/parts/moving_surface.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

using Eigen::Vector3d;

constexpr double kFarthest = 1e15; // m, of a coordinate: squares of distances are floats
// Boxes and the point are rounded to float: a box may seem to be so much further away than it is, by the largest coordinate.
constexpr double kRounding = 8 * std::numeric_limits<float>::epsilon();
constexpr int kDeepest = 16;                                     // levels: 4^16 faces
constexpr float kNever = std::numeric_limits<float>::infinity(); // from which an empty box begins, to which it goes on

/// The squared distance of a point to four boxes.
Eigen::Array4f squared_distances(const Eigen::Array3f &p, const std::array<Eigen::Array4f, 3> &low,
                                 const std::array<Eigen::Array4f, 3> &high) {
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (int axis = 0; axis < 3; ++axis)
    sum += (low[axis] - p[axis]).max(p[axis] - high[axis]).max(0.0f).square();
  return sum;
}

/// Halves the faces order[first, last) at the median of their centres, across the longest side of the box of those; where the
/// upper half begins.
int halve(int first, int last, const Vertices &centres, std::vector<int> &order) {
  Eigen::RowVector3d low = centres.row(order[first]), high = low;
  for (int i = first; i < last; ++i) {
    low = low.cwiseMin(centres.row(order[i]));
    high = high.cwiseMax(centres.row(order[i]));
  }
  Eigen::Index axis;
  (high - low).maxCoeff(&axis);
  const int middle = (first + last + 1) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, [&](int a, int b) {
    return centres(a, axis) != centres(b, axis) ? centres(a, axis) < centres(b, axis) : a < b;
  });
  return middle;
}

} // namespace

MovingSurface::MovingSurface(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid)
    : vertices_(mesh.vertices.rows(), 3), faces_(mesh.faces), valid_(face_valid) {
  require_usable(mesh, "MovingSurface");
  if (valid_.empty())
    valid_.assign(mesh.faces.rows(), 1);
  if (static_cast<Eigen::Index>(valid_.size()) != mesh.faces.rows())
    throw std::invalid_argument("MovingSurface: expected " + std::to_string(mesh.faces.rows()) +
                                " entries in face_valid, found " + std::to_string(valid_.size()));
  std::vector<int> order;
  Vertices centres(mesh.faces.rows(), 3);
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    centres.row(f) = (mesh.vertices.row(faces_(f, 0)) + mesh.vertices.row(faces_(f, 1)) + mesh.vertices.row(faces_(f, 2))) / 3;
    if (valid_[f])
      order.push_back(f);
  }
  if (order.empty())
    throw Error("MovingSurface: all " + std::to_string(mesh.faces.rows()) + " faces are invalid");
  add(0, static_cast<int>(order.size()), centres, order);
  move_to(mesh.vertices);
}

/// A node over the faces order[first, last), quartered.
int MovingSurface::add(int first, int last, const Vertices &centres, std::vector<int> &order) {
  const int node = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  std::array<int, 5> cuts{first, first, last, last, last};
  cuts[2] = halve(first, last, centres, order);
  cuts[1] = halve(first, cuts[2], centres, order);
  cuts[3] = cuts[2] < last ? halve(cuts[2], last, centres, order) : last;
  for (int k = 0; k < 4; ++k) {
    const int count = cuts[k + 1] - cuts[k];
    const int child = count > 1 ? add(cuts[k], cuts[k + 1], centres, order) : count == 1 ? ~order[cuts[k]] : 0;
    nodes_[node].child[k] = child;
  }
  return node;
}

void MovingSurface::fit() {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node)
    for (int k = 0; k < 4; ++k) {
      Eigen::Array3f low = Eigen::Array3f::Constant(kNever), high = -low;
      if (const int child = node->child[k]; child > 0) {
        for (int axis = 0; axis < 3; ++axis) {
          low[axis] = nodes_[child].low[axis].minCoeff();
          high[axis] = nodes_[child].high[axis].maxCoeff();
        }
      } else if (child < 0) {
        for (int corner = 0; corner < 3; ++corner) {
          const Eigen::Array3f at = vertices_.row(faces_(~child, corner)).transpose().array().cast<float>();
          low = low.min(at);
          high = high.max(at);
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        node->low[axis][k] = low[axis];
        node->high[axis][k] = high[axis];
      }
    }
}

void MovingSurface::move_to(const Vertices &vertices) {
  if (vertices.rows() != vertices_.rows())
    throw std::invalid_argument("MovingSurface: expected " + std::to_string(vertices_.rows()) + " vertices, found " +
                                std::to_string(vertices.rows()));
  const double largest = vertices.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  if (!(largest <= kFarthest))
    throw std::invalid_argument("MovingSurface: expected finite vertices, found NaN, infinity or more than 1e15 m");
  vertices_ = vertices;
  largest_ = largest;
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
  const double farthest = point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  if (!(farthest <= kFarthest) || !(within > 0))
    throw std::invalid_argument("MovingSurface: expected a point within 1e15 m and a distance above 0");
  if (hint >= static_cast<int>(valid_.size()) || (hint >= 0 && !valid_[hint]))
    throw std::invalid_argument("MovingSurface: expected the hint to be a valid face, found " + std::to_string(hint));
  Point best{-1, Vector3d::Zero(), Vector3d::Zero(), within};
  if (hint >= 0)
    try_face(hint, point, best);
  const Eigen::Array3f p = point.array().cast<float>();
  const double slack = kRounding * (1 + farthest + largest_);
  const auto reach_of = [slack](double distance) { // squared, rounded up
    const double reach = distance + slack;
    return static_cast<float>(reach * reach * (1 + kRounding));
  };
  float reach = reach_of(best.distance);
  struct Open {
    int node;
    float distance; ///< squared, of its box
  };
  std::array<Open, 3 * kDeepest + 1> open; // nodes to look into, the nearest of each four last
  int count = 0;
  open[count++] = {0, 0};
  while (count > 0) {
    const auto [at, box] = open[--count];
    if (!(box < reach))
      continue;
    const Node &node = nodes_[at];
    const Eigen::Array4f distances = squared_distances(p, node.low, node.high);
    if (!(distances < reach).any())
      continue;
    const int first = count;
    for (int k = 0; k < 4; ++k) {
      if (!(distances[k] < reach))
        continue;
      if (node.child[k] < 0) {
        try_face(~node.child[k], point, best);
        reach = reach_of(best.distance);
        continue;
      }
      int place = count++;
      for (; place > first && open[place - 1].distance < distances[k]; --place)
        open[place] = open[place - 1];
      open[place] = {node.child[k], distances[k]};
    }
  }
  return best.face < 0 ? std::nullopt : std::optional<Point>(best);
}

} // namespace doublet
