// Scans out of silhouettes and images of cameras: known shapes, drawn by the library's own rasterizer.
#include "doublet/capture/scan_from_views.h"

#include "../support/figure.h"
#include "../support/meshes.h"
#include "../support/option_ranges.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "doublet/core/stage_values.h"
#include "doublet/rays/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace doublet;
using namespace doublet::testing;

namespace scan_from_views_test {

/// A pattern in space that looks different wherever one looks, 0 .. 255.
std::uint8_t grain(const Eigen::Vector3d &p) {
  const double a = std::sin(71 * p.x() + 3 * std::sin(23 * p.y())), b = std::sin(67 * p.y() + 2 * std::sin(31 * p.z())),
               c = std::sin(61 * p.z() + 4 * std::sin(29 * p.x()));
  return static_cast<std::uint8_t>(std::lround(127 + 42 * (a + b + c)));
}

CameraView view_of(const Mesh &mesh, const Camera &camera) {
  const FaceBuffer buffer = rasterize(mesh.vertices, mesh.faces, camera);
  CameraView view{Image(camera.width, camera.height, 3), silhouette(buffer)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const int f = buffer.face_at(x, y);
      if (f < 0)
        continue;
      const Eigen::Vector3d weights = barycentric_at(mesh.vertices, mesh.faces, f, camera, {x, y});
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        point += weights[k] * mesh.vertices.row(mesh.faces(f, k)).transpose();
      for (int channel = 0; channel < 3; ++channel)
        view.image.at(x, y, channel) = grain(point);
    }
  return view;
}

std::vector<CameraView> views_of(const Mesh &mesh, const CameraRig &rig) {
  std::vector<CameraView> views;
  for (const Camera &camera : rig)
    views.push_back(view_of(mesh, camera));
  return views;
}

ViewScanOptions hull_only() {
  ViewScanOptions options;
  options.cell = 0.012;
  options.poisson_depth = 7;
  options.search_depth = 0;
  return options;
}

double mean_distance(const Mesh &from, const Mesh &to) {
  const RayScene scene(to);
  double sum = 0;
  for (Eigen::Index v = 0; v < from.vertices.rows(); ++v)
    sum += scene.closest(from.vertices.row(v)).distance;
  return sum / static_cast<double>(from.vertices.rows());
}

/// A drum of 0.25 m with a dent of 6 cm in front that no silhouette shows.
Mesh dented_drum() {
  const auto distance = [](const Eigen::Vector3d &p) {
    const double height = p.y() - 0.9, drum = std::max(std::hypot(p.x(), p.z()) - 0.25, std::abs(height) - 0.35);
    const double dent = 0.12 - (p - Eigen::Vector3d(0, 0.9, 0.31)).norm();
    return std::max(drum, dent);
  };
  return level_set(distance, {-0.3, 0.5, -0.3}, {0.3, 1.3, 0.3}, 0.015);
}

TEST(ViewScanOptions, Ranges) {
  expect_ranges<ViewScanOptions>();
}

TEST(ScanFromViews, TheHullHoldsThePersonAndTouchesEverySilhouette) {
  const Mesh person = figure_surface();
  const CameraRig rig = camera_ring(8, 320);
  std::vector<CameraView> views = views_of(person, rig);
  for (CameraView &view : views)
    view.image = {}; // masks are enough
  const Mesh scan = scan_from_views(rig, views, hull_only());
  for (std::size_t c = 0; c < rig.size(); ++c)
    EXPECT_GT(mask_iou(silhouette(rasterize(scan.vertices, scan.faces, rig[c])), views[c].mask), 0.9) << rig[c].name;
  EXPECT_LT(mean_distance(person, scan), 0.012);
  EXPECT_LT(mean_distance(scan, person), 0.012);
}

TEST(ScanFromViews, FourCamerasMakeNoPhantom) {
  // Beside the pictures of two cameras, the other two, which look at each other, would see more of the person.
  const Mesh person = figure_surface();
  CameraRig rig = camera_ring(4, 320);
  for (int c : {1, 3}) { // narrow pictures
    rig[c].K(0, 2) -= 100;
    rig[c].width -= 200;
  }
  const std::vector<CameraView> views = views_of(person, rig);
  const Mesh scan = scan_from_views(rig, views, hull_only());
  const Eigen::RowVector3d low = person.vertices.colwise().minCoeff(), high = person.vertices.colwise().maxCoeff();
  EXPECT_LT((low - scan.vertices.colwise().minCoeff()).maxCoeff(), 0.1);
  EXPECT_LT((scan.vertices.colwise().maxCoeff() - high).maxCoeff(), 0.1);
}

TEST(SlowScanFromViews, WhereCamerasAgreeTheHullIsPressedIn) {
  const Mesh drum = dented_drum();
  CameraRig rig;
  for (int c = 0; c < 8; ++c) {
    const double a = pi * c / 4;
    rig.push_back(look_at({2 * std::sin(a), 0.9 + 0.2 * (c % 2), 2 * std::cos(a)}, {0, 0.9, 0}, 600, 320, 320, "cam"));
  }
  const std::vector<CameraView> views = views_of(drum, rig);
  ViewScanOptions options = hull_only();
  const Mesh hull = scan_from_views(rig, views, options);
  options.search_depth = 0.08;
  const Mesh pressed = scan_from_views(rig, views, options);
  const auto depth_of_dent = [](const Mesh &mesh) {
    const auto hit = RayScene(mesh).cast({0, 0.9, 1}, {0, 0, -1});
    return hit ? hit->distance - 0.75 : -1;
  };
  EXPECT_NEAR(depth_of_dent(dented_drum()), 0.06, 0.005);
  EXPECT_LT(depth_of_dent(hull), 0.01);
  EXPECT_NEAR(depth_of_dent(pressed), 0.06, 0.01);
  EXPECT_LT(mean_distance(pressed, drum), 0.006);
}

/// Pictures that have nothing to do with each other, and so agree by chance: blobs of some pixels, others in every camera.
void paint_by_chance(std::vector<CameraView> &views) {
  const auto noise = [](std::uint32_t x, std::uint32_t y, std::uint32_t camera) {
    std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ camera * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    return static_cast<std::uint8_t>((h ^ h >> 12) >> 8);
  };
  for (std::size_t c = 0; c < views.size(); ++c)
    for (int y = 0; y < views[c].image.height; ++y)
      for (int x = 0; x < views[c].image.width; ++x)
        for (int channel = 0; channel < 3; ++channel)
          views[c].image.at(x, y, channel) = noise(x / 6, y / 6, static_cast<std::uint32_t>(c));
}

TEST(ScanFromViews, ALimbStaysWhereItsOutlinesPutIt) {
  const Mesh limb = capsule_mesh({Capsule{{0, 0.6, 0}, {0.05, 1.2, 0}, 0.05, 0.04}});
  const CameraRig rig = camera_ring(8, 640);
  std::vector<CameraView> views = views_of(limb, rig);
  paint_by_chance(views);
  ViewScanOptions options;
  options.poisson_depth = 7;
  const Mesh scan = scan_from_views(rig, views, options);
  const Vertices normals = vertex_normals(limb.vertices, limb.faces);
  const RayScene scene(scan);
  double out = 0; // m, of the scan, on average
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v)
    out += (scene.closest(limb.vertices.row(v)).point - limb.vertices.row(v).transpose()).dot(normals.row(v));
  out /= static_cast<double>(limb.vertices.rows());
  EXPECT_GT(out, -0.002);
  EXPECT_LT(out, 0.004);
}

