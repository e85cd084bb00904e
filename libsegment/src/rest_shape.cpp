#include "rest_shape.h"

#include "doublet/core/parts/alignment.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/core/parts/self_intersection.h"
#include "taubin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace doublet::detail {
namespace {

/// Neighbours that a vertex is smoothed with: a boundary vertex with those along the boundary alone, so that hems stay.
std::vector<std::vector<int>> smoothing_neighbours(const Faces &faces, Eigen::Index count) {
  const EdgeTopology edges = edge_topology(faces);
  std::vector<std::vector<int>> all = vertex_neighbours(faces, static_cast<int>(count)), boundary(all.size());
  for (std::size_t e = 0; e < edges.edges.size(); ++e)
    if (edges.edge_faces[e].minCoeff() < 0) {
      boundary[edges.edges[e][0]].push_back(edges.edges[e][1]);
      boundary[edges.edges[e][1]].push_back(edges.edges[e][0]);
    }
  for (std::size_t v = 0; v < all.size(); ++v)
    if (!boundary[v].empty())
      all[v] = boundary[v];
  return all;
}

std::vector<double> lengths_of(const std::vector<Eigen::Vector2i> &edges, const Vertices &x) {
  std::vector<double> lengths;
  for (const Eigen::Vector2i &e : edges)
    lengths.push_back((x.row(e[1]) - x.row(e[0])).norm());
  return lengths;
}

/// One step of springs.
void pull(Vertices &x, const std::vector<Eigen::Vector2i> &edges, const std::vector<double> &lengths) {
  Vertices change = Vertices::Zero(x.rows(), 3);
  Eigen::VectorXd degree = Eigen::VectorXd::Zero(x.rows());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Eigen::RowVector3d d = x.row(edges[e][1]) - x.row(edges[e][0]);
    const Eigen::RowVector3d move = 0.5 * (1 - lengths[e] / std::max(d.norm(), 1e-9)) * d;
    change.row(edges[e][0]) += move;
    change.row(edges[e][1]) -= move;
    degree[edges[e][0]] += 1;
    degree[edges[e][1]] += 1;
  }
  for (Eigen::Index v = 0; v < x.rows(); ++v)
    if (degree[v] > 0)
      x.row(v) += 1.5 / degree[v] * change.row(v);
}

/// `x` with edges that grow to these lengths under a pressure from inside, which opens every fold, and a weight, which irons
/// them.
Vertices blown_up(Vertices x, const Faces &faces, const std::vector<std::vector<int>> &neighbours,
                  const std::vector<Eigen::Vector2i> &edges, const std::vector<double> &lengths,
                  const std::vector<int> &attached) {
  constexpr int kSteps = 600, kSprings = 4;
  constexpr double kPressure = 0.003, kGravity = 0.0005, kBending = 0.2; // m a step; weight
  const Vertices start = x;
  const std::vector<double> before = lengths_of(edges, x);
  std::vector<double> now(lengths.size());
  for (int step = 0; step < kSteps; ++step) {
    const double grown = std::min(1.0, 2.0 * step / kSteps);
    for (std::size_t e = 0; e < now.size(); ++e)
      now[e] = (1 - grown) * before[e] + grown * lengths[e];
    x -= kBending * laplacian(laplacian(x, neighbours), neighbours);
    x += kPressure * (1 - step / static_cast<double>(kSteps)) * vertex_normals(x, faces);
    x.col(1).array() -= kGravity;
    for (int i = 0; i < kSprings; ++i) {
      pull(x, edges, now);
      for (int v : attached)
        x.row(v) = start.row(v);
    }
  }
  return x;
}

/// The smoothest surface with edges of these lengths, near `x`: the weight of the bending falls from `first` to `last`.
Vertices fair_shape(Vertices x, const std::vector<std::vector<int>> &neighbours, const std::vector<Eigen::Vector2i> &edges,
                    const std::vector<double> &lengths, double first, double last) {
  constexpr int kSweeps = 600, kSprings = 4;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double bending = first * std::pow(last / first, sweep / static_cast<double>(kSweeps));
    x -= bending * laplacian(laplacian(x, neighbours), neighbours);
    for (int i = 0; i < kSprings; ++i)
      pull(x, edges, lengths);
  }
  return x;
}

/// What each edge exceeds in the share `exceedance` of the frames; the seam that the garment hangs from does not give.
std::vector<double> lengths_over_time(const std::vector<Eigen::Vector2i> &edges, const std::vector<Vertices> &frames,
                                      const Vertices &scan, const std::vector<int> &attached, double exceedance) {
  std::vector<char> hangs(scan.rows(), 0);
  for (int v : attached)
    hangs[v] = 1;
  std::vector<double> lengths = lengths_of(edges, scan);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (hangs[edges[e][0]] && hangs[edges[e][1]])
      continue;
    std::vector<double> seen;
    for (const Vertices &frame : frames)
      seen.push_back((frame.row(edges[e][1]) - frame.row(edges[e][0])).norm());
    lengths[e] = quantile(std::move(seen), 1 - exceedance);
  }
  return lengths;
}

/// The part of each edge that leads away from the attachment, brought to the scan's length.
std::vector<double> lengths_as_hung(const Faces &faces, const Vertices &shape, const Vertices &scan,
                                    const std::vector<Eigen::Vector2i> &edges, const std::vector<int> &attached) {
  const auto neighbours = vertex_neighbours(faces, static_cast<int>(scan.rows()));
  const Eigen::VectorXd way = edge_distances(shape, neighbours, attached), hung = edge_distances(scan, neighbours, attached);
  std::vector<double> lengths = lengths_of(edges, shape);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = std::pair(edges[e][0], edges[e][1]);
    if (!std::isfinite(std::max(way[a], way[b])))
      continue;
    const double along = std::min(std::abs(way[a] - way[b]), lengths[e]), scanned = std::abs(hung[a] - hung[b]);
    lengths[e] = std::sqrt(scanned * scanned + lengths[e] * lengths[e] - along * along);
  }
  return lengths;
}

