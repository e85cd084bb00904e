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

void lane_spin(const float *inertia, const float *momentum, float *spin) {
  Eigen::Matrix3d about;
  about << inertia[0], inertia[1], inertia[2], inertia[1], inertia[3], inertia[4], inertia[2], inertia[4], inertia[5];
  const Eigen::Vector3d turning(momentum[0], momentum[1], momentum[2]);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(about);
  // A piece crumpled into a line has no inertia about it: leave that turn alone.
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a)
    if (axes.eigenvalues()[a] > 1e-5 * axes.eigenvalues()[2])
      rate += axes.eigenvectors().col(a).dot(turning) / axes.eigenvalues()[a] * axes.eigenvectors().col(a);
  for (int k = 0; k < 3; ++k)
    spin[k] = static_cast<float>(rate[k]);
}

} // namespace doublet::pbd
