#include "doublet/core/error.h"
#include "doublet/core/parts/closest_point.h"
#include "doublet/core/parts/normal_generator.h"
#include "fit/synthetic.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>

namespace doublet {
namespace {

using namespace testing;

const Scene &scene() {
  static const std::unique_ptr<Scene> shared = make_scene({cotton()});
  return *shared;
}

pbd::Material with_drag(double d_n) {
  pbd::Material material = cotton();
  material.d_n = d_n;
  return material;
}

double energy_of(const Scene &s, const pbd::Material &material, const EnergyOptions &options = {}) {
  return material_energy(*s.simulator, s.performance, s.observations, kDt, {material}, options)[0];
}

TEST(MaterialObjective, TheTruthCostsLittleAndEverythingElseMore) {
  const double truth = energy_of(scene(), cotton());
  std::printf("energy: truth %.2f", truth);
  for (double d_n : {0.0, 1.0, 16.0, 32.0}) {
    const double other = energy_of(scene(), with_drag(d_n));
    std::printf(", d_n %.0f %.2f", d_n, other);
    EXPECT_GT(other, 1.2 * truth) << d_n;
  }
  const double centre = energy_of(scene(), ParameterSpace{}.material(Eigen::VectorXd::Constant(5, 0.5)));
  std::printf(", centre %.2f\n", centre);
  EXPECT_GT(centre, 5 * truth);
  EXPECT_LT(truth, 8); // contours are pixels, the field has two-pixel cells
}

TEST(MaterialObjective, BothTermsSeeTheMaterialAlone) {
  EnergyOptions silhouette, feature;
  silhouette.beta = 0;
  feature.alpha = 0;
  for (const EnergyOptions &options : {silhouette, feature})
    EXPECT_GT(energy_of(scene(), with_drag(32), options), 2 * energy_of(scene(), cotton(), options));
}

TEST(MaterialObjective, FeaturesAreExactAtTheTruth) {
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt);
  const std::vector<FrameTerms> terms = objective.terms({cotton()})[0];
  EXPECT_EQ(terms[0].features, 0);
  double feature = 0;
  for (std::size_t t = 1; t < terms.size(); ++t) {
    EXPECT_GT(terms[t].features, 50);
    feature += terms[t].feature / static_cast<double>(terms.size());
    EXPECT_GT(terms[t].rims, 20);
    EXPECT_LT(terms[t].silhouette, 8) << t;
  }
  EXPECT_LT(feature, 0.05); // exact but for the few features beside an outline, where a coarse pixel shows another layer
}

TEST(MaterialObjective, SameEnergyForAnyNumberOfThreadsAndAnyCompany) {
  EnergyOptions windows;
  windows.window = 8;
  windows.window_lead = 4;
  for (const EnergyOptions &options : {EnergyOptions{}, windows}) {
    MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt, options);
    NormalGenerator random(1);
    MatrixRM samples(19, 5); // two groups
    for (Eigen::Index i = 0; i < samples.size(); ++i)
      samples.data()[i] = random.uniform();
    Context context;
    context.threads = 1;
    const MatrixRM expected = objective.evaluate(samples, context);
    for (int threads : {2, 7}) {
      context.threads = threads;
      EXPECT_EQ(objective.evaluate(samples, context), expected) << threads;
    }
    EXPECT_EQ(objective.evaluate(samples.row(3), context)(0, 0), expected(3, 0));
  }
}

TEST(MaterialObjective, WindowsStartFromTheCapturedSurface) {
  EnergyOptions whole, windows;
  windows.window = 8;
  windows.window_lead = 4;
  const double truth = energy_of(scene(), cotton(), windows);
  EXPECT_LT(truth, 8);
  for (double d_n : {0.0, 16.0, 32.0})
    EXPECT_GT(energy_of(scene(), with_drag(d_n), windows), truth) << d_n;
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt, windows);
  const std::vector<std::vector<FrameTerms>> terms = objective.terms({cotton()});
  for (const FrameTerms &frame : terms[0])
    EXPECT_GT(frame.rims, 20);
  // However bad the material, a window starts from the truth again.
  EXPECT_LT(energy_of(scene(), with_drag(32), windows), energy_of(scene(), with_drag(32), whole));
  whole.window = 1000; // longer than the motion
  EXPECT_EQ(energy_of(scene(), with_drag(8), whole), energy_of(scene(), with_drag(8)));
}

/// The scene's simulator with a rest shape this many times as large.
CharacterSimulator in_width(const Scene &filmed, double scale) {
  Segmentation segmentation = filmed.segmentation;
  segmentation.rest = scale * filmed.actor.mesh.vertices;
  return CharacterSimulator(filmed.actor, segmentation, filmed.proxies, filmed.simulator->options());
}

TEST(MaterialObjective, AWidthIsTheLastParameterAndAsIfItWereAlone) {
  const CharacterSimulator wide = in_width(scene(), 1.3), narrow = in_width(scene(), 1);
  MaterialObjective both({&wide, &narrow}, scene().performance, scene().observations, kDt);
  MaterialObjective one(wide, scene().performance, scene().observations, kDt);
  MaterialObjective other(narrow, scene().performance, scene().observations, kDt);
  EXPECT_EQ(both.parameter_count(), one.parameter_count() + 1);
  EXPECT_EQ(both.width_count(), 2);
  NormalGenerator random(3);
  MatrixRM samples(6, 6);
  for (Eigen::Index i = 0; i < samples.size(); ++i)
    samples.data()[i] = random.uniform();
  samples.col(5) << 0, 1, 1, 0, 0.4, 0.6; // the nearest
  const MatrixRM energies = both.evaluate(samples, {}), first = one.evaluate(samples.leftCols(5), {}),
                 second = other.evaluate(samples.leftCols(5), {});
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(energies(i, 0), samples(i, 5) < 0.5 ? first(i, 0) : second(i, 0)) << i;
  const MatrixRM truth = ParameterSpace{}.unit(cotton()).transpose();
  MatrixRM at_truth(2, 6);
  at_truth << truth, 0, truth, 1;
  const MatrixRM of_widths = both.evaluate(at_truth, {});
  EXPECT_LT(of_widths(1, 0), 0.5 * of_widths(0, 0)); // the width that was filmed
  EXPECT_NE(both.fingerprint(), one.fingerprint());
  EXPECT_THROW(MaterialObjective(std::vector<const CharacterSimulator *>{}, scene().performance, scene().observations, kDt),
               std::invalid_argument);
}

TEST(MaterialObjective, IsNotMovedByWhatBecomesOfTheSimulator) {
  CharacterSimulator simulator = *scene().simulator;
  const MaterialObjective objective(simulator, scene().performance, scene().observations, kDt);
  const MatrixRM expected = objective.energies({{cotton()}}, {});
  const CharacterSimulator other = in_width(scene(), 1.3);
  EXPECT_NE(MaterialObjective(other, scene().performance, scene().observations, kDt).energies({{cotton()}}, {}), expected);
  simulator = other;
  EXPECT_EQ(objective.energies({{cotton()}}, {}), expected);
}

TEST(MaterialObjective, KeepsLittleOfTheImages) {
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt);
  EXPECT_GT(objective.image_bytes(), 0u);
  EXPECT_LT(objective.image_bytes(), 32u * 4u * 320u * 320u); // less than a byte a pixel
}

