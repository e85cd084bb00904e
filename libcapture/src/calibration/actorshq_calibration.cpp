// calibration.csv of ActorsHQ (Isik et al. 2023): a line a camera; focal lengths and centre are shares of the image's size.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;

/// What stands between commas, without the blanks around it.
std::vector<std::string> cells_of(const std::string &line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) {
    const std::size_t begin = std::min(cell.find_first_not_of(" \t\r"), cell.size());
    cells.push_back(cell.substr(begin, cell.find_last_not_of(" \t\r") + 1 - begin));
  }
  return cells;
}

/// A line below the names of the columns.
class Row {
public:
  Row(const std::vector<std::string> &columns, const std::vector<std::string> &cells, std::string where)
      : where_(std::move(where)) {
    if (cells.size() != columns.size())
      throw Error(where_ + ": expected " + std::to_string(columns.size()) + " cells as the first line has, found " +
                  std::to_string(cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i)
      cells_[columns[i]] = cells[i];
  }
  const std::string &text(const std::string &column) const {
    const auto found = cells_.find(column);
    if (found == cells_.end())
      throw Error(where_ + ": expected a column \"" + column + "\", found none");
    return found->second;
  }
  double number(const std::string &column) const {
    const std::optional<double> value = parse_number(text(column));
    if (!value)
      throw Error(where_ + ": expected " + column + " to be a number, found '" + text(column) + "'");
    return *value;
  }
  double number_or_none(const std::string &column) const { return cells_.count(column) > 0 ? number(column) : 0; }
  const std::string &where() const { return where_; }

private:
  std::string where_;
  std::map<std::string, std::string> cells_;
};

CalibratedCamera camera_in(const Row &row) {
  CalibratedCamera result;
  Camera &camera = result.camera;
  camera.name = row.text("name");
  set_size(result, chosen_size(size_from({row.number("w"), row.number("h")}), {}, row.where()));
  const double fx = camera.width * row.number("fx"), fy = camera.height * row.number("fy");
  // Pixels have their corner, not their centre, at integers.
  const double cx = camera.width * row.number("px") - 0.5, cy = camera.height * row.number("py") - 0.5;
  camera.K << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  camera.R = rotation_from({row.number("rx"), row.number("ry"), row.number("rz")}).transpose(); // the file's is to the world
  camera.t = -camera.R * Eigen::Vector3d(row.number("tx"), row.number("ty"), row.number("tz"));
  set_distortion(result, {row.number_or_none("k1"), row.number_or_none("k2"), 0, 0, row.number_or_none("k3")}, false,
                 row.where());
  return result;
}

} // namespace

std::vector<CalibratedCamera> read_actorshq_calibration(const fs::path &path) {
  std::istringstream text(plain_text(read_text(path), path.string()));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> columns = cells_of(line);
  std::vector<CalibratedCamera> cameras;
  for (int number = 2; std::getline(text, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty() || (cells.size() == 1 && cells[0].empty()))
      continue;
    if (cameras.size() == kMostCameras)
      throw Error(path.string() + ": expected at most " + std::to_string(kMostCameras) + " cameras, found more");
    cameras.push_back(camera_in(Row(columns, cells, path.string() + ": line " + std::to_string(number))));
  }
  return cameras;
}

} // namespace doublet::detail
