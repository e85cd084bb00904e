#include "doublet/fit/material_objective.h"

#include "captured_cloth.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "doublet/fit/distance_field.h"
#include "fingerprint.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <mutex>
#include <span>
#include <typeinfo>

namespace doublet {
namespace {

using namespace fit;

constexpr int kFramesPerChunk = 32; // between two polls for cancellation
constexpr int kLargestGroup = 16;   // samples that the solver steps side by side
constexpr int kSmallestGroup = 4;   // below which a group is not worth a thread of its own
constexpr int kStages = 8;          // of a call, between which hopeless samples are stopped

struct Box {
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  void add(const Eigen::Vector2d &p) {
    x0 = std::min(x0, static_cast<float>(p.x())), x1 = std::max(x1, static_cast<float>(p.x()));
    y0 = std::min(y0, static_cast<float>(p.y())), y1 = std::max(y1, static_cast<float>(p.y()));
  }
  bool empty() const { return x0 > x1 || y0 > y1; }
};

/// What is kept of one camera at one frame.
struct FrameView {
  bool seen = false; ///< the image is there, and the cloth in it
  DistanceField contour;
  CoarseBuffer others; ///< depth of everything that is not cloth: it is the same for every sample
};

/// Frames that are simulated in one go.
struct Window {
  int start = 0;          ///< from the captured surface
  int first = 0, end = 0; ///< frames that count
  CharacterState state;   ///< at the start
};

using Terms = std::vector<std::vector<FrameTerms>>; // [R][T]

/// One sample on its way through a window.
struct Rollout {
  int sample;
  std::vector<pbd::Material> materials; ///< [R]
  CharacterState state;
  std::vector<std::uint8_t> exploded; ///< [R]
  Terms *terms = nullptr;             ///< of the sample
};

/// Rollouts that go through a window side by side.
struct Group {
  const Window *window;
  std::span<Rollout> rollouts;
  int from, to; ///< frames
};

/// A call of energies(): what is known about its samples so far.
struct Samples {
  std::vector<std::vector<pbd::Material>> materials; ///< [S][R]
  std::vector<Terms> terms;                          ///< [S]
  std::vector<std::uint8_t> stopped;                 ///< [S]
  MatrixRM ratio;                                    ///< (S, R) to the sample in the middle, when it was stopped
};

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The CPU time of this thread, sorted by what it was spent on.
class Stopwatch {
public:
  /// Adds the time since the last call, or since the start, to `part`.
  void lap(double EnergyTimes::*part) {
    const double now = thread_seconds();
    times_.*part += now - last_;
    last_ = now;
  }
  const EnergyTimes &times() const { return times_; }

private:
  EnergyTimes times_;
  double last_ = thread_seconds();
};

/// What measures a group of rollouts, one in each lane.
struct Measure {
  Stopwatch watch;
  ClothView view;
  std::vector<LocatedFeatures> located;    ///< [cameras]
  std::vector<std::vector<float>> largest; ///< [cameras][located features] what each costs at most, pixels^2
  std::vector<Rim> rims;
  std::vector<float> squared; ///< of contour points, pixels^2
  Measure(const ClothTopology &topology, std::size_t samples, std::size_t cameras)
      : view(topology, static_cast<int>(samples)), located(cameras), largest(cameras) {}
};

int field_cell(const Camera &camera, int field_size) {
  return std::max(1, static_cast<int>(std::lround(std::max(camera.width, camera.height) / static_cast<double>(field_size))));
}

/// The last of those that CMA-ES selects from a population, of which `values` are the lowest.
double middle(std::vector<double> values, std::size_t population) {
  const std::size_t last = std::max<std::size_t>(1, population / 2) - 1; // that CMA-ES selects
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(last), values.end());
  return values[last];
}

} // namespace

void EnergyOptions::validate() const {
  const auto positive = [](double value, const char *name) {
    require(value > 0 && std::isfinite(value),
            std::string("EnergyOptions: ") + name + ": expected a positive number, found " + std::to_string(value));
  };
  positive(dt, "dt");
  positive(rim_cap, "rim_cap");
  positive(feature_cap, "feature_cap");
  require(alpha >= 0 && beta >= 0 && gamma >= 0 && alpha + beta + gamma > 0 && std::isfinite(alpha + beta + gamma),
          "EnergyOptions: alpha, beta and gamma: expected non-negative numbers, not all 0, found " + std::to_string(alpha) +
              ", " + std::to_string(beta) + " and " + std::to_string(gamma));
  require(settle_frames >= 0, "EnergyOptions: settle_frames: expected at least 0, found " + std::to_string(settle_frames));
  require(window >= 0 && window_lead >= 0, "EnergyOptions: window and window_lead: expected at least 0, found " +
                                               std::to_string(window) + " and " + std::to_string(window_lead));
  require(stop_margin >= 0 && std::isfinite(stop_margin),
          "EnergyOptions: stop_margin: expected at least 0, found " + std::to_string(stop_margin));
  require(outline_size >= 16, "EnergyOptions: outline_size: expected at least 16, found " + std::to_string(outline_size));
  require(field_size >= 16, "EnergyOptions: field_size: expected at least 16, found " + std::to_string(field_size));
}

