#include "body_weld.h"

#include "doublet/core/parts/boundary_loops.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/rays/ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace doublet::detail {
namespace {

using Eigen::Vector3d;

// m, the scan's edge is ragged, and what closes the scan below a hem begins there. Where the scan is about twice as wide as that,
// as between the fronts of a coat, it may fall apart where the body, whose triangles are others, does not: a little more or less.
constexpr std::array kTried = {kTakenBack, 0.025, 0.015, 0.03, 0.035, 0.04};
constexpr double kBesideHidden = 0.05; // m, the scan ends at a garment where it ends so close to what is hidden of the body
constexpr double kSameSkin = 0.03;     // m, body and scan are the same skin up to here
constexpr double kNoOverlap = 0.002;   // m, between the body and the scan
constexpr double kTooFar = 0.20;       // m, what goes on so far from all that is hidden has got out
constexpr double kPiece = 0.005;       // m^2, smaller pieces and holes are none
constexpr double kBlend = 0.05;        // m from the weld, within which the body goes over from the scan to itself
constexpr double kSmear = 0.02;        // m, standard deviation along the weld of what the body is moved by
constexpr int kCleanings = 20;

using Loop = std::vector<int>;

/// Of the faces with this flag, those in pieces (joined by edges' ends) below a size get the other.
void turn_small_pieces(const Mesh &mesh, std::uint8_t flag, std::vector<std::uint8_t> &flags) {
  std::vector<std::uint8_t> chosen(flags.size());
  for (std::size_t f = 0; f < flags.size(); ++f)
    chosen[f] = flags[f] == flag;
  int count = 0;
  const Eigen::VectorXi piece =
      vertex_components(valid_faces(mesh.faces, chosen), static_cast<int>(mesh.vertices.rows()), &count);
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(count);
  for (std::size_t f = 0; f < flags.size(); ++f)
    if (chosen[f])
      sizes[piece[mesh.faces(static_cast<Eigen::Index>(f), 0)]] += areas[static_cast<Eigen::Index>(f)];
  for (std::size_t f = 0; f < flags.size(); ++f)
    if (chosen[f] && sizes[piece[mesh.faces(static_cast<Eigen::Index>(f), 0)]] < kPiece)
      flags[f] = flag ? 0 : 1;
}

/// Drops faces until the boundary passes every vertex once at most, and no face hangs by a single edge.
bool clean_boundary(const Mesh &mesh, std::vector<std::uint8_t> &kept) {
  for (int round = 0; round < kCleanings; ++round) {
    const EdgeTopology topology = edge_topology(valid_faces(mesh.faces, kept));
    std::vector<int> ends(mesh.vertices.rows(), 0);
    for (std::size_t e = 0; e < topology.edges.size(); ++e)
      if (topology.edge_faces[e][1] < 0)
        for (int k = 0; k < 2; ++k)
          ++ends[topology.edges[e][k]];
    std::vector<std::uint8_t> bad(kept.size(), 0);
    bool clean = true;
    for (std::size_t f = 0; f < kept.size(); ++f)
      for (int k = 0; k < 3 && kept[f]; ++k)
        if (ends[mesh.faces(static_cast<Eigen::Index>(f), k)] > 2) {
          bad[f] = 1;
          clean = false;
        }
    if (clean)
      return true;
    for (std::size_t f = 0; f < kept.size(); ++f)
      kept[f] = kept[f] && !bad[f];
    turn_small_pieces(mesh, 1, kept);
  }
  return false;
}

double mean_distance(const Vertices &from, const Loop &a, const Vertices &to, const Loop &b) {
  double sum = 0;
  for (int v : a) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int w : b)
      nearest = std::min(nearest, (from.row(v) - to.row(w)).squaredNorm());
    sum += std::sqrt(nearest);
  }
  return sum / static_cast<double>(a.size());
}

/// The loops of a skin's boundary that lie beside what is hidden.
std::vector<Loop> loops_at_garments(const Mesh &skin, const Mesh &body, const std::vector<std::uint8_t> &hidden) {
  Loop all;
  for (std::size_t v = 0; v < hidden.size(); ++v)
    if (hidden[v])
      all.push_back(static_cast<int>(v));
  std::vector<Loop> found;
  for (Loop &loop : boundary_loops(skin.faces))
    if (!all.empty() && mean_distance(skin.vertices, loop, body.vertices, all) < kBesideHidden)
      found.push_back(std::move(loop));
  return found;
}

/// (B) m, > 0 on the scan, from where it is taken back to; -infinity where body and scan are not the same skin.
Eigen::VectorXd on_the_body(const Mesh &skin, const Eigen::VectorXd &from_the_edge, double taken_back, const Mesh &body) {
  const RayScene scene(skin);
  const Vertices normals = vertex_normals(body.vertices, body.faces), skin_normals = face_normals(skin.vertices, skin.faces);
  Eigen::VectorXd field(body.vertices.rows());
  for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) {
    const ClosestPoint at = scene.closest(body.vertices.row(v));
    const bool same = at.distance < kSameSkin && skin_normals.row(at.face).dot(normals.row(v)) > 0;
    field[v] = same ? 0 : -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3 && same; ++k) // what is far is infinitely far
      field[v] += at.barycentric[k] > 0 ? at.barycentric[k] * (from_the_edge[skin.faces(at.face, k)] - taken_back) : 0;
  }
  return field;
}

