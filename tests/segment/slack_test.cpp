#include "doublet/segment/slack.h"

#include "doublet/core/error.h"
#include "doublet/segment/garment_mesher.h"
#include "skirt_person.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

using namespace doublet;
using skirt_person::Person;
using skirt_person::small_garment;

namespace {

constexpr double kRadius = 0.5, kSmall = 0.05; // m, of the body; of the tolerance for its flat faces: a share

/// A point for each of the distances (m) from a ball, outside it or, if negative, inside.
Vertices points_at(const std::vector<double> &distances) {
  Vertices points(static_cast<Eigen::Index>(distances.size()), 3);
  for (std::size_t i = 0; i < distances.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) << (kRadius + distances[i]) * std::cos(i), (kRadius + distances[i]) * std::sin(i), 0;
  return points;
}

/// The skirt with this slack (m), by its height (m).
Person with_slack(const std::function<double(double)> &slack) {
  Person person;
  person.segmentation.slack = person.actor.mesh.vertices.col(1).unaryExpr(slack);
  return person;
}

struct Made {
  Garment garment;
  std::string said;
};

Made made_of(const Person &person, const GarmentOptions &options = small_garment()) {
  Made made;
  Context context;
  context.log = [&](const std::string &line) { made.said += line; };
  made.garment = mesh_garment(person.actor, person.segmentation, {}, {}, options, context);
  return made;
}

} // namespace

TEST(ClothSlack, IsTheDistanceFromTheBodyThatIsExceededInOneFrameOfTwenty) {
  const Mesh body = doublet::testing::sphere(kRadius, {0, 0, 0}, 200, 400);
  std::vector<Vertices> frames;
  for (int t = 0; t < 100; ++t)
    frames.push_back(points_at({0.02, -0.03, t < 3 ? 0.1 : 0.01, t < 8 ? 0.1 : 0.01}));
  const Eigen::VectorXd slack = cloth_slack(body, frames);
  EXPECT_NEAR(slack[0], 0.02, kSmall * 0.02);
  EXPECT_EQ(slack[1], 0) << "it lies in the body";
  EXPECT_NEAR(slack[2], 0.01, kSmall * 0.01) << "three frames of a hundred are mistakes";
  EXPECT_NEAR(slack[3], 0.1, kSmall * 0.1);
}

TEST(ClothSlack, IsTheSameForAnyNumberOfThreads) {
  const Mesh body = doublet::testing::sphere(kRadius);
  const std::vector<Vertices> frames(3, Vertices(Vertices::Random(500, 3)));
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  EXPECT_EQ(cloth_slack(body, frames, one), cloth_slack(body, frames, four));
}

TEST(ClothSlack, RefusesWhatDoesNotFit) {
  const Mesh body = doublet::testing::sphere(kRadius);
  EXPECT_THROW(cloth_slack(body, {}), std::invalid_argument);
  EXPECT_THROW(cloth_slack(body, {Vertices::Zero(5, 3), Vertices::Zero(4, 3)}), std::invalid_argument);
  EXPECT_ANY_THROW(cloth_slack(body, {Vertices::Constant(5, 3, std::nan(""))}));
  EXPECT_THROW(cloth_slack({}, {Vertices::Zero(5, 3)}), Error);
}

/// Trousers: snug above, loose below. The mesh is that of loose ones; what is snug follows the skin.
TEST(CarriedCloth, IsFixedWhereItIsSnugAndFreeWhereItIsLoose) {
  const double edge = 0.8; // m
  const Person person = with_slack([&](double y) { return y > edge ? 0.005 : 0.1; });
  const Garment garment = made_of(person).garment, loose = made_of(Person()).garment;
  EXPECT_EQ(garment.mesh.vertices, loose.mesh.vertices);
  EXPECT_EQ(garment.replaced_faces, loose.replaced_faces);
  for (Eigen::Index v = 0; v < garment.clothness.size(); ++v) {
    const double y = garment.mesh.vertices(v, 1);
    if (y > edge + 0.06) {
      EXPECT_EQ(garment.clothness[v], 0) << y;
    }
    if (y < edge - 0.06) {
      EXPECT_EQ(garment.clothness[v], loose.clothness[v]) << y;
    }
  }
  EXPECT_EQ(dress(person.actor, person.segmentation, garment).segmentation.region_count, 1);
}

