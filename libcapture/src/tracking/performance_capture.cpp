#include "doublet/capture/performance_capture.h"

#include "camera_choice.h"
#include "delayed_frames.h"
#include "doublet/capture/parts/smoothing.h"
#include "tracked_actor.h"
#include "tracking.h"

#include "doublet/core/parts/fingerprint.h"
#include "doublet/version.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace doublet {
namespace {

using detail::CamerasMoved;
using detail::kMostMoves;
using detail::OtherCapture;
using detail::passes;
using detail::Studio;
using detail::Tracking;
using detail::TrackingJob;

/// Whatever the tracked frames depend on but the images: of a piece of one's own it is only known that it is one.
std::uint64_t fingerprint(const CaptureOptions &options, const std::string &own_parts, const RiggedMesh &actor,
                          const CameraRig &rig, int count) {
  Fingerprint print;
  print.add(std::string(DOUBLET_VERSION)).add(options).add(own_parts).add(std::to_string(count));
  print.add(actor.mesh.vertices).add(actor.mesh.faces).add(actor.face_valid).add(actor.weights);
  print.add(actor.skeleton.lower).add(actor.skeleton.upper);
  for (const Joint &joint : actor.skeleton.joints)
    print.add(joint.name)
        .add(joint.rest)
        .add(joint.axes)
        .add(Eigen::Vector4i(joint.parent, static_cast<int>(joint.kind), joint.first_dof, joint.dof_count));
  for (const Camera &camera : rig)
    print.add(camera.name)
        .add(camera.K)
        .add(camera.distortion)
        .add(camera.R)
        .add(camera.t)
        .add(Eigen::Vector2i(camera.width, camera.height));
  return print.value();
}

class TrackingCapture : public PerformanceCapture {
public:
  TrackingCapture(const CaptureOptions &options, const CaptureParts &parts)
      : options_(options), parts_(parts), own_parts_(own_parts(parts)) {
    if (!parts_.features)
      parts_.features = FeatureTracker::create(options.features);
    if (!parts_.pose)
      parts_.pose = PoseOptimizer::create(options.pose);
    if (!parts_.limbs)
      parts_.limbs = LimbSearch::create(options.limbs);
    if (!parts_.surface)
      parts_.surface = SurfaceRefiner::create(options.surface);
  }

  CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                        const Context &context) override {
    require_usable(actor.mesh, "capture: the actor's mesh");
    if (actor.weights.rows() != actor.mesh.vertices.rows() || actor.weights.cols() != actor.skeleton.joint_count())
      throw std::invalid_argument("capture: the actor's weights must be (" + std::to_string(actor.mesh.vertices.rows()) + ", " +
                                  std::to_string(actor.skeleton.joint_count()) + "), got (" +
                                  std::to_string(actor.weights.rows()) + ", " + std::to_string(actor.weights.cols()) + ")");
    if (static_cast<int>(actor.face_valid.size()) != actor.mesh.faces.rows())
      throw std::invalid_argument("capture: the actor's face_valid must have one entry a face, " +
                                  std::to_string(actor.mesh.faces.rows()) + ", got " + std::to_string(actor.face_valid.size()));
    if (rig.empty() || frames.camera_count() != static_cast<int>(rig.size()))
      throw std::invalid_argument("capture: the rig has " + std::to_string(rig.size()) + " cameras, the frames have " +
                                  std::to_string(frames.camera_count()));
    const int left = frames.frame_count() - options_.first_frame;
    const int count = options_.frame_count < 0 ? left : options_.frame_count;
    if (count < 1 || count > left)
      throw std::invalid_argument("capture: frames " + std::to_string(options_.first_frame) + " to " +
                                  std::to_string(options_.first_frame + count - 1) + " were asked for, there are " +
                                  std::to_string(frames.frame_count()));
    if (options_.start_frame >= 0 &&
        (options_.start_frame < options_.first_frame || options_.start_frame >= options_.first_frame + count))
      throw std::invalid_argument("capture: start_frame: expected one of the frames " + std::to_string(options_.first_frame) +
                                  " to " + std::to_string(options_.first_frame + count - 1) + ", found " +
                                  std::to_string(options_.start_frame));
    const CameraChoice chosen(options_.cameras, rig, frames, extractor);
    const TrackedActor tracked = track_actor(actor, options_.extra_twist_range);
    CaptureCheckpoint checkpoint(options_.checkpoint, fingerprint(options_, own_parts_, tracked.actor, chosen.rig(), count));
    const auto track = [&](std::vector<TrackedFrame> known) {
      return track_until_cameras_stay(tracked.actor, chosen, count, checkpoint, std::move(known), context);
    };
    CaptureResult result;
    try {
      const int most = (passes(options_) + (options_.refine_cameras ? kMostMoves : 0)) * count;
      result = track(checkpoint.read(static_cast<std::size_t>(most), context));
    } catch (const OtherCapture &why) {
      context.log_line("capture: " + checkpoint.path().string() + " " + why.what() + "; starting over");
      checkpoint.start_over();
      result = track({});
    }
    result.performance.dofs = MatrixRM(result.performance.dofs(Eigen::all, tracked.kept));
    return result;
  }

private:
  /// Tracks from the beginning each time that the cameras turn out to be others.
  CaptureResult track_until_cameras_stay(const RiggedMesh &actor, const CameraChoice &chosen, int count,
                                         CaptureCheckpoint &checkpoint, std::vector<TrackedFrame> known, const Context &context) {
    Studio studio;
    studio.given = studio.rig = chosen.rig();
    studio.delays.assign(chosen.rig().size(), 0);
    std::array<double, 6> seconds{};
    double progress = 0, reached = 0;
    for (;;) {
      DelayedFrames frames(chosen.frames(), studio.delays);
      const TrackingJob job{options_, parts_, actor, studio.rig, frames, chosen.extractor(), count, context};
      Tracking run(job, studio, checkpoint);
      run.go_on_after(seconds, progress, reached);
      try {
        CaptureResult result = run.run(std::move(known));
        result.summary.cameras_refined = studio.refined > 0;
        return result;
      } catch (CamerasMoved &moved) {
        move_cameras(studio, moved, context);
        known = std::move(moved.known);
        seconds = moved.seconds;
        progress = moved.progress;
        reached = moved.reached;
      }
    }
  }

  /// A letter for each piece that is not made from the options.
  static std::string own_parts(const CaptureParts &parts) {
    return std::string(parts.features ? "f" : "") + (parts.pose ? "p" : "") + (parts.limbs ? "l" : "") +
           (parts.surface ? "s" : "");
  }

  CaptureOptions options_;
  CaptureParts parts_;
  std::string own_parts_;
};

} // namespace

Session filmed(Session session, const CaptureResult &captured) {
  for (size_t c = 0; c < session.cameras.size(); ++c) {
    const std::string &name = session.cameras[c].name;
    for (const Camera &camera : captured.observations.cameras)
      if (camera.name == name)
        session.rig.at(c) = camera;
    for (const RefinedCamera &camera : captured.summary.cameras)
      if (camera.camera == name)
        session.cameras[c].late += camera.delay;
  }
  return session;
}

void CaptureOptions::validate() const {
  options::check(*this);
  if (frame_count == 0)
    options::throw_invalid("CaptureOptions: frame_count", "a number of frames, or -1 for all", "0");
  savitzky_golay_weights(smooth_window, std::min(smooth_order, smooth_window - 1));
}

std::unique_ptr<PerformanceCapture> PerformanceCapture::create(const CaptureOptions &options) {
  return create(options, {});
}

std::unique_ptr<PerformanceCapture> PerformanceCapture::create(const CaptureOptions &options, const CaptureParts &parts) {
  options.validate();
  return std::make_unique<TrackingCapture>(options, parts);
}

} // namespace doublet
