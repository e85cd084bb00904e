#pragma once
// A capture session on disk (docs/formats.md): session.json, calibration, videos or image folders, masks, scan, joints.

#include "doublet/capture/calibration_file.h"
#include "doublet/capture/keypoints.h"
#include "doublet/core/camera.h"
#include "doublet/core/image.h"
#include "doublet/core/skeleton.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

struct SessionCamera {
  std::string name;
  std::filesystem::path video; ///< absolute; an mp4, or a printf pattern such as cam0/%04d.png; empty if there are only masks
  std::filesystem::path masks; ///< absolute; the same kinds; empty = silhouettes are computed from the video
  std::filesystem::path background; ///< absolute; an image of the empty stage or a pattern of several; empty = none
  int first_frame = 0;              ///< of video and masks: frame 0 of the session; earlier frames are not used
  int late = 0;                     ///< frames, as CalibratedCamera::late: frame t of the session is t + late of this camera
  double video_fps = 0;             ///< as stated in the video's container, which may be wrong; 0 = not stated (images)
};

struct Session {
  std::filesystem::path folder;
  std::string name;
  double fps = 0;
  int frame_count = 0;
  std::vector<SessionCamera> cameras;
  CameraRig rig;              ///< one camera for each of `cameras`
  std::vector<Lens> lenses;   ///< undistorted when frames, masks and clean plates are read; one per camera, or empty
  std::filesystem::path scan; ///< absolute; empty if there is none (yet)
  /// The scan was made from the views (`doublet scan`): between the outlines it bulges by about as much as clothes do.
  bool scan_from_views = false;
  std::filesystem::path calibration;                ///< absolute
  std::filesystem::path markers;                    ///< absolute; empty if there are none (yet)
  std::vector<JointAnnotation> joints;              ///< joints.json
  std::map<std::string, Eigen::Vector3d> landmarks; ///< joints.json, clicked on the body surface, m
  std::filesystem::path new_motion;                 ///< absolute; empty if not given
  std::filesystem::path keypoints;                  ///< absolute; empty if there are none
};

/// Reads and checks a whole session within seconds, before any work: every file named exists, every camera is calibrated, every
/// joint's parent is known, every video opens with the stated size and has first_frame + frame_count frames (a truncated mp4 is
/// found here). Throws FileNotFound, or Error with one sentence naming file, expectation and finding.
Session read_session(const std::filesystem::path &folder);

/// The session with the cameras of another calibration.yml, such as the refined one of a capture. Throws as read_session if a
/// camera is not in it or has another size.
Session recalibrated(const Session &session, const std::filesystem::path &calibration);

/// Throws Error if the session has no scan or no joints, which all stages but those that make them need.
void require_scanned(const Session &session);

/// Swap point: where frames come from. Sequential reading is cheap, jumping may not be.
/// Threads: different cameras are read from several at once, one camera from one at a time. The counts are read from any thread.
class FrameSource {
public:
  virtual ~FrameSource() = default;
  virtual int frame_count() const = 0;
  virtual int camera_count() const = 0;
  /// BGR image of a camera at a frame, undistorted to the camera of the rig; an empty image if the session has only masks, or the
  /// camera dropped the frame: no image, or one of a single colour.
  virtual Image image(int camera, int frame) = 0;
  /// Ready mask (255 = actor); an empty image if the session has none and the image must be keyed.
  virtual Image mask(int camera, int frame) = 0;
  /// kKeypoints of the actor, in pixels of the camera of the rig; empty (the default) if there are none.
  virtual std::vector<Keypoint> keypoints(int camera, int frame);
  static std::unique_ptr<FrameSource> open(const Session &session);
};

} // namespace doublet
