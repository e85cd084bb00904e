#include "toy_population.h"

#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/train_body_model.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/rays/ray_scene.h"
#include "doublet/testing/body_fitter_conformance.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

using namespace doublet;

namespace {

constexpr int kPeople = 24;

/// Trained once for all tests.
struct Trained {
  doublet::testing::TempFolder folder;
  std::filesystem::path population = folder.path() / "population.npz", file = folder.path() / "model.npz";
  std::vector<Eigen::Vector3d> amounts;
  TrainSummary summary;
  std::shared_ptr<const BodyModel> model;

  Trained() {
    toy::population(kPeople, &amounts).write(population);
    TrainOptions options;
    options.components = 10;
    options.command = "test";
    summary = train_body_model(population, file, options);
    model = BodyModel::read(file);
  }
};

const Trained &trained() {
  static const Trained instance;
  return instance;
}

Eigen::VectorXd some_coefficients(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, size);
  Eigen::VectorXd c(trained().model->component_count());
  for (double &value : c)
    value = normal(random);
  return c;
}

/// A body made by the toy (not by the model) as an actor that stands elsewhere, its joints and landmarks marked.
struct Subject {
  RiggedMesh actor;
  Segmentation segmentation;
  std::map<std::string, Eigen::Vector3d> landmarks;
};

Subject make_subject(double scale = 1) {
  std::mt19937 random(77);
  const toy::Posed posed = toy::posed(toy::person({0.03, 0.008, -0.009}), toy::random_pose(random, 0.7));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.1, 1, 0.05).normalized()).toRotationMatrix();
  auto place = [&](const Vertices &v) -> Vertices {
    return (scale * v * turn.transpose()).rowwise() + Eigen::RowVector3d(1.5, 0.2, -0.7);
  };
  Subject subject;
  subject.actor = toy::body().actor;
  subject.actor.mesh.vertices = place(posed.vertices);
  const Vertices joints = place(posed.joints);
  for (int j = 0; j < joints.rows(); ++j)
    subject.actor.skeleton.joints[j].rest = joints.row(j).transpose();
  for (const auto &[name, index] : toy::body().landmarks)
    subject.landmarks[name] = subject.actor.mesh.vertices.row(index).transpose();
  const int n = static_cast<int>(joints.rows() > 0 ? subject.actor.mesh.vertices.rows() : 0);
  subject.segmentation = {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXi::Constant(n, -1), 0};
  return subject;
}

bool on_thigh(int v) {
  const auto p = toy::body().actor.mesh.vertices.row(v);
  return p[1] > 0.45 && p[1] < 0.85 && std::abs(p[0]) < 0.25;
}

double mean_error(const BodyFit &fit, const RiggedMesh &truth, bool thighs_only) {
  double sum = 0;
  int count = 0;
  for (int v = 0; v < fit.body.vertices.rows(); ++v)
    if (!thighs_only || on_thigh(v)) {
      sum += (fit.body.vertices.row(v) - truth.mesh.vertices.row(v)).norm();
      ++count;
    }
  return sum / count;
}

} // namespace

TEST(TrainBodyModel, RecoversTheKnownModes) {
  const Trained &t = trained();
  EXPECT_EQ(t.summary.meshes, 2 * kPeople);
  EXPECT_GT(t.summary.variance_kept, 0.9999);
  EXPECT_LT(t.summary.reconstruction_mm, 0.1);
  // Three modes made the shapes, so three components carry them; each planted mode, with the root at the origin, lies in their
  // span.
  const int v = t.model->vertex_count();
  Eigen::MatrixXd components(3 * v, toy::kModes);
  for (int k = 0; k < toy::kModes; ++k) {
    const Vertices c = t.model->component(k);
    components.col(k) = Eigen::Map<const Eigen::VectorXd>(c.data(), c.size());
  }
  EXPECT_LT(t.model->component(toy::kModes).norm(), 0.02 * components.col(toy::kModes - 1).norm());
  const Eigen::Matrix<double, toy::kModes, toy::kModes> products = components.transpose() * components;
  for (int k = 0; k < toy::kModes; ++k) {
    Vertices planted = toy::mode(k);
    if (k == 0)
      planted.rowwise() -= toy::body().joints.row(0);
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(planted.data(), planted.size()).normalized();
    // component() is at the model's mean pose, which is not exactly the rest pose
    const Eigen::Matrix<double, toy::kModes, 1> along = components.transpose() * x;
    EXPECT_GT(std::sqrt(along.dot(products.inverse() * along)), 0.99) << k; // length of the projection on the span
  }
}

