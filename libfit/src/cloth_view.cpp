#include "cloth_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace doublet::fit {
namespace {

constexpr double kNear = 0.05;    // m, as rasterize()
constexpr float kFarOut = 1e6f;   // pixels; beyond it nothing is drawn
constexpr int kWalkSteps = 12;    // coarse pixels are a few faces wide at most
constexpr float kInside = -1e-3f; // barycentric slack, so that rounding at an edge does not send the walk back and forth

std::map<std::pair<int, int>, int> half_edges(const Faces &faces, const std::vector<int> &chosen) {
  std::map<std::pair<int, int>, int> result;
  for (int f : chosen)
    for (int k = 0; k < 3; ++k)
      result[{faces(f, (k + 1) % 3), faces(f, (k + 2) % 3)}] = f;
  return result;
}

} // namespace

ClothTopology cloth_topology(const CharacterSimulator &simulator) {
  const RiggedMesh &actor = simulator.actor();
  const Faces &faces = actor.mesh.faces;
  std::vector<int> region_of(actor.mesh.vertices.rows(), -1);
  for (std::size_t r = 0; r < simulator.regions().size(); ++r) {
    const ClothRegion &region = simulator.regions()[r];
    for (std::size_t i = 0; i < region.vertex_from_cloth.size(); ++i)
      if (region.model->inverse_masses()[static_cast<Eigen::Index>(i)] > 0)
        region_of[region.vertex_from_cloth[i]] = static_cast<int>(r);
  }

  std::vector<int> valid, moving;
  std::vector<int> face_region(faces.rows(), -1);
  for (int f = 0; f < faces.rows(); ++f) {
    if (!actor.face_valid[f])
      continue;
    valid.push_back(f);
    for (int k = 0; k < 3; ++k)
      face_region[f] = std::max(face_region[f], region_of[faces(f, k)]);
    if (face_region[f] >= 0)
      moving.push_back(f);
  }

  ClothTopology result;
  result.face_is_cloth.assign(faces.rows(), 0);
  std::vector<int> local(actor.mesh.vertices.rows(), -1), local_face(faces.rows(), -1);
  for (int f : moving) {
    result.face_is_cloth[f] = 1;
    local_face[f] = static_cast<int>(result.faces.size());
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      int &index = local[faces(f, k)];
      if (index < 0) {
        index = static_cast<int>(result.vertices.size());
        result.vertices.push_back(faces(f, k));
        result.region.push_back(region_of[faces(f, k)]);
      }
      corners[k] = index;
    }
    result.faces.push_back(corners);
    result.face_region.push_back(face_region[f]);
  }
  const auto edges = half_edges(faces, valid);
  result.hem.assign(result.vertices.size(), 0);
  for (int f : moving) {
    std::array<int, 3> across{-1, -1, -1};
    for (int k = 0; k < 3; ++k) {
      const int a = faces(f, (k + 1) % 3), b = faces(f, (k + 2) % 3);
      const auto twin = edges.find({b, a});
      if (twin == edges.end())
        result.hem[local[a]] = result.hem[local[b]] = 1;
      else
        across[k] = local_face[twin->second];
    }
    result.neighbours.push_back(across);
  }
  return result;
}

CoarseCamera::CoarseCamera(const Camera &c, int larger_side) : camera(c) {
  const double factor = std::min(1.0, larger_side / static_cast<double>(std::max(c.width, c.height)));
  width = std::max(1, static_cast<int>(std::lround(c.width * factor)));
  height = std::max(1, static_cast<int>(std::lround(c.height * factor)));
  scale_x = static_cast<float>(width) / static_cast<float>(c.width);
  scale_y = static_cast<float>(height) / static_cast<float>(c.height);
}

void ClothView::project(const Vertices &surface) {
  const Camera &camera = camera_->camera;
  const std::size_t count = topology_->vertices.size();
  projected_.resize(count);
  coarse_.resize(count);
  const bool distorted = camera.distorted();
  const Eigen::Matrix3d KR = camera.K * camera.R;
  const Eigen::Vector3d Kt = camera.K * camera.t;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point = surface.row(topology_->vertices[i]).transpose();
    const Eigen::Vector3d image = KR * point + Kt; // K's last row is (0, 0, 1): z is the depth
    Projected &p = projected_[i];
    p = {};
    if (!(image.z() > kNear))
      continue;
    const Eigen::Vector2d pixel = distorted ? camera.project(point) : Eigen::Vector2d(image.head<2>() / image.z());
    if (!(pixel.cwiseAbs().maxCoeff() < kFarOut))
      continue;
    p = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), static_cast<float>(1 / image.z())};
    coarse_[i] = {camera_->coarse_x(p.x), camera_->coarse_y(p.y), p.inverse_depth};
  }
}

