// A tetrahedron that does not move has no cloth.
#include <doublet/segment/cloth_segmenter.h>

int main() {
  doublet::MeshSequence sequence;
  sequence.faces.resize(4, 3);
  sequence.faces << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
  doublet::Vertices vertices(4, 3);
  vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  sequence.frames = {vertices, vertices, vertices};
  const doublet::Segmentation result = doublet::segment_cloth({sequence, {1, 1, 1, 1}});
  return result.region_count == 0 && result.clothness.maxCoeff() == 0 ? 0 : 1;
}
