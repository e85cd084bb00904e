// The search for lost limbs: the annealing on known functions, limbs by topology, their error, and arms found again.

#include "../../libcapture/src/tracking/backward_hinges.h"
#include "doublet/capture/limb_search.h"
#include "person_scene.h"

#include <gtest/gtest.h>

using namespace doublet;
using namespace person_scene;

namespace limb_search_test {

/// Many minima of depth 1 on the way to the one at (1.3, 1.3, ...), which is 0.
Eigen::VectorXd rippled(const Eigen::MatrixXd &samples) {
  const Eigen::ArrayXXd off = samples.array() - 1.3;
  return (off.square() + 0.5 - 0.5 * (2 * std::numbers::pi * off).cos()).rowwise().sum();
}

TEST(Anneal, FindsTheLowestOfManyMinima) {
  const Eigen::VectorXd infinity = constant(4, std::numeric_limits<double>::infinity());
  ParticleAnnealingOptions options;
  options.particles = 300;
  options.iterations = 30;
  options.coldness = 0.3; // the ripples are 1 deep
  options.covariance_share = 0.7;
  for (int seed = 1; seed <= 5; ++seed) {
    options.seed = seed;
    const auto result = anneal(rippled, constant(4, -0.7), constant(4, 1.0), -infinity, infinity, options);
    EXPECT_LT((result.best - constant(4, 1.3)).norm(), 0.2) << "seed " << seed; // the next minima are 0.9 away
    EXPECT_EQ(result.energy, rippled(result.best.transpose())[0]);
    EXPECT_EQ(result.evaluations, 30 * options.particles);
  }
}

TEST(Anneal, StaysInTheBoxAndIsNeverWorseThanItsStart) {
  const auto outside = [](const Eigen::MatrixXd &samples) -> Eigen::VectorXd {
    EXPECT_LE(samples.maxCoeff(), 0.5);
    EXPECT_GE(samples.minCoeff(), -0.5);
    return (samples.array() - 2).square().rowwise().sum();
  };
  const auto result = anneal(outside, constant(3, 0), constant(3, 1), constant(3, -0.5), constant(3, 0.5));
  EXPECT_LT((result.best - constant(3, 0.5)).norm(), 1e-12); // the corner next to the minimum
  ParticleAnnealingOptions one;
  one.iterations = 1;
  one.particles = 2;
  const auto square = [](const Eigen::MatrixXd &samples) -> Eigen::VectorXd { return samples.rowwise().squaredNorm(); };
  EXPECT_EQ(anneal(square, constant(5, 0), constant(5, 1), constant(5, -9), constant(5, 9), one).energy, 0);
}

TEST(Anneal, SaysWhatIsWrong) {
  const auto none = [](const Eigen::MatrixXd &) { return Eigen::VectorXd(); };
  EXPECT_THROW(anneal(none, constant(2, 0), constant(2, 1), constant(2, -1), constant(2, 1)), std::invalid_argument);
  EXPECT_THROW(anneal(rippled, constant(2, 0), constant(3, 1), constant(2, -1), constant(2, 1)), std::invalid_argument);
  EXPECT_THROW(anneal(rippled, constant(2, 0), constant(2, 0), constant(2, -1), constant(2, 1)), std::invalid_argument);
  ParticleAnnealingOptions options;
  options.particles = 1;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  LimbSearchOptions search;
  search.lost_error = 0;
  EXPECT_THROW(LimbSearch::create(search), std::invalid_argument);
}

TEST(Limbs, AreTheChainsBetweenForks) {
  std::vector<JointAnnotation> marks = doublet::testing::stick_figure();
  marks.push_back({"l_thumb", "l_wrist", {0.55, 1.0, 0.1}, 0}); // a branch without freedom is no fork
  const Skeleton skeleton = make_skeleton(marks);
  const std::vector<Limb> limbs = find_limbs(skeleton);
  std::map<std::string, size_t> freedom;
  for (const Limb &limb : limbs)
    freedom[limb.name] = limb.dofs.size();
  const std::map<std::string, size_t> expected = {{"spine", 3},      {"neck", 3},  {"l_clavicle", 7},
                                                  {"r_clavicle", 7}, {"l_hip", 5}, {"r_hip", 5}};
  EXPECT_EQ(freedom, expected);
  EXPECT_EQ(limbs[0].name, "spine"); // what carries others comes first
  for (const Limb &limb : limbs)
    if (limb.name == "l_clavicle") {
      EXPECT_EQ(limb.joints.size(), 6u); // clavicle, shoulder, elbow, wrist, hand, thumb
    }
  const Skeleton chain = make_skeleton({{"a", "", {0, 0, 0}, 6}, {"b", "a", {0, 1, 0}, 3}, {"c", "b", {0, 2, 0}, 1}});
  ASSERT_EQ(find_limbs(chain).size(), 1u);
  EXPECT_EQ(find_limbs(chain)[0].dofs.size(), 4u);
  const Skeleton carried = make_skeleton({{"root", "", {0, 0, 0}, 6},
                                          {"pelvis", "root", {0, 0.1, 0}, 0}, // nothing to search: no limb
                                          {"spine", "pelvis", {0, 0.4, 0}, 3},
                                          {"l_hip", "pelvis", {0.1, 0, 0}, 3},
                                          {"r_hip", "pelvis", {-0.1, 0, 0}, 3}});
  ASSERT_EQ(find_limbs(carried).size(), 3u);
  for (const Limb &limb : find_limbs(carried))
    EXPECT_EQ(limb.dofs.size(), 3u) << limb.name;
}

const std::pair<const char *, const char *> kTurns[] = {
    {"l_shoulder.z", "l_clavicle"}, {"r_shoulder.x", "r_clavicle"}, {"l_hip.x", "l_hip"}, {"r_hip.z", "r_hip"}};

TEST(LimbErrors, NameTheLimbThatIsWrong) {
  Scene scene;
  EXPECT_LT(limb_errors(scene.problem(), scene.truth, scene.limbs, {}, scene.context).maxCoeff(), 0.004);
  EXPECT_LT(overlap_energy(scene.problem(), scene.truth, {}, scene.context), 0.03);
  for (const auto &[turn, name] : kTurns)
    for (const double angle : {70, -70}) {
      Eigen::VectorXd wrong = scene.truth;
      wrong[scene.dof(turn)] += angle * kDegree;
      const Eigen::VectorXd errors = limb_errors(scene.problem(), wrong, scene.limbs, {}, scene.context);
      Eigen::Index worst;
      errors.maxCoeff(&worst);
      EXPECT_EQ(scene.limbs[worst].name, name) << turn << " " << angle;
      EXPECT_GT(errors[worst], LimbSearchOptions().lost_error) << turn << " " << angle;
      EXPECT_GT(overlap_energy(scene.problem(), wrong, {}, scene.context), 0.05);
    }
}

TEST(LimbErrors, CountLooseClothLess) {
  Scene scene;
  Eigen::VectorXd wrong = scene.truth;
  wrong[scene.dof("l_hip.x")] += 40 * kDegree;
  LimbProblem problem = scene.problem();
  const Eigen::VectorXd firm = limb_errors(problem, wrong, scene.limbs, {}, scene.context);
  for (int i = 0; i < scene.actor.mesh.vertices.rows(); ++i)
    problem.reliability[i] = scene.actor.mesh.vertices(i, 1) < 0.3 ? 1e-3 : 1; // the shins wear something wide
  const Eigen::VectorXd loose = limb_errors(problem, wrong, scene.limbs, {}, scene.context);
  const auto leg =
      std::find_if(scene.limbs.begin(), scene.limbs.end(), [](const Limb &l) { return l.name == "l_hip"; }) - scene.limbs.begin();
  EXPECT_LT(loose[leg], 0.7 * firm[leg]);
}

TEST(LimbSearch, FindsALimbSeventyDegreesOff) {
  for (const auto &[turn, name] : kTurns) {
    Scene scene;
    const Eigen::VectorXd expected = scene.truth;
    scene.truth[scene.dof(turn)] += 70 * kDegree;
    scene.film();
    LimbProblem problem = scene.problem();
    problem.predicted = expected;
    std::vector<Limb> lost;
    for (const Limb &limb : scene.limbs)
      if (limb.name == name)
        lost.push_back(limb);
    const Eigen::VectorXd found = LimbSearch::create()->search(problem, expected, lost, scene.context);
    for (int d = 0; d < found.size(); ++d)
      if (std::find(lost[0].dofs.begin(), lost[0].dofs.end(), d) == lost[0].dofs.end()) {
        EXPECT_EQ(found[d], expected[d]); // only the limb moves
      }
    const Vertices truth = scene.joints(scene.truth), before = scene.joints(expected), after = scene.joints(found);
    const double off = (before - truth).rowwise().norm().maxCoeff(), left = (after - truth).rowwise().norm().maxCoeff();
    EXPECT_LT(left, 0.25 * off) << turn;
    EXPECT_LT(limb_errors(problem, found, lost, {}, scene.context)[0], LimbSearchOptions().lost_error) << turn;
  }
}

TEST(LimbSearch, WhatIsOfAnotherActorIsRefused) {
  Scene scene;
  const auto refuses = [&](const LimbProblem &problem, const std::vector<Limb> &limbs, bool search) {
    if (search) {
      EXPECT_THROW(LimbSearch::create()->search(problem, scene.truth, limbs, scene.context), std::invalid_argument);
    } else {
      EXPECT_THROW(limb_errors(problem, scene.truth, limbs, {}, scene.context), std::invalid_argument);
    }
  };
  std::vector<Limb> others = scene.limbs;
  others[0].dofs.back() = scene.actor.skeleton.dof_count();
  refuses(scene.problem(), others, true);
  others = scene.limbs;
  others[0].joints.back() = scene.actor.skeleton.joint_count();
  refuses(scene.problem(), others, false);
  LimbProblem problem = scene.problem();
  problem.predicted.conservativeResize(5);
  refuses(problem, scene.limbs, true);
  problem.reliability.conservativeResize(5);
  refuses(problem, scene.limbs, false);
}

TEST(LimbSearch, SameBitsForAnyNumberOfThreads) {
  Scene scene;
  Eigen::VectorXd wrong = scene.truth;
  wrong[scene.dof("l_shoulder.z")] += 1;
  LimbSearchOptions options;
  options.annealing.particles = 12;
  options.annealing.iterations = 3;
  std::vector<Eigen::VectorXd> found, errors;
  for (int threads : {1, 2, 3}) {
    scene.context.threads = threads;
    found.push_back(LimbSearch::create(options)->search(scene.problem(), wrong, scene.limbs, scene.context));
    errors.push_back(limb_errors(scene.problem(), wrong, scene.limbs, options, scene.context));
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
  EXPECT_EQ(errors[0], errors[1]);
  EXPECT_EQ(errors[0], errors[2]);
  options.annealing.seed = 2;
  EXPECT_NE(LimbSearch::create(options)->search(scene.problem(), wrong, scene.limbs, scene.context), found[0]);
}

double hand_error(const CaptureResult &result, const Scene &scene, const MatrixRM &truth, int t) {
  const int hand = scene.actor.skeleton.find("l_wrist");
  return (result.performance.joints[t].row(hand) - scene.joints(truth.row(t)).row(hand)).norm();
}

/// Puts an arm wrong in one frame, once.
class Sabotage : public PoseOptimizer {
public:
  Sabotage(int call, const std::string &dof, double angle = 70 * kDegree)
      : call_(call), dof_(dof), angle_(angle), inner_(PoseOptimizer::create()) {}
  PoseEstimate optimize(const PoseProblem &problem, const Context &context) override {
    PoseEstimate estimate = inner_->optimize(problem, context);
    const auto &names = problem.actor->skeleton.dof_names;
    if (calls_++ == call_)
      estimate.dofs[std::find(names.begin(), names.end(), dof_) - names.begin()] += angle_;
    return estimate;
  }

private:
  int call_, calls_ = 0;
  std::string dof_;
  double angle_;
  std::unique_ptr<PoseOptimizer> inner_;
};

TEST(LostLimb, PutWrongInOneFrameIsFoundAgain) {
  const Scene scene;
  const int frames = 6, turned = scene.dof("l_shoulder.z");
  MatrixRM truth = MatrixRM::Zero(frames, scene.truth.size());
  for (int t = 0; t < frames; ++t)
    truth(t, turned) = 0.03 * t;
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, truth));
  CaptureOptions options;
  options.second_pass = false; // which would not see the sabotage
  options.smooth_window = 1;
  std::vector<std::string> said;
  Context context;
  context.log = [&](const std::string &line) { said.push_back(line); };
  CaptureParts parts;
  parts.pose = std::make_shared<Sabotage>(2, "l_shoulder.z");
  const auto with = PerformanceCapture::create(options, parts)->capture(scene.actor, scene.rig, film, nullptr, context);
  ASSERT_FALSE(with.summary.lost_limbs.empty());
  EXPECT_EQ(with.summary.lost_limbs[0].frame, 2);
  EXPECT_EQ(with.summary.lost_limbs[0].limb, "l_clavicle");
  EXPECT_TRUE(with.summary.lost_limbs[0].recovered);
  EXPECT_GT(with.summary.lost_limbs[0].before, 2 * with.summary.lost_limbs[0].after);
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const std::string &line) {
    return line.find("frame 2, limb 'l_clavicle' lost") != std::string::npos && line.find("found again") != std::string::npos;
  }));
  for (int t = 2; t < frames; ++t)
    EXPECT_LT(hand_error(with, scene, truth, t), 0.03) << "frame " << t;
}

