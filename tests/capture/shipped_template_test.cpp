// The template of the shipped session against its ground truth; prints what docs/capture-template.md states.
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/session.h"
#include "doublet/capture/template_builder.h"
#include "doublet/files/npz.h"
#include "doublet/rays/ray_scene.h"
#include "support/meshes.h"

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <iostream>
#include <random>

namespace doublet {
namespace shipped_template_test {

const std::filesystem::path kShipped = std::filesystem::path(DOUBLET_SOURCE_DIR) / "examples/data/session";

struct Sample {
  Eigen::Vector3d point, normal;
  int face;
};

/// Uniform by area.
std::vector<Sample> sample(const Mesh &mesh, int count) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  const Vertices normals = face_normals(mesh.vertices, mesh.faces);
  std::mt19937 random(1);
  std::discrete_distribution<int> face(areas.data(), areas.data() + areas.size());
  std::uniform_real_distribution<double> unit;
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const int f = face(random);
    double a = unit(random), b = unit(random);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    const Eigen::RowVector3d p0 = mesh.vertices.row(mesh.faces(f, 0)), p1 = mesh.vertices.row(mesh.faces(f, 1)),
                             p2 = mesh.vertices.row(mesh.faces(f, 2));
    samples.push_back({(p0 + a * (p1 - p0) + b * (p2 - p0)).transpose(), normals.row(f).transpose(), f});
  }
  return samples;
}

/// Body and garment of frame 0 as one mesh.
Mesh true_surface() {
  const Npz frames = Npz::read(kShipped / "ground_truth/frames_0000.npz"),
            fixed = Npz::read(kShipped / "ground_truth/static.npz");
  std::vector<Mesh> parts;
  for (const std::string name : {"body", "cloth"}) {
    const auto shape = frames.shape(name);
    const auto values = frames.values(name);
    const auto corners = fixed.integers(name + "_tris");
    Mesh part;
    part.vertices = Eigen::Map<const Vertices>(values.data(), shape[1], 3); // the first frame of the file is frame 0
    part.faces = Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size()) / 3, 3);
    parts.push_back(part);
  }
  return testing::join(parts);
}

/// Points of the true surface that can be seen from around, level or from above.
std::vector<Sample> seen(const Mesh &truth, int count) {
  const RayScene scene(truth);
  std::vector<Sample> out;
  for (const Sample &s : sample(truth, count)) {
    bool visible = false;
    for (int i = 0; i < 150 && !visible; ++i) { // spiral over the sphere above 12 degrees below the horizon
      const double y = 1 - 1.2 * (i + 0.5) / 150, r = std::sqrt(1 - y * y), turn = 2.399963 * i;
      const Eigen::Vector3d direction(r * std::cos(turn), y, r * std::sin(turn));
      visible = direction.dot(s.normal) > 0.1 && !scene.cast(s.point + 1e-4 * s.normal, direction, 1e-4);
    }
    if (visible)
      out.push_back(s);
  }
  return out;
}

/// Mean, 99th percentile and maximum in mm.
struct Distances {
  double mean = 0, high = 0, most = 0;
  explicit Distances(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    for (double v : values)
      mean += 1e3 * v / static_cast<double>(values.size());
    high = 1e3 * values[values.size() * 99 / 100];
    most = 1e3 * values.back();
  }
};
std::ostream &operator<<(std::ostream &out, const Distances &d) {
  return out << "mean " << d.mean << ", 99 % " << d.high << ", max " << d.most << " mm";
}

void check(const std::string &name, const Mesh &mesh, const std::vector<std::uint8_t> &valid, const Mesh &scan, const Mesh &truth,
           const std::vector<Sample> &visible, double mean_limit) {
  const MeshReport report = report_mesh(mesh);
  EXPECT_TRUE(report.closed()) << report.to_string();
  EXPECT_EQ(report.components, 1);
  const RayScene surface(mesh), true_scene(truth), scan_scene(scan);

  double marked = 0;
  std::vector<double> from_truth, from_scan, to_scan;
  for (const Sample &s : visible) {
    const ClosestPoint closest = surface.closest(s.point);
    from_truth.push_back(closest.distance);
    marked += valid[closest.face] ? 0 : 1;
  }
  marked /= static_cast<double>(visible.size());
  for (const Sample &s : sample(scan, 20000))
    from_scan.push_back(surface.closest(s.point).distance);
  int invented = 0, found = 0;
  for (const Sample &s : sample(mesh, 50000)) {
    if (valid[s.face])
      to_scan.push_back(scan_scene.closest(s.point).distance);
    if (true_scene.closest(s.point).distance > 0.01) {
      ++invented;
      found += !valid[s.face];
    }
  }
  const double recall = static_cast<double>(found) / invented;
  std::cout << name << ": " << report.to_string() << "\n  true visible surface marked invalid " << 100 * marked
            << " %; surface more than 10 mm from any true one marked " << 100 * recall << " %\n  true visible surface to it "
            << Distances(from_truth) << "\n  scan to it " << Distances(from_scan) << "\n  its valid part to the scan "
            << Distances(to_scan) << std::endl;
  EXPECT_LT(marked, 0.03);
  EXPECT_GT(recall, 0.90);
  EXPECT_LT(Distances(from_scan).mean, mean_limit);

  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (valid[f])
      faces.push_back(f);
  const Mesh part = submesh(mesh, faces);
  int count = 0;
  vertex_components(part.faces, static_cast<int>(part.vertices.rows()), &count);
  EXPECT_EQ(count, 3); // the dressed body and two lower legs, which the sheet under the hem keeps apart
}

TEST(SlowShippedTemplate, AgainstTheTruth) {
  const Session session = read_session(kShipped);
  const Mesh scan = read_mesh(session.scan), truth = true_surface();
  const auto start = std::chrono::steady_clock::now();
  const Template surface = build_template(scan);
  const auto built = std::chrono::steady_clock::now();
  const RiggedMesh actor = rig_template(surface, session.joints);
  const auto rigged = std::chrono::steady_clock::now();
  const auto seconds = [](auto a, auto b) { return std::chrono::duration<double>(b - a).count(); };
  std::cout << "template " << seconds(start, built) << " s, skeleton and weights " << seconds(built, rigged) << " s" << std::endl;
  const TemplateSummary summary = summarise_template(surface, scan);
  for (const SurfaceQuality &quality : {summary.mesh, summary.high}) {
    std::cout << "invalid area " << 1e4 * quality.invalid_area << " cm^2, smallest angle " << quality.smallest_angle << ", 1 % "
              << quality.first_centile_angle << " degrees" << std::endl;
    EXPECT_EQ(quality.self_intersections, 0);
  }
  const std::vector<Sample> visible = seen(truth, 20000);
  check("M", surface.mesh, surface.face_valid, scan, truth, visible, 1.5);
  check("M_high", surface.high, surface.high_face_valid, scan, truth, visible, 0.5);

  // No lower leg follows the other side: bones of the left leg own nothing of the right one.
  const auto column = [&](const std::string &joint) { return actor.weights.col(actor.skeleton.find(joint)); };
  const double centre = actor.skeleton.joints[actor.skeleton.find("pelvis")].rest.x();
  for (Eigen::Index v = 0; v < actor.mesh.vertices.rows(); ++v) {
    if (actor.mesh.vertices(v, 1) > 0.45)
      continue; // above are the skirt and its sheet
    const bool left = actor.mesh.vertices(v, 0) > centre;
    for (const std::string bone : {"hip", "knee", "ankle"})
      EXPECT_LT(column((left ? "r_" : "l_") + bone)[v], 0.05);
  }
}

} // namespace shipped_template_test
} // namespace doublet