TEST(TrainBodyModel, ComponentsAreScaledByTheirDeviation) {
  const Trained &t = trained();
  double planted = 0, found = 0;
  for (int k = 0; k < toy::kModes; ++k) {
    double squares = 0, mean = 0;
    for (const auto &a : t.amounts)
      mean += a[k] / kPeople;
    for (const auto &a : t.amounts)
      squares += std::pow(a[k] - mean, 2) / kPeople;
    Vertices d = toy::mode(k);
    if (k == 0)
      d.rowwise() -= toy::body().joints.row(0);
    planted += squares * d.squaredNorm(); // amounts are drawn independently: variances add up, nearly
    found += t.model->component(k).squaredNorm();
  }
  EXPECT_NEAR(found / planted, 1, 0.15);
}

TEST(TrainBodyModel, RejectsBrokenPopulations) {
  const Trained &t = trained();
  const auto out = t.folder.path() / "never.npz";
  EXPECT_THROW(train_body_model(t.folder.path() / "nothing.npz", out), FileNotFound);
  TrainOptions options;
  options.components = 0;
  EXPECT_THROW(train_body_model(t.population, out, options), std::invalid_argument);
  options = {};
  options.individuals = {999};
  EXPECT_THROW(train_body_model(t.population, out, options), std::invalid_argument);
  options.individuals = {0, 1, 2, kPeople}; // the last one is not there
  EXPECT_THROW(train_body_model(t.population, out, options), std::invalid_argument);
  const Npz good = toy::population(3);
  for (const char *name :
       {"vertices_q", "vertex_scale", "faces", "skin_weights", "joint_rotvec", "joint_parents", "landmark_indices"}) {
    Npz broken = good;
    broken.arrays.erase(name);
    broken.write(t.folder.path() / "broken.npz");
    try {
      train_body_model(t.folder.path() / "broken.npz", out);
      ADD_FAILURE() << name;
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  Npz broken = good;
  broken.set_i4("mesh_individual", {6}, {0, 0, 1, 1, 2, 7});
  broken.write(t.folder.path() / "broken.npz");
  EXPECT_THROW(train_body_model(t.folder.path() / "broken.npz", out), Error);
  const std::int64_t vertices = good.shape("vertices_q")[1];
  Npz root = good; // alone
  root.set_text("joint_names", {"pelvis"});
  root.set_i4("joint_parents", {1}, {-1});
  root.set_f8("skin_weights", {vertices, 1}, std::vector<double>(static_cast<std::size_t>(vertices), 1));
  root.set_f8("ind_rest_joints", {3, 1, 3}, std::vector<double>(9, 0));
  for (const char *name : {"joints", "joint_rotvec"})
    root.set_f8(name, {6, 1, 3}, std::vector<double>(18, 0));
  root.write(t.folder.path() / "broken.npz");
  EXPECT_THROW(train_body_model(t.folder.path() / "broken.npz", out), Error);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(BodyModel, DerivativesMatchFiniteDifferences) {
  const BodyModel &model = *trained().model;
  const Eigen::VectorXd c = some_coefficients(3, 0.8);
  std::vector<int> chosen;
  for (int v = 0; v < model.vertex_count(); v += 37)
    chosen.push_back(v);
  const BodyLinearisation at = model.linearise(c, chosen), joints = model.joints(c);
  const Vertices all = model.vertices(c);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    EXPECT_LT((at.points.row(i) - all.row(chosen[i])).norm(), 1e-12);
  const double h = 1e-5;
  for (int k = 0; k < model.component_count(); ++k) {
    Eigen::VectorXd up = c, down = c;
    up[k] += h;
    down[k] -= h;
    const Vertices difference = (model.vertices(up) - model.vertices(down)) / (2 * h);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      EXPECT_LT((at.jacobian.block<3, 1>(3 * i, k) - difference.row(chosen[i]).transpose()).norm(), 1e-7)
          << k << " " << chosen[i];
    const Vertices moved = (model.joints(up).points - model.joints(down).points) / (2 * h);
    for (int j = 0; j < moved.rows(); ++j)
      EXPECT_LT((joints.jacobian.block<3, 1>(3 * j, k) - moved.row(j).transpose()).norm(), 1e-7) << k << " joint " << j;
  }
}

TEST(BodyModel, LinearModelsNeedNoMoreThanTheirComponents) {
  class Linear : public BodyModel {
  public:
    int vertex_count() const override { return 3; }
    int component_count() const override { return 2; }
    const Faces &faces() const override { return faces_; }
    Vertices vertices(const Eigen::VectorXd &c) const override { return mean_ + c[0] * component(0) + c[1] * component(1); }
    Vertices component(int k) const override { return (k + 1.0) * Vertices::Identity(3, 3); }
    const std::map<std::string, int> &landmarks() const override { return landmarks_; }
    std::string name() const override { return "linear"; }

  private:
    Faces faces_ = (Faces(1, 3) << 0, 1, 2).finished();
    Vertices mean_ = Vertices::Constant(3, 3, 5);
    std::map<std::string, int> landmarks_;
  };
  const BodyLinearisation at = Linear().linearise(Eigen::Vector2d(1, 1), {2, 0});
  EXPECT_EQ(at.points(0, 2), 8);
  EXPECT_EQ(at.jacobian(2, 1), 2);
  EXPECT_EQ(at.jacobian(3, 0), 1);
  EXPECT_EQ(at.jacobian(0, 0), 0);
  EXPECT_EQ(Linear().joints(Eigen::Vector2d(0, 0)).points.rows(), 0);
}

TEST(BodyModel, FilesAreReadBackAndTheirNameTellsThemApart) {
  const Trained &t = trained();
  TrainOptions options;
  options.components = 2;
  train_body_model(t.population, t.folder.path() / "two.npz", options);
  const auto two = BodyModel::read(t.folder.path() / "two.npz");
  EXPECT_NE(two->name(), t.model->name());
  EXPECT_EQ(BodyModel::read(t.file)->name(), t.model->name());
  EXPECT_EQ(two->component_count(), 2 + 3 * 23);
  EXPECT_EQ(t.model->landmarks().at("head_top"), toy::body().landmarks.at("crown"));
  EXPECT_EQ(t.model->landmarks().at("l_middle_fingertip"), toy::body().landmarks.at("l_middle_tip"));
  EXPECT_THROW(two->vertices(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(two->component(-1), std::invalid_argument);
}

TEST(BodyModel, RejectsBrokenFiles) {
  const Trained &t = trained();
  const auto path = t.folder.path() / "bad.npz";
  EXPECT_THROW(BodyModel::read(t.folder.path() / "missing.npz"), FileNotFound);
  write_text(path, "not a zip");
  EXPECT_THROW(BodyModel::read(path), Error);
  EXPECT_THROW(BodyModel::read(t.population), Error);
  const Npz good = Npz::read(t.file);
  for (const auto &[name, array] : good.arrays) {
    if (name == "licence" || name == "command")
      continue;
    Npz broken = good;
    broken.arrays.erase(name);
    broken.write(path);
    EXPECT_THROW(BodyModel::read(path), Error) << name;
  }
  Npz broken = good;
  broken.set_i4("joint_parents", good.shape("joint_parents"), std::vector<int>(24, 3));
  broken.write(path);
  EXPECT_THROW(BodyModel::read(path), Error);
  broken = good;
  broken.set_i4("faces", {1, 3}, {0, 1, 1 << 24});
  broken.write(path);
  EXPECT_THROW(BodyModel::read(path), Error);
}

TEST(BodyFit, FindsAWholeBody) {
  const Subject subject = make_subject();
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  EXPECT_LT(mean_error(fit, subject.actor, false), 0.004);
  EXPECT_LT(fit.residual, 0.002);
  EXPECT_EQ(fit.model, trained().model->name());
  EXPECT_EQ(fit.coefficients.size(), trained().model->component_count());
}

TEST(BodyFit, FindsTheHiddenThighsFromTheRest) {
  Subject subject = make_subject();
  const Faces &faces = subject.actor.mesh.faces;
  for (int f = 0; f < faces.rows(); ++f)
    if (on_thigh(faces(f, 0)) || on_thigh(faces(f, 1)) || on_thigh(faces(f, 2)))
      subject.actor.face_valid[f] = 0;
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  EXPECT_LT(mean_error(fit, subject.actor, true), 0.008);
}

TEST(BodyFit, ClothHoldsTheBodyInsideButDoesNotPullItOut) {
  Subject subject = make_subject();
  const RiggedMesh truth = subject.actor;
  const Vertices normals = vertex_normals(truth.mesh.vertices, truth.mesh.faces);
  for (int v = 0; v < normals.rows(); ++v)
    if (on_thigh(
            v)) { // trousers, 3 cm wider than the leg; they meet between the thighs, so legs may turn: distances to the surface
      subject.actor.mesh.vertices.row(v) += 0.03 * normals.row(v);
      subject.segmentation.clothness[v] = 1;
    }
  auto thigh_distance = [&](const BodyFit &fit) {
    const RayScene scene(fit.body);
    double sum = 0;
    int count = 0;
    for (int v = 0; v < normals.rows(); ++v)
      if (on_thigh(v)) {
        sum += scene.closest(truth.mesh.vertices.row(v).transpose()).distance;
        ++count;
      }
    return sum / count;
  };
  const auto fitter = BodyFitter::create();
  const double aware = thigh_distance(fitter->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {}));
  EXPECT_LT(aware, 0.006);
  subject.segmentation.clothness.setZero();
  const double unaware =
      thigh_distance(fitter->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {}));
  EXPECT_GT(unaware, 2 * aware);
}

TEST(BodyFit, ClothThatFacesAnotherWayIsNotWornHere) {
  // The thighs are missing and cloth stands 3 cm off with its outside towards them, as a sleeve does beside a hip.
  Subject subject = make_subject();
  const RiggedMesh truth = subject.actor;
  const Vertices normals = vertex_normals(truth.mesh.vertices, truth.mesh.faces);
  std::vector<int> rest, panel;
  for (int f = 0; f < truth.mesh.faces.rows(); ++f)
    (on_thigh(truth.mesh.faces(f, 0)) ? panel : rest).push_back(f);
  Mesh away = truth.mesh;
  away.vertices += 0.03 * normals;
  away.faces.col(1).swap(away.faces.col(2));
  const Mesh skin = submesh(truth.mesh, rest);
  subject.actor.mesh = doublet::testing::join({skin, submesh(away, panel)});
  subject.actor.face_valid.assign(subject.actor.mesh.faces.rows(), 1);
  subject.segmentation.clothness = Eigen::VectorXd::Ones(subject.actor.mesh.vertices.rows());
  subject.segmentation.clothness.head(skin.vertices.rows()).setZero();
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  EXPECT_LT(mean_error(fit, truth, true), 0.008);
}

TEST(BodyFit, SaysWhereItCannotBeTrusted) {
  Subject subject = make_subject();
  for (int v = 0; v < subject.segmentation.clothness.size(); ++v)
    subject.segmentation.clothness[v] = on_thigh(v);
  for (int f = 0; f < subject.actor.mesh.faces.rows(); ++f)
    subject.actor.face_valid[f] = !on_thigh(subject.actor.mesh.faces(f, 0));
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  ASSERT_EQ(fit.deviation.size(), fit.body.vertices.rows());
  double hidden = 0, seen = 0;
  int count = 0;
  for (int v = 0; v < fit.deviation.size(); ++v)
    if (on_thigh(v)) {
      hidden += fit.deviation[v];
      ++count;
    } else
      seen += fit.deviation[v];
  EXPECT_GT(hidden / count, 1.5 * seen / (fit.deviation.size() - count));
  EXPECT_LT(mean_error(fit, subject.actor, true), 2 * hidden / count); // and it does not promise too much

  double area = 0;
  bool thigh = false;
  for (const BodyRegion &region : body_regions(fit, subject.actor, subject.segmentation)) {
    area += region.area;
    EXPECT_GT(region.deviation, 0) << region.joint;
    if (region.joint.find("hip") != std::string::npos) {
      thigh = true;
      EXPECT_LT(region.exposed, 0.5) << region.joint;
    } else if (region.joint.find("elbow") != std::string::npos) {
      EXPECT_GT(region.exposed, 0.9) << region.joint;
    }
  }
  EXPECT_TRUE(thigh);
  EXPECT_NEAR(area, face_areas(fit.body.vertices, fit.body.faces).sum(), 0.01);
}

TEST(BodyFit, ScansOfOnePersonHelpEachOther) {
  // One scan lacks the thighs, the other everything but the thighs and the feet.
  const Subject whole = make_subject();
  Subject upper = whole, lower = whole;
  for (int f = 0; f < whole.actor.mesh.faces.rows(); ++f) {
    const int v = whole.actor.mesh.faces(f, 0);
    upper.actor.face_valid[f] = !on_thigh(v);
    lower.actor.face_valid[f] = on_thigh(v) || whole.actor.mesh.vertices(v, 1) < 0.2;
  }
  const auto fitter = BodyFitter::create();
  const std::vector<BodyFit> fits = fitter->fit_together(
      {{&upper.actor, &upper.segmentation, upper.landmarks}, {&lower.actor, &lower.segmentation, lower.landmarks}},
      *trained().model, {});
  ASSERT_EQ(fits.size(), 2u);
  const int shape = trained().model->shape_count();
  EXPECT_EQ(fits[0].coefficients.head(shape), fits[1].coefficients.head(shape));
  for (const Subject *subject : {&upper, &lower}) {
    const BodyFit &with_help = fits[subject == &lower];
    const BodyFit alone = fitter->fit(subject->actor, subject->segmentation, *trained().model, subject->landmarks, {});
    EXPECT_LT(with_help.deviation.sum(), alone.deviation.sum());
    if (subject == &lower) { // whose trunk nobody saw
      EXPECT_LT(mean_error(with_help, whole.actor, false), mean_error(alone, whole.actor, false));
    }
  }

  EXPECT_THROW(fitter->fit_together({}, *trained().model, {}), std::invalid_argument);
  Subject hidden = whole;
  hidden.segmentation.clothness.setOnes();
  try {
    fitter->fit_together(
        {{&upper.actor, &upper.segmentation, upper.landmarks}, {&hidden.actor, &hidden.segmentation, hidden.landmarks}},
        *trained().model, {});
    FAIL();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("scan 1"), std::string::npos) << error.what();
  }
}

TEST(BodyFit, ForgivesMarksThatAreOff) {
  Subject subject = make_subject();
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.03 / std::sqrt(3.0));
  for (auto &[name, point] : subject.landmarks)
    point += Eigen::Vector3d(normal(random), normal(random), normal(random));
  subject.landmarks["unknown_to_the_model"] = {9, 9, 9};
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  EXPECT_LT(mean_error(fit, subject.actor, false), 0.006);
}

TEST(BodyFit, IsFreeOfScale) {
  const Subject subject = make_subject(2.0); // marked in units of half a metre
  const BodyFit fit = BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, {});
  EXPECT_LT(mean_error(fit, subject.actor, false), 0.012);
}