/// rad, of the left elbow; the same backwards and forwards.
double bend(const Scene &scene, const Eigen::VectorXd &dofs) {
  const Vertices joints = scene.joints(dofs);
  const auto at = [&](const char *name) -> Eigen::Vector3d { return joints.row(scene.actor.skeleton.find(name)).transpose(); };
  const Eigen::Vector3d above = at("l_elbow") - at("l_shoulder"), below = at("l_wrist") - at("l_elbow");
  return std::atan2(above.cross(below).norm(), above.dot(below));
}

TEST(BackwardHinges, AreElbowsAndKneesBentBeyondStraight) {
  const Scene scene;
  const Skeleton &skeleton = scene.actor.skeleton;
  const RiggedMesh forwards = detail::forwards_only(scene.actor);
  const double straight = -bend(scene, scene.truth);
  const int elbow = scene.dof("l_elbow.flex");
  EXPECT_NEAR(forwards.skeleton.lower[elbow], straight, 1e-9);
  EXPECT_EQ((forwards.skeleton.lower.array() != skeleton.lower.array()).count(), 4); // two elbows, two knees
  for (const double beyond : {-1.0, 2.0, 4.0}) {
    Eigen::VectorXd dofs = scene.truth;
    dofs[elbow] = straight - beyond * kDegree;
    ASSERT_NEAR(bend(scene, dofs), std::abs(beyond) * kDegree, 1e-6);
    for (const Limb &limb : scene.limbs)
      EXPECT_EQ(detail::bends_backwards(skeleton, limb, dofs), beyond > 3 && limb.name == "l_clavicle") << beyond << limb.name;
  }
}

