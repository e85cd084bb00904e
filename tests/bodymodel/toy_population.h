#pragma once
// A population with known shape modes on the figure's skeleton: what training must recover.

#include "doublet/core/skinning.h"
#include "doublet/files/npz.h"
#include "support/figure.h"

#include <cstring>
#include <random>

namespace toy {

using namespace doublet;

constexpr int kModes = 3;
/// Standard deviations: height (relative), legs' girth (m), trunk's girth (m).
constexpr double kDeviation[kModes] = {0.04, 0.008, 0.012};

struct Body {
  RiggedMesh actor; ///< the mean in its rest pose
  Vertices joints;  ///< (J, 3)
  Vertices normals; ///< (V, 3)
  std::map<std::string, int> landmarks;
};

inline const Body &body() {
  static const Body made = [] {
    Body b{doublet::testing::figure_actor(0.04), {}, {}, {}};
    b.joints = joint_positions(b.actor.skeleton, Transforms(b.actor.skeleton.joint_count(), Eigen::Isometry3d::Identity()));
    b.normals = vertex_normals(b.actor.mesh.vertices, b.actor.mesh.faces);
    const std::map<std::string, Eigen::Vector3d> where = {{"crown", {0, 2, 0}},
                                                          {"nose_tip", {0, 1.6, 1}},
                                                          {"l_heel", {0.12, 0, -0.2}},
                                                          {"r_heel", {-0.12, 0, -0.2}},
                                                          {"l_middle_tip", {0.7, 0.8, 0.15}},
                                                          {"r_middle_tip", {-0.7, 0.8, 0.15}},
                                                          {"l_big_toe_tip", {0.13, 0, 0.3}},
                                                          {"r_big_toe_tip", {-0.13, 0, 0.3}}};
    for (const auto &[name, point] : where)
      (b.actor.mesh.vertices.rowwise() - point.transpose()).rowwise().norm().minCoeff(&b.landmarks[name]);
    return b;
  }();
  return made;
}

/// Displacement of rest vertices by mode k per unit: height scales everything, the girths move along the normal.
inline Vertices mode(int k) {
  const Vertices &v = body().actor.mesh.vertices;
  if (k == 0)
    return v;
  Vertices d = body().normals;
  for (int i = 0; i < d.rows(); ++i) {
    const double y = v(i, 1), arm = std::abs(v(i, 0)) > 0.25;
    d.row(i) *= arm ? 0 : k == 1 ? 1 / (1 + std::exp((y - 0.85) / 0.03)) : 1 / (1 + std::exp(-(y - 0.95) / 0.03));
  }
  return d;
}

struct Person {
  Vertices rest, joints;
};

inline Person person(const Eigen::Vector3d &amount) {
  Person p{body().actor.mesh.vertices, body().joints};
  for (int k = 0; k < kModes; ++k)
    p.rest += amount[k] * mode(k);
  p.joints *= 1 + amount[0];
  return p;
}

/// Rotation vectors (J, 3), the root's zero: arms swing most.
inline Vertices random_pose(std::mt19937 &random, double size) {
  std::normal_distribution<double> normal;
  Vertices angles = Vertices::Zero(body().joints.rows(), 3);
  for (int j = 1; j < angles.rows(); ++j) {
    const std::string &name = body().actor.skeleton.joints[j].name;
    const double scale = name.find("shoulder") != std::string::npos ? 0.3 : name.find("knee") != std::string::npos ? 0.05 : 0.1;
    for (int c = 0; c < 3; ++c)
      angles(j, c) = size * scale * normal(random);
  }
  return angles;
}

struct Posed {
  Vertices vertices, joints;
};

/// Skinned mesh of a person; the root stands where it rests.
inline Posed posed(const Person &p, const Vertices &angles) {
  const Skeleton &skeleton = body().actor.skeleton;
  Transforms bones(p.joints.rows());
  Posed out{{}, p.joints};
  for (int j = 0; j < p.joints.rows(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Eigen::Isometry3d above = parent < 0 ? Eigen::Isometry3d::Identity() : bones[parent];
    out.joints.row(j) = (above * p.joints.row(j).transpose()).transpose();
    bones[j] = Eigen::Isometry3d::Identity();
    bones[j].linear() = above.linear() * rotation_from_vector(angles.row(j).transpose());
    bones[j].translation() = out.joints.row(j).transpose() - bones[j].linear() * p.joints.row(j).transpose();
  }
  out.vertices = dual_quaternion_skinning(p.rest, body().actor.weights, bones);
  return out;
}

inline NpyArray shorts(const std::vector<std::int64_t> &shape, const std::vector<std::int16_t> &values) {
  NpyArray array;
  array.type = "i2";
  array.shape = shape;
  array.bytes.resize(2 * values.size());
  std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

inline std::vector<double> flat(const MatrixRM &m) {
  return {m.data(), m.data() + m.size()};
}

/// population.npz: `people` individuals, two poses each. amounts[i] are the individual's mode amounts.
inline Npz population(int people, std::vector<Eigen::Vector3d> *amounts = nullptr) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Body &b = body();
  const int v = static_cast<int>(b.normals.rows()), j = static_cast<int>(b.joints.rows()), meshes = 2 * people;
  std::vector<std::int16_t> quantised;
  std::vector<double> joints, angles, rest_joints;
  std::vector<int> individual;
  const double scale = 5e-5;
  auto append = [](std::vector<double> &to, const Vertices &from) {
    to.insert(to.end(), from.data(), from.data() + from.size());
  };
  for (int i = 0; i < people; ++i) {
    Eigen::Vector3d amount;
    for (int k = 0; k < kModes; ++k)
      amount[k] = kDeviation[k] * normal(random);
    if (amounts)
      amounts->push_back(amount);
    const Person p = person(amount);
    append(rest_joints, p.joints);
    for (int pose = 0; pose < 2; ++pose) {
      const Vertices turn = random_pose(random, 1);
      const Posed mesh = posed(p, turn);
      for (int k = 0; k < mesh.vertices.size(); ++k)
        quantised.push_back(static_cast<std::int16_t>(std::lround((mesh.vertices.data()[k] - (k % 3 == 1 ? 1 : 0)) / scale)));
      append(joints, mesh.joints);
      append(angles, turn);
      individual.push_back(i);
    }
  }
  Npz file;
  file.arrays["vertices_q"] = shorts({meshes, v, 3}, quantised);
  file.set_f8("vertex_scale", {1}, {scale});
  file.set_f8("vertex_offset", {3}, {0, 1, 0});
  file.set_i4("faces", {b.actor.mesh.faces.rows(), 3},
              {b.actor.mesh.faces.data(), b.actor.mesh.faces.data() + b.actor.mesh.faces.size()});
  file.set_f8("skin_weights", {v, j}, flat(b.actor.weights));
  file.set_i4("mesh_individual", {meshes}, individual);
  file.set_f8("joints", {meshes, j, 3}, joints);
  file.set_f8("joint_rotvec", {meshes, j, 3}, angles);
  file.set_f8("ind_rest_joints", {people, j, 3}, rest_joints);
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Joint &joint : b.actor.skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  file.set_text("joint_names", names);
  file.set_i4("joint_parents", {j}, parents);
  std::vector<std::string> marks;
  std::vector<int> indices;
  for (const auto &[name, index] : b.landmarks) {
    marks.push_back(name);
    indices.push_back(index);
  }
  file.set_text("landmark_names", marks);
  file.set_i4("landmark_indices", {static_cast<std::int64_t>(indices.size())}, indices);
  return file;
}

} // namespace toy
