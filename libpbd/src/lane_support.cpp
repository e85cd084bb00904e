// What the loops ask of the rest of the program, see lane_group.h.

#include "kernels.h"
#include "lane_group.h"

#include <Eigen/Dense>
#include <new>

namespace doublet::pbd {

LaneGroup::LaneGroup() = default;
LaneGroup::~LaneGroup() = default;

void *lane_allocate(unsigned long bytes) {
  return ::operator new(bytes, std::align_val_t(64));
}
void lane_free(void *block) {
  ::operator delete(block, std::align_val_t(64));
}

void damp_lane(const LaneModel &model, const float *x, float *v, int vertex_stride, int lanes, float k) {
  const auto place = [&](int i) {
    const float *p = x + static_cast<long>(i) * vertex_stride;
    return Eigen::Vector3d(p[0], p[lanes], p[2 * lanes]);
  };
  const auto velocity_of = [&](int i) {
    const float *p = v + 3L * i * lanes;
    return Eigen::Vector3d(p[0], p[lanes], p[2 * lanes]);
  };
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  for (int i = 0; i < model.vertex_count; ++i)
    if (model.weights[i] > 0) {
      const double m = 1.0 / model.weights[i];
      mass += m;
      centre += m * place(i);
      velocity += m * velocity_of(i);
    }
  if (mass == 0)
    return;
  centre /= mass;
  velocity /= mass;
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int i = 0; i < model.vertex_count; ++i)
    if (model.weights[i] > 0) {
      const double m = 1.0 / model.weights[i];
      const Eigen::Vector3d r = place(i) - centre;
      angular_momentum += m * r.cross(velocity_of(i));
      inertia += m * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
    }
  // A piece crumpled into a line has no inertia about it: leave that turn alone.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a)
    if (axes.eigenvalues()[a] > 1e-9 * axes.eigenvalues()[2])
      spin += axes.eigenvectors().col(a).dot(angular_momentum) / axes.eigenvalues()[a] * axes.eigenvectors().col(a);
  for (int i = 0; i < model.vertex_count; ++i)
    if (model.weights[i] > 0) {
      const Eigen::Vector3f rigid = (velocity + spin.cross(place(i) - centre)).cast<float>();
      float *p = v + 3L * i * lanes;
      for (int c = 0; c < 3; ++c)
        p[c * lanes] += k * (rigid[c] - p[c * lanes]);
    }
}

} // namespace doublet::pbd
