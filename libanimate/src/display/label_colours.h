#pragma once
// What colours body and garment have around each place of a surface.

#include "doublet/animate/texture_baker.h"

#include <vector>

namespace doublet::detail {

/// Of each face, its own label's colours in the surface within 20 cm.
class LabelColours {
public:
  /// `seen` (F): colour_bin() of all that was seen of each face.
  LabelColours(const Mesh &mesh, const std::vector<SurfaceLabel> &face_labels, const std::vector<std::vector<int>> &seen,
               const Context &context);

  /// Is all but 5 % of the label's surface around the face of likelier colours? Not where none of it was seen.
  bool rare(int face, int bin) const;
  /// Is a colour at least three times likelier around `other`, of that face's label, than around `face`?
  bool likelier(int bin, int other, int face) const;

private:
  /// Of a label in a cube of the surface, which its faces share.
  struct Place {
    SurfaceLabel label;
    Eigen::Vector3d centre;
    Eigen::VectorXf likelihoods; ///< (colour_bin_count()); empty = nothing was seen
    float rare = 0;              ///< likelihood that rare colours are below
  };
  void find_places(const Vertices &centres, const std::vector<SurfaceLabel> &face_labels);

  std::vector<Place> places_;
  std::vector<int> place_; ///< (F)
};

} // namespace doublet::detail
