#include "doublet/core/mesh.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/connected_sets.h"
#include "support/meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <limits>
#include <map>
#include <random>

namespace doublet {

using testing::make_mesh;

TEST(Mesh, ReportsGoodMeshes) {
  const MeshReport ball = report_mesh(testing::sphere(1));
  EXPECT_TRUE(ball.usable() && ball.closed());
  EXPECT_EQ(ball.components, 1);
  const MeshReport sheet = report_mesh(testing::grid(1, 1, 4, 3));
  EXPECT_EQ(sheet.boundary_edges, 14);
  EXPECT_FALSE(sheet.closed());
  EXPECT_EQ(report_mesh(testing::join({testing::sphere(1), testing::grid(1, 1, 1, 1)})).components, 2);
}

TEST(Mesh, ReportSurvivesAnything) {
  EXPECT_FALSE(report_mesh({}).usable());
  Mesh mesh = testing::grid(1, 1, 4, 4);
  mesh.vertices(3, 1) = std::numeric_limits<double>::quiet_NaN();
  mesh.faces(0, 0) = -7;
  mesh.faces(1, 2) = INT_MAX;
  mesh.faces(2, 1) = INT_MIN;
  mesh.faces.row(3).setConstant(5);
  const MeshReport r = report_mesh(mesh);
  EXPECT_EQ(r.non_finite_vertices, 1);
  EXPECT_EQ(r.out_of_range_faces, 3);
  EXPECT_GE(r.degenerate_faces, 1);
  EXPECT_FALSE(r.usable());
  EXPECT_THROW(require_usable(mesh, "scan.ply"), Error);
  try {
    require_usable(mesh, "scan.ply");
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("scan.ply: expected"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("1 non-finite vertices"), std::string::npos);
  }
  Mesh points; // no faces, only vertices
  points.vertices = Vertices::Random(5, 3);
  EXPECT_EQ(report_mesh(points).unused_vertices, 5);
}

TEST(Mesh, FindsNonManifoldEdges) {
  const std::vector<Eigen::Vector3d> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  EXPECT_EQ(report_mesh(make_mesh(v, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})).non_manifold_edges, 1); // three faces
  EXPECT_EQ(report_mesh(make_mesh(v, {{0, 1, 2}, {0, 1, 3}})).non_manifold_edges, 1);            // one is turned over
}

TEST(Mesh, IndexFunctionsRefuseCornersOutOfRange) {
  Mesh mesh = testing::grid(1, 1, 2, 2);
  mesh.faces(1, 1) = 99;
  EXPECT_THROW(face_normals(mesh.vertices, mesh.faces), std::invalid_argument);
  EXPECT_THROW(vertex_normals(mesh.vertices, mesh.faces), std::invalid_argument);
  EXPECT_THROW(face_areas(mesh.vertices, mesh.faces), std::invalid_argument);
  EXPECT_THROW(mean_edge_length(mesh.vertices, mesh.faces), std::invalid_argument);
  EXPECT_THROW(cotangent_laplacian(mesh.vertices, mesh.faces), std::invalid_argument);
  EXPECT_THROW(vertex_neighbours(mesh.faces, 9), std::invalid_argument);
  EXPECT_THROW(vertex_components(mesh.faces, 9), std::invalid_argument);
  EXPECT_THROW(submesh(mesh, {1}), std::invalid_argument);
  EXPECT_THROW(submesh(mesh, {-1}), std::invalid_argument);
}

TEST(Mesh, NormalsAndAreasOfASphere) {
  const Mesh ball = testing::sphere(2, {1, 2, 3}, 48, 96);
  const Vertices n = vertex_normals(ball.vertices, ball.faces);
  for (int v = 0; v < n.rows(); ++v)
    EXPECT_GT(n.row(v).dot((ball.vertices.row(v) - Eigen::RowVector3d(1, 2, 3)) / 2), 0.998);
  EXPECT_NEAR(face_areas(ball.vertices, ball.faces).sum(), 4 * testing::pi * 4, 0.2);
  EXPECT_NEAR(vertex_areas(ball.vertices, ball.faces).sum(), face_areas(ball.vertices, ball.faces).sum(), 1e-9);
}

TEST(Mesh, DegenerateFacesHaveNoNormal) {
  const Mesh m = make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}});
  EXPECT_TRUE(face_normals(m.vertices, m.faces).isZero());
  EXPECT_TRUE(vertex_normals(m.vertices, m.faces).isZero());
  for (const Triplet &t : cotangent_laplacian(m.vertices, m.faces))
    EXPECT_EQ(t.value, 0);
}

