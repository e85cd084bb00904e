#include "doublet/core/garment.h"

#include "doublet/core/error.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

/// `top` over `bottom`.
template <class Matrix> Matrix stacked(const Matrix &top, const Matrix &bottom) {
  Matrix both(top.rows() + bottom.rows(), top.cols());
  both << top, bottom;
  return both;
}

std::vector<double> all_at(const Garment &garment, double width) {
  return std::vector<double>(static_cast<std::size_t>(garment.region_count), width);
}

/// m^2 at rest, with all regions at this position among the widths.
double area_at(const Garment &garment, double width) {
  return face_areas(choose_widths(garment, all_at(garment, width)).rest, garment.mesh.faces).sum();
}

/// Where the area is `area`, by bisection: it falls from the first width to the last.
double position_of(const Garment &garment, double area) {
  double low = 0, high = static_cast<double>(garment.widths.size()) - 1;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (area_at(garment, middle) > area ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void require_attachment(const Garment &garment, Eigen::Index vertices, const std::string &what) {
  if (garment.attachment.size() != 0 && garment.attachment.size() != vertices)
    throw Error(what + ": array 'attachment': expected " + std::to_string(vertices) +
                " entries, one per vertex of the actor, found " + std::to_string(garment.attachment.size()));
  if (!(garment.attachment.array() >= 0 && garment.attachment.array() <= 1).all())
    throw Error(what + ": array 'attachment': expected values in [0, 1], found others");
}

/// What of the cloth hangs free; a region of which nothing does is none.
Segmentation without_carried(const Segmentation &segmentation, const Eigen::VectorXd &attachment) {
  if (attachment.size() == 0)
    return segmentation;
  Segmentation free = segmentation;
  free.clothness.array() *= 1 - attachment.array();
  std::vector<int> number(segmentation.region_count, -1);
  for (Eigen::Index v = 0; v < free.region.size(); ++v)
    if (free.clothness[v] == 0)
      free.region[v] = -1;
    else if (free.region[v] >= 0)
      number[free.region[v]] = 0;
  free.region_count = 0;
  for (int &region : number)
    region = region < 0 ? -1 : free.region_count++;
  for (int &region : free.region)
    region = region < 0 ? -1 : number[region];
  return free;
}

} // namespace

void validate_garment(const Garment &garment, const RiggedMesh &actor, const std::string &what) {
  require_usable(garment.mesh, what);
  const Eigen::Index count = garment.mesh.vertices.rows();
  const auto expect = [&](const char *array, Eigen::Index found) {
    if (found != count)
      throw Error(what + ": array '" + array + "': expected " + std::to_string(count) + " rows, one per vertex, found " +
                  std::to_string(found));
  };
  expect("region", garment.region.size());
  expect("clothness", garment.clothness.size());
  expect("rest", garment.rest.rows());
  for (const Vertices &width : garment.widths) {
    expect("widths", width.rows());
    if (!width.allFinite())
      throw Error(what + ": array 'widths': expected finite positions, found NaN or infinity");
  }
  expect("actor_face", garment.actor_face.size());
  expect("barycentric", garment.barycentric.rows());
  if (static_cast<Eigen::Index>(garment.replaced_faces.size()) != actor.mesh.faces.rows())
    throw Error(what + ": array 'covers': expected " + std::to_string(actor.mesh.faces.rows()) +
                " entries, one per face of the actor, found " + std::to_string(garment.replaced_faces.size()));
  require_attachment(garment, actor.mesh.vertices.rows(), what);
  for (Eigen::Index v = 0; v < count; ++v) {
    const auto fail = [&](const std::string &expected, double found) {
      throw Error(what + ": vertex " + std::to_string(v) + ": expected " + expected + ", found " + std::to_string(found));
    };
    if (garment.region[v] < 0 || garment.region[v] >= garment.region_count)
      fail("a region below " + std::to_string(garment.region_count), garment.region[v]);
    if (!(garment.clothness[v] >= 0 && garment.clothness[v] <= 1))
      fail("a clothness in [0, 1]", garment.clothness[v]);
    if (!garment.rest.row(v).allFinite())
      fail("a finite rest position", garment.rest(v, 0));
    if (garment.actor_face[v] < 0 || garment.actor_face[v] >= actor.mesh.faces.rows())
      fail("a face below " + std::to_string(actor.mesh.faces.rows()) + " of the actor", garment.actor_face[v]);
    if (!(garment.barycentric.row(v).minCoeff() > -1e-3 && std::abs(garment.barycentric.row(v).sum() - 1) < 1e-3))
      fail("barycentric coordinates with sum one", garment.barycentric.row(v).sum());
  }
}

Garment choose_widths(const Garment &garment, const std::vector<double> &chosen) {
  const Eigen::Index count = garment.mesh.vertices.rows();
  bool fits = garment.rest.rows() == count && garment.region.size() == count;
  for (const Vertices &width : garment.widths)
    fits = fits && width.rows() == count;
  if (!fits || (count > 0 && (garment.region.minCoeff() < 0 || garment.region.maxCoeff() >= garment.region_count)))
    throw std::invalid_argument("choose_widths: garment: expected rest, widths and a region below " +
                                std::to_string(garment.region_count) + " for each of " + std::to_string(count) +
                                " vertices, found others");
  Garment result = garment;
  result.widths.clear();
  if (garment.widths.empty() || chosen.empty())
    return result;
  if (static_cast<int>(chosen.size()) != garment.region_count)
    throw std::invalid_argument("choose_widths: expected one width for each of " + std::to_string(garment.region_count) +
                                " regions, found " + std::to_string(chosen.size()));
  const double last = static_cast<double>(garment.widths.size()) - 1;
  for (double width : chosen)
    if (!(width >= 0 && width <= last))
      throw std::invalid_argument("choose_widths: expected a width between 0 and " + std::to_string(garment.widths.size() - 1) +
                                  ", found " + options::to_text(width));
  for (Eigen::Index v = 0; v < result.rest.rows(); ++v) {
    const double width = chosen[garment.region[v]], below = std::floor(width), share = width - below;
    const auto first = static_cast<std::size_t>(below), second = static_cast<std::size_t>(std::min(below + 1, last));
    result.rest.row(v) = garment.widths[first].row(v);
    if (share > 0)
      result.rest.row(v) = (1 - share) * result.rest.row(v) + share * garment.widths[second].row(v);
  }
  return result;
}

std::vector<Garment> width_variants(const Garment &garment) {
  std::vector<Garment> result;
  for (std::size_t width = 0; width < garment.widths.size(); ++width)
    result.push_back(choose_widths(garment, all_at(garment, static_cast<double>(width))));
  if (result.empty())
    result.push_back(garment);
  return result;
}

std::vector<std::vector<double>> common_widths(const std::vector<Garment> &garments, int count) {
  if (garments.empty() || count < 2)
    throw std::invalid_argument("common_widths: expected at least one garment and two widths, found " +
                                std::to_string(garments.size()) + " and " + std::to_string(count));
  double widest = std::numeric_limits<double>::infinity(), narrowest = 0;
  for (const Garment &garment : garments) {
    if (garment.widths.size() < 2)
      throw std::invalid_argument("common_widths: expected garments that offer several widths, found one that does not");
    widest = std::min(widest, area_at(garment, 0));
    narrowest = std::max(narrowest, area_at(garment, static_cast<double>(garment.widths.size()) - 1));
  }
  if (!(narrowest < widest))
    throw std::invalid_argument("common_widths: expected garments that can be equally wide, found one whose narrowest area, " +
                                std::to_string(narrowest) + " m^2, is above another's widest, " + std::to_string(widest));
  std::vector<std::vector<double>> positions(garments.size());
  for (std::size_t g = 0; g < garments.size(); ++g)
    for (int k = 0; k < count; ++k)
      positions[g].push_back(position_of(garments[g], widest + (narrowest - widest) * k / (count - 1)));
  return positions;
}

MatrixRM interpolate_to_garment(const Garment &garment, const Faces &actor_faces, const MatrixRM &values) {
  MatrixRM result = MatrixRM::Zero(garment.actor_face.size(), values.cols());
  for (Eigen::Index v = 0; v < result.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      result.row(v) += garment.barycentric(v, k) * values.row(actor_faces(garment.actor_face[v], k));
  return result;
}

DressedActor dress(const RiggedMesh &actor, const Segmentation &segmentation, const Garment &garment) {
  require_actor(actor, "dress");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "dress");
  if (garment.region_count == 0) {
    require_attachment(garment, actor.mesh.vertices.rows(), "garment");
    return {actor, without_carried(segmentation, garment.attachment)};
  }
  validate_garment(garment, actor, "garment");
  const Eigen::Index bare = actor.mesh.vertices.rows(), count = garment.mesh.vertices.rows(), faces = actor.mesh.faces.rows();
  DressedActor dressed;
  RiggedMesh &mesh = dressed.actor;
  mesh.skeleton = actor.skeleton;
  mesh.mesh.vertices = stacked(actor.mesh.vertices, garment.mesh.vertices);
  mesh.mesh.faces = stacked(actor.mesh.faces, Faces(garment.mesh.faces.array() + static_cast<int>(bare)));
  mesh.weights = stacked(actor.weights, interpolate_to_garment(garment, actor.mesh.faces, actor.weights));
  mesh.face_valid = actor.face_valid;
  mesh.face_valid.resize(faces, 1);
  for (Eigen::Index f = 0; f < faces; ++f)
    if (garment.replaced_faces[f])
      mesh.face_valid[f] = 0;
  mesh.face_valid.resize(faces + garment.mesh.faces.rows(), 1);

  Segmentation &cloth = dressed.segmentation;
  cloth.region_count = garment.region_count;
  cloth.sigma = Eigen::VectorXd::Constant(bare + count, std::numeric_limits<double>::quiet_NaN());
  cloth.sigma.head(std::min(bare, segmentation.sigma.size())) =
      segmentation.sigma.head(std::min(bare, segmentation.sigma.size()));
  cloth.clothness = stacked<Eigen::VectorXd>(Eigen::VectorXd::Zero(bare), garment.clothness);
  cloth.region = stacked<Eigen::VectorXi>(Eigen::VectorXi::Constant(bare, -1), garment.region);
  cloth.rest = stacked<Vertices>(actor.mesh.vertices, garment.rest);
  return dressed;
}

ReferencePerformance dress(const ReferencePerformance &performance, const RiggedMesh &actor, const Garment &garment) {
  require_actor(actor, "dress");
  require_frames(performance.surface.frames, actor.mesh.vertices.rows(), "dress: a captured frame");
  if (garment.region_count == 0)
    return performance;
  validate_garment(garment, actor, "garment");
  ReferencePerformance dressed = performance;
  const Faces cloth = garment.mesh.faces.array() + static_cast<int>(actor.mesh.vertices.rows());
  dressed.surface.faces = stacked(actor.mesh.faces, cloth);
  for (Vertices &frame : dressed.surface.frames)
    frame = stacked<Vertices>(frame, interpolate_to_garment(garment, actor.mesh.faces, frame));
  return dressed;
}

} // namespace doublet