void ClothView::clear(const CoarseBuffer &others) {
  float x0 = kFarOut, y0 = kFarOut, x1 = -kFarOut, y1 = -kFarOut;
  for (std::size_t i = 0; i < projected_.size(); ++i)
    if (projected_[i].inverse_depth > 0) {
      x0 = std::min(x0, coarse_[i].x), x1 = std::max(x1, coarse_[i].x);
      y0 = std::min(y0, coarse_[i].y), y1 = std::max(y1, coarse_[i].y);
    }
  // Two pixels more, so that the background beside the outline is there to be seen.
  buffer_.x0 = static_cast<int>(std::clamp(std::floor(x0) - 2, 0.f, static_cast<float>(camera_->width)));
  buffer_.y0 = static_cast<int>(std::clamp(std::floor(y0) - 2, 0.f, static_cast<float>(camera_->height)));
  buffer_.width =
      std::max(0, static_cast<int>(std::clamp(std::ceil(x1) + 3, 0.f, static_cast<float>(camera_->width))) - buffer_.x0);
  buffer_.height =
      std::max(0, static_cast<int>(std::clamp(std::ceil(y1) + 3, 0.f, static_cast<float>(camera_->height))) - buffer_.y0);
  const std::size_t size = static_cast<std::size_t>(buffer_.width) * buffer_.height;
  buffer_.inverse_depth.assign(size, 0.f);
  buffer_.face.assign(size, -1);
  const int left = std::max(buffer_.x0, others.x0), right = std::min(buffer_.x0 + buffer_.width, others.x0 + others.width);
  const int top = std::max(buffer_.y0, others.y0), bottom = std::min(buffer_.y0 + buffer_.height, others.y0 + others.height);
  for (int y = top; y < bottom && left < right; ++y)
    std::copy_n(&others.inverse_depth[others.index(left, y)], right - left, &buffer_.inverse_depth[buffer_.index(left, y)]);
}

void ClothView::draw_face(int face) {
  const auto &corners = topology_->faces[face];
  Projected a = coarse_[corners[0]], b = coarse_[corners[1]], c = coarse_[corners[2]];
  if (projected_[corners[0]].inverse_depth <= 0 || projected_[corners[1]].inverse_depth <= 0 ||
      projected_[corners[2]].inverse_depth <= 0)
    return;
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  // y points down: a face that is counter-clockwise from outside has negative area where its outside is seen.
  const std::uint8_t facing = area < 0 ? 1 : 2;
  for (int corner : corners)
    facing_[corner] |= facing;
  if (area == 0)
    return;
  if (area < 0)
    std::swap(b, c);
  const int x0 = std::max(buffer_.x0, static_cast<int>(std::ceil(std::min({a.x, b.x, c.x}))));
  const int x1 = std::min(buffer_.x0 + buffer_.width - 1, static_cast<int>(std::floor(std::max({a.x, b.x, c.x}))));
  const int y0 = std::max(buffer_.y0, static_cast<int>(std::ceil(std::min({a.y, b.y, c.y}))));
  const int y1 = std::min(buffer_.y0 + buffer_.height - 1, static_cast<int>(std::floor(std::max({a.y, b.y, c.y}))));
  const float scale = 1.f / std::fabs(area);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      const float wa = (c.x - b.x) * (fy - b.y) - (c.y - b.y) * (fx - b.x);
      const float wb = (a.x - c.x) * (fy - c.y) - (a.y - c.y) * (fx - c.x);
      const float wc = (b.x - a.x) * (fy - a.y) - (b.y - a.y) * (fx - a.x);
      if (wa < 0 || wb < 0 || wc < 0)
        continue;
      const float inverse_depth = (wa * a.inverse_depth + wb * b.inverse_depth + wc * c.inverse_depth) * scale;
      const std::size_t i = buffer_.index(x, y);
      if (inverse_depth > buffer_.inverse_depth[i]) {
        buffer_.inverse_depth[i] = inverse_depth;
        buffer_.face[i] = face;
      }
    }
}

void ClothView::draw(const Vertices &surface, const CoarseCamera &camera, const CoarseBuffer &others) {
  camera_ = &camera;
  project(surface);
  clear(others);
  facing_.assign(topology_->vertices.size(), 0);
  for (int f = 0; f < static_cast<int>(topology_->faces.size()); ++f)
    draw_face(f);
}

bool ClothView::on_outline(int vertex) const {
  const Projected &p = coarse_[vertex];
  const int px = static_cast<int>(std::lround(p.x)), py = static_cast<int>(std::lround(p.y));
  bool background = false, seen = false;
  for (int y = py - 1; y <= py + 1; ++y)
    for (int x = px - 1; x <= px + 1; ++x) {
      if (!buffer_.holds(x, y))
        continue;
      const std::size_t i = buffer_.index(x, y);
      background |= buffer_.inverse_depth[i] == 0;
      if (buffer_.face[i] >= 0) {
        const auto &corners = topology_->faces[buffer_.face[i]];
        seen |= corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
      }
    }
  return background && seen;
}