TEST(MaterialObjective, AMissingImageIsLeftOut) {
  Scene copy;
  copy.observations = scene().observations;
  for (auto &views : copy.observations.views)
    views[1] = {};
  const double truth = material_energy(*scene().simulator, scene().performance, copy.observations, kDt, {cotton()})[0];
  const double other = material_energy(*scene().simulator, scene().performance, copy.observations, kDt, {with_drag(32)})[0];
  EXPECT_GT(other, 2.5 * truth);
}

TEST(MaterialObjective, AMismatchedFeatureCostsNoMoreThanTheCap) {
  Observations observations = scene().observations;
  for (auto &views : observations.views)
    for (auto &view : views)
      if (!view.matches.empty())
        view.matches[view.matches.size() / 2].current = {0, 0};
  EnergyOptions options;
  options.alpha = 0;
  options.beta = 1;
  const double clean = energy_of(scene(), cotton(), options);
  const double spoiled = material_energy(*scene().simulator, scene().performance, observations, kDt, {cotton()}, options)[0];
  const double cap = options.feature_cap * 320;
  EXPECT_LE(spoiled, clean + cap * cap * 4 / 50); // at most four of at least fifty features a frame
}

/// A solver that blows up for d_n > 20: the cloth flies away, becomes NaN, or the solver notices and says so.
class Exploding : public pbd::ClothSolver {
public:
  Exploding(std::shared_ptr<const pbd::ClothModel> cloth, double value, bool notices)
      : ClothSolver(std::move(cloth)), value_(value), notices_(notices) {}

private:
  std::vector<int> advance(std::span<pbd::ClothState> states, std::span<const pbd::StepInputs> inputs,
                           std::span<const pbd::Material> materials, int) const override {
    std::vector<int> failed;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const bool explodes = materials[i].d_n > 20;
      if (explodes && notices_) {
        failed.push_back(static_cast<int>(i));
        continue;
      }
      states[i].positions = inputs[inputs.size() == 1 ? 0 : i].targets.map();
      if (explodes)
        states[i].positions.row(states[i].positions.rows() / 2).setConstant(value_);
    }
    return failed;
  }
  double value_;
  bool notices_;
};

TEST(MaterialObjective, AnExplosionCostsTheWorstAndStaysFinite) {
  for (const auto &[value, notices] : {std::pair{std::nan(""), false}, {1e300, false}, {-100.0, false}, {0.0, true}}) {
    const auto s = make_scene({cotton(), cotton()}, {12, 2, 160});
    const CharacterSimulator exploding(s->actor, s->segmentation, s->proxies, s->simulator->options(),
                                       [value = value, notices = notices](std::shared_ptr<const pbd::ClothModel> model) {
                                         return std::make_shared<Exploding>(std::move(model), value, notices);
                                       });
    EnergyOptions options;
    options.settle_frames = 0;
    const MaterialObjective objective(exploding, s->performance, s->observations, kDt, options);
    EXPECT_NE(objective.fingerprint(),
              MaterialObjective(*s->simulator, s->performance, s->observations, kDt, options).fingerprint());
    const pbd::Material good = cotton();
    pbd::Material bad = good;
    bad.d_n = 32;
    const MatrixRM energies = objective.energies({{good, good}, {bad, good}, {good, bad}, {bad, bad}}, {});
    ASSERT_TRUE(energies.allFinite());
    EXPECT_LT(energies.row(0).maxCoeff(), 0.9 * objective.worst_energy());
    // From the second frame on; the other region is as good as without.
    for (const auto &[sample, region] : {std::pair{1, 0}, {2, 1}, {3, 0}, {3, 1}})
      EXPECT_GT(energies(sample, region), 0.8 * objective.worst_energy());
    EXPECT_LT(energies(1, 1), 0.9 * objective.worst_energy());
    EXPECT_LT(energies(2, 0), 0.9 * objective.worst_energy());
  }
}

/// The surfaces of a scene with their cloth moved: place(frame, point).
std::vector<Vertices> moved(const Scene &s, const std::function<Eigen::RowVector3d(int, const Eigen::RowVector3d &)> &place) {
  std::vector<Vertices> surfaces = s.performance.surface.frames;
  for (std::size_t t = 0; t < surfaces.size(); ++t)
    for (Eigen::Index v = 0; v < surfaces[t].rows(); ++v)
      if (s.segmentation.region[v] >= 0)
        surfaces[t].row(v) = place(static_cast<int>(t), surfaces[t].row(v));
  return surfaces;
}

Eigen::RowVector3d out_of_sight(const Eigen::RowVector3d &point) {
  return point + Eigen::RowVector3d(0, 50, 0);
}

TEST(MaterialObjective, ASampleWithoutClothIsTheWorstAndWasFreeInThePaper) {
  const std::vector<Vertices> gone = moved(scene(), [](int, const Eigen::RowVector3d &p) { return out_of_sight(p); });
  const auto energies = [&](const EnergyOptions &options) {
    const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt, options);
    EXPECT_LE(objective.surface_energy(scene().performance.surface.frames)[0], objective.worst_energy());
    return std::array{objective.surface_energy(scene().performance.surface.frames)[0], objective.surface_energy(gone)[0],
                      objective.worst_energy()};
  };
  const auto [captured, without, worst] = energies({});
  EXPECT_LT(captured, 0.05 * worst);
  EXPECT_NEAR(without, worst, 1e-5 * worst);
  EXPECT_EQ(energies(EnergyOptions::paper())[1], 0);
  // Each term by itself.
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt);
  const FrameTerms terms = objective.surface_terms(gone)[0][7];
  const double rim_cap = 0.064 * 320;
  EXPECT_NEAR(terms.silhouette, rim_cap * rim_cap, 1e-3);
  EXPECT_NEAR(terms.contour, rim_cap * rim_cap, 1e-2);
  EXPECT_GE(terms.feature, std::pow(0.032 * 320, 2) - 1e-3);
}

TEST(MaterialObjective, EverySampleIsMeasuredOnTheSameFeaturesAndContour) {
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt);
  const std::vector<FrameTerms> captured = objective.surface_terms(scene().performance.surface.frames)[0];
  pbd::Material wild = with_drag(0);
  wild.k_bend = 0.01, wild.k_stretch = 0.6;
  for (const pbd::Material &material : {with_drag(32), wild}) {
    const std::vector<FrameTerms> terms = objective.terms({material})[0];
    for (std::size_t t = 0; t < terms.size(); ++t) {
      EXPECT_EQ(terms[t].features, captured[t].features) << t;
      EXPECT_EQ(terms[t].points, captured[t].points) << t;
    }
  }
  EXPECT_EQ(captured[0].features, 0);
  for (std::size_t t = 1; t < captured.size(); ++t)
    EXPECT_GT(captured[t].features, 50);
  // All of the outline's pixels that are not the trunk's: there are more than rims, which are vertices.
  for (const FrameTerms &terms : captured)
    EXPECT_GT(terms.points, terms.rims);
}

