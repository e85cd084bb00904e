#include "doublet/core/parts/boundary_loops.h"
#include "doublet/segment/garment_mesher.h"

#include "../../libsegment/src/rest_shape.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/self_intersection.h"
#include "doublet/testing/garment_mesher_conformance.h"
#include "skirt_person.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

using namespace doublet;
using skirt_person::Person;
using skirt_person::small_garment;

namespace {

Garment garment_of(const Person &person, const GarmentOptions &options = small_garment(), const MeshSequence &captured = {}) {
  return mesh_garment(person.actor, person.segmentation, {}, captured, options);
}

std::vector<char> on_boundary(const Garment &garment) {
  const EdgeTopology edges = edge_topology(garment.mesh.faces);
  std::vector<char> result(garment.mesh.vertices.rows(), 0);
  for (std::size_t e = 0; e < edges.edges.size(); ++e)
    if (edges.edge_faces[e].minCoeff() < 0)
      result[edges.edges[e][0]] = result[edges.edges[e][1]] = 1;
  return result;
}

std::vector<int> hem_vertices(const Garment &garment) {
  std::vector<int> hem;
  const std::vector<char> boundary = on_boundary(garment);
  for (int v = 0; v < garment.clothness.size(); ++v)
    if (boundary[v] && garment.clothness[v] > 0)
      hem.push_back(v);
  return hem;
}

/// m, of the boundary that does not hang.
double hem_length(const Garment &garment, const Vertices &shape) {
  const EdgeTopology edges = edge_topology(garment.mesh.faces);
  double length = 0;
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const int a = edges.edges[e][0], b = edges.edges[e][1];
    if (edges.edge_faces[e].minCoeff() < 0 && garment.clothness[a] > 0 && garment.clothness[b] > 0)
      length += (shape.row(a) - shape.row(b)).norm();
  }
  return length;
}

/// m, mean over the hem of the way to the seam along the edges.
double way_to_hem(const Garment &garment, const Vertices &shape) {
  std::vector<int> seam;
  for (int v = 0; v < garment.clothness.size(); ++v)
    if (garment.clothness[v] == 0)
      seam.push_back(v);
  const auto neighbours = vertex_neighbours(garment.mesh.faces, static_cast<int>(shape.rows()));
  const Eigen::VectorXd way = edge_distances(shape, neighbours, seam);
  double sum = 0;
  for (int v : hem_vertices(garment))
    sum += way[v];
  return sum / static_cast<double>(hem_vertices(garment).size());
}

/// m, the height up to which the garment's lower boundary reaches.
double top_of_hem(const Garment &garment) {
  double top = 0;
  for (int v : hem_vertices(garment))
    top = std::max(top, garment.mesh.vertices(v, 1));
  return top;
}

void expect_loops(const Garment &garment, int loops, int hanging) {
  const GarmentSummary summary = summarise_garment(garment);
  EXPECT_EQ(summary.loops, loops);
  EXPECT_EQ(summary.hanging_loops, hanging);
}

/// A skirt with a slit of `columns` of unseen faces from the hem up to y = 0.615.
Person with_slit(int columns) {
  Person person;
  for (int ring = 28; ring < 34; ++ring)
    for (int k = 0; k < columns; ++k)
      person.set_invalid(ring, k);
  return person;
}

/// ... with a hole of 2 x half rings and columns: bare skin, or nothing that was seen.
Person with_hole(int half, bool skin) {
  Person person;
  for (int ring = 40 - half; ring < 40 + half; ++ring)
    for (int k = -half; k < half; ++k)
      if (skin)
        person.segmentation.clothness[skirt_person::vertex(ring, k)] = 0;
      else
        person.set_invalid(ring, k);
  return person;
}

/// Height and radius: a skirt that hangs in eight folds, and the same cloth spread out. Both are 0.5025 m long from waist to hem
/// (but for the folds).
Eigen::Vector2d folded(double up, double angle) {
  const double down = 1 - up;
  return {1.0 - 0.5 * down, 0.15 + 0.05 * down + 0.02 * down * std::cos(8 * angle)};
}
Eigen::Vector2d spread_out(double up, double) {
  const double down = 1 - up, length = std::hypot(0.5, 0.05), out = 0.15;
  return {1.0 - std::sqrt(length * length - out * out) * down, 0.15 + out * down};
}
MeshSequence folded_and_spread_out(const Person &person) {
  MeshSequence captured{person.actor.mesh.faces, {}};
  for (int t = 0; t < 3; ++t) {
    captured.frames.push_back(skirt_person::surface(folded));
    captured.frames.push_back(skirt_person::surface(spread_out));
  }
  return captured;
}

} // namespace

