#pragma once
// Shape components in the rest pose, bent by the model's own skeleton with dual quaternion skinning: pose is exact by
// construction.

#include "doublet/bodymodel/body_model.h"
#include "doublet/files/npz.h"

namespace doublet {

/// The arrays of a model file (docs/body-model.md). V vertices, J joints (parents first, joint 0 the root), K shape and P pose
/// components.
struct SkinnedBodyData {
  std::string name;
  Faces faces;      ///< (F, 3)
  Vertices mean;    ///< (V, 3) m, rest pose, root joint at the origin
  MatrixRM shape;   ///< (3V, K) m per standard deviation
  MatrixRM weights; ///< (V, J)
  std::vector<std::string> joint_names;
  std::vector<int> joint_parents;
  Vertices joint_mean;       ///< (J, 3) m
  MatrixRM joint_shape;      ///< (3J, K)
  Eigen::VectorXd pose_mean; ///< (3J) rad, local rotation vectors
  MatrixRM pose;             ///< (3J, P) rad per standard deviation; the root's rows are zero
  std::map<std::string, int> landmarks;
};

SkinnedBodyData read_body_data(const std::filesystem::path &path); ///< a model file of this library
SkinnedBodyData read_smpl_data(const std::filesystem::path &path); ///< an .npz of the SMPL family
std::string content_hash(const Npz &file);

class SkinnedBodyModel : public BodyModel {
public:
  explicit SkinnedBodyModel(SkinnedBodyData data);
  int vertex_count() const override { return static_cast<int>(data_.mean.rows()); }
  int component_count() const override { return static_cast<int>(data_.shape.cols() + data_.pose.cols()); }
  int shape_count() const override { return static_cast<int>(data_.shape.cols()); }
  const Faces &faces() const override { return data_.faces; }
  Vertices vertices(const Eigen::VectorXd &coefficients) const override;
  Vertices component(int k) const override;
  const std::map<std::string, int> &landmarks() const override { return data_.landmarks; }
  std::string name() const override { return data_.name; }
  BodyLinearisation linearise(const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) const override;
  std::vector<std::string> joint_names() const override { return data_.joint_names; }
  BodyLinearisation joints(const Eigen::VectorXd &coefficients) const override;

private:
  struct Posed;
  Posed pose(const Eigen::VectorXd &coefficients) const;
  bool below(int joint, int ancestor) const;
  SkinnedBodyData data_;
  std::vector<std::vector<std::pair<int, double>>> influences_; ///< per vertex (joint, weight > 0), largest first
};

} // namespace doublet
