#include "texture_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <stdexcept>
#include <unordered_set>

namespace doublet::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFacing = 0.5;     // cosine between a face and the way its chart is seen: flattened, it keeps half its area
constexpr int kBorder = 2;          // pixels around a chart that have its colours, for bilinear sampling
constexpr double kFirstFill = 0.75; // share of the image that the surface would cover if charts were without gaps
constexpr double kShrink = 0.97;    // of the scale, until the charts fit

using Triangle = std::array<Vector2d, 3>;

struct Chart {
  std::vector<int> faces;
  Vector3d across, up; ///< of the plane it is flattened onto
  Vector2d low, high;  ///< m, on that plane
  int x = 0, y = 0;    ///< of its first pixel in the image, border included
};

Vector2d flattened(const Chart &chart, const Mesh &mesh, int vertex) {
  const Vector3d p = mesh.vertices.row(vertex);
  return {chart.across.dot(p), chart.up.dot(p)};
}

/// Calls visit(x, y, barycentric coordinates) for the pixels whose centre is in the triangle.
template <class Visit> void for_pixels(const Triangle &t, const Visit &visit) {
  const Vector2d ab = t[1] - t[0], ac = t[2] - t[0];
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (!(std::abs(area) > 1e-12))
    return;
  const auto [left, right] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
  const auto [low, high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
  for (int y = static_cast<int>(std::floor(low)); y <= static_cast<int>(high); ++y)
    for (int x = static_cast<int>(std::floor(left)); x <= static_cast<int>(right); ++x) {
      const Vector2d p = Vector2d(x + 0.5, y + 0.5) - t[0];
      const double b = (p.x() * ac.y() - p.y() * ac.x()) / area, c = (ab.x() * p.y() - ab.y() * p.x()) / area;
      if (b >= 0 && c >= 0 && b + c <= 1)
        visit(x, y, Vector3d(1 - b - c, b, c));
    }
}

/// Grows charts from face to face.
class Grower {
public:
  /// `pixel`: m, of the grid on which a chart must not lie over itself.
  Grower(const Mesh &mesh, const std::vector<std::uint8_t> &shown, double pixel)
      : mesh_(mesh), normals_(face_normals(mesh.vertices, mesh.faces)), beside_(mesh.faces.rows()), pixel_(pixel),
        open_(mesh.faces.rows(), 1) {
    for (std::size_t f = 0; f < open_.size(); ++f)
      open_[f] = shown.empty() || shown[f];
    for (const Eigen::Vector2i &pair : edge_topology(mesh.faces).edge_faces)
      if (pair[1] >= 0 && open_[pair[0]] && open_[pair[1]]) {
        beside_[pair[0]].push_back(pair[1]);
        beside_[pair[1]].push_back(pair[0]);
      }
  }

  std::vector<Chart> grow() {
    std::vector<Chart> charts;
    const std::vector<Vector3d> sides = main_sides();
    for (int f = 0; f < mesh_.faces.rows(); ++f)
      if (open_[f])
        charts.push_back(grown_from(f, sides[f]));
    return charts;
  }

private:
  /// [F] of the six sides of a box the one that a face shows most, like its surroundings where it hardly matters: the borders
  /// between them are smooth.
  std::vector<Vector3d> main_sides() const {
    constexpr int kRounds = 8;
    std::vector<Vector3d> smooth(mesh_.faces.rows());
    for (std::size_t f = 0; f < smooth.size(); ++f)
      smooth[f] = normals_.row(f);
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Vector3d> before = smooth;
      for (std::size_t f = 0; f < smooth.size(); ++f)
        for (int g : beside_[f])
          smooth[f] += before[g];
      for (Vector3d &normal : smooth)
        if (normal.norm() > 0)
          normal.normalize();
    }
    for (std::size_t f = 0; f < smooth.size(); ++f) {
      const Vector3d side = along_axis(smooth[f]);
      smooth[f] = normals_.row(f).dot(side) > kFacing ? side : along_axis(normals_.row(f));
    }
    return smooth;
  }

  static Vector3d along_axis(const Vector3d &normal) {
    Eigen::Index axis;
    normal.cwiseAbs().maxCoeff(&axis);
    return (normal[axis] < 0 ? -1 : 1) * Vector3d::Unit(axis);
  }

  Chart grown_from(int seed, const Vector3d &side) {
    Chart chart;
    const Vector3d above = std::abs(side.y()) < 0.5 ? Vector3d::UnitY() : Vector3d::UnitZ();
    chart.across = above.cross(side);
    chart.up = -above; // images begin at the top
    taken_.clear();
    std::queue<int> front;
    const auto take = [&](int f) {
      if (!open_[f] || (f != seed && !(normals_.row(f).dot(side) > kFacing)) || !claims(chart, f))
        return;
      open_[f] = 0;
      chart.faces.push_back(f);
      front.push(f);
    };
    for (take(seed); !front.empty(); front.pop())
      for (int g : beside_[front.front()])
        take(g);
    chart.low = Vector2d::Constant(1e30);
    chart.high = -chart.low;
    for (int f : chart.faces)
      for (int k = 0; k < 3; ++k) {
        const Vector2d p = flattened(chart, mesh_, mesh_.faces(f, k));
        chart.low = chart.low.cwiseMin(p);
        chart.high = chart.high.cwiseMax(p);
      }
    return chart;
  }

  /// Are the pixels under the face free? Then they are its own.
  bool claims(const Chart &chart, int f) {
    Triangle t;
    for (int k = 0; k < 3; ++k)
      t[k] = flattened(chart, mesh_, mesh_.faces(f, k)) / pixel_;
    std::vector<std::int64_t> under;
    bool is_free = true;
    for_pixels(t, [&](int x, int y, const Vector3d &) {
      under.push_back((static_cast<std::int64_t>(x) << 32) + y);
      is_free &= taken_.count(under.back()) == 0;
    });
    if (is_free)
      taken_.insert(under.begin(), under.end());
    return is_free;
  }

  const Mesh &mesh_;
  const Vertices normals_;
  std::vector<std::vector<int>> beside_;
  const double pixel_;
  std::vector<std::uint8_t> open_;
  std::unordered_set<std::int64_t> taken_;
};

