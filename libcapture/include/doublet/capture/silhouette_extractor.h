#pragma once
// Silhouettes from images (Sect. 4): chroma keying with the key colour found automatically, or the difference to a background.

#include "doublet/capture/session.h"
#include "doublet/core/context.h"
#include "doublet/core/image.h"

#include <memory>
#include <string>
#include <vector>

namespace doublet {

struct ChromaKeyOptions {
  int smallest_blob =
      200; ///< px, at 1004 x 1004; smaller foreground islands and background holes are dropped (scaled with the image area)
  double smallest_key_share = 0.5; ///< of the image border that must show one saturated hue, or there is no screen to key against
  void validate() const;           ///< throws std::invalid_argument
};

/// Subtraction of a still background (Horprasert, Harwood & Davis 1999): a pixel belongs to the background if it has the
/// background's colour there, scaled by a brightness between `shadow` and `highlight`, up to the noise.
struct BackgroundOptions {
  double tolerance = 2.5;  ///< standard deviations of the noise, which is measured in every image
  double shadow = 0.55;    ///< darkest share of its brightness at which the background counts as shadowed
  double highlight = 1.25; ///< brightest
  int smallest_blob = 200; ///< as in ChromaKeyOptions
  void validate() const;
};

/// Swap point: an image in, the actor's mask out. Safe to call from many threads once trained.
class SilhouetteExtractor {
public:
  virtual ~SilhouetteExtractor() = default;
  /// Looks at a few images of one camera: the actor before a screen for the chroma key (key colour, threshold); clean plates, or
  /// images whose median is one, for subtraction. Called once a camera before extract(), not while another thread
  /// extracts. The chroma key throws Error if no hue dominates the image border.
  virtual void train(int camera, const std::vector<Image> &images) = 0;
  /// 255 = actor. Both throw std::invalid_argument if the camera was not trained or the image has not three channels.
  virtual Image extract(int camera, const Image &image) const = 0;
  static std::unique_ptr<SilhouetteExtractor> create(const ChromaKeyOptions &options = {});
  static std::unique_ptr<SilhouetteExtractor> create(const BackgroundOptions &options);
};

struct SilhouetteOptions {
  /// "plates" (clean plates of the session), "key" (a screen of one colour), "median" (of the frames: the actor must move about);
  /// "auto" = for each camera the first of these that the session allows.
  std::string method = "auto";
  int median_frames = 25; ///< spread over the session
  ChromaKeyOptions key;
  BackgroundOptions background;
  void validate() const;
};

/// A trained extractor for the cameras of a session that have no ready masks; null if all have. Says for every camera which
/// method it uses. Throws Error if the method asked for does not fit the session.
std::unique_ptr<SilhouetteExtractor> session_silhouettes(const Session &session, FrameSource &frames,
                                                         const SilhouetteOptions &options, const Context &context);

/// What a camera shows at a frame.
struct CameraView {
  Image image; ///< BGR; empty = the camera shows nothing, or the session has masks alone
  Image mask;  ///< 255 = actor; empty = there is neither a ready one nor an image to make it from
};

/// The image, and the ready mask or, where there is none, the extractor's. `extractor` may be null: then only ready masks.
CameraView read_view(FrameSource &frames, int camera, int frame, const SilhouetteExtractor *extractor);

} // namespace doublet
