#include "closed_surface.h"
#include "decimate.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/core/ray_scene.h"
#include "holes.h"
#include "poisson.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

void expect(bool good, const std::string &name, const std::string &expectation, double found) {
  if (!good)
    throw std::invalid_argument(name + ": expected " + expectation + ", found " + std::to_string(found));
}

/// What closes the scan, before decimation.
struct Closed {
  Mesh mesh;
  std::vector<std::uint8_t> face_valid;
};

Closed close_scan(const Mesh &scan, const TemplateOptions &options, const Context &context) {
  context.report("template: Poisson reconstruction", 0.0);
  const detail::PoissonSurface poisson = detail::poisson_surface(scan, options.poisson_depth);
  context.report("template: closing", 0.6);
  std::vector<int> source;
  Closed closed;
  closed.mesh = detail::closed_surface(poisson.mesh, source);
  Eigen::VectorXd density(static_cast<Eigen::Index>(source.size()));
  for (std::size_t v = 0; v < source.size(); ++v)
    density[static_cast<Eigen::Index>(v)] = source[v] < 0 ? std::numeric_limits<double>::quiet_NaN() : poisson.density[source[v]];
  context.report("template: holes", 0.65);
  std::vector<detail::HolePatch> patches = detail::find_holes(closed.mesh, density, scan, options, context);
  std::erase_if(patches, [&](const detail::HolePatch &patch) { return patch.area < options.sheet_hole; });
  detail::flatten(closed.mesh, patches);
  closed.face_valid.assign(closed.mesh.faces.rows(), 1);
  for (const detail::HolePatch &patch : patches) {
    const bool large = detail::is_large(patch, options);
    context.say("template: hole of " + std::to_string(std::lround(1e4 * patch.area)) + " cm^2 with " +
                std::to_string(patch.rims) + " rim(s): " + (large ? "suggested as invalid" : "closed"));
    if (large)
      for (int f : patch.faces)
        closed.face_valid[f] = 0;
  }
  return closed;
}

/// Labels of the faces of a decimated mesh: what most of seven points of the face lie on. Small faces follow their centre.
std::vector<std::uint8_t> carry_labels(const Closed &closed, const RayScene &scene, const Mesh &mesh, const Context &context) {
  static const double kPoints[7][3] = {{1, 1, 1}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}, {2, 2, 0.5}, {2, 0.5, 2}, {0.5, 2, 2}};
  std::vector<std::uint8_t> labels(mesh.faces.rows());
  parallel_for(context, static_cast<int>(mesh.faces.rows()), [&](int f) {
    int valid = 0;
    for (const auto &weights : kPoints) {
      const double sum = weights[0] + weights[1] + weights[2];
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        point += weights[k] / sum * mesh.vertices.row(mesh.faces(f, k)).transpose();
      valid += closed.face_valid[scene.closest(point).face];
    }
    labels[f] = valid >= 4;
  });
  return labels;
}

} // namespace

void TemplateOptions::validate() const {
  expect(triangles >= 100, "triangles", "at least 100", triangles);
  expect(high_triangles >= triangles, "high_triangles", "at least as many as triangles", high_triangles);
  expect(poisson_depth >= 4 && poisson_depth <= 12, "poisson_depth", "4 to 12", poisson_depth);
  expect(hole_gap > 0, "hole_gap", "a positive distance in metres", hole_gap);
  expect(density_drop >= 0, "density_drop", "a number of octree levels", density_drop);
  expect(large_hole > 0, "large_hole", "a positive area in m^2", large_hole);
  expect(sheet_hole > 0, "sheet_hole", "a positive area in m^2", sheet_hole);
}

Template build_template(const Mesh &scan, const TemplateOptions &options, const Context &context) {
  options.validate();
  require_usable(scan, "scan");
  const Closed closed = close_scan(scan, options, context);
  context.report("template: decimation", 0.75);
  Template out;
  out.high = detail::decimate(closed.mesh, options.high_triangles);
  out.mesh = detail::decimate(out.high, options.triangles);
  context.report("template: labels", 0.95);
  const RayScene scene(closed.mesh);
  out.high_face_valid = carry_labels(closed, scene, out.high, context);
  out.face_valid = carry_labels(closed, scene, out.mesh, context);
  const Eigen::VectorXd areas = face_areas(out.mesh.vertices, out.mesh.faces);
  for (std::size_t f = 0; f < out.face_valid.size(); ++f)
    out.invalid_area += out.face_valid[f] ? 0 : areas[static_cast<Eigen::Index>(f)];
  context.report("template: labels", 1.0);
  return out;
}

RiggedMesh rig_template(const Template &surface, const std::vector<JointMark> &joints, const Context &context) {
  require_usable(surface.mesh, "template");
  if (static_cast<Eigen::Index>(surface.face_valid.size()) != surface.mesh.faces.rows())
    throw std::invalid_argument("face_valid: expected one value for each of " + std::to_string(surface.mesh.faces.rows()) +
                                " triangles, found " + std::to_string(surface.face_valid.size()));
  RiggedMesh actor;
  actor.mesh = surface.mesh;
  actor.face_valid = surface.face_valid;
  actor.skeleton = make_skeleton(joints);
  actor.weights = heat_weights(surface.mesh, surface.face_valid, actor.skeleton, {}, context);
  return actor;
}

} // namespace doublet
