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
  Vector3d side, across, up;                   ///< that it is seen from; of the plane it is flattened onto
  std::unordered_set<std::int64_t> taken = {}; ///< pixels of that plane
  Vector2d low, high;                          ///< m, on that plane
  int x = 0, y = 0;                            ///< of its first pixel in the image, border included
};

Vector2d flattened(const Chart &chart, const Mesh &mesh, int vertex) {
  const Vector3d p = mesh.vertices.row(vertex);
  return {chart.across.dot(p), chart.up.dot(p)};
}

/// Grows charts from face to face.
class ChartGrower {
public:
  /// `pixel`: m, of the grid on which a chart must not lie over itself.
  ChartGrower(const Mesh &mesh, const std::vector<std::uint8_t> &shown, double pixel)
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

  /// Front and back first: they reach as far around as they can, so that they part at the sides.
  std::vector<Chart> grow() {
    std::vector<Chart> charts;
    const std::vector<Vector3d> sides = main_sides();
    for (const int axis : {2, 0, 1})
      for (int f = 0; f < mesh_.faces.rows(); ++f)
        if (open_[f] && sides[f][axis] != 0)
          charts.push_back(grown_from(f, sides[f]));
    join_small(charts);
    for (Chart &chart : charts)
      find_bounds(chart);
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
    chart.side = side;
    const Vector3d above = std::abs(side.y()) < 0.5 ? Vector3d::UnitY() : Vector3d::UnitZ();
    chart.across = above.cross(side);
    chart.up = -above; // images begin at the top
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
    return chart;
  }

  /// Faces of small charts, as of the undersides of folds, go over to large ones beside them where they have room there.
  void join_small(std::vector<Chart> &charts) {
    constexpr int kRounds = 20;
    constexpr std::size_t kSmall = 40; // faces
    constexpr double kFlat = 0.15;     // cosine
    std::vector<int> chart_of(mesh_.faces.rows(), -1);
    std::vector<std::uint8_t> is_small(charts.size());
    for (std::size_t c = 0; c < charts.size(); ++c) {
      is_small[c] = charts[c].faces.size() < kSmall;
      for (int f : charts[c].faces)
        chart_of[f] = static_cast<int>(c);
    }
    const auto joined = [&](int f) {
      for (int g : beside_[f])
        if (Chart &other = charts[chart_of[g]];
            !is_small[chart_of[g]] && normals_.row(f).dot(other.side) > kFlat && claims(other, f)) {
          chart_of[f] = chart_of[g];
          other.faces.push_back(f);
          return true;
        }
      return false;
    };
    for (int round = 0; round < kRounds; ++round)
      for (std::size_t c = 0; c < charts.size(); ++c)
        if (is_small[c])
          std::erase_if(charts[c].faces, joined);
    std::erase_if(charts, [](const Chart &chart) { return chart.faces.empty(); });
  }

  void find_bounds(Chart &chart) const {
    chart.low = Vector2d::Constant(1e30);
    chart.high = -chart.low;
    for (int f : chart.faces)
      for (int k = 0; k < 3; ++k) {
        const Vector2d p = flattened(chart, mesh_, mesh_.faces(f, k));
        chart.low = chart.low.cwiseMin(p);
        chart.high = chart.high.cwiseMax(p);
      }
  }

  /// Are the pixels under the face free? Then they are its own.
  bool claims(Chart &chart, int f) const {
    Triangle t;
    for (int k = 0; k < 3; ++k)
      t[k] = flattened(chart, mesh_, mesh_.faces(f, k)) / pixel_;
    std::vector<std::int64_t> under;
    bool is_free = true;
    for_pixels(t, [&](int x, int y, const Vector3d &) {
      under.push_back((static_cast<std::int64_t>(x) << 32) + y);
      is_free &= chart.taken.count(under.back()) == 0;
    });
    if (is_free)
      chart.taken.insert(under.begin(), under.end());
    return is_free;
  }

  const Mesh &mesh_;
  const Vertices normals_;
  std::vector<std::vector<int>> beside_;
  const double pixel_;
  std::vector<std::uint8_t> open_;
};

/// A raster of which some cells are taken; coarser than the image's pixels.
class CellMask {
public:
  CellMask(int columns, int rows) : columns_(columns), words_((columns + 63) / 64), rows_(rows), bits_(words_ * rows, 0) {}
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  void take(int x, int y) { bits_[y * words_ + x / 64] |= std::uint64_t(1) << (x % 64); }

