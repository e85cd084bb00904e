#include "doublet/reconstruct/corrections_file.h"

#include "doublet/core/error.h"
#include "doublet/files/hash.h"
#include "doublet/files/npz.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace doublet {

namespace {

constexpr const char *kTemplate = "template.ply";

/// Empty, or what is wrong with a mask of so many triangles.
std::string mask_fault(const std::vector<int> &mask, std::size_t count) {
  if (mask.size() != count)
    return std::to_string(mask.size()) + " values, not one for each of " + std::to_string(count) + " triangles";
  if (!std::all_of(mask.begin(), mask.end(), [](int value) { return value == 0 || value == 1; }))
    return "values that are neither 0 nor 1";
  return std::find(mask.begin(), mask.end(), 1) == mask.end() ? "no valid triangle" : "";
}

std::string paint_fault(const std::vector<int> &painted, Eigen::Index count) {
  if (static_cast<Eigen::Index>(painted.size()) != count)
    return std::to_string(painted.size()) + " values, not one for each of " + std::to_string(count) + " vertices";
  const bool known = std::all_of(painted.begin(), painted.end(), [](int value) { return value >= -1 && value <= 2; });
  return known ? "" : "values that are none of -1 (as found), 0 (skin), 1 (cloth) and 2 (border)";
}

/// Whole numbers and bools as they are, others if they are whole.
std::vector<int> whole_numbers(const Npz &npz, const std::string &name) {
  std::vector<int> whole;
  for (const double value : npz.values(name))
    whole.push_back(value == std::clamp(value, -1e6, 1e6) && value == static_cast<int>(value) ? static_cast<int>(value) : -1000);
  return whole;
}

/// Throws Error if `npz` says that it was made for another template than the one in `out`.
void require_this_template(const Npz &npz, const Path &out, const Path &file) {
  if (!npz.has("template") || !std::filesystem::exists(out / kTemplate))
    return;
  const std::vector<std::string> made_for = npz.text("template");
  if (made_for.size() != 1 || made_for[0] != hash_files(out / kTemplate))
    throw Error(file.string() + " was made for another template.ply than the one beside it; delete it or paint it again");
}

void write_for_template(Npz &npz, const Path &out, const Path &file) {
  if (std::filesystem::exists(out / kTemplate)) {
    npz.set_text("template", {hash_files(out / kTemplate)});
    npz.arrays.at("template").shape.clear(); // one text, not a list of one
  }
  npz.write(file);
}

} // namespace

std::vector<std::uint8_t> read_suggested_mask(const Path &out) {
  const std::vector<int> mask = Npz::read(out / kSuggestedMask, {"face_valid"}).integers("face_valid");
  return {mask.begin(), mask.end()};
}

std::vector<std::uint8_t> read_template_mask(const Path &out) {
  const std::vector<std::uint8_t> suggested = read_suggested_mask(out);
  const Path file = out / kEditedMask;
  if (!std::filesystem::exists(file))
    return suggested;
  const Npz npz = Npz::read(file, {"face_valid", "template"});
  const std::vector<int> mask = whole_numbers(npz, "face_valid");
  if (const std::string fault = mask_fault(mask, suggested.size()); !fault.empty())
    throw Error(file.string() + ": expected a mask of the template's " + std::to_string(suggested.size()) + " triangles, as " +
                kSuggestedMask + " beside it has them, found " + fault);
  require_this_template(npz, out, file);
  return {mask.begin(), mask.end()};
}

void write_template_mask(const Path &out, const std::vector<std::uint8_t> &mask) {
  const std::string fault = mask_fault({mask.begin(), mask.end()}, read_suggested_mask(out).size());
  if (!fault.empty())
    throw std::invalid_argument(fault);
  Npz npz;
  npz.set_b1("face_valid", mask);
  write_for_template(npz, out, out / kEditedMask);
}

std::optional<Eigen::VectorXi> read_segmentation_paint(const Path &out, Eigen::Index vertices) {
  const Path file = out / kPaint;
  if (!std::filesystem::exists(file))
    return std::nullopt;
  const Npz npz = Npz::read(file, {"painted", "template"});
  const std::vector<int> painted = whole_numbers(npz, "painted");
  if (const std::string fault = paint_fault(painted, vertices); !fault.empty())
    throw Error(file.string() + ": expected what was painted on the template's vertices, found " + fault);
  require_this_template(npz, out, file);
  return Eigen::VectorXi::Map(painted.data(), vertices);
}

void write_segmentation_paint(const Path &out, const Eigen::VectorXi &painted, Eigen::Index vertices) {
  const std::vector<int> values(painted.begin(), painted.end());
  if (const std::string fault = paint_fault(values, vertices); !fault.empty())
    throw std::invalid_argument(fault);
  Npz npz;
  npz.set_i4("painted", {vertices}, values);
  write_for_template(npz, out, out / kPaint);
}

Segmentation read_found_segmentation(const Path &out) {
  return read_segmentation(std::filesystem::exists(out / kFoundSegmentation) ? out / kFoundSegmentation
                                                                             : out / "segmentation.npz");
}

} // namespace doublet