TEST(LostLimb, WithAnElbowThatBendsBackwardsIsSought) {
  const Scene scene;
  const int frames = 4, elbow = scene.dof("l_elbow.flex");
  const double straight = -bend(scene, scene.truth);
  MatrixRM truth = MatrixRM::Zero(frames, scene.truth.size());
  for (int t = 0; t < frames; ++t)
    truth(t, elbow) = straight + (8 - 2 * t) * kDegree;
  truth.row(0).setZero();
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, truth));
  CaptureOptions options;
  options.second_pass = false;
  options.smooth_window = 1;
  for (const bool sought : {true, false}) {
    options.find_lost_limbs = sought;
    CaptureParts parts;
    parts.pose = std::make_shared<Sabotage>(3, "l_elbow.flex", -10 * kDegree); // a few millimetres at the hand: no large error
    const auto result = PerformanceCapture::create(options, parts)->capture(scene.actor, scene.rig, film, nullptr, {});
    EXPECT_TRUE(result.summary.lost_limbs.empty());
    EXPECT_EQ(result.performance.dofs(3, elbow) > straight, sought);
  }
}

TEST(SlowLostLimb, ThatJumpedBetweenFramesIsFoundAgain) {
  const Scene scene;
  const int frames = 6, turned = scene.dof("l_shoulder.z");
  MatrixRM truth = MatrixRM::Zero(frames, scene.truth.size());
  truth.bottomRows(4).col(turned).setConstant(70 * kDegree); // the arm goes up between frames 1 and 2
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, truth));
  CaptureOptions options;
  options.smooth_window = 1;
  options.second_pass = false;
  const auto with = PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  for (int t = 4; t < frames; ++t)
    EXPECT_LT(hand_error(with, scene, truth, t), 0.04) << "frame " << t;
  options.find_lost_limbs = false;
  const auto without = PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  EXPECT_GT(hand_error(without, scene, truth, frames - 1), 0.1); // else this test shows nothing
  EXPECT_TRUE(without.summary.lost_limbs.empty());
}

TEST(LostLimb, SearchCanBeSwappedAndIsChecked) {
  struct Nonsense : LimbSearch {
    Eigen::VectorXd search(const LimbProblem &, const Eigen::VectorXd &, const std::vector<Limb> &, const Context &) override {
      return Eigen::VectorXd::Zero(3);
    }
  };
  const Scene scene;
  MatrixRM truth = MatrixRM::Zero(3, scene.truth.size());
  truth.bottomRows(1).col(scene.dof("l_shoulder.z")).setConstant(70 * kDegree);
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, truth));
  CaptureParts parts;
  parts.limbs = std::make_shared<Nonsense>();
  EXPECT_THROW(PerformanceCapture::create({}, parts)->capture(scene.actor, scene.rig, film, nullptr, scene.context),
               std::runtime_error);
}

} // namespace limb_search_test