TEST(BodyFit, DoesNotDependOnThreads) {
  const Subject subject = make_subject();
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  BodyFitOptions options;
  options.iterations = 4;
  const auto fitter = BodyFitter::create(options);
  const BodyFit a = fitter->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, one);
  const BodyFit b = fitter->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, three);
  EXPECT_TRUE((a.body.vertices.array() == b.body.vertices.array()).all());
}

TEST(BodyFit, RejectsWhatCannotBeFitted) {
  const BodyModel &model = *trained().model;
  const auto fitter = BodyFitter::create();
  Subject nameless = make_subject();
  nameless.landmarks = {{"somewhere", {0, 0, 0}}};
  for (Joint &joint : nameless.actor.skeleton.joints)
    joint.name = "bone_" + joint.name;
  EXPECT_THROW(fitter->fit(nameless.actor, nameless.segmentation, model, nameless.landmarks, {}), Error);
  Subject covered = make_subject();
  covered.segmentation.clothness.setOnes();
  EXPECT_THROW(fitter->fit(covered.actor, covered.segmentation, model, covered.landmarks, {}), Error);
  Subject short_mask = make_subject();
  short_mask.segmentation.clothness.resize(3);
  EXPECT_THROW(fitter->fit(short_mask.actor, short_mask.segmentation, model, short_mask.landmarks, {}), std::invalid_argument);
  Subject nan = make_subject();
  nan.actor.mesh.vertices(3, 1) = std::nan("");
  EXPECT_THROW(fitter->fit(nan.actor, nan.segmentation, model, nan.landmarks, {}), Error);
  Subject point = make_subject();
  for (auto &[name, position] : point.landmarks)
    position.setZero();
  for (Joint &joint : point.actor.skeleton.joints)
    joint.rest.setZero();
  EXPECT_THROW(fitter->fit(point.actor, point.segmentation, model, point.landmarks, {}), Error);
  class Jointless : public BodyModel { // has names of joints alone
  public:
    int vertex_count() const override { return model_.vertex_count(); }
    int component_count() const override { return model_.component_count(); }
    const Faces &faces() const override { return model_.faces(); }
    Vertices vertices(const Eigen::VectorXd &c) const override { return model_.vertices(c); }
    Vertices component(int k) const override { return model_.component(k); }
    const std::map<std::string, int> &landmarks() const override { return model_.landmarks(); }
    std::string name() const override { return "jointless"; }
    std::vector<std::string> joint_names() const override { return model_.joint_names(); }

  private:
    const BodyModel &model_ = *trained().model;
  };
  const Subject whole = make_subject();
  EXPECT_THROW(fitter->fit(whole.actor, whole.segmentation, Jointless(), whole.landmarks, {}), std::invalid_argument);
  BodyFitOptions options;
  options.iterations = 0;
  EXPECT_THROW(BodyFitter::create(options), std::invalid_argument);
}

