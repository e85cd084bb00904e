#pragma once
// What every ClothSegmenter must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/options/options.h"
#include "doublet/segment/cloth_segmenter.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

namespace detail {

/// A closed column, 1.6 m high and 0.3 m wide, whose lower half sways; the last vertex is on no face.
inline MeshSequence swaying_column() {
  constexpr int kAround = 16, kRows = 25, kSide = kAround * kRows;
  MeshSequence sequence;
  std::vector<Eigen::Vector3i> faces;
  for (int r = 0; r < kRows; ++r)
    for (int a = 0; a < kAround; ++a) {
      const int b = (a + 1) % kAround, here = r * kAround;
      if (r + 1 < kRows) {
        faces.emplace_back(here + a, here + b, here + kAround + b);
        faces.emplace_back(here + a, here + kAround + b, here + kAround + a);
      } else {
        faces.emplace_back(b, a, kSide);
        faces.emplace_back(here + a, here + b, kSide + 1);
      }
    }
  sequence.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    sequence.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  for (int t = 0; t < 6; ++t) {
    Vertices frame(kSide + 3, 3);
    for (int i = 0; i < kSide; ++i) {
      const double y = 1.6 * (i / kAround) / (kRows - 1), turn = 2 * std::numbers::pi * (i % kAround) / kAround;
      const double radius = 0.15 + (y < 0.8 ? 0.04 * std::sin(t + 2 * turn) : 0);
      frame.row(i) << radius * std::sin(turn), y, radius * std::cos(turn);
    }
    frame.bottomRows(3) << 0, 0, 0, 0, 1.6, 0, 0, 3, 0;
    sequence.frames.push_back(frame);
  }
  return sequence;
}

} // namespace detail

/// One sentence for each rule the segmenter breaks: sizes are those of the mesh, clothness lies in [0, 1], regions are what is
/// cloth, what sways is more so than what stands, what is on no face is rigid, two calls give the same bits, a single frame is
/// refused.
inline std::vector<std::string> cloth_segmenter_violations(const ClothSegmenter &segmenter) {
  std::vector<std::string> broken;
  SegmentInputs inputs{detail::swaying_column()};
  const Eigen::Index n = inputs.surface.frames[0].rows();
  inputs.face_valid.assign(static_cast<std::size_t>(inputs.surface.faces.rows()), 1);
  try {
    const Segmentation found = segmenter.segment(inputs, {}), again = segmenter.segment(inputs, {});
    if (found.clothness.size() != n || found.region.size() != n)
      return {"expected a clothness and a region for each of " + std::to_string(n) + " vertices, found " +
              std::to_string(found.clothness.size()) + " and " + std::to_string(found.region.size())};
    if (!((found.clothness.array() >= 0).all() && (found.clothness.array() <= 1).all()))
      broken.push_back("clothness leaves [0, 1]");
    for (Eigen::Index v = 0; v < n; ++v) {
      const int region = found.region[v];
      if (region < -1 || region >= found.region_count || (region >= 0) != (found.clothness[v] > 0)) {
        broken.push_back("vertex " + std::to_string(v) + " of clothness " + options::to_text(found.clothness[v]) +
                         " has the region " + std::to_string(region) + " of " + std::to_string(found.region_count) +
                         "; expected -1 where clothness is 0, an index elsewhere");
        break;
      }
    }
    const Eigen::Index half = 12 * 16; // the rows below 0.8 m come first
    if (!(found.clothness.head(half).mean() > found.clothness.segment(half, half).mean()))
      broken.push_back("what sways is no more cloth than what stands still");
    if (found.clothness[n - 1] != 0)
      broken.push_back("a vertex on no face is not rigid");
    if (again.clothness.size() != n || again.region.size() != n || found.clothness != again.clothness ||
        found.region != again.region)
      broken.push_back("a second call gives other bits");
  } catch (const std::exception &error) {
    broken.push_back(std::string("the segmenter threw: ") + error.what());
  }
  try {
    SegmentInputs single = inputs;
    single.surface.frames.resize(1);
    segmenter.segment(single, {});
    broken.push_back("a sequence of one frame is not refused");
  } catch (const std::exception &) { // of whatever kind: Python has its own
  }
  return broken;
}

} // namespace doublet::testing
