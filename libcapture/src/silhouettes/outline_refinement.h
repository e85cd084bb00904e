#pragma once
// Ready masks are where a network or a hand has put them; the image knows their outlines better.

#include "actor_cut.h"

#include <vector>

namespace doublet::detail {

/// One camera that stands still. What is behind the actor is seen in the frames whose masks say that she is elsewhere, what she
/// looks like well inside the masks; near a mask's outline a pixel is the actor's or the background's by how likely its colour is
/// on either, by its neighbours, and by how far it is from that outline (after Rother, Kolmogorov and Blake, GrabCut, SIGGRAPH
/// 2004). What no frame has shown is judged by all colours of the room.
class OutlineRefiner {
public:
  /// `error`: px, expected of a mask's outline. Frames of the take, spread over it, and their masks; of one size, none empty.
  OutlineRefiner(double error, const BackgroundOptions &options, const std::vector<Image> &images,
                 const std::vector<Image> &masks);
  /// 255 = actor.
  Image refine(const Image &image, const Image &mask) const;

private:
  double error_;
  BackgroundOptions options_;
  BackgroundColours background_;
  Plate plate_;
  ColourHistogram actor_, room_;
};

} // namespace doublet::detail