TEST(MaterialObjective, AMissedFeatureCostsWhereItsPointOfTheClothIs) {
  // Gone in every odd frame, so that all features of the even ones are missed.
  const std::vector<Vertices> flickering =
      moved(scene(), [](int t, const Eigen::RowVector3d &p) { return t % 2 ? out_of_sight(p) : p; });
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt);
  const std::vector<FrameTerms> terms = objective.surface_terms(flickering)[0];
  for (std::size_t t = 2; t < terms.size(); ++t)
    if (t % 2)
      EXPECT_GE(terms[t].feature, std::pow(0.032 * 320, 2) - 1e-3) << t;
    else
      EXPECT_LT(terms[t].feature, 0.5) << t; // a few lie where a coarse pixel shows another layer
}

TEST(MaterialObjective, AnotherRegionInItsPlaceDoesNotExplainAFeature) {
  const auto s = make_scene({cotton(), cotton()}, {12, 2, 240});
  std::vector<Vertices> swapped = s->performance.surface.frames;
  std::vector<Eigen::Index> rows[2];
  for (Eigen::Index v = 0; v < swapped[0].rows(); ++v)
    if (s->segmentation.region[v] >= 0)
      rows[s->segmentation.region[v]].push_back(v);
  ASSERT_EQ(rows[0].size(), rows[1].size());
  for (std::size_t t = 0; t < swapped.size(); ++t)
    for (std::size_t i = 0; i < rows[0].size(); ++i) {
      swapped[t].row(rows[0][i]) = s->performance.surface.frames[t].row(rows[1][i]);
      swapped[t].row(rows[1][i]) = s->performance.surface.frames[t].row(rows[0][i]);
    }
  const MaterialObjective objective(*s->simulator, s->performance, s->observations, kDt);
  const auto own = objective.surface_terms(s->performance.surface.frames), other = objective.surface_terms(swapped);
  for (int r : {0, 1})
    for (std::size_t t = 2; t < swapped.size(); ++t) { // the first frame is not captured but at rest
      EXPECT_EQ(other[r][t].features, own[r][t].features);
      EXPECT_LT(own[r][t].feature, 1);
      EXPECT_GT(other[r][t].feature, 0.9 * std::pow(0.032 * 240, 2)); // 1.2 m away, though not as every camera sees it
      EXPECT_GT(other[r][t].contour, 20 * own[r][t].contour);
    }
}

/// The fingerprints of problems that each differ in one thing, and so must they.
class Fingerprints {
public:
  explicit Fingerprints(const Scene &s) : s_(s) { add(EnergyOptions{}); }
  void add(const EnergyOptions &options, const ParameterSpace &space = {}) {
    prints_["options " + std::to_string(count_++)] =
        MaterialObjective(*s_.simulator, s_.performance, s_.observations, kDt, options, space).fingerprint();
  }
  /// `change` is applied to copies of what the scene is made of.
  void add(const std::string &what,
           const std::function<void(RiggedMesh &, Segmentation &, std::vector<TaperedCapsule> &, pbd::ClothOptions &,
                                    ReferencePerformance &, Observations &)> &change) {
    RiggedMesh actor = s_.actor;
    Segmentation segmentation = s_.segmentation;
    std::vector<TaperedCapsule> proxies = s_.proxies;
    pbd::ClothOptions cloth = s_.simulator->options();
    ReferencePerformance performance = s_.performance;
    Observations observations = s_.observations;
    change(actor, segmentation, proxies, cloth, performance, observations);
    const CharacterSimulator simulator(actor, segmentation, proxies, cloth);
    prints_[what] = MaterialObjective(simulator, performance, observations, kDt).fingerprint();
  }
  void expect_all_differ() const {
    for (const auto &[a, print] : prints_)
      for (const auto &[b, other] : prints_)
        EXPECT_EQ(print == other, a == b) << a << ", " << b;
  }
  const std::string &operator[](const std::string &what) const { return prints_.at(what); }

private:
  const Scene &s_;
  int count_ = 0;
  std::map<std::string, std::string> prints_;
};

TEST(MaterialObjective, TheFingerprintSeesWhateverTheEnergyDependsOn) {
  const auto s = make_scene({cotton()}, {12, 2, 160});
  Fingerprints prints(*s);
  const auto change_each = [](const auto &object, const auto &use) { // every option, to another valid value
    options::for_each_field(object, [&](const auto &field, const auto &value) {
      auto changed = object;
      auto &member = changed.*field.member;
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, bool>)
        member = !value;
      else if constexpr (std::is_enum_v<Value>)
        member = static_cast<Value>(1 - static_cast<int>(value));
      else if constexpr (std::is_integral_v<Value>)
        member = value + 1;
      else if constexpr (std::is_floating_point_v<Value>)
        member = field.allowed.contains(value * 1.01 + 1e-4) ? value * 1.01 + 1e-4 : value * 0.99;
      else if constexpr (std::is_same_v<Value, Eigen::Vector3d>)
        member.x() += 0.01;
      else
        return;
      use(field.name, changed);
    });
  };
  change_each(EnergyOptions{}, [&](const char *, const EnergyOptions &options) { prints.add(options); });
  change_each(pbd::Material{}, [&](const char *, const pbd::Material &fixed) {
    ParameterSpace space;
    space.fixed = fixed;
    prints.add({}, space);
  });
  ParameterSpace fewer;
  fewer.names.pop_back();
  prints.add({}, fewer);
  change_each(s->simulator->options(), [&](const char *name, const pbd::ClothOptions &changed) {
    prints.add(name, [&](auto &, auto &, auto &, auto &cloth, auto &, auto &) { cloth = changed; });
  });
  Eigen::Index cloth_vertex = 0;
  s->segmentation.clothness.maxCoeff(&cloth_vertex);
  prints.add("skin weights", [](auto &actor, auto &, auto &, auto &, auto &, auto &) { actor.weights(1, 0) += 1e-6; });
  prints.add("invalid face", [](auto &actor, auto &, auto &, auto &, auto &, auto &) {
    actor.face_valid.assign(actor.mesh.faces.rows(), 1);
    actor.face_valid.back() = 0;
  });
  prints.add("blend weight",
             [&](auto &, auto &segmentation, auto &, auto &, auto &, auto &) { segmentation.clothness[cloth_vertex] = 0.9; });
  prints.add("proxy", [](auto &, auto &, auto &proxies, auto &, auto &, auto &) { proxies[0].r0 += 1e-6; });
  prints.add("captured frame", [](auto &, auto &, auto &, auto &, auto &performance, auto &) {
    performance.surface.frames[9](0, 0) += 1e-9; // the captured cloth decides what is compared
  });
  prints.add("pose", [](auto &, auto &, auto &, auto &, auto &performance, auto &) { performance.dofs(9, 0) += 1e-6; });
  prints.add("image size", [](auto &, auto &, auto &, auto &, auto &, auto &observations) { ++observations.cameras[1].width; });
  prints.add("camera", [](auto &, auto &, auto &, auto &, auto &, auto &observations) { observations.cameras[1].t.x() += 1e-6; });
  prints.add("contour", [](auto &, auto &, auto &, auto &, auto &, auto &observations) {
    observations.views[5][1].contour.back().x() += 0.01f;
  });
  prints.add("contour of another view", [](auto &, auto &, auto &, auto &, auto &, auto &observations) {
    auto &views = observations.views[5];
    views[1].contour.push_back(views[0].contour.back());
    views[0].contour.pop_back();
  });
  prints.expect_all_differ();
}

