#pragma once
// Silhouettes from images (Sect. 4): chroma keying with the key colour found automatically.

#include "doublet/core/context.h"
#include "doublet/core/image.h"

#include <memory>
#include <vector>

namespace doublet {

struct ChromaKeyOptions {
  int smallest_blob =
      200; ///< px, at 1004 x 1004; smaller foreground islands and background holes are dropped (scaled with the image area)
  double smallest_key_share = 0.5; ///< of the image border that must show one saturated hue, or there is no screen to key against
  void validate() const;           ///< throws std::invalid_argument
};

/// Swap point: an image in, the actor's mask out. Safe to call from many threads once trained.
class SilhouetteExtractor {
public:
  virtual ~SilhouetteExtractor() = default;
  /// Looks at a few images of one camera (key colour, threshold). Called once a camera before extract(), not while another thread
  /// extracts. The chroma key throws Error if no hue dominates the image border.
  virtual void train(int camera, const std::vector<Image> &images) = 0;
  /// 255 = actor. The chroma key throws std::invalid_argument if the camera was not trained or the image has not three channels.
  virtual Image extract(int camera, const Image &image) const = 0;
  static std::unique_ptr<SilhouetteExtractor> create(const ChromaKeyOptions &options = {});
};

} // namespace doublet
