#pragma once
// A rigged figure with a textured skin, a ring of cameras around it, and its motion rendered: a capture with known truth.

#include "doublet/capture/performance_capture.h"
#include "doublet/core/skinning.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>

namespace tracker_scene {

using doublet::Vertices;

/// A closed body of three limbs in a row along y: middle (root, 6 dof) with an upper and a lower one (3 dof each). Its sections
/// are no circles, so that silhouettes tell every rotation.
inline doublet::RiggedMesh figure() {
  constexpr int kAround = 28, kRings = 45;
  constexpr double kLength = 1.6;
  doublet::RiggedMesh actor;
  Vertices v(kAround * kRings + 2, 3);
  for (int r = 0; r < kRings; ++r)
    for (int a = 0; a < kAround; ++a) {
      const double y = kLength * r / (kRings - 1), phi = 2 * std::numbers::pi * a / kAround;
      const double taper = std::sqrt(std::max(0.02, 1 - std::pow(std::abs(2 * y / kLength - 1), 6)));
      const double x = 0.20 + 0.05 * std::sin(7 * y), z = 0.10 + 0.03 * std::cos(5 * y);
      v.row(r * kAround + a) << taper * x * std::sin(phi) + 0.04 * std::sin(4 * y), y, taper * z * std::cos(phi);
    }
  v.row(kAround * kRings) << 0, -0.01, 0;
  v.row(kAround * kRings + 1) << 0.04 * std::sin(4 * kLength), kLength + 0.01, 0;
  doublet::Faces f(2 * kAround * kRings, 3);
  int n = 0;
  for (int r = 0; r + 1 < kRings; ++r)
    for (int a = 0; a < kAround; ++a) {
      const int b = (a + 1) % kAround, i = r * kAround + a, j = r * kAround + b;
      f.row(n++) << i, j, i + kAround;
      f.row(n++) << j, j + kAround, i + kAround;
    }
  for (int a = 0; a < kAround; ++a) {
    const int b = (a + 1) % kAround, top = (kRings - 1) * kAround;
    f.row(n++) << kAround * kRings, b, a;
    f.row(n++) << kAround * kRings + 1, top + a, top + b;
  }
  actor.mesh = {v, f};
  actor.face_valid.assign(f.rows(), 1);
  actor.skeleton = doublet::make_skeleton(
      {{"middle", "", {0, 0.8, 0}, 6}, {"upper", "middle", {0, 1.1, 0}, 3}, {"lower", "middle", {0, 0.5, 0}, 3}});
  actor.weights.resize(v.rows(), 3);
  for (int i = 0; i < v.rows(); ++i) {
    const double up = std::clamp((v(i, 1) - 1.0) / 0.2, 0.0, 1.0), low = std::clamp((0.6 - v(i, 1)) / 0.2, 0.0, 1.0);
    actor.weights.row(i) << 1 - up - low, up, low;
  }
  return actor;
}

/// `count` cameras of `size` x `size` pixels on a ring of 3.5 m, some looking from above, with lens distortion.
inline doublet::CameraRig ring(int count = 8, int size = 240) {
  doublet::CameraRig rig;
  for (int c = 0; c < count; ++c) {
    const double angle = 2 * std::numbers::pi * c / count + 0.1;
    const Eigen::Vector3d centre(3.5 * std::sin(angle), 0.9 + 0.8 * (c % 2), 3.5 * std::cos(angle)), target(0, 0.8, 0);
    doublet::Camera camera;
    camera.name = "cam" + std::to_string(c);
    camera.width = camera.height = size;
    camera.K << 1.35 * size, 0, size / 2. - 0.5, 0, 1.35 * size, size / 2. - 0.5, 0, 0, 1;
    camera.distortion << -0.05, 0.01, 0.001, -0.001, 0;
    const Eigen::Vector3d forward = (target - centre).normalized(), right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
    camera.R.row(0) = right;
    camera.R.row(1) = forward.cross(right);
    camera.R.row(2) = forward;
    camera.t = -camera.R * centre;
    rig.push_back(camera);
  }
  return rig;
}

/// Grey of a point of the rest pose: blobs of a few centimetres, the same on every side.
inline double texture(const Eigen::Vector3d &p) {
  const double a =
      std::sin(61 * p.x() + 13 * p.y() + 3) * std::sin(53 * p.y() - 17 * p.z()) * std::sin(47 * p.z() + 29 * p.x() + 1);
  const double b = std::sin(131 * p.x() - 71 * p.y()) * std::sin(113 * p.y() + 90 * p.z() + 2);
  return std::clamp(128 + 90 * a + 50 * b, 5.0, 250.0);
}

/// Frames rendered from known surfaces, once, however often they are asked for.
class Frames : public doublet::FrameSource {
public:
  Frames(const doublet::RiggedMesh &actor, const doublet::CameraRig &rig, std::vector<Vertices> surfaces)
      : actor_(actor), rig_(rig), surfaces_(std::move(surfaces)) {}

