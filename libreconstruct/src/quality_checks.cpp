#include "doublet/reconstruct/quality_checks.h"

#include "json.h"

#include <array>
#include <limits>

namespace doublet {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The seven sessions of docs/results.md have 1.0 to 1.5 mm, 0.97 to 0.98, 0.8 to 2 mm, 0.00 to 0.17, 1.5 to 2.0 mm, 3.0 to 3.4
/// and 0.87 to 0.91.
constexpr std::array kLimits{
    Limit{"template", "template_valid_to_scan_mean_mm", 5, 30, "mean distance of the template to the scan, mm",
          "look at template.ply"},
    Limit{"performance", "silhouette_iou_against_measured_masks", 0.85, 0.6,
          "overlap of the tracked surface with the silhouettes",
          "see the overlays in the report: calibration, silhouettes or frame rate may be wrong"},
    Limit{"segment", "noise_mm", 3, kNever, "noise of the captured surface (10 % quantile of its deviation), mm",
          "few cameras or a rough scan? check the segmentation"},
    Limit{"segment", "uncertain_area", 0.2, kNever, "share of the surface whose probability of being cloth is from 0.1 to 0.9",
          "look at the segmentation, and paint what is wrong (doublet edit-segmentation)"},
    Limit{"body", "residual_mm", 20, 80, "mean distance of the skin to the body, mm",
          "the marked joints or the units may be wrong"},
    Limit{"body", "largest_coefficient", 5, 8, "largest coefficient of the body, standard deviations of people",
          "no person has such a shape or pose; check the joints, and whether the scan's limbs have grown together"},
    Limit{"character", "overlap_of_character", 0.8, 0.75, "overlap of the simulated character with the silhouettes",
          "it does not move as in the video; check the segmentation and the body"},
};

bool is_low(const Limit &limit) {
  return limit.impossible < limit.doubtful;
}

} // namespace

std::string Limit::expected() const {
  return std::string("expected ") + (is_low(*this) ? "at least " : "at most ") + options::to_text(doubtful, 6);
}

std::optional<Finding> Limit::check(double value) const {
  const auto is_beyond = [&](double bound) { return is_low(*this) ? value < bound : value > bound; };
  if (!is_beyond(doubtful))
    return std::nullopt;
  return Finding{is_beyond(impossible),
                 std::string(meaning) + ": " + expected() + ", found " + options::to_text(value, 3) + "; " + advice, number};
}

std::string Limit::passed(double value) const {
  return check(value) ? "" : std::string(meaning) + ": " + options::to_text(value, 3) + " (" + expected() + ")";
}

std::span<const Limit> quality_limits() {
  return kLimits;
}

std::vector<Finding> quality_findings(const std::string &stage, const std::string &summary) {
  try {
    const detail::Json numbers = detail::Json::parse(summary);
    std::vector<Finding> found;
    for (const detail::Json &entry : numbers.value("findings", detail::Json::array()))
      found.push_back({entry.at("impossible"), entry.at("text"), entry.value("kind", "")});
    for (const Limit &limit : kLimits)
      if (stage == limit.stage && numbers.contains(limit.number) && !numbers.at(limit.number).is_null())
        if (auto finding = limit.check(numbers.at(limit.number)))
          found.push_back(*finding);
    return found;
  } catch (const detail::Json::exception &error) {
    throw Error(stage + ": expected a summary of numbers, found others (" + error.what() + ")");
  }
}

std::string findings_to_json(const std::vector<Finding> &findings) {
  return detail::text_of(detail::to_json(findings));
}

} // namespace doublet