TEST(GarmentConformance, OursConforms) {
  const Person person;
  for (const std::string &broken :
       doublet::testing::garment_mesher_violations(*GarmentMesher::create(small_garment()), person.actor, person.segmentation))
    ADD_FAILURE() << broken;
}

/// Wears whatever it is given, a little lower each time.
class Sagging : public GarmentMesher {
public:
  Garment mesh(const RiggedMesh &actor, const Segmentation &, const Mesh &, const MeshSequence &,
               const Context &) const override {
    Garment garment = garment_of(Person());
    garment.rest.array() -= ++calls_;
    garment.replaced_faces.resize(actor.face_valid.size() - (calls_ == 4));
    return garment;
  }

private:
  mutable int calls_ = 0;
};

TEST(GarmentConformance, TheKitCatchesASaggingOne) {
  const Person person;
  const auto broken = doublet::testing::garment_mesher_violations(Sagging(), person.actor, person.segmentation);
  EXPECT_EQ(broken.size(), 3u); // other bits, vertices without cloth, no refusal
}

/// Ours, a size too large.
class TooLarge : public GarmentMesher {
public:
  Garment mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body, const MeshSequence &captured,
               const Context &context) const override {
    Garment garment = GarmentMesher::create(small_garment())->mesh(actor, segmentation, body, captured, context);
    garment.mesh.vertices *= 1.3;
    return garment;
  }
};

TEST(GarmentConformance, TheKitCatchesOneThatIsTooLarge) {
  const Person person;
  const auto broken = doublet::testing::garment_mesher_violations(TooLarge(), person.actor, person.segmentation);
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_NE(broken[0].find("not where the cloth is"), std::string::npos) << broken[0];
}

TEST(GarmentMesher, ASkirtHangsOnItsSeamAndHasOneHem) {
  const Person person;
  const Garment garment = garment_of(person);
  expect_loops(garment, 2, 1);
  const MeshReport report = report_mesh(garment.mesh);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.non_manifold_edges + report.degenerate_faces + report.unused_vertices, 0);
  EXPECT_NO_THROW(validate_garment(garment, person.actor, "garment"));
  const std::vector<char> boundary = on_boundary(garment);
  for (Eigen::Index v = 0; v < garment.clothness.size(); ++v) {
    const double y = garment.mesh.vertices(v, 1);
    EXPECT_EQ(garment.clothness[v], boundary[v] && y > 0.75 ? 0.0 : 1.0) << v; // a seam, no band
    EXPECT_TRUE(!boundary[v] || std::abs(y - skirt_person::kHem) < 0.01 || std::abs(y - skirt_person::kWaist) < 0.03) << y;
  }
  EXPECT_NEAR(hem_length(garment, garment.mesh.vertices), 2 * skirt_person::pi * skirt_person::kHemRadius, 0.02);
}

TEST(GarmentMesher, TrianglesAreRegularAndAsManyAsWanted) {
  for (int wanted : {400, 1400, 2000}) {
    GarmentOptions options;
    options.vertices = wanted;
    const GarmentSummary summary = summarise_garment(garment_of(Person(), options));
    EXPECT_NEAR(summary.vertices, wanted, 0.15 * wanted);
    EXPECT_GT(summary.smallest_angle, 30); // 40; of an equilateral triangle 60
    EXPECT_EQ(summary.regions, 1);
    EXPECT_GT(summary.faces, 1.7 * summary.vertices);
    EXPECT_NEAR(summary.mean_edge, std::sqrt(2 * 0.725 / (std::sqrt(3.0) * wanted)), 0.12 * summary.mean_edge);
  }
}

