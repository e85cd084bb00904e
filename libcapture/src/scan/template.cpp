#include "closed_surface.h"
#include "decimate.h"
#include "doublet/capture/heat_weights.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/self_intersection.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "doublet/options/options.h"
#include "face_mask.h"
#include "holes.h"
#include "oriented_scan.h"
#include "poisson.h"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace doublet {
namespace {

void expect(bool good, const std::string &name, const std::string &expectation, double found) {
  if (!good)
    options::throw_invalid(name, expectation, options::to_text(found));
}

/// The sizes of holes are in metres, so the scan must be.
void expect_metres(const Mesh &scan) {
  constexpr double kSmallest = 0.2, kLargest = 10; // m
  const double extent = (scan.vertices.colwise().maxCoeff() - scan.vertices.colwise().minCoeff()).maxCoeff();
  if (!(extent >= kSmallest && extent <= kLargest))
    throw Error("scan: expected a person in metres, 0.2 to 10 from end to end, found " + options::to_text(extent, 4) +
                (extent > kLargest ? " (millimetres or centimetres?)" : ""));
}

/// The closed surface of the scan before decimation; labels: 1 = valid.
detail::LabelledMesh close_scan(const Mesh &scan, const TemplateOptions &options, const Context &context) {
  context.report_progress("template: Poisson reconstruction", 0.0);
  const detail::PoissonSurface poisson = detail::poisson_surface(scan, options.poisson_depth);
  context.report_progress("template: closing", 0.6);
  std::vector<int> source, kept;
  detail::LabelledMesh closed;
  const Mesh whole = detail::closed_surface(poisson.mesh, source);
  constexpr double kShortEdge = 0.3; // of the mean edge
  closed.mesh = detail::collapse_short_edges(whole, kShortEdge * mean_edge_length(whole.vertices, whole.faces), kept);
  Eigen::VectorXd density(static_cast<Eigen::Index>(kept.size()));
  for (std::size_t v = 0; v < kept.size(); ++v) {
    const int from = source[kept[v]];
    density[static_cast<Eigen::Index>(v)] = from < 0 ? std::numeric_limits<double>::quiet_NaN() : poisson.density[from];
  }
  context.report_progress("template: holes", 0.65);
  std::vector<detail::HolePatch> patches = detail::find_holes(closed.mesh, density, scan, options, context);
  std::erase_if(patches, [&](const detail::HolePatch &patch) { return patch.area < options.sheet_hole; });
  detail::flatten(closed.mesh, patches);
  closed.labels.assign(closed.mesh.faces.rows(), 1);
  for (const detail::HolePatch &patch : patches) {
    const bool large = detail::is_large(patch, options);
    context.log_line("template: hole of " + std::to_string(std::lround(1e4 * patch.area)) + " cm^2 with " +
                     std::to_string(patch.borders) + " border(s): " + (large ? "suggested as invalid" : "closed"));
    if (large)
      for (int f : patch.wide_faces)
        closed.labels[f] = 0;
  }
  return closed;
}

/// Where decimation left triangles that pass through each other (thin folds, close sheets) their corners go halfway to the mean
/// of their neighbours, until none is left or it does not help; TemplateSummary tells.
void untangle(Mesh &mesh, const Context &context) {
  constexpr int kUntanglings = 10;
  const auto neighbours = vertex_neighbours(mesh.faces, static_cast<int>(mesh.vertices.rows()));
  for (int round = 0; round < kUntanglings; ++round) {
    const std::vector<std::uint8_t> crossing = self_intersecting_faces(mesh, context);
    std::set<int> corners;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
      for (int k = 0; crossing[f] && k < 3; ++k)
        corners.insert(mesh.faces(f, k));
    if (corners.empty())
      return;
    const Vertices before = mesh.vertices;
    for (int v : corners) {
      Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
      for (int n : neighbours[v])
        mean += before.row(n) / static_cast<double>(neighbours[v].size());
      mesh.vertices.row(v) = (before.row(v) + mean) / 2;
    }
  }
}

} // namespace

void TemplateOptions::validate() const {
  options::check(*this);
  expect(high_triangles >= triangles, "high_triangles", "at least as many as triangles", high_triangles);
}

Template build_template(const Mesh &scan, const TemplateOptions &options, const Context &context) {
  options.validate();
  require_usable(scan, "scan");
  expect_metres(scan);
  const detail::LabelledMesh closed = close_scan(detail::oriented_scan(scan), options, context);
  context.report_progress("template: decimation", 0.75);
  detail::LabelledMesh high = detail::decimate(closed, options.high_triangles),
                       coarse = detail::decimate(high, options.triangles);
  untangle(high.mesh, context);
  untangle(coarse.mesh, context);
  context.report_progress("template: decimation", 1.0);
  return {coarse.mesh, high.mesh, coarse.labels, high.labels};
}

RiggedMesh rig_template(const Template &surface, const std::vector<JointAnnotation> &joints, const Context &context) {
  require_usable(surface.mesh, "template");
  detail::expect_mask(surface.face_valid, surface.mesh, "face_valid");
  RiggedMesh actor;
  actor.mesh = surface.mesh;
  actor.face_valid = surface.face_valid;
  actor.skeleton = make_skeleton(joints);
  actor.weights = heat_weights(surface.mesh, surface.face_valid, actor.skeleton, {}, context);
  return actor;
}

void write_template_suggestion(const std::filesystem::path &path, const Template &surface) {
  Npz npz;
  npz.set_b1("face_valid", surface.face_valid);
  npz.set_b1("high_face_valid", surface.high_face_valid);
  npz.write(path, kFileFormat);
}

} // namespace doublet
