#pragma once
// What the cameras saw of every face of a surface in several frames, and which of it the texture is made of: one frame a face,
// few changes between them (Lempitsky, Ivanov 2007; Waechter, Moehrle, Goesele 2014).

#include "surface_sights.h"

#include <vector>

namespace doublet::detail {

/// What a camera sees of a face.
struct SeenPoints {
  int camera;
  std::uint16_t points; ///< bits of points_of_a_face()
};

/// A face in one frame.
struct FaceView {
  int frame;
  float quality;          ///< resolution and share that was seen
  Eigen::Vector3f colour; ///< B G R, mean of what was seen
  Eigen::Vector3f level;  ///< to be added: what the surface around is brighter in all frames together
  float slip;             ///< of 255: how unlike the colours of all frames together the faces around are, each for itself
  std::vector<SeenPoints> seen;
};

/// Part of an image, where the actor is.
struct ImagePart {
  Image image;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero(); ///< px, of its first pixel in the whole
};

struct FilmedFrame {
  Vertices vertices, normals;
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> gains; ///< (V, 3) of the 8-bit B G R; none = 1
  std::vector<ImagePart> parts;                                   ///< one per camera; empty = none
  std::vector<Eigen::VectorXf> inside;                            ///< [cameras] (V), see find_insides()
  /// At a point of a face.
  Eigen::Vector3f gain(const Faces &faces, int f, const Eigen::Vector3d &barycentric) const;
  Eigen::Vector3d normal(const Faces &faces, int f, const Eigen::Vector3d &barycentric) const;
  Eigen::Vector3d point(const Faces &faces, int f, const Eigen::Vector3d &barycentric) const;
  double inside_at(const Faces &faces, int f, const Eigen::Vector3d &barycentric, int camera) const;
};

/// What was filmed of a surface.
struct FilmedFaces {
  const Mesh &mesh; ///< as it is laid out
  const CameraRig &cameras;
  std::vector<FilmedFrame> frames;
  std::vector<std::vector<FaceView>> views; ///< [F], by frame
  std::vector<std::vector<int>> beside;     ///< [F] faces across an edge
  std::vector<Eigen::Vector3f> colour;      ///< [F] of all frames together
  std::vector<std::uint8_t> known;          ///< [F] 0 = seen in none: the colour is of the faces around
  std::vector<int> label;                   ///< [F] the frame to take; -1 = none

  const FaceView *view(int face, int frame) const;
};

/// A face in a frame, and its index among the face's views.
struct ShownFace {
  int face, view;
};
/// [frames]
std::vector<std::vector<ShownFace>> faces_of_frames(const FilmedFaces &filmed);

/// A colour no brighter than white, in its own hue.
Eigen::Vector3f within_white(Eigen::Vector3f colour);

/// How much a camera counts that sees a point so.
double sight_weight(double facing, double depth, const Camera &camera, double facing_power);

/// Adds a frame: what `sights` of its images show.
void add_frame(FilmedFaces &filmed, const SurfaceSights &sights, const Vertices &vertices, const std::vector<Image> &images,
               const TextureOptions &options, const Context &context);

/// Quality, less where the view shows something else or another place than most others.
float worth(const FaceView &view);

/// Fills `inside` of the frames: how far each vertex is from the faces drawn (`valid`, as of bake_texture()) of which the camera
/// shows nothing, 0 = at one, 1 = a band away from all.
void find_insides(FilmedFaces &filmed, const std::vector<std::uint8_t> &valid, const Context &context);

/// Divides all colours by the light that was on the surface in all frames.
void divide_light(FilmedFaces &filmed, const Context &context);

/// Fills colour and known, and the levels of the views.
void find_levels(FilmedFaces &filmed, const Context &context);

/// Fills label.
void choose_views(FilmedFaces &filmed);

} // namespace doublet::detail