  /// Can `other` lie at (x, y) without touching what is taken?
  bool has_room(const CellMask &other, int x, int y) const {
    for (int row = 0; row < other.rows_; ++row)
      for (int word = 0; word <= other.words_; ++word)
        if (other.shifted(row, word, x % 64) & at(y + row, x / 64 + word))
          return false;
    return true;
  }
  void take(const CellMask &other, int x, int y) {
    for (int row = 0; row < other.rows_; ++row)
      for (int word = 0; word <= other.words_; ++word)
        if (const std::uint64_t bits = other.shifted(row, word, x % 64))
          bits_[(y + row) * words_ + x / 64 + word] |= bits;
  }

private:
  std::uint64_t at(int row, int word) const { return word < words_ ? bits_[row * words_ + word] : 0; }
  /// A word of a row that has been moved to the right.
  std::uint64_t shifted(int row, int word, int by) const {
    const std::uint64_t here = word < words_ ? bits_[row * words_ + word] : 0;
    return by == 0 ? here : here << by | (word > 0 ? bits_[row * words_ + word - 1] >> (64 - by) : 0);
  }

  int columns_, words_, rows_;
  std::vector<std::uint64_t> bits_;
};

/// Places charts in an image.
class ChartPacker {
public:
  ChartPacker(const Mesh &mesh, std::vector<Chart> &charts, int size)
      : mesh_(mesh), size_(size), cell_(std::max(2, size / kCells)) {
    for (Chart &chart : charts)
      order_.push_back(&chart);
    std::stable_sort(order_.begin(), order_.end(), [](const Chart *a, const Chart *b) {
      return (a->high - a->low).maxCoeff() > (b->high - b->low).maxCoeff();
    });
  }

  /// The largest first, each as high up and as far left as there is room; false if there is none.
  bool place(double scale) const {
    CellMask image(size_ / cell_, size_ / cell_);
    int first = 0; // what comes later is smaller, and finds no room in full rows either
    for (Chart *chart : order_) {
      const CellMask mask = cells_of(*chart, scale);
      if (!place(image, mask, *chart, chart->faces.size() == 1 ? first : 0))
        return false;
      if (chart->faces.size() == 1)
        first = chart->y / cell_;
    }
    return true;
  }

private:
  static constexpr int kCells = 512;

  bool place(CellMask &image, const CellMask &mask, Chart &chart, int first) const {
    for (int y = first; y + mask.rows() <= image.rows(); ++y)
      for (int x = 0; x + mask.columns() <= image.columns(); ++x)
        if (image.has_room(mask, x, y)) {
          image.take(mask, x, y);
          chart.x = x * cell_;
          chart.y = y * cell_;
          return true;
        }
    return false;
  }

  /// Those with a pixel of the chart or of its border.
  CellMask cells_of(const Chart &chart, double scale) const {
    const Eigen::Vector2i pixels = ((chart.high - chart.low) * scale).array().ceil().cast<int>() + 1 + 2 * kBorder;
    CellMask mask((pixels.x() + cell_ - 1) / cell_, (pixels.y() + cell_ - 1) / cell_);
    const auto take = [&](double x, double y) {
      const int left = static_cast<int>(x) - kBorder, right = static_cast<int>(x) + kBorder;
      const int top = static_cast<int>(y) - kBorder, bottom = static_cast<int>(y) + kBorder;
      for (int j = std::max(top, 0) / cell_; j <= std::min(bottom / cell_, mask.rows() - 1); ++j)
        for (int i = std::max(left, 0) / cell_; i <= std::min(right / cell_, mask.columns() - 1); ++i)
          mask.take(i, j);
    };
    for (int f : chart.faces) {
      std::array<Vector2d, 3> t;
      for (int k = 0; k < 3; ++k) {
        t[k] = scale * (flattened(chart, mesh_, mesh_.faces(f, k)) - chart.low) + Vector2d::Constant(kBorder + 0.5);
        take(t[k].x(), t[k].y());
      }
      for_pixels(t, [&](int x, int y, const Vector3d &) { take(x, y); });
    }
    return mask;
  }

  const Mesh &mesh_;
  int size_, cell_;
  std::vector<Chart *> order_;
};

/// Pixels a metre with which the charts fit into the image, each at its place.
double packed(const Mesh &mesh, std::vector<Chart> &charts, double scale, int size) {
  const ChartPacker packer(mesh, charts, size);
  const double least = 1e-6 * scale;
  while (!packer.place(scale))
    if ((scale *= kShrink) < least)
      throw std::invalid_argument("TextureOptions.size must hold " + std::to_string(charts.size()) + " charts, found " +
                                  std::to_string(size));
  return scale;
}

Vector2d pixel_place(const Chart &chart, const Mesh &mesh, int vertex, double scale) {
  return Vector2d(chart.x + kBorder + 0.5, chart.y + kBorder + 0.5) + scale * (flattened(chart, mesh, vertex) - chart.low);
}

/// (size * size) the face that a pixel's centre is in, the last of several; that of a sliver without any where no other is.
std::vector<int> owners(const ChartLayout &layout) {
  std::vector<int> owner(static_cast<std::size_t>(layout.size) * layout.size, -1), slivers;
  const auto at = [&](int x, int y) -> int & { return owner[static_cast<std::size_t>(y) * layout.size + x]; };
  for (int f = 0; f < static_cast<int>(layout.chart.size()); ++f) {
    if (layout.chart[f] < 0)
      continue;
    bool any = false;
    for_pixels({layout.corner(f, 0), layout.corner(f, 1), layout.corner(f, 2)}, [&](int x, int y, const Vector3d &) {
      at(x, y) = f;
      any = true;
    });
    if (!any)
      slivers.push_back(f);
  }
  for (const int f : slivers)
    for (int k = 0; k < 3; ++k)
      if (const Vector2d c = layout.corner(f, k); at(static_cast<int>(c.x()), static_cast<int>(c.y())) < 0)
        at(static_cast<int>(c.x()), static_cast<int>(c.y())) = f;
  return owner;
}

