// Which extractor a camera of a session gets, and what it shows.

#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/context.h"
#include "doublet/core/error.h"
#include "frames/frame_reader.h"
#include "frames/lens_map.h"
#include "outline_refinement.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

namespace doublet {
namespace {

/// What one camera has learnt: one of the two, or nothing if its ready masks have no images.
struct Trained {
  std::string method; ///< in words
  std::shared_ptr<SilhouetteExtractor> extractor;
  std::optional<detail::OutlineRefiner> refiner;
};

/// Each camera's own extractor.
class SessionSilhouettes : public SilhouetteExtractor {
public:
  void add(int camera, Trained trained) {
    if (trained.extractor)
      extractors_[camera] = std::move(trained.extractor);
    if (trained.refiner)
      refiners_.emplace(camera, std::move(*trained.refiner));
  }
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

/// Trains the extractor of one camera by the first method that fits. Threads: several cameras at once.
class Trainer {
public:
  Trainer(const Session &session, FrameSource &frames, const SilhouetteOptions &options)
      : session_(session), frames_(frames), options_(options) {}

  Trained train(int camera) const {
    const SilhouetteMethod method = options_.method;
    const std::string name = "camera '" + session_.cameras[camera].name + "'";
    if (!session_.cameras[camera].masks.empty())
      return refine_masks(camera);
    const bool automatic = method == SilhouetteMethod::Auto;
    if (method == SilhouetteMethod::Plates || (automatic && !session_.cameras[camera].background.empty())) {
      if (session_.cameras[camera].background.empty())
        throw Error(session_.folder.string() + ": " + name +
                    " has no clean plate (\"background\" in session.json), which the "
                    "silhouette method 'plates' needs");
      return {"difference to its clean plate", background(camera, plates(camera)), {}};
    }
    std::string why;
    if (method == SilhouetteMethod::Key || automatic)
      try {
        std::shared_ptr<SilhouetteExtractor> key = SilhouetteExtractor::create(options_.key);
        key->train(camera, require_images(spread_images(frames_, camera, 3), name));
        return {"key colour", std::move(key), {}};
      } catch (const Error &error) {
        if (!automatic)
          throw;
        why = std::string(" (") + error.what() + ")";
      }
    const std::vector<Image> images = require_images(spread_images(frames_, camera, options_.median_frames), name);
    return {"difference to the median of its frames" + why, background(camera, images), {}};
  }

private:
  Trained refine_masks(int camera) const {
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
      return {"ready masks, none of which has an image", {}, {}};
    const double error = options_.mask_error * images[0].height / 1004;
    const std::string without = missing > 0 ? ", of which " + std::to_string(missing) + " frames looked at have none" : "";
    return {"ready masks" + without + ", their outlines as the images have them",
            {},
            detail::OutlineRefiner(error, options_.background, images, masks)};
  }

  /// Subtracts what `plates` have in common, and knows the actor.
  std::shared_ptr<SilhouetteExtractor> background(int camera, const std::vector<Image> &plates) const {
    std::shared_ptr<SilhouetteExtractor> extractor = SilhouetteExtractor::create(options_.background);
    extractor->train(camera, plates);
    extractor->learn_actor(camera, spread_images(frames_, camera, options_.actor_frames));
    return extractor;
  }

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
};

} // namespace

std::unique_ptr<SilhouetteExtractor> session_silhouettes(const Session &session, FrameSource &frames,
                                                         const SilhouetteOptions &options, const Context &context) {
  options.validate();
  const Trainer trainer(session, frames, options);
  const int count = static_cast<int>(session.cameras.size()), at_once = context.thread_count();
  std::vector<Trained> trained(count);
  for (int first = 0; first < count; first += at_once) {
    context.report_progress("silhouettes", double(first) / count);
    parallel_for(context, std::min(at_once, count - first), [&](int i) {
      const SessionCamera &camera = session.cameras[first + i];
      if (camera.masks.empty() || (!camera.video.empty() && options.mask_error > 0))
        trained[first + i] = trainer.train(first + i);
    });
  }
  context.report_progress("silhouettes", 1);
  auto all = std::make_unique<SessionSilhouettes>();
  std::map<std::string, std::string> cameras; // by method
  bool needed = false;                        // with images beside ready masks, too: one of them may be missing
  for (int c = 0; c < count; ++c) {
    const SessionCamera &camera = session.cameras[c];
    if (!camera.masks.empty())
      all->has_masks(c);
    needed = needed || camera.masks.empty() || !camera.video.empty();
    if (trained[c].method.empty())
      continue;
    std::string &names = cameras[trained[c].method];
    names += (names.empty() ? "" : ", ") + camera.name;
    all->add(c, std::move(trained[c]));
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
  const int count = source->camera_count();
  FrameViews views{std::vector<Image>(count), std::vector<Image>(count)};
  parallel_for({}, count, [&](int camera) {
    auto [image, mask] = read_view(*source, camera, frame, extractor);
    views.images[camera] = std::move(image);
    views.masks[camera] = std::move(mask);
  });
  return views;
}

} // namespace doublet