TEST(GarmentMesher, VerticesLieOnTheActorWhereTheySay) {
  const Person person(folded);
  const Garment garment = garment_of(person, small_garment(), folded_and_spread_out(person));
  const Vertices places = interpolate_to_garment(garment, person.actor.mesh.faces, person.actor.mesh.vertices);
  EXPECT_LT((places - garment.mesh.vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(garment.barycentric.minCoeff(), -1e-6);
  EXPECT_LT((garment.barycentric.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-9);
  for (int face : garment.actor_face) { // covered, but for the faces that the seam runs through
    const auto clothness = [&](int k) { return person.segmentation.clothness[person.actor.mesh.faces(face, k)]; };
    EXPECT_TRUE(garment.replaced_faces[face] || std::min({clothness(0), clothness(1), clothness(2)}) < 0.5) << face;
  }
  EXPECT_TRUE(
      std::any_of(garment.actor_face.begin(), garment.actor_face.end(), [&](int f) { return !garment.replaced_faces[f]; }));
  // Regular where it was spread out, not in the folds.
  const auto variation = [&](const Vertices &actor_vertices) { // of the edges' lengths
    const Vertices x = interpolate_to_garment(garment, person.actor.mesh.faces, actor_vertices);
    const std::vector<Eigen::Vector2i> edges = edge_topology(garment.mesh.faces).edges;
    Eigen::ArrayXd lengths(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e)
      lengths[static_cast<Eigen::Index>(e)] = (x.row(edges[e][0]) - x.row(edges[e][1])).norm();
    return std::sqrt((lengths - lengths.mean()).square().mean()) / lengths.mean();
  };
  EXPECT_LT(variation(skirt_person::surface(spread_out)), 0.12);
  EXPECT_LT(variation(skirt_person::surface(spread_out)), variation(person.actor.mesh.vertices));
}

TEST(GarmentMesher, CoversTheClothAndNothingElse) {
  const Person person;
  const Garment garment = garment_of(person);
  const int faces_a_ring = 2 * skirt_person::kAround, hem = 28, waist = hem + 26;
  for (int f = 0; f < person.actor.mesh.faces.rows(); ++f) {
    const int ring = f / faces_a_ring;
    if (ring >= hem && ring < waist - 2) { // the cut runs through the last two
      EXPECT_TRUE(garment.replaced_faces[f]) << ring;
    }
    if (ring < hem - 1 || ring >= waist) {
      EXPECT_FALSE(garment.replaced_faces[f]) << ring;
    }
  }
}

TEST(GarmentMesher, ASlitNarrowerThanTheClosingIsClosed) {
  const Person slit = with_slit(3); // 6 cm
  GarmentOptions options;
  options.vertices = 1500;
  options.closing_length = 0.08;
  const Garment closed = garment_of(slit, options);
  expect_loops(closed, 2, 1);
  EXPECT_LT(top_of_hem(closed), 0.54);
  options.closing_length = 0.002;
  const Garment open = garment_of(slit, options);
  expect_loops(open, 2, 1);
  EXPECT_GT(top_of_hem(open), 0.59);
}

TEST(GarmentMesher, HolesAreFilledIfTheyAreSmall) {
  for (bool skin : {false, true}) {
    expect_loops(garment_of(with_hole(3, skin)), 2, 1); // 0.011 m^2
    const Person holed = with_hole(6, skin);            // 0.044 m^2
    expect_loops(garment_of(holed), 3, skin ? 2 : 1);
    GarmentOptions options = small_garment();
    options.min_hole_area = 0.06;
    expect_loops(garment_of(holed, options), 2, 1);
  }
}

TEST(GarmentMesher, PiecesThatAreTooSmallMoveAsSkinAndAreNamed) {
  const auto with_belt = [](double top) { // region 0 around the chest, the skirt is region 1
    Person person;
    for (int ring = 28; ring < 54; ++ring)
      person.set_cloth(ring, 1);
    for (int ring = skirt_person::first_ring(1.1); ring < skirt_person::first_ring(top); ++ring)
      person.set_cloth(ring, 0);
    return person;
  };
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line; };
  const Person narrow = with_belt(1.15), wide = with_belt(1.3); // 0.05 and 0.19 m^2
  const Garment one = mesh_garment(narrow.actor, narrow.segmentation, {}, {}, small_garment(), context);
  EXPECT_NE(said.find("region 0 is too small"), std::string::npos) << said;
  EXPECT_EQ(one.region_count, 1);
  EXPECT_EQ(one.region.maxCoeff(), 0); // the skirt moves up
  expect_loops(one, 2, 1);
  for (int k = 0; k < skirt_person::kAround; ++k)
    EXPECT_FALSE(one.replaced_faces[skirt_person::face(skirt_person::first_ring(1.1), k)]);
  said.clear();
  const Garment two = mesh_garment(wide.actor, wide.segmentation, {}, {}, small_garment(), context);
  EXPECT_EQ(said, "");
  EXPECT_EQ(two.region_count, 2);
  expect_loops(two, 4, 3);
  for (Eigen::Index v = 0; v < two.region.size(); ++v)
    EXPECT_EQ(two.region[v], two.mesh.vertices(v, 1) > 1.05 ? 0 : 1);
  EXPECT_NEAR(two.mesh.vertices.rows(), 400, 100); // of both together; small pieces have more boundary
}

TEST(GarmentMesher, AGarmentThatHangsOnNothingMovesAsSkin) {
  Person person;
  person.segmentation.clothness.setOnes();
  person.segmentation.region.setZero();
  std::fill(person.actor.face_valid.begin(), person.actor.face_valid.end(), 1);
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line; };
  const MeshSequence captured{person.actor.mesh.faces, {person.actor.mesh.vertices}};
  const Garment none = mesh_garment(person.actor, person.segmentation, {}, captured, small_garment(), context);
  EXPECT_NE(said.find("region 0 does not touch skin"), std::string::npos) << said;
  EXPECT_EQ(none.region_count, 0);
  EXPECT_EQ(none.mesh.vertices.rows(), 0);
  EXPECT_EQ(*std::max_element(none.replaced_faces.begin(), none.replaced_faces.end()), 0);
  EXPECT_EQ(dress(person.actor, person.segmentation, none).segmentation.region_count, 0);
}

/// Two pieces of one region, of which one hangs on nothing: it would fall.
TEST(GarmentMesher, ALoosePieceOfARegionMovesAsSkin) {
  Person person;
  for (int ring = 6; ring <= 20; ++ring) // the leg, between the sheet and what was not seen
    person.set_cloth(ring, 0);
  for (int ring = 0; ring < 6; ++ring)
    for (int k = 0; k < skirt_person::kAround; ++k)
      person.set_invalid(ring, k);
  GarmentOptions options = small_garment();
  options.min_piece_area = 0.05;
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line; };
  const Garment garment = mesh_garment(person.actor, person.segmentation, {}, {}, options, context);
  EXPECT_NE(said.find("region 0: 0.17"), std::string::npos) << said; // m^2
  expect_loops(garment, 2, 1);
  EXPECT_GT(garment.mesh.vertices.col(1).minCoeff(), 0.49);
  EXPECT_FALSE(garment.replaced_faces[skirt_person::face(12, 0)]);
}

