#pragma once
// Silhouettes from images (Sect. 4): chroma keying with the key colour found automatically, or the difference to a background.

#include "doublet/capture/session.h"
#include "doublet/core/context.h"
#include "doublet/core/image.h"
#include "doublet/options/options.h"

#include <memory>
#include <string>
#include <vector>

namespace doublet {

struct ChromaKeyOptions {
  int min_blob_area = 200;
  double min_key_share = 0.5;
  static constexpr auto describe() {
    using namespace options;
    using O = ChromaKeyOptions;
    return Description{
        "ChromaKeyOptions",
        option(&O::min_blob_area, "min_blob_area", at_least(0), "px",
               "Smaller islands and holes of the mask are dropped; at 1004 x 1004, scaled with the image area"),
        option(&O::min_key_share, "min_key_share", Range{0, 1, Open::Below}, "",
               "Share of the image border that must show one saturated hue", "With less there is no screen of one colour"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A static background (background_cut.cpp): a graph cut assigns each pixel to actor or background by the likelihood of its
/// colour and by its neighbours. A shadow is the background's colour at lower brightness (Horprasert, Harwood & Davis 1999).
struct BackgroundOptions {
  double smoothness = 8;
  double shadow = 0.55;
  double highlight = 1.25;
  int min_blob_area = 200;
  static constexpr auto describe() {
    using namespace options;
    using O = BackgroundOptions;
    return Description{
        "BackgroundOptions",
        option(&O::smoothness, "smoothness", at_least(0), "",
               "Cost of a boundary between two pixels of the same colour, as log likelihood",
               "Larger values fill parts that look like the background and lose thin ones"),
        option(&O::shadow, "shadow", Range{0, 1, Open::Below}, "",
               "Background may be darkened by a shadow to this share of its brightness"),
        option(&O::highlight, "highlight", at_least(1), "", "Background may be brightened to this multiple of its brightness"),
        option(&O::min_blob_area, "min_blob_area", at_least(0), "px",
               "Smaller islands and holes of the mask are dropped; at 1004 x 1004, scaled with the image area"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Swap point: an image in, the actor's mask out.
/// Threads: extract() is const and is called from several at once, after all cameras are trained; train() and learn_actor() are
/// called from one thread, never while extract() runs.
class SilhouetteExtractor {
public:
  virtual ~SilhouetteExtractor() = default;
  /// Trains on a few images of one camera: for the chroma key (key colour, threshold) the actor in front of a screen; for
  /// background subtraction clean plates, or images whose median is one. Called once per camera, before extract(). The chroma key
  /// throws Error if no hue dominates the image border.
  virtual void train(int camera, const std::vector<Image> &images) = 0;
  /// Learns the actor's appearance from a few images of the take, after train() and under the same rules. The chroma key does
  /// nothing here.
  virtual void learn_actor(int /*camera*/, const std::vector<Image> & /*images*/) {}
  /// 255 = actor. Both throw std::invalid_argument if the camera was not trained or the image has not three channels.
  virtual Image extract(int camera, const Image &image) const = 0;
  /// For a camera with ready masks: the mask with its outline refined to the edge in the image. Default: the mask as it is.
  /// Called from several threads at once.
  virtual Image refine(int /*camera*/, const Image & /*image*/, const Image &mask) const { return mask; }
  static std::unique_ptr<SilhouetteExtractor> create(const ChromaKeyOptions &options = {});
  static std::unique_ptr<SilhouetteExtractor> create(const BackgroundOptions &options);
};

/// How the silhouettes of a camera are computed: from clean plates of the session, a screen of one colour, or the median of the
/// frames; Auto = the first of these that the session allows.
enum class SilhouetteMethod { Auto, Plates, Key, Median };
inline constexpr std::array kSilhouetteMethodNames{"auto", "plates", "key", "median"}; ///< in the order of SilhouetteMethod

struct SilhouetteOptions {
  SilhouetteMethod method = SilhouetteMethod::Auto;
  int median_frames = 25;
  int actor_frames = 8;
  double mask_error = 0;
  ChromaKeyOptions key;
  BackgroundOptions background;
  static constexpr auto describe() {
    using namespace options;
    using O = SilhouetteOptions;
    return Description{
        "SilhouetteOptions",
        option(&O::method, "method", kSilhouetteMethodNames,
               "Method: plates, key, median, or auto = for each camera the first that the session allows",
               "plates = clean plates of the session, key = a screen of one colour, median = of the frames: the actor must move "
               "about"),
        option(&O::median_frames, "median_frames", at_least(1), "", "Number of frames, spread over the session, for the median"),
        option(&O::actor_frames, "actor_frames", at_least(0), "",
               "Number of frames, spread over the session, from which the actor's colours are learnt"),
        option(&O::mask_error, "mask_error", at_least(0), "px",
               "Expected error of the outlines of ready masks, at 1004 px image height; 0 = they are not refined",
               "Within three times this distance of an outline the image decides"),
        option(&O::key, "key", "Options of the screen of one colour"),
        option(&O::background, "background", "Options of the difference to a background"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A trained extractor for the cameras of a session without ready masks and, if mask_error is above 0, for those with both masks
/// and images, whose outlines it refines; where such a camera has no mask, the result is empty. Null if no camera needs one. Logs
/// the method of every camera. Throws Error if the session does not allow the method that is set.
std::unique_ptr<SilhouetteExtractor> session_silhouettes(const Session &session, FrameSource &frames,
                                                         const SilhouetteOptions &options, const Context &context);

/// What a camera shows at a frame.
struct CameraView {
  Image image; ///< BGR; empty = the camera dropped the frame, or the session has only masks
  Image mask;  ///< 255 = actor; empty = there is neither a ready one nor an image to make it from
};

/// The image, and the ready mask as refined by the extractor or, without one, the extractor's mask. `extractor` null: ready masks
/// only, unrefined.
CameraView read_view(FrameSource &frames, int camera, int frame, const SilhouetteExtractor *extractor);

/// What all cameras of a session show at a frame: one image and one mask each, as CameraView has them.
struct FrameViews {
  std::vector<Image> images, masks;
};
FrameViews read_views(const Session &session, int frame, const SilhouetteExtractor *extractor);

} // namespace doublet