TEST(CarriedCloth, HasASoftBorderOfTheClosingLength) {
  const Person person = with_slack([](double y) { return y > 0.8 ? 0.005 : 0.1; });
  const auto between = [&](double closing_length) {
    GarmentOptions options = small_garment();
    options.closing_length = closing_length;
    const Garment garment = made_of(person, options).garment;
    return (garment.clothness.array() > 0 && garment.clothness.array() < 1).count();
  };
  EXPECT_GT(between(0.04), 2 * between(0.002));
}

TEST(CarriedCloth, MakesNoGarmentWhereAllOfItIsSnug) {
  const Person person = with_slack([](double) { return 0.005; });
  for (const bool remesh : {true, false}) { // the cloth of the template is not simulated either
    GarmentOptions options = small_garment();
    options.remesh = remesh;
    const auto [garment, said] = made_of(person, options);
    EXPECT_EQ(garment.mesh.vertices.rows(), 0);
    const Segmentation worn = dress(person.actor, person.segmentation, garment).segmentation;
    EXPECT_EQ(worn.region_count, 0);
    EXPECT_EQ(worn.clothness.maxCoeff(), 0);
    EXPECT_EQ(worn.region.maxCoeff(), -1);
    EXPECT_EQ(said.find("region 0 lies on the body") != std::string::npos, remesh) << said;
  }
}

TEST(CarriedCloth, AFreePieceThatIsTooSmallIsCarriedToo) {
  const auto with_free_to = [](double low) { return with_slack([=](double y) { return y > 0.9 || y < low ? 0.005 : 0.1; }); };
  EXPECT_EQ(made_of(with_free_to(0.86)).garment.region_count, 0); // 0.04 m^2
  EXPECT_EQ(made_of(with_free_to(0.6)).garment.region_count, 1);  // 0.4 m^2
}

/// A tight belt, and no other cloth: nothing around it hangs.
TEST(CarriedCloth, ASmallPieceByItselfIsWhatItIs) {
  Person person;
  person.segmentation.clothness.setZero();
  person.segmentation.region.setConstant(-1);
  for (int ring = skirt_person::first_ring(1.1); ring < skirt_person::first_ring(1.15); ++ring) // 0.05 m^2
    person.set_cloth(ring, 0);
  GarmentOptions options = small_garment();
  options.remesh = false;
  for (const bool snug : {true, false}) {
    person.segmentation.slack = Eigen::VectorXd::Constant(person.actor.mesh.vertices.rows(), snug ? 0.005 : 0.1);
    const Garment garment = made_of(person, options).garment;
    EXPECT_EQ(dress(person.actor, person.segmentation, garment).segmentation.region_count, snug ? 0 : 1);
  }
}

TEST(CarriedCloth, APieceThatLiesOnTheBodyAmidLooseClothRestsThere) {
  const auto resting_to = [](double low) { return with_slack([=](double y) { return y > 0.8 || y < low ? 0.1 : 0.005; }); };
  EXPECT_EQ(made_of(resting_to(0.77)).garment.clothness, made_of(Person()).garment.clothness); // 0.05 m^2
  EXPECT_GT((made_of(resting_to(0.65)).garment.clothness.array() == 0).count(),
            (made_of(Person()).garment.clothness.array() == 0).count() + 20);
}

TEST(CarriedCloth, NothingIsWithoutAMeasureOrWhereItIsNotWanted) {
  const Person snug = with_slack([](double) { return 0.005; });
  GarmentOptions all_free = small_garment();
  all_free.snug_slack = 0;
  const Garment loose = made_of(Person()).garment;
  EXPECT_EQ(made_of(snug, all_free).garment.clothness, loose.clothness);
  EXPECT_EQ(loose.attachment, Eigen::VectorXd::Zero(snug.actor.mesh.vertices.rows()));
}

TEST(CarriedCloth, OfTwoGarmentsTheLooseOneIsMade) {
  Person person;
  for (int ring = skirt_person::first_ring(1.1); ring < skirt_person::first_ring(1.3); ++ring) // around the chest
    person.set_cloth(ring, 1);
  person.segmentation.slack = person.actor.mesh.vertices.col(1).unaryExpr([](double y) { return y > 1.05 ? 0.005 : 0.1; });
  const auto [garment, said] = made_of(person);
  EXPECT_NE(said.find("region 1 lies on the body"), std::string::npos) << said;
  EXPECT_EQ(garment.region_count, 1);
  EXPECT_LT(garment.mesh.vertices.col(1).maxCoeff(), 1.05);
}