struct MaterialObjective::Impl {
  const CharacterSimulator *simulator;
  EnergyOptions options;
  ParameterSpace space;
  ClothTopology topology;
  std::vector<CoarseCamera> cameras;
  std::vector<PosedFrame> frames;                  // [T], shared by all samples
  std::vector<std::vector<FrameView>> views;       // [T][cameras]
  std::vector<std::vector<CapturedView>> captured; // [T][cameras], features from t-1 to t
  std::vector<Window> windows;
  double farthest = 0; // m, see check_explosion()
  Terms worst;         // what a frame of an exploded sample costs; a term that is 0 does not count, for any sample
  std::string fingerprint;
  mutable std::mutex mutex; // of the times alone
  mutable EnergyTimes times;

  void add(const Stopwatch &watch) const;
  int regions() const { return static_cast<int>(simulator->regions().size()); }
  int frame_count() const { return static_cast<int>(frames.size()); }

  void prepare(double done, const Context &context, const std::function<void(int)> &frame);
  void keep_image(int t, std::size_t c, const Vertices &surface, const ViewObservation &observation, const CoarseCamera &camera);
  void keep_captured(int t, const MeshSequence &surface, const Observations &observations);
  bool starts_window(int t) const;
  FrameTerms worst_terms(int region, int t) const;
  CoarseBuffer draw_others(const PosedFrame &frame, const CoarseCamera &camera, const Box &box) const;
  void put_back(Rollout &rollout, const PosedFrame &frame) const;
  void check_explosion(Rollout &rollout, const PosedFrame &frame) const;
  void step(std::span<Rollout> group, int from, int to, bool settling) const;
  void place(std::span<Rollout> group, int t, ClothView &view) const;
  void locate(int t, std::size_t c, Measure &measure) const;
  void place_missed(const CapturedFeatures &features, LocatedFeatures &located, int lanes) const;
  void measure(std::span<Rollout> group, int t, Measure &measure) const;
  void finish(Rollout &rollout, int t) const;
  void measure_rims(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void measure_contour(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void measure_features(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void find(std::span<Rollout> group, int t, Measure &measure) const;
  void start(Group &group) const;
  void advance(Group &group, int from, int to) const;
  Window make_window(int first, int end, const MeshSequence &surface) const;
  Samples make_samples(const std::vector<std::vector<pbd::Material>> &materials) const;
  void split(std::span<Rollout> rollouts, const Window &window, int from, int to, int threads, std::vector<Group> &groups) const;
  void run_groups(std::span<Group> groups, const Context &context) const;
  MatrixRM final_energies(const Samples &samples, const std::vector<std::uint8_t> &counts) const;
  double mean_energy(const Terms &terms, int region, const std::vector<std::uint8_t> &counts) const;
  Terms surface_terms(const std::vector<Vertices> &surfaces) const;
  void stop_hopeless(Samples &samples, const std::vector<std::uint8_t> &counts) const;
  MatrixRM run(Samples &samples, bool may_stop, const Context &context) const;
};

namespace {

void check_inputs(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                  const Observations &observations) {
  require(!simulator.regions().empty(), "MaterialObjective: simulator: expected a character with cloth, found no region");
  const auto count = static_cast<std::size_t>(performance.dofs.rows());
  const auto expect = [](const std::string &what, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw Error("MaterialObjective: " + what + ": expected " + std::to_string(expected) + ", found " + std::to_string(found));
  };
  if (count == 0 || observations.cameras.empty())
    throw Error("MaterialObjective: expected at least one frame and one camera, found " + std::to_string(count) + " and " +
                std::to_string(observations.cameras.size()));
  expect("frames of the performance's surface", performance.surface.frames.size(), count);
  expect("frames of the observations", observations.views.size(), count);
  expect("degrees of freedom of the performance", static_cast<std::size_t>(performance.dofs.cols()),
         static_cast<std::size_t>(simulator.actor().skeleton.dof_count()));
  for (const Vertices &surface : performance.surface.frames)
    expect("vertices of the performance's surface", static_cast<std::size_t>(surface.rows()),
           static_cast<std::size_t>(simulator.actor().mesh.vertices.rows()));
  if (performance.frames != observations.frames)
    throw Error("MaterialObjective: performance and observations: expected the same video frame numbers, found different ones");
  for (const auto &views : observations.views)
    expect("cameras of an observed frame", views.size(), observations.cameras.size());
  for (const Camera &camera : observations.cameras)
    validate_camera(camera, "MaterialObjective: observations");
  require_performance(performance, simulator.actor(), "MaterialObjective");
}

/// Solvers that are not ours have no name: a frame of each tells them apart.
void hash_solvers(Fingerprint &print, const CharacterSimulator &simulator, const ReferencePerformance &performance, double dt) {
  const auto own = [](const ClothRegion &region) {
    const auto ours = pbd::ClothSolver::create(region.model);
    return typeid(*region.solver) == typeid(*ours);
  };
  if (std::all_of(simulator.regions().begin(), simulator.regions().end(), own))
    return;
  const PosedFrame first = simulator.pose(performance.dofs.row(0)),
                   last = simulator.pose(performance.dofs.row(performance.dofs.rows() - 1));
  CharacterState state = simulator.start(first);
  CharacterState *const states = &state;
  const std::vector<pbd::Material> materials(simulator.regions().size());
  const std::vector<pbd::Material> *const lists = &materials;
  simulator.step_each({&states, 1}, first, last, {&lists, 1}, dt);
  for (const pbd::ClothState &region : state.regions)
    print.add(region.positions).add(region.velocities);
}

std::string hash_problem(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                         const Observations &observations, const EnergyOptions &o, const ParameterSpace &space) {
  Fingerprint print;
  const RiggedMesh &actor = simulator.actor();
  print.add(actor.mesh.vertices).add(actor.mesh.faces).add(actor.weights).add(performance.dofs);
  for (const Vertices &surface : performance.surface.frames)
    print.add(surface);
  for (const ClothRegion &region : simulator.regions()) {
    const pbd::ClothOptions &cloth = region.model->options();
    print.add(region.vertex_from_cloth).add(region.model->inverse_masses()).add(cloth.gravity);
    print.add({static_cast<double>(cloth.iterations), static_cast<double>(cloth.substeps), cloth.restitution, cloth.thickness,
               cloth.self_thickness, cloth.self_collision ? 1.0 : 0.0, cloth.rest_curvature,
               cloth.stiffness == pbd::Stiffness::Compliance ? 1.0 : 0.0});
  }
  hash_solvers(print, simulator, performance, o.dt);
  for (const pbd::Capsule &capsule : simulator.pose(performance.dofs.row(0)).capsules)
    print.add(capsule.p0).add(capsule.p1).add({capsule.r0, capsule.r1});
  for (const Camera &camera : observations.cameras)
    print.add(camera.K).add(camera.distortion).add(camera.R).add(camera.t);
  for (const auto &views : observations.views)
    for (const ViewObservation &view : views) {
      for (const Eigen::Vector2f &point : view.contour)
        print.add(point);
      for (const FeatureMatch &match : view.matches)
        print.add(match.previous).add(match.current);
    }
  print.add({o.dt, o.alpha, o.beta, o.gamma, o.same_comparisons ? 1.0 : 0.0, o.fast_features ? 1.0 : 0.0,
             static_cast<double>(o.settle_frames), o.rim_cap, o.feature_cap, static_cast<double>(o.outline_size),
             static_cast<double>(o.field_size), static_cast<double>(o.window), static_cast<double>(o.window_lead), o.stop_margin,
             space.even_steps ? 1.0 : 0.0});
  for (const std::string &name : space.names)
    print.add(name);
  for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
    print.add({space.fixed.*parameter.value});
  return print.text();
}

} // namespace

/// Everything that is not cloth, drawn once and cut to the box where cloth can be.
CoarseBuffer MaterialObjective::Impl::draw_others(const PosedFrame &frame, const CoarseCamera &camera, const Box &box) const {
  const Faces &faces = simulator->actor().mesh.faces;
  std::vector<std::uint8_t> skip = simulator->actor().skip_invalid();
  for (std::size_t f = 0; f < skip.size(); ++f)
    skip[f] |= topology.face_is_cloth[f];
  const Camera coarse = camera.camera.resized(camera.width, camera.height);
  const FaceBuffer body = rasterize(frame.skinned, faces, coarse, skip);
  const Mesh capsules = capsule_mesh(frame.capsules);
  const FaceBuffer legs = rasterize(capsules.vertices, capsules.faces, coarse);

  CoarseBuffer result;
  result.x0 = std::clamp(static_cast<int>(camera.coarse_x(box.x0)) - 2, 0, camera.width - 1);
  result.y0 = std::clamp(static_cast<int>(camera.coarse_y(box.y0)) - 2, 0, camera.height - 1);
  result.width = std::clamp(static_cast<int>(camera.coarse_x(box.x1)) + 3, 1, camera.width) - result.x0;
  result.height = std::clamp(static_cast<int>(camera.coarse_y(box.y1)) + 3, 1, camera.height) - result.y0;
  result.inverse_depth.reserve(static_cast<std::size_t>(result.width) * result.height);
  for (int y = result.y0; y < result.y0 + result.height; ++y)
    for (int x = result.x0; x < result.x0 + result.width; ++x)
      result.inverse_depth.push_back(1.f / std::min(body.depth_at(x, y), legs.depth_at(x, y))); // 1 / infinity = 0
  return result;
}

void MaterialObjective::Impl::keep_image(int t, std::size_t c, const Vertices &surface, const ViewObservation &observation,
                                         const CoarseCamera &camera) {
  if (observation.contour.empty())
    return;
  const Camera &full = camera.camera;
  Box box;
  for (std::size_t i = 0; i < topology.vertices.size(); ++i)
    for (const Vertices *place : {static_cast<const Vertices *>(&frames[t].skinned), &surface}) {
      const Eigen::Vector3d point = place->row(topology.vertices[i]).transpose();
      if (full.depth(point) > 0.05)
        box.add(full.project(point));
    }
  const float reach = static_cast<float>(options.rim_cap) * larger_side(full);
  box.x0 = std::max(0.f, box.x0 - reach), box.y0 = std::max(0.f, box.y0 - reach);
  box.x1 = std::min(static_cast<float>(full.width - 1), box.x1 + reach);
  box.y1 = std::min(static_cast<float>(full.height - 1), box.y1 + reach);
  if (box.empty())
    return;
  FrameView &view = views[t][c];
  view.contour =
      DistanceField(observation.contour, {box.x0, box.y0, box.x1, box.y1}, field_cell(full, options.field_size), reach);
  view.others = draw_others(frames[t], camera, box);
  view.seen = true;
}

/// Calls frame(t) for every frame, on all threads: one half of the preparation, which begins when `done` of it is over.
void MaterialObjective::Impl::prepare(double done, const Context &context, const std::function<void(int)> &frame) {
  for (int from = 0; from < frame_count(); from += kFramesPerChunk) {
    context.report("fit: images", done + 0.5 * from / static_cast<double>(frame_count()));
    parallel_for(context, std::min(kFramesPerChunk, frame_count() - from), [&](int i) {
      Stopwatch watch;
      frame(from + i);
      watch.lap(&EnergyTimes::set_up);
      add(watch);
    });
  }
}

/// Whether the simulation starts at this frame, so that there is none at the frame before on which features could lie.
bool MaterialObjective::Impl::starts_window(int t) const {
  return std::any_of(windows.begin(), windows.end(),
                     [&](const Window &window) { return window.start == t && window.first == t; });
}

/// What the captured cloth shows at frame t, after the images of this frame and of the one before have been kept.
void MaterialObjective::Impl::keep_captured(int t, const MeshSequence &surface, const Observations &observations) {
  CapturedCloth cloth(*simulator, topology, options);
  const Vertices &now = surface.frames[t];
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const ViewObservation &observed = observations.views[t][c];
    CapturedView &view = captured[t][c];
    view.rims.assign(regions(), 0);
    view.contour.first.assign(regions() + 1, 0);
    if (!starts_window(t))
      view.features = cloth.features(cameras[c], surface.frames[t - 1], views[t - 1][c].others, now, observed.matches);
    if (views[t][c].seen)
      view.rims = cloth.rims(cameras[c], now, views[t][c].others);
    if (views[t][c].seen && options.gamma > 0)
      view.contour = cloth.contour(cameras[c], now, views[t][c].others, observed.contour);
  }
}

/// What a region costs at most in a frame: a term is 0 where the captured cloth has nothing to compare a sample with.
FrameTerms MaterialObjective::Impl::worst_terms(int region, int t) const {
  double side = 0;
  for (const CoarseCamera &camera : cameras)
    side = std::max(side, static_cast<double>(larger_side(camera.camera)));
  FrameTerms result;
  for (const CapturedView &view : captured[t]) {
    result.rims += view.rims[region];
    result.points += view.contour.first[region + 1] - view.contour.first[region];
    for (int i = 0; i < view.features.count(); ++i)
      if (view.features.face[i] >= 0 && topology.face_region[view.features.face[i]] == region) {
        result.feature += view.features.largest[i];
        ++result.features;
      }
  }
  const double farthest_rim = std::pow(options.rim_cap * side, 2);
  result.feature = result.features > 0 ? result.feature / result.features : 0;
  result.silhouette = result.rims > 0 ? farthest_rim : 0;
  result.contour = result.points > 0 ? farthest_rim : 0;
  if (!options.same_comparisons) { // every frame counts
    result.silhouette = farthest_rim;
    result.feature = std::max(result.feature, std::pow(options.feature_cap * side, 2));
  }
  return result;
}

/// A region that has exploded is put back on the skinned surface, so that it cannot spoil the views of the others, and goes on
/// with the default material, so that it does not explode again.
void MaterialObjective::Impl::put_back(Rollout &rollout, const PosedFrame &frame) const {
  for (int r = 0; r < regions(); ++r) {
    if (!rollout.exploded[r])
      continue;
    const std::vector<int> &vertices = simulator->regions()[r].vertex_from_cloth;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      rollout.state.regions[r].positions.row(static_cast<Eigen::Index>(i)) = frame.skinned.row(vertices[i]);
    rollout.state.regions[r].velocities.setZero();
    rollout.materials[r] = {};
  }
}

void MaterialObjective::Impl::check_explosion(Rollout &rollout, const PosedFrame &frame) const {
  for (int r = 0; r < regions(); ++r) {
    const std::vector<int> &vertices = simulator->regions()[r].vertex_from_cloth;
    const Vertices &positions = rollout.state.regions[r].positions;
    for (std::size_t i = 0; i < vertices.size() && !rollout.exploded[r]; ++i) {
      const double distance = (positions.row(static_cast<Eigen::Index>(i)) - frame.skinned.row(vertices[i])).norm();
      rollout.exploded[r] = !(distance <= farthest); // NaN is not
    }
  }
  put_back(rollout, frame);
}

/// From frame `from` to frame `to`. Cloth that stops being finite stays where it was, and has exploded; while it is still
/// settling the sample's other regions, too, never came to rest.
void MaterialObjective::Impl::step(std::span<Rollout> group, int from, int to, bool settling) const {
  std::vector<CharacterState *> states;
  std::vector<const std::vector<pbd::Material> *> materials;
  for (Rollout &rollout : group) {
    states.push_back(&rollout.state);
    materials.push_back(&rollout.materials);
  }
  for (const auto &[sample, region] : simulator->step_each(states, frames[from], frames[to], materials, options.dt))
    if (settling)
      group[sample].exploded.assign(regions(), 1);
    else
      group[sample].exploded[region] = 1;
}

void MaterialObjective::Impl::add(const Stopwatch &watch) const {
  const std::lock_guard lock(mutex);
  for (double EnergyTimes::*part : {&EnergyTimes::set_up, &EnergyTimes::simulate, &EnergyTimes::project, &EnergyTimes::rims,
                                    &EnergyTimes::contour, &EnergyTimes::features})
    times.*part += watch.times().*part;
}

/// The cloth of all samples into the lanes of the view.
void MaterialObjective::Impl::place(std::span<Rollout> group, int t, ClothView &view) const {
  float *to = view.positions().data();
  const int lanes = view.lanes(), count = static_cast<int>(group.size());
  for (int v = 0; v < topology.vertex_count(); ++v, to += 3 * lanes)
    for (int l = 0; l < lanes; ++l) {
      const int r = topology.region[v];
      const double *from = r < 0 ? &frames[t].skinned(topology.vertices[v], 0)
                                 : &group[std::min(l, count - 1)].state.regions[r].positions(topology.row[v], 0);
      for (int k = 0; k < 3; ++k)
        to[k * lanes + l] = static_cast<float>(from[k]);
    }
}

/// Eq. (6).
void MaterialObjective::Impl::measure_rims(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const {
  measure.view.outline(views[t][c].others, measure.rims);
  for (const Rim &rim : measure.rims) {
    const double distance = views[t][c].contour.distance(rim.x, rim.y);
    FrameTerms &terms = (*group[rim.lane].terms)[topology.region[rim.vertex]][t];
    terms.silhouette += distance * distance;
    ++terms.rims;
  }
}

/// The other direction: from the measured contour of the captured cloth to the outline of the sample's.
void MaterialObjective::Impl::measure_contour(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const {
  const CapturedContour &contour = captured[t][c].contour;
  const float farthest_rim = static_cast<float>(options.rim_cap) * larger_side(cameras[c].camera);
  for (int r = 0; r < regions(); ++r) {
    const int first = contour.first[r], count = contour.first[r + 1] - first;
    measure.view.approach(r, count, contour.x.data() + first, contour.y.data() + first, farthest_rim * farthest_rim,
                          measure.squared);
    const float *squared = measure.squared.data();
    for (Rollout &rollout : group) {
      FrameTerms &terms = (*rollout.terms)[r][t];
      for (int i = 0; i < count; ++i)
        terms.contour += *squared++;
      terms.points += count;
    }
  }
}

/// Eq. (7).
void MaterialObjective::Impl::measure_features(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const {
  const LocatedFeatures &located = measure.located[c];
  const std::vector<float> &squared = measure.view.carry(located, measure.largest[c]);
  for (int i = 0; i < located.count; ++i)
    for (std::size_t s = 0; s < group.size(); ++s) {
      const std::size_t at = static_cast<std::size_t>(i) * measure.view.lanes() + s;
      if (located.face[at] < 0)
        continue;
      FrameTerms &terms = (*group[s].terms)[topology.face_region[located.face[at]]][t];
      terms.feature += squared[at];
      ++terms.features;
    }
}

/// A sample that does not show a feature of the captured cloth, or shows another region there, has the same point of the cloth
/// elsewhere: that is where the feature is taken to lie.
void MaterialObjective::Impl::place_missed(const CapturedFeatures &features, LocatedFeatures &located, int lanes) const {
  for (int i = 0; i < located.count; ++i) {
    const int match = located.match[i], own = features.face[match];
    for (int l = 0; l < lanes; ++l) {
      int &face = located.face[static_cast<std::size_t>(i) * lanes + l];
      if (face >= 0 && topology.face_region[face] == topology.face_region[own])
        continue;
      face = own;
      for (int k = 0; k < 3; ++k)
        located.weight[(static_cast<std::size_t>(i) * 3 + k) * lanes + l] = features.weight[3 * match + k];
    }
  }
}

/// Where the features lie that are matched from this frame to the next.
void MaterialObjective::Impl::locate(int t, std::size_t c, Measure &measure) const {
  LocatedFeatures &located = measure.located[c];
  located.count = 0;
  if (t + 1 >= frame_count() || captured[t + 1][c].features.matches.empty())
    return;
  const CapturedFeatures &features = captured[t + 1][c].features;
  measure.view.locate(features.matches, views[t][c].others, located);
  measure.largest[c].clear();
  for (const int match : located.match)
    measure.largest[c].push_back(features.largest[match]);
  if (options.same_comparisons)
    place_missed(features, located, measure.view.lanes());
}

/// The features alone, of a frame that does not count.
void MaterialObjective::Impl::find(std::span<Rollout> group, int t, Measure &measure) const {
  place(group, t, measure.view);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    measure.view.look(cameras[c]);
    locate(t, c, measure);
  }
  measure.watch.lap(&EnergyTimes::features);
}

void MaterialObjective::Impl::measure(std::span<Rollout> group, int t, Measure &measure) const {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    measure.view.look(cameras[c]);
    measure.watch.lap(&EnergyTimes::project);
    measure_features(group, t, c, measure);
    locate(t, c, measure);
    measure.watch.lap(&EnergyTimes::features);
    if (!views[t][c].seen)
      continue;
    measure_rims(group, t, c, measure);
    measure.watch.lap(&EnergyTimes::rims);
    if (captured[t][c].contour.count() > 0)
      measure_contour(group, t, c, measure);
    measure.watch.lap(&EnergyTimes::contour);
  }
  for (Rollout &rollout : group)
    finish(rollout, t);
}

/// From sums to means.
void MaterialObjective::Impl::finish(Rollout &rollout, int t) const {
  for (int r = 0; r < regions(); ++r) {
    FrameTerms &terms = (*rollout.terms)[r][t];
    const double no_rims = options.same_comparisons ? worst[r][t].silhouette : 0;
    terms.silhouette = terms.rims > 0 ? terms.silhouette / terms.rims : no_rims;
    terms.feature = terms.features > 0 ? terms.feature / terms.features : 0;
    terms.contour = terms.points > 0 ? terms.contour / terms.points : 0;
    if (rollout.exploded[r])
      terms = worst[r][t];
  }
}

/// Frames [first, end) from the captured surface some frames before, at the speed that it has there; from rest at the first frame
/// of the motion.
Window MaterialObjective::Impl::make_window(int first, int end, const MeshSequence &surface) const {
  Window window{std::max(0, first - (first > 0 ? options.window_lead : 0)), first, end, {}};
  const int t = window.start;
  window.state = simulator->start(frames[t], t == 0 && simulator->has_rest_shape() ? nullptr : &surface.frames[t]);
  if (t == 0)
    return window;
  const int after = std::min(t + 1, frame_count() - 1);
  const Vertices velocities = (surface.frames[after] - surface.frames[t - 1]) / ((after - t + 1) * options.dt);
  for (int r = 0; r < regions(); ++r) {
    const std::vector<int> &vertices = simulator->regions()[r].vertex_from_cloth;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      window.state.regions[r].velocities.row(static_cast<Eigen::Index>(i)) = velocities.row(vertices[i]);
  }
  return window;
}

void MaterialObjective::Impl::start(Group &group) const {
  Stopwatch watch;
  for (Rollout &rollout : group.rollouts) {
    rollout.state = group.window->state;
    rollout.exploded.assign(regions(), 0);
  }
  if (group.window->start == 0) {
    for (int i = 0; i < options.settle_frames; ++i)
      step(group.rollouts, 0, 0, true);
    for (Rollout &rollout : group.rollouts)
      for (pbd::ClothState &region : rollout.state.regions)
        region.velocities.setZero();
  }
  watch.lap(&EnergyTimes::simulate);
  add(watch);
}

/// Simulates frames [from, to) of the window, and measures those that count.
void MaterialObjective::Impl::advance(Group &group, int from, int to) const {
  if (from >= to)
    return;
  const std::span<Rollout> rollouts = group.rollouts;
  Measure tools(topology, rollouts.size(), cameras.size());
  if (from > group.window->start && from >= group.window->first)
    find(rollouts, from - 1, tools);
  for (int t = from; t < to; ++t) {
    if (t > group.window->start)
      step(rollouts, t - 1, t, false);
    for (Rollout &rollout : rollouts)
      check_explosion(rollout, frames[t]);
    tools.watch.lap(&EnergyTimes::simulate);
    if (t >= group.window->first) {
      place(rollouts, t, tools.view);
      measure(rollouts, t, tools);
    } else if (t + 1 == group.window->first)
      find(rollouts, t, tools);
  }
  add(tools.watch);
}

/// The samples that are still running, in as few groups as fill the registers, but not fewer than threads.
void MaterialObjective::Impl::split(std::span<Rollout> rollouts, const Window &window, int from, int to, int threads,
                                    std::vector<Group> &groups) const {
  const int count = static_cast<int>(rollouts.size());
  int parts = (count + kLargestGroup - 1) / kLargestGroup;
  if (windows.size() == 1) // several keep the threads busy by themselves
    parts = std::max(parts, std::min(threads, (count + kSmallestGroup - 1) / kSmallestGroup));
  for (int g = 0; g < parts; ++g) {
    const int first = count * g / parts, last = count * (g + 1) / parts;
    groups.push_back({&window, rollouts.subspan(first, last - first), from, to});
  }
}

/// Eq. (8), over the frames that count so far: each term over those of them in which there is something to compare.
double MaterialObjective::Impl::mean_energy(const Terms &terms, int region, const std::vector<std::uint8_t> &counts) const {
  const auto mean = [&](double FrameTerms::*term) {
    double sum = 0;
    int count = 0;
    for (int t = 0; t < frame_count(); ++t)
      if (counts[t] && worst[region][t].*term > 0) {
        sum += terms[region][t].*term;
        ++count;
      }
    return sum / std::max(1, count);
  };
  return options.alpha * mean(&FrameTerms::silhouette) + options.beta * mean(&FrameTerms::feature) +
         options.gamma * mean(&FrameTerms::contour);
}

/// Surfaces in the place of a simulation: one sample that never explodes.
Terms MaterialObjective::Impl::surface_terms(const std::vector<Vertices> &surfaces) const {
  require(surfaces.size() == frames.size(), "MaterialObjective: surfaces: expected " + std::to_string(frames.size()) +
                                                " frames, found " + std::to_string(surfaces.size()));
  const Eigen::Index vertices = simulator->actor().mesh.vertices.rows();
  for (const Vertices &surface : surfaces)
    require(surface.rows() == vertices && surface.allFinite(),
            "MaterialObjective: surfaces: expected (" + std::to_string(vertices) + ", 3) finite numbers, found (" +
                std::to_string(surface.rows()) + ", 3)" + (surface.allFinite() ? "" : " with NaN or infinity"));
  Terms terms(regions(), std::vector<FrameTerms>(frames.size()));
  std::vector<Rollout> one(1);
  one[0].exploded.assign(regions(), 0);
  one[0].terms = &terms;
  Measure tools(topology, 1, cameras.size());
  for (int t = 0; t < frame_count(); ++t) {
    place_surface(topology, surfaces[t], tools.view);
    measure(one, t, tools);
  }
  return terms;
}

Samples MaterialObjective::Impl::make_samples(const std::vector<std::vector<pbd::Material>> &materials) const {
  for (const auto &sample : materials) {
    require(static_cast<int>(sample.size()) == regions(), "MaterialObjective: materials: expected " + std::to_string(regions()) +
                                                              ", one a region, found " + std::to_string(sample.size()));
    for (const pbd::Material &material : sample)
      pbd::validate(material);
  }
  Samples samples;
  samples.materials = materials;
  samples.terms.assign(materials.size(), Terms(regions(), std::vector<FrameTerms>(frames.size())));
  samples.stopped.assign(materials.size(), 0);
  samples.ratio.resize(static_cast<Eigen::Index>(materials.size()), regions());
  return samples;
}

void MaterialObjective::Impl::stop_hopeless(Samples &samples, const std::vector<std::uint8_t> &counts) const {
  const std::size_t count = samples.stopped.size();
  std::vector<std::uint8_t> hopeless = samples.stopped;
  for (std::uint8_t &h : hopeless)
    h = !h;
  for (int r = 0; r < regions(); ++r) {
    std::vector<double> running;
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s])
        running.push_back(mean_energy(samples.terms[s], r, counts));
    const double reference = middle(running, count);
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s]) {
        const double energy = mean_energy(samples.terms[s], r, counts);
        samples.ratio(static_cast<Eigen::Index>(s), r) = energy / reference;
        hopeless[s] &= energy > (1 + options.stop_margin) * reference;
      }
  }
  for (std::size_t s = 0; s < count; ++s)
    samples.stopped[s] |= hopeless[s];
}