TEST(MaterialObjective, AScrapOnTheContourDoesNotExplainIt) {
  // Every vertex near the lowest one on the right as the first camera sees it: what there is of an outline lies on the contour.
  const std::vector<Vertices> scrap = moved(scene(), [](int t, const Eigen::RowVector3d &p) {
    const Vertices &captured = scene().performance.surface.frames[t];
    const Camera &camera = scene().observations.cameras[0];
    Eigen::Index corner = 0;
    double best = -1e9;
    for (Eigen::Index v = 0; v < captured.rows(); ++v)
      if (const Eigen::Vector2d pixel = camera.project(captured.row(v).transpose());
          scene().segmentation.region[v] >= 0 && pixel.sum() > best)
        best = pixel.sum(), corner = v;
    return Eigen::RowVector3d(captured.row(corner) + 0.02 * (p - captured.row(corner)));
  });
  Observations one = scene().observations;
  for (auto &views : one.views)
    std::fill(views.begin() + 1, views.end(), ViewObservation{});
  const MaterialObjective objective(*scene().simulator, scene().performance, one, kDt);
  const auto mean = [&](const std::vector<Vertices> &surfaces, double FrameTerms::*term) {
    const std::vector<FrameTerms> frames = objective.surface_terms(surfaces)[0];
    return std::accumulate(frames.begin(), frames.end(), 0.0,
                           [&](double sum, const FrameTerms &f) { return sum + f.*term / 32; });
  };
  const std::vector<Vertices> &captured = scene().performance.surface.frames;
  EXPECT_LT(mean(scrap, &FrameTerms::silhouette), 20);
  EXPECT_GT(mean(scrap, &FrameTerms::contour), 200);
  EXPECT_LT(mean(captured, &FrameTerms::contour), 5);
}

/// E_sift of surfaces that stand still from frame t to t + 1, and that move the wrong way, one after the other.
/// From the point to the nearest of the faces, m, without a tree.
double plain_distance(const Eigen::Vector3d &p, const Vertices &vertices, const Faces &faces, const std::vector<int> &region) {
  double nearest = 1e30;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (region[faces(f, 0)] < 0 || region[faces(f, 1)] < 0 || region[faces(f, 2)] < 0)
      continue;
    const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
    const Eigen::Vector3d ab = b - a, ac = c - a;
    const Eigen::Vector3d at =
        closest_on_triangle(ab.dot(p - a), ac.dot(p - a), ab.dot(p - b), ac.dot(p - b), ab.dot(p - c), ac.dot(p - c));
    nearest = std::min(nearest, (at[0] * a + at[1] * b + at[2] * c - p).norm());
  }
  return nearest;
}

/// A garment carried sideways, so that part of it is nearer to other parts of the captured one than to its own place.
TEST(MaterialObjective, TheSurfaceTermIsTheSquaredDistanceToTheCapturedClothInPixels) {
  const Scene &s = scene();
  const MaterialObjective objective(*s.simulator, s.performance, s.observations, kDt);
  const std::vector<Vertices> aside =
      moved(s, [](int, const Eigen::RowVector3d &p) -> Eigen::RowVector3d { return p + Eigen::RowVector3d(0.03, 0.01, 0); });
  const std::vector<FrameTerms> terms = objective.surface_terms(aside)[0];
  const std::vector<int> region(s.segmentation.region.begin(), s.segmentation.region.end());
  for (const int t : {0, 4, 28}) {
    const Vertices &captured = s.performance.surface.frames[t];
    const Eigen::Vector3d middle = captured.colwise().mean().transpose();
    double scale = 0;
    for (const Camera &camera : s.observations.cameras)
      scale += camera.K(0, 0) / camera.depth(middle) / static_cast<double>(s.observations.cameras.size());
    std::vector<double> squared;
    for (Eigen::Index v = 0; v < captured.rows(); ++v)
      if (region[v] >= 0)
        squared.push_back(std::pow(scale * plain_distance(aside[t].row(v).transpose(), captured, s.actor.mesh.faces, region), 2));
    const double all = std::accumulate(squared.begin(), squared.end(), 0.0) / static_cast<double>(squared.size());
    EXPECT_NEAR(terms[t].probes, static_cast<double>(squared.size()) / 7, 1);
    EXPECT_NEAR(terms[t].surface, all, 0.1 * all) << t; // of one vertex in seven
    EXPECT_GT(all, 0.5) << t;
  }
  EXPECT_EQ(terms[5].probes, 0);
  const std::vector<FrameTerms> own = objective.surface_terms(s.performance.surface.frames)[0];
  EXPECT_LT(std::max_element(own.begin(), own.end(), [](auto &a, auto &b) { return a.surface < b.surface; })->surface, 1e-6);
  EnergyOptions images;
  images.delta = 0;
  const MaterialObjective blind(*s.simulator, s.performance, s.observations, kDt, images);
  EXPECT_EQ(blind.surface_terms(aside)[0][4].probes, 0);
  const double without = blind.surface_energy(aside)[0];
  double term = 0;
  for (int t = 0; t < 32; t += 4)
    term += terms[t].surface / 8;
  EXPECT_NEAR(objective.surface_energy(aside)[0], without + term, 1e-9);
}

std::pair<double, double> still_and_wrong(const EnergyOptions &options, int t) {
  const std::vector<Vertices> &captured = scene().performance.surface.frames;
  std::vector<Vertices> still = captured, wrong = captured;
  still[t + 1] = captured[t];
  wrong[t + 1] = 2 * captured[t] - captured[t + 1];
  const MaterialObjective objective(*scene().simulator, scene().performance, scene().observations, kDt, options);
  return {objective.surface_terms(still)[0][t + 1].feature, objective.surface_terms(wrong)[0][t + 1].feature};
}

TEST(MaterialObjective, CapsAreForMismatchesNotForFastCloth) {
  EnergyOptions options;
  options.feature_cap = 0.003; // a pixel, which the cloth outruns
  const double cap = std::pow(0.003 * 320, 2);
  const auto [still, wrong] = still_and_wrong(options, 10);
  EXPECT_GT(still, 2 * cap);
  EXPECT_GT(wrong, 1.2 * still);
  options.speed_dependent_cap = false;
  const auto [capped_still, capped_wrong] = still_and_wrong(options, 10);
  EXPECT_LE(capped_still, cap * (1 + 1e-6));
  EXPECT_LE(capped_wrong, cap * (1 + 1e-6));
}

TEST(MaterialObjective, AFrameWithoutObservationsCountsForNoSample) {
  Observations observations = scene().observations;
  for (ViewObservation &view : observations.views[5])
    view = {};
  const MaterialObjective objective(*scene().simulator, scene().performance, observations, kDt);
  const std::vector<FrameTerms> terms = objective.terms({with_drag(32)})[0];
  EXPECT_EQ(terms[5].rims + terms[5].features + terms[5].points, 0);
  FrameTerms sum;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    sum.silhouette += terms[t].silhouette / 31, sum.contour += terms[t].contour / 31; // of 32
    sum.feature += terms[t].feature / 30;                                             // none at the first frame either
    sum.surface += terms[t].surface / 8;                                              // in every fourth frame
  }
  const EnergyOptions weights;
  EXPECT_NEAR(objective.energies({{with_drag(32)}}, {})(0, 0),
              sum.silhouette + sum.contour + weights.beta * sum.feature + weights.delta * sum.surface, 1e-9);
}