TEST(GarmentMesher, TheSheetBelowAHemIsNoSkinEvenWhereItCountsAsValid) {
  Person person;
  for (int k = 0; k < skirt_person::kAround; ++k)
    for (int f : {0, 1})
      person.actor.face_valid[skirt_person::face(27, k) + f] = 1;
  expect_loops(garment_of(person), 2, 1);
}

TEST(GarmentMesher, ASheetThatCountsAsClothIsNoFloor) {
  Person person;
  for (int ring = 21; ring < 28; ++ring) { // up to the leg
    person.set_cloth(ring, 0);
    for (int k = 0; k < skirt_person::kAround; ++k)
      for (int f : {0, 1})
        person.actor.face_valid[skirt_person::face(ring, k) + f] = 1;
  }
  for (int k = 0; k < skirt_person::kAround; ++k)
    for (int f : {0, 1})
      person.actor.face_valid[skirt_person::face(20, k) + f] = 1;
  const Garment garment = garment_of(person);
  expect_loops(garment, 2, 1);
  for (const std::vector<int> &loop : boundary_loops(garment.mesh.faces))
    for (int v : loop)
      EXPECT_GT(std::hypot(garment.mesh.vertices(v, 0), garment.mesh.vertices(v, 2)),
                skirt_person::kWaistRadius - 0.02); // not at the leg
}

TEST(GarmentMesher, ALegThatIsOneSurfaceWithTheHemDoesNotHoldIt) {
  Person person;
  for (int k = 0; k <= 24; ++k) { // on a quarter of the hem, 47 cm
    for (int ring = 0; ring < 28; ++ring) {
      const double angle = 2 * skirt_person::pi * k / skirt_person::kAround, radius = 0.295 + 0.005 * std::max(0, ring - 20) / 8;
      const double y = ring < 20 ? 0.024 * ring : 0.48 + 0.02 * (ring - 20) / 8;
      person.actor.mesh.vertices.row(skirt_person::vertex(ring, k)) << radius * std::sin(angle), y, radius * std::cos(angle);
    }
    for (int ring = 20; ring < 28 && k < 24; ++ring)
      for (int f : {0, 1})
        person.actor.face_valid[skirt_person::face(ring, k) + f] = 1;
  }
  const Garment garment = garment_of(person);
  expect_loops(garment, 2, 1);
  const std::vector<int> hem = hem_vertices(garment);
  EXPECT_TRUE(std::any_of(hem.begin(), hem.end(), [&](int v) { // the quarter is free
    return garment.mesh.vertices(v, 0) > 0.2 && garment.mesh.vertices(v, 2) > 0.2;
  }));
}

