// The only file that includes Embree.

#include "doublet/rays/ray_scene.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/options/options.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

namespace doublet {

namespace {

/// A ray in doubles, with the best hit so far. Embree walks its tree with the same ray in floats and knows only this base.
struct ExactRay {
  RTCIntersectContext context; ///< first: Embree hands it back to the callbacks
  const Mesh *mesh;
  const std::vector<int> *face_of;
  Eigen::Vector3d origin, direction;
  double nearest, farthest; ///< m, open interval
  RayHit hit;               ///< face -1: none
};

/// Distance (m) and barycentric coordinates at which the ray's line crosses the face; nothing if it passes by. The ray passes
/// each edge on the same side for both faces beside it, up to rounding, for which there is a margin: so a closed surface has no
/// cracks, which Embree's own triangles have at their corners. Signed volumes as Woop, Benthin & Wald 2013.
std::optional<RayHit> cross_face(const ExactRay &ray, int face) {
  const auto corner = [&](int k) -> Eigen::Vector3d {
    return ray.mesh->vertices.row(ray.mesh->faces(face, k)).transpose() - ray.origin;
  };
  const Eigen::Vector3d a = corner(0), b = corner(1), c = corner(2);
  Eigen::Vector3d sides(ray.direction.dot(b.cross(c)), ray.direction.dot(c.cross(a)), ray.direction.dot(a.cross(b)));
  constexpr double kRounding = 1e-14;
  const double margin = kRounding * std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  if (sides.minCoeff() < -margin && sides.maxCoeff() > margin)
    return std::nullopt;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double slope = normal.dot(ray.direction);
  if (slope == 0)
    return std::nullopt;
  sides = slope > 0 ? sides.cwiseMax(0).eval() : (-sides).cwiseMax(0).eval();
  if (!(sides.sum() > 0))
    return std::nullopt;
  return RayHit{face, normal.dot(a) / slope, sides / sides.sum()};
}

/// Keeps the face's hit if it is in the ray's interval and nearer than the best; the lowest face wins a tie.
bool try_face(ExactRay &ray, unsigned primitive) {
  const auto hit = cross_face(ray, (*ray.face_of)[primitive]);
  if (!hit || !(hit->distance > ray.nearest && hit->distance < ray.farthest))
    return false;
  const bool better =
      ray.hit.face < 0 || hit->distance < ray.hit.distance || (hit->distance == ray.hit.distance && hit->face < ray.hit.face);
  if (better)
    ray.hit = *hit;
  return better;
}

/// Rounded up: the tree works in floats, and must not cut off a face that is as near in doubles.
float rounded_up(double distance) {
  return static_cast<float>(distance * (1 + 1e-5) + 1e-6);
}

void visit_first(const RTCIntersectFunctionNArguments *args) {
  ExactRay &ray = *reinterpret_cast<ExactRay *>(args->context);
  if (args->valid[0] == 0 || !try_face(ray, args->primID))
    return;
  RTCRayHit &found = *reinterpret_cast<RTCRayHit *>(args->rayhit);
  found.ray.tfar = std::min(found.ray.tfar, rounded_up(ray.hit.distance));
  found.hit.geomID = args->geomID;
  found.hit.primID = args->primID;
}

void visit_any(const RTCOccludedFunctionNArguments *args) {
  ExactRay &ray = *reinterpret_cast<ExactRay *>(args->context);
  if (args->valid[0] != 0 && try_face(ray, args->primID))
    reinterpret_cast<RTCRay *>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
}

/// m, and of directions. Embree ends the process at rays beyond 1.8e18, and at those of NaN.
constexpr double kLargestCoordinate = 1e18;

void require_in_reach(const Eigen::Vector3d &vector, const char *what) {
  if (vector.hasNaN() || !(vector.cwiseAbs().maxCoeff() <= kLargestCoordinate))
    throw std::invalid_argument(std::string("RayScene: expected ") + what + " of numbers within 1e18, found (" +
                                options::to_text(vector.x()) + ", " + options::to_text(vector.y()) + ", " +
                                options::to_text(vector.z()) + ")");
}

RTCRay float_ray(const ExactRay &ray) {
  RTCRay out{};
  const Eigen::Vector3f o = ray.origin.cast<float>(), d = ray.direction.cast<float>();
  out.org_x = o.x();
  out.org_y = o.y();
  out.org_z = o.z();
  out.dir_x = d.x();
  out.dir_y = d.y();
  out.dir_z = d.z();
  out.tnear = static_cast<float>(std::max(0.0, ray.nearest * (1 - 1e-5) - 1e-6));
  out.tfar = rounded_up(ray.farthest);
  out.mask = ~0u;
  return out;
}

} // namespace

struct RayScene::Impl {
  Mesh mesh;
  std::vector<int> face_of; ///< Embree's primitive -> face
  double size = 0;          ///< m, largest coordinate
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Impl(const Mesh &m, const std::vector<std::uint8_t> &face_valid) : mesh(m) {
    for (int f = 0; f < mesh.faces.rows(); ++f)
      if (face_valid.empty() || face_valid[f])
        face_of.push_back(f);
    size = mesh.vertices.cwiseAbs().maxCoeff();
    device = rtcNewDevice("threads=1,user_threads=1");
    if (!device)
      fail("gave no device", rtcGetDeviceError(nullptr));
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    add_triangles();
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      release();
      fail("failed to build the scene", error);
    }
  }
  Impl(const Impl &) = delete;
  Impl &operator=(const Impl &) = delete;
  ~Impl() { release(); }