Eigen::Vector2i pixels_of(const Chart &chart, double scale) {
  return ((chart.high - chart.low) * scale).array().ceil().cast<int>() + 1 + 2 * kBorder;
}

/// Places the charts in shelves, the highest first; false if they do not fit.
bool pack(std::vector<Chart *> &charts, double scale, int width, int height) {
  int x = 0, y = 0, shelf = 0;
  for (Chart *chart : charts) {
    const Eigen::Vector2i size = pixels_of(*chart, scale);
    if (x + size.x() > width) {
      y += shelf;
      x = shelf = 0;
    }
    if (x + size.x() > width || y + size.y() > height)
      return false;
    chart->x = x;
    chart->y = y;
    x += size.x();
    shelf = std::max(shelf, size.y());
  }
  return true;
}

/// Pixels a metre with which the charts fit into the image, each at its place.
double packed(std::vector<Chart> &charts, double scale, const Image &image) {
  std::vector<Chart *> order;
  for (Chart &chart : charts)
    order.push_back(&chart);
  std::stable_sort(order.begin(), order.end(),
                   [](const Chart *a, const Chart *b) { return (a->high - a->low).y() > (b->high - b->low).y(); });
  const double least = 1e-6 * scale;
  while (!pack(order, scale, image.width, image.height))
    if ((scale *= kShrink) < least)
      throw std::invalid_argument("chart_texture: expected an image that holds " + std::to_string(charts.size()) +
                                  " charts, found " + std::to_string(image.width) + " x " + std::to_string(image.height));
  return scale;
}

Vector2d pixel_place(const Chart &chart, const Mesh &mesh, int vertex, double scale) {
  return Vector2d(chart.x + kBorder + 0.5, chart.y + kBorder + 0.5) + scale * (flattened(chart, mesh, vertex) - chart.low);
}