TEST(MaterialObjective, AWindowsFirstFrameHasFeaturesWhereverItsLeadEnds) {
  const auto s = make_scene({cotton()}, {80, 1, 160});
  EnergyOptions options;
  options.window = 40;
  for (int lead : {31, 32, 33}) { // frames are simulated 32 at a time
    options.window_lead = lead;
    const MaterialObjective objective(*s->simulator, s->performance, s->observations, kDt, options);
    EXPECT_GT(objective.terms({cotton()})[0][40].features, 0) << lead;
  }
}

TEST(MaterialObjective, MeasuresGivenSurfacesAsIfTheyWereSimulated) {
  const Scene &s = scene();
  const MaterialObjective objective(*s.simulator, s.performance, s.observations, kDt);
  const std::vector<Vertices> simulated = simulate_reference(*s.simulator, s.performance, {with_drag(16)}, kDt);
  const std::vector<FrameTerms> expected = objective.terms({with_drag(16)})[0], found = objective.surface_terms(simulated)[0];
  for (std::size_t t = 0; t < expected.size(); ++t) {
    EXPECT_EQ(found[t].silhouette, expected[t].silhouette) << t;
    EXPECT_EQ(found[t].feature, expected[t].feature) << t;
    EXPECT_EQ(found[t].contour, expected[t].contour) << t;
  }
  EXPECT_EQ(objective.surface_energy(simulated)[0], objective.energies({{with_drag(16)}}, {})(0, 0));
  EXPECT_THROW(objective.surface_energy({}), std::invalid_argument);
  std::vector<Vertices> bad = simulated;
  bad[3](0, 0) = std::nan("");
  EXPECT_THROW(objective.surface_terms(bad), std::invalid_argument);
  bad[3].conservativeResize(5, 3);
  EXPECT_THROW(objective.surface_terms(bad), std::invalid_argument);
}

TEST(MaterialObjective, RefusesWhatDoesNotBelongTogether) {
  const Scene &s = scene();
  const auto make = [&](const ReferencePerformance &performance, const Observations &observations) {
    MaterialObjective(*s.simulator, performance, observations, kDt);
  };
  Observations observations = s.observations;
  observations.views.pop_back();
  EXPECT_THROW(make(s.performance, observations), Error);
  observations = s.observations;
  observations.frames[3] = 77;
  EXPECT_THROW(make(s.performance, observations), Error);
  observations = s.observations;
  observations.views[2].pop_back();
  EXPECT_THROW(make(s.performance, observations), Error);
  ReferencePerformance performance = s.performance;
  performance.dofs.conservativeResize(performance.dofs.rows(), 3);
  EXPECT_THROW(make(performance, s.observations), Error);
  performance = s.performance;
  performance.surface.frames[5].conservativeResize(7, 3);
  EXPECT_THROW(make(performance, s.observations), Error);
  performance = s.performance;
  performance.dofs(5, 0) = std::nan("");
  EXPECT_THROW(make(performance, s.observations), Error);
  EXPECT_THROW(make({}, {}), Error);

  Segmentation rigid = s.segmentation;
  rigid.region.setConstant(-1);
  rigid.region_count = 0;
  const CharacterSimulator naked(s.actor, rigid, s.proxies);
  EXPECT_THROW(MaterialObjective(naked, s.performance, s.observations, kDt), std::invalid_argument);
  MaterialObjective objective(*s.simulator, s.performance, s.observations, kDt);
  EXPECT_THROW(objective.evaluate(MatrixRM::Zero(2, 4), {}), std::invalid_argument);
  EXPECT_THROW(objective.energies({{}}, {}), std::invalid_argument);
  try {
    objective.surface_terms({});
    ADD_FAILURE() << "no error";
  } catch (const std::invalid_argument &error) {
    EXPECT_STREQ(error.what(), ("MaterialObjective: surfaces: expected " + std::to_string(s.performance.dofs.rows()) +
                                ", one per frame, found 0")
                                   .c_str());
  }
}

TEST(ParameterSpace, MapsTheBoxBothWays) {
  ParameterSpace space = ParameterSpace::paper();
  EXPECT_DOUBLE_EQ(space.material(Eigen::VectorXd::Constant(5, 0.5)).d_n, 16);
  EXPECT_GT(space.material(Eigen::VectorXd::Zero(5)).k_stretch, 0);
  for (bool even : {false, true}) {
    space.warp_parameters = even;
    const Eigen::VectorXd unit = space.unit(cotton());
    EXPECT_NEAR((space.unit(space.material(unit)) - unit).norm(), 0, 1e-12);
    EXPECT_DOUBLE_EQ(space.material(Eigen::VectorXd::Ones(5)).d_t, 32);
    EXPECT_DOUBLE_EQ(space.material(Eigen::VectorXd::Ones(5)).k_stretch, 1);
  }
  const pbd::Material middle = space.material(Eigen::VectorXd::Constant(5, 0.5));
  EXPECT_DOUBLE_EQ(middle.d_n, 8);
  EXPECT_DOUBLE_EQ(middle.k_bend, 0.5);
  EXPECT_DOUBLE_EQ(middle.k_stretch, 1 - 0.0625);
  space.warp_parameters = false;
  space.names = {"k_damping", "d_n"};
  space.fixed = cotton();
  const pbd::Material material = space.material(Eigen::Vector2d(0.25, 0.5));
  EXPECT_DOUBLE_EQ(material.k_damping, 0.25);
  EXPECT_DOUBLE_EQ(material.d_n, 16);
  EXPECT_DOUBLE_EQ(material.d_t, cotton().d_t);
  space.names = {"d_n", "weight"};
  EXPECT_THROW(space.validate(), std::invalid_argument);
  space.names = {"d_n", "d_n"};
  EXPECT_THROW(space.validate(), std::invalid_argument);
}

FitOptions quick() {
  FitOptions options;
  options.optimizer = SearchMethod::CmaEs;
  options.space = ParameterSpace::paper();
  options.space.names = {"d_n", "k_bend"};
  options.space.fixed = cotton();
  options.max_evaluations = 48;
  return options;
}

/// The search as users run it, in two parameters.
FitOptions usual() {
  FitOptions options;
  options.space.names = {"d_n", "k_bend"};
  options.space.fixed = cotton();
  return options;
}

void expect_recovered_from_seeds(std::uint64_t first, std::uint64_t last) {
  FitOptions options = usual();
  for (options.seed = first; options.seed <= last; ++options.seed) {
    const FitResult result = estimate_material(*scene().simulator, scene().performance, scene().observations, kDt, options);
    const RegionFit &fit = result.regions[0];
    const MatrixRM &known = fit.posterior.interval;
    std::printf("d_n %.2f (true 4; box %.2f to %.2f), k_bend %.3f (true 0.3; %.2f to %.2f), energy %.2f +- %.2f, centre %.2f, %d "
                "evaluations, %s\n",
                fit.material.d_n, known(0, 0), known(0, 1), fit.material.k_bend, known(1, 0), known(1, 1), fit.energy,
                fit.energy_noise, fit.energy_at_centre, fit.evaluations, fit.stop_reason.c_str());
    EXPECT_NEAR(fit.material.d_n, 4, 0.5);
    EXPECT_LT(fit.energy, 0.25 * fit.energy_at_centre); // not 0: the first frame is captured as it rests
    EXPECT_DOUBLE_EQ(fit.material.d_t, cotton().d_t);
    EXPECT_EQ(fit.confidence()[0], Confidence::High);
    EXPECT_LE(fit.evaluations, 256);
  }
}