TEST(Mesh, EdgesNeighboursComponents) {
  const Mesh sheet = testing::grid(2, 1, 2, 1); // 0 1 2 / 3 4 5
  const EdgeTopology topology = edge_topology(sheet.faces);
  EXPECT_EQ(topology.edges.size(), 9u);
  EXPECT_TRUE(std::is_sorted(topology.edges.begin(), topology.edges.end(),
                             [](const auto &a, const auto &b) { return std::pair(a[0], a[1]) < std::pair(b[0], b[1]); }));
  int inner = 0;
  for (const Eigen::Vector2i &f : topology.edge_faces)
    inner += f[1] >= 0;
  EXPECT_EQ(inner, 3);
  EXPECT_EQ(vertex_neighbours(sheet.faces, 7)[1], (std::vector<int>{0, 2, 3, 4}));
  EXPECT_TRUE(vertex_neighbours(sheet.faces, 7)[6].empty());
  int count = 0;
  const Mesh two = testing::join({testing::grid(1, 1, 1, 1), testing::grid(1, 1, 1, 1)});
  const Eigen::VectorXi component = vertex_components(two.faces, 9, &count);
  EXPECT_EQ(count, 2);
  EXPECT_EQ(component, (Eigen::VectorXi(9) << 0, 0, 0, 0, 1, 1, 1, 1, -1).finished());
  EXPECT_NEAR(mean_edge_length(two.vertices, two.faces), (4 + std::sqrt(2.0)) / 5, 1e-12);
}

TEST(Mesh, EveryUnusableMeshIsRefusedByWhatItsReportSays) {
  const Mesh good = testing::grid(1, 1, 4, 4);
  require_usable(good, "scan.ply");
  for (int fault = 0; fault < 5; ++fault) {
    Mesh mesh = good;
    if (fault == 0)
      mesh.vertices(7, 2) = std::numeric_limits<double>::infinity();
    else if (fault == 1)
      mesh.faces(5, 1) = -1;
    else if (fault == 2)
      mesh.faces(5, 1) = static_cast<int>(mesh.vertices.rows());
    else if (fault == 3)
      mesh.faces.resize(0, 3);
    else
      mesh = {};
    EXPECT_FALSE(report_mesh(mesh).usable()) << fault;
    EXPECT_THROW(require_usable(mesh, "scan.ply"), Error) << fault;
  }
}

TEST(Mesh, EdgesOfAnyFacesAreSortedWithTheirFirstTwoFaces) {
  std::mt19937 random(3);
  const std::vector<int> odd{0, INT_MAX, INT_MIN}; // added to one vertex: what no mesh has
  for (const int more : odd) {
    Faces faces(400, 3); // of 40 vertices: edges of many faces, faces with repeated vertices
    for (int &v : faces.reshaped())
      v = static_cast<int>(random() % 40);
    faces(17, 1) = more != 0 ? more : faces(17, 1);
    std::map<std::pair<int, int>, std::vector<int>> expected;
    for (int f = 0; f < faces.rows(); ++f)
      for (int k = 0; k < 3; ++k)
        if (const int a = faces(f, k), b = faces(f, (k + 1) % 3); a != b)
          expected[std::minmax(a, b)].push_back(f);
    const EdgeTopology found = edge_topology(faces);
    ASSERT_EQ(found.edges.size(), expected.size());
    std::size_t e = 0;
    for (const auto &[edge, beside] : expected) {
      EXPECT_EQ(found.edges[e], Eigen::Vector2i(edge.first, edge.second));
      EXPECT_EQ(found.edge_faces[e], Eigen::Vector2i(beside[0], beside.size() > 1 ? beside[1] : -1));
      ++e;
    }
  }
}

TEST(Mesh, ConnectedSetsAreThoseOfTheChosen) {
  const auto neighbours = vertex_neighbours(testing::grid(4, 1, 4, 1).faces, 10); // 0 1 2 3 4 / 5 6 7 8 9
  const std::vector<char> chosen{1, 1, 0, 0, 1, 0, 0, 0, 0, 1};
  EXPECT_EQ(connected_sets(neighbours, chosen), (std::vector<std::vector<int>>{{0, 1}, {4, 9}}));
  EXPECT_TRUE(connected_sets(neighbours, std::vector<char>(10, 0)).empty());
}

TEST(Mesh, LaplacianIsPositiveSemidefiniteAndKnowsLinearFunctions) {
  Mesh sheet = testing::grid(1, 1, 6, 6);
  sheet.vertices.col(0) += 0.5 * sheet.vertices.col(2); // nearly equilateral, so that no weight is clamped
  sheet.vertices.col(2) *= std::sqrt(0.75);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.02, 0.02);
  for (int v = 0; v < sheet.vertices.rows(); ++v)
    sheet.vertices.row(v) += Eigen::RowVector3d(jitter(random), 0, jitter(random));
  const int n = static_cast<int>(sheet.vertices.rows());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  for (const Triplet &t : cotangent_laplacian(sheet.vertices, sheet.faces))
    L(t.row, t.col) += t.value;
  EXPECT_LT((L - L.transpose()).norm(), 1e-12);
  EXPECT_LT(L.rowwise().sum().norm(), 1e-9);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(L).eigenvalues().minCoeff(), -1e-9);
  const Eigen::VectorXd Lx = L * sheet.vertices.col(0);
  for (int i = 1; i < 6; ++i)
    for (int k = 1; k < 6; ++k)
      EXPECT_NEAR(Lx[i * 7 + k], 0, 1e-9); // zero inside for a linear function
}

TEST(Mesh, SubmeshKeepsChosenFaces) {
  const Mesh sheet = testing::grid(1, 1, 2, 2);
  std::vector<int> from;
  const Mesh part = submesh(sheet, {7, 6}, &from);
  EXPECT_EQ(part.faces.rows(), 2);
  EXPECT_EQ(from, (std::vector<int>{4, 5, 7, 8}));
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(from[part.faces(f, k)], sheet.faces(7 - f, k));
}

} // namespace doublet
