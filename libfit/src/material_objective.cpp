#include "doublet/fit/material_objective.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"
#include "doublet/options/options.h"
#include "optimizer_checks.h"
#include "race.h"

#include <algorithm>
#include <cmath>

namespace doublet {

using namespace fit;

void EnergyOptions::validate() const {
  options::check(*this);
  require(alpha + beta + gamma > 0, "EnergyOptions: alpha, beta and gamma: expected a weight above 0, found 0 for all");
}

struct MaterialObjective::Impl {
  Impl(const CharacterSimulator &simulator, const ReferencePerformance &performance, const Observations &observations,
       const EnergyOptions &options, const ParameterSpace &parameters, const Context &context)
      : space(parameters), windows(cut_windows(static_cast<int>(performance.dofs.rows()), options)),
        observed(simulator, performance, observations, options, simulated_from(windows), times, context), energy(observed),
        rollouts(observed, energy, times) {
    for (Window &window : windows)
      window.state = rollouts.state_at(window.start, performance.surface);
  }
  Impl(const Impl &) = delete;

  /// The frames that count and before which nothing is simulated.
  static std::vector<int> simulated_from(const std::vector<Window> &windows) {
    std::vector<int> starts;
    for (const Window &window : windows)
      if (window.start == window.first)
        starts.push_back(window.start);
    return starts;
  }
  Race race(double margin) const { return {observed, energy, rollouts, windows, margin}; }

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

/// One frame of all cloth, from rest in the first pose to the last: what its model was made of (rest shape, fullness, blend
/// weights), and whose solver it is, shows in nothing else.
std::vector<pbd::ClothState> one_step(const CharacterSimulator &simulator, const PosedFrame &first, const PosedFrame &last,
                                      const pbd::Material &material, double dt) {
  CharacterState state = simulator.start(first);
  CharacterState *const states[] = {&state};
  const std::vector<pbd::Material> materials(simulator.regions().size(), material);
  const std::vector<pbd::Material> *const lists[] = {&materials};
  simulator.step_each(states, first, last, lists, dt);
  return state.regions;
}

/// Poses stand for the actor, its skeleton and its proxies.
std::string hash_problem(const CharacterSimulator &simulator, const std::vector<PosedFrame> &poses, const MeshSequence &captured,
                         const Observations &observations, const EnergyOptions &options, const ParameterSpace &space) {
  Fingerprint print;
  const RiggedMesh &actor = simulator.actor();
  print.add(actor.mesh.faces).add(actor.face_valid).add(actor.weights).add(simulator.options()).add(options).add(space);
  for (const PosedFrame &pose : poses) {
    print.add(pose.skinned);
    for (const pbd::Capsule &capsule : pose.capsules)
      print.add(capsule.p0).add(capsule.p1).add(Eigen::Vector2d(capsule.r0, capsule.r1));
  }
  for (const Vertices &surface : captured.frames)
    print.add(surface);
  for (const ClothRegion &region : simulator.regions())
    print.add(region.vertex_from_cloth);
  for (const pbd::ClothState &state : one_step(simulator, poses.front(), poses.back(), space.fixed, options.dt))
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
                                     const Observations &observations, const EnergyOptions &options, const ParameterSpace &space,
                                     const Context &context) {
  options.validate();
  space.validate();
  check_inputs(simulator, performance, observations);
  auto impl = std::make_unique<Impl>(simulator, performance, observations, options, space, context);
  impl->fingerprint = hash_problem(simulator, impl->observed.frames, performance.surface, observations, options, space);
  impl_ = std::move(impl);
}

MaterialObjective::~MaterialObjective() = default;

int MaterialObjective::parameter_count() const {
  return impl_->space.size();
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

MatrixRM MaterialObjective::energies(const std::vector<std::vector<pbd::Material>> &materials, const Context &context) const {
  const Race all = impl_->race(0);
  Samples samples = all.make_samples(materials);
  return all.run(samples, context);
}

MatrixRM MaterialObjective::evaluate(const MatrixRM &samples, const Context &context) {
  return race(samples, 0, context);
}

MatrixRM MaterialObjective::race(const MatrixRM &samples, double margin, const Context &context) const {
  const int n = parameter_count(), regions = part_count();
  require(margin >= 0 && std::isfinite(margin),
          "MaterialObjective: margin: expected a number of at least 0, found " + options::shown(margin));
  require(samples.cols() == static_cast<Eigen::Index>(n) * regions, "MaterialObjective: samples: expected " +
                                                                        std::to_string(n * regions) + " columns, found " +
                                                                        std::to_string(samples.cols()));
  require(samples.allFinite(), "MaterialObjective: samples: expected finite numbers, found NaN or infinity");
  if (samples.rows() == 0)
    return MatrixRM(0, regions);
  std::vector<std::vector<pbd::Material>> materials(static_cast<std::size_t>(samples.rows()));
  for (Eigen::Index s = 0; s < samples.rows(); ++s)
    for (int r = 0; r < regions; ++r)
      materials[s].push_back(impl_->space.material(samples.row(s).segment(r * n, n).transpose()));
  const Race race = impl_->race(margin);
  Samples generation = race.make_samples(materials);
  return race.run(generation, context);
}

std::vector<std::vector<FrameTerms>> MaterialObjective::terms(const std::vector<pbd::Material> &materials) const {
  Context one;
  one.threads = 1;
  const Race all = impl_->race(0);
  Samples samples = all.make_samples({materials});
  all.run(samples, one);
  return samples.terms[0];
}

std::vector<std::vector<FrameTerms>> MaterialObjective::surface_terms(const std::vector<Vertices> &surfaces) const {
  return impl_->energy.surface_terms(surfaces);
}

std::vector<double> MaterialObjective::surface_energy(const std::vector<Vertices> &surfaces) const {
  return impl_->energy.mean(impl_->energy.surface_terms(surfaces));
}

} // namespace doublet