/// As the collar of a vest does on the shoulders.
TEST(GarmentMesher, AGarmentHangsFromAnEdgeThatLiesLevel) {
  const auto level = [](double up, double) -> Eigen::Vector2d {
    const double in = std::max(0.0, up - 0.7) / 0.3;
    return {0.5 + 0.47 * std::min(up / 0.7, 1.0) + 0.03 * in, 0.3 - 0.15 * in};
  };
  expect_loops(garment_of(Person(level)), 2, 1);
}

TEST(GarmentMesher, WhatIsOpenInFrontHangsFromAboveAlone) {
  Person person;
  for (std::size_t ring = 0; ring < skirt_person::rings().size(); ++ring)
    for (int k = 0; k < 12; ++k) // skin shows, from hem to waist
      person.segmentation.clothness[skirt_person::vertex(static_cast<int>(ring), k)] = 0;
  const Garment garment = garment_of(person);
  const std::vector<std::vector<int>> loops = boundary_loops(garment.mesh.faces);
  ASSERT_EQ(loops.size(), 1u);
  int front = 0;
  for (int v : loops[0]) {
    const double y = garment.mesh.vertices(v, 1), clothness = garment.clothness[v];
    if (y > 0.98) {
      EXPECT_LT(clothness, 0.5) << y;
    } else if (y > 0.57 && y < 0.9) {
      EXPECT_GT(clothness, 0) << y;
      ++front;
    }
  }
  EXPECT_GT(front, 10);
}

TEST(GarmentMesher, PressureDoesNotTurnAnOpenFrontInsideOut) {
  Person person;
  const std::vector<skirt_person::Ring> rings = skirt_person::rings();
  for (int ring = skirt_person::first_ring(skirt_person::kWaist); rings[ring].y < 1.35; ++ring)
    person.set_cloth(ring, 0); // up to the shoulders
  for (std::size_t ring = 0; ring < rings.size(); ++ring)
    for (int k = 0; k < 30; ++k)
      person.segmentation.clothness[skirt_person::vertex(static_cast<int>(ring), k)] = 0;
  const MeshSequence still{person.actor.mesh.faces, {person.actor.mesh.vertices, person.actor.mesh.vertices}};
  const Garment garment = mesh_garment(person.actor, person.segmentation, {}, still, small_garment());
  const EdgeTopology topology = edge_topology(garment.mesh.faces);
  double off = 0;
  for (const Eigen::Vector2i &e : topology.edges) {
    const double scanned = (garment.mesh.vertices.row(e[0]) - garment.mesh.vertices.row(e[1])).norm();
    off += std::abs((garment.rest.row(e[0]) - garment.rest.row(e[1])).norm() / scanned - 1);
  }
  EXPECT_LT(off / static_cast<double>(topology.edges.size()), 0.03);
}

TEST(GarmentMesher, AGapInTheSkinAboveTheSeamIsNoHem) {
  Person person;
  for (int ring = 53; ring < 60; ++ring)
    for (int k = 0; k < 9; ++k) // 9 cm
      person.set_invalid(ring, k);
  const auto free_at_waist = [&](double min_edge_run) {
    GarmentOptions options = small_garment();
    options.vertices = 1500;
    options.min_edge_run = min_edge_run;
    const Garment garment = garment_of(person, options);
    const std::vector<int> hem = hem_vertices(garment);
    return std::count_if(hem.begin(), hem.end(), [&](int v) { return garment.mesh.vertices(v, 1) > 0.9; });
  };
  EXPECT_EQ(free_at_waist(0.15), 0);
  EXPECT_GT(free_at_waist(0.02), 0);
}

