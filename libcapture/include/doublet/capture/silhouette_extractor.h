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
               "Share of the image border that must show one saturated hue", "With less there is no screen to key against"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A still background (background_cut.cpp): each pixel is the actor's or the background's by how likely its colour is on either,
/// and by its neighbours. A shadow is the background's colour at less brightness (Horprasert, Harwood & Davis 1999).
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
               "Log likelihood that an edge between two pixels of the same colour costs",
               "More fills what looks like the background and loses thin parts"),
        option(&O::shadow, "shadow", Range{0, 1, Open::Below}, "",
               "Background may be darkened by a shadow to this share of its brightness"),
        option(&O::highlight, "highlight", at_least(1), "", "Background may be brightened to this share of its brightness"),
        option(&O::min_blob_area, "min_blob_area", at_least(0), "px",
               "Smaller islands and holes of the mask are dropped; at 1004 x 1004, scaled with the image area"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Swap point: an image in, the actor's mask out.
/// Threads: extract() is const and is called from several at once, once all cameras are trained; train() and learn_actor() are
/// called from one, while nobody extracts.
class SilhouetteExtractor {
public:
  virtual ~SilhouetteExtractor() = default;
  /// Looks at a few images of one camera: the actor before a screen for the chroma key (key colour, threshold); clean plates, or
  /// images whose median is one, for subtraction. Called once a camera before extract(). The chroma key throws Error if no hue
  /// dominates the image border.
  virtual void train(int camera, const std::vector<Image> &images) = 0;
  /// Looks at a few images of the take, after train() and under the same rules: an extractor may learn from them what the actor
  /// looks like. The chroma key needs nothing.
  virtual void learn_actor(int /*camera*/, const std::vector<Image> & /*images*/) {}
  /// 255 = actor. Both throw std::invalid_argument if the camera was not trained or the image has not three channels.
  virtual Image extract(int camera, const Image &image) const = 0;
  /// Of a camera with ready masks: the mask, its outline brought to where the image has it. By default it is taken as it is.
  /// Called from several threads at once.
  virtual Image refine(int /*camera*/, const Image & /*image*/, const Image &mask) const { return mask; }
  static std::unique_ptr<SilhouetteExtractor> create(const ChromaKeyOptions &options = {});
  static std::unique_ptr<SilhouetteExtractor> create(const BackgroundOptions &options);
};

/// Where the silhouettes of a camera come from: clean plates of the session, a screen of one colour, the median of the frames;
/// Auto = the first of these that the session allows.
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
               "Method: plates, key, median, or auto: the first of these that the session allows, a camera",
               "plates = clean ones of the session, key = a screen of one colour, median = of the frames: the actor must move "
               "about"),
        option(&O::median_frames, "median_frames", at_least(1), "",
               "Number of frames, spread over the session, that the median is taken of"),
        option(&O::actor_frames, "actor_frames", at_least(0), "",
               "Number of frames, spread over the session, that the actor's colours before a background are learnt from"),
        option(&O::mask_error, "mask_error", at_least(0), "px",
               "Expected error of the outlines of ready masks, at 1004 px image height; 0 = they are taken as they are",
               "Up to three times as far from them the image decides"),
        option(&O::key, "key", "Options of the screen of one colour"),
        option(&O::background, "background", "Options of the difference to a background"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A trained extractor for the cameras of a session that have no ready masks, and with mask_error above 0 for those that have
/// images with them, whose outlines it refines; where one of these masks is missing, it finds nothing. Null if there are masks
/// alone. Says for every camera which method it uses. Throws Error if the method asked for does not fit the session.
std::unique_ptr<SilhouetteExtractor> session_silhouettes(const Session &session, FrameSource &frames,
                                                         const SilhouetteOptions &options, const Context &context);

/// What a camera shows at a frame.
struct CameraView {
  Image image; ///< BGR; empty = the camera shows nothing, or the session has masks alone
  Image mask;  ///< 255 = actor; empty = there is neither a ready one nor an image to make it from
};

/// The image, and the ready mask as the extractor refines it or, where there is none, the extractor's own. `extractor` may be
/// null: then only ready masks, as they are.
CameraView read_view(FrameSource &frames, int camera, int frame, const SilhouetteExtractor *extractor);

/// What all cameras of a session show at a frame: one image and one mask each, as CameraView has them.
struct FrameViews {
  std::vector<Image> images, masks;
};
FrameViews read_views(const Session &session, int frame, const SilhouetteExtractor *extractor);

} // namespace doublet
