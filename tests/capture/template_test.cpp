// Scan -> closed template: known shapes with known holes.
#include "capture/capture_shapes.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"
#include "support/temp_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace doublet {
namespace template_test {

using testing::lathe;

constexpr double kHem = 0.5, kHemRadius = 0.25, kLegRadius = 0.06;

/// A bell (skirt and body) open at its hem, and a leg of which only the part below the hem was seen. About 5 mm between samples.
Mesh skirted_scan() {
  std::vector<std::pair<double, double>> bell, leg;
  testing::line(bell, kHemRadius, kHem, 0.12, 1.0, 100);
  testing::arc(bell, 0.12, 1.005, 95, 180, 40);
  testing::arc(leg, kLegRadius, kLegRadius, 0, 88, 20);
  testing::line(leg, kLegRadius, kLegRadius + 0.002, kLegRadius, kHem - 0.03, 85);
  return testing::join({lathe(bell, 250), lathe(leg, 75)});
}

TemplateOptions small_options(int poisson_depth = 8) {
  TemplateOptions options;
  options.triangles = 2000;
  options.high_triangles = 8000;
  options.poisson_depth = poisson_depth;
  return options;
}

/// Built once, for the tests that only look at it.
const Template &skirted_template() {
  static const Template surface = build_template(skirted_scan(), small_options());
  return surface;
}

int valid_components(const Mesh &mesh, const std::vector<std::uint8_t> &valid) {
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (valid[f])
      faces.push_back(f);
  const Mesh part = submesh(mesh, faces);
  int count = 0;
  vertex_components(part.faces, static_cast<int>(part.vertices.rows()), &count);
  return count;
}

TEST(Template, ClosesTheHemAndMarksTheSheet) {
  const Mesh scan = skirted_scan();
  const Template &surface = skirted_template();
  for (const Mesh *mesh : {&surface.mesh, &surface.high}) {
    const MeshReport report = report_mesh(*mesh);
    EXPECT_TRUE(report.closed()) << report.to_string();
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.degenerate_faces, 0);
    EXPECT_GT(testing::signed_volume(*mesh), 0);
  }
  EXPECT_NEAR(surface.mesh.faces.rows(), 2000, 4);
  EXPECT_NEAR(surface.high.faces.rows(), 8000, 4);
  const double sheet = std::numbers::pi * (kHemRadius * kHemRadius - kLegRadius * kLegRadius);
  const TemplateSummary summary = summarise_template(surface, scan);
  EXPECT_NEAR(summary.mesh.invalid_area, sheet, 0.15 * sheet);
  EXPECT_NEAR(summary.high.invalid_area, sheet, 0.15 * sheet);
  EXPECT_EQ(summary.mesh.self_intersections, 0);
  EXPECT_EQ(summary.high.self_intersections, 0);
  EXPECT_GT(summary.mesh.smallest_angle, 2);
  EXPECT_GT(summary.mesh.first_centile_angle, summary.mesh.smallest_angle);
  EXPECT_LT(summary.mesh.scan_max, 0.010);
  EXPECT_LT(summary.high.scan_max, 0.006);
  EXPECT_LT(summary.mesh.max_to_scan, 0.03);
  const RayScene scene(scan);
  for (Eigen::Index f = 0; f < surface.mesh.faces.rows(); ++f) {
    const Eigen::Vector3d centre = surface.mesh.vertices(surface.mesh.faces.row(f), Eigen::all).colwise().mean();
    if (surface.face_valid[f]) {
      EXPECT_LT(scene.closest(centre).distance, 0.012) << centre.transpose();
    } else {
      EXPECT_NEAR(centre.y(), kHem, 0.06) << centre.transpose();
    }
  }
}

TEST(Template, SheetSeparatesLegFromGarment) {
  const Template &surface = skirted_template();
  EXPECT_EQ(valid_components(surface.mesh, surface.face_valid), 2);
  EXPECT_EQ(valid_components(surface.high, surface.high_face_valid), 2);
}

/// The bell with a fold at +X, deeper towards the hem; of its bottom and its one wall nothing was seen.
Mesh pleated_scan() {
  std::vector<std::pair<double, double>> bell, leg;
  testing::line(bell, kHemRadius, kHem, 0.12, 1.0, 120);
  testing::arc(bell, 0.12, 1.005, 95, 180, 40);
  testing::arc(leg, kLegRadius, kLegRadius, 0, 88, 20);
  testing::line(leg, kLegRadius, kLegRadius + 0.002, kLegRadius, kHem - 0.03, 85);
  Mesh garment = lathe(bell, 600);
  const auto across = [](const Eigen::RowVector3d &p) { return p.x() > 0 ? p.z() : 1.0; }; // m, from the middle of the fold
  for (Eigen::Index v = 0; v < garment.vertices.rows(); ++v) {
    const double w = across(garment.vertices.row(v)) / 0.012;
    garment.vertices(v, 0) -= 0.12 * std::max(0.0, 0.9 - garment.vertices(v, 1)) * std::exp(-w * w);
  }
  std::vector<int> seen;
  for (int f = 0; f < garment.faces.rows(); ++f) {
    const Eigen::RowVector3d centre = garment.vertices(garment.faces.row(f), Eigen::all).colwise().mean();
    if (!(across(centre) > -0.012 && across(centre) < 0.004 && centre.y() < 0.8))
      seen.push_back(f);
  }
  return testing::join({submesh(garment, seen), lathe(leg, 75)});
}