/// Runs groups of one stage, all threads on a few of them at a time.
void MaterialObjective::Impl::run_groups(std::span<Group> groups, const Context &context) const {
  const std::size_t batch = windows.size() == 1 ? groups.size() : 2 * static_cast<std::size_t>(context.thread_count());
  for (std::size_t i = 0; i < groups.size(); i += batch) {
    const auto some = groups.subspan(i, std::min(batch, groups.size() - i));
    int longest = 0;
    for (const Group &group : some)
      longest = std::max(longest, group.to - group.from);
    for (int done = 0; done < longest; done += kFramesPerChunk) {
      context.check_cancelled();
      parallel_for(context, static_cast<int>(some.size()), [&](int g) {
        Group &group = some[g];
        if (done == 0 && group.from == group.window->start)
          start(group);
        advance(group, std::min(group.from + done, group.to), std::min(group.from + done + kFramesPerChunk, group.to));
      });
    }
  }
}

/// E_fit (S, R).
MatrixRM MaterialObjective::Impl::run(Samples &samples, bool may_stop, const Context &context) const {
  const int stages = may_stop && options.stop_margin > 0 ? kStages : 1, count = static_cast<int>(samples.stopped.size());
  const bool whole = static_cast<int>(windows.size()) >= stages; // windows are run one stage each; else each over all stages
  std::vector<std::uint8_t> counts(frames.size(), 0);            // frames measured so far
  std::vector<std::vector<Rollout>> rollouts(windows.size());
  for (int stage = 0; stage < stages; ++stage) {
    std::vector<Group> groups;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      const Window &window = windows[w];
      const int length = window.end - window.start;
      int from = window.start, to = window.end;
      if (!whole)
        from = window.start + length * stage / stages, to = window.start + length * (stage + 1) / stages;
      else if (static_cast<int>(w) % stages != stage)
        continue;
      if (from == window.start && rollouts[w].empty())
        for (int s = 0; s < count; ++s)
          rollouts[w].push_back({s, samples.materials[s], {}, {}, &samples.terms[s]});
      std::erase_if(rollouts[w], [&](const Rollout &rollout) { return samples.stopped[rollout.sample]; });
      split(rollouts[w], window, from, to, context.thread_count(), groups);
      for (int t = std::max(from, window.first); t < to; ++t)
        counts[t] = 1;
    }
    run_groups(groups, context);
    if (whole)
      rollouts.assign(windows.size(), {});
    if (stage + 1 < stages)
      stop_hopeless(samples, counts);
  }
  return final_energies(samples, counts);
}

