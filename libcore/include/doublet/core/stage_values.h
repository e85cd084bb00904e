#pragma once
// The values that stages hand to each other (each has a file, see files.h and docs/formats.md).

#include "doublet/core/camera.h"
#include "doublet/core/context.h"
#include "doublet/core/mesh.h"
#include "doublet/core/mesh_sequence.h"
#include "doublet/core/skeleton.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

/// The animatable template of Sect. 4: closed surface M in the scan pose, skeleton and skin weights. File: actor.npz.
struct RiggedMesh {
  Mesh mesh;
  Mask face_valid;  ///< (F) 0 = semantically invalid (invented over a large hole)
  MatrixRM weights; ///< (V, J), rows sum to one
  Skeleton skeleton;
};

/// The captured reference performance. File: performance.npz.
struct ReferencePerformance {
  MeshSequence surface;         ///< T frames of the mesh of the RiggedMesh, cloth included
  MatrixRM dofs;                ///< (T, D) poses
  std::vector<Vertices> joints; ///< T x (J, 3) m
  std::vector<int> frames;      ///< (T) video frame numbers
};

/// Checks of values that may come from other programs. Throws std::invalid_argument for wrong lengths, Error for wrong values.
/// Usable mesh, face_valid (F), finite weights (V, J).
void require_actor(const RiggedMesh &actor, const std::string &what);
/// Finite frames of so many vertices.
void require_frames(const std::vector<Vertices> &frames, Eigen::Index vertices, const std::string &what);
/// At least one frame; finite surfaces (V, 3) and poses (T, D); joints (J, 3) and frame numbers for all frames, or none.
void require_performance(const ReferencePerformance &performance, const RiggedMesh &actor, const std::string &what);

/// T x (V, 3) m: every vertex of every captured frame, taken back to the scan pose by its blended bone transform (dual
/// quaternions). Throws std::invalid_argument if actor and performance do not belong together.
std::vector<Vertices> canonical_frames(const RiggedMesh &actor, const ReferencePerformance &performance,
                                       const Context &context = {});

/// One texture feature seen in one camera in two successive frames.
struct FeatureMatch {
  Eigen::Vector2f previous, current; ///< pixels of the original (distorted) image at t-1 and t
};

/// What was measured in one camera's image at one frame: 2D data only (Sect. 6.2).
struct ViewObservation {
  std::vector<Eigen::Vector2f>
      contour; ///< boundary points of the measured silhouette, pixels, about one per pixel; empty = image missing
  std::vector<FeatureMatch> matches; ///< features inside the silhouette matched from t-1 to t; empty at the first frame
};

/// 2D observations of the whole reference sequence. File: observations.npz.
struct Observations {
  CameraRig cameras;
  std::vector<int> frames;                         ///< (T) video frame numbers
  std::vector<std::vector<ViewObservation>> views; ///< [T][cameras]
};

/// Sect. 5. File: segmentation.npz.
struct Segmentation {
  Eigen::VectorXd sigma;     ///< (V) m, standard deviation of the opposite-ray distance; NaN where no valid ray was found
  Eigen::VectorXd clothness; ///< (V) delta in [0, 1]
  Eigen::VectorXi region;    ///< (V) connected region of delta > 0, numbered by falling area; -1 = rigid
  int region_count = 0;
  /// (V, 3) m: the shape that lengths and masses of the cloth come from (see Garment::rest); empty = the mesh in the scan pose.
  Vertices rest = Vertices(0, 3);
  Eigen::VectorXd probability = {}; ///< (V) in [0, 1], of being cloth; empty = not known
  Eigen::VectorXd slack = {};       ///< (V) m, how far the surface gets from the body (cloth_slack); empty = not measured
};

/// clothness (V) in [0, 1], region (V) from -1 to below region_count; sigma, probability, slack and rest for all vertices or
/// none, the last two finite. Throws as require_actor.
void require_segmentation(const Segmentation &segmentation, Eigen::Index vertices, const std::string &what);

/// Two spheres and the cone between them, carried rigidly by a joint. File: proxies.json.
struct TaperedCapsule {
  int joint = 0;
  Eigen::Vector3d p0, p1; ///< m; in the joint's frame (rest-pose axes, origin at the joint's rest position)
  double r0 = 0, r1 = 0;  ///< m
};

/// Valid joint indices, finite ends, positive radii; throws as require_actor.
void require_proxies(const std::vector<TaperedCapsule> &proxies, const Skeleton &skeleton, const std::string &what);

/// The capsule in the world for a pose.
Capsule pose_capsule(const TaperedCapsule &capsule, const Skeleton &skeleton, const Transforms &world_from_rest);
std::vector<Capsule> pose_capsules(const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton,
                                   const Transforms &world_from_rest);
/// The same into a list whose memory is reused.
void pose_capsules(const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton, const Transforms &world_from_rest,
                   std::vector<Capsule> &posed);
/// Closed triangle meshes of the capsules, concatenated. Throws std::invalid_argument unless ends are finite and radii positive.
Mesh capsule_mesh(const std::vector<Capsule> &capsules);
/// Signed distance (m, negative inside) of a point to a posed capsule.
double signed_distance(const Capsule &capsule, const Eigen::Vector3d &point);

/// The body under the clothes, scan pose. File: body.npz.
struct BodyFit {
  Mesh body;                      ///< (B, 3) scan pose
  Eigen::VectorXd coefficients;   ///< of the statistical model, ~ N(0, 1)
  std::string model;              ///< name and hash of the model file
  double residual = 0;            ///< m, mean |distance| of the exposed scan surface to the body
  Eigen::VectorXd deviation = {}; ///< (B) m, expected RMS error of each vertex: small where skin was seen; empty = not known
};
/// Usable mesh, a finite deviation for all vertices or none; throws as require_actor.
void require_body(const BodyFit &fit, const std::string &what);

// Deprecated names.
using PosedCapsule [[deprecated("use Capsule")]] = Capsule;
template <class... A> [[deprecated("use canonical_frames")]] decltype(auto) unposed_frames(A &&...a) {
  return canonical_frames(std::forward<A>(a)...);
}

} // namespace doublet
