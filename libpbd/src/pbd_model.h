#pragma once
// What ClothModel::create makes: the constraints in their final order, laid out for the solver's loops.

#include "doublet/pbd/cloth_solver.h"
#include "kernels.h"
#include "lane_model.h"

namespace doublet::pbd {

class PbdModel final : public ClothModel {
public:
  PbdModel(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options,
           const Eigen::VectorXd &fullness);
  int vertex_count() const override { return static_cast<int>(inverse_mass_.size()); }
  const ClothOptions &options() const override { return options_; }
  const Eigen::VectorXd &inverse_masses() const override { return inverse_mass_; }
  const LaneModel &arrays() const { return arrays_; } ///< lives as long as the model

private:
  void set_masses(const Vertices &rest, const Eigen::VectorXd &clothness);
  void set_constraints(const Vertices &rest);
  double full_length(const Vertices &rest, const Vertices &across, int a, int b) const;
  void set_followers(const Eigen::VectorXd &clothness);
  void set_tree(const Vertices &rest);
  void set_arrays();

  ClothOptions options_;
  Eigen::VectorXd fullness_; ///< (N)
  std::vector<Triangle> faces_;
  Eigen::VectorXd inverse_mass_;
  std::vector<float> weights_; ///< inverse masses once more, for the loops
  std::vector<StretchConstraint> stretches_;
  std::vector<BendBlock> blocks_;
  std::vector<int> followers_;
  std::vector<BlendConstraint> blends_;
  std::vector<TreeNode> nodes_;
  std::vector<std::uint64_t> resting_pairs_;
  LaneModel arrays_{};
};

} // namespace doublet::pbd
