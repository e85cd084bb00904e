#include "doublet/fit/material_objective.h"

#include "batch.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"
#include "doublet/options/options.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>

namespace doublet {

using namespace fit;

void EnergyOptions::validate() const {
  options::check(*this);
  require(alpha + beta + gamma + delta > 0,
          "EnergyOptions: alpha, beta, gamma and delta: expected a weight above 0, found 0 for all");
}

struct MaterialObjective::Impl {
  Impl(const std::vector<const CharacterSimulator *> &widths, const ReferencePerformance &performance,
       const Observations &observations, double dt, const EnergyOptions &options, const ParameterSpace &parameters,
       const Context &context)
      : simulators(copies_of(widths)), space(parameters),
        windows(cut_windows(static_cast<int>(performance.dofs.rows()), options)),
        observed(addresses_of(simulators), performance, observations, dt, options, simulated_from(windows), times, context),
        energy(observed), rollouts(observed, energy, times) {
    for (Window &window : windows)
      window.states = rollouts.states_at(window.start, performance.surface);
  }
  Impl(const Impl &) = delete;

  static std::vector<CharacterSimulator> copies_of(const std::vector<const CharacterSimulator *> &widths) {
    std::vector<CharacterSimulator> copies;
    for (const CharacterSimulator *width : widths)
      copies.push_back(*width);
    return copies;
  }
  static std::vector<const CharacterSimulator *> addresses_of(const std::vector<CharacterSimulator> &widths) {
    std::vector<const CharacterSimulator *> addresses;
    for (const CharacterSimulator &width : widths)
      addresses.push_back(&width);
    return addresses;
  }
  /// The frames that count and before which nothing is simulated.
  static std::vector<int> simulated_from(const std::vector<Window> &windows) {
    std::vector<int> starts;
    for (const Window &window : windows)
      if (window.start == window.first)
        starts.push_back(window.start);
    return starts;
  }
  Batch batch() const { return {observed, energy, rollouts, windows}; }