/// A body of one vertex too few that moves a little at every call; asks for nothing.
class Careless : public BodyFitter {
public:
  BodyFit fit(const RiggedMesh &, const Segmentation &, const BodyModel &model, const std::map<std::string, Eigen::Vector3d> &,
              const Context &) const override {
    BodyFit fit;
    fit.body = {Vertices::Constant(model.vertex_count() - 1, 3, ++calls_), model.faces()};
    fit.coefficients = Eigen::VectorXd::Constant(1, NAN);
    return fit;
  }

private:
  mutable int calls_ = 0;
};

/// Ours, a metre and a half away.
class Beside : public BodyFitter {
public:
  BodyFit fit(const RiggedMesh &actor, const Segmentation &segmentation, const BodyModel &model,
              const std::map<std::string, Eigen::Vector3d> &landmarks, const Context &context) const override {
    BodyFit fit = BodyFitter::create()->fit(actor, segmentation, model, landmarks, context);
    fit.body.vertices.col(0).array() += 1.5;
    return fit;
  }
};

/// No body, then one.
class Absent : public BodyFitter {
public:
  BodyFit fit(const RiggedMesh &, const Segmentation &, const BodyModel &model, const std::map<std::string, Eigen::Vector3d> &,
              const Context &) const override {
    BodyFit fit;
    if (++calls_ == 2)
      fit.body.vertices = Vertices::Zero(model.vertex_count(), 3);
    return fit;
  }

private:
  mutable int calls_ = 0;
};

TEST(BodyFitConformance, OursConformsAndACarelessOneDoesNot) {
  const Subject subject = make_subject();
  const auto violations = [&](const BodyFitter &fitter) {
    return doublet::testing::body_fitter_violations(fitter, subject.actor, subject.segmentation, *trained().model,
                                                    subject.landmarks);
  };
  for (const std::string &broken : violations(*BodyFitter::create()))
    ADD_FAILURE() << broken;
  EXPECT_EQ(violations(Careless()).size(), 6u); // sizes, finite, place, bits, landmarks, another mesh
  EXPECT_EQ(violations(Absent()).size(), 5u);   // the same, but for what is not finite
  EXPECT_EQ(violations(Beside()), std::vector<std::string>{"the body does not stand where the actor does"});
}

TEST(BodyFit, CanBeCancelled) {
  const Subject subject = make_subject();
  Context context;
  context.cancelled = [] { return true; };
  EXPECT_THROW(BodyFitter::create()->fit(subject.actor, subject.segmentation, *trained().model, subject.landmarks, context),
               Cancelled);
}