/// B G R at texture coordinates; pixel centres lie at .5.
Vector3d sampled(const Image &image, const Vector2d &uv) {
  const Vector2d last(image.width - 1, image.height - 1);
  const Vector2d at = (uv.cwiseProduct(last + Vector2d::Ones()) - Vector2d::Constant(0.5)).cwiseMax(0).cwiseMin(last);
  const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
  const int right = std::min(x + 1, image.width - 1), below = std::min(y + 1, image.height - 1);
  const double a = at.x() - x, b = at.y() - y;
  Vector3d colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = (1 - b) * ((1 - a) * image.at(x, y, c) + a * image.at(right, y, c)) +
                b * ((1 - a) * image.at(x, below, c) + a * image.at(right, below, c));
  return colour;
}

/// The new image, and which of its pixels are known.
class Painter {
public:
  Painter(int width, int height) : image(width, height, 3, 128), known_(static_cast<std::size_t>(width) * height, 0) {}
  Image image;

  void paint(int x, int y, const Vector3d &colour) {
    for (int c = 0; c < 3; ++c)
      image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(std::lround(colour[c]), 0L, 255L));
    known_[at(x, y)] = 1;
  }

  /// Pixels beside known ones take their mean.
  void spread(int first_x, int first_y, const Eigen::Vector2i &size) {
    std::vector<std::pair<Eigen::Vector2i, Vector3d>> found;
    for (int y = first_y; y < first_y + size.y(); ++y)
      for (int x = first_x; x < first_x + size.x(); ++x) {
        Vector3d sum = Vector3d::Zero();
        int count = 0;
        for (int j = std::max(y - 1, first_y); j <= std::min(y + 1, first_y + size.y() - 1) && !known_[at(x, y)]; ++j)
          for (int i = std::max(x - 1, first_x); i <= std::min(x + 1, first_x + size.x() - 1); ++i)
            if (known_[at(i, j)]) {
              sum += Vector3d(image.at(i, j, 0), image.at(i, j, 1), image.at(i, j, 2));
              ++count;
            }
        if (count > 0)
          found.emplace_back(Eigen::Vector2i(x, y), sum / count);
      }
    for (const auto &[place, colour] : found)
      paint(place.x(), place.y(), colour);
  }

private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * image.width + x; }
  std::vector<std::uint8_t> known_;
};

void paint_chart(Painter &painter, const Chart &chart, double scale, const Mesh &mesh, const TexCoords &texcoords,
                 const Image &from) {
  for (int f : chart.faces) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      t[k] = pixel_place(chart, mesh, mesh.faces(f, k), scale);
      // Slivers may be without a pixel's centre.
      painter.paint(static_cast<int>(t[k].x()), static_cast<int>(t[k].y()), sampled(from, texcoords.row(3 * f + k)));
    }
  }
  for (int f : chart.faces) {
    Triangle t;
    for (int k = 0; k < 3; ++k)
      t[k] = pixel_place(chart, mesh, mesh.faces(f, k), scale);
    for_pixels(t, [&](int x, int y, const Vector3d &b) {
      painter.paint(x, y, sampled(from, b.transpose() * texcoords.middleRows(3 * f, 3)));
    });
  }
  for (int round = 0; round < kBorder; ++round)
    painter.spread(chart.x, chart.y, pixels_of(chart, scale));
}

} // namespace

ChartedTexture chart_texture(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &texcoords,
                             const Image &image) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  double area = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    area += shown.empty() || shown[f] ? areas[f] : 0;
  const double wished = std::sqrt(kFirstFill * image.width * image.height / std::max(area, 1e-12));
  std::vector<Chart> charts = Grower(mesh, shown, 1 / wished).grow();
  const double scale = packed(charts, wished, image);
  ChartedTexture made;
  made.texcoords = TexCoords::Zero(texcoords.rows(), 2);
  made.chart.assign(mesh.faces.rows(), -1);
  Painter painter(image.width, image.height);
  for (std::size_t c = 0; c < charts.size(); ++c) {
    paint_chart(painter, charts[c], scale, mesh, texcoords, image);
    for (int f : charts[c].faces) {
      made.chart[f] = static_cast<int>(c);
      for (int k = 0; k < 3; ++k)
        made.texcoords.row(3 * f + k) =
            pixel_place(charts[c], mesh, mesh.faces(f, k), scale).cwiseQuotient(Vector2d(image.width, image.height));
    }
  }
  made.image = std::move(painter.image);
  return made;
}

} // namespace doublet::detail
