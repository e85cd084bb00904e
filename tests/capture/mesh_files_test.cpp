// Mesh files that are damaged, or that other programs write in their own way.
#include "capture/capture_shapes.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace doublet {
namespace mesh_files_test {

using testing::TempFolder;

const std::string kVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string ply(const std::string &faces, const std::string &count = "1", const std::string &vertices = kVertices,
                const std::string &vertex_count = "4") {
  return "ply\nformat ascii 1.0\nelement vertex " + vertex_count +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + count +
         "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

/// What is said about a file of this content; empty if it was read.
std::string refusal(const std::string &name, const std::string &content) {
  const TempFolder folder;
  write_text(folder / name, content);
  try {
    read_mesh(folder / name);
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

Mesh read(const std::string &name, const std::string &content) {
  const TempFolder folder;
  write_text(folder / name, content);
  return read_mesh(folder / name);
}

struct Bad {
  const char *name;
  std::string content;
  const char *said;
};

TEST(MeshFiles, DamagedOnesAreRefusedInOneSentence) {
  const TempFolder folder;
  write_mesh(folder / "whole.ply", testing::capsule(0.1, 0, 0.5, 20, 10));
  write_mesh(folder / "whole.stl", testing::capsule(0.1, 0, 0.5, 20, 10));
  const std::string whole = read_text(folder / "whole.ply"), stl = read_text(folder / "whole.stl");
  std::string longer = whole, inserted = whole, huge = whole, index = whole, counted = stl;
  longer += 'x';
  inserted.insert(whole.size() - 100, 1, '\0');
  huge.replace(huge.find("element face ") + 13, 1, "9999999");
  std::memset(index.data() + index.size() - 4, 0x7F, 4);
  std::memset(counted.data() + 80, 0xFF, 4);
  const std::vector<Bad> cases = {
      {"a.ply", ply("0\n"), "3 corners"},
      {"a.ply", ply("2 0 1\n"), "3 corners"},
      {"a.ply", ply("-1 0 1\n"), "room for"},
      {"a.ply", ply("3 0 1 4\n"), "corners in range"},
      {"a.ply", ply("3 0 1 -2\n"), "corners in range"},
      {"a.ply", ply("3 0 1 1e300\n"), "corners in range"},
      {"a.ply", ply("2000000000 0 1 2\n"), "room for"},
      {"a.ply", ply("3 0 1 2\n", "4000000000"), "room for"},
      {"a.ply", ply("3 0 1 2\n", "100"), "bytes for them"},
      {"a.ply", ply("3 0 1 2\n", "3"), "the end"},
      {"a.ply", ply("3 0 1 2\n", "-1"), "a number of elements"},
      {"a.ply", ply("3 0 1 2\n3 0 2 3\n"), "found more"},
      {"a.ply", ply("3 0 1 2\n", "1", "nan 0 0\n1 0 0\n1 1 0\n0 1 0\n"), "finite vertices"},
      {"a.ply", ply("", "0"), "0 faces"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "x, y and z"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty blob x\nend_header\n0\n", "a type such as"},
      {"a.ply", "ply\nend_header\n", "format"},
      {"a.ply", "ply\nformat ascii 1.0\n", "end_header"},
      {"a.ply", "not a mesh", "a PLY file"},
      {"a.ply", "", "a PLY file"},
      {"a.ply", whole.substr(0, whole.size() / 2), "found"},
      {"a.ply", longer, "found more"},
      {"a.ply", inserted, "found"},
      {"a.ply", huge, "found"},
      {"a.ply", index, "corners in range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "corners in range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "counted from 1"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n", "corners in range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "3 corners"},
      {"a.obj", "v 0 0\nf 1 1 1\n", "three coordinates"},
      {"a.obj", "v 0 0 x\nf 1 1 1\n", "three coordinates"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/2 junk\n", "corners of a face"},
      {"a.obj", "", "0 vertices"},
      {"a.stl", stl.substr(0, stl.size() - 1), "bytes"},
      {"a.stl", counted, "bytes"},
      {"a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\nendloop\n", "coordinates"},
      {"a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", "finite"},
      {"a.stl", "solid a\nendsolid a\n", "0 vertices"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "corners in range"},
      {"a.off", "OFF\n3000000000 1 0\n0 0 0\n", "room for"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "3 corners"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "found"},
      {"a.off", "CUBE\n", "an OFF file"},
  };
  for (const Bad &bad : cases) {
    const std::string said = refusal(bad.name, bad.content);
    EXPECT_NE(said.find(bad.said), std::string::npos) << bad.content.substr(0, 300) << "\nsaid: " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(MeshFiles, PolygonsBecomeFansAndOtherPropertiesAreSkipped) {
  const Mesh quad = read("a.ply", ply("4 0 1 2 3\n"));
  EXPECT_EQ(quad.faces.rows(), 2);
  EXPECT_DOUBLE_EQ(face_areas(quad.vertices, quad.faces).sum(), 1.0);
  const Mesh rich = read(
      "a.ply", "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nelement vertex 3\r\nproperty uchar red\r\nproperty float x\r\n"
               "property float y\r\nproperty double z\r\nproperty list uchar float more\r\nelement face 1\r\n"
               "property list uint8 uint32 vertex_index\r\nproperty float quality\r\nelement edge 1\r\nproperty int vertex1\r\n"
               "end_header\r\n9 0 0 5 0\r\n9 1 0 5 2 1 1\r\n9 0 1 5 0\r\n3 0 1 2 0.5\r\n0\r\n");
  EXPECT_EQ(rich.vertices.rows(), 3);
  EXPECT_DOUBLE_EQ(rich.vertices(2, 2), 5);
  const Mesh obj =
      read("a.obj", "# by hand\nmtllib ../../elsewhere.mtl\nv 0 0 0 1 0 0\nv +1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                    "usemtl red\nf 1/1/1 2//1 3 -1\n");
  EXPECT_EQ(obj.faces.rows(), 2);
  EXPECT_EQ(read("a.off", "COFF # coloured\n# and commented\n4 1 0\n0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3 1\n")
                .faces.rows(),
            2);
  EXPECT_EQ(read("a.stl", "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                          "endfacet\nendsolid a b\n")
                .faces.rows(),
            1);
}

TEST(MeshFiles, PlyOfAnyLineEndsAndWithAByteOrderMark) {
  std::string old = ply("3 0 1 2\n");
  std::replace(old.begin(), old.end(), '\n', '\r');
  EXPECT_EQ(read("a.ply", old).faces.rows(), 1);
  EXPECT_EQ(read("a.ply", "\xEF\xBB\xBF" + ply("3 0 1 2\n")).faces.rows(), 1);
  EXPECT_NE(refusal("a.ply", "ply\rend_header\r").find("format"), std::string::npos);
  EXPECT_NE(refusal("a.ply", "ply\r").find("end_header"), std::string::npos);
  const TempFolder folder;
  const Mesh mesh = testing::capsule(0.1, 0, 0.5, 20, 10);
  write_mesh(folder / "a.ply", mesh);
  std::string raw = read_text(folder / "a.ply");
  const auto body = raw.begin() + static_cast<std::ptrdiff_t>(raw.find("end_header\n") + 11);
  ASSERT_NE(std::find(body, raw.end(), '\r'), raw.end()) << "numbers have such a byte, which stays";
  std::replace(raw.begin(), body, '\n', '\r');
  EXPECT_EQ(read("a.ply", raw).vertices, mesh.vertices);
}

TEST(MeshFiles, BigEndianAndExactNumbers) {
  std::string big = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar short vertex_indices\nend_header\n";
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) {
    char raw[4];
    std::memcpy(raw, &x, 4);
    big.append({raw[3], raw[2], raw[1], raw[0]});
  }
  big.append({3, 0, 0, 0, 1, 0, 2});
  EXPECT_DOUBLE_EQ(read("a.ply", big).vertices(2, 1), 2);

  Mesh mesh = testing::capsule(0.1, 0, 0.5, 20, 10);
  mesh.vertices *= 1.0 / 3;
  const TempFolder folder;
  for (const char *name : {"a.ply", "a.obj", "a.off"}) {
    write_mesh(folder / name, mesh);
    EXPECT_EQ(read_mesh(folder / name).vertices, mesh.vertices) << name;
    EXPECT_EQ(read_mesh(folder / name).faces, mesh.faces) << name;
  }
}

TEST(PoseSurface, RefusesAnOffsetOfAnotherLength) {
  RiggedMesh actor;
  actor.skeleton = testing::figure_skeleton();
  actor.mesh = testing::capsule(0.1, 0, 0.5, 20, 10);
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  actor.weights =
      MatrixRM::Constant(actor.mesh.vertices.rows(), actor.skeleton.joint_count(), 1.0 / actor.skeleton.joint_count());
  const Eigen::VectorXd dofs = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
  EXPECT_EQ(pose_surface(actor, dofs, Vertices(0, 3)).vertices.rows(), actor.mesh.vertices.rows());
  EXPECT_THROW(pose_surface(actor, dofs, Vertices::Zero(3, 3)), std::invalid_argument);
  EXPECT_THROW(pose_surface(actor, dofs.head(2), Vertices(0, 3)), std::invalid_argument);
  EXPECT_THROW(pose_surface(actor, dofs * NAN, Vertices(0, 3)), std::invalid_argument);
  actor.weights.conservativeResize(5, Eigen::NoChange);
  EXPECT_THROW(pose_surface(actor, dofs, Vertices(0, 3)), std::invalid_argument);
}

} // namespace mesh_files_test
} // namespace doublet