TEST(SlowTemplate, AFoldThatNobodySawIsNoSheet) {
  const Template surface = build_template(pleated_scan(), small_options());
  const double sheet = std::numbers::pi * (kHemRadius * kHemRadius - kLegRadius * kLegRadius);
  EXPECT_NEAR(summarise_template(surface, pleated_scan()).mesh.invalid_area, sheet, 0.15 * sheet);
  const Eigen::VectorXd areas = face_areas(surface.high.vertices, surface.high.faces);
  double above = 0;
  for (Eigen::Index f = 0; f < surface.high.faces.rows(); ++f)
    if (surface.high.vertices(surface.high.faces.row(f), 1).mean() > kHem + 0.08) // the hem's sheet reaches into the fold
      above += surface.high_face_valid[f] ? 0 : areas[f];
  EXPECT_LT(above, 1e-4);
}

TEST(Template, SummaryMeasuresTheMaskAsItIs) {
  const Mesh scan = skirted_scan();
  Template surface = skirted_template();
  surface.face_valid.assign(surface.face_valid.size(), 1);
  const SurfaceQuality all = summarise_template(surface, scan).mesh;
  EXPECT_EQ(all.invalid_area, 0);
  EXPECT_GT(all.max_to_scan, 0.05); // the sheet is far from the scan
  surface.face_valid.pop_back();
  EXPECT_THROW(summarise_template(surface, scan), std::invalid_argument);
}

TEST(Template, SmallHolesStayValidAndFloatersGo) {
  std::vector<std::pair<double, double>> ball, floater;
  testing::arc(ball, 0.3, 1.0, 5, 180, 150); // a hole of 21 cm^2 at the south pole
  testing::arc(floater, 0.01, 2.0, 0, 180, 10);
  const Template surface = build_template(testing::join({lathe(ball, 300), lathe(floater, 16)}), small_options(7));
  EXPECT_TRUE(report_mesh(surface.mesh).closed());
  EXPECT_EQ(report_mesh(surface.mesh).components, 1);
  EXPECT_EQ(std::count(surface.face_valid.begin(), surface.face_valid.end(), 0), 0);
  EXPECT_LT(surface.mesh.vertices.col(1).maxCoeff(), 1.31);
}

TEST(Template, SameBitsForAnyThreadCount) {
  Context one;
  one.threads = 1;
  const Template a = build_template(skirted_scan(), small_options(6)), b = build_template(skirted_scan(), small_options(6), one);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.faces, b.mesh.faces);
  EXPECT_EQ(a.face_valid, b.face_valid);
  EXPECT_EQ(a.high.vertices, b.high.vertices);
  EXPECT_EQ(a.high_face_valid, b.high_face_valid);
}

TEST(Template, SurvivesNonManifoldAndDegenerateScans) {
  Mesh scan = skirted_scan();
  const Eigen::Index faces = scan.faces.rows();
  scan.faces.conservativeResize(faces + 3, 3);
  scan.faces.row(faces) = scan.faces.row(0);                            // twice the same face
  scan.faces.row(faces + 1) << scan.faces(0, 0), scan.faces(0, 1), 900; // a third face at an edge
  scan.faces.row(faces + 2) << 5, 5, 6;                                 // no area
  const Template surface = build_template(scan, small_options(7));
  EXPECT_TRUE(report_mesh(surface.mesh).closed());
}

TEST(Template, FacesThatRunTheWrongWayAreTurned) {
  const Mesh scan = skirted_scan();
  Mesh inward = scan, mixed = scan;
  inward.faces.col(1).swap(inward.faces.col(2));
  for (Eigen::Index f = 0; f < mixed.faces.rows(); ++f)
    if (f * 7 % 10 < 3)
      std::swap(mixed.faces(f, 1), mixed.faces(f, 2));
  const Template expected = build_template(scan, small_options(6));
  for (const Mesh *turned : {&inward, &mixed}) {
    const Template surface = build_template(*turned, small_options(6));
    EXPECT_GT(testing::signed_volume(surface.mesh), 0);
    EXPECT_NEAR(testing::signed_volume(surface.mesh), testing::signed_volume(expected.mesh),
                1e-3 * testing::signed_volume(expected.mesh));
    EXPECT_EQ(std::count(surface.face_valid.begin(), surface.face_valid.end(), 0),
              std::count(expected.face_valid.begin(), expected.face_valid.end(), 0));
  }
}

