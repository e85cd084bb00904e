#pragma once
// What is known of the skin under a garment: that it goes on beyond the garment's edge.

#include "doublet/animate/character.h"

#include <vector>

namespace doublet::detail {

constexpr double kGamma = 2.2; // about that of sRGB, which images are in

/// (VH) m from each vertex of M_high's skin to the garment's free edges, such as a hem; infinite on the garment, and where an
/// edge that it hangs by is nearer. All infinite without a garment.
std::vector<double> beyond_free_edges(const Character &character);

/// Vertices of M_high's skin, loop by loop, where the scan ends beside the garment's free edges and the body goes on. `away` from
/// beyond_free_edges().
std::vector<std::vector<Eigen::Vector3d>> seams_beside(const Character &character, const std::vector<double> &away);

/// (VH) m from each vertex of M_high's skin to those seams; infinite far from the free edges.
std::vector<double> from_the_seam(const Character &character, const std::vector<double> &away);

/// What the hidden body looks like in all likelihood. Beside each seam where the scan ends under a free edge of the garment it is
/// as what the scan shows there, of bare legs or leggings below a hem, of arms below a sleeve; between seams it goes over.
class HiddenSkin {
public:
  /// Sets body_colour, of all seams together. `away` from beyond_free_edges().
  HiddenSkin(Character &character, const std::vector<double> &away, const TexCoords &texcoords, const Image &image);

  /// False, and body_colour as it was, where the scan shows next to nothing.
  bool is_known() const { return is_known_; }

  struct Here {
    double distance;        ///< m to the next seam; infinite without one
    Eigen::Vector3d colour; ///< B G R in [0, 255]
  };
  Here at(const Eigen::Vector3d &point) const;

private:
  struct Seam {
    std::vector<Eigen::Vector3d> points;
    Eigen::Vector3d colour;
  };
  std::vector<Seam> seams_;
  Eigen::Vector3d colour_ = Eigen::Vector3d::Zero();
  bool is_known_ = false;

  std::size_t nearest_seam(const Eigen::Vector3d &at) const;
};

} // namespace doublet::detail