TEST(EstimateMaterial, RecoversTheMaterialOfItsOwnSimulation) {
  expect_recovered_from_seeds(1, 1);
}
TEST(SlowEstimateMaterial, RecoversTheMaterialOfItsOwnSimulationFromEverySeed) {
  expect_recovered_from_seeds(2, 4);
}

TEST(EstimateMaterial, FindsTheWidthThatWasFilmed) {
  const CharacterSimulator widths[] = {in_width(scene(), 1.4), in_width(scene(), 1.2), in_width(scene(), 1)};
  FitOptions options = usual();
  options.max_evaluations = 160;
  const Take take{{&widths[0], &widths[1], &widths[2]}, &scene().performance, &scene().observations, kDt};
  const FitResult result = estimate_material({take}, options);
  EXPECT_EQ(result.parameters(), (std::vector<std::string>{"d_n", "k_bend", "width"}));
  EXPECT_EQ(result.chosen_widths(), std::vector<double>{2});
  EXPECT_NEAR(result.regions[0].material.d_n, 4, 1);
  EXPECT_EQ(result.regions[0].posterior.interval.rows(), 3);
  const TempFolder folder;
  write_materials(folder / "material.json", result);
  EXPECT_EQ(read_widths(folder / "material.json"), std::vector<double>{2});
  write_text(folder / "material.json", "{\"regions\": [{\"width\": -1}]}");
  EXPECT_THROW(read_widths(folder / "material.json"), Error);
}

/// Two films of one material: the energies are added, and one answer explains both.
TEST(EstimateMaterial, SeveralTakesHaveOneAnswer) {
  const auto a = make_scene({cotton()}, {16, 2, 160}), b = make_scene({cotton()}, {24, 3, 160});
  const Take first{{a->simulator.get()}, &a->performance, &a->observations, kDt},
      second{{b->simulator.get()}, &b->performance, &b->observations, kDt};
  FitOptions options = usual();
  options.max_evaluations = 128;
  const FitResult both = estimate_material({first, second}, options);
  const RegionFit &fit = both.regions[0];
  EXPECT_NEAR(fit.material.d_n, 4, 1);
  const double apart = material_energy(*a->simulator, a->performance, a->observations, kDt, both.materials())[0] +
                       material_energy(*b->simulator, b->performance, b->observations, kDt, both.materials())[0];
  EXPECT_NEAR(fit.energy, apart, 3 * fit.energy_noise + 0.05 * apart);
  EXPECT_THROW(estimate_material(std::vector<Take>{}, options), std::invalid_argument);
  const auto two = make_scene({cotton(), cotton()}, {12, 2, 160});
  const Take other{{two->simulator.get()}, &two->performance, &two->observations, kDt};
  EXPECT_THROW(estimate_material({first, other}, options), std::invalid_argument);
  const Eigen::Index count = a->simulator->actor().mesh.vertices.rows();
  const CharacterSimulator bare(
      a->simulator->actor(), {Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count), -Eigen::VectorXi::Ones(count), 0}, {});
  Take without_cloth{{&bare}, &a->performance, &a->observations, kDt};
  EXPECT_THROW(estimate_material({without_cloth, first}, options), std::invalid_argument);
  EXPECT_TRUE(estimate_material({without_cloth}, options).regions.empty());
  without_cloth.dt = 0;
  EXPECT_THROW(estimate_material({without_cloth}, options), std::invalid_argument);
}

TEST(EstimateMaterial, SaysWhatItHasAfterEveryGeneration) {
  const auto s = make_scene({with_drag(0)}, {12, 2, 160});
  FitOptions options = quick();
  options.penalty = 1; // so that the best samples lie outside the box
  std::vector<double> energies;
  FitResult last;
  options.on_generation = [&](const FitResult &result) {
    EXPECT_TRUE(result.interrupted);
    energies.push_back(result.regions.at(0).energy);
    last = result;
  };
  const FitResult whole = estimate_material(*s->simulator, s->performance, s->observations, kDt, options);
  EXPECT_FALSE(whole.interrupted);
  EXPECT_EQ(energies.size(), whole.log.size());
  EXPECT_TRUE(std::is_sorted(energies.rbegin(), energies.rend()));
  EXPECT_NEAR(last.regions[0].energy, whole.regions[0].best_energy, 1e-9); // without the penalty of samples outside the box
  EXPECT_EQ(last.regions[0].material.d_n, whole.regions[0].best.d_n);
  EXPECT_TRUE(last.regions[0].confidence().empty());
}

TEST(EstimateMaterial, CanBeDoneByAnnealing) {
  const auto s = make_scene({cotton()}, {12, 2, 160});
  FitOptions options = quick();
  options.optimizer = SearchMethod::Annealing;
  const RegionFit fit = estimate_material(*s->simulator, s->performance, s->observations, kDt, options).regions[0];
  EXPECT_EQ(fit.evaluations, 48);
  EXPECT_NEAR(fit.energy, fit.best_energy, 0.05 * fit.best_energy); // its answer is the best sample
  EXPECT_LT(fit.energy, fit.energy_at_centre);
  options.optimizer = static_cast<SearchMethod>(3);
  EXPECT_THROW(options.validate(), std::invalid_argument);
}

class EstimateMaterialWith : public ::testing::TestWithParam<SearchMethod> {};
INSTANTIATE_TEST_SUITE_P(Optimizers, EstimateMaterialWith, ::testing::Values(SearchMethod::Bayesian, SearchMethod::CmaEs),
                         [](const auto &test) { return test.param == SearchMethod::CmaEs ? "cma" : "bay"; });

TEST_P(EstimateMaterialWith, ResumesToTheSameBitsForAnyNumberOfThreads) {
  const auto s = make_scene({cotton()}, {15, 2, 160});
  const auto quick = [] {
    FitOptions options = doublet::quick();
    options.optimizer = GetParam();
    options.initial_design_size = 16;
    options.population = 8;
    options.min_gain = 0;
    return options;
  };
  const auto run = [&](const FitOptions &options, const Context &context) {
    return estimate_material(*s->simulator, s->performance, s->observations, kDt, options, context);
  };
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const FitResult whole = run(quick(), one);

  const TempFolder folder;
  FitOptions options = quick();
  options.checkpoint = folder / "checkpoint.json";
  options.log = folder / "fit_log.csv";
  int reports = 0;
  two.progress = [&](const std::string &stage, double) { reports += stage == "fit"; };
  two.cancelled = [&] { return reports == 4; };
  EXPECT_THROW(run(options, two), Cancelled);
  EXPECT_TRUE(std::filesystem::exists(options.checkpoint));
  EXPECT_TRUE(std::filesystem::exists(options.log));
  two.cancelled = nullptr;
  const FitResult resumed = run(options, two);
  const auto bits = [](const FitResult &r) {
    const RegionFit &f = r.regions[0];
    return std::vector<double>{f.material.d_n,
                               f.material.k_bend,
                               f.energy,
                               f.energy_at_centre,
                               f.best.d_n,
                               f.best_energy,
                               f.posterior.interval(0, 0),
                               f.posterior.interval(1, 1)};
  };
  EXPECT_EQ(bits(resumed), bits(whole));
  EXPECT_EQ(resumed.log.size(), whole.log.size());
  std::ifstream log(options.log);
  std::string line;
  std::getline(log, line);
  EXPECT_EQ(line,
            "region,generation,evaluations,best,generation_best,mean_d_n,mean_k_bend,deviation_d_n,deviation_k_bend,seconds");
  std::size_t rows = 0;
  while (std::getline(log, line))
    ++rows;
  EXPECT_EQ(rows, resumed.log.size());

  options.seed = 2; // other options: the checkpoint is not used
  EXPECT_NE(bits(run(options, two)), bits(whole));
}

