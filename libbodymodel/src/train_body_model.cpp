#include "doublet/bodymodel/train_body_model.h"

#include "doublet/core/error.h"
#include "doublet/core/skeleton.h"
#include "doublet/core/skinning.h"
#include "doublet/files/npz.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <stdexcept>

namespace doublet {
namespace {

/// The arrays of population.npz that training needs. M meshes of N individuals, V vertices, J joints.
struct Population {
  int meshes = 0, vertices = 0, joints = 0, individuals = 0;
  std::vector<int> individual;          ///< (M)
  MatrixRM weights;                     ///< (V, J)
  std::vector<int> parents;             ///< (J)
  std::vector<std::string> joint_names; ///< (J)
  std::vector<double> rest_joints;      ///< (N, J, 3) m
  std::vector<double> root;             ///< (M, J, 3) m, posed joints; only the root's are used
  std::vector<double> angles;           ///< (M, J, 3) rad
  std::vector<double> quantised;        ///< (M, V, 3)
  double scale = 1;
  Eigen::RowVector3d offset;
};

Population read_population(const Npz &file) {
  Population p;
  const auto shape = file.shape("vertices_q");
  if (shape.size() != 3 || shape[2] != 3 || shape[0] < 2)
    throw Error(file.source + ": array 'vertices_q': expected shape (meshes >= 2, vertices, 3)");
  p.meshes = static_cast<int>(shape[0]);
  p.vertices = static_cast<int>(shape[1]);
  p.joint_names = file.text("joint_names");
  p.joints = static_cast<int>(p.joint_names.size());
  file.require_shape("mesh_individual", {p.meshes});
  p.individual = file.integers("mesh_individual");
  file.require_shape("skin_weights", {p.vertices, p.joints});
  p.weights = file.matrix("skin_weights");
  file.require_shape("joint_parents", {p.joints});
  p.parents = file.integers("joint_parents");
  file.require_shape("ind_rest_joints", {-1, p.joints, 3});
  p.individuals = static_cast<int>(file.shape("ind_rest_joints")[0]);
  p.rest_joints = file.values("ind_rest_joints");
  file.require_shape("joints", {p.meshes, p.joints, 3});
  p.root = file.values("joints");
  file.require_shape("joint_rotvec", {p.meshes, p.joints, 3});
  p.angles = file.values("joint_rotvec");
  p.quantised = file.values("vertices_q");
  const std::vector<double> scale = file.values("vertex_scale");
  if (scale.size() != 1 || !(scale[0] > 0))
    throw Error(file.source + ": array 'vertex_scale': expected one number > 0");
  p.scale = scale[0];
  file.require_shape("faces", {-1, 3});
  if (p.joints < 2 || p.joints > 256) // with a root alone there are no poses to learn
    throw Error(file.source + ": array 'joint_names': expected 2 to 256 joints, found " + std::to_string(p.joints));
  file.require_shape("vertex_offset", {3});
  const auto offset = file.values("vertex_offset");
  p.offset << offset[0], offset[1], offset[2];
  for (int j = 0; j < p.joints; ++j)
    if (j == 0 ? p.parents[j] != -1 : p.parents[j] < 0 || p.parents[j] >= j)
      throw Error(file.source + ": array 'joint_parents': expected -1 first and then parents before children");
  for (int individual : p.individual)
    if (individual < 0 || individual >= p.individuals)
      throw Error(file.source + ": array 'mesh_individual': individual " + std::to_string(individual) + " of " +
                  std::to_string(p.individuals));
  for (int v = 0; v < p.vertices; ++v)
    p.weights.row(v) /= p.weights.row(v).sum();
  if (!p.weights.allFinite())
    throw Error(file.source + ": array 'skin_weights': a row has no weights");
  return p;
}

Eigen::Vector3d triple(const std::vector<double> &values, std::size_t index) {
  return {values[3 * index], values[3 * index + 1], values[3 * index + 2]};
}

Transforms posed_bones(const Population &p, int mesh) {
  Transforms bones(p.joints);
  const std::size_t person = static_cast<std::size_t>(p.individual[mesh]) * p.joints,
                    pose = static_cast<std::size_t>(mesh) * p.joints;
  for (int j = 0; j < p.joints; ++j) {
    const Eigen::Vector3d rest = triple(p.rest_joints, person + j);
    const int parent = p.parents[j];
    const Eigen::Matrix3d above =
        parent < 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : Eigen::Matrix3d(bones[parent].linear());
    const Eigen::Vector3d position = parent < 0 ? triple(p.root, pose) : Eigen::Vector3d(bones[parent] * rest);
    bones[j] = Eigen::Isometry3d::Identity();
    bones[j].linear() = above * rotation_from_vector(triple(p.angles, pose + j));
    bones[j].translation() = position - bones[j].linear() * rest;
  }
  return bones;
}

/// One row of the data matrix: rest vertices, then rest joints, root joint at the origin.
Eigen::RowVectorXd unposed(const Population &p, int mesh) {
  const Transforms skin = dual_quaternion_blend(p.weights, posed_bones(p, mesh));
  const std::size_t person = static_cast<std::size_t>(p.individual[mesh]) * p.joints;
  const Eigen::Vector3d root = triple(p.rest_joints, person);
  Eigen::RowVectorXd row(3 * (p.vertices + p.joints));
  for (int v = 0; v < p.vertices; ++v) {
    const Eigen::Vector3d point =
        p.offset.transpose() + p.scale * triple(p.quantised, static_cast<std::size_t>(mesh) * p.vertices + v);
    row.segment<3>(3 * v) = (skin[v].inverse() * point - root).transpose();
  }
  for (int j = 0; j < p.joints; ++j)
    row.segment<3>(3 * (p.vertices + j)) = (triple(p.rest_joints, person + j) - root).transpose();
  return row;
}

struct Components {
  Eigen::RowVectorXd mean;
  MatrixRM rows; ///< (K, n) per standard deviation
  double kept = 0, error = 0;
};

/// Principal components through the Gram matrix of the centred rows, which is small (Turk & Pentland 1991).
Components principal_components(MatrixRM data, int count, int vertices) {
  Components result;
  const int meshes = static_cast<int>(data.rows());
  result.mean = data.colwise().mean();
  data.rowwise() -= result.mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(data * data.transpose());
  const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0.0);
  const Eigen::MatrixXd vectors = solver.eigenvectors().rowwise().reverse();
  const int rank = static_cast<int>((values.array() > 1e-12 * values[0]).count());
  count = std::min({count, meshes - 1, rank});
  // row k of U^T X has norm sqrt(lambda_k); the deviation along it is sqrt(lambda_k / (M - 1)).
  result.rows = vectors.leftCols(count).transpose() * data / std::sqrt(meshes - 1.0);
  for (int k = 0; k < count; ++k) {
    int largest;
    result.rows.row(k).cwiseAbs().maxCoeff(&largest);
    if (result.rows(k, largest) < 0)
      result.rows.row(k) *= -1;
  }
  result.kept = values.head(count).sum() / std::max(values.sum(), 1e-300);
  const MatrixRM basis = vectors.leftCols(count);
  const MatrixRM rest = data - basis * (basis.transpose() * data);
  for (int m = 0; m < meshes; ++m)
    result.error += Eigen::Map<const Vertices>(rest.row(m).data(), vertices, 3).rowwise().norm().mean() / meshes;
  return result;
}

/// Poses of the chosen meshes: mean and whitened components (P, 3J), P = 3 (J - 1); the floor keeps every direction possible.
void pose_components(const Population &p, const std::vector<int> &meshes, double floor, Eigen::RowVectorXd &mean,
                     MatrixRM &components) {
  const int n = 3 * p.joints;
  MatrixRM poses(meshes.size(), n);
  for (std::size_t m = 0; m < meshes.size(); ++m)
    poses.row(m) = Eigen::Map<const Eigen::RowVectorXd>(p.angles.data() + static_cast<std::size_t>(meshes[m]) * n, n);
  mean = poses.colwise().mean();
  mean.head<3>().setZero();
  poses.rowwise() -= mean;
  const MatrixRM free = poses.rightCols(n - 3);
  const Eigen::MatrixXd covariance = free.transpose() * free / std::max<double>(meshes.size() - 1.0, 1.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  components = MatrixRM::Zero(n - 3, n);
  for (int k = 0; k < n - 3; ++k) {
    const int from = n - 4 - k;
    const double deviation = std::sqrt(std::max(solver.eigenvalues()[from], 0.0) + floor * floor);
    components.row(k).tail(n - 3) = deviation * solver.eigenvectors().col(from).transpose();
  }
}

template <typename Number>
NpyArray array_of(const std::string &type, std::vector<std::int64_t> shape, const std::vector<Number> &values) {
  NpyArray array;
  array.type = type;
  array.shape = std::move(shape);
  array.bytes.resize(values.size() * sizeof(Number));
  std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

void store_components(Npz &file, const Components &components, int vertices, int joints) {
  const int count = static_cast<int>(components.rows.rows());
  std::vector<std::int16_t> quantised;
  std::vector<double> scale, joint_rows;
  quantised.reserve(static_cast<std::size_t>(count) * vertices * 3);
  for (int k = 0; k < count; ++k) {
    const auto row = components.rows.row(k);
    const double step = row.head(3 * vertices).cwiseAbs().maxCoeff() / 32767.0;
    scale.push_back(step);
    for (int i = 0; i < 3 * vertices; ++i)
      quantised.push_back(step > 0 ? static_cast<std::int16_t>(std::lround(row[i] / step)) : std::int16_t{0});
    for (int i = 0; i < 3 * joints; ++i)
      joint_rows.push_back(row[3 * vertices + i]);
  }
  file.arrays["components_q"] = array_of("i2", {count, vertices, 3}, quantised);
  file.set_f8("component_scale", {count}, scale);
  file.set_f4("joint_components", {count, joints, 3}, joint_rows);
}

void store_weights(Npz &file, const MatrixRM &weights) {
  const int most = static_cast<int>((weights.array() > 0).rowwise().count().maxCoeff());
  const int kept = std::min(most, 8); // the shipped population has at most 6 weights above 1e-4
  std::vector<std::uint8_t> indices;
  std::vector<double> values;
  for (int v = 0; v < weights.rows(); ++v) {
    std::vector<int> order(weights.cols());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return weights(v, a) > weights(v, b); });
    for (int i = 0; i < kept; ++i) {
      indices.push_back(static_cast<std::uint8_t>(order[i]));
      values.push_back(weights(v, order[i]));
    }
  }
  file.arrays["skin_indices"] = array_of("u1", {weights.rows(), kept}, indices);
  file.set_f4("skin_weights", {weights.rows(), kept}, values);
}

/// The session format's landmark names for the same points as the population's.
const std::map<std::string, std::string> kLandmarkAliases = {
    {"head_top", "crown"}, {"l_middle_fingertip", "l_middle_tip"}, {"r_middle_fingertip", "r_middle_tip"}};

void store_landmarks(Npz &file, const Npz &population) {
  std::vector<std::string> names = population.text("landmark_names");
  population.require_shape("landmark_indices", {static_cast<std::int64_t>(names.size())});
  std::vector<int> indices = population.integers("landmark_indices");
  for (const auto &[alias, name] : kLandmarkAliases) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end() && std::find(names.begin(), names.end(), alias) == names.end()) {
      indices.push_back(indices[found - names.begin()]);
      names.push_back(alias);
    }
  }
  file.set_text("landmark_names", names);
  file.set_i4("landmark_indices", {static_cast<std::int64_t>(indices.size())}, indices);
}