TEST(GarmentMesher, ALegThatAWholeLoopRunsAroundDoesNotHoldTheSkirt) {
  Person person;
  for (int ring = 2; ring < 28; ++ring) { // the leg, and the sheet that joins it to the hem
    person.set_cloth(ring, 0);
    for (int k = 0; k < skirt_person::kAround; ++k)
      for (int f : {0, 1})
        person.actor.face_valid[skirt_person::face(ring, k) + f] = 1;
  }
  const Garment garment = garment_of(person);
  EXPECT_LT(garment.mesh.vertices.col(1).minCoeff(), 0.2);
  expect_loops(garment, 2, 1);
  for (Eigen::Index v = 0; v < garment.clothness.size(); ++v)
    EXPECT_TRUE(garment.clothness[v] > 0 || garment.mesh.vertices(v, 1) > 0.9) << v;
}

TEST(GarmentMesher, ALegThatCountsAsClothHangsOnNothing) {
  Person person;
  for (int ring = 2; ring <= 20; ++ring) // the leg, up to the sheet
    person.set_cloth(ring, 0);
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line; };
  const Garment skirt = mesh_garment(person.actor, person.segmentation, person.body, {}, small_garment(), context);
  EXPECT_NE(said.find("region 0: 0.2"), std::string::npos) << said; // m^2
  expect_loops(skirt, 2, 1);
  EXPECT_GT(skirt.mesh.vertices.col(1).minCoeff(), 0.49);
  EXPECT_GT(skirt.mesh.vertices.col(1).maxCoeff(), 0.98);
}

/// A shirt over trousers, a sleeve, a cuff lie on the body in places, and skin lies beyond them: all the same they are cloth.
TEST(GarmentMesher, WhatLiesOnTheBodyIsClothWhereItCountsAsThat) {
  Person person;
  const Garment skirt = mesh_garment(person.actor, person.segmentation, person.actor.mesh, {}, small_garment());
  const Garment without_body = mesh_garment(person.actor, person.segmentation, {}, {}, small_garment());
  EXPECT_EQ(skirt.mesh.vertices, without_body.mesh.vertices);
}

/// The underside of a fold that was taken for skin is not drawn beside the garment; a patch of skin that the cloth leaves free
/// is.
TEST(GarmentMesher, SkinThatLiesNowhereOnTheBodyIsNone) {
  Person person;
  const auto make_skin = [&](int first, int last) { // a patch, in cloth
    for (int ring = first; ring < last; ++ring)
      for (int k = -8; k < 8; ++k)
        person.segmentation.clothness[skirt_person::vertex(ring, k)] = 0;
  };
  make_skin(36, 46);
  const int middle = skirt_person::face(41, 0);
  GarmentOptions options = small_garment();
  options.min_hole_area = 0;
  const auto replaced = [&](const Mesh &body) {
    return mesh_garment(person.actor, person.segmentation, body, {}, options).replaced_faces[middle];
  };
  EXPECT_TRUE(replaced(person.body));
  EXPECT_FALSE(replaced({}));                // nobody knows
  EXPECT_FALSE(replaced(person.actor.mesh)); // it does lie on the body
}

TEST(GarmentMesher, RestIsAsWideAsTheFramesAndAsLongAsTheScan) {
  const Person person(folded);
  const Garment garment = garment_of(person, small_garment(), folded_and_spread_out(person));
  expect_loops(garment, 2, 1);
  const double wide = 2 * skirt_person::pi * 0.3, length = way_to_hem(garment, garment.mesh.vertices);
  EXPECT_LT(hem_length(garment, garment.mesh.vertices), 0.8 * wide); // the scan bridges what it does not see
  EXPECT_NEAR(hem_length(garment, garment.rest), wide, 0.03 * wide); // 0.7 %
  EXPECT_NEAR(way_to_hem(garment, garment.rest), length, 0.02 * length);
  EXPECT_GT(summarise_garment(garment).smallest_angle, 30);
  for (Eigen::Index v = 0; v < garment.clothness.size(); ++v)
    if (garment.clothness[v] == 0) {
      EXPECT_LT((garment.rest.row(v) - garment.mesh.vertices.row(v)).norm(), 0.02); // hung on the same seam
    }
}