MatrixRM MaterialObjective::Impl::final_energies(const Samples &samples, const std::vector<std::uint8_t> &counts) const {
  const std::size_t count = samples.stopped.size();
  MatrixRM result(static_cast<Eigen::Index>(count), regions());
  for (int r = 0; r < regions(); ++r) {
    std::vector<double> finished;
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s])
        finished.push_back(result(static_cast<Eigen::Index>(s), r) = mean_energy(samples.terms[s], r, counts));
    for (std::size_t s = 0; s < count; ++s)
      if (samples.stopped[s])
        result(static_cast<Eigen::Index>(s), r) = samples.ratio(static_cast<Eigen::Index>(s), r) * middle(finished, count);
  }
  return result;
}

MaterialObjective::MaterialObjective(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                     const Observations &observations, const EnergyOptions &options, const ParameterSpace &space,
                                     const Context &context) {
  options.validate();
  space.validate();
  check_inputs(simulator, performance, observations);
  auto impl = std::make_unique<Impl>();
  impl->simulator = &simulator;
  impl->options = options;
  impl->space = space;
  impl->topology = cloth_topology(simulator);
  const Vertices &rest = simulator.actor().mesh.vertices;
  impl->farthest = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  for (const Camera &camera : observations.cameras)
    impl->cameras.emplace_back(camera, options.outline_size);
  impl->fingerprint = hash_problem(simulator, performance, observations, options, space);

  const int count = static_cast<int>(performance.dofs.rows());
  impl->frames.resize(count);
  impl->views.assign(count, std::vector<FrameView>(observations.cameras.size()));
  impl->captured.assign(count, std::vector<CapturedView>(observations.cameras.size()));
  impl->prepare(0, context, [&](int t) {
    impl->frames[t] = simulator.pose(performance.dofs.row(t).transpose());
    for (std::size_t c = 0; c < impl->cameras.size(); ++c)
      impl->keep_image(t, c, performance.surface.frames[t], observations.views[t][c], impl->cameras[c]);
  });
  const int windows = options.window > 0 ? std::max(1, count / options.window) : 1;
  for (int w = 0; w < windows; ++w)
    impl->windows.push_back(impl->make_window(count * w / windows, count * (w + 1) / windows, performance.surface));
  impl->prepare(0.5, context, [&](int t) { impl->keep_captured(t, performance.surface, observations); });
  for (int r = 0; r < impl->regions(); ++r) {
    impl->worst.emplace_back();
    for (int t = 0; t < count; ++t)
      impl->worst[r].push_back(impl->worst_terms(r, t));
  }
  impl_ = std::move(impl);
}

