// A TOML table a camera: anipose, Pose2Sim, Caliscope. The only file that includes toml++.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <toml++/toml.h>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;

toml::table parse(const fs::path &path) {
  const std::string text = read_text(path);
  require_shallow(text, Markup::Toml, path.string());
  try {
    return toml::parse(text);
  } catch (const toml::parse_error &e) {
    throw Error(path.string() + ": expected TOML, found a syntax error at line " + std::to_string(e.source().begin.line) + " (" +
                std::string(e.description()) + ")");
  }
}

/// Numbers of a list, or of a list of lists; empty if anything in it is no number.
std::vector<double> numbers(const toml::node *node) {
  std::vector<double> result;
  const toml::array *list = node ? node->as_array() : nullptr;
  if (!list)
    return {};
  for (const toml::node &element : *list) {
    if (const auto number = element.value<double>()) {
      result.push_back(*number);
      continue;
    }
    const toml::array *row = element.as_array();
    if (!row)
      return {};
    for (const toml::node &entry : *row) {
      const auto number = entry.value<double>();
      if (!number)
        return {};
      result.push_back(*number);
    }
  }
  return result;
}

std::vector<double> required(const toml::table &table, const char *key, std::size_t count, std::size_t or_count,
                             const std::string &where) {
  const std::vector<double> found = numbers(table.get(key));
  if (found.size() != count && found.size() != or_count)
    throw Error(where + ": expected " + key + " to be " + std::to_string(count) +
                (or_count == count ? std::string() : " or " + std::to_string(or_count)) + " numbers, found " +
                (found.empty() ? std::string("none") : std::to_string(found.size())));
  return found;
}

CalibratedCamera camera_in(const toml::table &table, const std::string &key, ImageSize size, const fs::path &source) {
  CalibratedCamera result;
  result.camera.name = table["name"].value_or(key);
  const std::string where = source.string() + ": camera '" + result.camera.name + "'";
  result.camera.K = matrix_from(required(table, "matrix", 9, 9, where));
  result.camera.R = rotation_from(required(table, "rotation", 3, 9, where));
  result.camera.t = Eigen::Vector3d(required(table, "translation", 3, 3, where).data());
  if (table.contains("distortions"))
    set_distortion(result, numbers(table.get("distortions")), table["fisheye"].value_or(false), where + ": distortions");
  set_size(result, chosen_size(size_from(numbers(table.get("size"))), size, where));
  return result;
}

/// What was not found is left out, or is an empty list, or the word null.
bool is_there(const toml::table &table, const char *key) {
  const toml::node *node = table.get(key);
  const toml::array *list = node ? node->as_array() : nullptr;
  return node && (list ? !list->empty() : node->value_or(std::string()) != "null");
}

struct Entry {
  std::string key;
  const toml::table *table;
};

/// Tables of cameras in the order of the file, which a toml::table does not keep.
std::vector<Entry> camera_tables(const toml::table &file) {
  const toml::table *inner = file["cameras"].as_table(); // of later Caliscope
  std::vector<Entry> entries;
  for (const toml::table *tables : {&file, inner})
    if (tables)
      for (const auto &[key, node] : *tables)
        if (const toml::table *table = node.as_table(); table && table->contains("matrix") && !(*table)["ignore"].value_or(false))
          entries.push_back({std::string(key.str()), table});
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry &a, const Entry &b) { return a.table->source().begin.line < b.table->source().begin.line; });
  return entries;
}

} // namespace

std::vector<CalibratedCamera> read_toml_calibration(const fs::path &path, ImageSize size, std::vector<std::string> &left_out) {
  const toml::table file = parse(path);
  std::vector<CalibratedCamera> cameras;
  const std::vector<Entry> entries = camera_tables(file);
  for (const auto &[key, table] : entries) {
    if (is_there(*table, "rotation") || is_there(*table, "translation"))
      cameras.push_back(camera_in(*table, key, size, path));
    else
      left_out.push_back("camera '" + (*table)["name"].value_or(key) +
                         "' has no rotation and translation (its pose was not found)");
  }
  if (cameras.empty() && !entries.empty())
    throw Error(path.string() + ": expected cameras with rotation and translation, found intrinsics alone; calibrate the "
                                "extrinsics, too");
  if (cameras.empty())
    throw Error(path.string() + ": expected tables with matrix, distortions, rotation and translation, found none");
  return cameras;
}

} // namespace doublet::detail
