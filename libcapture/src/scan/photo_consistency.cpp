#include "photo_consistency.h"

#include "doublet/rays/ray_scene.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace doublet::detail {
namespace {

/// Samples along a side of a patch.
constexpr int kSide = 9;
/// A camera that sees the surface flatter than this (cosine) does not compare.
constexpr double kFlattest = 0.35;
/// Cameras that compare at a vertex: those that see it most frontally.
constexpr std::size_t kCameras = 3;
/// Grey levels; a patch with less contrast tells nothing.
constexpr double kLeastContrast = 3;
/// Correlation that is no evidence: cloth of one colour under one light reaches it anywhere.
constexpr double kChance = 0.3;
constexpr int kRounds = 30;
/// What a depth costs that cannot be.
constexpr float kTooDeep = 10;
/// What a depth costs that the outline speaks against.
constexpr float kUnlikely = 0.3f;

using Patch = Eigen::Array<float, kSide * kSide, 1>;

/// Grey, 8 bit as float.
cv::Mat grey_of(const Image &image) {
  const cv::Mat colours(image.height, image.width, CV_8UC(image.channels), const_cast<std::uint8_t *>(image.data.data()));
  cv::Mat grey, result;
  if (image.channels == 3)
    cv::cvtColor(colours, grey, cv::COLOR_BGR2GRAY);
  else
    grey = colours;
  grey.convertTo(result, CV_32F);
  return result;
}

struct Tangents {
  Eigen::Vector3d first, second;
};

Tangents tangents_of(const Eigen::Vector3d &normal) {
  const Eigen::Vector3d first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

/// The surface's patch as the camera sees it, zero mean and unit length; false where it leaves the image or has no contrast.
bool read_patch(const Camera &camera, const cv::Mat &grey, const Eigen::Vector3d &centre, const Tangents &tangents, double step,
                Patch &patch) {
  for (int j = 0, i = 0; j < kSide; ++j)
    for (int k = 0; k < kSide; ++k, ++i) {
      const Eigen::Vector3d point = centre + step * ((j - kSide / 2) * tangents.first + (k - kSide / 2) * tangents.second);
      const Eigen::Vector2d pixel = camera.project(point);
      const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
      if (x < 0 || y < 0 || x + 1 >= grey.cols || y + 1 >= grey.rows)
        return false;
      const float fx = static_cast<float>(pixel.x() - x), fy = static_cast<float>(pixel.y() - y);
      const float *row = grey.ptr<float>(y) + x, *next = grey.ptr<float>(y + 1) + x;
      patch[i] = (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * next[0] + fx * next[1]);
    }
  patch -= patch.mean();
  const float length = std::sqrt(patch.square().sum());
  if (length < kLeastContrast * kSide)
    return false;
  patch /= length;
  return true;
}

/// The cameras that see a vertex of the hull, the most frontal first.
std::vector<int> seeing(const RayScene &scene, const CameraRig &rig, const std::vector<cv::Mat> &grey,
                        const Eigen::Vector3d &point, const Eigen::Vector3d &normal) {
  std::vector<std::pair<double, int>> found;
  for (std::size_t c = 0; c < rig.size(); ++c) {
    const Eigen::Vector3d towards = rig[c].centre() - point;
    const double facing = normal.dot(towards.normalized());
    constexpr double kAbove = 2e-3; // m; a vertex must not hide itself
    if (!grey[c].empty() && facing > kFlattest && !scene.occluded(point + kAbove * normal, rig[c].centre()))
      found.emplace_back(-facing, static_cast<int>(c));
  }
  std::sort(found.begin(), found.end());
  std::vector<int> cameras;
  for (std::size_t i = 0; i < std::min(kCameras, found.size()); ++i)
    cameras.push_back(found[i].second);
  return cameras;
}

bool in_mask(const Camera &camera, const Image &mask, const Eigen::Vector3d &point) {
  const Eigen::Vector2d pixel = camera.project(point);
  const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
  return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.data[static_cast<std::size_t>(y) * mask.width + x];
}

/// m, how far below the hull the surface may lie: a limb has a middle.
double reach_of(const RayScene &scene, const Eigen::Vector3d &point, const Eigen::Vector3d &normal, double most) {
  constexpr double kShare = 0.25, kSkin = 1e-3; // of the way to the other side; the ray starts below the surface
  const auto other_side = scene.cast(point - kSkin * normal, -normal, 0, most / kShare);
  return other_side ? kShare * (other_side->distance + kSkin) : most;
}

/// m, how far below the hull the surface may lie where it makes a camera's outline: somewhere on the line of sight that passes it
/// there the two touch, and between, cloth does not bend more sharply than kSharpestFold.
double reach_at_outline(const RayScene &scene, const CameraRig &rig, const std::vector<CameraView> &views,
                        const Eigen::Vector3d &point, const Eigen::Vector3d &normal, double most) {
  constexpr double kSharpestFold = 0.03, kInside = 0.002, kOutside = 0.003; // m
  constexpr double kPasses = 0.15;                                          // cosine
  double reach = most;
  const Eigen::Vector3d inside = point - kInside * normal;
  for (std::size_t c = 0; c < rig.size(); ++c) {
    const Eigen::Vector3d sight = (point - rig[c].centre()).normalized();
    if (views[c].mask.empty() || std::abs(sight.dot(normal)) > kPasses ||
        in_mask(rig[c], views[c].mask, point + kOutside * normal))
      continue;
    double chord = 0;
    for (const double side : {1.0, -1.0})
      if (const auto hit = scene.cast(inside, side * sight, 0, 1))
        chord += hit->distance;
    reach = std::min(reach, chord * chord / (8 * kSharpestFold));
  }
  return reach;
}

using Costs = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What a vertex says of every depth: minus the mean correlation of the pairs with the most frontal camera, above chance.
void vertex_costs(const CameraRig &rig, const std::vector<cv::Mat> &grey, const std::vector<int> &cameras,
                  const Eigen::Vector3d &point, const Eigen::Vector3d &normal, double spacing, const ViewScanOptions &options,
                  Eigen::Ref<Eigen::Array<float, 1, Eigen::Dynamic>> costs) {
  const Tangents tangents = tangents_of(normal);
  const double step = options.patch / (kSide - 1);
  for (Eigen::Index label = 0; label < costs.size(); ++label) {
    const Eigen::Vector3d centre = point - static_cast<double>(label) * spacing * normal;
    Patch first, other;
    if (!read_patch(rig[cameras[0]], grey[cameras[0]], centre, tangents, step, first))
      continue;
    float best = 0;
    for (std::size_t i = 1; i < cameras.size(); ++i)
      if (read_patch(rig[cameras[i]], grey[cameras[i]], centre, tangents, step, other))
        best = std::max(best, (first * other).sum()); // one of them may be hidden there
    costs[label] = -std::max(0.0F, best - static_cast<float>(kChance));
  }
}

/// Edges both ways: messages run along them.
struct Edges {
  std::vector<int> first;      ///< (V + 1) of the edges that arrive at a vertex
  std::vector<int> from, back; ///< where they start; the index of the same edge the other way
};

Edges edges_of(const Mesh &mesh) {
  const int count = static_cast<int>(mesh.vertices.rows());
  const auto neighbours = vertex_neighbours(mesh.faces, count);
  Edges edges;
  edges.first.assign(count + 1, 0);
  for (int v = 0; v < count; ++v)
    edges.first[v + 1] = edges.first[v] + static_cast<int>(neighbours[v].size());
  for (int v = 0; v < count; ++v)
    edges.from.insert(edges.from.end(), neighbours[v].begin(), neighbours[v].end());
  for (int v = 0; v < count; ++v)
    for (int n : neighbours[v]) {
      const auto found = std::find(neighbours[n].begin(), neighbours[n].end(), v);
      edges.back.push_back(edges.first[n] + static_cast<int>(found - neighbours[n].begin()));
    }
  return edges;
}

/// Least of the costs after a step that costs `slope` a label and `most` at most.
void pass_on(Eigen::Ref<Eigen::Array<float, 1, Eigen::Dynamic>> costs, float slope, float most) {
  const float capped = costs.minCoeff() + most;
  for (Eigen::Index k = 1; k < costs.size(); ++k)
    costs[k] = std::min(costs[k], costs[k - 1] + slope);
  for (Eigen::Index k = costs.size() - 2; k >= 0; --k)
    costs[k] = std::min(costs[k], costs[k + 1] + slope);
  costs = costs.min(capped);
  costs -= costs.mean();
}

/// Min-sum belief propagation, all messages at once, so that no order matters.
Costs beliefs(const Costs &own, const Edges &edges, float slope, float most, const Context &context) {
  Costs messages = Costs::Zero(static_cast<Eigen::Index>(edges.from.size()), own.cols()), next = messages, sums = own;
  for (int round = 0; round <= kRounds; ++round) {
    context.report_progress("scan: smooth depths", static_cast<double>(round) / kRounds);
    parallel_for(context, static_cast<int>(own.rows()), [&](int v) {
      sums.row(v) = own.row(v);
      for (int e = edges.first[v]; e < edges.first[v + 1]; ++e)
        sums.row(v) += messages.row(e);
    });
    if (round == kRounds)
      break;
    parallel_for(context, static_cast<int>(own.rows()), [&](int v) {
      for (int e = edges.first[v]; e < edges.first[v + 1]; ++e) {
        next.row(e) = sums.row(edges.from[e]) - messages.row(edges.back[e]);
        pass_on(next.row(e), slope, most);
      }
    });
    std::swap(messages, next);
  }
  return sums;
}

/// The best label, between labels by a parabola.
double best_label(const Eigen::Ref<const Eigen::Array<float, 1, Eigen::Dynamic>> &costs) {
  Eigen::Index best = 0;
  costs.minCoeff(&best);
  if (best == 0 || best + 1 == costs.size())
    return static_cast<double>(best);
  const double before = costs[best - 1], at = costs[best], after = costs[best + 1], bend = before - 2 * at + after;
  return static_cast<double>(best) + (bend > 0 ? std::clamp((before - after) / (2 * bend), -0.5, 0.5) : 0.0);
}

} // namespace

Vertices photo_consistent(const Mesh &hull, const CameraRig &rig, const std::vector<CameraView> &views,
                          const ViewScanOptions &options, const Context &context) {
  std::vector<cv::Mat> grey;
  for (const CameraView &view : views)
    grey.push_back(view.image.empty() ? cv::Mat() : grey_of(view.image));
  constexpr double kSpacing = 0.0025; // m between depths
  const int labels = 1 + static_cast<int>(std::ceil(options.search_depth / kSpacing));
  const Vertices normals = vertex_normals(hull.vertices, hull.faces);
  const RayScene scene(hull);
  const int count = static_cast<int>(hull.vertices.rows());
  Costs own = Costs::Zero(count, labels);
  constexpr int kChunk = 4096;
  for (int start = 0; start < count; start += kChunk) {
    context.report_progress("scan: comparing cameras", static_cast<double>(start) / count);
    parallel_for(context, std::min(kChunk, count - start), [&](int offset) {
      const int v = start + offset;
      const Eigen::Vector3d point = hull.vertices.row(v), normal = normals.row(v);
      const std::vector<int> cameras = seeing(scene, rig, grey, point, normal);
      if (cameras.size() > 1)
        vertex_costs(rig, grey, cameras, point, normal, kSpacing, options, own.row(v));
      const double reach = reach_of(scene, point, normal, options.search_depth);
      const double likely = reach_at_outline(scene, rig, views, point, normal, reach);
      for (int label = 1; label < labels; ++label)
        if (label * kSpacing > reach)
          own(v, label) = kTooDeep;
        else if (label * kSpacing > likely)
          own(v, label) += kUnlikely;
    });
  }
  const float slope = static_cast<float>(options.smoothness * kSpacing / 0.01);
  constexpr float kMost = 0.5F; // a fold's edge may be steep
  // Where nothing speaks the hull stays: a depth of its own has a small price.
  for (int label = 0; label < labels; ++label)
    own.col(label) += 0.02F * static_cast<float>(label) / static_cast<float>(labels);
  const Costs belief = beliefs(own, edges_of(hull), slope, kMost, context);
  Vertices moved = hull.vertices;
  for (int v = 0; v < count; ++v)
    moved.row(v) -= kSpacing * best_label(belief.row(v)) * normals.row(v);
  return moved;
}

} // namespace doublet::detail