/// The faces of the body that go on from what is hidden to where the scan begins; none if they go on too far.
std::vector<std::uint8_t> going_on(const Mesh &body, const std::vector<std::uint8_t> &hidden, const Eigen::VectorXd &field) {
  const auto neighbours = vertex_neighbours(body.faces, static_cast<int>(body.vertices.rows()));
  std::vector<int> front, sources;
  std::vector<std::uint8_t> reached(hidden.size(), 0);
  for (std::size_t v = 0; v < hidden.size(); ++v)
    if (hidden[v]) {
      sources.push_back(static_cast<int>(v));
      if (field[static_cast<Eigen::Index>(v)] < -kNoOverlap) {
        reached[v] = 1;
        front.push_back(static_cast<int>(v));
      }
    }
  const Eigen::VectorXd away = edge_distances(body.vertices, neighbours, sources);
  for (std::size_t i = 0; i < front.size(); ++i)
    for (int w : neighbours[front[i]])
      if (!reached[w] && field[w] < -kNoOverlap) {
        if (away[w] > kTooFar)
          return {};
        reached[w] = 1;
        front.push_back(w);
      }
  std::vector<std::uint8_t> kept(body.faces.rows());
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f)
    kept[f] = reached[body.faces(f, 0)] && reached[body.faces(f, 1)] && reached[body.faces(f, 2)];
  return kept;
}

/// Triangles between a loop `a` of the scan and one of the body, both in the order of their faces: those with the shortest edges
/// across (Fuchs, Kedem, Uselton 1977). The body's vertices are numbered from `first`.
std::vector<Eigen::RowVector3i> strip_between(const Loop &a, Loop b, const Vertices &a_at, const Vertices &b_at, int first) {
  std::reverse(b.begin(), b.end());
  const auto across = [&](std::size_t i, std::size_t j) {
    return (a_at.row(a[i % a.size()]) - b_at.row(b[j % b.size()])).norm();
  };
  std::size_t nearest = 0;
  for (std::size_t j = 1; j < b.size(); ++j)
    if (across(0, j) < across(0, nearest))
      nearest = j;
  std::rotate(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(nearest), b.end());
  const std::size_t n = a.size(), m = b.size(), wide = m + 1;
  std::vector<double> cost((n + 1) * wide, std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> along_a(cost.size(), 0);
  cost[0] = 0;
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; j <= m; ++j)
      for (const bool step_a : {true, false})
        if (step_a ? i > 0 : j > 0) {
          const std::size_t here = i * wide + j;
          const double total = cost[here - (step_a ? wide : 1)] + across(i, j);
          if (total < cost[here]) {
            cost[here] = total;
            along_a[here] = step_a;
          }
        }
  std::vector<Eigen::RowVector3i> triangles;
  for (std::size_t i = n, j = m; i + j > 0;) {
    const int at_a = a[i % n], at_b = first + b[j % m];
    if (along_a[i * wide + j])
      triangles.emplace_back(at_a, a[--i], at_b);
    else
      triangles.emplace_back(first + b[--j], at_b, at_a);
  }
  return triangles;
}

/// Which of the body's loops each of the scan's goes to; empty if they do not go together one by one.
std::vector<int> partners(const Mesh &skin, const std::vector<Loop> &skin_loops, const Mesh &body,
                          const std::vector<Loop> &body_loops) {
  std::vector<int> chosen;
  for (const Loop &loop : skin_loops) {
    int best = -1;
    double nearest = kBlend;
    for (std::size_t j = 0; j < body_loops.size(); ++j) {
      const double distance = std::max(mean_distance(skin.vertices, loop, body.vertices, body_loops[j]),
                                       mean_distance(body.vertices, body_loops[j], skin.vertices, loop));
      if (distance < nearest && std::find(chosen.begin(), chosen.end(), static_cast<int>(j)) == chosen.end()) {
        nearest = distance;
        best = static_cast<int>(j);
      }
    }
    if (best < 0)
      return {};
    chosen.push_back(best);
  }
  return chosen.size() == body_loops.size() ? chosen : std::vector<int>{};
}

