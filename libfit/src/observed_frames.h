#pragma once
// What a material is measured on: for every frame the pose, and for every camera what its image and the captured cloth show.
// Worked out once, the same for all samples.

#include "captured_cloth.h"
#include "captured_shape.h"
#include "cpu_times.h"
#include "doublet/fit/material_objective.h"
#include "doublet/fit/parts/distance_field.h"

#include <functional>

namespace doublet::fit {

/// What is kept of one camera at one frame.
struct FrameView {
  bool seen = false; ///< the image is there, and the cloth in it
  DistanceField contour;
  CoarseBuffer others; ///< depth of everything that is not cloth: it is the same for every sample
};

using Terms = std::vector<std::vector<FrameTerms>>; ///< [R][T]

class ObservedFrames {
public:
  /// `models`: the character at each width, of one mesh. `frame_seconds`: between two frames. `starts`: frames before
  /// which nothing is simulated, so that there is no frame on which their features could lie.
  ObservedFrames(const std::vector<const CharacterSimulator *> &models, const ReferencePerformance &performance,
                 const Observations &observations, double frame_seconds, const EnergyOptions &energy,
                 const std::vector<int> &starts, CpuTimes &times, const Context &context);

  std::vector<const CharacterSimulator *> widths; ///< they differ in the rest shape of their cloth alone
  const CharacterSimulator *simulator;            ///< the first of them, for all that is the same of all
  double dt;                                      ///< s, between two frames
  EnergyOptions options;
  ClothTopology topology;
  std::vector<CoarseCamera> cameras;
  std::vector<PosedFrame> frames;                  ///< [T], shared by all samples
  std::vector<PosedFrame> lead_in_poses;           ///< in which cloth with a rest shape is put on before the first of them
  std::vector<std::vector<FrameView>> views;       ///< [T][cameras]
  std::vector<std::vector<CapturedView>> captured; ///< [T][cameras], features from t-1 to t
  std::vector<CapturedShape> shapes;               ///< [T], in some frames, unless delta is 0
  std::vector<int> probes;                         ///< vertices of the cloth whose distance to the shapes is measured
  Terms worst; ///< what a frame of an exploded sample costs; a term that is 0 does not count, for any sample

  int regions() const { return static_cast<int>(simulator->regions().size()); }
  int frame_count() const { return static_cast<int>(frames.size()); }
  std::size_t image_bytes() const;

private:
  void prepare(double done, CpuTimes &times, const Context &context, const std::function<void(int)> &frame);
  void keep_image(int t, std::size_t c, const Vertices &surface, const ViewObservation &observation, const CoarseCamera &camera);
  void keep_captured(int t, bool starts, const MeshSequence &surface, const Observations &observations);
  FrameTerms worst_terms(int region, int t) const;
};

} // namespace doublet::fit