/// Sets the faces that are folded flat onto a neighbour.
void add_folded(std::vector<std::uint8_t> &chosen, const Vertices &x, const Faces &faces, const EdgeTopology &edges) {
  constexpr double kFolded = -0.866; // cosine between normals: 150 degrees
  const Vertices normals = face_normals(x, faces);
  for (const Eigen::Vector2i &pair : edges.edge_faces)
    if (pair.minCoeff() >= 0 && normals.row(pair[0]).dot(normals.row(pair[1])) < kFolded)
      chosen[pair[0]] = chosen[pair[1]] = 1;
}

/// The vertices within so many edges of these faces.
std::vector<int> vertices_near(const Faces &faces, const std::vector<std::uint8_t> &chosen,
                               const std::vector<std::vector<int>> &around, int edges) {
  std::vector<char> seen(around.size(), 0);
  std::vector<int> near;
  const auto add = [&](int v) {
    if (!seen[v])
      near.push_back(v);
    seen[v] = 1;
  };
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3 && chosen[f]; ++k)
      add(faces(f, k));
  for (int ring = 0; ring < edges; ++ring)
    for (int v : std::vector<int>(near))
      for (int w : around[v])
        add(w);
  return near;
}

/// `x` smoothed where it passes through itself or is folded flat, further around the longer that lasts. What is attached stays.
Vertices untangled(Vertices x, const Faces &faces, const std::vector<std::vector<int>> &neighbours,
                   const std::vector<int> &attached) {
  constexpr int kRounds = 24, kSteps = 10, kRoundsToARing = 4;
  const auto around = vertex_neighbours(faces, static_cast<int>(x.rows()));
  const EdgeTopology edges = edge_topology(faces);
  const Vertices start = x;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::uint8_t> tangled = self_intersecting_faces({x, faces});
    const int first = std::count(tangled.begin(), tangled.end(), 1) > 0 ? 1 : 0; // a fold alone: its own corners
    add_folded(tangled, x, faces, edges);
    const std::vector<int> near = vertices_near(faces, tangled, around, first + round / kRoundsToARing);
    if (near.empty())
      break;
    for (int step = 0; step < kSteps; ++step) {
      const Vertices change = laplacian(x, neighbours);
      for (int v : near)
        x.row(v) += 0.5 * change.row(v);
      for (int v : attached)
        x.row(v) = start.row(v);
    }
  }
  return x;
}

/// Mean over the edges of how far they are off these lengths, as a share.
double length_error(const std::vector<Eigen::Vector2i> &edges, const Vertices &x, const std::vector<double> &lengths) {
  double sum = 0;
  for (std::size_t e = 0; e < edges.size(); ++e)
    sum += std::abs((x.row(edges[e][1]) - x.row(edges[e][0])).norm() / std::max(lengths[e], 1e-9) - 1);
  return sum / static_cast<double>(edges.size());
}

/// `shape` moved rigidly so that the seam it hangs from lies on the scan's; as it is, if it hangs from nothing.
Vertices on_seam(const Vertices &shape, const Vertices &scan, const std::vector<int> &attached) {
  if (attached.empty())
    return shape;
  Eigen::Matrix3Xd from(3, attached.size()), to(3, attached.size());
  for (std::size_t i = 0; i < attached.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = shape.row(attached[i]).transpose();
    to.col(static_cast<Eigen::Index>(i)) = scan.row(attached[i]).transpose();
  }
  const Eigen::Matrix4d moved = nearest_similarity(from, to, AlignmentScale::One);
  return (shape * moved.topLeftCorner<3, 3>().transpose()).rowwise() + moved.topRightCorner<3, 1>().transpose();
}

} // namespace

Vertices rest_shape(const Faces &faces, const Vertices &scan, const std::vector<Vertices> &frames, int wide,
                    const std::vector<int> &attached, double exceedance) {
  const auto neighbours = smoothing_neighbours(faces, scan.rows());
  if (frames.empty())
    return untangled(scan, faces, neighbours, attached);
  constexpr double kStiff = 0.2, kMiddling = 0.05, kSoft = 0.02; // weights of the bending
  const std::vector<Eigen::Vector2i> edges = edge_topology(faces).edges;
  std::vector<Vertices> smooth;
  for (const Vertices &frame : frames)
    smooth.push_back(smoothed(frame, neighbours));
  std::vector<double> lengths = lengths_over_time(edges, smooth, scan, attached, exceedance);
  Vertices shape = fair_shape(smooth[wide], neighbours, edges, lengths, kStiff, kSoft);
  for (int i = 0; i < 2; ++i) { // the second time for what the bending gave back
    lengths = lengths_as_hung(faces, shape, scan, edges, attached);
    shape = fair_shape(shape, neighbours, edges, lengths, kSoft, kSoft);
  }
  lengths = lengths_of(edges, shape);
  const auto laid_out = [&](const Vertices &from) {
    return untangled(on_seam(fair_shape(from, neighbours, edges, lengths, kMiddling, kSoft), scan, attached), faces, neighbours,
                     attached);
  };
  // Pressure opens the folds of a skirt, and turns an open jacket inside out. What ends in knots loses its lengths to untangling.
  const Vertices calm = smoothed(scan, neighbours), as_scanned = laid_out(calm),
                 open = laid_out(blown_up(calm, faces, neighbours, edges, lengths, attached));
  return length_error(edges, as_scanned, lengths) < length_error(edges, open, lengths) ? as_scanned : open;
}

} // namespace doublet::detail