TEST(ScanFromViews, WhatFacesDownUnseenIsLeftOut) {
  const Mesh drum = cylinder({0, 0.5, 0}, {0, 1.3, 0}, 0.25, 20, 64); // open, which no camera beside it sees
  CameraRig rig;
  for (int c = 0; c < 8; ++c)
    rig.push_back(look_at({2 * std::sin(pi * c / 4), 0.9, 2 * std::cos(pi * c / 4)}, {0, 0.9, 0}, 500, 320, 320, "cam"));
  const Mesh scan = scan_from_views(rig, views_of(drum, rig), hull_only());
  const RayScene scene(scan);
  const auto top = scene.cast({0, -1, 0}, {0, 1, 0});
  ASSERT_TRUE(top.has_value()) << "what faces up is closed";
  EXPECT_NEAR(top->distance, 2.3, 0.1) << "the first that a ray from below meets is the top's back";
  EXPECT_TRUE(scene.cast({2, 0.9, 0}, {-1, 0, 0}).has_value());
}

TEST(ScanFromViews, ABodyTellsFourCamerasWhatNoneSees) {
  const Mesh person = figure_surface();
  const CameraRig rig = camera_ring(4, 320);
  const std::vector<CameraView> views = views_of(person, rig);
  const double alone = mean_distance(scan_from_views(rig, views, hull_only()), person),
               around = mean_distance(scan_from_views(rig, views, person, hull_only()), person);
  EXPECT_LT(around, 0.006);
  EXPECT_GT(alone, 2 * around);
}

