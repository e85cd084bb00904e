#include "self_collision.h"

#include "pbd_model.h"

#include <algorithm>

namespace doublet::pbd {
namespace {

Vec3f low(Vec3f a, Vec3f b) {
  return {lane_min(a.x, b.x), lane_min(a.y, b.y), lane_min(a.z, b.z)};
}
Vec3f high(Vec3f a, Vec3f b) {
  return {lane_max(a.x, b.x), lane_max(a.y, b.y), lane_max(a.z, b.z)};
}
float extent(const Box &b) {
  return lane_max(b.hi.x - b.lo.x, lane_max(b.hi.y - b.lo.y, b.hi.z - b.lo.z));
}
bool overlap(const Box &a, const Box &b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z && b.lo.z <= a.hi.z;
}
Box face_box(const std::vector<Box> &boxes, const Faces &faces, int f, float margin) {
  const Box &a = boxes[faces(f, 0)], &b = boxes[faces(f, 1)], &c = boxes[faces(f, 2)];
  const Vec3f m{margin, margin, margin};
  return {low(low(a.lo, b.lo), c.lo) - m, high(high(a.hi, b.hi), c.hi) + m};
}
std::uint64_t cell_key(int x, int y, int z) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
  return part(x) << 42 | part(y) << 21 | part(z);
}

/// Barycentric coordinates of the foot of q on the plane of (a, b, c).
Vec3f barycentric(Vec3f q, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f u = b - a, v = c - a, d = q - a;
  const float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), du = dot(d, u), dv = dot(d, v);
  const float inverse = 1.0f / lane_max(uu * vv - uv * uv, 1e-30f);
  const float s = (vv * du - uv * dv) * inverse, t = (uu * dv - uv * du) * inverse;
  return {1.0f - s - t, s, t};
}

float segment_distance2(Vec3f q, Vec3f a, Vec3f b) {
  const Vec3f e = b - a, d = q - a;
  const float t = lane_min(lane_max(dot(d, e) / lane_max(dot(e, e), 1e-30f), 0.0f), 1.0f);
  const Vec3f r = d - t * e;
  return dot(r, r);
}

float triangle_distance(Vec3f q, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f w = barycentric(q, a, b, c);
  if (w.x >= 0 && w.y >= 0 && w.z >= 0) {
    const Vec3f r = q - (w.x * a + w.y * b + w.z * c);
    return lane_sqrt(dot(r, r));
  }
  return lane_sqrt(lane_min(segment_distance2(q, a, b), lane_min(segment_distance2(q, b, c), segment_distance2(q, c, a))));
}

/// Height of q over the plane of (a, b, c), m.
float height(Vec3f q, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f n = cross(b - a, c - a);
  return dot(q - a, n) / lane_max(lane_sqrt(dot(n, n)), 1e-12f);
}

} // namespace

void PairFinder::set_cell_size(const std::vector<Box> &boxes, const Faces &faces, float margin) {
  double sum = 0;
  for (int f = 0; f < faces.rows(); ++f)
    sum += extent(face_box(boxes, faces, f, margin));
  // About one face a cell. The floor keeps coordinates within 2^20 cells for anything within kilometres.
  inverse_cell_ = 1.0f / lane_max(static_cast<float>(sum / static_cast<double>(faces.rows())), 0.002f);
}

int PairFinder::cell_of(float x) const {
  return static_cast<int>(std::floor(lane_min(lane_max(x * inverse_cell_, -1e6f), 1e6f)));
}

PairFinder::Cells PairFinder::cells_of(const Box &box) const {
  Cells c{{cell_of(box.lo.x), cell_of(box.lo.y), cell_of(box.lo.z)}, {cell_of(box.hi.x), cell_of(box.hi.y), cell_of(box.hi.z)}};
  for (int k = 0; k < 3; ++k)
    if (c.hi[k] - c.lo[k] >= kMaxSpan) {
      c.lo[k] += (c.hi[k] - c.lo[k]) / 2 - kMaxSpan / 2;
      c.hi[k] = c.lo[k] + kMaxSpan - 1;
    }
  return c;
}

std::uint32_t PairFinder::bucket(std::uint64_t cell) const {
  return static_cast<std::uint32_t>((cell * 0x9e3779b97f4a7c15ULL) >> 32) & static_cast<std::uint32_t>(start_.size() - 2);
}

