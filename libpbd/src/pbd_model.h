#pragma once
// What ClothModel::create makes: the constraints in their final order, laid out for the solver's loops.

#include "doublet/pbd/cloth_solver.h"
#include "lane.h"

#include <cstdint>

namespace doublet::pbd {

struct StretchConstraint {
  int a, b;
  float share_a, share_b; ///< w_a / (w_a + w_b), w_b / (w_a + w_b)
  float length;           ///< m
};
struct BendConstraint {
  int v[4];       ///< edge 0-1, opposite vertices 2 and 3
  float w[4];     ///< inverse masses divided by the largest of the four
  float cos, sin; ///< of the rest angle
  float floor;    ///< see project_bend, 1/m^2
};
/// Four bends in a row of the order that share no vertex, so that they may be projected side by side. Where the order does not
/// offer four, the rest are idle ones on the four spare vertices behind the last (see kSpareVertices), with no mass to move.
struct BendBlock {
  int v[4][4];   ///< [corner][bend]
  float w[4][4]; ///< [corner][bend]
  float cos[4], sin[4], floor[4];
};
inline constexpr int kSpareVertices = 4; ///< after the model's own, in every array of positions: the corners of a flat square

struct BlendConstraint {
  int vertex;
  float stiffness; ///< in every iteration: 1 - delta^(1 / iterations)
};

class PbdModel final : public ClothModel {
public:
  PbdModel(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options);
  int vertex_count() const override { return static_cast<int>(inverse_mass_.size()); }
  const ClothOptions &options() const override { return options_; }
  const Eigen::VectorXd &inverse_masses() const override { return inverse_mass_; }

  const Faces &faces() const { return faces_; }
  const std::vector<float> &weights() const { return weights_; }
  const std::vector<StretchConstraint> &stretches() const { return stretches_; }
  const std::vector<BendBlock> &bends() const { return bends_; }
  const std::vector<BlendConstraint> &blends() const { return blends_; }
  bool follows_targets() const { return follows_targets_; } ///< some vertex is pinned or blended
  /// True if vertex and face (not one of its own) never collide: they rest closer to each other than the thickness.
  bool excluded(int vertex, int face) const;

private:
  void set_masses(const Vertices &rest, const Eigen::VectorXd &clothness);
  void set_constraints(const Vertices &rest);
  void set_exclusions(const Vertices &rest);

  ClothOptions options_;
  Faces faces_;
  Eigen::VectorXd inverse_mass_;
  std::vector<float> weights_; ///< inverse masses once more, for the loops
  std::vector<StretchConstraint> stretches_;
  std::vector<BendBlock> bends_;
  std::vector<BlendConstraint> blends_;
  std::vector<std::uint64_t> resting_pairs_; ///< sorted (vertex << 32 | face)
  bool follows_targets_ = false;
};

} // namespace doublet::pbd
