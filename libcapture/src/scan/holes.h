#pragma once
#include "doublet/capture/template_builder.h"

namespace doublet::detail {

/// A connected part of the reconstruction with no scan near it.
struct HolePatch {
  std::vector<int> faces;
  std::vector<int> wide_faces; ///< those of `faces` that are not in a fold narrower than TemplateOptions::narrow_hole
  double area = 0;             ///< m^2
  int borders = 0;             ///< boundary loops longer than 0.1 m (a wrist is 0.15 m around)
};

/// Finds the parts of the closed `surface` (density as Poisson gave it, NaN = none) that lie over holes of `scan`, largest first.
std::vector<HolePatch> find_holes(const Mesh &surface, const Eigen::VectorXd &density, const Mesh &scan,
                                  const TemplateOptions &options, const Context &context);

/// Is the patch to be suggested as semantically invalid?
bool is_large(const HolePatch &patch, const TemplateOptions &options);

/// Replaces the inside of the patches by the membrane spanned by their borders (the discrete harmonic surface, uniform weights):
/// Poisson lets a sheet that no scan point holds bulge.
void flatten(Mesh &surface, const std::vector<HolePatch> &patches);

} // namespace doublet::detail