MaterialObjective::~MaterialObjective() = default;

int MaterialObjective::parameter_count() const {
  return impl_->space.size();
}
int MaterialObjective::part_count() const {
  return impl_->regions();
}
double MaterialObjective::worst_energy() const {
  double worst = 0;
  for (int r = 0; r < impl_->regions(); ++r)
    worst = std::max(worst, impl_->mean_energy(impl_->worst, r, std::vector<std::uint8_t>(impl_->frames.size(), 1)));
  return worst;
}
EnergyTimes MaterialObjective::times() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->times;
}
std::string MaterialObjective::fingerprint() const {
  return impl_->fingerprint;
}
const ParameterSpace &MaterialObjective::space() const {
  return impl_->space;
}

std::size_t MaterialObjective::image_bytes() const {
  std::size_t bytes = 0;
  for (std::size_t t = 0; t < impl_->views.size(); ++t)
    for (std::size_t c = 0; c < impl_->cameras.size(); ++c) {
      const FrameView &view = impl_->views[t][c];
      const CapturedView &captured = impl_->captured[t][c];
      bytes += view.contour.bytes() + view.others.inverse_depth.size() * sizeof(float) + captured.features.bytes() +
               captured.contour.bytes();
    }
  return bytes;
}

MatrixRM MaterialObjective::energies(const std::vector<std::vector<pbd::Material>> &materials, const Context &context) const {
  Samples samples = impl_->make_samples(materials);
  return impl_->run(samples, false, context);
}

