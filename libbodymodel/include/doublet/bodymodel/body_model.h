#pragma once
// A statistical model of naked bodies: shape and pose near the scan pose as coefficients ~ N(0, I) (Sect. 5, after Hasler et al.
// 2009).

#include "doublet/core/types.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// Points of a body and their exact derivatives with respect to the coefficients.
struct BodyLinearisation {
  Vertices points;   ///< (n, 3) m
  MatrixRM jacobian; ///< (3n, K) m per standard deviation; rows x, y, z of point 0, then of point 1, ...
};

/// A linear model is vertices = mean + components * s, s ~ N(0, I); a model that poses its own skeleton is linear only in the
/// shape coefficients and overrides linearise(). An interface, so that other models can be used. Threads: all methods are const
/// and are called from several at once, on one immutable object.
class BodyModel {
public:
  virtual ~BodyModel() = default;
  virtual int vertex_count() const = 0;
  virtual int component_count() const = 0;
  /// Number of shape coefficients, which come first; the others are the pose. Default: all, a model without poses.
  virtual int shape_count() const { return component_count(); }
  virtual const Faces &faces() const = 0;
  virtual Vertices
  vertices(const Eigen::VectorXd &coefficients) const = 0;         ///< (B, 3) m; throws std::invalid_argument on a wrong size
  virtual Vertices component(int k) const = 0;                     ///< (B, 3) m per standard deviation, at the mean
  virtual const std::map<std::string, int> &landmarks() const = 0; ///< name -> vertex
  virtual std::string name() const = 0;                            ///< name and hash of the file

  /// The chosen vertices and their derivatives. Default: linear, from component().
  virtual BodyLinearisation linearise(const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) const;
  /// Names of the model's own joints; default none.
  virtual std::vector<std::string> joint_names() const { return {}; }
  /// Positions of those joints and their derivatives; default empty.
  virtual BodyLinearisation joints(const Eigen::VectorXd &coefficients) const;

  /// Reads a model file as docs/body-model.md describes, or an .npz of the SMPL family (v_template, shapedirs, J_regressor,
  /// weights, kintree_table, f). Throws FileNotFound or Error naming file and array.
  static std::shared_ptr<const BodyModel> read(const std::filesystem::path &path);
};

} // namespace doublet