TEST(ScanFromViews, OutlinesTellHowFarFromTheBodyTheSurfaceIs) {
  const Mesh person = closed_tube(
                 {0, 0.4, 0}, {0, 1.4, 0}, [](double) { return 0.2; }, 30, 48),
             body = closed_tube(
                 {0.02, 0.4, 0}, {0.02, 1.4, 0}, [](double) { return 0.16; }, 30, 48); // thinner, and not quite there
  const CameraRig rig = camera_ring(4, 320);
  const std::vector<CameraView> views = views_of(person, rig);
  const RayScene scan(scan_from_views(rig, views, body, hull_only()));
  for (const double a : {0.0, pi / 4, pi / 2, 3 * pi / 4, 5 * pi / 4}) { // the hull's corners are 0.28 m out
    const Eigen::Vector3d out(std::sin(a), 0, std::cos(a));
    const auto hit = scan.cast(Eigen::Vector3d(0, 0.9, 0) + out, -out);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(1 - hit->distance, 0.2, 0.025) << a;
  }
}

TEST(ScanFromViews, AGarmentSpansTheGapBetweenTheLegs) {
  const Mesh body = figure_surface(), dressed = join({body, skirt()});
  const CameraRig rig = camera_ring(8, 320);
  const RayScene scan(scan_from_views(rig, views_of(dressed, rig), body, hull_only()));
  for (const double height : {0.58, 0.7, 0.8, 0.88}) {
    const auto hit = scan.cast({0, height, 2}, {0, 0, -1});
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(2 - hit->distance, 0.38 - 0.4 * (height - 0.5), 0.01) << height;
  }
  EXPECT_FALSE(scan.cast({0, 0.3, 2}, {0, 0, -1}, 0, 4).has_value()) << "below the hem one sees through between the legs";
}

/// What hangs from the left forearm as a wide sleeve does, without thickness.
Mesh hanging_sheet() {
  Mesh sheet{Vertices(4, 3), Faces(2, 3)};
  sheet.vertices << 0.30, 1.18, -0.02, 0.48, 1.0, 0.04, 0.44, 0.78, 0.04, 0.32, 0.78, 0;
  sheet.faces << 0, 1, 2, 0, 2, 3;
  return sheet;
}

TEST(ScanFromViews, ASheetFarFromTheBodyStays) {
  const Mesh body = figure_surface(), dressed = join({body, hanging_sheet()});
  const CameraRig rig = camera_ring(4, 320);
  const RayScene scan(scan_from_views(rig, views_of(dressed, rig), body, hull_only()));
  for (const Eigen::Vector3d &at :
       {Eigen::Vector3d(0.36, 1.02, 0.01), {0.41, 0.95, 0.03}, {0.35, 0.85, 0.01}, {0.42, 0.82, 0.03}}) {
    const auto hit = scan.cast(at + Eigen::Vector3d(0, 0, 2), {0, 0, -1}, 1.9, 2.1);
    EXPECT_TRUE(hit.has_value()) << at.transpose();
  }
  EXPECT_FALSE(scan.cast({-0.37, 0.9, 2}, {0, 0, -1}).has_value()) << "nothing hangs from the other arm";
}

