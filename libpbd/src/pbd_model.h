#pragma once
// What our solver derives from a ClothModel: the constraints in their final order, laid out for the solver's loops.

#include "doublet/pbd/cloth_solver.h"
#include "face_tree.h"
#include "kernels.h"
#include "lane_model.h"

namespace doublet::pbd {

class PbdModel {
public:
  explicit PbdModel(std::shared_ptr<const ClothModel> cloth);
  PbdModel(const PbdModel &) = delete; // arrays() points into this one
  int vertex_count() const { return cloth_->vertex_count(); }
  const ClothOptions &options() const { return cloth_->options(); }
  const LaneModel &arrays() const { return arrays_; } ///< lives as long as this

private:
  void set_constraints(const Vertices &rest);
  void set_followers(const Eigen::VectorXd &clothness);
  void set_tree(const Vertices &rest);
  void set_arrays();
  void set_resting_knots(const Vertices &rest);

  std::shared_ptr<const ClothModel> cloth_;
  std::vector<Triangle> faces_;
  std::vector<float> weights_; ///< inverse masses, for the loops
  std::vector<StretchBlock> stretch_blocks_;
  std::vector<BendBlock> bend_blocks_;
  std::vector<int> followers_;
  std::vector<BlendConstraint> blends_;
  std::vector<TreeNode> nodes_;
  std::vector<QuadNode> quads_;
  std::vector<int> vertex_order_;
  OrderedEdges edges_;
  PatchedTree patches_;
  std::vector<std::uint64_t> resting_pairs_, resting_edges_;
  std::vector<int> resting_knots_;
  LaneModel arrays_{};
};

} // namespace doublet::pbd
