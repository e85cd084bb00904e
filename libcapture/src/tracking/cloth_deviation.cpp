#include "cloth_deviation.h"

#include "tracked_actor.h"

#include <algorithm>

namespace doublet::detail {
namespace {

/// (V) m, before anything is known: what skinning leaves on a body, and more where the surface is farther from the bone of a
/// limb than flesh reaches. That is clothing, and what a wide garment does must not be taken for the limb's motion.
Eigen::VectorXd expected_deviation(const RiggedMesh &actor) {
  constexpr double kSkin = 0.005, kFlesh = 0.2, kSwing = 1.0; // m; of the bone's length; of what lies beyond it
  Eigen::VectorXd expected = Eigen::VectorXd::Constant(actor.mesh.vertices.rows(), kSkin);
  const std::vector<Joint> &joints = actor.skeleton.joints;
  const std::vector<int> ends = limb_bones(actor.skeleton);
  for (int i = 0; i < expected.size(); ++i) {
    Eigen::Index owner;
    actor.weights.row(i).maxCoeff(&owner);
    if (ends[owner] < 0)
      continue;
    const Eigen::Vector3d x = actor.mesh.vertices.row(i).transpose() - joints[owner].rest;
    const Eigen::Vector3d bone = joints[ends[owner]].rest - joints[owner].rest;
    const double along = std::clamp(x.dot(bone) / bone.squaredNorm(), 0.0, 1.0);
    expected[i] += kSwing * std::max(0.0, (x - along * bone).norm() - kFlesh * bone.norm());
  }
  return expected;
}

/// Of the valid faces: what a garment does says nothing about the legs below its hem.
std::vector<std::pair<int, int>> scanned_edges(const RiggedMesh &actor) {
  std::vector<std::pair<int, int>> edges;
  for (int f = 0; f < actor.mesh.faces.rows(); ++f)
    for (int c = 0; actor.face_valid[f] && c < 3; ++c)
      edges.emplace_back(std::minmax(actor.mesh.faces(f, c), actor.mesh.faces(f, (c + 1) % 3)));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

} // namespace

ClothDeviation::ClothDeviation(const RiggedMesh &actor, double loose)
    : edges_(scanned_edges(actor)), loose_(loose), all_(expected_deviation(actor).cwiseAbs2()), recent_(all_) {}

void ClothDeviation::learn(const Vertices &refined, const Vertices &skinned) {
  const Eigen::VectorXd squared = (refined - skinned).rowwise().squaredNorm();
  all_ += (squared - all_) / ++frames_;
  recent_ += 0.1 * (squared - recent_);
}

void ClothDeviation::settle(const std::vector<Vertices> &offsets) {
  const size_t middle = offsets.size() / 2;
  std::vector<double> squared(offsets.size());
  for (int i = 0; i < all_.size(); ++i) {
    for (size_t t = 0; t < offsets.size(); ++t)
      squared[t] = offsets[t].row(i).squaredNorm();
    std::nth_element(squared.begin(), squared.begin() + middle, squared.end());
    all_[i] = squared[middle];
  }
  recent_ = all_;
  frames_ = static_cast<int>(offsets.size());
}

Eigen::VectorXd ClothDeviation::reliability() const {
  Eigen::VectorXd d = all_.cwiseMax(recent_);
  for (int round = 0; round < 3; ++round)
    d = spread(d);
  return (1 + d.array() / (loose_ * loose_)).inverse();
}

/// The mean of a vertex and its neighbourhood.
Eigen::VectorXd ClothDeviation::spread(const Eigen::VectorXd &d) const {
  Eigen::VectorXd sum = d, count = Eigen::VectorXd::Ones(d.size());
  for (const auto &[a, b] : edges_) {
    sum[a] += d[b];
    sum[b] += d[a];
    count[a] += 1;
    count[b] += 1;
  }
  return sum.cwiseQuotient(count);
}

Vertices rest_offset(const RiggedMesh &actor, const Transforms &blend, const Vertices &surface) {
  Vertices offset(surface.rows(), 3);
  for (int i = 0; i < surface.rows(); ++i)
    offset.row(i) = (blend[i].inverse() * Eigen::Vector3d(surface.row(i))).transpose() - actor.mesh.vertices.row(i);
  return offset;
}

SurfaceMemory::SurfaceMemory(const RiggedMesh &actor, double loose, double decay, int count)
    : actor_(actor), decay_(decay), deviation_(actor, loose), expected_(Vertices::Zero(actor.mesh.vertices.rows(), 3)),
      offsets_(count) {}

void SurfaceMemory::learn(int t, const Vertices &refined, const PosedSurface &skinned) {
  deviation_.learn(refined, skinned.vertices);
  offsets_[t] = rest_offset(actor_, skinned.blend, refined);
  expected_ = decay_ * (deviation_.looseness().asDiagonal() * offsets_[t]);
}

void SurfaceMemory::start_again(int t) {
  deviation_.settle(offsets_);
  expected_.setZero();
  if (t >= 0)
    expected_ = deviation_.looseness().asDiagonal() * offsets_[t];
}

} // namespace doublet::detail