void PairFinder::insert(const std::vector<Box> &boxes) {
  cells_.resize(boxes.size());
  for (size_t v = 0; v < boxes.size(); ++v)
    cells_[v] = cells_of(boxes[v]);
  size_t buckets = 64;
  while (buckets < 2 * boxes.size())
    buckets *= 2;
  start_.assign(buckets + 1, 0);
  const auto for_each_cell = [&](auto &&visit) {
    for (int v = 0; v < static_cast<int>(boxes.size()); ++v) {
      const Cells &c = cells_[v];
      for (int x = c.lo[0]; x <= c.hi[0]; ++x)
        for (int y = c.lo[1]; y <= c.hi[1]; ++y)
          for (int z = c.lo[2]; z <= c.hi[2]; ++z)
            visit(v, cell_key(x, y, z));
    }
  };
  for_each_cell([&](int, std::uint64_t cell) { ++start_[bucket(cell)]; });
  std::uint32_t total = 0;
  for (std::uint32_t &s : start_) {
    const std::uint32_t count = s;
    s = total;
    total += count;
  }
  entries_.resize(total);
  for_each_cell([&](int v, std::uint64_t cell) { entries_[start_[bucket(cell)]++] = {cell, v}; });
  for (size_t b = buckets; b > 0; --b) // the fill moved every start to its end
    start_[b] = start_[b - 1];
  start_[0] = 0;
}

const std::vector<FaceVertex> &PairFinder::find(const std::vector<Box> &boxes, const Faces &faces, float margin) {
  set_cell_size(boxes, faces, margin);
  insert(boxes);
  pairs_.clear();
  for (int f = 0; f < faces.rows(); ++f) {
    const Box box = face_box(boxes, faces, f, margin);
    const Cells c = cells_of(box);
    for (int x = c.lo[0]; x <= c.hi[0]; ++x)
      for (int y = c.lo[1]; y <= c.hi[1]; ++y)
        for (int z = c.lo[2]; z <= c.hi[2]; ++z) {
          const std::uint64_t cell = cell_key(x, y, z);
          const std::uint32_t b = bucket(cell);
          for (std::uint32_t i = start_[b]; i < start_[b + 1]; ++i) {
            const Entry &entry = entries_[i];
            const int q = entry.vertex;
            if (entry.cell != cell || q == faces(f, 0) || q == faces(f, 1) || q == faces(f, 2) || !overlap(box, boxes[q]))
              continue;
            // Both boxes may share several cells: only the lowest one reports the pair.
            const Cells &v = cells_[q];
            if (x == std::max(c.lo[0], v.lo[0]) && y == std::max(c.lo[1], v.lo[1]) && z == std::max(c.lo[2], v.lo[2]))
              pairs_.push_back({f, q});
          }
        }
  }
  return pairs_;
}

std::vector<std::uint64_t> pairs_closer_than(const std::vector<Point> &points, const Faces &faces, float distance) {
  std::vector<Box> boxes;
  for (const Point &p : points)
    boxes.push_back({p, p});
  PairFinder finder;
  std::vector<std::uint64_t> close;
  for (const auto &[f, v] : finder.find(boxes, faces, distance)) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    if (triangle_distance(points[v], points[a], points[b], points[c]) < distance)
      close.push_back(static_cast<std::uint64_t>(v) << 32 | static_cast<std::uint32_t>(f));
  }
  std::sort(close.begin(), close.end());
  return close;
}

void find_self_contacts(const PbdModel &model, const std::vector<Point> &x, const std::vector<Point> &p, float opening,
                        PairFinder &finder, std::vector<Box> &boxes, std::vector<SelfContact<float>> &contacts) {
  contacts.clear();
  const float thickness = static_cast<float>(model.options().self_thickness);
  const Faces &faces = model.faces();
  const std::vector<float> &w = model.weights();

  // Common motion brings nobody together: leave it out of the boxes.
  Vec3f drift{0, 0, 0};
  const int n = model.vertex_count();
  for (int i = 0; i < n; ++i)
    drift += p[i] - x[i];
  drift = (1.0f / static_cast<float>(n)) * drift;
  boxes.resize(n);
  for (int i = 0; i < n; ++i) {
    const Vec3f end = p[i] - drift;
    boxes[i] = {low(x[i], end), high(x[i], end)};
  }

  for (const auto &[f, q] : finder.find(boxes, faces, 2 * thickness)) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    if (w[q] + w[a] + w[b] + w[c] == 0)
      continue;
    const float start = height(x[q], x[a], x[b], x[c]);
    const float side = start < 0 ? -1.0f : 1.0f;
    const float h0 = side * start, h1 = side * height(p[q], p[a], p[b], p[c]);
    if (h1 > 2 * thickness)
      continue;
    // Where on the face: at the moment the vertex comes within the thickness, else at the end.
    const float t = h1 < thickness && h0 > h1 ? lane_min(lane_max((h0 - thickness) / (h0 - h1), 0.0f), 1.0f) : 1.0f;
    const auto at = [&](int i) { return x[i] + t * (p[i] - x[i]); };
    const Vec3f foot = barycentric(at(q), at(a), at(b), at(c));
    if (foot.x < 0 || foot.y < 0 || foot.z < 0 || model.excluded(q, f))
      continue;
    SelfContact<float> contact{q, a,    b,    c,    foot.x, foot.y, foot.z, side, lane_min(thickness, h0 + opening),
                               0, w[q], w[a], w[b], w[c],   0};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }
}

} // namespace doublet::pbd
