#include "frame_energy.h"

#include "optimizer_checks.h"

#include <algorithm>

namespace doublet::fit {

Snapshot FrameEnergy::snapshot(int samples) const {
  const std::size_t lanes = lanes_for(samples), vertices = observed_.topology.vertices.size();
  return {std::vector<float>(vertices * 3 * lanes),
          std::vector<std::uint8_t>(static_cast<std::size_t>(samples) * observed_.regions())};
}

void FrameEnergy::take(std::span<const Rollout> some, int first, int t, Snapshot &snapshot) const {
  const int samples = static_cast<int>(snapshot.exploded.size()) / observed_.regions(), lanes = lanes_for(samples),
            end = first + static_cast<int>(some.size());
  float *to = snapshot.positions.data();
  for (int v = 0; v < observed_.topology.vertex_count(); ++v, to += 3 * lanes)
    for (int l = first; l < (end == samples ? lanes : end); ++l) {
      const int r = observed_.topology.region[v];
      const double *from = r < 0 ? &observed_.frames[t].skinned(observed_.topology.vertices[v], 0)
                                 : &some[std::min(l, end - 1) - first].state.regions[r].positions(observed_.topology.row[v], 0);
      for (int k = 0; k < 3; ++k)
        to[k * lanes + l] = static_cast<float>(from[k]);
    }
  for (int s = first; s < end; ++s)
    std::copy(some[s - first].exploded.begin(), some[s - first].exploded.end(),
              snapshot.exploded.begin() + static_cast<std::ptrdiff_t>(s) * observed_.regions());
}

/// Eq. (6).
void FrameEnergy::measure_rims(int t, std::size_t c, Measure &measure) const {
  measure.view.outline(observed_.views[t][c].others, measure.rims);
  for (const Rim &rim : measure.rims) {
    const double distance = observed_.views[t][c].contour.distance(rim.x, rim.y);
    FrameTerms &terms = (*measure.terms[rim.lane])[observed_.topology.region[rim.vertex]][t];
    terms.silhouette += distance * distance;
    ++terms.rims;
  }
}

/// The other direction: from the measured contour of the captured cloth to the outline of the sample's.
void FrameEnergy::measure_contour(int t, std::size_t c, Measure &measure) const {
  const CapturedContour &contour = observed_.captured[t][c].contour;
  const float farthest_rim = static_cast<float>(observed_.options.rim_cap) * larger_side(observed_.cameras[c].camera);
  for (int r = 0; r < observed_.regions(); ++r) {
    const int first = contour.first[r], count = contour.first[r + 1] - first;
    measure.view.approach(r, count, contour.x.data() + first, contour.y.data() + first, farthest_rim * farthest_rim,
                          measure.squared);
    const float *squared = measure.squared.data();
    for (Terms *sample : measure.terms) {
      FrameTerms &terms = (*sample)[r][t];
      for (int i = 0; i < count; ++i)
        terms.contour += *squared++;
      terms.points += count;
    }
  }
}

/// Eq. (7).
void FrameEnergy::measure_features(int t, std::size_t c, Measure &measure) const {
  const LocatedFeatures &located = measure.located[c];
  const std::vector<float> &squared = measure.view.squared_errors(located, measure.largest[c]);
  for (int i = 0; i < located.count; ++i)
    for (std::size_t s = 0; s < measure.terms.size(); ++s) {
      const std::size_t at = static_cast<std::size_t>(i) * measure.view.lanes() + s;
      if (located.face[at] < 0)
        continue;
      FrameTerms &terms = (*measure.terms[s])[observed_.topology.face_region[located.face[at]]][t];
      terms.feature += squared[at];
      ++terms.features;
    }
}

/// From the simulated cloth to the captured surface.
void FrameEnergy::measure_surface(int t, Measure &measure) const {
  const CapturedShape &shape = observed_.shapes[t];
  const int lanes = measure.view.lanes();
  for (const int v : observed_.probes) {
    const int r = observed_.topology.region[v];
    if (!shape.has(r))
      continue;
    const float *place = measure.view.positions().data() + static_cast<std::size_t>(v) * 3 * lanes;
    for (std::size_t s = 0; s < measure.terms.size(); ++s) {
      FrameTerms &terms = (*measure.terms[s])[r][t];
      const Eigen::Vector3d point(place[s], place[lanes + s], place[2 * lanes + s]);
      terms.surface += std::min(shape.squared_distance(r, point), observed_.worst[r][t].surface);
      ++terms.probes;
    }
  }
}

/// A sample that does not show a feature of the captured cloth, or shows another region there, has the same point of the
/// cloth elsewhere: that is where the feature is taken to lie.
void FrameEnergy::place_missed(const CapturedFeatures &features, LocatedFeatures &located, int lanes) const {
  for (int i = 0; i < located.count; ++i) {
    const int match = located.match[i], own = features.face[match];
    for (int l = 0; l < lanes; ++l) {
      int &face = located.face[static_cast<std::size_t>(i) * lanes + l];
      if (face >= 0 && observed_.topology.face_region[face] == observed_.topology.face_region[own])
        continue;
      face = own;
      for (int k = 0; k < 3; ++k)
        located.weight[(static_cast<std::size_t>(i) * 3 + k) * lanes + l] = features.weight[3 * match + k];
    }
  }
}

/// Where the features lie that are matched from this frame to the next.
void FrameEnergy::locate(int t, std::size_t c, Measure &measure) const {
  LocatedFeatures &located = measure.located[c];
  located.count = 0;
  if (t + 1 >= observed_.frame_count() || observed_.captured[t + 1][c].features.matches.empty())
    return;
  const CapturedFeatures &features = observed_.captured[t + 1][c].features;
  measure.view.locate(features.matches, observed_.views[t][c].others, located);
  measure.largest[c].clear();
  for (const int match : located.match)
    measure.largest[c].push_back(features.largest[match]);
  if (observed_.options.fixed_correspondences)
    place_missed(features, located, measure.view.lanes());
}

void FrameEnergy::find(const Snapshot &snapshot, int t, Measure &measure) const {
  measure.view.positions() = snapshot.positions;
  for (std::size_t c = 0; c < observed_.cameras.size(); ++c) {
    measure.view.set_camera(observed_.cameras[c]);
    locate(t, c, measure);
  }
  measure.watch.lap(&EnergyTimes::features);
}

void FrameEnergy::measure(const Snapshot &snapshot, int t, Measure &measure) const {
  measure.view.positions() = snapshot.positions;
  measure_view(t, measure);
  for (std::size_t s = 0; s < measure.terms.size(); ++s)
    finish(*measure.terms[s], &snapshot.exploded[s * observed_.regions()], t);
}

void FrameEnergy::measure_view(int t, Measure &measure) const {
  for (std::size_t c = 0; c < observed_.cameras.size(); ++c) {
    measure.view.set_camera(observed_.cameras[c]);
    measure.watch.lap(&EnergyTimes::project);
    measure_features(t, c, measure);
    locate(t, c, measure);
    measure.watch.lap(&EnergyTimes::features);
    if (!observed_.views[t][c].seen)
      continue;
    measure_rims(t, c, measure);
    measure.watch.lap(&EnergyTimes::rims);
    if (observed_.captured[t][c].contour.count() > 0)
      measure_contour(t, c, measure);
    measure.watch.lap(&EnergyTimes::contour);
  }
  measure_surface(t, measure);
  measure.watch.lap(&EnergyTimes::surface);
}

/// From sums to means.
void FrameEnergy::finish(Terms &sample, const std::uint8_t *exploded, int t) const {
  for (int r = 0; r < observed_.regions(); ++r) {
    FrameTerms &terms = sample[r][t];
    const double no_rims = observed_.options.fixed_correspondences ? observed_.worst[r][t].silhouette : 0;
    terms.silhouette = terms.rims > 0 ? terms.silhouette / terms.rims : no_rims;
    terms.feature = terms.features > 0 ? terms.feature / terms.features : 0;
    terms.contour = terms.points > 0 ? terms.contour / terms.points : 0;
    terms.surface = terms.probes > 0 ? terms.surface / terms.probes : 0;
    if (exploded[r])
      terms = observed_.worst[r][t];
  }
}

double FrameEnergy::mean(const Terms &terms, int region) const {
  const auto over_frames = [&](double FrameTerms::*term) {
    double sum = 0;
    int count = 0;
    for (int t = 0; t < observed_.frame_count(); ++t)
      if (observed_.worst[region][t].*term > 0) {
        sum += terms[region][t].*term;
        ++count;
      }
    return sum / std::max(1, count);
  };
  return observed_.options.alpha * over_frames(&FrameTerms::silhouette) +
         observed_.options.beta * over_frames(&FrameTerms::feature) +
         observed_.options.gamma * over_frames(&FrameTerms::contour) +
         observed_.options.delta * over_frames(&FrameTerms::surface);
}

std::vector<double> FrameEnergy::mean(const Terms &terms) const {
  std::vector<double> result;
  for (int r = 0; r < observed_.regions(); ++r)
    result.push_back(mean(terms, r));
  return result;
}

Terms FrameEnergy::surface_terms(const std::vector<Vertices> &surfaces) const {
  require(surfaces.size() == observed_.frames.size(), "MaterialObjective: surfaces: expected " +
                                                          std::to_string(observed_.frames.size()) + ", one per frame, found " +
                                                          std::to_string(surfaces.size()));
  const Eigen::Index vertices = observed_.simulator->actor().mesh.vertices.rows();
  for (const Vertices &surface : surfaces)
    require(surface.rows() == vertices && surface.allFinite(),
            "MaterialObjective: surfaces: expected (" + std::to_string(vertices) + ", 3) finite numbers, found (" +
                std::to_string(surface.rows()) + ", 3)" + (surface.allFinite() ? "" : " with NaN or infinity"));
  Terms terms(observed_.regions(), std::vector<FrameTerms>(observed_.frames.size()));
  const std::vector<std::uint8_t> exploded(observed_.regions(), 0);
  Measure tools(observed_.topology, {&terms}, observed_.cameras.size());
  for (int t = 0; t < observed_.frame_count(); ++t) {
    place_surface(observed_.topology, surfaces[t], tools.view);
    measure_view(t, tools);
    finish(terms, exploded.data(), t);
  }
  return terms;
}

} // namespace doublet::fit
