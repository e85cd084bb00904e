// The model file: read, check, dequantise (docs/body-model.md).
#include "doublet/core/error.h"
#include "skinned_body_model.h"

#include <cmath>
#include <cstdio>

namespace doublet {
namespace {

constexpr int kFormat = 1;

/// (n, k) from an array (k, ...) of n values each, times scale[k].
MatrixRM columns(const Npz &file, const std::string &name, int n, int k, const std::vector<double> &scale = {}) {
  const std::vector<double> values = file.values(name);
  MatrixRM result = Eigen::Map<const MatrixRM>(values.data(), k, n).transpose();
  for (int c = 0; c < k && !scale.empty(); ++c)
    result.col(c) *= scale[c];
  if (!result.allFinite())
    file.reject("array '" + name + "' holds values that are not finite");
  return result;
}

MatrixRM dense_weights(const Npz &file, int vertices, int joints) {
  const auto shape = file.shape("skin_indices");
  if (shape.size() != 2 || shape[0] != vertices)
    file.reject("array 'skin_indices': expected shape (" + std::to_string(vertices) + ", n)");
  file.require_shape("skin_weights", shape);
  const std::vector<int> indices = file.integers("skin_indices");
  const std::vector<double> values = file.values("skin_weights");
  MatrixRM weights = MatrixRM::Zero(vertices, joints);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < 0 || indices[i] >= joints)
      file.reject("array 'skin_indices': joint " + std::to_string(indices[i]) + " of " + std::to_string(joints));
    weights(static_cast<long>(i) / shape[1], indices[i]) += values[i];
  }
  for (int v = 0; v < vertices; ++v) {
    const double sum = weights.row(v).sum();
    if (!(sum > 0.5 && weights.row(v).minCoeff() >= 0))
      file.reject("array 'skin_weights': row " + std::to_string(v) + " is not a set of weights");
    weights.row(v) /= sum;
  }
  return weights;
}

void check_topology(const Npz &file, const SkinnedBodyData &data) {
  const int vertices = static_cast<int>(data.mean.rows());
  if (data.faces.rows() == 0 || data.faces.minCoeff() < 0 || data.faces.maxCoeff() >= vertices)
    file.reject("array 'faces': expected indices in [0, " + std::to_string(vertices) + ")");
  for (std::size_t j = 0; j < data.joint_parents.size(); ++j)
    if (j == 0 ? data.joint_parents[j] != -1 : data.joint_parents[j] < 0 || data.joint_parents[j] >= static_cast<int>(j))
      file.reject("array 'joint_parents': expected -1 first and then parents before children, found " +
                  std::to_string(data.joint_parents[j]) + " at " + std::to_string(j));
  for (const auto &[name, vertex] : data.landmarks)
    if (vertex < 0 || vertex >= vertices)
      file.reject("array 'landmark_indices': landmark '" + name + "' is vertex " + std::to_string(vertex));
}

} // namespace

/// FNV-1a over names and contents, so that the name tells two models apart whatever the zip around them.
std::string content_hash(const Npz &file) {
  std::uint64_t hash = 1469598103934665603ull;
  auto mix = [&](const void *data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      hash = (hash ^ static_cast<const unsigned char *>(data)[i]) * 1099511628211ull;
  };
  for (const auto &[name, array] : file.arrays) {
    mix(name.data(), name.size());
    mix(array.bytes.data(), array.bytes.size());
    for (const std::string &text : array.strings)
      mix(text.data(), text.size());
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

SkinnedBodyData read_body_data(const std::filesystem::path &path) {
  const Npz file = Npz::read(path);
  const std::vector<int> format = file.integers("body_model_format");
  if (format.size() != 1 || format[0] != kFormat)
    file.reject("expected body model format " + std::to_string(kFormat) + ", found " +
                (format.empty() ? std::string("nothing") : std::to_string(format[0])));
  const auto shape = file.shape("components_q");
  if (shape.size() != 3 || shape[2] != 3)
    file.reject("array 'components_q': expected shape (K, V, 3)");
  const int k = static_cast<int>(shape[0]), v = static_cast<int>(shape[1]);
  SkinnedBodyData data;
  file.require_shape("mean", {v, 3});
  file.require_shape("component_scale", {k});
  file.require_shape("faces", {-1, 3});
  data.mean = file.matrix("mean");
  data.shape = columns(file, "components_q", 3 * v, k, file.values("component_scale"));
  data.faces = file.matrix("faces").cast<int>();
  data.joint_names = file.text("joint_names");
  const int j = static_cast<int>(data.joint_names.size());
  file.require_shape("joint_parents", {j});
  data.joint_parents = file.integers("joint_parents");
  file.require_shape("joint_mean", {j, 3});
  data.joint_mean = file.matrix("joint_mean");
  file.require_shape("joint_components", {k, j, 3});
  data.joint_shape = columns(file, "joint_components", 3 * j, k);
  data.weights = dense_weights(file, v, j);
  file.require_shape("pose_mean", {3 * j});
  const std::vector<double> pose_mean = file.values("pose_mean");
  data.pose_mean = Eigen::Map<const Eigen::VectorXd>(pose_mean.data(), 3 * j);
  file.require_shape("pose_components", {-1, 3 * j});
  data.pose = columns(file, "pose_components", 3 * j, static_cast<int>(file.shape("pose_components")[0]));
  const std::vector<std::string> names = file.text("landmark_names");
  file.require_shape("landmark_indices", {static_cast<std::int64_t>(names.size())});
  const std::vector<int> indices = file.integers("landmark_indices");
  for (std::size_t i = 0; i < names.size(); ++i)
    data.landmarks[names[i]] = indices[i];
  if (!data.mean.allFinite() || !data.joint_mean.allFinite() || !data.pose_mean.allFinite())
    file.reject("arrays 'mean', 'joint_mean', 'pose_mean' must be finite");
  check_topology(file, data);
  const std::vector<std::string> name = file.text("name");
  data.name = (name.empty() ? std::string("body") : name[0]) + " " + content_hash(file);
  return data;
}

std::shared_ptr<const BodyModel> BodyModel::read(const std::filesystem::path &path) {
  if (path.extension() == ".pkl")
    throw Error(path.string() +
                ": expected an .npz file, found a Python pickle, which runs code when it is read: convert it with "
                "numpy.savez where you trust it (docs/body-model.md)");
  const bool own = Npz::read(path, {"body_model_format"}).has("body_model_format");
  return std::make_shared<SkinnedBodyModel>(own ? read_body_data(path) : read_smpl_data(path));
}

} // namespace doublet