TEST(ScanFromViews, SameBitsOnAnyNumberOfThreads) {
  const Mesh drum = dented_drum();
  const CameraRig rig = camera_ring(6, 120);
  const std::vector<CameraView> views = views_of(drum, rig);
  ViewScanOptions options = hull_only();
  options.cell = 0.03;
  options.poisson_depth = 6;
  options.search_depth = 0.05;
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const Mesh a = scan_from_views(rig, views, options, one), b = scan_from_views(rig, views, options, three);
  ASSERT_EQ(a.vertices.rows(), b.vertices.rows());
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.faces, b.faces);
}

TEST(SlowScanFromViews, ASilhouetteWithAHoleMayBeOutvoted) {
  const Mesh drum = dented_drum();
  const CameraRig rig = camera_ring(8, 200);
  std::vector<CameraView> views = views_of(drum, rig);
  for (int y = 90; y < 110; ++y)
    for (int x = 0; x < 200; ++x)
      views[2].mask.at(x, y) = 0; // a slit through the whole drum
  ViewScanOptions options = hull_only();
  const auto wall = [&] { return RayScene(scan_from_views(rig, views, options)).cast({0, 0.9, 2}, {0, 0, -1}); };
  const auto cut = wall();
  EXPECT_TRUE(!cut || cut->distance > 1.78) << "the slit lets the ray in, or cuts off the half that is not the largest piece";
  options.max_missing_views = 1;
  const auto whole = wall();
  ASSERT_TRUE(whole.has_value());
  EXPECT_NEAR(whole->distance, 1.75, 0.03);
}

TEST(ScanFromViews, SaysWhatIsWrong) {
  const Mesh drum = dented_drum();
  const CameraRig rig = camera_ring(8, 160);
  const std::vector<CameraView> views = views_of(drum, rig);
  const auto refused = [&](const std::vector<CameraView> &given, const CameraRig &cameras) -> std::string {
    try {
      scan_from_views(cameras, given, hull_only());
    } catch (const std::exception &error) { // std::invalid_argument for sizes, Error for what the cameras show
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused({views[0]}, rig), "scan: expected 8 views, one per camera, found 1");
  std::vector<CameraView> few = views;
  for (int c = 0; c < 6; ++c)
    few[c] = {};
  EXPECT_EQ(refused(few, rig), "scan: expected the actor in at least 3 cameras, found 2 of 8 with a silhouette");
  std::vector<CameraView> small = views;
  small[1].mask = Image(10, 10, 1);
  EXPECT_EQ(refused(small, rig), "scan: camera 'cam1': expected images of 160 x 160, found 10 x 10");
  CameraRig moved = rig;
  moved[3].t += Eigen::Vector3d(0.9, 0, 0);
  EXPECT_NE(refused(views, moved).find("without camera 'cam3' they have"), std::string::npos) << refused(views, moved);
  CameraRig turned = rig; // the same camera looks away
  turned[3].R = Eigen::Vector3d(-1, 1, -1).asDiagonal() * rig[3].R;
  turned[3].t = Eigen::Vector3d(-1, 1, -1).asDiagonal() * rig[3].t;
  try {
    scan_from_views(turned, views, drum, hull_only()); // around a body, too
    ADD_FAILURE();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("without camera 'cam3' they have"), std::string::npos) << error.what();
  }
  EXPECT_THROW(
      {
        Context context;
        context.cancelled = [] { return true; };
        scan_from_views(rig, views, hull_only(), context);
      },
      Cancelled);
}

} // namespace scan_from_views_test
