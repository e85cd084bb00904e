#include "garment_part.h"

#include "doublet/core/error.h"

namespace doublet::detail {

Worn worn_garment(const RiggedMesh &actor, const Segmentation &segmentation) {
  Worn garment;
  const Faces &faces = actor.mesh.faces;
  for (int f = 0; f < faces.rows() && segmentation.rest.rows() > 0; ++f)
    if (segmentation.region[faces(f, 0)] >= 0 && segmentation.region[faces(f, 1)] >= 0 && segmentation.region[faces(f, 2)] >= 0)
      garment.faces.push_back(f);
  garment.mesh = submesh(actor.mesh, garment.faces, &garment.vertices);
  return garment;
}

GarmentPart garment_part(const Character &c) {
  const int levels = c.garment_subdivisions;
  if (levels < 0 || levels > kMostSubdivisions)
    throw Error("character: garment_subdivisions must be in [-1, " + std::to_string(kMostSubdivisions) + "], found " +
                std::to_string(levels));
  GarmentPart part;
  part.garment = worn_garment(c.actor, c.segmentation);
  const Mesh &mesh = part.garment.mesh;
  part.fine = subdivide(mesh.faces, static_cast<int>(mesh.vertices.rows()), levels);
  const Faces &fine = part.fine.faces, &high = c.high.faces;
  part.skin_vertices = c.high.vertices.rows() - part.fine.weights.rows();
  part.skin_faces = high.rows() - fine.rows();
  const bool fits = fine.rows() > 0 && part.skin_vertices >= 0 && part.skin_faces >= 0 &&
                    high.bottomRows(fine.rows()) == Faces(fine.array() + static_cast<int>(part.skin_vertices)) &&
                    (part.skin_faces == 0 || high.topRows(part.skin_faces).maxCoeff() < part.skin_vertices);
  if (!fits)
    throw Error("character: high: expected its last " + std::to_string(fine.rows()) + " faces to be the garment's, " +
                std::to_string(levels) + " times subdivided; found others");
  return part;
}

Mesh joined(const Mesh &first, const Mesh &second) {
  Mesh both{Vertices(first.vertices.rows() + second.vertices.rows(), 3), Faces(first.faces.rows() + second.faces.rows(), 3)};
  both.vertices << first.vertices, second.vertices;
  both.faces << first.faces, Faces(second.faces.array() + static_cast<int>(first.vertices.rows()));
  return both;
}

} // namespace doublet::detail
