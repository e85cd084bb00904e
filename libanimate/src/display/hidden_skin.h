#pragma once
// What is known of the skin under a garment: that it goes on beyond the garment's edge.

#include "doublet/animate/character.h"

#include <vector>

namespace doublet::detail {

constexpr double kGamma = 2.2; // about that of sRGB, which images are in

/// (VH) m from each vertex of M_high's skin to the garment's free edges, such as a hem; infinite on the garment, and where an
/// edge that it hangs by is nearer. All infinite without a garment.
std::vector<double> beyond_free_edges(const Character &character);

/// (VH) m from each vertex of M_high's skin to where the scan ends beside the garment's free edges, and the body goes on;
/// infinite far from those. `away` from beyond_free_edges().
std::vector<double> from_the_seam(const Character &character, const std::vector<double> &away);

/// Sets the colour that the hidden part of the body has in all likelihood: the median of the brighter half (a shadow only
/// darkens) of the skin within 20 cm beyond the garment's free edges, of legs below a hem. False, and as it was, where there is
/// none.
bool find_hidden_colour(Character &character, const std::vector<double> &away, const TexCoords &texcoords, const Image &image);

} // namespace doublet::detail