TEST(EstimateMaterial, SeveralSeedsAnswerTheLowestAndTellTheirSpread) {
  const auto s = make_scene({cotton(), with_drag(24)}, {12, 2, 160});
  FitOptions options = quick();
  options.max_evaluations = 18; // three generations: the searches end far apart
  const auto run = [&](std::uint64_t seed, int seeds, const Path &checkpoint = {}, const Context &context = {}) {
    options.seed = seed, options.seeds = seeds, options.checkpoint = checkpoint;
    return estimate_material(*s->simulator, s->performance, s->observations, kDt, options, context);
  };
  // Region r of search k starts from seed + k R + r, and samples do not know of each other.
  const FitResult one = run(1, 1), two = run(3, 1), both = run(1, 2);
  for (int r : {0, 1}) {
    const RegionFit &first = one.regions[r], &second = two.regions[r], &fit = both.regions[r];
    const RegionFit &better = first.energy <= second.energy ? first : second;
    EXPECT_EQ(fit.answer, better.answer);
    EXPECT_EQ(fit.energy, better.energy);
    EXPECT_EQ(fit.best_energy, better.best_energy);
    EXPECT_EQ(fit.evaluations, first.evaluations + second.evaluations);
    EXPECT_NEAR((fit.answer_half_range - (first.answer - second.answer).cwiseAbs() / 2).norm(), 0, 1e-15);
    EXPECT_EQ(first.answer_half_range.size(), 0);
  }
  EXPECT_EQ(both.log.size(), one.log.size()); // of the searches that are answered
  EXPECT_EQ(both.log[0].part, 0);
  EXPECT_EQ(both.log[1].part, 1);

  const TempFolder folder;
  Context context;
  int reports = 0;
  context.progress = [&](const std::string &stage, double) { reports += stage == "fit"; };
  context.cancelled = [&] { return reports == 2; };
  EXPECT_THROW(run(1, 2, folder / "checkpoint.json", context), Cancelled);
  const FitResult resumed = run(1, 2, folder / "checkpoint.json");
  for (int r : {0, 1}) {
    EXPECT_EQ(resumed.regions[r].answer, both.regions[r].answer);
    EXPECT_EQ(resumed.regions[r].answer_half_range, both.regions[r].answer_half_range);
  }
  options.seeds = 0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
}

/// Three parameters: in the middle of its box, at its lower bound, within 0.01 of its upper bound.
RegionFit three_parameters() {
  RegionFit fit;
  fit.material = cotton();
  fit.material.d_n = 8, fit.material.d_t = 0, fit.material.k_bend = 0.995;
  fit.answer = Eigen::Vector3d(0.5, 0, 0.995);
  fit.deviations = Eigen::Vector3d(0.02, 0.02, 0.2);
  return fit;
}

TEST(RegionFit, FindingsNameWhatIsDoubtful) {
  RegionFit fit = three_parameters();
  ParameterSpace space;
  space.names = {"d_n", "d_t", "k_bend"};
  const auto texts = [&] {
    std::vector<std::string> result;
    for (const FitFinding &finding : fit.findings(space))
      result.push_back(finding.text());
    return result;
  };
  EXPECT_EQ(texts(), (std::vector<std::string>{
                         "d_t = 0 lies at the lower bound of its box, 0: the search would go further if it could.",
                         "k_bend = 0.995 lies at the upper bound of its box, 1: the search would go further if it could."}));
  fit.answer = Eigen::Vector3d(0.5, 0.011, 0.989);
  EXPECT_TRUE(texts().empty());
  fit.posterior.interval.resize(3, 2);
  fit.posterior.interval << 0.25, 0.8, 0, 0.1, 0.7, 0.99;
  EXPECT_EQ(texts(), (std::vector<std::string>{"d_n = 8 is a guess: its 90 % interval is 2 to 20.5."}));
  fit.posterior.interval(0, 1) = 0.3;
  fit.answer_half_range = Eigen::Vector3d(0.1, 0.2, 0);
  ASSERT_EQ(texts().size(), 1u);
  EXPECT_EQ(texts()[0].substr(0, 27), "d_t = 0 depends on the seed");
  for (const char *kind : {"lower_bound", "upper_bound", "guess", "seeds"})
    EXPECT_STREQ(finding_name(finding_kind(kind)), kind);
  EXPECT_THROW(finding_kind("weight"), std::invalid_argument);
}

TEST(RegionFit, ConfidenceFollowsFromTheInterval) {
  RegionFit fit = three_parameters();
  EXPECT_TRUE(fit.confidence().empty());
  fit.posterior.interval.resize(3, 2);
  fit.posterior.interval << 0.1, 0.2, 0.1, 0.5, 0.1, 0.9;
  using enum Confidence;
  EXPECT_EQ(fit.confidence(), (std::vector{High, Medium, Low}));
}

TEST(EstimateMaterial, SaysWhatIsDoubtful) {
  const auto s = make_scene({cotton()}, {12, 2, 160});
  FitOptions options = usual();
  options.max_evaluations = 96;
  options.space.names = {"d_n", "k_friction"}; // nothing is touched
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line + "\n"; };
  const FitResult result = estimate_material(*s->simulator, s->performance, s->observations, kDt, options, context);
  EXPECT_NE(said.find("fit: region 0: k_friction = "), std::string::npos) << said;
  const TempFolder folder;
  write_materials(folder / "material.json", result);
  EXPECT_NE(read_text(folder / "material.json").find("\"kind\": \"guess\""), std::string::npos);
}

TEST(EstimateMaterial, EveryRegionGetsItsOwn) {
  pbd::Material heavy = cotton();
  heavy.d_n = 24;
  const auto s = make_scene({cotton(), heavy}, {20, 2, 240});
  FitOptions options = usual();
  options.space.names = {"d_n"};
  const FitResult result = estimate_material(*s->simulator, s->performance, s->observations, kDt, options);
  ASSERT_EQ(result.regions.size(), 2u);
  EXPECT_NEAR(result.regions[0].material.d_n, 4, 3.2);
  EXPECT_NEAR(result.regions[1].material.d_n, 24, 6.4);
}

