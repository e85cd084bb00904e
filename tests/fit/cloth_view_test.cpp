#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/parts/distance_field.h"
#include "fit/plain_view.h"
#include "fit/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace doublet {
namespace {

using namespace testing;

/// Some samples of one moment: the cloth of different frames in front of one camera.
struct Moment {
  std::unique_ptr<Scene> scene = make_scene({cotton()}, {40, 3, 640, 16, 40});
  fit::ClothTopology topology = fit::cloth_topology(*scene->simulator);
  fit::CoarseCamera camera;
  fit::CoarseBuffer others;
  std::vector<FeatureMatch> matches;

  explicit Moment(bool distorted) : camera(make_camera(*scene, distorted), 251) {
    others = draw_others(*scene->simulator, topology, scene->simulator->pose(scene->performance.dofs.row(0).transpose()), camera);
    NormalGenerator random(3);
    for (int i = 0; i < 1500; ++i) {
      const Eigen::Vector2f pixel(640 * static_cast<float>(random.uniform()), 640 * static_cast<float>(random.uniform()));
      matches.push_back({pixel, pixel});
    }
  }
  static Camera make_camera(const Scene &scene, bool distorted) {
    Camera camera = scene.observations.cameras[1];
    if (distorted)
      camera.distortion << -0.15, 0.05, 0.002, -0.001, 0.01;
    return camera;
  }
  const Vertices &surface(int sample) const { return scene->frames[static_cast<std::size_t>(sample) * 7 % 40]; }

  /// `samples`: which, one a lane.
  void fill(fit::ClothView &view, const std::vector<int> &samples) const {
    for (int v = 0; v < topology.vertex_count(); ++v)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < view.lanes(); ++l)
          view.positions()[(static_cast<std::size_t>(v) * 3 + k) * view.lanes() + l] =
              static_cast<float>(surface(samples[std::min<std::size_t>(l, samples.size() - 1)])(topology.vertices[v], k));
  }
};

constexpr float kFarthest = 1600; // pixels^2

/// What a view says about one lane.
struct Findings {
  std::vector<std::array<float, 3>> rims;                           ///< vertex, x, y
  std::map<std::pair<float, float>, std::array<float, 4>> features; ///< of those on the cloth: where seen -> face, weights
  std::vector<float> squared; ///< of the same, in the order of the view, after the cloth has moved
  std::vector<float> outline; ///< of the places where the features are: squared distances to the outline
  bool operator==(const Findings &) const = default;
};

std::vector<Findings> found_in(const Moment &moment, const std::vector<int> &samples, const fit::LaneKernels *kernels = nullptr) {
  fit::ClothView view(moment.topology, static_cast<int>(samples.size()), kernels);
  moment.fill(view, samples);
  view.set_camera(moment.camera);
  std::vector<fit::Rim> rims;
  view.outline(moment.others, rims);
  std::vector<Findings> found(samples.size());
  for (const fit::Rim &rim : rims)
    found[rim.lane].rims.push_back({static_cast<float>(rim.vertex), rim.x, rim.y});
  std::vector<float> x, y, distances;
  for (const FeatureMatch &match : moment.matches)
    x.push_back(match.current.x()), y.push_back(match.current.y());
  view.approach(0, static_cast<int>(x.size()), x.data(), y.data(), kFarthest, distances);
  for (std::size_t l = 0; l < samples.size(); ++l)
    found[l].outline.assign(distances.begin() + static_cast<std::ptrdiff_t>(l * x.size()),
                            distances.begin() + static_cast<std::ptrdiff_t>((l + 1) * x.size()));
  fit::LocatedFeatures located;
  view.locate(moment.matches, moment.others, located);
  std::vector<int> later = samples;
  for (int &sample : later)
    ++sample;
  moment.fill(view, later);
  view.set_camera(moment.camera);
  const std::vector<float> &squared = view.squared_errors(located, std::vector<float>(located.count, 900.f));
  const int lanes = view.lanes();
  for (int i = 0; i < located.count; ++i)
    for (std::size_t l = 0; l < samples.size(); ++l) {
      const float *weight = &located.weight[static_cast<std::size_t>(i) * 3 * lanes + l];
      const std::size_t at = static_cast<std::size_t>(i) * lanes + l;
      if (located.face[at] < 0) {
        EXPECT_EQ(squared[at], -1);
        continue;
      }
      found[l].features[{located.seen_x[i], located.seen_y[i]}] = {static_cast<float>(located.face[at]), weight[0], weight[lanes],
                                                                   weight[2 * lanes]};
      found[l].squared.push_back(squared[at]);
    }
  return found;
}

Eigen::Vector3d point_of(const Moment &moment, int sample, const std::array<float, 4> &place) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    point += place[k + 1] * moment.surface(sample)
                                .row(moment.topology.vertices[moment.topology.corners[3 * static_cast<int>(place[0]) + k]])
                                .transpose();
  return point / (place[1] + place[2] + place[3]);
}

