#include "attachment.h"

#include "doublet/segment/parts/diffusion.h"
#include "surface_patches.h"

#include <limits>

namespace doublet::detail {

Eigen::VectorXd attachment_of(const RiggedMesh &actor, const Segmentation &segmentation, const GarmentOptions &options) {
  if (segmentation.slack.size() == 0)
    return Eigen::VectorXd::Zero(actor.mesh.vertices.rows());
  const Surface surface = surface_of(actor.mesh, actor.face_valid);
  const std::vector<char> cloth = choose(surface, [&](int v) { return segmentation.clothness[v] > 0.5; });
  std::vector<char> snug = choose(surface, [&](int v) { return segmentation.slack[v] < options.snug_slack; });
  merge_small(surface, cloth, options.min_piece_area, snug); // what hangs a little amid snug cloth, what rests amid loose cloth
  Eigen::VectorXd label(surface.size());
  for (int v = 0; v < surface.size(); ++v) // skin takes that of the cloth beside it
    label[v] = cloth[v] ? snug[v] : std::numeric_limits<double>::quiet_NaN();
  return snapped(diffuse_on_surface(surface.vertices, surface.faces, label, options.closing_length));
}

std::vector<char> free_regions(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &attachment) {
  const Eigen::VectorXd seen = vertex_areas(actor.mesh.vertices, valid_faces(actor.mesh.faces, actor.face_valid));
  std::vector<char> free(segmentation.region_count, 0);
  for (int v = 0; v < attachment.size(); ++v)
    if (segmentation.region[v] >= 0 && seen[v] > 0 && attachment[v] < 0.5)
      free[segmentation.region[v]] = 1;
  return free;
}

Segmentation with_regions(const Segmentation &segmentation, const std::vector<char> &kept) {
  Segmentation result = segmentation;
  for (Eigen::Index v = 0; v < result.region.size(); ++v)
    if (result.region[v] >= 0 && !kept[result.region[v]]) {
      result.region[v] = -1;
      result.clothness[v] = 0;
    }
  return result;
}

} // namespace doublet::detail
