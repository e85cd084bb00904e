#include "doublet/animate/parts/body_penetration.h"

#include "area_vectors.h"

namespace doublet {
namespace {

// m; deeper under cloth, because the body's triangles are flat where the cloth folds inward between their corners
constexpr double kDeepUnderSkin = 0.003, kDeepUnderCloth = 0.010, kReachUnderSkin = 0.012, kReachUnderCloth = 0.06;

} // namespace

BodyPenetrationFix::BodyPenetrationFix(const Character &character)
    : faces_(character.actor.mesh.faces), clothness_(character.segmentation.clothness),
      surface_(character.actor.mesh, character.actor.face_valid) {
  std::vector<std::uint8_t> drawn(character.body.vertices.rows(), 0);
  for (Eigen::Index f = 0; f < character.body.faces.rows(); ++f)
    for (int k = 0; k < 3 && character.body_shown[f]; ++k)
      drawn[character.body.faces(f, k)] = 1;
  for (std::size_t v = 0; v < drawn.size(); ++v)
    if (drawn[v])
      drawn_.push_back(static_cast<int>(v));
  last_.assign(drawn_.size(), -1);
}

void BodyPenetrationFix::apply(const Vertices &surface, Vertices &body) {
  surface_.move_to(surface);
  detail::sum_area_vectors(surface, faces_, normals_);
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    const int v = drawn_[i];
    const Eigen::Vector3d p = body.row(v);
    const std::optional<MovingSurface::Point> at = surface_.closest(p, kReachUnderCloth, last_[i]);
    last_[i] = at ? at->face : -1;
    if (!at)
      continue;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double cloth = 0;
    for (int k = 0; k < 3; ++k) {
      normal += at->barycentric[k] * normals_.row(faces_(at->face, k)).normalized().transpose();
      cloth += at->barycentric[k] * clothness_[faces_(at->face, k)];
    }
    const double out = (p - at->point).dot(normal);
    const double deep = kDeepUnderSkin + cloth * (kDeepUnderCloth - kDeepUnderSkin);
    if (normal.norm() > 0.1 && out > -deep && at->distance < (cloth > 0 ? kReachUnderCloth : kReachUnderSkin))
      body.row(v) = at->point - deep * normal.normalized();
  }
}

} // namespace doublet
