#include "isotropic.h"

#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"
#include "taubin.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace doublet::detail {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using Point = HalfEdgeMesh::Point;

HalfEdgeMesh to_openmesh(const Mesh &mesh) {
  HalfEdgeMesh out;
  std::vector<HalfEdgeMesh::VertexHandle> handles;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
    handles.push_back(out.add_vertex({mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if (!out.add_face(handles[mesh.faces(f, 0)], handles[mesh.faces(f, 1)], handles[mesh.faces(f, 2)]).is_valid())
      throw Error("remeshing: expected a manifold mesh, found that face " + std::to_string(f) + " makes it non-manifold");
  return out;
}

Mesh from_openmesh(const HalfEdgeMesh &surface) {
  Mesh out{Vertices(static_cast<Eigen::Index>(surface.n_vertices()), 3), Faces(static_cast<Eigen::Index>(surface.n_faces()), 3)};
  for (const auto v : surface.vertices()) {
    const Point &p = surface.point(v);
    out.vertices.row(v.idx()) << p[0], p[1], p[2];
  }
  for (const auto f : surface.faces()) {
    int k = 0;
    for (const auto v : surface.fv_range(f))
      out.faces(f.idx(), k++) = v.idx();
  }
  return out;
}

/// A place on the boundary.
struct OnBoundary {
  int loop = -1;    ///< none: the vertex is inside, or boundaries touch there, so that it stays
  double along = 0; ///< m, from where the loop begins, the way its half edges go
};

/// A closed one.
struct Curve {
  std::vector<Point> corners;
  std::vector<double> along; ///< m, of each corner
  double length = 0;

  void add(const Point &corner) {
    length += corners.empty() ? 0.0 : (corner - corners.back()).norm();
    corners.push_back(corner);
    along.push_back(length);
  }
  void close() { length += (corners.front() - corners.back()).norm(); }
  /// m, after this share of the corners, in [0, 1).
  double at_share(double share) const {
    const double corner = share * static_cast<double>(corners.size());
    const std::size_t k = std::min(static_cast<std::size_t>(corner), corners.size() - 1);
    const double next = k + 1 < along.size() ? along[k + 1] : length;
    return along[k] + (corner - static_cast<double>(k)) * (next - along[k]);
  }
  Point at(double place) const {
    const auto next = std::upper_bound(along.begin() + 1, along.end(), place);
    const std::size_t k = static_cast<std::size_t>(next - along.begin()) - 1;
    const Point a = corners[k], b = corners[(k + 1) % corners.size()];
    const double step = (next == along.end() ? length : *next) - along[k];
    return a + (b - a) * std::clamp((place - along[k]) / std::max(step, 1e-30), 0.0, 1.0);
  }
};

/// The loop without what is shorter than `noise` m, in equal steps. Four of them are as long as that, and there are 24 at least:
/// what has fewer would shrink.
Curve smoothed_curve(const Curve &loop, double noise) {
  const int count = std::max(24, static_cast<int>(std::min(1e6, 4 * loop.length / noise)));
  Vertices points(count, 3);
  std::vector<std::vector<int>> neighbours;
  for (int i = 0; i < count; ++i) {
    const Point p = loop.at(loop.length * i / count);
    points.row(i) << p[0], p[1], p[2];
    neighbours.push_back({(i + count - 1) % count, (i + 1) % count});
  }
  points = smoothed(points, neighbours);
  Curve smooth;
  for (int i = 0; i < count; ++i)
    smooth.add({points(i, 0), points(i, 1), points(i, 2)});
  smooth.close();
  return smooth;
}

/// The loops that vertices slide along, by the way along them: by what is nearest, those at the ends of a flat loop would leave
/// these for its sides, until three of them are left. The loops are the surface's without what is shorter than `noise` m:
/// edges that go through such noise anywhere have spikes, and make a hem too long.
class Boundary {
public:
  /// Sets `places` of the vertices.
  Boundary(HalfEdgeMesh &surface, OpenMesh::VPropHandleT<OnBoundary> places, double noise) {
    std::vector<char> seen(surface.n_halfedges(), 0);
    std::vector<int> passes(surface.n_vertices(), 0); // of boundaries
    for (const auto start : surface.halfedges()) {
      if (!start.is_boundary() || seen[start.idx()])
        continue;
      Curve loop;
      std::vector<HalfEdgeMesh::VertexHandle> vertices;
      auto h = start;
      do {
        seen[h.idx()] = 1;
        vertices.push_back(h.from());
        loop.add(surface.point(h.from()));
        h = h.next();
      } while (h != start);
      loop.close();
      loops_.push_back(smoothed_curve(loop, noise));
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        const bool alone = ++passes[vertices[i].idx()] == 1;
        surface.property(places, vertices[i]) = {alone ? static_cast<int>(loops_.size()) - 1 : -1,
                                                 loops_.back().at_share(loop.along[i] / std::max(loop.length, 1e-30))};
      }
    }
  }
  /// m, in [0, the loop's length)
  double way(const OnBoundary &from, const OnBoundary &to) const {
    return wrapped(to.along - from.along, loops_[from.loop].length);
  }
  OnBoundary moved(const OnBoundary &from, double by) const {
    return {from.loop, wrapped(from.along + by, loops_[from.loop].length)};
  }
  Point at(const OnBoundary &place) const { return loops_[place.loop].at(place.along); }

private:
  static double wrapped(double along, double length) {
    const double rest = length > 0 ? std::fmod(along, length) : 0.0;
    return rest < 0 ? rest + length : rest;
  }
  std::vector<Curve> loops_;
};

class Remesher {
public:
  Remesher(const Mesh &mesh, double length, double noise)
      : surface_(to_openmesh(mesh)), scene_(mesh), places_(add_places(surface_)), boundary_(surface_, places_, noise),
        length_(length) {
    normals_ = face_normals(mesh.vertices, mesh.faces);
  }

  Mesh operator()(int iterations) {
    for (int i = 0; i < iterations; ++i) {
      split_long_edges();
      collapse_short_edges();
      flip_edges();
      for (int k = 0; k < 3; ++k)
        relax();
    }
    surface_.garbage_collection();
    return from_openmesh(surface_);
  }

private:
  using VertexHandle = HalfEdgeMesh::VertexHandle;
  using HalfedgeHandle = HalfEdgeMesh::HalfedgeHandle;

  static OpenMesh::VPropHandleT<OnBoundary> add_places(HalfEdgeMesh &surface) {
    OpenMesh::VPropHandleT<OnBoundary> places;
    surface.add_property(places);
    return places;
  }
  OnBoundary &place(VertexHandle v) { return surface_.property(places_, v); }

  bool on_loop(HalfedgeHandle h) {
    return place(surface_.from_vertex_handle(h)).loop >= 0 && place(surface_.to_vertex_handle(h)).loop >= 0;
  }
  /// Of the edge the half that runs along a loop; not valid inside.
  HalfedgeHandle boundary_half(HalfEdgeMesh::EdgeHandle e) {
    for (int side : {0, 1})
      if (const auto h = surface_.halfedge_handle(e, side); surface_.is_boundary(h) && on_loop(h))
        return h;
    return HalfedgeHandle();
  }
  /// m, along the boundary for what is of it
  double length_of(HalfEdgeMesh::EdgeHandle e) {
    const HalfedgeHandle h = boundary_half(e);
    return h.is_valid() ? boundary_.way(place(surface_.from_vertex_handle(h)), place(surface_.to_vertex_handle(h)))
                        : surface_.calc_edge_length(e);
  }

  void split_long_edges() {
    const double most = 4.0 / 3 * length_;
    const std::size_t count = surface_.n_edges(); // halves of split ones wait for the next iteration
    for (std::size_t i = 0; i < count; ++i) {
      const HalfEdgeMesh::EdgeHandle e(static_cast<int>(i));
      if (surface_.status(e).deleted() || length_of(e) <= most)
        continue;
      const HalfedgeHandle h = boundary_half(e);
      OnBoundary between;
      if (h.is_valid())
        between = boundary_.moved(place(surface_.from_vertex_handle(h)), length_of(e) / 2);
      const auto middle = surface_.add_vertex(h.is_valid() ? boundary_.at(between) : surface_.calc_edge_midpoint(e));
      place(middle) = between;
      surface_.split(e, middle);
    }
  }

  /// May the edge's first vertex go into its second?
  bool may_collapse(HalfedgeHandle h) {
    const auto from = surface_.from_vertex_handle(h), to = surface_.to_vertex_handle(h);
    if (surface_.is_boundary(from) && !surface_.is_boundary(surface_.edge_handle(h)))
      return false;
    if (!surface_.is_collapse_ok(h))
      return false;
    const double most = std::pow(4.0 / 3 * length_, 2);
    for (const auto v : surface_.vv_range(from))
      if ((surface_.point(v) - surface_.point(to)).sqrnorm() > most)
        return false;
    // No face may turn over.
    for (const auto f : surface_.vf_range(from)) {
      Point corners[3], moved[3];
      int k = 0;
      bool goes = false;
      for (const auto v : surface_.fv_range(f)) {
        goes |= v == to;
        corners[k] = surface_.point(v);
        moved[k++] = surface_.point(v == from ? to : v);
      }
      const Point before = (corners[1] - corners[0]) % (corners[2] - corners[0]),
                  after = (moved[1] - moved[0]) % (moved[2] - moved[0]);
      if (!goes && (before | after) < 0.2 * before.norm() * after.norm())
        return false;
    }
    return true;
  }

  void collapse_short_edges() {
    const double least = 4.0 / 5 * length_;
    for (std::size_t i = 0; i < surface_.n_edges(); ++i) {
      const HalfEdgeMesh::EdgeHandle e(static_cast<int>(i));
      if (surface_.status(e).deleted() || length_of(e) >= least)
        continue;
      for (int side : {0, 1}) {
        const auto h = surface_.halfedge_handle(e, side);
        if (may_collapse(h)) {
          surface_.collapse(h);
          break;
        }
      }
    }
    surface_.garbage_collection();
  }

  int excess(VertexHandle v, int change) const {
    const int ideal = surface_.is_boundary(v) ? 4 : 6;
    return std::abs(static_cast<int>(surface_.valence(v)) + change - ideal);
  }

  void flip_edges() {
    for (const auto e : surface_.edges()) {
      if (e.is_boundary() || !surface_.is_flip_ok(e))
        continue;
      const auto h = surface_.halfedge_handle(e, 0), o = surface_.halfedge_handle(e, 1);
      const auto a = surface_.to_vertex_handle(h), b = surface_.from_vertex_handle(h), c = surface_.opposite_vh(h),
                 d = surface_.opposite_vh(o);
      const int before = excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0),
                after = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
      if (after >= before || surface_.valence(a) <= 3 || surface_.valence(b) <= 3)
        continue;
      const Point &pa = surface_.point(a), &pb = surface_.point(b), &pc = surface_.point(c), &pd = surface_.point(d);
      const Point first = (pd - pc) % (pa - pc), second = (pb - pc) % (pd - pc); // the faces (c, d, a) and (c, b, d) of a flip
      if ((first | second) > 0.3 * first.norm() * second.norm())
        surface_.flip(e);
    }
  }

  Point normal_at(VertexHandle v) const {
    Point n(0, 0, 0);
    for (const auto f : surface_.vf_range(v))
      n += surface_.calc_face_normal(f);
    return n.norm() > 1e-12 ? n / n.norm() : Point(0, 0, 0);
  }

  /// Every vertex half way to the middle of its neighbours along the surface; boundary vertices along the boundary.
  void relax() {
    std::vector<Point> moved(surface_.n_vertices());
    std::vector<OnBoundary> places(surface_.n_vertices());
    for (const auto v : surface_.vertices()) {
      if (surface_.is_boundary(v)) {
        const auto h = surface_.halfedge_handle(v); // the one along the boundary
        places[v.idx()] = place(v);
        moved[v.idx()] = surface_.point(v);
        if (!on_loop(h) || !on_loop(surface_.prev_halfedge_handle(h)))
          continue;
        const OnBoundary &before = place(surface_.from_vertex_handle(surface_.prev_halfedge_handle(h))),
                         &after = place(surface_.to_vertex_handle(h));
        places[v.idx()] = boundary_.moved(place(v), (boundary_.way(place(v), after) - boundary_.way(before, place(v))) / 4);
        moved[v.idx()] = boundary_.at(places[v.idx()]);
        continue;
      }
      Point sum(0, 0, 0);
      int count = 0;
      for (const auto w : surface_.vv_range(v)) {
        sum += surface_.point(w);
        ++count;
      }
      const Point p = surface_.point(v), n = normal_at(v), way = sum / std::max(1, count) - p;
      moved[v.idx()] = projected(p + 0.5 * (way - (way | n) * n), n);
    }
    for (const auto v : surface_.vertices()) {
      surface_.set_point(v, moved[v.idx()]);
      place(v) = places[v.idx()];
    }
  }

  /// The closest point of the original surface, unless that is another sheet of it.
  Point projected(const Point &p, const Point &normal) const {
    const ClosestPoint at = scene_.closest({p[0], p[1], p[2]});
    const double agreement = normals_.row(at.face).dot(Eigen::RowVector3d(normal[0], normal[1], normal[2]));
    return agreement > 0 ? Point(at.point.x(), at.point.y(), at.point.z()) : p;
  }

  HalfEdgeMesh surface_;
  RayScene scene_;
  Vertices normals_;
  OpenMesh::VPropHandleT<OnBoundary> places_;
  Boundary boundary_;
  double length_;
};

} // namespace

Mesh remesh_isotropic(const Mesh &mesh, double length, double noise, int iterations) {
  require_usable(mesh, "remeshing");
  return Remesher(mesh, length, std::max(noise, 2 * length))(iterations);
}

} // namespace doublet::detail