  std::vector<CharacterSimulator> simulators; ///< one a width
  ParameterSpace space;
  std::vector<Window> windows;
  mutable CpuTimes times;
  ObservedFrames observed;
  FrameEnergy energy;
  Rollouts rollouts;
  std::string fingerprint;
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

void check_widths(const std::vector<const CharacterSimulator *> &widths) {
  require(!widths.empty() && std::count(widths.begin(), widths.end(), nullptr) == 0,
          "MaterialObjective: widths: expected at least one simulator, found none");
  const std::vector<ClothRegion> &first = widths.front()->regions();
  for (const CharacterSimulator *other : widths) {
    bool same = other->regions().size() == first.size() &&
                other->actor().mesh.vertices.rows() == widths.front()->actor().mesh.vertices.rows();
    for (std::size_t r = 0; same && r < first.size(); ++r)
      same = other->regions()[r].vertex_from_cloth == first[r].vertex_from_cloth;
    require(same, "MaterialObjective: widths: expected simulators of one mesh and the same cloth, found others");
  }
}

/// One frame of all cloth, from rest in the first pose to the last: what its model was made of (rest shape, blend
/// weights), and whose solver it is, shows in nothing else.
std::vector<pbd::ClothState> one_step(const CharacterSimulator &simulator, const PosedFrame &first, const PosedFrame &last,
                                      const pbd::Material &material, double dt) {
  CharacterState state = simulator.start(first);
  CharacterState *const states[] = {&state};
  const std::vector<pbd::Material> materials(simulator.regions().size(), material);
  const std::vector<pbd::Material> *const lists[] = {&materials};
  simulator.step_batch(states, first, last, lists, dt);
  return state.regions;
}

/// Poses stand for the actor, its skeleton and its proxies.
std::string hash_problem(const std::vector<const CharacterSimulator *> &widths, const std::vector<PosedFrame> &poses,
                         const MeshSequence &captured, const Observations &observations, double dt, const EnergyOptions &options,
                         const ParameterSpace &space) {
  Fingerprint print;
  const CharacterSimulator &simulator = *widths.front();
  const RiggedMesh &actor = simulator.actor();
  print.add(actor.mesh.faces).add(actor.face_valid).add(actor.weights).add(simulator.options()).add(std::vector<double>{dt});
  print.add(options).add(space);
  for (const PosedFrame &pose : poses) {
    print.add(pose.skinned);
    for (const Capsule &capsule : pose.capsules)
      print.add(capsule.p0).add(capsule.p1).add(Eigen::Vector2d(capsule.r0, capsule.r1));
  }
  for (const Vertices &surface : captured.frames)
    print.add(surface);
  for (const ClothRegion &region : simulator.regions())
    print.add(region.vertex_from_cloth);
  for (const CharacterSimulator *width : widths)
    for (const pbd::ClothState &state : one_step(*width, poses.front(), poses.back(), space.fixed, dt))
      print.add(state.positions).add(state.velocities);
  for (const Camera &camera : observations.cameras)
    print.add(camera.K).add(camera.distortion).add(camera.R).add(camera.t).add(Eigen::Vector2i(camera.width, camera.height));
  for (const auto &views : observations.views)
    for (const ViewObservation &view : views) {
      print.add(view.contour);
      for (const FeatureMatch &match : view.matches)
        print.add(match.previous).add(match.current);
    }
  return print.text();
}

} // namespace

MaterialObjective::MaterialObjective(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                     const Observations &observations, double dt, const EnergyOptions &options,
                                     const ParameterSpace &space, const Context &context)
    : MaterialObjective(std::vector<const CharacterSimulator *>{&simulator}, performance, observations, dt, options, space,
                        context) {}

MaterialObjective::MaterialObjective(const std::vector<const CharacterSimulator *> &widths,
                                     const ReferencePerformance &performance, const Observations &observations, double dt,
                                     const EnergyOptions &options, const ParameterSpace &space, const Context &context) {
  require(dt > 0 && std::isfinite(dt), "MaterialObjective: dt: expected a positive number, found " + options::to_text(dt));
  options.validate();
  space.validate();
  check_widths(widths);
  check_inputs(*widths.front(), performance, observations);
  auto impl = std::make_unique<Impl>(widths, performance, observations, dt, options, space, context);
  impl->fingerprint = hash_problem(widths, impl->observed.frames, performance.surface, observations, dt, options, space);
  impl_ = std::move(impl);
}

MaterialObjective::~MaterialObjective() = default;

int MaterialObjective::parameter_count() const {
  return impl_->space.size() + (width_count() > 1 ? 1 : 0);
}
int MaterialObjective::width_count() const {
  return static_cast<int>(impl_->observed.widths.size());
}
int MaterialObjective::part_count() const {
  return impl_->observed.regions();
}
double MaterialObjective::worst_energy() const {
  const std::vector<double> worst = impl_->energy.mean(impl_->observed.worst);
  return *std::max_element(worst.begin(), worst.end());
}
EnergyTimes MaterialObjective::times() const {
  return impl_->times.times();
}
std::string MaterialObjective::fingerprint() const {
  return impl_->fingerprint;
}
const ParameterSpace &MaterialObjective::space() const {
  return impl_->space;
}
std::size_t MaterialObjective::image_bytes() const {
  return impl_->observed.image_bytes();
}

int width_index(double unit, int widths) {
  return static_cast<int>(std::lround(std::clamp(unit, 0.0, 1.0) * (widths - 1)));
}

MatrixRM MaterialObjective::energies(const std::vector<std::vector<pbd::Material>> &materials, const Context &context) const {
  Samples samples{materials, {}, {}};
  return impl_->batch().run(samples, context);
}

MatrixRM MaterialObjective::evaluate(const MatrixRM &samples, const Context &context) {
  const int n = parameter_count(), regions = part_count(), of_material = impl_->space.size(), widths = width_count();
  require(samples.cols() == static_cast<Eigen::Index>(n) * regions, "MaterialObjective: samples: expected " +
                                                                        std::to_string(n * regions) + " columns, found " +
                                                                        std::to_string(samples.cols()));
  require(samples.allFinite(), "MaterialObjective: samples: expected finite numbers, found NaN or infinity");
  if (samples.rows() == 0)
    return MatrixRM(0, regions);
  Samples generation;
  generation.materials.resize(static_cast<std::size_t>(samples.rows()));
  generation.widths.resize(generation.materials.size());
  for (Eigen::Index s = 0; s < samples.rows(); ++s)
    for (int r = 0; r < regions; ++r) {
      const Eigen::VectorXd unit = samples.row(s).segment(r * n, n).transpose();
      generation.materials[s].push_back(impl_->space.material(unit.head(of_material)));
      generation.widths[s].push_back(n > of_material ? width_index(unit[of_material], widths) : 0);
    }
  return impl_->batch().run(generation, context);
}

std::vector<std::vector<FrameTerms>> MaterialObjective::terms(const std::vector<pbd::Material> &materials) const {
  Context one;
  one.threads = 1;
  Samples samples{{materials}, {}, {}};
  impl_->batch().run(samples, one);
  return samples.terms[0];
}

std::vector<std::vector<FrameTerms>> MaterialObjective::surface_terms(const std::vector<Vertices> &surfaces) const {
  return impl_->energy.surface_terms(surfaces);
}

std::vector<double> MaterialObjective::surface_energy(const std::vector<Vertices> &surfaces) const {
  return impl_->energy.mean(impl_->energy.surface_terms(surfaces));
}

} // namespace doublet
