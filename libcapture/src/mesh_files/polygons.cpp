// Polygons as triangles, and seams closed.

#include "mesh_parsing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace doublet::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kMostCorners = 1000; // of a polygon that is not convex: its time grows with the cube

double cross(const Vector2d &a, const Vector2d &b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A polygon in the plane that it lies in, counterclockwise.
std::vector<Vector2d> flattened(const std::vector<double> &coordinates, const std::vector<int> &polygon) {
  std::vector<Vector3d> points;
  for (int corner : polygon)
    points.emplace_back(coordinates.data() + 3 * static_cast<std::size_t>(corner));
  Vector3d normal = Vector3d::Zero(); // Newell's
  for (std::size_t k = 0; k < points.size(); ++k)
    normal += (points[k] - points[0]).cross(points[(k + 1) % points.size()] - points[0]);
  if (!(normal.norm() > 0))
    return {};
  const Vector3d x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
  std::vector<Vector2d> flat;
  for (const Vector3d &point : points)
    flat.emplace_back(x.dot(point - points[0]), y.dot(point - points[0]));
  return flat;
}

class EarClipping {
public:
  explicit EarClipping(const std::vector<Vector2d> &points) : points_(points) {
    double area = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      left_.push_back(k);
      area += cross(points[k], points[(k + 1) % points.size()]);
    }
    nothing_ = 1e-9 * area;
  }

  bool convex() const {
    for (std::size_t k = 0; k < left_.size(); ++k)
      if (turn(k) < -nothing_)
        return false;
    return true;
  }

  std::vector<std::size_t> triangles() {
    std::vector<std::size_t> result;
    while (left_.size() > 2) {
      const std::size_t k = ear();
      for (std::size_t corner : {before(k), left_[k], after(k)})
        result.push_back(corner);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(k));
    }
    return result;
  }

private:
  std::size_t before(std::size_t k) const { return left_[(k + left_.size() - 1) % left_.size()]; }
  std::size_t after(std::size_t k) const { return left_[(k + 1) % left_.size()]; }
  /// Twice the area of the triangle that a corner would be cut off with.
  double turn(std::size_t k) const {
    return cross(points_[left_[k]] - points_[before(k)], points_[after(k)] - points_[left_[k]]);
  }

  bool holds_another(std::size_t k) const {
    const std::array<std::size_t, 3> corners{before(k), left_[k], after(k)};
    for (std::size_t other : left_) {
      bool inside = true, is_corner = false;
      for (int side = 0; side < 3; ++side) {
        const Vector2d &a = points_[corners[side]], &b = points_[corners[(side + 1) % 3]];
        is_corner = is_corner || points_[other] == a;
        inside = inside && cross(b - a, points_[other] - a) > -nothing_;
      }
      if (inside && !is_corner)
        return true;
    }
    return false;
  }

  /// A corner that can be cut off; of a polygon that crosses itself any.
  std::size_t ear() const {
    std::size_t flat = left_.size();
    for (std::size_t k = 0; k < left_.size(); ++k) {
      if (turn(k) > nothing_ && !holds_another(k))
        return k;
      if (std::abs(turn(k)) <= nothing_)
        flat = k;
    }
    return flat < left_.size() ? flat : 0;
  }

  const std::vector<Vector2d> &points_;
  std::vector<std::size_t> left_;
  double nothing_ = 0;
};

} // namespace

std::vector<int> cut_polygon(const std::vector<double> &coordinates, const std::vector<int> &polygon) {
  const std::vector<Vector2d> flat = flattened(coordinates, polygon);
  if (flat.empty())
    return {};
  EarClipping clipping(flat);
  if (clipping.convex())
    return {};
  std::vector<int> corners;
  if (flat.size() <= kMostCorners)
    for (std::size_t k : clipping.triangles())
      corners.push_back(polygon[k]);
  else
    corners.push_back(-1);
  return corners;
}

Mesh GrowingMesh::mesh(const std::string &source) {
  for (const auto &[first, size] : polygons) {
    std::vector<int> polygon{corners[first]};
    for (std::size_t k = 1; k < size; ++k)
      polygon.push_back(k == 1 ? corners[first + 1] : corners[first + 3 * (k - 2) + 2]);
    const auto known = [&](int corner) { return corner >= 0 && static_cast<std::size_t>(corner) < coordinates.size() / 3; };
    if (!std::all_of(polygon.begin(), polygon.end(), known))
      continue; // refused later
    const std::vector<int> cut = cut_polygon(coordinates, polygon);
    if (cut.size() == 1)
      throw Error(source + ": expected polygons that are not convex to have at most " + std::to_string(kMostCorners) +
                  " corners, found one of " + std::to_string(size));
    std::copy(cut.begin(), cut.end(), corners.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return {Eigen::Map<const Vertices>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3),
          Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3)};
}

Mesh without_seams(const Mesh &mesh) {
  using Place = std::array<double, 3>;
  using Edge = std::pair<int, int>;
  const auto place = [&](int v) { return Place{mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}; };
  if ((mesh.faces.array() < 0).any() || (mesh.faces.array() >= mesh.vertices.rows()).any() || !mesh.vertices.allFinite())
    return mesh;            // refused later
  std::map<Edge, int> open; // directed edges without their opposite
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      const auto opposite = open.find({b, a});
      if (opposite == open.end())
        ++open[{a, b}];
      else if (--opposite->second == 0)
        open.erase(opposite);
    }
  std::map<std::pair<Place, Place>, Edge> by_place;
  for (const auto &[edge, count] : open)
    by_place.emplace(std::pair(place(edge.first), place(edge.second)), edge);
  std::vector<int> same(static_cast<std::size_t>(mesh.vertices.rows())); // union-find; the lowest index stays
  for (std::size_t v = 0; v < same.size(); ++v)
    same[v] = static_cast<int>(v);
  const auto root = [&](int v) {
    while (same[v] != v)
      v = same[v] = same[same[v]];
    return v;
  };
  const auto join = [&](int a, int b) {
    a = root(a), b = root(b);
    same[std::max(a, b)] = std::min(a, b);
  };
  bool any = false;
  for (const auto &[places, edge] : by_place)
    if (const auto other = by_place.find({places.second, places.first});
        other != by_place.end() && places.first != places.second) {
      join(edge.first, other->second.second);
      join(edge.second, other->second.first);
      any = true;
    }
  if (!any)
    return mesh;
  Mesh result{Vertices(mesh.vertices.rows(), 3), mesh.faces};
  std::vector<int> number(same.size(), -1);
  int count = 0;
  for (int v = 0; v < static_cast<int>(same.size()); ++v)
    if (root(v) == v) {
      result.vertices.row(count) = mesh.vertices.row(v);
      number[v] = count++;
    }
  result.vertices.conservativeResize(count, 3);
  for (Eigen::Index i = 0; i < result.faces.size(); ++i)
    result.faces.data()[i] = number[root(result.faces.data()[i])];
  return result;
}

} // namespace doublet::detail