TEST(SlowTemplate, NoiseFloatersAndASecondObject) {
  Mesh scan = skirted_scan();
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.001);
  for (Eigen::Index i = 0; i < scan.vertices.size(); ++i)
    scan.vertices.data()[i] += noise(random);
  std::vector<Mesh> parts{scan, testing::capsule(0.05, 0, 0.2, 40, 20, 0.6)};
  for (int i = 0; i < 20; ++i)
    parts.push_back(testing::sphere(0.004 + 0.001 * i, {0.45 - 0.02 * i, 0.1 + 0.05 * i, 0.4}, 6, 8));
  const Template surface = build_template(testing::join(parts), small_options());
  const double sheet = std::numbers::pi * (kHemRadius * kHemRadius - kLegRadius * kLegRadius);
  const TemplateSummary summary = summarise_template(surface, scan);
  EXPECT_TRUE(report_mesh(surface.mesh).closed());
  EXPECT_EQ(report_mesh(surface.mesh).components, 1);
  EXPECT_NEAR(summary.mesh.invalid_area, sheet, 0.2 * sheet);
  EXPECT_EQ(summary.mesh.self_intersections, 0);
  EXPECT_LT(summary.high.scan_max, 0.012);
}

TEST(Template, UnitsOtherThanMetresAreNamed) {
  Mesh scan = testing::capsule(0.1, 0, 0.5, 20, 10);
  scan.vertices *= 1000;
  try {
    build_template(scan);
    ADD_FAILURE() << "millimetres were taken for metres";
  } catch (const Error &e) {
    EXPECT_NE(std::string(e.what()).find("metres"), std::string::npos) << e.what();
  }
}

TEST(Template, RejectsUnusableScans) {
  EXPECT_THROW(build_template(Mesh{}), Error);
  Mesh scan = testing::capsule(0.1, 0, 0.5, 20, 10);
  Mesh broken = scan;
  broken.vertices(3, 1) = std::nan("");
  EXPECT_THROW(build_template(broken), Error);
  broken = scan;
  broken.faces(0, 0) = 1000000;
  EXPECT_THROW(build_template(broken), Error);
  broken = scan;
  broken.vertices.setZero(); // every triangle without area
  EXPECT_THROW(build_template(broken), Error);
}

TEST(Template, OptionsAreChecked) {
  const Mesh scan = testing::capsule(0.1, 0, 0.5, 20, 10);
  TemplateOptions options;
  options.triangles = 3;
  EXPECT_THROW(build_template(scan, options), std::invalid_argument);
  options = {};
  options.poisson_depth = 30;
  EXPECT_THROW(build_template(scan, options), std::invalid_argument);
  options = {};
  options.hole_gap = std::nan("");
  EXPECT_THROW(build_template(scan, options), std::invalid_argument);
}

TEST(Template, CancelStopsIt) {
  Context context;
  context.cancelled = [] { return true; };
  EXPECT_THROW(build_template(skirted_scan(), small_options(), context), Cancelled);
}

TEST(MeshFiles, RoundTrip) {
  const testing::TempFolder folder;
  const Mesh mesh = testing::capsule(0.1, 0, 0.5, 20, 10);
  for (const char *name : {"a.ply", "a.obj", "a.off", "a.STL"}) {
    write_mesh(folder / name, mesh);
    const Mesh read = read_mesh(folder / name);
    EXPECT_EQ(read.vertices.rows(), mesh.vertices.rows()) << name;
    EXPECT_EQ(read.faces.rows(), mesh.faces.rows()) << name;
    EXPECT_TRUE(report_mesh(read).closed()) << name;
    EXPECT_NEAR(testing::signed_volume(read), testing::signed_volume(mesh), 1e-6) << name;
  }
}

TEST(MeshFiles, BrokenFilesAreNamed) {
  const testing::TempFolder folder;
  EXPECT_THROW(read_mesh(folder / "missing.ply"), FileNotFound);
  std::ofstream(folder / "text.ply") << "not a mesh";
  std::ofstream(folder / "thing.xyz") << "1 2 3";
  write_mesh(folder / "half.ply", testing::capsule(0.1, 0, 0.5, 20, 10));
  std::filesystem::resize_file(folder / "half.ply", std::filesystem::file_size(folder / "half.ply") / 2);
  for (const char *name : {"text.ply", "thing.xyz", "half.ply"})
    try {
      read_mesh(folder / name);
      ADD_FAILURE() << name << " was read";
    } catch (const Error &e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
}

} // namespace template_test
} // namespace doublet
