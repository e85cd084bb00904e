#pragma once
// Manual corrections, in files beside the results, which they override (docs/formats.md).

#include "doublet/core/stage_values.h"
#include "doublet/files/files.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace doublet {

inline constexpr const char *kSuggestedMask = "template_suggestion.npz", *kEditedMask = "template_mask.npz";
inline constexpr const char *kPaint = "segmentation_paint.npz", *kFoundSegmentation = "segmentation_found.npz";

/// (F) for the template in `out`, 0 = suggested as invalid.
Mask read_suggested_mask(const Path &out);
/// (F) the edited mask if there is one, else the suggestion. Throws Error naming the file if the mask does not fit the template.
Mask read_template_mask(const Path &out);
/// Writes the edited mask for the template in `out`. Throws std::invalid_argument unless it has F values of 0 or 1.
void write_template_mask(const Path &out, const Mask &mask);

/// (V) CorrectionLabels, -1 to 2; none if nothing was painted. Throws Error naming the file if it belongs to another template.
std::optional<Eigen::VectorXi> read_segmentation_paint(const Path &out, Eigen::Index vertices);
/// Throws std::invalid_argument unless there is a CorrectionLabel for each vertex.
void write_segmentation_paint(const Path &out, const Eigen::VectorXi &painted, Eigen::Index vertices);
/// The segmentation without corrections.
Segmentation read_found_segmentation(const Path &out);

} // namespace doublet
