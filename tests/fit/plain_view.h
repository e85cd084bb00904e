#pragma once
// What ClothView finds, found plainly: every edge and every feature tried against every face, one sample at a time in double
// precision.

#include "../../libfit/src/cloth_view.h"
#include "doublet/core/rasterizer.h"

#include <cmath>
#include <optional>
#include <set>

namespace doublet::testing {

/// Everything of the character that is not cloth, in coarse pixels.
inline fit::CoarseBuffer draw_others(const CharacterSimulator &simulator, const fit::ClothTopology &topology,
                                     const PosedFrame &frame, const fit::CoarseCamera &camera) {
  std::vector<std::uint8_t> rest = simulator.actor().face_valid;
  for (std::size_t f = 0; f < rest.size(); ++f)
    rest[f] = rest[f] && !topology.face_is_cloth[f];
  const Camera coarse = camera.camera.resized(camera.width, camera.height);
  const FaceBuffer body = rasterize(frame.skinned, simulator.actor().mesh.faces, coarse, rest);
  const Mesh capsules = capsule_mesh(frame.capsules);
  const FaceBuffer legs = rasterize(capsules.vertices, capsules.faces, coarse);
  fit::CoarseBuffer others{0, 0, camera.width, camera.height, {}};
  for (std::size_t i = 0; i < body.depth.size(); ++i)
    others.inverse_depth.push_back(1.f / std::min(body.depth[i], legs.depth[i]));
  return others;
}

class PlainView {
public:
  /// surface (V, 3) of the whole character.
  PlainView(const fit::ClothTopology &topology, const Vertices &surface, const fit::CoarseCamera &camera,
            const fit::CoarseBuffer &others)
      : topology_(topology), camera_(camera), others_(others), surface_(topology.vertices.size(), 3),
        faces_(topology.face_count(), 3) {
    for (std::size_t i = 0; i < topology.vertices.size(); ++i) {
      surface_.row(static_cast<Eigen::Index>(i)) = surface.row(topology.vertices[i]);
      pixels_.push_back(camera.camera.project(surface_.row(static_cast<Eigen::Index>(i)).transpose()));
    }
    for (int f = 0; f < topology.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        faces_(f, k) = topology.corners[3 * f + k];
  }

  /// Ends of the edges between front and back faces, and of the hem's, that have nothing beside them half a pixel off.
  std::set<int> outline() const {
    std::set<int> result;
    for (const fit::ClothEdge &edge : topology_.edges) {
      const double left = area(edge.left), right = edge.right >= 0 ? area(edge.right) : 0;
      if (edge.right >= 0 ? left * right >= 0 : !edge.hem)
        continue;
      const Eigen::Vector2d along = pixels_[edge.b] - pixels_[edge.a];
      Eigen::Vector2d out = Eigen::Vector2d(along.y(), -along.x()).normalized(); // of a face with positive area
      if (left < 0)
        out = -out;
      const Eigen::Vector2d beside = (pixels_[edge.a] + pixels_[edge.b]) / 2 + 0.5 * out;
      if (behind(beside) > 0 || covered(beside))
        continue;
      for (int v : {edge.a, edge.b})
        if (topology_.region[v] >= 0 && inside(pixels_[v]) &&
            behind(pixels_[v]) < 1 / (camera_.camera.depth(surface_.row(v).transpose()) - kInFront))
          result.insert(v);
    }
    return result;
  }

  /// The visible place of the cloth under a pixel: face and barycentric coordinates.
  std::optional<std::pair<int, Eigen::Vector3d>> place_under(const Eigen::Vector2d &p) const {
    std::optional<std::pair<int, Eigen::Vector3d>> nearest;
    double depth = behind(p) > 0 ? 1 / behind(p) + kInFront : 1e9;
    for (int f = 0; f < topology_.face_count(); ++f) {
      const Eigen::Vector3d b = barycentric_at(surface_, faces_, f, camera_.camera, p);
      const double here = camera_.camera.depth(point_at(f, b));
      if (b.minCoeff() >= 0 && here < depth && here > fit::kNear) {
        depth = here;
        nearest = {f, b};
      }
    }
    return nearest;
  }
  std::optional<Eigen::Vector3d> point_under(const Eigen::Vector2d &p) const {
    const auto place = place_under(p);
    return place ? std::optional(point_at(place->first, place->second)) : std::nullopt;
  }

private:
  static constexpr double kInFront = 0.01; // m: what touches the cloth does not hide it

  double behind(const Eigen::Vector2d &p) const {
    return others_.at(static_cast<int>(std::lround(camera_.coarse_x(static_cast<float>(p.x())))),
                      static_cast<int>(std::lround(camera_.coarse_y(static_cast<float>(p.y())))));
  }
  bool inside(const Eigen::Vector2d &p) const {
    return p.minCoeff() >= 0 && p.x() <= camera_.camera.width - 1 && p.y() <= camera_.camera.height - 1;
  }
  bool covered(const Eigen::Vector2d &p) const {
    for (int f = 0; f < topology_.face_count(); ++f)
      if (barycentric_at(surface_, faces_, f, camera_.camera, p).minCoeff() >= 0)
        return true;
    return false;
  }
  Eigen::Vector3d point_at(int f, const Eigen::Vector3d &barycentric) const {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      point += barycentric[k] * surface_.row(faces_(f, k)).transpose();
    return point;
  }
  double area(int f) const {
    const Eigen::Vector2d a = pixels_[faces_(f, 0)], b = pixels_[faces_(f, 1)] - a, c = pixels_[faces_(f, 2)] - a;
    return b.x() * c.y() - b.y() * c.x();
  }

  const fit::ClothTopology &topology_;
  const fit::CoarseCamera &camera_;
  const fit::CoarseBuffer &others_;
  Vertices surface_;
  Faces faces_;
  std::vector<Eigen::Vector2d> pixels_;
};

} // namespace doublet::testing
