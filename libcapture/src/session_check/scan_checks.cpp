#include "session_check/checks.h"

#include "doublet/rays/ray_scene.h"

#include <array>
#include <cmath>

namespace doublet::detail {
namespace {

constexpr double kShortest = 0.5, kUsualHeight = 1.7, kTallest = 2.6; // m, of people in any pose
constexpr double kUpright = 0.7;                                      // of the longest side, along y at least
constexpr double kOutside = 0.05; // m, how far from the scan a marked joint may lie; toes and hands end near the skin
constexpr double kLeastSpread = 0.4, kMostSpread = 1.5; // of the joints over that of the scan
constexpr double kFewOutside = 0.25;                    // share of the joints that may be outside and only doubtful

Eigen::RowVector3d extent(const Vertices &points) {
  return points.colwise().maxCoeff() - points.colwise().minCoeff();
}

/// To the faces and corners of a cube, unit.
std::vector<Eigen::Vector3d> fourteen_directions() {
  std::vector<Eigen::Vector3d> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if ((std::abs(x) + std::abs(y) + std::abs(z)) % 2 == 1)
          directions.push_back(Eigen::Vector3d(x, y, z).normalized());
  return directions;
}

/// Does it see the surface's back in half of the directions? So it is inside, whatever holes and inner walls a scan has.
bool sees_backs(const RayScene &scene, const Vertices &normals, const Eigen::Vector3d &point) {
  static const std::vector<Eigen::Vector3d> directions = fourteen_directions();
  std::size_t backs = 0;
  for (const Eigen::Vector3d &direction : directions)
    if (const auto hit = scene.cast(point, direction))
      backs += normals.row(hit->face).dot(direction) > 0;
  return 2 * backs >= directions.size();
}

} // namespace

std::string likely_unit(double length, double usual) {
  struct Unit {
    double metres;
    const char *name;
  };
  constexpr std::array<Unit, 4> kUnits{{{0.001, "millimetres"}, {0.01, "centimetres"}, {0.0254, "inches"}, {1000, "kilometres"}}};
  const auto off = [&](const Unit &unit) { return std::abs(std::log(std::max(length, 1e-9) * unit.metres / usual)); };
  const Unit &best =
      *std::min_element(kUnits.begin(), kUnits.end(), [&](const Unit &a, const Unit &b) { return off(a) < off(b); });
  return off(best) < std::log(3) ? std::string("; it looks like ") + best.name : "";
}

Findings check_scan(Evidence &evidence) {
  const Eigen::RowVector3d size = extent(evidence.scan.vertices);
  Eigen::Index longest = 0;
  const double most = size.maxCoeff(&longest);
  const std::string where = evidence.session.scan.string();
  if (!(kShortest <= most && most <= kTallest))
    return {{true, where + ": expected a person of " + printed("%g", kShortest) + " to " + printed("%g", kTallest) +
                       " m, found " + printed("%.4g", most) + " m" + likely_unit(most, kUsualHeight)}};
  if (size.y() < kUpright * most)
    return {{true, where + ": expected a person who stands along y, found " + printed("%.2f", size.y()) + " m in y and " +
                       printed("%.2f", most) + " m in " + "xyz"[longest]}};
  return {};
}

Findings check_joints(Evidence &evidence) {
  const std::vector<JointAnnotation> &joints = evidence.session.joints;
  if (joints.empty())
    return {};
  const double spread = extent(evidence.found.joints).maxCoeff(), size = extent(evidence.scan.vertices).maxCoeff();
  const std::string where = "joints of " + evidence.session.folder.string() + ": expected ";
  if (!(kLeastSpread < spread / size && spread / size < kMostSpread))
    return {{true, where + "marks spread over the scan's " + printed("%.3g", size) + " m, found " + printed("%.4g", spread) +
                       " m" + likely_unit(spread, size)}};
  const RayScene scene(evidence.scan);
  const Vertices normals = face_normals(evidence.scan.vertices, evidence.scan.faces);
  std::size_t outside = 0, worst = 0;
  double farthest = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double distance = scene.closest(joints[j].position).distance;
    if (distance <= kOutside || sees_backs(scene, normals, joints[j].position))
      continue;
    ++outside;
    if (distance > farthest) {
      farthest = distance;
      worst = j;
    }
  }
  if (outside == 0)
    return {};
  const double total = static_cast<double>(joints.size());
  return {{static_cast<double>(outside) / total > kFewOutside,
           where + "every joint inside the scan, found " + std::to_string(outside) + " of " + std::to_string(joints.size()) +
               " more than " + printed("%.0f", 1000 * kOutside) + " mm outside (" + joints[worst].name + " by " +
               printed("%.0f", 1000 * farthest) + " mm)"}};
}

} // namespace doublet::detail