TEST(ClothView, FindsWhatAPlainSearchFinds) {
  for (bool distorted : {false, true}) {
    const Moment moment(distorted);
    const std::vector<int> samples{0, 1, 2, 3, 4, 5};
    const std::vector<Findings> found = found_in(moment, samples);
    int rims = 0, missed = 0, others = 0, features = 0, wrong = 0;
    for (int s : samples) {
      const PlainView plain(moment.topology, moment.surface(s), moment.camera, moment.others),
          after(moment.topology, moment.surface(s + 1), moment.camera, moment.others);
      std::set<int> expected = plain.outline();
      rims += static_cast<int>(expected.size());
      for (const auto &[v, x, y] : found[s].rims) {
        others += expected.erase(static_cast<int>(v)) == 0;
        const Eigen::Vector2d pixel =
            moment.camera.camera.project(moment.surface(s).row(moment.topology.vertices[static_cast<int>(v)]).transpose());
        EXPECT_NEAR((pixel - Eigen::Vector2d(x, y)).norm(), 0, 1e-3);
      }
      missed += static_cast<int>(expected.size());
      for (const FeatureMatch &match : moment.matches) {
        const auto point = plain.point_under(match.previous.cast<double>());
        const auto place = found[s].features.find({match.current.x(), match.current.y()});
        const bool both = point && place != found[s].features.end();
        features += both;
        wrong += both ? (point_of(moment, s, place->second) - *point).norm() > 1e-4
                      : point.has_value() != (place != found[s].features.end());
      }
    }
    std::printf("%d rims, %d missed, %d others; %d features on the cloth, %d wrong\n", rims, missed, others, features, wrong);
    EXPECT_GT(rims, 200);
    EXPECT_LT(missed, 0.05 * rims);
    EXPECT_LT(others, 0.15 * rims); // inner folds within a coarse pixel of the outline
    EXPECT_GT(features, 200);
    EXPECT_LE(wrong, 0.005 * features);
  }
}

