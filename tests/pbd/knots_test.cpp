// Cloth that has passed through itself.

#include "../../libpbd/src/knots.h"
#include "../../libpbd/src/pack.h"
#include "../../libpbd/src/pbd_model.h"
#include "../../libpbd/src/self_collision.h"
#include "doublet/pbd/cloth_solver.h"
#include "knotted.h"
#include "scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace doublet::pbd {
namespace knots_test {

using Eigen::Vector3d;
using scenes::knotted;

/// Two sheets in one, the second `away` (m) from the first.
scenes::Sheet doubled(const scenes::Sheet &one, const Eigen::RowVector3d &away) {
  const Eigen::Index n = one.rest.rows(), f = one.faces.rows();
  scenes::Sheet both{Vertices(2 * n, 3), Faces(2 * f, 3), Eigen::VectorXd(2 * n)};
  both.rest << one.rest, one.rest.rowwise() + away;
  both.faces << one.faces, (one.faces.array() + static_cast<int>(n)).matrix();
  both.clothness << one.clothness, one.clothness;
  return both;
}

/// Two sheets that hang from their upper edges, one before the other; towards its free lower corner the one behind has passed
/// through the other by as much as `through` (m).
struct Curtains {
  scenes::Sheet both;
  Vertices tangled;
  explicit Curtains(double through) {
    const scenes::Sheet one = scenes::grid(12, 12, 0.03);
    const Eigen::Index n = one.rest.rows();
    both = doubled(one, {0, 0, 0});
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

Array<Point> &fill(Array<Point> &to, const Vertices &x) {
  to.resize(static_cast<int>(x.rows()));
  for (int i = 0; i < to.size(); ++i)
    to[i] = Vec3f{static_cast<float>(x(i, 0)), static_cast<float>(x(i, 1)), static_cast<float>(x(i, 2))};
  return to;
}

TEST(Knots, AreWhereEdgesPassThroughFaces) {
  for (const double through : {-0.02, 0.01, 0.07}) {
    const Curtains scene(through);
    const PbdModel model(scene.model());
    Array<Point> x;
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
  in.targets = scene.both.rest;
  Material material;
  material.k_damping = 0.05;
  EXPECT_GT(knotted(state.positions, scene.both.faces).size(), 20u);
  for (int i = 0; i < 80; ++i)
    solver->step(state, in, material);
  EXPECT_EQ(knotted(state.positions, scene.both.faces).size(), 0u);
}

/// Two sheets whose upright lower edges cross like an X fall on each other edge to edge: no vertex meets a face.
TEST(Knots, EdgesDoNotPassThroughEdges) {
  Vertices rest(6, 3);
  rest << -0.05, 0, 0, 0.05, 0, 0, 0, -0.1, 0, 0, 0.02, -0.05, 0, 0.02, 0.05, 0, 0.12, 0;
  Faces faces(2, 3);
  faces << 0, 1, 2, 3, 4, 5;
  Eigen::VectorXd clothness = Eigen::VectorXd::Ones(6);
  clothness.head(3).setZero();
  Material material;
  material.d_n = material.d_t = 0;
  for (const bool edges : {false, true}) {
    ClothOptions options;
    options.edge_collision = edges;
    const auto solver = ClothSolver::create(ClothModel::create(rest, faces, clothness, options));
    ClothState state = initial_state(rest);
    StepInputs in;
    in.targets = rest;
    double lowest = 1;
    for (int i = 0; i < 8; ++i) {
      solver->step(state, in, material);
      lowest = std::min(lowest, state.positions(3, 1));
    }
    if (edges)
      EXPECT_NEAR(lowest, options.self_thickness, 5e-4);
    else
      EXPECT_LT(lowest, -0.05);
  }
}

TEST(Knots, CrossingsAreMovedApartWhereEdgesCollide) {
  const Curtains scene(0.012);
  ClothOptions options;
  options.edge_collision = true;
  options.gravity.setZero();
  const auto solver = ClothSolver::create(ClothModel::create(scene.both.rest, scene.both.faces, scene.both.clothness, options));
  ClothState state = initial_state(scene.tangled);
  StepInputs in;
  in.targets = scene.both.rest;
  Material limp;
  limp.k_bend = 0;
  EXPECT_GT(knotted(state.positions, scene.both.faces).size(), 10u);
  for (int i = 0; i < 20; ++i)
    solver->step(state, in, limp);
  EXPECT_EQ(knotted(state.positions, scene.both.faces).size(), 0u);
}

/// By what it is at rest.
double longest_edge(const scenes::Sheet &sheet, const Vertices &x) {
  double longest = 0;
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int p = sheet.faces(f, k), q = sheet.faces(f, (k + 1) % 3);
      longest = std::max(longest, (x.row(p) - x.row(q)).norm() / (sheet.rest.row(p) - sheet.rest.row(q)).norm());
    }
  return longest;
}

/// Six rods press a skirt flat from before and behind, nearer than there is room for its folds: contacts that held on to all of
/// them would pull the cloth to three times its length, for good.
TEST(Knots, WhatIsSqueezedIsNotPulledOut) {
  const scenes::Sheet skirt = scenes::skirt(40, 18);
  ClothOptions options;
  options.edge_collision = true;
  const auto solver = ClothSolver::create(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options));
  const auto rods = [](int frame) {
    const double z = 0.5 * (1 - std::min(1.0, frame / 30.0));
    std::vector<Capsule> all;
    for (const double side : {-z, z})
      for (const double x : {-0.15, 0.0, 0.15})
        all.push_back({{x, 0.45, side}, {x, 0.75, side}, 0.12, 0.12});
    return all;
  };
  ClothState state = initial_state(skirt.rest);
  Material material;
  material.k_damping = 0.05;
  std::vector<Capsule> before, now = rods(0);
  StepInputs in;
  in.targets = skirt.rest;
  double longest = 0; // once the rods stand still
  for (int i = 1; i <= 70; ++i) {
    before = now;
    now = rods(i);
    in.previous_capsules = before;
    in.capsules = now;
    solver->step(state, in, material);
    if (i > 50)
      longest = std::max(longest, longest_edge(skirt, state.positions));
  }
  EXPECT_LT(longest, 1.8);
}

/// A rod inside a skirt goes off with its front: the cloth lets go of it before it is longer than twice its length.
TEST(Knots, WhatIsDraggedOffIsNotLongerThanTwiceItsLength) {
  const scenes::Sheet skirt = scenes::skirt(40, 18);
  const auto dragged = [&](bool edge_collision) {
    ClothOptions options;
    options.edge_collision = edge_collision;
    const auto solver = ClothSolver::create(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options));
    ClothState state = initial_state(skirt.rest);
    std::vector<Capsule> before, now{{{0, 0.5, 0}, {0, 0.8, 0}, 0.04, 0.04}};
    StepInputs in;
    in.targets = skirt.rest;
    double longest = 0;
    for (int i = 0; i < 30; ++i) {
      before = now;
      now[0].p0[2] = now[0].p1[2] = 0.05 * i;
      in.previous_capsules = before;
      in.capsules = now;
      solver->step(state, in, Material{});
      longest = std::max(longest, longest_edge(skirt, state.positions));
    }
    return longest;
  };
  EXPECT_GT(dragged(false), 2.5); // 2.7
  EXPECT_LT(dragged(true), 1.9);
}

/// A corner of free cloth that has been pulled out comes back within a frame, and the cloth as a whole goes nowhere.
TEST(Knots, WhatIsFarTooLongIsBroughtBackFromBothEnds) {
  const scenes::Sheet sheet = scenes::grid(12, 12, 0.025);
  ClothOptions options;
  options.edge_collision = true;
  options.gravity.setZero();
  const Eigen::VectorXd free = Eigen::VectorXd::Ones(sheet.rest.rows());
  const auto solver = ClothSolver::create(ClothModel::create(sheet.rest, sheet.faces, free, options));
  ClothState state = initial_state(sheet.rest);
  const Eigen::RowVector3d direction = Eigen::RowVector3d(1, 0, 1).normalized();
  for (Eigen::Index v = 0; v < state.positions.rows(); ++v)
    state.positions.row(v) +=
        6 * std::max(0.0, (sheet.rest.row(v) - sheet.rest.colwise().mean()).dot(direction) - 0.1) * direction;
  EXPECT_GT(longest_edge(sheet, state.positions), 6);
  Material soft;
  soft.k_stretch = 0.01;
  soft.d_n = soft.d_t = 0;
  Eigen::RowVectorXd mass = Eigen::RowVectorXd::Zero(sheet.rest.rows()); // all triangles are equal
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      mass[sheet.faces(f, k)] += 1;
  mass /= mass.sum();
  const Eigen::RowVector3d middle = mass * state.positions;
  StepInputs in;
  in.targets = sheet.rest;
  solver->step(state, in, soft);
  EXPECT_LT(longest_edge(sheet, state.positions), 1.9);
  EXPECT_LT((mass * state.positions - middle).norm(), 1e-5);
}

/// Two sheets, held at their borders, lie one over the other; a ball from below pushes the lower one into the upper and
/// stretches both.
struct Covered {
  scenes::Sheet both;
  Covered() {
    scenes::Sheet one = scenes::grid(14, 14, 0.025);
    const double border = one.rest.col(0).maxCoeff() - 1e-9;
    for (Eigen::Index i = 0; i < one.rest.rows(); ++i)
      one.clothness[i] = one.rest.row(i).cwiseAbs().maxCoeff() < border;
    both = doubled(one, {0.006, 0.02, 0.004});
  }
  /// Vertices in knots while the ball comes up at a speed (m/s), at most, and half a second later.
  std::pair<std::size_t, std::size_t> pushed(double speed, double height) const {
    ClothOptions options;
    options.edge_collision = true;
    const auto solver = ClothSolver::create(ClothModel::create(both.rest, both.faces, both.clothness, options));
    ClothState state = initial_state(both.rest);
    std::vector<Capsule> before, now{{{0, -0.08, 0}, {0, -0.08, 0}, 0.05, 0.05}};
    StepInputs in;
    in.targets = both.rest;
    const auto rise = [&](double by) {
      before = now;
      now[0].p0[1] += by;
      now[0].p1[1] += by;
      in.previous_capsules = before;
      in.capsules = now;
      solver->step(state, in, Material{});
    };
    const int frames = static_cast<int>(std::ceil(height / (speed * in.dt)));
    std::size_t most = 0;
    for (int i = 0; i < frames; ++i) {
      rise(height / frames);
      most = std::max(most, knotted(state.positions, both.faces).size());
    }
    for (int i = 0; i < 20; ++i)
      rise(0);
    return {most, knotted(state.positions, both.faces).size()};
  }
};

TEST(Knots, WhatAProxyPushesStaysUnderTheClothAboveIt) {
  for (const double speed : {0.5, 2.0}) {
    const auto [most, left] = Covered().pushed(speed, 0.06);
    EXPECT_EQ(most, 0u) << speed << " m/s";
    EXPECT_EQ(left, 0u) << speed << " m/s";
  }
}

/// Vertices where the rest shape passes through itself have no contacts where edges collide, nor are they moved: it rests.
TEST(Knots, WhatIsInAKnotAtRestIsLeftAlone) {
  Curtains scene(0.06);
  const Eigen::Index behind = scene.tangled.rows() / 2; // not edge on edge, where rounding decides what passes through
  scene.tangled.bottomRows(behind).rowwise() += Eigen::RowVector3d(0.0071, 0.0053, 0);
  ClothOptions options;
  options.edge_collision = true;
  options.gravity.setZero();
  const auto model = ClothModel::create(scene.tangled, scene.both.faces, scene.both.clothness, options);
  const PbdModel laid_out(model);
  const LaneModel &m = laid_out.arrays();
  const std::set<int> expected = knotted(scene.tangled, scene.both.faces);
  EXPECT_EQ(std::set<int>(m.resting_knots, m.resting_knots + m.resting_knot_count), expected);
  Array<Point> x;
  Knots<float> knots;
  knots.find(m, fill(x, scene.tangled));
  for (const int v : expected)
    EXPECT_TRUE(knots.strained(v)) << v;
  knots.untangle(m, x);
  Array<Point> before;
  fill(before, scene.tangled);
  for (int i = 0; i < x.size(); ++i)
    EXPECT_EQ(dot(x[i] - before[i], x[i] - before[i]), 0.0f) << i;
}

/// Every pair of edges that comes near is found: against all pairs.
TEST(Knots, TheTreeFindsEveryPairOfEdges) {
  const Curtains scene(0.03);
  ClothOptions options;
  options.edge_collision = true;
  const PbdModel model(ClothModel::create(scene.both.rest, scene.both.faces, scene.both.clothness, options));
  const LaneModel &m = model.arrays();
  Array<Point> x, p;
  fill(x, scene.both.rest);
  fill(p, scene.tangled);
  Knots<float> knots;
  knots.find(m, x);
  SelfCollision<float> search;
  Array<SelfContact<float>> faces;
  Array<EdgeContact<float>> found;
  search.find(m, x, p, 0.001f, knots, faces, found);
  std::set<std::array<int, 4>> pairs;
  for (const EdgeContact<float> &c : found)
    EXPECT_TRUE(pairs.insert({c.a, c.b, c.c, c.d}).second); // once
  std::set<std::array<int, 4>> expected;
  for (int i = 0; i < m.edge_count; ++i)
    for (int j = i + 1; j < m.edge_count; ++j) {
      const int v[] = {m.edges[i].a, m.edges[i].b, m.edges[j].a, m.edges[j].b};
      const Vec3f start[] = {x[v[0]], x[v[1]], x[v[2]], x[v[3]]}, end[] = {p[v[0]], p[v[1]], p[v[2]], p[v[3]]};
      const bool joined = v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3];
      const bool strained = std::any_of(v, v + 4, [&](int k) { return knots.strained(k); });
      if (!joined && !strained && meeting_of_edges(start, end, m.self_thickness, true).lanes &&
          !is_among(m.resting_edges, m.resting_edge_count, i, j))
        expected.insert({v[0], v[1], v[2], v[3]});
    }
  EXPECT_EQ(pairs, expected);
  EXPECT_GT(expected.size(), 20u);
  // And of vertices and faces what the other search finds, which leaves out nothing that is near.
  const auto contacts_of = [](const Array<SelfContact<float>> &contacts) {
    std::set<std::array<int, 4>> all;
    for (int i = 0; i < contacts.size(); ++i)
      EXPECT_TRUE(all.insert({contacts[i].q, contacts[i].a, contacts[i].b, contacts[i].c}).second);
    return all;
  };
  const PbdModel plain(scene.model());
  Array<SelfContact<float>> by_face;
  search.find(plain.arrays(), x, p, 0.001f, knots, by_face, found);
  EXPECT_EQ(contacts_of(by_face), contacts_of(faces));
  EXPECT_GT(by_face.size(), 20);
}

