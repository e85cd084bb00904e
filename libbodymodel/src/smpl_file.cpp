// Models of the SMPL family (Loper et al. 2015; SMPL-H, SMPL-X, STAR) from .npz: shape directions, joint regressor, skin weights.
// They become this library's own kind of model: shape linear, pose by their skeleton (docs/body-model.md says what is left out).
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "skinned_body_model.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

constexpr int kMostShapes = 300;      ///< SMPL-X appends 100 expressions of the face to 300 shapes
constexpr double kBodyTurn = 0.5;     ///< rad, deviation of a body joint from the rest pose, which is a T
constexpr double kDetailTurn = 0.1;   ///< rad, of fingers, jaw and eyes: a scan of a body says little about them
constexpr double kLeastStature = 0.5; ///< of the largest extent: up is the axis from pelvis to head

/// The body joints that the family shares, by this library's names where it has one.
const std::vector<std::string> kBodyJoints = {"pelvis",  "l_hip",      "r_hip",      "spine1", "l_knee",     "r_knee",
                                              "spine2",  "l_ankle",    "r_ankle",    "chest",  "l_toe",      "r_toe",
                                              "neck",    "l_clavicle", "r_clavicle", "head",   "l_shoulder", "r_shoulder",
                                              "l_elbow", "r_elbow",    "l_wrist",    "r_wrist"};

/// (J, V) from a dense array, or from the three arrays of SciPy's compressed sparse rows or columns.
MatrixRM joint_regressor(const Npz &file, int vertices) {
  if (file.has("J_regressor")) {
    file.require_shape("J_regressor", {-1, vertices});
    return file.matrix("J_regressor");
  }
  for (const char *part : {"J_regressor_data", "J_regressor_indices", "J_regressor_indptr", "J_regressor_shape"})
    if (!file.has(part))
      file.reject("expected an array 'J_regressor', dense, or 'J_regressor_data', '_indices', '_indptr' and '_shape' of a SciPy "
                  "sparse matrix; '" +
                  std::string(part) + "' is missing");
  const std::vector<double> data = file.values("J_regressor_data");
  const std::vector<int> indices = file.integers("J_regressor_indices"), starts = file.integers("J_regressor_indptr"),
                         shape = file.integers("J_regressor_shape");
  if (shape.size() != 2 || shape[0] < 1 || shape[0] > 1000 || shape[1] != vertices || indices.size() != data.size() ||
      starts.empty() || starts.front() != 0 || starts.back() != static_cast<int>(data.size()) ||
      !std::is_sorted(starts.begin(), starts.end()))
    file.reject("arrays 'J_regressor_*' are no sparse matrix of (joints, " + std::to_string(vertices) + ")");
  const int lines = static_cast<int>(starts.size()) - 1;
  const bool by_rows = lines == shape[0];
  if (!by_rows && lines != shape[1])
    file.reject("array 'J_regressor_indptr': expected one entry more than the matrix has rows or columns");
  MatrixRM matrix = MatrixRM::Zero(shape[0], shape[1]);
  for (int line = 0; line < lines; ++line)
    for (int i = starts[line]; i < starts[line + 1]; ++i) {
      if (indices[i] < 0 || indices[i] >= (by_rows ? shape[1] : shape[0]))
        file.reject("array 'J_regressor_indices': index " + std::to_string(indices[i]) + " lies outside the matrix");
      matrix(by_rows ? line : indices[i], by_rows ? indices[i] : line) += data[i];
    }
  return matrix;
}

/// kintree_table (2, J) or (J): the first row holds the parents, the root's is -1 or that as an unsigned number.
std::vector<int> parents(const Npz &file, int joints) {
  const auto shape = file.shape("kintree_table");
  const bool table = shape.size() == 2 && shape[0] == 2 && shape[1] == joints;
  if (!table && !(shape.size() == 1 && shape[0] == joints))
    file.reject("array 'kintree_table': expected shape (2, " + std::to_string(joints) + "), the joints of the regressor");
  const std::vector<double> values = file.values("kintree_table");
  std::vector<int> result(joints, -1);
  for (int j = 1; j < joints; ++j) {
    if (!(values[j] >= 0 && values[j] < j))
      file.reject("array 'kintree_table': expected parents before children, found parent " + std::to_string(values[j]) +
                  " of joint " + std::to_string(j));
    result[j] = static_cast<int>(values[j]);
  }
  return result;
}

std::vector<std::string> joint_names(const Npz &file, int joints) {
  if (file.has("joint_names")) {
    std::vector<std::string> names = file.text("joint_names");
    if (static_cast<int>(names.size()) != joints)
      file.reject("array 'joint_names': expected " + std::to_string(joints) + " names, found " + std::to_string(names.size()));
    return names;
  }
  if (joints != 24 && joints != 52 && joints != 55) // SMPL and STAR, SMPL-H, SMPL-X
    file.reject("expected 24, 52 or 55 joints, as SMPL, SMPL-H and SMPL-X have, or an array 'joint_names'; found " +
                std::to_string(joints) + " joints without names");
  std::vector<std::string> names = kBodyJoints;
  for (int j = static_cast<int>(names.size()); j < joints; ++j)
    names.push_back("detail_" + std::to_string(j));
  if (joints == 24) {
    names[22] = "l_hand";
    names[23] = "r_hand";
  }
  return names;
}