/// In the widest frame the cloth of the front is squeezed to a fifth of its width; in the others it is even.
TEST(GarmentMesher, TrianglesAreRegularInTheRestShapeWhereverTheWidestFrameSqueezesThem) {
  const Person person(spread_out);
  MeshSequence captured{person.actor.mesh.faces, {}};
  for (int t = 0; t < 12; ++t)
    captured.frames.push_back(person.actor.mesh.vertices);
  for (Eigen::Index v = 0; v < captured.frames[5].rows(); ++v) {
    auto x = captured.frames[5].row(v);
    if (x[1] < 0.95 && x[1] > 0.3) {
      const double angle = std::atan2(x[2], x[0]), squeezed = angle + 0.8 * std::sin(angle),
                   radius = 1.05 * std::hypot(x[0], x[2]);
      x << radius * std::cos(squeezed), x[1], radius * std::sin(squeezed);
    }
  }
  const Garment garment = garment_of(person, small_garment(), captured);
  expect_loops(garment, 2, 1);
  std::vector<double> lengths;
  for (const Eigen::Vector2i &edge : edge_topology(garment.mesh.faces).edges)
    lengths.push_back((garment.rest.row(edge[0]) - garment.rest.row(edge[1])).norm());
  std::sort(lengths.begin(), lengths.end());
  const double middle = lengths[lengths.size() / 2];
  EXPECT_LT(lengths.back(), 1.6 * middle);   // 1.37; meshed in the widest frame alone 3.4
  EXPECT_GT(lengths.front(), 0.45 * middle); // 0.54
}

TEST(GarmentMesher, AFewWideFramesDoNotCount) {
  const Person person(folded);
  MeshSequence captured{person.actor.mesh.faces, {}};
  for (int t = 0; t < 12; ++t)
    captured.frames.push_back(t == 5 ? skirt_person::surface(spread_out) : person.actor.mesh.vertices);
  const Garment garment = garment_of(person, small_garment(), captured);
  EXPECT_LT(hem_length(garment, garment.rest), 1.15 * hem_length(garment, garment.mesh.vertices));
}

TEST(GarmentMesher, WithoutFramesRestIsTheScan) {
  const Garment garment = garment_of(Person(folded));
  EXPECT_EQ(garment.rest, garment.mesh.vertices);
}

/// A strip of cloth that hangs from its upper edge.
struct Strip {
  static constexpr int kColumns = 24, kRows = 10;
  Vertices vertices{(kColumns + 1) * (kRows + 1), 3};
  Faces faces{2 * kColumns * kRows, 3};
  std::vector<int> attached;

  Strip() : attached(kColumns + 1) {
    std::iota(attached.begin(), attached.end(), 0);
    for (int r = 0; r <= kRows; ++r)
      for (int c = 0; c <= kColumns; ++c)
        vertices.row(r * (kColumns + 1) + c) << 0.02 * (c - kColumns / 2), -0.02 * r, 0;
    for (int r = 0, f = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const int a = r * (kColumns + 1) + c, b = a + kColumns + 1;
        faces.row(f++) << a, b, a + 1;
        faces.row(f++) << a + 1, b, b + 1;
      }
  }
  Vertices rest() const { return detail::rest_shape(faces, vertices, {}, -1, attached, 0.2); }
  long crossing(const Vertices &x) const {
    const std::vector<std::uint8_t> all = self_intersecting_faces({x, faces});
    return std::count(all.begin(), all.end(), 1);
  }
  /// The least cosine between the normals of neighbours.
  double most_folded(const Vertices &x) const {
    const Vertices normals = face_normals(x, faces);
    double least = 1;
    for (const Eigen::Vector2i &pair : edge_topology(faces).edge_faces)
      if (pair.minCoeff() >= 0)
        least = std::min(least, normals.row(pair[0]).dot(normals.row(pair[1])));
    return least;
  }
};

/// A scarf that lies on the shoulders and is fastened nowhere.
TEST(GarmentMesher, WhatHangsFromNothingHasARestShapeToo) {
  const Strip strip;
  const std::vector<Vertices> frames(3, strip.vertices);
  const Vertices rest = detail::rest_shape(strip.faces, strip.vertices, frames, 0, {}, 0.2);
  EXPECT_TRUE(rest.allFinite());
  EXPECT_NEAR(face_areas(rest, strip.faces).sum(), face_areas(strip.vertices, strip.faces).sum(), 0.01);
}

/// With a fold in its middle that has closed on itself and gone through: flat above, ever more of a loop below.
TEST(GarmentMesher, WhatPassesThroughItselfAtRestIsSmoothedUntilItDoesNot) {
  Strip strip;
  const Vertices flat = strip.vertices;
  for (Eigen::Index v = 0; v < flat.rows(); ++v) {
    const double t = flat(v, 0) / 0.06, deep = std::max(0.0, -flat(v, 1) / 0.02 - 4) / 6, loop = deep * 0.05 * std::exp(-t * t);
    strip.vertices.row(v) += Eigen::RowVector3d(-1.9 * loop * t, 0, 2 * loop);
  }
  EXPECT_GT(strip.crossing(strip.vertices), 4);
  const Vertices rest = strip.rest();
  EXPECT_EQ(strip.crossing(rest), 0);
  EXPECT_EQ(rest.topRows(Strip::kColumns + 1), flat.topRows(Strip::kColumns + 1));
  EXPECT_LT((rest - strip.vertices).rowwise().norm().maxCoeff(), 0.2);
}

