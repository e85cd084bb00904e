// Which extractor a camera of a session gets, and what it shows.

#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/error.h"
#include "frames/frame_reader.h"
#include "frames/lens_map.h"
#include "outline_refinement.h"

#include <map>
#include <set>
#include <stdexcept>

namespace doublet {
namespace {

/// Each camera's own extractor.
class SessionSilhouettes : public SilhouetteExtractor {
public:
  void add(int camera, std::shared_ptr<SilhouetteExtractor> extractor) { extractors_[camera] = std::move(extractor); }
  void add(int camera, detail::OutlineRefiner refiner) { refiners_.emplace(camera, std::move(refiner)); }
  void has_masks(int camera) { ready_.insert(camera); }
  void train(int camera, const std::vector<Image> &images) override { of(camera).train(camera, images); }
  void learn_actor(int camera, const std::vector<Image> &images) override { of(camera).learn_actor(camera, images); }
  /// Nothing where a ready mask is missing: the camera drops out there.
  Image extract(int camera, const Image &image) const override {
    return ready_.count(camera) > 0 ? Image() : of(camera).extract(camera, image);
  }
  Image refine(int camera, const Image &image, const Image &mask) const override {
    const auto found = refiners_.find(camera);
    return found == refiners_.end() ? mask : found->second.refine(image, mask);
  }

private:
  SilhouetteExtractor &of(int camera) const {
    const auto found = extractors_.find(camera);
    if (found == extractors_.end())
      throw std::invalid_argument("camera: expected one that has no ready masks, found " + std::to_string(camera));
    return *found->second;
  }
  std::map<int, std::shared_ptr<SilhouetteExtractor>> extractors_;
  std::map<int, detail::OutlineRefiner> refiners_;
  std::set<int> ready_; // cameras with masks of their own, refined or not
};

std::set<int> spread_frames(const FrameSource &frames, int count) {
  std::set<int> chosen;
  for (int i = 0; i < count; ++i)
    chosen.insert(count == 1 ? 0 : static_cast<int>(double(i) * (frames.frame_count() - 1) / (count - 1)));
  return chosen;
}

std::vector<Image> spread_images(FrameSource &frames, int camera, int count) {
  std::vector<Image> images;
  for (int frame : spread_frames(frames, count))
    if (Image image = frames.image(camera, frame); !image.empty())
      images.push_back(std::move(image));
  return images;
}

/// Trains the extractor of one camera by the first method that fits; returns what it used, in words.
class Trainer {
public:
  Trainer(const Session &session, FrameSource &frames, const SilhouetteOptions &options)
      : session_(session), frames_(frames), options_(options), key_(SilhouetteExtractor::create(options.key)),
        background_(SilhouetteExtractor::create(options.background)) {}

  std::string train(int camera, SessionSilhouettes &all) {
    const SilhouetteMethod method = options_.method;
    const std::string name = "camera '" + session_.cameras[camera].name + "'";
    if (!session_.cameras[camera].masks.empty())
      return refine_masks(camera, all);
    const bool automatic = method == SilhouetteMethod::Auto;
    if (method == SilhouetteMethod::Plates || (automatic && !session_.cameras[camera].background.empty())) {
      if (session_.cameras[camera].background.empty())
        throw Error(session_.folder.string() + ": " + name +
                    " has no clean plate (\"background\" in session.json), which the "
                    "silhouette method 'plates' needs");
      background_->train(camera, plates(camera));
      learn_actor(camera);
      all.add(camera, background_);
      return "difference to its clean plate";
    }
    std::string why;
    if (method == SilhouetteMethod::Key || automatic)
      try {
        key_->train(camera, require_images(spread_images(frames_, camera, 3), name));
        all.add(camera, key_);
        return "key colour";
      } catch (const Error &error) {
        if (!automatic)
          throw;
        why = std::string(" (") + error.what() + ")";
      }
    background_->train(camera, require_images(spread_images(frames_, camera, options_.median_frames), name));
    learn_actor(camera);
    all.add(camera, background_);
    return "difference to the median of its frames" + why;
  }

private:
  std::string refine_masks(int camera, SessionSilhouettes &all) {
    std::vector<Image> images, masks;
    int missing = 0;
    for (int frame : spread_frames(frames_, options_.median_frames)) {
      Image image = frames_.image(camera, frame), mask = frames_.mask(camera, frame);
      missing += mask.empty();
      if (image.empty() || mask.empty())
        continue;
      const Image &first = images.empty() ? image : images[0];
      for (const Image *one : {&image, &mask})
        if (one->width != first.width || one->height != first.height)
          throw Error("camera '" + session_.cameras[camera].name + "': expected images and masks of " +
                      std::to_string(first.width) + " x " + std::to_string(first.height) + " pixels, found " +
                      std::to_string(one->width) + " x " + std::to_string(one->height) + " at frame " + std::to_string(frame));
      images.push_back(std::move(image));
      masks.push_back(std::move(mask));
    }
    if (images.empty())
      return "ready masks, none of which has an image";
    const double error = options_.mask_error * images[0].height / 1004;
    all.add(camera, detail::OutlineRefiner(error, options_.background, images, masks));
    const std::string without = missing > 0 ? ", of which " + std::to_string(missing) + " frames looked at have none" : "";
    return "ready masks" + without + ", their outlines as the images have them";
  }

