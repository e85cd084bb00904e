#include "doublet/fit/results.h"

namespace doublet {

namespace {

/// What is kept, after it was made if it was not there.
template <class T, class Make> const T &kept(std::optional<T> &value, Make &&make) {
  if (!value)
    value = make();
  return *value;
}

} // namespace

void Results::forget() {
  actor_.reset();
  offered_garment_.reset();
  garment_.reset();
  dressed_.reset();
}

void Results::set_widths(const std::vector<double> &positions) {
  garment_ = choose_widths(offered_garment(), positions);
  dressed_.reset();
}

const RiggedMesh &Results::actor() {
  return kept(actor_, [&] { return read_actor(path("actor.npz")); });
}

ReferencePerformance Results::performance() {
  return read_performance(path("performance.npz"), actor());
}

Observations Results::observations() const {
  return read_observations(path("observations.npz"));
}

Segmentation Results::segmentation() const {
  return read_segmentation(path("segmentation.npz"));
}

BodyFit Results::body() const {
  return read_body(path("body.npz"));
}

std::vector<TaperedCapsule> Results::proxies() {
  return read_proxies(path("proxies.json"), actor().skeleton);
}

const Garment &Results::offered_garment() {
  return kept(offered_garment_, [&] { return read_garment(path("garment.npz"), actor()); });
}

const Garment &Results::garment() {
  return kept(garment_, [&] {
    const Path material = path("material.json");
    const bool estimated = std::filesystem::exists(material);
    return choose_widths(offered_garment(), estimated ? read_widths(material) : std::vector<double>{});
  });
}

const DressedActor &Results::dressed() {
  return kept(dressed_, [&] { return dress(actor(), segmentation(), garment()); });
}

ReferencePerformance Results::dressed_performance() {
  return dress(performance(), actor(), offered_garment());
}

CharacterSimulator Results::simulator(const pbd::ClothOptions &cloth) {
  return CharacterSimulator(dressed().actor, dressed().segmentation, proxies(), cloth);
}

FilmedTake Results::take(const SolverSettings &solver, const std::vector<Garment> &garments) {
  FilmedTake take{{}, dressed_performance(), observations(), solver.dt};
  const Segmentation worn_on = segmentation();
  const std::vector<TaperedCapsule> capsules = proxies();
  for (const Garment &garment : garments.empty() ? width_variants(offered_garment()) : garments) {
    const DressedActor dressed = dress(actor(), worn_on, garment);
    take.widths.emplace_back(dressed.actor, dressed.segmentation, capsules, solver.cloth);
  }
  return take;
}

Take FilmedTake::take() const {
  Take take{{}, &performance, &observations, dt};
  for (const CharacterSimulator &width : widths)
    take.widths.push_back(&width);
  return take;
}

} // namespace doublet