std::vector<double> flat(const MatrixRM &matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

} // namespace

TrainSummary train_body_model(const std::filesystem::path &population_path, const std::filesystem::path &out,
                              const TrainOptions &options, const Context &context) {
  options.validate();
  context.report_progress("train body", 0.0);
  Npz population_file = Npz::read(population_path);
  Population population = read_population(population_file);
  population_file.arrays.erase("vertices_q");
  for (const int individual : options.individuals)
    if (individual >= population.individuals) // else a list that counts from 1 leaves people out unnoticed
      throw std::invalid_argument("TrainOptions: individuals: expected numbers below " + std::to_string(population.individuals) +
                                  ", the people of " + population_file.source + ", found " + std::to_string(individual));
  std::vector<int> chosen;
  for (int m = 0; m < population.meshes; ++m)
    if (options.individuals.empty() ||
        std::count(options.individuals.begin(), options.individuals.end(), population.individual[m]))
      chosen.push_back(m);
  if (chosen.size() < 2)
    throw std::invalid_argument("TrainOptions: individuals leave " + std::to_string(chosen.size()) +
                                " meshes, expected at least 2");

  const int meshes = static_cast<int>(chosen.size()), v = population.vertices, j = population.joints;
  MatrixRM data(meshes, 3 * (v + j));
  for (int first = 0; first < meshes; first += 32) {
    context.report_progress("train body", 0.1 + 0.5 * first / meshes);
    parallel_for(context, std::min(32, meshes - first),
                 [&](int i) { data.row(first + i) = unposed(population, chosen[first + i]); });
  }
  if (!data.allFinite())
    throw Error(population_file.source + ": the meshes hold values that are not finite");
  population.quantised.clear();
  population.quantised.shrink_to_fit();
  context.report_progress("train body", 0.6);
  const Components components = principal_components(std::move(data), options.components, v);
  Eigen::RowVectorXd pose_mean;
  MatrixRM pose;
  pose_components(population, chosen, options.pose_floor, pose_mean, pose);

  Npz file;
  file.set_i4("body_model_format", {1}, {1});
  file.set_text("name", {options.name});
  file.set_text("licence", {options.licence});
  file.set_text("command", {options.command});
  const std::vector<int> faces = population_file.integers("faces");
  file.set_i4("faces", population_file.shape("faces"), faces);
  file.set_f4("mean", {v, 3}, flat(components.mean.head(3 * v)));
  file.set_f4("joint_mean", {j, 3}, flat(components.mean.tail(3 * j)));
  store_components(file, components, v, j);
  store_weights(file, population.weights);
  file.set_text("joint_names", population.joint_names);
  file.set_i4("joint_parents", {j}, population.parents);
  file.set_f4("pose_mean", {3 * j}, flat(pose_mean));
  file.set_f4("pose_components", {pose.rows(), 3 * j}, flat(pose));
  store_landmarks(file, population_file);
  file.write(out);
  context.report_progress("train body", 1.0);
  return {meshes, v, static_cast<int>(components.rows.rows()), components.kept, 1000 * components.error};
}

} // namespace doublet