  void learn_actor(int camera) { background_->learn_actor(camera, spread_images(frames_, camera, options_.actor_frames)); }

  std::vector<Image> plates(int camera) const {
    const std::vector<Lens> &lenses = session_.lenses;
    if (lenses.empty() || !lenses.at(camera).needs_undistortion())
      return detail::read_plates(session_.cameras[camera].background);
    const detail::LensMap lens(session_.rig.at(camera), lenses[camera]);
    return detail::read_plates(session_.cameras[camera].background, &lens);
  }

  std::vector<Image> require_images(std::vector<Image> images, const std::string &name) const {
    if (images.empty())
      throw std::invalid_argument(session_.folder.string() + ": " + name + " shows nothing in any of the frames looked at");
    return images;
  }

  const Session &session_;
  FrameSource &frames_;
  const SilhouetteOptions &options_;
  std::shared_ptr<SilhouetteExtractor> key_, background_;
};

} // namespace

std::unique_ptr<SilhouetteExtractor> session_silhouettes(const Session &session, FrameSource &frames,
                                                         const SilhouetteOptions &options, const Context &context) {
  options.validate();
  auto all = std::make_unique<SessionSilhouettes>();
  Trainer trainer(session, frames, options);
  std::map<std::string, std::string> cameras; // by method
  const int count = static_cast<int>(session.cameras.size());
  bool needed = false; // with images beside ready masks, too: one of them may be missing
  for (int c = 0; c < count; ++c) {
    context.report_progress("silhouettes", double(c) / count);
    const SessionCamera &camera = session.cameras[c];
    if (!camera.masks.empty())
      all->has_masks(c);
    needed = needed || camera.masks.empty() || !camera.video.empty();
    if (camera.masks.empty() || (!camera.video.empty() && options.mask_error > 0)) {
      std::string &names = cameras[trainer.train(c, *all)];
      names += (names.empty() ? "" : ", ") + camera.name;
    }
  }
  for (const auto &[method, names] : cameras)
    context.log_line("silhouettes: " + names + ": " + method);
  return needed ? std::move(all) : nullptr;
}

CameraView read_view(FrameSource &frames, int camera, int frame, const SilhouetteExtractor *extractor) {
  CameraView view{frames.image(camera, frame), frames.mask(camera, frame)};
  if (view.mask.empty() && !view.image.empty() && extractor)
    view.mask = extractor->extract(camera, view.image);
  else if (!view.image.empty() && !view.mask.empty() && extractor)
    view.mask = extractor->refine(camera, view.image, view.mask);
  return view;
}

FrameViews read_views(const Session &session, int frame, const SilhouetteExtractor *extractor) {
  const auto source = FrameSource::open(session);
  FrameViews views;
  for (int camera = 0; camera < source->camera_count(); ++camera) {
    auto [image, mask] = read_view(*source, camera, frame, extractor);
    views.images.push_back(std::move(image));
    views.masks.push_back(std::move(mask));
  }
  return views;
}

} // namespace doublet
