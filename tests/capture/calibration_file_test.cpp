// Cameras written in each format by a few lines here, read again, and held against OpenCV's own projection.
#include "doublet/capture/calibration_file.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "support/temp_folder.h"

#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <random>
#include <sstream>

namespace doublet {
namespace calibration_file_test {

namespace fs = std::filesystem;
using Matrix3 = Eigen::Matrix3d;
using Terms = std::vector<double>;

/// A camera as another program has it: in its own units and axes, projected by OpenCV alone.
struct Truth {
  std::string name;
  int width = 1088, height = 1920;
  double fx = 1681.2, fy = 1680.9, cx = 532.97, cy = 948.14;
  Terms terms;
  bool fisheye = false;
  Matrix3 R;
  Eigen::Vector3d t;

  Eigen::Vector3d rotation_vector() const {
    const Eigen::AngleAxisd turn(R);
    return turn.axis() * turn.angle();
  }
  Eigen::Vector2d project(const Eigen::Vector3d &point) const {
    const cv::Matx33d K(fx, 0, cx, 0, fy, cy, 0, 0, 1);
    const Eigen::Vector3d r = rotation_vector();
    const std::vector<cv::Point3d> points{{point.x(), point.y(), point.z()}};
    const cv::Vec3d rvec(r.x(), r.y(), r.z()), tvec(t.x(), t.y(), t.z());
    std::vector<cv::Point2d> pixels;
    if (fisheye)
      cv::fisheye::projectPoints(points, pixels, rvec, tvec, K, terms);
    else
      cv::projectPoints(points, rvec, tvec, K, terms, pixels);
    return {pixels[0].x, pixels[0].y};
  }
};

/// Metres and +Y up, as doublet has the world, from the truth's file.
struct FileAxes {
  double unit = 1; ///< metres
  Matrix3 file_from_world = Matrix3::Identity();
};
const FileAxes kOurs;
const FileAxes kZUp{1, (Matrix3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished()};
const FileAxes kZUpMillimetres{0.001, kZUp.file_from_world};

/// Upright cameras about the origin, looking at a person.
std::vector<Truth> ring(const FileAxes &axes, const Terms &terms = {}, bool fisheye = false, int count = 3) {
  std::vector<Truth> cameras;
  for (int c = 0; c < count; ++c) {
    const double angle = 0.4 + 2.1 * c;
    const Eigen::Vector3d centre(3.1 * std::sin(angle), 1.5 + 0.2 * c, 3.1 * std::cos(angle));
    const Eigen::Vector3d forward = (Eigen::Vector3d(0, 1, 0) - centre).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
    Matrix3 R;
    R << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    Truth camera;
    camera.name = "cam" + std::to_string(c);
    camera.cx += c;
    camera.terms = terms;
    camera.fisheye = fisheye;
    camera.R = R * axes.file_from_world.transpose();
    camera.t = -R * centre / axes.unit;
    cameras.push_back(camera);
  }
  return cameras;
}

/// The same pixels, for 100 points about the person, as OpenCV has for what was written.
void expect_same(const std::vector<CalibratedCamera> &read, const std::vector<Truth> &truth, const FileAxes &axes,
                 double tolerance = 1e-6) {
  ASSERT_EQ(read.size(), truth.size());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-0.8, 0.8), height(0, 2);
  for (std::size_t c = 0; c < truth.size(); ++c) {
    EXPECT_EQ(read[c].camera.name, truth[c].name);
    EXPECT_EQ(read[c].camera.width, truth[c].width);
    EXPECT_EQ(read[c].camera.height, truth[c].height);
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d world(side(random), height(random), side(random));
      const Eigen::Vector3d in_file = axes.file_from_world * world / axes.unit;
      ASSERT_GT(read[c].camera.depth(world), 0);
      EXPECT_LT((read[c].project(world) - truth[c].project(in_file)).norm(), tolerance) << truth[c].name << " " << i;
    }
  }
}

// --- writers

std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return std::strpbrk(text, ".en") ? text : std::string(text) + ".0";
}

std::string list(const Terms &values, const std::string &between = ", ") {
  std::string text;
  for (double value : values)
    text += (text.empty() ? "" : between) + digits(value);
  return text;
}

Terms rows(const Matrix3 &m) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> r = m;
  return {r.data(), r.data() + 9};
}
Terms flat(const Eigen::Vector3d &v) {
  return {v.x(), v.y(), v.z()};
}
Terms K_of(const Truth &c) {
  return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
}

std::string yaml(const std::string &key, int rows_, const Terms &values) {
  return key + ": !!opencv-matrix\n   rows: " + std::to_string(rows_) + "\n   cols: " + std::to_string(values.size() / rows_) +
         "\n   dt: d\n   data: [ " + list(values) + " ]\n";
}

std::string opencv_yaml(const Truth &c) {
  return "%YAML:1.0\n---\nimage_width: " + std::to_string(c.width) + "\nimage_height: " + std::to_string(c.height) + "\n" +
         yaml("camera_matrix", 3, K_of(c)) + yaml("distortion_coefficients", 1, c.terms) +
         (c.fisheye ? "fisheye_model: 1\n" : "") + yaml("R", 3, rows(c.R)) + yaml("T", 3, flat(c.t));
}

std::string xml(const std::string &key, int rows_, const Terms &values) {
  return "<" + key + " type_id=\"opencv-matrix\"><rows>" + std::to_string(rows_) + "</rows><cols>" +
         std::to_string(values.size() / rows_) + "</cols><dt>d</dt><data>" + list(values, " ") + "</data></" + key + ">\n";
}

