// A small model in the SMPL family's layout, made from the toy's known modes.
#include "toy_population.h"

#include "doublet/bodymodel/body_fitter.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace doublet;

namespace {

/// (J, V): every joint an affine combination of its nearest vertices, of least norm; rows sum to one.
MatrixRM regressor() {
  const Vertices &v = toy::body().actor.mesh.vertices;
  MatrixRM matrix = MatrixRM::Zero(toy::body().joints.rows(), v.rows());
  for (int j = 0; j < matrix.rows(); ++j) {
    std::vector<int> order(v.rows());
    std::iota(order.begin(), order.end(), 0);
    auto distance = [&](int i) { return (v.row(i) - toy::body().joints.row(j)).norm(); };
    std::partial_sort(order.begin(), order.begin() + 60, order.end(), [&](int a, int b) { return distance(a) < distance(b); });
    Eigen::Matrix<double, 4, 60> near;
    for (int i = 0; i < 60; ++i)
      near.col(i) << v.row(order[i]).transpose(), 1;
    Eigen::Vector4d target;
    target << toy::body().joints.row(j).transpose(), 1;
    const Eigen::Matrix4d square = near * near.transpose();
    const Eigen::VectorXd weights = near.transpose() * square.ldlt().solve(target);
    for (int i = 0; i < 60; ++i)
      matrix(j, order[i]) = weights[i];
  }
  return matrix;
}

/// turn: the file's axes; the toy is y-up.
Npz smpl(const Eigen::Matrix3d &turn = Eigen::Matrix3d::Identity()) {
  const toy::Body &b = toy::body();
  const int v = static_cast<int>(b.normals.rows()), j = static_cast<int>(b.joints.rows());
  Npz file;
  file.set_f8("v_template", {v, 3}, toy::flat(b.actor.mesh.vertices * turn.transpose()));
  std::vector<double> directions(3 * v * toy::kModes);
  for (int k = 0; k < toy::kModes; ++k) {
    const Vertices mode = toy::kDeviation[k] * toy::mode(k) * turn.transpose();
    for (int i = 0; i < 3 * v; ++i)
      directions[i * toy::kModes + k] = mode.data()[i];
  }
  file.set_f8("shapedirs", {v, 3, toy::kModes}, directions);
  file.set_f8("J_regressor", {j, v}, toy::flat(regressor()));
  file.set_f8("weights", {v, j}, toy::flat(b.actor.weights));
  std::vector<double> table(2 * j);
  std::vector<std::string> names;
  for (int k = 0; k < j; ++k) {
    table[k] = k ? b.actor.skeleton.joints[k].parent : 4294967295.0; // as the unsigned arrays of such files have it
    table[j + k] = k;
    names.push_back(b.actor.skeleton.joints[k].name);
  }
  file.set_f8("kintree_table", {2, j}, table);
  file.set_text("joint_names", names);
  const Faces &f = b.actor.mesh.faces;
  file.set_i4("f", {f.rows(), 3}, {f.data(), f.data() + f.size()});
  return file;
}

std::shared_ptr<const BodyModel> written_and_read(const Npz &file) {
  const doublet::testing::TempFolder folder;
  file.write(folder.path() / "model.npz");
  return BodyModel::read(folder.path() / "model.npz");
}

std::string message(const Npz &file) {
  try {
    written_and_read(file);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(SmplFile, HoldsTemplateShapeAndJoints) {
  const auto model = written_and_read(smpl());
  const int joints = static_cast<int>(toy::body().joints.rows());
  ASSERT_EQ(model->component_count(), toy::kModes + 3 * (joints - 1));
  Eigen::VectorXd c = Eigen::VectorXd::Zero(model->component_count());
  const Eigen::RowVector3d root = toy::body().joints.row(0);
  EXPECT_LT((model->vertices(c) - (toy::body().actor.mesh.vertices.rowwise() - root)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((model->joints(c).points - (toy::body().joints.rowwise() - root)).cwiseAbs().maxCoeff(), 1e-9);
  c[0] = 2; // two deviations taller: the regressor carries the joints along
  const Vertices joints_then = model->joints(c).points;
  const int head = 4, last = joints - 1;
  for (int j : {head, last})
    EXPECT_NEAR((joints_then.row(j) - joints_then.row(0)).norm(),
                (1 + 2 * toy::kDeviation[0]) * (toy::body().joints.row(j) - root).norm(), 1e-6);
}

TEST(SmplFile, SparseRegressorAndOtherAxesAreTheSameModel) {
  const auto model = written_and_read(smpl());
  Eigen::VectorXd c = Eigen::VectorXd::Zero(model->component_count());
  c.head(4) << 1, -1, 0.5, 0.7;
  const Vertices expected = model->vertices(c);
  const MatrixRM dense = regressor();
  for (const bool by_rows : {true, false}) {
    std::vector<double> data;
    std::vector<int> indices, starts{0};
    const int lines = static_cast<int>(by_rows ? dense.rows() : dense.cols());
    for (int line = 0; line < lines; ++line) {
      const Eigen::VectorXd values = by_rows ? Eigen::VectorXd(dense.row(line)) : Eigen::VectorXd(dense.col(line));
      for (int i = 0; i < values.size(); ++i)
        if (values[i] != 0) {
          data.push_back(values[i]);
          indices.push_back(i);
        }
      starts.push_back(static_cast<int>(data.size()));
    }
    Npz sparse = smpl();
    sparse.arrays.erase("J_regressor");
    const auto n = static_cast<std::int64_t>(data.size());
    sparse.set_f8("J_regressor_data", {n}, data);
    sparse.set_i4("J_regressor_indices", {n}, indices);
    sparse.set_i4("J_regressor_indptr", {static_cast<std::int64_t>(starts.size())}, starts);
    sparse.set_i4("J_regressor_shape", {2}, {static_cast<int>(dense.rows()), static_cast<int>(dense.cols())});
    EXPECT_LT((written_and_read(sparse)->vertices(c) - expected).cwiseAbs().maxCoeff(), 1e-9) << by_rows;
  }
  const Eigen::Matrix3d z_up = Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX()).toRotationMatrix();
  c.tail(c.size() - toy::kModes).setZero(); // rotation vectors are about the axes of the upright model
  const Vertices upright = written_and_read(smpl(z_up))->vertices(c);
  EXPECT_LT((upright - model->vertices(c)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SmplFile, FitsAPosedPerson) {
  std::mt19937 random(77);
  const toy::Posed posed = toy::posed(toy::person({0.03, 0.008, -0.009}), toy::random_pose(random, 0.7));
  RiggedMesh actor = toy::body().actor;
  actor.mesh.vertices = posed.vertices.rowwise() + Eigen::RowVector3d(1, 0, -1);
  for (int j = 0; j < posed.joints.rows(); ++j)
    actor.skeleton.joints[j].rest = posed.joints.row(j).transpose() + Eigen::Vector3d(1, 0, -1);
  const auto n = actor.mesh.vertices.rows();
  const Segmentation naked{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXi::Constant(n, -1), 0};
  const BodyFit fit = BodyFitter::create()->fit(actor, naked, *written_and_read(smpl()), {}, {});
  EXPECT_LT((fit.body.vertices - actor.mesh.vertices).rowwise().norm().mean(), 0.006);
}

TEST(SmplFile, NamesWhatIsWrong) {
  const doublet::testing::TempFolder folder;
  write_text(folder.path() / "model.pkl", "\x80\x02");
  try {
    BodyModel::read(folder.path() / "model.pkl");
    ADD_FAILURE();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("pickle"), std::string::npos);
  }
  const Npz good = smpl();
  for (const char *name : {"v_template", "shapedirs", "J_regressor", "weights", "kintree_table", "f"}) {
    Npz broken = good;
    broken.arrays.erase(name);
    EXPECT_NE(message(broken).find(name), std::string::npos) << name << ": " << message(broken);
  }
  Npz broken = good;
  broken.set_i4("f", {1, 3}, {0, 1, 1 << 24});
  EXPECT_NE(message(broken).find("'f'"), std::string::npos);
  broken = good;
  broken.set_f8("weights", {2, 2}, {1, 0, 0, 1});
  EXPECT_NE(message(broken).find("'weights'"), std::string::npos);
  std::vector<double> weights = good.values("weights");
  weights[weights.size() / 2] = std::nan("");
  broken.set_f8("weights", good.shape("weights"), weights);
  EXPECT_NE(message(broken).find("'weights'"), std::string::npos);
  broken = good;
  broken.set_text("joint_names", {"pelvis"});
  EXPECT_NE(message(broken).find("joint_names"), std::string::npos);
  Npz unused = good; // other arrays of such files are none of the reader's business
  unused.set_text("part2num", {"dictionary"});
  EXPECT_EQ(message(unused), "");
}