TEST(ClothView, CarriesFeaturesWithTheCloth) {
  const Moment moment(true);
  const std::vector<Findings> found = found_in(moment, {0, 1, 2});
  const Camera &camera = moment.camera.camera;
  for (int s : {0, 1, 2}) {
    std::vector<double> expected;
    for (const auto &[seen, place] : found[s].features) {
      const Eigen::Vector2d now = camera.project(point_of(moment, s, place)); // at the same time: where it was
      EXPECT_NEAR((now - Eigen::Vector2d(seen.first, seen.second)).norm(), 0, 2e-2) << s;
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        point += place[k + 1] / (place[1] + place[2] + place[3]) *
                 moment.surface(s + 1)
                     .row(moment.topology.vertices[moment.topology.corners[3 * static_cast<int>(place[0]) + k]])
                     .transpose();
      expected.push_back(std::min(900.0, (camera.project(point) - Eigen::Vector2d(seen.first, seen.second)).squaredNorm()));
    }
    std::vector<float> squared = found[s].squared;
    ASSERT_EQ(squared.size(), expected.size());
    std::sort(squared.begin(), squared.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_GT(expected.back(), 4);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(squared[i], expected[i], 1e-2 + 1e-3 * expected[i]);
  }
}

TEST(ClothView, SameBitsInAnyCompanyAndForEveryInstructionSet) {
  for (bool distorted : {false, true}) {
    const Moment moment(distorted);
    std::vector<int> samples(16);
    std::iota(samples.begin(), samples.end(), 0);
    const std::vector<Findings> expected = found_in(moment, samples, fit::baseline_kernels(2));
    for (int s : {0, 7, 15})
      EXPECT_EQ(found_in(moment, {s}, fit::baseline_kernels(0))[0], expected[s]);
    EXPECT_EQ(found_in(moment, {3, 11, 15, 1, 0}, fit::baseline_kernels(1))[2], expected[15]);
#ifdef __x86_64__
    for (int width : {0, 1, 2}) {
      const std::vector<int> some(samples.begin(), samples.begin() + (4 << width) - 1);
      const std::vector<Findings> part(expected.begin(), expected.begin() + (4 << width) - 1);
      if (__builtin_cpu_supports("avx2") && fit::avx2_kernels(width)) {
        EXPECT_EQ(found_in(moment, some, fit::avx2_kernels(width)), part) << width;
      }
      if (__builtin_cpu_supports("avx512f") && fit::avx512_kernels(width)) {
        EXPECT_EQ(found_in(moment, some, fit::avx512_kernels(width)), part) << width;
      }
    }
#endif
  }
}

double distance_to(const fit::Segment &segment, const Eigen::Vector2d &p) {
  const Eigen::Vector2d a(segment.ax, segment.ay), along = Eigen::Vector2d(segment.bx, segment.by) - a;
  const double part = std::clamp(along.dot(p - a) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - part * along).norm();
}

TEST(ClothView, TellsHowFarTheOutlineIs) {
  const Moment moment(false);
  fit::ClothView view(moment.topology, 1);
  moment.fill(view, {2});
  view.set_camera(moment.camera);
  std::vector<fit::Rim> rims;
  view.outline(moment.others, rims);
  const Findings found = found_in(moment, {0, 1, 2})[2];
  ASSERT_GT(view.outline_edges().size(), 40u);
  int near = 0;
  for (std::size_t i = 0; i < moment.matches.size(); ++i) {
    double nearest = std::sqrt(kFarthest);
    for (const fit::OutlineEdge &edge : view.outline_edges())
      nearest = std::min(nearest, distance_to(edge.segment, moment.matches[i].current.cast<double>()));
    EXPECT_NEAR(std::sqrt(found.outline[i]), nearest, 1e-3);
    near += nearest < 39;
  }
  EXPECT_GT(near, 100);
  for (const fit::Rim &rim : rims) { // the ends of the edges
    double nearest = 1e9;
    for (const fit::OutlineEdge &edge : view.outline_edges())
      nearest = std::min(nearest, distance_to(edge.segment, {rim.x, rim.y}));
    EXPECT_LT(nearest, 1e-3);
  }
}

/// The paper's E_fit by the plain search, for one region.
double plain_energy(const Scene &s, const pbd::Material &material, const EnergyOptions &options) {
  const fit::ClothTopology topology = fit::cloth_topology(*s.simulator);
  const std::vector<Vertices> frames = simulate_reference(*s.simulator, s.performance, {material}, kDt, options.settle_frames);
  double energy = 0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    FrameTerms terms;
    for (std::size_t c = 0; c < s.observations.cameras.size(); ++c) {
      const fit::CoarseCamera camera(s.observations.cameras[c], options.outline_size);
      const double side = std::max(camera.camera.width, camera.camera.height);
      const auto plain_at = [&](std::size_t i, const fit::CoarseBuffer &others) {
        return PlainView(topology, frames[i], camera, others);
      };
      const auto others_at = [&](std::size_t i) {
        return draw_others(*s.simulator, topology,
                           s.simulator->pose(s.performance.dofs.row(static_cast<Eigen::Index>(i)).transpose()), camera);
      };
      const fit::CoarseBuffer now = others_at(t);
      const float cap = static_cast<float>(options.rim_cap * side);
      const DistanceField field(s.observations.views[t][c].contour, {0, 0, static_cast<float>(side), static_cast<float>(side)}, 1,
                                cap);
      for (int v : plain_at(t, now).outline()) {
        const Eigen::Vector2d pixel = camera.camera.project(frames[t].row(topology.vertices[v]).transpose());
        terms.silhouette += std::pow(field.distance(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())), 2);
        ++terms.rims;
      }
      if (t == 0)
        continue;
      const fit::CoarseBuffer before = others_at(t - 1);
      const PlainView view = plain_at(t - 1, before);
      for (const FeatureMatch &match : s.observations.views[t][c].matches)
        if (const auto place = view.place_under(match.previous.cast<double>())) {
          const auto &[face, weights] = *place;
          Eigen::Vector3d point = Eigen::Vector3d::Zero();
          for (int k = 0; k < 3; ++k)
            point += weights[k] * frames[t].row(topology.vertices[topology.corners[3 * face + k]]).transpose();
          terms.feature += std::min(std::pow(options.feature_cap * side, 2),
                                    (camera.camera.project(point) - match.current.cast<double>()).squaredNorm());
          ++terms.features;
        }
    }
    energy +=
        options.alpha * terms.silhouette / std::max(1, terms.rims) + options.beta * terms.feature / std::max(1, terms.features);
  }
  return energy / static_cast<double>(frames.size());
}

TEST(MaterialObjective, RanksMaterialsAsThePlainSearchDoes) {
  const auto s = make_scene({cotton()}, {12, 2, 320, 8, 20});
  const EnergyOptions options = EnergyOptions::paper();
  NormalGenerator random(4);
  std::vector<std::vector<pbd::Material>> materials;
  std::vector<double> expected;
  for (int i = 0; i < 12; ++i) {
    pbd::Material material = cotton();
    material.d_n = 32 * random.uniform(), material.d_t = 32 * random.uniform();
    material.k_bend = random.uniform(), material.k_stretch = 1 - 0.1 * random.uniform();
    materials.push_back({material});
    expected.push_back(plain_energy(*s, material, options));
  }
  const MatrixRM energies =
      MaterialObjective(*s->simulator, s->performance, s->observations, kDt, options).energies(materials, {});
  const auto ranking = [](const auto &values) {
    std::vector<int> order(12);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return values(a) < values(b); });
    return order;
  };
  for (int i = 0; i < 12; ++i)
    EXPECT_NEAR(energies(i, 0), expected[i], 0.02 * expected[i] + 0.1) << i;
  EXPECT_EQ(ranking([&](int i) { return energies(i, 0); }), ranking([&](int i) { return expected[i]; }));
}

} // namespace
} // namespace doublet