std::string opencv_xml(const Truth &c) {
  return "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_size>" + std::to_string(c.width) + " " + std::to_string(c.height) +
         "</image_size>\n" + xml("K", 3, K_of(c)) + xml("D", 1, c.terms) + xml("rvec", 3, flat(c.rotation_vector())) +
         xml("tvec", 3, flat(c.t)) + "</opencv_storage>\n";
}

std::string toml(const std::vector<Truth> &cameras) {
  std::ostringstream text;
  for (const Truth &c : cameras)
    text << "[" << c.name << "_of_a_table]\nname = \"" << c.name << "\"\nsize = [" << c.width << ".0, " << c.height
         << ".0]\nmatrix = [[" << digits(c.fx) << ", 0.0, " << digits(c.cx) << "], [0.0, " << digits(c.fy) << ", " << digits(c.cy)
         << "], [0.0, 0.0, 1.0]]\ndistortions = [" << list(c.terms) << "]\nrotation = [" << list(flat(c.rotation_vector()))
         << "]\ntranslation = [" << list(flat(c.t)) << "]\nfisheye = " << (c.fisheye ? "true" : "false") << "\n\n";
  text << "[metadata]\nadjusted = false\nerror = 0.0\n";
  return text.str();
}

void write_easymocap(const fs::path &folder, const std::vector<Truth> &cameras, bool with_size) {
  std::string names = "%YAML:1.0\n---\nnames:\n", intri, extri;
  for (const Truth &c : cameras) {
    names += "   - \"" + c.name + "\"\n";
    intri += yaml("K_" + c.name, 3, K_of(c)) + yaml("dist_" + c.name, 1, c.terms);
    if (with_size)
      intri += "H_" + c.name + ": " + std::to_string(c.height) + "\nW_" + c.name + ": " + std::to_string(c.width) + "\n";
    extri += yaml("R_" + c.name, 3, flat(c.rotation_vector())) + yaml("T_" + c.name, 3, flat(c.t));
  }
  write_text(folder / "intri.yml", names + intri);
  write_text(folder / "extri.yml", names + extri);
}

std::string qualisys(const std::vector<Truth> &cameras) {
  std::ostringstream text;
  text.precision(17);
  text << "<?xml version='1.0' encoding='ASCII'?>\n<calibration type=\"regular\"><cameras>\n";
  for (const Truth &c : cameras) {
    const Matrix3 axes = Eigen::Vector3d(1, -1, -1).asDiagonal() * c.R;
    const Eigen::Vector3d centre = -c.R.transpose() * c.t;
    text << "<camera active=\"1\" serial=\"" << c.name << "\"><fov_video bottom=\"" << 9 + c.height << "\" left=\"4\" right=\""
         << 3 + c.width << "\" top=\"10\"/><transform";
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k)
        text << " r" << r + 1 << k + 1 << "=\"" << axes(r, k) << "\"";
    text << " x=\"" << centre.x() << "\" y=\"" << centre.y() << "\" z=\"" << centre.z() << "\"/><intrinsic focalLengthU=\""
         << 64 * c.fx << "\" focalLengthV=\"" << 64 * c.fy << "\" centerPointU=\"" << 64 * (c.cx + 4) << "\" centerPointV=\""
         << 64 * (c.cy + 10) << "\" skew=\"0\" radialDistortion1=\"" << c.terms[0] << "\" radialDistortion2=\"" << c.terms[1]
         << "\" radialDistortion3=\"" << c.terms[4] << "\" tangentalDistortion1=\"" << c.terms[2] << "\" tangentalDistortion2=\""
         << c.terms[3] << "\"/></camera>\n";
  }
  text << "<camera active=\"0\" serial=\"marker camera\"/></cameras></calibration>\n";
  return text.str();
}

/// COLMAP's parameters of a model: focal lengths, principal point with the pixel's corner at integers, terms.
struct ColmapModel {
  const char *name;
  int id;
  bool one_focal_length;
  int terms;
  bool fisheye;
};
Terms colmap_parameters(const ColmapModel &model, const Truth &c) {
  Terms p{c.fx};
  if (!model.one_focal_length)
    p.push_back(c.fy);
  p.insert(p.end(), {c.cx + 0.5, c.cy + 0.5});
  p.insert(p.end(), c.terms.begin(), c.terms.begin() + model.terms);
  return p;
}

void write_colmap_text(const fs::path &folder, const ColmapModel &model, const std::vector<Truth> &cameras) {
  std::string intrinsics = "# Camera list with one line of data per camera:\n", images = "# Image list\n";
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Truth &camera = cameras[c];
    const Eigen::Quaterniond q(camera.R);
    const std::string id = std::to_string(c + 7);
    intrinsics += id + " " + model.name + " " + std::to_string(camera.width) + " " + std::to_string(camera.height) + " " +
                  list(colmap_parameters(model, camera), " ") + "\n";
    images += std::to_string(c + 1) + " " + list({q.w(), q.x(), q.y(), q.z()}, " ") + " " + list(flat(camera.t), " ") + " " + id +
              " " + camera.name + "/0001.png\n" + (c ? "\n" : "10.5 20.5 -1 11 12 3\n");
  }
  write_text(folder / "cameras.txt", intrinsics);
  write_text(folder / "images.txt", images);
}

struct Binary {
  std::string bytes;
  template <class T> Binary &operator<<(T value) {
    bytes.append(reinterpret_cast<const char *>(&value), sizeof value);
    return *this;
  }
};