/// The body is moved to meet the scan, and goes back to its own place.
void meet(const Mesh &skin, const std::vector<Loop> &skin_loops, const Mesh &whole_body, const std::vector<Loop> &body_loops,
          Mesh &body) {
  const RayScene scene(whole_body);
  Vertices places(0, 3), ways(0, 3);
  for (const Loop &loop : skin_loops)
    for (int v : loop) {
      places.conservativeResize(places.rows() + 1, 3);
      ways.conservativeResize(ways.rows() + 1, 3);
      places.bottomRows<1>() = skin.vertices.row(v);
      ways.bottomRows<1>() = skin.vertices.row(v) - scene.closest(skin.vertices.row(v)).point.transpose();
    }
  std::vector<int> ends;
  for (const Loop &loop : body_loops)
    ends.insert(ends.end(), loop.begin(), loop.end());
  const Eigen::VectorXd away =
      edge_distances(body.vertices, vertex_neighbours(body.faces, static_cast<int>(body.vertices.rows())), ends, kBlend);
  const Vertices before = body.vertices;
  for (Eigen::Index v = 0; v < before.rows(); ++v) {
    if (!(away[v] < kBlend))
      continue;
    const Eigen::VectorXd squares = (places.rowwise() - before.row(v)).rowwise().squaredNorm();
    const Eigen::VectorXd weights =
        ((squares.minCoeff() - squares.array()) / (2 * kSmear * kSmear)).exp(); // of the nearest 1, however far it is
    const double left = 1 - away[v] / kBlend;
    body.vertices.row(v) += left * left * (3 - 2 * left) * (weights.transpose() * ways) / weights.sum();
  }
}

std::vector<int> chosen_faces(const std::vector<std::uint8_t> &flags) {
  std::vector<int> chosen;
  for (std::size_t f = 0; f < flags.size(); ++f)
    if (flags[f])
      chosen.push_back(static_cast<int>(f));
  return chosen;
}

/// `from_the_edge` (V): m along the skin from where it ends at a garment.
std::optional<WeldedSkin> weld_taken_back(const Mesh &skin, const Eigen::VectorXd &from_the_edge, double taken_back,
                                          const Mesh &whole_body, const std::vector<std::uint8_t> &hidden) {
  std::vector<std::uint8_t> kept_skin(skin.faces.rows());
  for (Eigen::Index f = 0; f < skin.faces.rows(); ++f)
    kept_skin[f] = from_the_edge(skin.faces.row(f).transpose()).minCoeff() >= taken_back;
  turn_small_pieces(skin, 1, kept_skin);
  std::vector<std::uint8_t> kept_body = going_on(whole_body, hidden, on_the_body(skin, from_the_edge, taken_back, whole_body));
  if (kept_body.empty())
    return {};
  turn_small_pieces(whole_body, 1, kept_body);
  turn_small_pieces(whole_body, 0, kept_body);
  if (!clean_boundary(skin, kept_skin) || !clean_boundary(whole_body, kept_body))
    return {};

  WeldedSkin welded;
  const Mesh scan = submesh(skin, chosen_faces(kept_skin));
  Mesh body = submesh(whole_body, chosen_faces(kept_body), &welded.body_vertices);
  if (scan.faces.rows() == 0 || body.faces.rows() == 0)
    return {};
  const std::vector<Loop> scan_loops = loops_at_garments(scan, body, std::vector<std::uint8_t>(body.vertices.rows(), 1)),
                          body_loops = boundary_loops(body.faces);
  const std::vector<int> partner = partners(scan, scan_loops, body, body_loops);
  if (partner.empty())
    return {};
  meet(scan, scan_loops, whole_body, body_loops, body);
  const int first = static_cast<int>(scan.vertices.rows());
  std::vector<Eigen::RowVector3i> between;
  for (std::size_t i = 0; i < scan_loops.size(); ++i)
    for (const Eigen::RowVector3i &triangle :
         strip_between(scan_loops[i], body_loops[partner[i]], scan.vertices, body.vertices, first))
      between.push_back(triangle);
  welded.mesh.vertices.resize(scan.vertices.rows() + body.vertices.rows(), 3);
  welded.mesh.vertices << scan.vertices, body.vertices;
  welded.mesh.faces.resize(scan.faces.rows() + body.faces.rows() + static_cast<Eigen::Index>(between.size()), 3);
  welded.mesh.faces.topRows(scan.faces.rows()) = scan.faces;
  welded.mesh.faces.middleRows(scan.faces.rows(), body.faces.rows()) = body.faces.array() + first;
  for (std::size_t i = 0; i < between.size(); ++i)
    welded.mesh.faces.row(scan.faces.rows() + body.faces.rows() + static_cast<Eigen::Index>(i)) = between[i];
  return welded;
}

} // namespace

std::optional<WeldedSkin> weld_body(const Mesh &skin, const Mesh &body, const std::vector<std::uint8_t> &hidden) {
  Loop edge;
  for (const Loop &loop : loops_at_garments(skin, body, hidden))
    edge.insert(edge.end(), loop.begin(), loop.end());
  if (edge.empty())
    return {};
  const Eigen::VectorXd from_the_edge =
      edge_distances(skin.vertices, vertex_neighbours(skin.faces, static_cast<int>(skin.vertices.rows())), edge);
  for (const double taken_back : kTried)
    if (std::optional<WeldedSkin> welded = weld_taken_back(skin, from_the_edge, taken_back, body, hidden))
      return welded;
  return {};
}

std::vector<int> weld_vertices(const Faces &faces, Eigen::Index first_body_vertex) {
  std::vector<int> found;
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    if (faces.row(f).maxCoeff() >= first_body_vertex)
      for (int k = 0; k < 3; ++k)
        if (faces(f, k) < first_body_vertex)
          found.push_back(faces(f, k));
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

} // namespace doublet::detail
