#pragma once
// Which cameras see a point of a surface, away from everything that may not be the surface there, and in which colour.

#include "doublet/animate/texture_baker.h"
#include "doublet/core/rasterizer.h"
#include "label_colours.h"

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace doublet::detail {

constexpr int kSightRadius = 2; // pixels around a sample that must see the same surface
constexpr int kAlong = 4, kPoints = kAlong * (kAlong + 1) / 2;

/// Barycentric coordinates of a triangular grid, half a step away from the edges.
std::array<Eigen::Vector3d, kPoints> points_of_a_face();

struct View {
  int number; ///< of the camera in the rig
  const Camera *camera;
  const Image *image;
  std::vector<int> depth; ///< inside the silhouette, px; empty = there is none
  FaceBuffer buffer;
  std::vector<std::uint16_t> colours = {}; ///< colour_bin() of every pixel; empty = labels do not matter
};

/// A surface point as a camera sees it.
struct Sight {
  const View &view;
  Eigen::Vector2d pixel;
  double depth, facing; ///< m; cosine between normal and ray

  std::size_t nearest_pixel() const { return std::lround(pixel.y()) * view.image->width + std::lround(pixel.x()); }
};

/// Between pixels, which must lie in the image with one to the right and below.
Eigen::Vector3f bilinear(const Image &image, const Eigen::Vector2d &pixel);

/// One frame: a surface, and what was filmed of it. What it is given must outlive it.
class SurfaceSights {
public:
  SurfaceSights(const Mesh &mesh, const std::vector<std::uint8_t> &valid, const CameraRig &cameras,
                const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options);

  bool drawn(int f) const { return valid_.empty() || valid_[f]; }
  const Vertices &normals() const { return normals_; }

  /// From now on cameras do not count where they see the colour of what has the other label beside it. `colours`: what each
  /// label looks like, from another frame; none = from this one. Where the surface has been tracked since, fingers are farther
  /// off, and cameras do not count beside the other label, whatever they see, nor where they see of a body what is rare on it.
  /// Returns them; none where labels do not matter.
  std::shared_ptr<const LabelColours> keep_apart(const std::vector<SurfaceLabel> &face_labels,
                                                 std::shared_ptr<const LabelColours> colours, const Context &context);

  /// B G R of the surface point, and its weight; 0 = seen by no camera.
  float colour_at(int f, const Eigen::Vector3d &barycentric, Eigen::Vector3f &colour) const;

  /// Visits the sights of the surface point that count.
  template <class Visit> void for_sights(int f, const Eigen::Vector3d &barycentric, const Visit &visit) const {
    for_all_sights(f, barycentric, [&](const Sight &sight) {
      if (!shows_the_other_label(f, sight))
        visit(sight);
    });
  }

private:
  /// Whatever colour they show.
  template <class Visit> void for_all_sights(int f, const Eigen::Vector3d &barycentric, const Visit &visit) const {
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point += barycentric[k] * mesh_.vertices.row(mesh_.faces(f, k)).transpose();
      normal += barycentric[k] * normals_.row(mesh_.faces(f, k)).transpose();
    }
    normal.normalize();
    for (const View &view : views_)
      if (const std::optional<Sight> sight = seen_by(view, point, normal))
        visit(*sight);
  }
  std::optional<Sight> seen_by(const View &view, const Eigen::Vector3d &point, const Eigen::Vector3d &normal) const;
  std::vector<int> certain_colours(int f, const std::vector<SurfaceLabel> &face_labels) const;
  bool shows_the_other_label(int f, const Sight &sight) const;

  const Mesh &mesh_;
  const std::vector<std::uint8_t> &valid_;
  const TextureOptions &options_;
  Vertices normals_; ///< (V, 3)
  std::vector<View> views_;
  const std::vector<SurfaceLabel> *face_labels_ = nullptr;
  std::shared_ptr<const LabelColours> label_colours_; ///< none = labels do not matter
  bool tracked_ = false;                              ///< since the frame that the colours are of
};

} // namespace doublet::detail