  Eigen::Vector3d corner(int face, int k) const { return mesh.vertices.row(mesh.faces(face, k)); }

private:
  [[noreturn]] static void fail(const std::string &how, RTCError error) {
    if (error == RTC_ERROR_OUT_OF_MEMORY)
      throw std::bad_alloc();
    throw Error("RayScene: Embree " + how + ", error " + std::to_string(error));
  }

  void add_triangles() {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(face_of.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &Impl::bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, &visit_first);
    rtcSetGeometryOccludedFunction(geometry, &visit_any);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  /// The box of a face, widened by what floats lose of it and of a ray.
  static void bounds(const RTCBoundsFunctionArguments *args) {
    const Impl &own = *static_cast<const Impl *>(args->geometryUserPtr);
    const int face = own.face_of[args->primID];
    const Eigen::Matrix3d corners = own.mesh.vertices(own.mesh.faces.row(face), Eigen::all);
    const double margin = 1e-6 * own.size;
    const Eigen::RowVector3f low = (corners.colwise().minCoeff().array() - margin).cast<float>(),
                             high = (corners.colwise().maxCoeff().array() + margin).cast<float>();
    RTCBounds &box = *args->bounds_o;
    box.lower_x = low.x();
    box.lower_y = low.y();
    box.lower_z = low.z();
    box.upper_x = high.x();
    box.upper_y = high.y();
    box.upper_z = high.z();
  }

  void release() {
    if (scene)
      rtcReleaseScene(scene);
    if (device)
      rtcReleaseDevice(device);
    scene = nullptr;
    device = nullptr;
  }

  friend class RayScene;
  struct Query {
    const Impl *impl;
    Eigen::Vector3d point;
    ClosestPoint best;
  };

  static bool visit(RTCPointQueryFunctionArguments *args) {
    Query &q = *static_cast<Query *>(args->userPtr);
    const int face = q.impl->face_of[args->primID];
    const Eigen::Vector3d a = q.impl->corner(face, 0), b = q.impl->corner(face, 1), c = q.impl->corner(face, 2);
    const Eigen::Vector3d ab = b - a, ac = c - a, ap = q.point - a, bp = q.point - b, cp = q.point - c;
    const Eigen::Vector3d bary = closest_on_triangle(ab.dot(ap), ac.dot(ap), ab.dot(bp), ac.dot(bp), ab.dot(cp), ac.dot(cp));
    const Eigen::Vector3d at = bary[0] * a + bary[1] * b + bary[2] * c;
    const double distance = (at - q.point).norm();
    // The lowest face wins a tie, so that the answer does not depend on the order of the tree.
    if (!(distance < q.best.distance || (distance == q.best.distance && face < q.best.face)))
      return false;
    q.best = {face, at, bary, distance};
    const float radius = rounded_up(distance);
    if (radius < args->query->radius) {
      args->query->radius = radius;
      return true;
    }
    return false;
  }
};

RayScene::RayScene(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid) {
  require_usable(mesh, "RayScene");
  if (!(mesh.vertices.cwiseAbs().maxCoeff() < kLargestCoordinate))
    throw Error("RayScene: expected coordinates below 1e18 m, found " + options::to_text(mesh.vertices.cwiseAbs().maxCoeff()));
  if (!face_valid.empty() && static_cast<Eigen::Index>(face_valid.size()) != mesh.faces.rows())
    throw std::invalid_argument("RayScene: expected " + std::to_string(mesh.faces.rows()) + " entries in face_valid, found " +
                                std::to_string(face_valid.size()));
  impl_ = std::make_shared<Impl>(mesh, face_valid);
  if (impl_->face_of.empty())
    throw Error("RayScene: all " + std::to_string(mesh.faces.rows()) + " faces are invalid");
}

std::optional<RayHit> RayScene::cast(const Eigen::Vector3d &origin, const Eigen::Vector3d &direction, double min_distance,
                                     double max_distance) const {
  require_in_reach(origin, "an origin");
  require_in_reach(direction, "a direction");
  if (std::isnan(min_distance) || std::isnan(max_distance))
    throw std::invalid_argument("RayScene: expected distances, found NaN");
  ExactRay ray{{}, &impl_->mesh, &impl_->face_of, origin, direction, std::max(0.0, min_distance), max_distance, {}};
  rtcInitIntersectContext(&ray.context);
  RTCRayHit walk{};
  walk.ray = float_ray(ray);
  walk.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  walk.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &ray.context, &walk);
  return ray.hit.face < 0 ? std::nullopt : std::optional<RayHit>(ray.hit);
}

bool RayScene::occluded(const Eigen::Vector3d &from, const Eigen::Vector3d &to, double margin) const {
  require_in_reach(from, "a start");
  require_in_reach(to, "an end");
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  if (!(length > 2 * margin))
    return false;
  ExactRay ray{{}, &impl_->mesh, &impl_->face_of, from, way / length, margin, length - margin, {}};
  rtcInitIntersectContext(&ray.context);
  RTCRay walk = float_ray(ray);
  rtcOccluded1(impl_->scene, &ray.context, &walk);
  return ray.hit.face >= 0;
}

ClosestPoint RayScene::closest(const Eigen::Vector3d &point) const {
  require_in_reach(point, "a point");
  RTCPointQuery query{};
  query.x = static_cast<float>(point.x());
  query.y = static_cast<float>(point.y());
  query.z = static_cast<float>(point.z());
  query.radius = std::numeric_limits<float>::infinity();
  Impl::Query state{impl_.get(), point, {}};
  state.best.distance = std::numeric_limits<double>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, &Impl::visit, &state);
  return state.best;
}

} // namespace doublet