/// A strip that was flat in the frame before, and all of whose patches lie near to each other, falls onto itself from a fold.
TEST(Knots, WhatASolverHasSeenBeforeChangesNoBit) {
  const scenes::Sheet strip = scenes::grid(6, 2, 0.02);
  Vertices folded = strip.rest;
  for (Eigen::Index i = 0; i < folded.rows(); ++i)
    if (folded(i, 0) > 0)
      folded.row(i) += Eigen::RowVector3d(0.02 - 2 * folded(i, 0), 0.006, 0.005);
  ClothOptions options;
  options.edge_collision = true;
  const auto model = ClothModel::create(strip.rest, strip.faces, strip.clothness, options);
  const auto solver = ClothSolver::create(model), fresh = ClothSolver::create(model);
  Material limp;
  limp.k_bend = 0;
  StepInputs in;
  ClothState flat = initial_state(strip.rest), again = initial_state(folded);
  for (Eigen::Index i = 0; i < folded.rows(); ++i)
    again.velocities(i, 1) = folded(i, 1) > 0 ? -1 : 0;
  ClothState expected = again;
  in.gravity = Eigen::Vector3d::Zero();
  solver->step(flat, in, limp);
  for (int frame = 0; frame < 4; ++frame) {
    solver->step(again, in, limp);
    fresh->step(expected, in, limp);
    EXPECT_EQ(again.positions, expected.positions) << frame;
  }
}

