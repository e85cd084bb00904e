#pragma once
// What the checks of a session look at, worked out once a frame.

#include "doublet/capture/session_check.h"
#include "doublet/core/mesh.h"
#include "sentences.h"

namespace doublet::detail {

/// Shares of an image: what shows less than the first, or more than the second, is no silhouette of a person.
inline constexpr double kNoActor = 0.0005, kAllActor = 0.8;

struct Evidence {
  const Session &session;
  FrameSource &frames;
  const SilhouetteExtractor *extractor;
  const Context &context;
  Mesh scan = {};                  ///< empty if the session has none
  SessionCheck found = {};         ///< of the frame that is looked at; findings are still to come
  std::vector<double> shares = {}; ///< (C) of that frame's images which the actor covers; NaN = no silhouette
  Eigen::VectorXd mirrored = {};   ///< (C) diagonal of `overlaps` for the silhouettes as a mirror shows them

  bool scanned() const { return scan.faces.rows() > 0; }
  /// Cameras with a silhouette that can be a person's.
  std::vector<int> seen() const;
};

/// Of frame 0.
Evidence gather_evidence(const Session &session, FrameSource &frames, const SilhouetteExtractor *extractor,
                         const Context &context);
/// From now on that frame is looked at, with the scan where it is placed there.
void look_at(Evidence &evidence, const StartFrame &start);
/// Share of the image that the actor covers; NaN = no silhouette.
double actor_share(const Evidence &evidence, int camera, int frame);

/// Mean of the two in the middle if there are two; of at least one.
double middle_of(const std::vector<double> &values);

} // namespace doublet::detail