/// A picture of which only some pixels are known.
struct PartlyKnown {
  int size;
  std::vector<Eigen::Vector3f> colours;
  std::vector<std::uint8_t> known;
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * size + x; }
};

/// Pixels beside known ones take their mean.
void spread(PartlyKnown &picture) {
  const std::vector<std::uint8_t> before = picture.known;
  const int last = picture.size - 1;
  for (int y = 0; y <= last; ++y)
    for (int x = 0; x <= last; ++x) {
      if (before[picture.at(x, y)])
        continue;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      int count = 0;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, last); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, last); ++i)
          if (before[picture.at(i, j)]) {
            sum += picture.colours[picture.at(i, j)];
            ++count;
          }
      if (count > 0) {
        picture.colours[picture.at(x, y)] = sum / static_cast<float>(count);
        picture.known[picture.at(x, y)] = 1;
      }
    }
}

/// Half as large: each pixel the mean of what is known of four.
PartlyKnown halved(const PartlyKnown &picture) {
  const int size = (picture.size + 1) / 2;
  PartlyKnown small{size, std::vector<Eigen::Vector3f>(static_cast<std::size_t>(size) * size, Eigen::Vector3f::Zero()),
                    std::vector<std::uint8_t>(static_cast<std::size_t>(size) * size, 0)};
  for (int y = 0; y < picture.size; ++y)
    for (int x = 0; x < picture.size; ++x)
      if (picture.known[picture.at(x, y)]) {
        small.colours[small.at(x / 2, y / 2)] += picture.colours[picture.at(x, y)];
        ++small.known[small.at(x / 2, y / 2)];
      }
  for (std::size_t i = 0; i < small.known.size(); ++i)
    if (small.known[i]) {
      small.colours[i] /= small.known[i];
      small.known[i] = 1;
    }
  return small;
}

/// What is not known is taken from pictures half as large, as often halved as it takes (pull-push; Gortler et al. 1996).
void pull_push(PartlyKnown &picture) {
  if (picture.size < 2)
    return;
  PartlyKnown small = halved(picture);
  pull_push(small);
  for (int y = 0; y < picture.size; ++y)
    for (int x = 0; x < picture.size; ++x)
      if (const std::size_t i = picture.at(x, y); !picture.known[i])
        picture.colours[i] = small.colours[small.at(x / 2, y / 2)];
}

} // namespace

ChartLayout lay_out_charts(const Mesh &mesh, const std::vector<std::uint8_t> &shown, int size) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  double area = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    area += shown.empty() || shown[f] ? areas[f] : 0;
  const double wished = size * std::sqrt(kFirstFill / std::max(area, 1e-12));
  std::vector<Chart> charts = ChartGrower(mesh, shown, 1 / wished).grow();
  const double scale = packed(mesh, charts, wished, size);
  ChartLayout layout;
  layout.size = size;
  layout.texcoords = TexCoords::Zero(3 * mesh.faces.rows(), 2);
  layout.chart.assign(mesh.faces.rows(), -1);
  for (std::size_t c = 0; c < charts.size(); ++c)
    for (int f : charts[c].faces) {
      layout.chart[f] = static_cast<int>(c);
      for (int k = 0; k < 3; ++k)
        layout.texcoords.row(3 * f + k) = pixel_place(charts[c], mesh, mesh.faces(f, k), scale) / size;
    }
  layout.owner = owners(layout);
  return layout;
}

void fill_between_charts(const ChartLayout &layout, Image &image) {
  PartlyKnown picture{layout.size, std::vector<Eigen::Vector3f>(layout.owner.size(), Eigen::Vector3f::Constant(128)),
                      std::vector<std::uint8_t>(layout.owner.size(), 0)};
  for (std::size_t i = 0; i < layout.owner.size(); ++i)
    if (layout.owner[i] >= 0) {
      picture.known[i] = 1;
      picture.colours[i] = Eigen::Vector3f(image.data[3 * i], image.data[3 * i + 1], image.data[3 * i + 2]);
    }
  for (int round = 0; round < kBorder; ++round)
    spread(picture);
  pull_push(picture);
  for (std::size_t i = 0; i < layout.owner.size(); ++i)
    for (int c = 0; c < 3 && layout.owner[i] < 0; ++c)
      image.data[3 * i + c] = static_cast<std::uint8_t>(std::clamp(picture.colours[i][c] + 0.5f, 0.0f, 255.0f));
}

} // namespace doublet::detail