  int frame_count() const override { return static_cast<int>(surfaces_.size()); }
  int camera_count() const override { return static_cast<int>(rig_.size()); }

  doublet::Image image(int camera, int frame) override {
    return is_missing(camera, frame) ? doublet::Image() : once(images_, camera, frame, [&] { return drawn(camera, frame); });
  }
  doublet::Image mask(int camera, int frame) override {
    if (is_missing(camera, frame))
      return {};
    return once(masks_, camera, frame, [&] { return doublet::silhouette(render(camera, frame)); });
  }

  std::function<bool(int camera, int frame)> missing;

private:
  using Drawn = std::map<std::pair<int, int>, doublet::Image>;
  template <class Draw> doublet::Image once(Drawn &known, int camera, int frame, const Draw &draw) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = known.find({camera, frame}); found != known.end())
        return found->second;
    }
    const doublet::Image image = draw(); // threads draw side by side
    const std::lock_guard lock(mutex_);
    return known.emplace(std::pair(camera, frame), image).first->second;
  }
  doublet::Image drawn(int camera, int frame) const {
    const doublet::FaceBuffer buffer = render(camera, frame);
    doublet::Image image(buffer.width, buffer.height, 3, 0);
    for (int y = 0; y < buffer.height; ++y)
      for (int x = 0; x < buffer.width; ++x)
        if (const int f = buffer.face_at(x, y); f >= 0) {
          const Eigen::Vector3d b = doublet::barycentric_at(surfaces_[frame], actor_.mesh.faces, f, rig_[camera], {x, y});
          const doublet::SurfacePoint point{f, b};
          const auto grey = static_cast<std::uint8_t>(texture(point.position(actor_.mesh.vertices, actor_.mesh.faces)));
          for (int c = 0; c < 3; ++c)
            image.at(x, y, c) = grey;
        }
    return image;
  }
  bool is_missing(int camera, int frame) const { return missing && missing(camera, frame); }
  doublet::FaceBuffer render(int camera, int frame) const {
    return doublet::rasterize(surfaces_[frame], actor_.mesh.faces, rig_[camera]);
  }

  doublet::RiggedMesh actor_;
  doublet::CameraRig rig_;
  std::vector<Vertices> surfaces_;
  std::mutex mutex_;
  Drawn images_, masks_;
};

/// A dance: (T, D), about 4 degrees and 2 cm a frame at its fastest.
inline doublet::MatrixRM motion(const doublet::RiggedMesh &actor, int frames) {
  doublet::MatrixRM dofs = doublet::MatrixRM::Zero(frames, actor.skeleton.dof_count());
  for (int t = 0; t < frames; ++t)
    for (int d = 0; d < dofs.cols(); ++d)
      dofs(t, d) = (d < 3 ? 0.10 : 0.35) * (std::sin(0.20 * t + d) - std::sin(d));
  return dofs;
}

inline std::vector<Vertices> surfaces(const doublet::RiggedMesh &actor, const doublet::MatrixRM &dofs,
                                      const Vertices &offset = {}) {
  std::vector<Vertices> result;
  for (int t = 0; t < dofs.rows(); ++t)
    result.push_back(doublet::pose_surface(actor, dofs.row(t), offset).vertices);
  return result;
}

inline double mean_distance(const Vertices &a, const Vertices &b) {
  return (a - b).rowwise().norm().mean();
}

} // namespace tracker_scene