MatrixRM MaterialObjective::evaluate(const MatrixRM &samples, const Context &context) {
  const int n = parameter_count(), regions = part_count();
  require(samples.cols() == static_cast<Eigen::Index>(n) * regions, "MaterialObjective: samples: expected " +
                                                                        std::to_string(n * regions) + " columns, found " +
                                                                        std::to_string(samples.cols()));
  require(samples.allFinite(), "MaterialObjective: samples: expected finite numbers, found NaN or infinity");
  std::vector<std::vector<pbd::Material>> materials(static_cast<std::size_t>(samples.rows()));
  for (Eigen::Index s = 0; s < samples.rows(); ++s)
    for (int r = 0; r < regions; ++r)
      materials[s].push_back(impl_->space.material(samples.row(s).segment(r * n, n).transpose()));
  Samples generation = impl_->make_samples(materials);
  return impl_->run(generation, true, context);
}

std::vector<std::vector<FrameTerms>> MaterialObjective::terms(const std::vector<pbd::Material> &materials) const {
  Context one;
  one.threads = 1;
  Samples samples = impl_->make_samples({materials});
  impl_->run(samples, false, one);
  return samples.terms[0];
}

std::vector<std::vector<FrameTerms>> MaterialObjective::surface_terms(const std::vector<Vertices> &surfaces) const {
  return impl_->surface_terms(surfaces);
}

std::vector<double> MaterialObjective::surface_energy(const std::vector<Vertices> &surfaces) const {
  const Terms terms = impl_->surface_terms(surfaces);
  std::vector<double> result;
  for (int r = 0; r < impl_->regions(); ++r)
    result.push_back(impl_->mean_energy(terms, r, std::vector<std::uint8_t>(impl_->frames.size(), 1)));
  return result;
}

} // namespace doublet