void ClothView::outline(std::vector<int> &result) const {
  result.clear();
  const float width = static_cast<float>(camera_->camera.width), height = static_cast<float>(camera_->camera.height);
  for (int v = 0; v < static_cast<int>(topology_->vertices.size()); ++v) {
    const Projected &p = projected_[v];
    const bool rim = facing_[v] == 3 || (topology_->hem[v] && facing_[v] != 0);
    if (!rim || topology_->region[v] < 0 || p.inverse_depth <= 0)
      continue;
    if (p.x < 0 || p.y < 0 || p.x > width - 1 || p.y > height - 1)
      continue;
    if (on_outline(v))
      result.push_back(v);
  }
}

std::optional<SurfacePoint> ClothView::locate(const Eigen::Vector2f &pixel) const {
  const int x = static_cast<int>(std::lround(camera_->coarse_x(pixel.x()))),
            y = static_cast<int>(std::lround(camera_->coarse_y(pixel.y())));
  if (!buffer_.holds(x, y))
    return std::nullopt;
  int face = buffer_.face[buffer_.index(x, y)], previous = -1;
  for (int step = 0; step < kWalkSteps && face >= 0; ++step) {
    const auto &corners = topology_->faces[face];
    const Projected &a = projected_[corners[0]], &b = projected_[corners[1]], &c = projected_[corners[2]];
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0 || a.inverse_depth <= 0 || b.inverse_depth <= 0 || c.inverse_depth <= 0)
      return std::nullopt;
    Eigen::Vector3f weights((c.x - b.x) * (pixel.y() - b.y) - (c.y - b.y) * (pixel.x() - b.x),
                            (a.x - c.x) * (pixel.y() - c.y) - (a.y - c.y) * (pixel.x() - c.x),
                            (b.x - a.x) * (pixel.y() - a.y) - (b.y - a.y) * (pixel.x() - a.x));
    weights /= area;
    int worst = 0;
    if (weights.minCoeff(&worst) >= kInside) {
      // Linear in the image after division by depth: perspective-correct.
      weights = weights.cwiseMax(0.f).cwiseProduct(Eigen::Vector3f(a.inverse_depth, b.inverse_depth, c.inverse_depth));
      return SurfacePoint{face, weights / weights.sum()};
    }
    const int next = topology_->neighbours[face][worst];
    if (next == previous) // over the fold: the pixel is beside the cloth
      return std::nullopt;
    previous = face;
    face = next;
  }
  return std::nullopt;
}

Mesh capsule_mesh(const std::vector<pbd::Capsule> &capsules) {
  constexpr int kSegments = 16, kRings = 10; // from pole to pole; half on each sphere
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const pbd::Capsule &capsule : capsules) {
    pbd::Capsule c = capsule;
    const Eigen::Vector3d between = c.p1 - c.p0;
    const double length = between.norm();
    const bool nested = length <= std::fabs(c.r0 - c.r1);
    if (nested) { // one sphere holds the other
      c.p0 = c.p1 = c.r0 > c.r1 ? c.p0 : c.p1;
      c.r0 = c.r1 = std::max(c.r0, c.r1);
    }
    const double slope = nested ? 0.0 : (c.r0 - c.r1) / length; // sine of the cone's half angle
    const Eigen::Vector3d axis = length > 0 ? Eigen::Vector3d(between / length) : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d u = axis.unitOrthogonal(), w = axis.cross(u);
    const double tangent = std::asin(slope); // latitude at which sphere and cone touch
    const int first = static_cast<int>(vertices.size());
    for (int ring = 0; ring < kRings; ++ring) {
      const bool lower = ring < kRings / 2;
      const double part = lower ? ring / (kRings / 2 - 1.0) : (ring - kRings / 2) / (kRings / 2 - 1.0);
      const double latitude = lower ? -M_PI_2 + part * (tangent + M_PI_2) : tangent + part * (M_PI_2 - tangent);
      const double radius = lower ? c.r0 : c.r1;
      for (int s = 0; s < kSegments; ++s) {
        const double angle = 2 * M_PI * s / kSegments;
        const Eigen::Vector3d around = std::cos(angle) * u + std::sin(angle) * w;
        vertices.push_back((lower ? c.p0 : c.p1) + radius * (std::sin(latitude) * axis + std::cos(latitude) * around));
      }
    }
    for (int ring = 0; ring + 1 < kRings; ++ring)
      for (int s = 0; s < kSegments; ++s) {
        const int a = first + ring * kSegments + s, b = first + ring * kSegments + (s + 1) % kSegments;
        faces.emplace_back(a, b, b + kSegments);
        faces.emplace_back(a, b + kSegments, a + kSegments);
      }
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    mesh.vertices.row(static_cast<Eigen::Index>(i)) = vertices[i].transpose();
  for (std::size_t i = 0; i < faces.size(); ++i)
    mesh.faces.row(static_cast<Eigen::Index>(i)) = faces[i].transpose();
  return mesh;
}

} // namespace doublet::fit
