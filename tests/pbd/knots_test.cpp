// Cloth that has passed through itself.

#include "../../libpbd/src/knots.h"
#include "../../libpbd/src/pack.h"
#include "../../libpbd/src/pbd_model.h"
#include "doublet/pbd/cloth_solver.h"
#include "scenes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace doublet::pbd {
namespace knots_test {

using Eigen::Vector3d;

/// Corners of edges that pass through faces, and of these faces: every edge against every face.
std::set<int> knotted(const Vertices &x, const Faces &faces) {
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      edges.insert(std::minmax(faces(f, k), faces(f, (k + 1) % 3)));
  std::set<int> found;
  for (const auto &[i, j] : edges)
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      const Vector3d a = x.row(i), b = x.row(j), c = x.row(faces(f, 0)), u = x.row(faces(f, 1)).transpose() - c,
                     v = x.row(faces(f, 2)).transpose() - c, n = u.cross(v);
      const double ha = n.dot(a - c), hb = n.dot(b - c);
      if ((faces.row(f).array() == i).any() || (faces.row(f).array() == j).any() || ha * hb >= 0)
        continue;
      const Vector3d p = a + ha / (ha - hb) * (b - a) - c;
      const double s = n.dot(p.cross(v)) / n.squaredNorm(), t = n.dot(u.cross(p)) / n.squaredNorm();
      if (s >= 0 && t >= 0 && s + t <= 1)
        found.insert({i, j, faces(f, 0), faces(f, 1), faces(f, 2)});
    }
  return found;
}

/// Two sheets that hang from their upper edges, one before the other; towards its free lower corner the one behind has passed
/// through the other by as much as `through` (m).
struct Curtains {
  scenes::Sheet both;
  Vertices tangled;
  explicit Curtains(double through) {
    const scenes::Sheet one = scenes::grid(12, 12, 0.03);
    const Eigen::Index n = one.rest.rows(), f = one.faces.rows();
    both.rest.resize(2 * n, 3);
    both.faces.resize(2 * f, 3);
    both.faces << one.faces, (one.faces.array() + static_cast<int>(n)).matrix();
    both.clothness = Eigen::VectorXd::Ones(2 * n);
    tangled.resize(2 * n, 3);
    const double top = one.rest.col(2).maxCoeff(), centre = one.rest.col(0).mean(), right = one.rest.col(0).maxCoeff();
    const double length = top - one.rest.col(2).minCoeff();
    for (Eigen::Index i = 0; i < 2 * n; ++i) {
      const Eigen::RowVector3d flat = one.rest.row(i % n);
      const double across = (flat[0] - centre) / (right - centre), down = (top - flat[2]) / length, behind = i < n ? 0 : 0.03;
      both.rest.row(i) = Eigen::RowVector3d(flat[0], flat[2], behind);
      tangled.row(i) = both.rest.row(i);
      if (i >= n)
        tangled(i, 2) -= (through + 0.03) * down * std::max(0.0, across);
      if (down < 1e-9)
        both.clothness[i] = 0;
    }
  }
  std::shared_ptr<const ClothModel> model() const {
    return ClothModel::create(both.rest, both.faces, both.clothness, ClothOptions{});
  }
};

Array<Vec3f> &fill(Array<Vec3f> &to, const Vertices &x) {
  to.resize(static_cast<int>(x.rows()));
  for (int i = 0; i < to.size(); ++i)
    to[i] = {static_cast<float>(x(i, 0)), static_cast<float>(x(i, 1)), static_cast<float>(x(i, 2))};
  return to;
}

TEST(Knots, AreWhereEdgesPassThroughFaces) {
  for (const double through : {-0.02, 0.01, 0.07}) {
    const Curtains scene(through);
    const PbdModel model(scene.model());
    Array<Vec3f> x;
    Knots<float> knots;
    knots.find(model.arrays(), fill(x, scene.tangled));
    const std::set<int> expected = knotted(scene.tangled, scene.both.faces);
    EXPECT_EQ(expected.empty(), through < 0);
    for (int i = 0; i < x.size(); ++i)
      EXPECT_EQ(knots.at(i), expected.count(i) > 0) << through << ", vertex " << i;
  }
}

TEST(Knots, EachLaneHasItsOwn) {
  const double through[4] = {-0.02, 0.07, 0.01, -0.02};
  std::vector<Curtains> scenes(through, through + 4);
  const PbdModel model(scenes[0].model());
  Array<Vec3<Pack<4>>> x;
  x.resize(model.vertex_count());
  for (int l = 0; l < 4; ++l)
    for (int i = 0; i < x.size(); ++i) {
      x[i].x.lanes[l] = static_cast<float>(scenes[l].tangled(i, 0));
      x[i].y.lanes[l] = static_cast<float>(scenes[l].tangled(i, 1));
      x[i].z.lanes[l] = static_cast<float>(scenes[l].tangled(i, 2));
    }
  Knots<Pack<4>> knots;
  knots.find(model.arrays(), x);
  for (int l = 0; l < 4; ++l) {
    const std::set<int> expected = knotted(scenes[l].tangled, scenes[l].both.faces);
    for (int i = 0; i < x.size(); ++i)
      EXPECT_EQ(knots.at(i).bits[l] != 0, expected.count(i) > 0) << "lane " << l << ", vertex " << i;
  }
}

TEST(Knots, SheetsThatHavePassedThroughEachOtherComeApart) {
  const Curtains scene(0.06);
  const auto solver = ClothSolver::create(scene.model());
  ClothState state = initial_state(scene.tangled);
  StepInputs in;
  in.targets = &scene.both.rest;
  Material material;
  material.k_damping = 0.05;
  EXPECT_GT(knotted(state.positions, scene.both.faces).size(), 20u);
  for (int i = 0; i < 80; ++i)
    solver->step(state, in, material);
  EXPECT_EQ(knotted(state.positions, scene.both.faces).size(), 0u);
}

} // namespace knots_test
} // namespace doublet::pbd