/// Rotation that brings the axis from the root to the highest end of the skeleton onto +Y: z-up files become y-up.
Eigen::Matrix3d upright(const Npz &file, const Vertices &vertices, const Vertices &joints,
                        const std::vector<std::string> &names) {
  const auto head = std::find(names.begin(), names.end(), "head");
  const Eigen::RowVector3d extent = vertices.colwise().maxCoeff() - vertices.colwise().minCoeff();
  if (!(extent.maxCoeff() > 0))
    file.reject("array 'v_template': all vertices are in one place");
  if (head == names.end())
    return Eigen::Matrix3d::Identity();
  const Eigen::RowVector3d up = joints.row(head - names.begin()) - joints.row(0);
  int axis;
  up.cwiseAbs().maxCoeff(&axis);
  if (extent[axis] < kLeastStature * extent.maxCoeff())
    file.reject("the model does not stand: its head is not above its pelvis");
  const Eigen::Vector3d from = (up[axis] > 0 ? 1 : -1) * Eigen::Vector3d::Unit(axis);
  return shortest_turn(from, Eigen::Vector3d::UnitY());
}

/// 3n x K matrix from an (n, 3, >= K) array, every direction turned.
MatrixRM turned_directions(const Npz &file, const std::string &name, int vertices, const Eigen::Matrix3d &turn) {
  file.require_shape(name, {vertices, 3, -1});
  const int all = static_cast<int>(file.shape(name)[2]), kept = std::min(all, kMostShapes);
  if (kept < 1)
    file.reject("array '" + name + "': expected at least one direction");
  const std::vector<double> values = file.values(name);
  MatrixRM result = Eigen::Map<const MatrixRM>(values.data(), 3 * vertices, all).leftCols(kept);
  for (int v = 0; v < vertices; ++v)
    result.middleRows(3 * v, 3) = (turn * result.middleRows(3 * v, 3)).eval();
  return result;
}

MatrixRM regressed(const MatrixRM &regressor, const MatrixRM &directions) {
  const int joints = static_cast<int>(regressor.rows()), shapes = static_cast<int>(directions.cols());
  const Eigen::Map<const MatrixRM> flat(directions.data(), regressor.cols(), 3 * shapes);
  const MatrixRM product = regressor * flat;
  return Eigen::Map<const MatrixRM>(product.data(), 3 * joints, shapes);
}

} // namespace

SkinnedBodyData read_smpl_data(const std::filesystem::path &path) {
  const Npz file = Npz::read(path, {"v_template", "shapedirs", "J_regressor", "J_regressor_data", "J_regressor_indices",
                                    "J_regressor_indptr", "J_regressor_shape", "weights", "kintree_table", "f", "joint_names",
                                    "landmark_names", "landmark_indices"});
  if (!file.has("v_template"))
    file.reject("is no body model: expected array 'body_model_format', or 'v_template' of the SMPL family");
  file.require_shape("v_template", {-1, 3});
  file.require_shape("f", {-1, 3});
  SkinnedBodyData data;
  data.mean = file.matrix("v_template");
  const int v = static_cast<int>(data.mean.rows());
  const std::vector<int> faces = file.integers("f");
  data.faces = Eigen::Map<const Faces>(faces.data(), faces.size() / 3, 3);
  if (faces.empty() || data.faces.minCoeff() < 0 || data.faces.maxCoeff() >= v)
    file.reject("array 'f': expected indices in [0, " + std::to_string(v) + ")");
  const MatrixRM regressor = joint_regressor(file, v);
  const int j = static_cast<int>(regressor.rows());
  data.joint_parents = parents(file, j);
  data.joint_names = joint_names(file, j);
  data.joint_mean = regressor * data.mean;
  const Eigen::Matrix3d turn = upright(file, data.mean, data.joint_mean, data.joint_names);
  data.mean = (data.mean.rowwise() - data.joint_mean.row(0)).eval() * turn.transpose();
  data.joint_mean = (data.joint_mean.rowwise() - data.joint_mean.row(0)).eval() * turn.transpose();
  data.shape = turned_directions(file, "shapedirs", v, turn);
  data.joint_shape = regressed(regressor, data.shape);
  file.require_shape("weights", {v, j});
  data.weights = file.matrix("weights").cwiseMax(0.0);
  const Eigen::VectorXd sums = data.weights.rowwise().sum();
  if (!data.weights.allFinite() || !(sums.minCoeff() > 0.5)) // NaN is no least value
    file.reject("array 'weights': a row is not a set of weights");
  data.weights.array().colwise() /= sums.array();
  if (!data.mean.allFinite() || !data.shape.allFinite() || !data.joint_shape.allFinite() || !data.joint_mean.allFinite())
    file.reject("arrays 'v_template', 'shapedirs' and 'J_regressor' must be finite");
  data.pose_mean = Eigen::VectorXd::Zero(3 * j);
  data.pose = MatrixRM::Zero(3 * j, 3 * (j - 1));
  for (int k = 0; k < 3 * (j - 1); ++k)
    data.pose(k + 3, k) = data.joint_names[k / 3 + 1].rfind("detail_", 0) == 0 ? kDetailTurn : kBodyTurn;
  if (file.has("landmark_names")) {
    const std::vector<std::string> names = file.text("landmark_names");
    file.require_shape("landmark_indices", {static_cast<std::int64_t>(names.size())});
    const std::vector<int> indices = file.integers("landmark_indices");
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (indices[i] < 0 || indices[i] >= v)
        file.reject("array 'landmark_indices': landmark '" + names[i] + "' is vertex " + std::to_string(indices[i]));
      data.landmarks[names[i]] = indices[i];
    }
  }
  data.name = path.stem().string() + " " + content_hash(file);
  return data;
}

} // namespace doublet