/// Patches that lie far from the others of their row, too.
TEST(Knots, RowsOfPatchesFindEveryLaterOneThatOverlaps) {
  LaneModel m{};
  m.patch_count = 2 * kRow + 3;
  PatchBoxes<float> boxes;
  boxes.resize(m.patch_count);
  for (int i = 0; i < m.patch_count; ++i) {
    const float at = static_cast<float>(i * 5 % 7);
    boxes.set(i, {{at, at, -at}, {at + 0.6f, at + 0.6f, 0.6f - at}});
  }
  boxes.refit(m);
  for (int i = 0; i < m.patch_count; ++i) {
    std::vector<int> found, expected;
    boxes.for_each_overlap(m, i, boxes[i], [&](int j, bool) { found.push_back(j); });
    for (int j = i; j < m.patch_count; ++j)
      if (overlap(boxes[i], boxes[j]))
        expected.push_back(j);
    EXPECT_EQ(found, expected) << i;
  }
}

TEST(Knots, EveryFaceVertexAndEdgeIsInOnePatch) {
  const scenes::Sheet skirt = scenes::skirt(40, 18);
  ClothOptions options;
  options.edge_collision = true;
  const PbdModel model(ClothModel::create(skirt.rest, skirt.faces, skirt.clothness, options));
  const LaneModel &m = model.arrays();
  std::multiset<int> faces, vertices;
  std::vector<std::set<int>> corners(m.patch_count);
  int edges = 0;
  for (int i = 0; i < m.patch_count; ++i) {
    const Patch &patch = m.patches[i];
    EXPECT_EQ(patch.first_edge, edges); // in a row
    edges += patch.edge_count;
    EXPECT_LE(patch.face_count, 8);
    EXPECT_TRUE(patch.connected);
    EXPECT_EQ(m.patch_nodes[patch.node].face, i);
    for (int k = 0; k < patch.face_count; ++k) {
      const int f = m.patch_faces[patch.first_face + k];
      faces.insert(f);
      corners[i].insert(m.faces[f].v, m.faces[f].v + 3);
    }
    for (int k = 0; k < patch.vertex_count; ++k) {
      const int v = m.vertex_order[patch.first_vertex + k];
      vertices.insert(v);
      EXPECT_TRUE(corners[i].count(v));
    }
    for (int e = patch.first_edge; e < patch.first_edge + patch.edge_count; ++e)
      EXPECT_TRUE(corners[i].count(m.edges[e].a) && corners[i].count(m.edges[e].b));
  }
  const auto each_once = [](const std::multiset<int> &all, int count) {
    return static_cast<int>(all.size()) == count && std::set<int>(all.begin(), all.end()).size() == all.size();
  };
  EXPECT_TRUE(each_once(faces, m.face_count));
  EXPECT_TRUE(each_once(vertices, m.vertex_count));
  EXPECT_EQ(edges, m.edge_count);
  const auto common = [&](int i, int j) { // of a vertex 1, of an edge 2
    return std::count_if(corners[i].begin(), corners[i].end(), [&](int v) { return corners[j].count(v) > 0; });
  };
  int bridges = 0;
  for (int i = 0; i < m.patch_count; i += 7) {
    std::set<int> next, near;
    for (int j = 0; j < m.patch_count; ++j)
      if (j != i && common(i, j) > 0)
        next.insert(j);
    for (int j = i + 1; j < m.patch_count; ++j)
      if (next.count(j) || std::any_of(next.begin(), next.end(), [&](int k) { return common(k, j) > 0; }))
        near.insert(j);
    const Patch &patch = m.patches[i];
    std::vector<int> found;
    for (int n = patch.first_near; n < patch.first_near + patch.near_count; ++n) {
      const NearPatch &other = m.patch_near[n];
      found.push_back(other.patch);
      for (int k = other.first_bridge; k < other.first_bridge + other.bridge_count; ++k) {
        const int bridge = m.patch_bridges[k];
        EXPECT_TRUE(bridge == i || common(bridge, i) >= 2);
        EXPECT_GE(common(bridge, other.patch), 2);
        bridges += bridge == i ? 1 : 2;
      }
    }
    EXPECT_EQ(found, std::vector<int>(near.begin(), near.end()));
  }
  EXPECT_GT(bridges, m.patch_count / 7);
}

} // namespace knots_test
} // namespace doublet::pbd
