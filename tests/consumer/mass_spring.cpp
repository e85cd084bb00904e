// A cloth solver that knows the installed headers alone: point masses and springs, explicit Euler in small steps.
#include <doublet/pbd/cloth_solver.h>
#include <doublet/testing/cloth_solver_conformance.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <vector>

namespace {

using namespace doublet::pbd;

class MassSpring : public ClothSolver {
public:
  explicit MassSpring(std::shared_ptr<const ClothModel> cloth) : ClothSolver(std::move(cloth)) {
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index f = 0; f < model().faces().rows(); ++f)
      for (int k = 0; k < 3; ++k)
        edges.insert(std::minmax({model().faces()(f, k), model().faces()(f, (k + 1) % 3)}));
    for (const auto &[a, b] : edges)
      springs_.push_back({a, b, (model().rest().row(b) - model().rest().row(a)).norm()});
  }

private:
  static constexpr int kSteps = 40; // a frame
  struct Spring {
    int a, b;
    double length;
  };

  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int) const override {
    std::vector<int> failed;
    for (std::size_t i = 0; i < states.size(); ++i) {
      ClothState next = states[i];
      for (int step = 1; step <= kSteps; ++step)
        advance(next, inputs[inputs.size() == 1 ? 0 : i], materials[i], step / static_cast<double>(kSteps));
      if (next.positions.allFinite() && next.velocities.allFinite())
        states[i] = std::move(next);
      else
        failed.push_back(static_cast<int>(i));
    }
    return failed;
  }

  /// One small step, at whose end the fraction `end` of the frame is over.
  void advance(ClothState &state, const StepInputs &in, const Material &material, double end) const {
    const double h = in.dt / kSteps, stiffness = 0.05 * material.k_stretch / (h * h);
    const Eigen::VectorXd &w = model().inverse_masses();
    Vertices push = Vertices::Zero(w.size(), 3);
    for (const Spring &s : springs_) {
      const Eigen::RowVector3d apart = state.positions.row(s.b) - state.positions.row(s.a);
      const double size = apart.norm(), light = std::max(w[s.a], w[s.b]);
      if (size == 0 || light == 0)
        continue;
      const Eigen::RowVector3d force = stiffness / light * (size - s.length) / size * apart;
      push.row(s.a) += w[s.a] * force;
      push.row(s.b) -= w[s.b] * force;
    }
    const Vertices normals = vertex_normals(state.positions);
    const double drag = std::exp(-0.5 * material.d_t * h), slides = std::pow(1 - material.k_friction, 1.0 / kSteps);
    for (Eigen::Index v = 0; v < w.size(); ++v) {
      const double loose = model().clothness()[v];
      Eigen::RowVector3d x = state.positions.row(v), u = state.velocities.row(v);
      u += h * (push.row(v) + in.gravity.value_or(model().options().gravity).transpose()) - in.wind.transpose();
      const double across = u.dot(normals.row(v));
      u = drag * u + across * (1 / (1 + 0.5 * material.d_n * h * std::abs(across)) - drag) * normals.row(v) + in.wind.transpose();
      x += h * u;
      if (loose < 1) {
        const auto after = in.targets.map(), before = in.previous_targets.empty() ? after : in.previous_targets.map();
        const double keeps = std::pow(loose, 1.0 / kSteps);
        x = keeps * x + (1 - keeps) * (before.row(v) + end * (after.row(v) - before.row(v)));
      }
      if (loose > 0)
        for (std::size_t c = 0; c < in.capsules.size(); ++c)
          push_out(x, state.positions.row(v), moved(in, c, end - 1.0 / kSteps), moved(in, c, end), slides);
      state.velocities.row(v) = (x - state.positions.row(v)) / h;
      state.positions.row(v) = x;
    }
  }

  /// Of unit length.
  Vertices vertex_normals(const Vertices &positions) const {
    Vertices normals = Vertices::Zero(positions.rows(), 3);
    const Faces &faces = model().faces();
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      const Eigen::RowVector3d a = positions.row(faces(f, 0)), b = positions.row(faces(f, 1)), c = positions.row(faces(f, 2));
      for (int k = 0; k < 3; ++k)
        normals.row(faces(f, k)) += (b - a).cross(c - a);
    }
    for (Eigen::Index v = 0; v < normals.rows(); ++v)
      normals.row(v) /= std::max(normals.row(v).norm(), 1e-12);
    return normals;
  }

  /// Proxy c when the fraction t of the frame is over.
  static Capsule moved(const StepInputs &in, std::size_t c, double t) {
    const Capsule &after = in.capsules[c], &before = in.previous_capsules.empty() ? after : in.previous_capsules[c];
    return {before.p0 + t * (after.p0 - before.p0), before.p1 + t * (after.p1 - before.p1), after.r0, after.r1};
  }

  /// x, which was at `old` while the proxy was `before`: out of the proxy, and sliding on it by `slides` of its way.
  void push_out(Eigen::RowVector3d &x, const Eigen::RowVector3d &old, const Capsule &before, const Capsule &capsule,
                double slides) const {
    const Eigen::RowVector3d axis = (capsule.p1 - capsule.p0).transpose(), from = x - capsule.p0.transpose();
    const double along = std::clamp(from.dot(axis) / std::max(axis.squaredNorm(), 1e-12), 0.0, 1.0);
    const Eigen::RowVector3d away = from - along * axis;
    const double radius = capsule.r0 + along * (capsule.r1 - capsule.r0) + model().options().thickness;
    if (away.norm() >= radius || away.norm() == 0)
      return;
    const Eigen::RowVector3d was = (before.p0 + along * (before.p1 - before.p0)).transpose(),
                             is = capsule.p0.transpose() + along * axis, normal = away.normalized();
    x += (radius / away.norm() - 1) * away;
    const Eigen::RowVector3d way = (x - old) - (is - was), slid = way - way.dot(normal) * normal;
    x -= (1 - slides) * slid;
  }

  std::vector<Spring> springs_;
};

} // namespace

int main() {
  const auto make = [](std::shared_ptr<const ClothModel> model) { return std::make_shared<MassSpring>(std::move(model)); };
  const auto broken = doublet::testing::cloth_solver_violations(make);
  for (const std::string &sentence : broken)
    std::printf("%s\n", sentence.c_str());
  return broken.empty() ? 0 : 1;
}