void write_colmap_binary(const fs::path &folder, const ColmapModel &model, const std::vector<Truth> &cameras) {
  Binary intrinsics, images;
  intrinsics << std::uint64_t(cameras.size());
  images << std::uint64_t(cameras.size());
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Truth &camera = cameras[c];
    intrinsics << std::uint32_t(c + 7) << std::int32_t(model.id) << std::uint64_t(camera.width) << std::uint64_t(camera.height);
    for (double p : colmap_parameters(model, camera))
      intrinsics << p;
    const Eigen::Quaterniond q(camera.R);
    images << std::uint32_t(c + 1) << q.w() << q.x() << q.y() << q.z() << camera.t.x() << camera.t.y() << camera.t.z()
           << std::uint32_t(c + 7);
    images.bytes += camera.name + ".jpg" + std::string(1, '\0');
    images << std::uint64_t(2);
    for (int i = 0; i < 2; ++i)
      images << 1.5 << 2.5 << std::uint64_t(-1);
  }
  write_text(folder / "cameras.bin", intrinsics.bytes);
  write_text(folder / "images.bin", images.bytes);
}

const Terms kFive{-0.146, 0.0399, 6e-4, -7e-4, 0.011}, kFour{-0.146, 0.0399, 6e-4, -7e-4},
    kRational{-0.12, 0.03, 6e-4, -7e-4, 0.01, 0.05, -0.02, 0.004},
    kPrism{-0.12, 0.03, 6e-4, -7e-4, 0.01, 0.05, -0.02, 0.004, 2e-3, -1e-3, 3e-3, 1e-3},
    kTilted{-0.12, 0.03, 6e-4, -7e-4, 0.01, 0.05, -0.02, 0.004, 2e-3, -1e-3, 3e-3, 1e-3, 0.01, -0.02},
    kFisheye{0.02, -0.01, 3e-3, -4e-4};

class CalibrationFiles : public ::testing::Test {
protected:
  testing::TempFolder folder;

