// The only file that includes Embree.

#include "doublet/core/ray_scene.h"

#include "doublet/core/error.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {

namespace {

/// Barycentric coordinates (Ericson 2004, sect. 5.1.5) of the point of triangle a b c that is closest to p.
Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d &p, const Eigen::Vector3d &a, const Eigen::Vector3d &b,
                                    const Eigen::Vector3d &c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0)
    return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3)
    return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0)
    return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6)
    return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0)
    return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

} // namespace

struct RayScene::Impl {
  Mesh mesh;
  std::vector<int> face_of; ///< Embree's primitive -> face
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Impl(const Mesh &m, const std::vector<std::uint8_t> &skip_face) : mesh(m) {
    for (int f = 0; f < mesh.faces.rows(); ++f)
      if (skip_face.empty() || !skip_face[f])
        face_of.push_back(f);
    device = rtcNewDevice("threads=1,user_threads=1");
    if (!device)
      throw Error("RayScene: Embree gave no device");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    add_triangles();
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      release();
      throw Error("RayScene: Embree failed to build the scene, error " + std::to_string(error));
    }
  }
  Impl(const Impl &) = delete;
  Impl &operator=(const Impl &) = delete;
  ~Impl() { release(); }

  Eigen::Vector3d corner(int face, int k) const { return mesh.vertices.row(mesh.faces(face, k)); }

private:
  void add_triangles() {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *v = static_cast<float *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.rows()));
    auto *t = static_cast<unsigned *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), face_of.size()));
    if (v && t) {
      std::copy_n(mesh.vertices.data(), mesh.vertices.size(), v);
      for (std::size_t i = 0; i < face_of.size(); ++i)
        for (int k = 0; k < 3; ++k)
          t[3 * i + k] = static_cast<unsigned>(mesh.faces(face_of[i], k));
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
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
    const Eigen::Vector3d bary = closest_on_triangle(q.point, a, b, c);
    const Eigen::Vector3d at = bary[0] * a + bary[1] * b + bary[2] * c;
    const double distance = (at - q.point).norm();
    // The lowest face wins a tie, so that the answer does not depend on the order of the tree.
    if (!(distance < q.best.distance || (distance == q.best.distance && face < q.best.face)))
      return false;
    q.best = {face, at, bary, distance};
    // Rounded up: the tree works in floats, and must not cut off a face that is as near in doubles.
    const float radius = static_cast<float>(distance * (1 + 1e-5) + 1e-6);
    if (radius < args->query->radius) {
      args->query->radius = radius;
      return true;
    }
    return false;
  }
};

RayScene::RayScene(const Mesh &mesh, const std::vector<std::uint8_t> &skip_face) {
  require_usable(mesh, "RayScene");
  if (!skip_face.empty() && static_cast<Eigen::Index>(skip_face.size()) != mesh.faces.rows())
    throw std::invalid_argument("RayScene: expected " + std::to_string(mesh.faces.rows()) + " entries in skip_face, found " +
                                std::to_string(skip_face.size()));
  impl_ = std::make_shared<Impl>(mesh, skip_face);
  if (impl_->face_of.empty())
    throw Error("RayScene: all " + std::to_string(mesh.faces.rows()) + " faces are skipped");
}

std::optional<RayHit> RayScene::cast(const Eigen::Vector3d &origin, const Eigen::Vector3d &direction, double min_distance,
                                     double max_distance) const {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = static_cast<float>(std::max(0.0, min_distance));
  ray.ray.tfar = static_cast<float>(max_distance);
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return std::nullopt;
  RayHit hit;
  hit.face = impl_->face_of[ray.hit.primID];
  hit.distance = ray.ray.tfar;
  const double u = ray.hit.u, v = ray.hit.v;
  hit.barycentric = {1 - u - v, u, v};
  return hit;
}

bool RayScene::occluded(const Eigen::Vector3d &from, const Eigen::Vector3d &to, double margin) const {
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  if (!(length > 2 * margin))
    return false;
  RTCRay ray{};
  const Eigen::Vector3f o = from.cast<float>(), d = (way / length).cast<float>();
  ray.org_x = o.x();
  ray.org_y = o.y();
  ray.org_z = o.z();
  ray.dir_x = d.x();
  ray.dir_y = d.y();
  ray.dir_z = d.z();
  ray.tnear = static_cast<float>(margin);
  ray.tfar = static_cast<float>(length - margin);
  ray.mask = ~0u;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

ClosestPoint RayScene::closest(const Eigen::Vector3d &point) const {
  if (!point.allFinite())
    throw std::invalid_argument("RayScene::closest: the point is not finite");
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
