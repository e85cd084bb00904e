#pragma once
// Broad phase of the cloth against itself: which vertices come near which faces. Spatial hash of Teschner et al. 2003.

#include "doublet/pbd/cloth_solver.h"
#include "kernels.h"
#include "pack4.h"

#include <cstdint>

namespace doublet::pbd {

class PbdModel;

struct Box {
  Vec3f lo, hi;
};
struct FaceVertex {
  int face, vertex;
};

/// Finds overlapping (face box, vertex box) pairs, a face's own vertices left out. Holds its memory for the next call.
class PairFinder {
public:
  /// boxes: where each vertex is during the step; a face's box is the union of its vertices', grown by `margin` (m). Pairs come
  /// ordered by face, then cell, then vertex: the same for the same input. Work is bounded: a vertex or face that spans more than
  /// kMaxSpan cells (edges of some ten times their mean length) is looked for around its middle alone.
  const std::vector<FaceVertex> &find(const std::vector<Box> &boxes, const Faces &faces, float margin);

private:
  static constexpr int kMaxSpan = 12;
  struct Entry {
    std::uint64_t cell;
    int vertex;
  };
  struct Cells {
    int lo[3], hi[3];
  };
  void set_cell_size(const std::vector<Box> &boxes, const Faces &faces, float margin);
  int cell_of(float x) const;
  Cells cells_of(const Box &box) const;
  std::uint32_t bucket(std::uint64_t cell) const;
  void insert(const std::vector<Box> &boxes);

  float inverse_cell_ = 1;
  std::vector<Cells> cells_;         ///< of each vertex
  std::vector<std::uint32_t> start_; ///< bucket -> first entry
  std::vector<Entry> entries_;
  std::vector<FaceVertex> pairs_;
};

/// Sorted (vertex << 32 | face) of all pairs closer than `distance`, a face's own vertices left out.
std::vector<std::uint64_t> pairs_closer_than(const std::vector<Point> &points, const Faces &faces, float distance);

/// Contacts of the cloth with itself for a step from x to p: vertices that would come nearer to a face than the thickness, on the
/// side on which they started (so that nothing passes through), or are within a thickness of doing so. A pair that starts closer
/// than the thickness is opened at most by `opening` in this step.
void find_self_contacts(const PbdModel &model, const std::vector<Point> &x, const std::vector<Point> &p, float opening,
                        PairFinder &finder, std::vector<Box> &boxes, std::vector<SelfContact<float>> &contacts);

} // namespace doublet::pbd