  template <class E = Error>
  void expect_refused(const fs::path &path, const std::vector<std::string> &words, const CalibrationOptions &options = {}) {
    try {
      read_calibration(path, options);
      ADD_FAILURE() << path << " was read";
    } catch (const E &e) {
      for (const std::string &word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << "'" << word << "' is missing in: " << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      EXPECT_LT(std::string(e.what()).size(), 500U) << e.what();
    }
  }
  void replace(const std::string &name, const std::string &old, const std::string &with) {
    std::string text = read_text(folder / name);
    const auto at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    write_text(folder / name, text.replace(at, old.size(), with));
  }
  void cut(const std::string &name, std::size_t size) { fs::resize_file(folder / name, size); }
};

// --- every format says what was written

TEST_F(CalibrationFiles, OpenCVHasAFileACamera) {
  for (const Terms &terms : {kFour, kFive, kRational, kPrism, kTilted}) {
    const auto truth = ring(kOurs, terms);
    for (const Truth &camera : truth)
      write_text(folder / (camera.name + ".yml"), opencv_yaml(camera));
    write_text(folder / "._cam0.yml", "Mac OS X"); // as macOS writes them beside files on other disks
    expect_same(read_calibration(folder.path()), truth, kOurs);
  }
}

TEST_F(CalibrationFiles, OpenCVXmlWithRotationVectors) {
  const auto truth = ring(kOurs, kRational);
  for (const Truth &camera : truth)
    write_text(folder / (camera.name + ".xml"), opencv_xml(camera));
  expect_same(read_calibration(folder.path()), truth, kOurs);
  expect_same(read_calibration(folder / "cam1.xml"), {truth[1]}, kOurs);
}

TEST_F(CalibrationFiles, OpenCVFisheye) {
  const auto truth = ring(kOurs, kFisheye, true);
  for (const Truth &camera : truth)
    write_text(folder / (camera.name + ".yml"), opencv_yaml(camera));
  const auto read = read_calibration(folder.path());
  EXPECT_TRUE(read[0].lens.fisheye);
  expect_same(read, truth, kOurs);
}

TEST_F(CalibrationFiles, ColmapModels) {
  const ColmapModel models[] = {{"SIMPLE_PINHOLE", 0, true, 0, false}, {"PINHOLE", 1, false, 0, false},
                                {"SIMPLE_RADIAL", 2, true, 1, false},  {"RADIAL", 3, true, 2, false},
                                {"OPENCV", 4, false, 4, false},        {"FULL_OPENCV", 6, false, 8, false},
                                {"OPENCV_FISHEYE", 5, false, 4, true}, {"SIMPLE_RADIAL_FISHEYE", 8, true, 1, true},
                                {"RADIAL_FISHEYE", 9, true, 2, true}};
  for (const ColmapModel &model : models) {
    SCOPED_TRACE(model.name);
    Terms terms = model.fisheye ? kFisheye : kRational;
    terms.resize(std::max(model.terms, 4));
    for (std::size_t i = model.terms; i < terms.size(); ++i)
      terms[i] = 0;
    auto truth = ring(kOurs, terms, model.fisheye);
    if (model.one_focal_length)
      for (Truth &camera : truth)
        camera.fy = camera.fx;
    testing::TempFolder text, binary;
    write_colmap_text(text.path(), model, truth);
    expect_same(read_calibration(text.path()), truth, kOurs);
    expect_same(read_calibration(text / "images.txt"), truth, kOurs);
    write_colmap_binary(binary.path(), model, truth);
    expect_same(read_calibration(binary.path()), truth, kOurs);
  }
}

TEST_F(CalibrationFiles, EasyMocap) {
  const auto truth = ring(kZUp, kFive);
  write_easymocap(folder.path(), truth, true);
  expect_same(read_calibration(folder.path()), truth, kZUp);
  write_easymocap(folder.path(), truth, false);
  expect_refused(folder.path(), {"intri.yml", "cam0", "--image-size"});
  expect_same(read_calibration(folder / "extri.yml", {.image_width = 1088, .image_height = 1920}), truth, kZUp);
}

TEST_F(CalibrationFiles, Toml) {
  for (const Terms &terms : {kFour, kFive, kRational}) {
    const auto truth = ring(kZUp, terms);
    write_text(folder / "Calib.toml", toml(truth));
    expect_same(read_calibration(folder / "Calib.toml"), truth, kZUp);
  }
  const auto truth = ring(kZUp, kFisheye, true);
  write_text(folder / "Calib.toml", toml(truth));
  expect_same(read_calibration(folder / "Calib.toml"), truth, kZUp);
}

TEST_F(CalibrationFiles, CaliscopeHasTablesWithinATable) {
  auto truth = ring(kZUp, kFive);
  std::string text = toml(truth);
  for (std::size_t at = 0; (at = text.find("[cam", at)) != std::string::npos; at += 9)
    text.replace(at, 4, "[cameras.cam");
  write_text(folder / "camera_array.toml", text);
  expect_same(read_calibration(folder / "camera_array.toml"), truth, kZUp);
}

TEST_F(CalibrationFiles, Qualisys) {
  const auto truth = ring(kZUpMillimetres, kFive);
  write_text(folder / "session.qca.txt", qualisys(truth));
  expect_same(read_calibration(folder / "session.qca.txt"), truth, kZUpMillimetres);
}

TEST_F(CalibrationFiles, OursIsWrittenAndRead) {
  for (const Terms &terms : {kFive, kRational, kPrism, kTilted, kFisheye}) {
    const bool fisheye = terms == kFisheye;
    const auto truth = ring(kZUp, terms, fisheye);
    write_text(folder / "Calib.toml", toml(truth));
    const auto read = read_calibration(folder / "Calib.toml");
    write_calibration(folder / "calibration.yml", read);
    const auto again = read_calibration(folder / "calibration.yml");
    ASSERT_EQ(again.size(), read.size());
    for (std::size_t c = 0; c < read.size(); ++c) {
      EXPECT_EQ(again[c].camera.K, read[c].camera.K); // to the bit
      EXPECT_EQ(again[c].camera.R, read[c].camera.R);
      EXPECT_EQ(again[c].camera.t, read[c].camera.t);
      EXPECT_EQ(again[c].camera.distortion, read[c].camera.distortion);
      EXPECT_EQ(again[c].lens.fisheye, fisheye);
      EXPECT_EQ(again[c].lens.distortion, read[c].lens.distortion);
    }
    expect_same(again, truth, kZUp);
  }
}

TEST_F(CalibrationFiles, AMarkOfTheByteOrderAndAQuestionMarkInThePath) {
  write_text(folder / "Calib.toml", toml(ring(kZUp, kFive)));
  const auto read = read_calibration(folder / "Calib.toml");
  write_calibration(folder / "calibration.yml", read);
  const std::string text = read_text(folder / "calibration.yml");
  fs::create_directory(folder / "take 3?");
  write_text(folder / "take 3?" / "calibration.yml", text);
  write_text(folder / "calibration.yml", "\xEF\xBB\xBF" + text);
  for (const fs::path &path : {folder / "calibration.yml", folder / "take 3?" / "calibration.yml"}) {
    const auto again = read_calibration(path);
    ASSERT_EQ(again.size(), read.size());
    EXPECT_EQ(again[0].camera.K, read[0].camera.K);
  }
}

// --- units, axes, names

TEST_F(CalibrationFiles, UnitsAreAskedFor) {
  const FileAxes centimetres{0.01, kZUp.file_from_world};
  const auto truth = ring(centimetres, kFive);
  write_text(folder / "Calib.toml", toml(truth));
  expect_refused(folder / "Calib.toml", {"Calib.toml", "0.3 to 30 m", "--units", "cm would make it", "mm would make it 0."});
  expect_same(read_calibration(folder / "Calib.toml", {.units = "cm"}), truth, centimetres);
  expect_same(read_calibration(folder / "Calib.toml", {.units = "0.01"}), truth, centimetres);
  expect_refused(folder / "Calib.toml", {"found 29600 m"}, {.units = "55"});
}

TEST_F(CalibrationFiles, TheAxisThatPointsUpIsAskedFor) {
  for (const auto &[axis, row] : std::map<UpAxis, Eigen::Vector3d>{{UpAxis::X, {1, 0, 0}},
                                                                   {UpAxis::MinusX, {-1, 0, 0}},
                                                                   {UpAxis::MinusY, {0, -1, 0}},
                                                                   {UpAxis::Z, {0, 0, 1}},
                                                                   {UpAxis::MinusZ, {0, 0, -1}}}) {
    const std::string up = kUpAxisNames[static_cast<std::size_t>(axis)];
    SCOPED_TRACE(up);
    const auto truth = ring({1, shortest_turn(Eigen::Vector3d::UnitY(), row)}, kFive);
    for (const Truth &camera : truth)
      write_text(folder / (camera.name + ".yml"), opencv_yaml(camera));
    expect_refused(folder.path(), {"--up=" + up, "found that the pictures' upper edges point along " + up + ":"});
    const auto read = read_calibration(folder.path(), {.up = axis});
    for (std::size_t c = 0; c < read.size(); ++c) {
      const Eigen::Vector3d centre = truth[c].R.transpose() * -truth[c].t;
      EXPECT_NEAR(read[c].camera.centre().y(), centre.dot(row), 1e-9);
      EXPECT_NEAR(read[c].camera.R.determinant(), 1, 1e-9);
    }
  }
}

TEST_F(CalibrationFiles, NamesBecomeKeys) {
  auto truth = ring(kZUp, kFive);
  truth[0].name = "01";
  truth[1].name = "front left";
  truth[2].name = "c\xc3\xa4m";
  std::string text = toml(truth);
  for (const char *name : {"[01_", "[front left_", "[c\xc3\xa4m_"})
    text.replace(text.find(name), std::strlen(name), "[t_" + std::to_string(std::strlen(name)));
  write_text(folder / "Calib.toml", text);
  const auto read = read_calibration(folder / "Calib.toml");
  EXPECT_EQ(read[0].camera.name.substr(0, 3), "cam");
  write_calibration(folder / "calibration.yml", read);
  EXPECT_EQ(read_calibration(folder / "calibration.yml").size(), 3U);
  for (const auto &camera : read)
    EXPECT_TRUE(camera.camera.name == "cam01" || camera.camera.name == "front_left" || camera.camera.name == "c__m")
        << camera.camera.name;
}

// --- what is wrong is said

TEST_F(CalibrationFiles, NothingThere) {
  expect_refused<FileNotFound>(folder / "nowhere.toml", {"nowhere.toml"});
  expect_refused(folder.path(), {"COLMAP", "EasyMocap"});
  write_text(folder / "notes.txt", "f = 1000");
  expect_refused(folder / "notes.txt", {"notes.txt", "--format"});
  write_text(folder / "a.toml", "title = \"no camera\"\n");
  expect_refused(folder / "a.toml", {"a.toml", "matrix"});
  expect_refused(folder.path(), {"found a folder"}, {.format = CalibrationFormat::Toml});
}

TEST_F(CalibrationFiles, AnotherFormatThanIsSaid) {
  write_text(folder / "Calib.toml", toml(ring(kZUp, kFive)));
  for (const CalibrationFormat format : {CalibrationFormat::Doublet, CalibrationFormat::OpenCv, CalibrationFormat::Qualisys})
    expect_refused(folder / "Calib.toml", {"Calib.toml", "expected"}, {.format = format});
  for (const CalibrationFormat format : {CalibrationFormat::Colmap, CalibrationFormat::EasyMocap})
    expect_refused<FileNotFound>(folder / "Calib.toml", {}, {.format = format});
  EXPECT_THROW(read_calibration(folder / "Calib.toml", {.format = static_cast<CalibrationFormat>(99)}), std::invalid_argument);
  EXPECT_THROW(read_calibration(folder / "Calib.toml", {.units = "feet"}), std::invalid_argument);
  EXPECT_THROW(read_calibration(folder / "Calib.toml", {.units = "-1"}), std::invalid_argument);
  expect_refused(folder / "Calib.toml", {"cam0", "5 x 0", "1088 x 1920"}, {.image_width = 5});
}

TEST_F(CalibrationFiles, DamagedText) {
  const auto good = toml(ring(kZUp, kFive));
  const auto with = [&](const std::string &old, const std::string &now) {
    write_text(folder / "Calib.toml", good);
    replace("Calib.toml", old, now);
  };
  with("name = \"cam1\"", "name = \"cam0\"");
  expect_refused(folder / "Calib.toml", {"'cam0' twice"});
  with("rotation = [", "rotation = [nan, ");
  expect_refused(folder / "Calib.toml", {"rotation", "3 or 9", "found 4"});
  with("translation = [", "translation = [nan, 0.0, 0.0]\nother = [");
  expect_refused(folder / "Calib.toml", {"cam0", "NaN"});
  with("distortions = [", "distortions = [inf, 0.0, 0.0, 0.0]\nother = [");
  expect_refused(folder / "Calib.toml", {"cam0", "infinity"});
  with("distortions = [", "distortions = [0.0, 0.0, 0.0]\nother = [");
  expect_refused(folder / "Calib.toml", {"4, 5, 8, 12 or 14", "found 3"});
  with("size = [", "sizes = [");
  expect_refused(folder / "Calib.toml", {"cam0", "--image-size"});
  with("rotation = [", "rotation = [1.0, 0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 0.0, 1.0]\nother = [");
  expect_refused(folder / "Calib.toml", {"cam0", "rotation"});
  with("matrix = [[", "matrix = [[-");
  expect_refused(folder / "Calib.toml", {"cam0", "focal length"});
  with("matrix = [[", "matrix = [");
  expect_refused(folder / "Calib.toml", {"syntax error"});
  write_text(folder / "Calib.toml", good);
  expect_refused(folder / "Calib.toml", {"640 x 480", "1088 x 1920"}, {.image_width = 640, .image_height = 480});
}

TEST_F(CalibrationFiles, MatricesAsListsOfRows) {
  const auto truth = ring(kOurs, kFive);
  for (const Truth &c : truth) {
    const Terms K = K_of(c), R = rows(c.R), t = flat(c.t);
    const auto matrix = [](const Terms &m) {
      return "[[" + list({m[0], m[1], m[2]}) + "], [" + list({m[3], m[4], m[5]}) + "], [" + list({m[6], m[7], m[8]}) + "]]";
    };
    write_text(folder / (c.name + ".json"), "{\"image_size\": [" + std::to_string(c.width) + ", " + std::to_string(c.height) +
                                                "], \"camera_matrix\": " + matrix(K) + ", \"distortion_coefficients\": [[" +
                                                list(c.terms) + "]], \"R\": " + matrix(R) + ", \"T\": [[" + digits(t[0]) +
                                                "], [" + digits(t[1]) + "], [" + digits(t[2]) + "]]}");
  }
  expect_same(read_calibration(folder.path()), truth, kOurs);
  replace("cam0.json", "\"T\": [[", "\"T\": [[\"left\", ");
  expect_refused(folder / "cam0.json", {"expected T", "found none"});
}

TEST_F(CalibrationFiles, SeveralCamerasInOneFile) {
  const auto truth = ring(kOurs, kFive);
  std::string by_name, listed;
  for (const Truth &c : truth) {
    const std::string entry = "\"image_size\": [" + std::to_string(c.width) + ", " + std::to_string(c.height) + "], \"K\": [" +
                              list(K_of(c)) + "], \"dist\": [" + list(c.terms) + "], \"R\": [" + list(rows(c.R)) + "], \"t\": [" +
                              list(flat(c.t)) + "]}";
    by_name += (by_name.empty() ? "" : ", ") + ("\"" + c.name + "\": {") + entry;
    listed += (listed.empty() ? "" : ", ") + ("{\"name\": \"" + c.name + "\", ") + entry;
  }
  for (const std::string &text :
       {"{" + by_name + "}", "{\"date\": \"today\", \"cameras\": {" + by_name + "}}", "{\"cameras\": [" + listed + "]}"}) {
    write_text(folder / "cameras.json", text);
    expect_same(read_calibration(folder / "cameras.json"), truth, kOurs);
  }
  replace("cameras.json", "\"K\": [", "\"K\": [1, ");
  expect_refused(folder / "cameras.json", {"camera_matrix", "9 numbers", "found 10"});
  write_text(folder / "cameras.json", "{\"fl_x\": 1000.0, \"frames\": []}");
  expect_refused(folder / "cameras.json", {"camera_matrix, R and T", "found fl_x, frames"});
}

TEST_F(CalibrationFiles, YamlOfAnotherProgram) {
  write_text(folder / "cam0.yaml", "K:\n- - 1000.0\n  - 0.0\n");
  expect_refused(folder.path(), {"cam0.yaml", "begins with %YAML", "json.dump"});
}

TEST_F(CalibrationFiles, DamagedOpenCV) {
  const auto truth = ring(kOurs, kFive);
  const auto with = [&](const std::string &old, const std::string &now) {
    write_text(folder / "cam0.yml", opencv_yaml(truth[0]));
    replace("cam0.yml", old, now);
  };
  with("rows: 3", "rows: 2000000000");
  expect_refused(folder / "cam0.yml", {"camera_matrix", "9 numbers", "found none"});
  with("T: ", "U: ");
  expect_refused(folder / "cam0.yml", {"cam0.yml", "expected T", "found none"});
  with("image_width", "image_with");
  expect_refused(folder / "cam0.yml", {"--image-size"});
  with("image_width: 1088", "image_width: -1088");
  expect_refused(folder / "cam0.yml", {"--image-size"});
  with("R: ", "camera_model: \"omnidirectional\"\nR: ");
  expect_refused(folder / "cam0.yml", {"omnidirectional", "fisheye"});
  cut("cam0.yml", 300);
  expect_refused(folder / "cam0.yml", {"cam0.yml"});
}

/// OpenCV's parser would never come back from them.
TEST_F(CalibrationFiles, WhatFollowsTheFirstMapping) {
  for (const std::string text : {"%YAML:1.0\n---\n   cols: 3\n s:\n   - \"cam0\"\n", "%YAML:1.0\n---\na: 1\n...\n- 1\n",
                                 "%YAML:1.0\n---\na: 1\n---\n- 1\n-\n", "%YAML:1.0\n---\n{ a: 1 }\nabc\n- 1\n",
                                 "%YAML:1.0\n--- a: 1\nabc\n- 1\n", "%YAML:1.0\n   a: 1\r\nabc\r\n- 1\n"}) {
    write_text(folder / "cam0.yml", text);
    expect_refused(folder / "cam0.yml", {"cam0.yml:", "expected one mapping in the file"});
  }
  const auto truth = ring(kOurs, kFive);
  write_text(folder / "cam0.yml", opencv_yaml(truth[0]) + "# the end\r\n...\n");
  EXPECT_EQ(read_calibration(folder / "cam0.yml", {}).size(), 1u);
}

TEST_F(CalibrationFiles, DamagedColmap) {
  const ColmapModel model{"OPENCV", 4, false, 4, false};
  const auto truth = ring(kOurs, kFour);
  write_colmap_text(folder.path(), model, truth);
  replace("cameras.txt", "OPENCV", "FOV");
  expect_refused(folder.path(), {"cameras.txt: line 2", "'FOV'", "OPENCV_FISHEYE"});
  replace("cameras.txt", "FOV", "FULL_OPENCV");
  expect_refused(folder.path(), {"12 parameters of FULL_OPENCV"});
  write_colmap_text(folder.path(), model, truth);
  expect_refused(folder.path(), {"cam0", "640 x 480", "1088 x 1920"}, {.image_width = 640, .image_height = 480});
  replace("images.txt", " 7 cam0/", " 77 cam0/");
  expect_refused(folder.path(), {"cam0/0001.png", "camera 77"});
  write_colmap_text(folder.path(), model, truth);
  replace("images.txt", "cam1/", "cam0/");
  expect_refused(folder.path(), {"'cam0001' twice"});
  fs::remove(folder / "images.txt");
  expect_refused<FileNotFound>(folder.path(), {"images.txt"});
}

TEST_F(CalibrationFiles, TruncatedColmap) {
  const ColmapModel model{"OPENCV", 4, false, 4, false};
  write_colmap_binary(folder.path(), model, ring(kOurs, kFour));
  const std::string cameras = read_text(folder / "cameras.bin"), images = read_text(folder / "images.bin");
  for (const auto &[name, whole] : {std::pair{"cameras.bin", cameras}, {"images.bin", images}}) {
    for (std::size_t size = 0; size < whole.size(); size += 5) {
      write_text(folder / name, whole.substr(0, size));
      expect_refused(folder.path(), {name, "truncated"});
    }
    std::string many = whole;
    std::memset(many.data(), 0xff, 8);
    write_text(folder / name, many);
    expect_refused(folder.path(), {name, "18446744073709551615 records"});
    write_text(folder / name, whole);
  }
  std::string other = cameras;
  other[12] = 7; // the model FOV
  write_text(folder / "cameras.bin", other);
  expect_refused(folder.path(), {"cameras.bin", "camera 7", "number 7"});
  std::string turned = images;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(turned.data() + 12, &nan, 8);
  write_text(folder / "cameras.bin", cameras);
  write_text(folder / "images.bin", turned);
  expect_refused(folder.path(), {"images.bin", "cam0.jpg", "quaternion"});
}

TEST_F(CalibrationFiles, DamagedQualisys) {
  const std::string good = qualisys(ring(kZUpMillimetres, kFive));
  const auto with = [&](const std::string &old, const std::string &now) {
    write_text(folder / "c.qca.txt", good);
    replace("c.qca.txt", old, now);
  };
  with(" r11=\"", " r11=\"x");
  expect_refused(folder / "c.qca.txt", {"cam0", "r11", "'x"});
  with(" r11=\"", " r11=\"1");
  expect_refused(folder / "c.qca.txt", {"cam0", "rotation"});
  with(" x=\"", " x=\"1e999\" old_x=\"");
  expect_refused(folder / "c.qca.txt", {"x in <transform> to be a number", "1e999"});
  with(" x=\"", " x=\"nan\" old_x=\"");
  expect_refused(folder / "c.qca.txt", {"cam0", "NaN"});
  with(" x=\"", " old_x=\"");
  expect_refused(folder / "c.qca.txt", {"expected x in <transform>", "found none"});
  with("<fov_video", "<fov_film");
  expect_refused(folder / "c.qca.txt", {"cam0", "<fov_video>"});
  with("right=\"", "right=\"-9");
  expect_refused(folder / "c.qca.txt", {"cam0", "1000000 pixels"});
  with("</cameras>", "");
  expect_refused(folder / "c.qca.txt", {"c.qca.txt", "syntax error"});
}

TEST_F(CalibrationFiles, WhatCannotBeWritten) {
  const auto write = [&](const std::function<void(CalibratedCamera &)> &spoil) {
    write_text(folder / "Calib.toml", toml(ring(kZUp, kRational)));
    auto cameras = read_calibration(folder / "Calib.toml");
    spoil(cameras[1]);
    write_calibration(folder / "calibration.yml", cameras);
  };
  EXPECT_NO_THROW(write([](CalibratedCamera &) {}));
  EXPECT_THROW(write_calibration(folder / "calibration.yml", {}), std::invalid_argument);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.camera.name = "cam0"; }), std::invalid_argument);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.camera.name = "1: x"; }), std::invalid_argument);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.camera.width = 0; }), Error);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.lens.distortion[3] = std::nan(""); }), Error);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.lens.distortion.conservativeResize(7); }), std::invalid_argument);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.camera.distortion[0] = 0.1; }), Error);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.camera.K(0, 1) = 2; }), Error);
  EXPECT_THROW(write([](CalibratedCamera &c) { c.late = 100'001; }), Error); // it would not be read again
  write([](CalibratedCamera &c) { c.late = 5; });
  std::string text = read_text(folder / "calibration.yml");
  text.replace(text.find("_late: 5") + 7, 1, "-2147483648"); // which has no absolute value
  write_text(folder / "calibration.yml", text);
  EXPECT_THROW(read_calibration(folder / "calibration.yml"), Error);
}

// --- a session undoes the lens

/// A picture whose blue is x and whose green is y, filmed through the lens: what is read at a pixel says where it was.
class FilmedThroughALens : public CalibrationFiles {
protected:
  static constexpr int kSize = 250;

  Session session_with(const Lens &lens) {
    std::ofstream image(folder / "0.ppm");
    image << "P6 " << kSize << " " << kSize << " 255\n";
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        image << static_cast<char>(0) << static_cast<char>(y) << static_cast<char>(x); // RGB
    image.close();
    fs::copy_file(folder / "0.ppm", folder / "mask0.ppm", fs::copy_options::overwrite_existing);
    Session session;
    session.frame_count = 1;
    session.cameras.resize(1);
    session.cameras[0].video = folder / "%d.ppm";
    session.cameras[0].masks = folder / "mask%d.ppm";
    session.rig.resize(1);
    session.rig[0].K << 180, 0, 122, 0, 175, 127, 0, 0, 1;
    session.rig[0].width = session.rig[0].height = kSize;
    session.lenses = {lens};
    return session;
  }

  void expect_undone(const Lens &lens) {
    const Session session = session_with(lens);
    const Image image = FrameSource::open(session)->image(0, 0);
    const CalibratedCamera filmed{session.rig[0], lens};
    int compared = 0;
    for (int y = 0; y < kSize; y += 7)
      for (int x = 0; x < kSize; x += 7) {
        const Eigen::Vector2d source = filmed.project(session.rig[0].ray_direction(Eigen::Vector2d(x, y)));
        if (source.minCoeff() < 1 || source.maxCoeff() > kSize - 2)
          continue; // beyond the picture's edge
        EXPECT_NEAR(image.at(x, y, 0), source.x(), 0.6) << x << " " << y;
        EXPECT_NEAR(image.at(x, y, 1), source.y(), 0.6) << x << " " << y;
        ++compared;
      }
    EXPECT_GT(compared, 900);
  }
};

Lens make_lens(const Terms &terms, bool fisheye) {
  return {fisheye, Eigen::Map<const Eigen::VectorXd>(terms.data(), static_cast<Eigen::Index>(terms.size()))};
}

TEST_F(FilmedThroughALens, FramesAreThoseOfAPinholeCamera) {
  expect_undone(make_lens(kFisheye, true));
  expect_undone(make_lens({-0.32, 0.09, 1e-3, -2e-3, 0.01, 0.05, -0.02, 0.004}, false));
}

TEST_F(FilmedThroughALens, KeypointsFarOutAreWhereThePinholeSeesThem) {
  const Lens wide = make_lens({0.147, 0, 0, 0, 0, 0.461, 0, 0}, false);
  Session session = session_with(wide);
  const Eigen::Vector3d point(1.3, 0.4, 1);
  const Eigen::Vector2d seen = CalibratedCamera{session.rig[0], wide}.project(point);
  std::vector<double> values;
  for (int k = 0; k < kKeypoints; ++k)
    values.insert(values.end(), {seen.x(), seen.y(), 1});
  Npz file;
  file.set_f8("cam0", {1, kKeypoints, 3}, values);
  file.write(folder / "keypoints.npz");
  session.cameras[0].name = "cam0";
  session.keypoints = folder / "keypoints.npz";
  const Eigen::Vector2d pixel = FrameSource::open(session)->keypoints(0, 0).at(3).pixel;
  EXPECT_LT((pixel - session.rig[0].project(point)).norm(), 0.01);
}

TEST_F(FilmedThroughALens, WithoutALensTheyAreAsFilmed) {
  const Image image = FrameSource::open(session_with({}))->image(0, 0);
  for (int i = 0; i < kSize; i += 9)
    EXPECT_EQ(image.at(i, 17, 0), i);
}

TEST_F(FilmedThroughALens, CleanPlatesAreSeenThroughTheSameLens) {
  Session session = session_with(make_lens(kFisheye, true));
  const auto write_tiles = [&](const std::string &name, bool with_actor) {
    std::ofstream image(folder / name);
    image << "P6 " << kSize << " " << kSize << " 255\n";
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const bool actor = with_actor && std::abs(x - 125) < 30 && std::abs(y - 125) < 50;
        const char grey = static_cast<char>((x / 12 + y / 12) % 2 ? 70 : 190);
        image << (actor ? static_cast<char>(220) : grey) << (actor ? '\0' : grey) << (actor ? '\0' : grey);
      }
  };
  write_tiles("0.ppm", true);
  write_tiles("plate.ppm", false);
  session.cameras[0].background = folder / "plate.ppm";
  session.cameras[0].masks.clear();
  const auto frames = FrameSource::open(session);
  SilhouetteOptions by_plates;
  by_plates.method = SilhouetteMethod::Plates;
  const auto extractor = session_silhouettes(session, *frames, by_plates, {});
  const Image mask = read_view(*frames, 0, 0, extractor.get()).mask;
  EXPECT_EQ(mask.at(125, 125), 255);
  const auto actor = std::count(mask.data.begin(), mask.data.end(), 255);
  EXPECT_GT(actor, 5000);
  EXPECT_LT(actor, 7000); // 59 x 99 on film, and the lens draws the picture together
}

TEST_F(FilmedThroughALens, BeyondTheEdgeAMaskIsEmptyAndAnImageGoesOn) {
  // A pincushion: the corners of the pinhole camera's picture lie beyond those of the film.
  Session session = session_with(make_lens({0.6, 0.2, 0, 0, 0, 0.01, 0, 0}, false));
  std::ofstream white(folder / "mask0.ppm");
  white << "P6 " << kSize << " " << kSize << " 255\n" << std::string(3 * kSize * kSize, static_cast<char>(255));
  white.close();
  const auto frames = FrameSource::open(session);
  const Image mask = frames->mask(0, 0), image = frames->image(0, 0);
  EXPECT_EQ(mask.at(0, 0), 0);
  EXPECT_EQ(mask.at(125, 125), 255);
  EXPECT_EQ(image.at(249, 249, 0), 249);
  session.lenses[0].distortion.conservativeResize(7);
  EXPECT_THROW(FrameSource::open(session)->image(0, 0), std::invalid_argument);
  EXPECT_THROW((CalibratedCamera{session.rig[0], session.lenses[0]}.project({0, 0, 1})), std::invalid_argument);
  session.lenses.resize(2);
  EXPECT_THROW(FrameSource::open(session), std::invalid_argument);
}

} // namespace calibration_file_test
} // namespace doublet