/// A vertex of the hem that is turned up over its neighbours touches nothing, and yet its triangle lies on the next one.
TEST(GarmentMesher, WhatIsFoldedFlatAtRestIsUnfolded) {
  Strip strip;
  const int turned_up = Strip::kRows * (Strip::kColumns + 1) + Strip::kColumns / 2;
  strip.vertices.row(turned_up) += Eigen::RowVector3d(0.015, 0.038, 0.002);
  EXPECT_EQ(strip.crossing(strip.vertices), 0);
  EXPECT_LT(strip.most_folded(strip.vertices), -0.95);
  const Vertices rest = strip.rest();
  EXPECT_GT(strip.most_folded(rest), -0.866);
  const Eigen::VectorXd moved = (rest - strip.vertices).rowwise().norm();
  EXPECT_GT(moved[turned_up], 0.01);
  EXPECT_LT((moved.array() > 0).count(), 20); // of 275
}

TEST(GarmentMesher, ABandRisesWithTheWayFromTheSeam) {
  GarmentOptions options = small_garment();
  options.attachment_width = 0.1;
  const Garment garment = garment_of(Person(), options);
  for (Eigen::Index v = 0; v < garment.clothness.size(); ++v) {
    const double down = (garment.mesh.vertices.row(v) - Eigen::RowVector3d(0, 1, 0)).y() * -std::hypot(0.5, 0.15) / 0.5;
    EXPECT_NEAR(garment.clothness[v], std::clamp(down / 0.1, 0.0, 1.0), 0.3) << down; // along edges, from a cut a ring lower
  }
  EXPECT_GT((garment.clothness.array() > 0 && garment.clothness.array() < 1).count(), 10);
}

TEST(GarmentMesher, NoClothOrNoMeshOfItsOwnIsAnEmptyGarment) {
  Person person;
  GarmentOptions options = small_garment();
  options.remesh = false;
  Person bare;
  bare.segmentation.clothness.setZero();
  bare.segmentation.region.setConstant(-1);
  bare.segmentation.region_count = 0;
  for (const Garment &garment : {garment_of(person, options), garment_of(bare)}) {
    EXPECT_EQ(garment.region_count, 0);
    EXPECT_EQ(garment.mesh.vertices.rows(), 0);
    EXPECT_EQ(garment.replaced_faces, std::vector<std::uint8_t>(person.actor.mesh.faces.rows(), 0));
    EXPECT_EQ(summarise_garment(garment).loops, 0);
    EXPECT_EQ(dress(person.actor, person.segmentation, garment).actor.mesh.vertices, person.actor.mesh.vertices);
  }
}

TEST(GarmentMesher, IsTheSameFromRunToRun) {
  const Person person(folded);
  const MeshSequence captured = folded_and_spread_out(person);
  Context one;
  one.threads = 1;
  const Garment first = mesh_garment(person.actor, person.segmentation, person.body, captured, small_garment(), one),
                second = mesh_garment(person.actor, person.segmentation, person.body, captured, small_garment());
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
  EXPECT_EQ(first.mesh.faces, second.mesh.faces);
  EXPECT_EQ(first.rest, second.rest);
  EXPECT_EQ(first.barycentric, second.barycentric);
  EXPECT_EQ(first.clothness, second.clothness);
}

TEST(GarmentMesher, RefusesWhatDoesNotFit) {
  const Person good;
  const auto refused = [](const Person &person, const MeshSequence &captured = {}) {
    EXPECT_THROW(garment_of(person, small_garment(), captured), std::invalid_argument);
  };
  Person bad = good;
  bad.actor.face_valid.pop_back();
  refused(bad);
  bad = good;
  bad.segmentation.clothness.conservativeResize(7);
  refused(bad);
  bad = good;
  bad.segmentation.region.conservativeResize(7);
  refused(bad);
  refused(good, {good.actor.mesh.faces, {Vertices::Zero(5, 3)}});
  bad = good;
  bad.actor.mesh.vertices(0, 0) = std::nan("");
  EXPECT_THROW(garment_of(bad), Error);
}