TEST(MaterialFiles, AreReadBack) {
  FitResult result;
  result.space.names = {"d_n", "k_bend"};
  RegionFit region;
  region.material = cotton();
  region.answer = Eigen::Vector2d(0.35, 0.3);
  region.deviations = Eigen::Vector2d(0.1, 0.02);
  result.regions = {region, region};
  result.regions[1].material.d_n = 1.0 / 3;
  result.regions[1].answer_half_range = Eigen::Vector2d(0.25, 0);
  result.regions[1].posterior.draws = MatrixRM::Constant(2, 2, 0.123456);
  result.regions[1].posterior.interval.resize(2, 2);
  result.regions[1].posterior.interval << 0.25, 0.9, 0.2, 0.3;
  result.regions[1].posterior.correlation = Eigen::MatrixXd::Identity(2, 2);
  const TempFolder folder;
  write_materials(folder / "material.json", result);
  const std::vector<pbd::Material> read = read_materials(folder / "material.json");
  ASSERT_EQ(read.size(), 2u);
  for (const pbd::MaterialParameter &p : pbd::material_parameters())
    for (int r : {0, 1})
      EXPECT_EQ(read[r].*p.value, result.regions[r].material.*p.value);

  const std::string written = read_text(folder / "material.json");
  for (const char *part : {"\"d_n\": \"low\"", "\"k_bend\": \"high\"", "\"findings\": []", "\"kind\": \"seeds\"", "0.1235"})
    EXPECT_NE(written.find(part), std::string::npos) << part;
  EXPECT_NE(written.find("2.0"), std::string::npos);              // 32 * 0.25^2: the interval in the parameter's unit
  EXPECT_EQ(written.find("energy_at_centre"), std::string::npos); // not measured

  EXPECT_NO_THROW(read_materials(folder / "material.json", result.solver));
  SolverSettings other = result.solver;
  other.cloth.restitution = 0.25;
  const auto refusal = [&](const char *file) {
    try {
      read_materials(folder / file, other);
    } catch (const Error &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("material.json").find("material.json: solver setting cloth.restitution: expected 0.25, found 0"),
            std::string::npos);
  write_text(folder / "newer.json", R"({"version": 3, "regions": []})");
  EXPECT_NE(refusal("newer.json").find("expected version 1 to 2 of material.json, found 3, which a newer doublet wrote"),
            std::string::npos);
  // Version 1 knew these four alone.
  write_text(folder / "first.json",
             R"({"solver": {"dt": 0.025, "n_iter": 24, "substeps": 1, "stiffness": "sweeps"}, "regions": []})");
  other.cloth = pbd::ClothOptions::paper();
  EXPECT_EQ(refusal("first.json"), "");
  other.cloth.stiffness = pbd::Stiffness::Compliance;
  EXPECT_NE(refusal("first.json").find("cloth.stiffness: expected compliance, found sweeps"), std::string::npos);

  for (const char *count : {"24.5", "2e30", "-0.5"}) { // 24.5 iterations are not 24
    write_text(folder / "part.json", std::string(R"({"solver": {"dt": 0.025, "n_iter": )") + count + R"(}, "regions": []})");
    EXPECT_NE(refusal("part.json").find("iterations: expected a whole number, found"), std::string::npos) << count;
  }

  EXPECT_THROW(read_materials(folder / "none.json"), FileNotFound);
  for (const char *text : {"{", "[]", "{\"regions\": [{}]}", "{\"regions\": [{\"parameters\": {\"d_n\": \"much\"}}]}"}) {
    write_text(folder / "bad.json", text);
    EXPECT_THROW(read_materials(folder / "bad.json"), Error) << text;
  }
  result.regions[0].material.d_n = 99;
  write_materials(folder / "material.json", result);
  EXPECT_THROW(read_materials(folder / "material.json"), Error);
}

TEST(MaterialFiles, TheIntervalOfAWidthIsThatOfItsPositions) {
  FitResult result;
  result.space.names = {"d_n"};
  result.widths = 3;
  RegionFit region;
  region.material = cotton();
  region.width = 2;
  region.answer = Eigen::Vector2d(0.35, 1);
  region.deviations = Eigen::Vector2d(0.1, 0.1);
  region.posterior.draws = MatrixRM::Constant(2, 2, 0.5);
  region.posterior.interval.resize(2, 2);
  region.posterior.interval << 0.2, 0.3, 0.25, 1;
  region.posterior.correlation = Eigen::MatrixXd::Identity(2, 2);
  result.regions = {region};
  const TempFolder folder;
  const auto numbers_behind = [&](const FitResult &fit, const std::string &key) {
    write_materials(folder / "material.json", fit);
    std::string text = read_text(folder / "material.json");
    text = text.substr(text.find(key) + key.size());
    std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
    return text.substr(0, text.find(']') + 1);
  };
  EXPECT_EQ(numbers_behind(result, "\"width\": ["), "0.5,2.0]");
  const FitResult placed = result.at_positions({3.5, 4.25, 5});
  EXPECT_EQ(placed.chosen_widths(), std::vector<double>{5});
  EXPECT_EQ(numbers_behind(placed, "\"width\": ["), "3.875,5.0]");
}

TEST(SimulatedFile, IsReadBack) {
  const TempFolder folder;
  const std::vector<Vertices> frames = {scene().frames[0], scene().frames[5]};
  for (const Eigen::Index actor : {frames[0].rows(), frames[0].rows() - 7}) { // without and with a garment
    write_simulated(folder / "simulated.npz", frames, actor);
    const std::vector<Vertices> read = read_simulated(folder / "simulated.npz");
    ASSERT_EQ(read.size(), 2u);
    EXPECT_LT((read[1] - frames[1]).cwiseAbs().maxCoeff(), 1e-6);
  }
  EXPECT_THROW(write_simulated(folder / "simulated.npz", {}, 1), std::invalid_argument);
  EXPECT_THROW(write_simulated(folder / "simulated.npz", frames, 0), std::invalid_argument);
  EXPECT_THROW(write_simulated(folder / "simulated.npz", frames, frames[0].rows() + 1), std::invalid_argument);
}

/// Stretch and bend both rigid, no air: a swinging skirt stays a skirt and does not fold up into a heap.
TEST(Synthetic, RigidSkirtOutlivesItsSwing) {
  const auto scene = make_scene({cotton()}, {60, 1, 64, 25, 52, true});
  pbd::Material rigid;
  rigid.d_n = rigid.d_t = 0;
  rigid.k_bend = rigid.k_stretch = rigid.k_friction = 1;
  for (const auto &[iterations, substeps] : {std::pair{24, 1}, {12, 2}, {6, 4}}) {
    pbd::ClothOptions options = pbd::ClothOptions::paper();
    options.iterations = iterations, options.substeps = substeps;
    const CharacterSimulator simulator(scene->actor, scene->segmentation, scene->proxies, options);
    const Vertices last = simulate_reference(simulator, scene->performance, {rigid}, kDt).back();
    double low = 1, high = 0;
    for (Eigen::Index v = 0; v < last.rows(); ++v)
      if (scene->segmentation.region[v] == 0)
        low = std::min(low, last(v, 1)), high = std::max(high, last(v, 1));
    EXPECT_GT(high - low, 0.45) << iterations; // 0.54 m at rest
  }
}

} // namespace
} // namespace doublet
