#pragma once
// Silhouettes from images (Sect. 4): chroma keying with the key colour found automatically.

#include "doublet/core/context.h"
#include "doublet/core/image.h"

#include <memory>
#include <vector>

namespace doublet {

struct ChromaKeyOptions {
  int smallest_blob = 200;  ///< px, at 1004 x 1004; smaller foreground islands and background holes are dropped (scaled with the image area)
  void validate() const;
};

/// Swap point: an image in, the actor's mask out. Safe to call from many threads once trained.
class SilhouetteExtractor {
public:
  virtual ~SilhouetteExtractor() = default;
  /// Looks at a few images of one camera (key colour, threshold). Called once a camera before extract().
  virtual void train(int camera, const std::vector<Image> &images) = 0;
  /// 255 = actor.
  virtual Image extract(int camera, const Image &image) const = 0;
  static std::unique_ptr<SilhouetteExtractor> create(const ChromaKeyOptions &options = {});
};

}  // namespace doublet
