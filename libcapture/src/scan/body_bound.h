#pragma once
// How far outside a body, that stands inside the clothes, the actor's surface can be.

#include "doublet/core/mesh.h"
#include "doublet/rays/ray_scene.h"

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace doublet::detail {

/// A place on the actor's surface, and how far it lies outside the body.
struct Contact {
  Eigen::Vector3d point;
  double clearance; ///< m, negative inside
};

/// What lies between the legs of a body that stands upright (+Y): at each height the convex hull of both, up to the groin.
class LegGap {
public:
  explicit LegGap(const Mesh &body);
  /// The middle between the legs at each height.
  std::vector<Eigen::Vector3d> middles() const;
  /// Cloth spans the gap at these of the middles' heights: elsewhere it is no part of what nearest() knows.
  void keep(const std::vector<bool> &spanned);
  /// A side of the hull, from one leg to the other or along one.
  struct Side {
    double distance; ///< m, horizontally, negative inside; large where there is no gap or it is not spanned
    Eigen::Vector3d from, to;
    double share; ///< of `to` in the place on the side that is nearest
  };
  Side nearest(const Eigen::Vector3d &point) const;

private:
  struct Slice {
    double height;                 // m
    std::vector<cv::Point2f> hull; // x, z; m
  };
  std::vector<Slice> slices_; // upwards
  std::vector<int> slice_at_; // by height; -1 = none
  double lowest_ = 0;
};

/// The body and what lies on it: skin lies on it everywhere, a garment as far off as contacts nearby do, or, where it hangs down
/// as a sheet (a wide sleeve), along lines from the body.
class BodyBound {
public:
  /// `filled`: is a point one that the silhouettes leave?
  BodyBound(const Mesh &body, const std::function<bool(const Eigen::Vector3d &)> &filled);
  /// m, negative inside the body.
  double distance(const Eigen::Vector3d &point) const { return look(point).distance; }
  /// Spreads the clearances of `contacts` over the body, as heat from them.
  void learn(const std::vector<Contact> &contacts);
  /// From now on it reaches as far as these, at least one, which lie outside the body, by a tube of `radius` (m) from the body to
  /// each.
  void reach(const std::vector<Contact> &contacts, double radius);
  /// m, about: how far inside the bound a point is.
  double inside(const Eigen::Vector3d &point) const;

private:
  struct Look {
    double distance;      ///< m, negative inside
    ClosestPoint on_body; ///< the nearest place on it
    LegGap::Side side;    ///< of the gap
    bool in_gap;          ///< the gap is nearer
  };
  Look look(const Eigen::Vector3d &point) const;
  double clearance_at(const ClosestPoint &on_body) const;
  double inside_clearance(const Eigen::Vector3d &point) const;

  Mesh body_;
  RayScene scene_;
  LegGap gap_;
  Vertices normals_;
  Eigen::VectorXd clearance_;     // (V) m
  std::optional<RayScene> lines_; // the tubes' middles
  double radius_ = 0;             // m
};

} // namespace doublet::detail
