#include "doublet/capture/surface_refiner.h"

#include "doublet/core/error.h"
#include "preconditioner.h"
#include "shown_surface.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

using detail::Preconditioner;
using detail::ShownSurface;
using Sparse = Eigen::SparseMatrix<double>;

/// bending * |D^-1 L u|^2 + stretching * u^T L u / mean(D), L = the cotangent Laplacian of the rest pose, D its diagonal.
Sparse stiffness_matrix(const Mesh &mesh, double bending, double stretching) {
  const int n = static_cast<int>(mesh.vertices.rows());
  Sparse laplacian(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Triplet &t : cotangent_laplacian(mesh.vertices, mesh.faces))
    entries.emplace_back(t.row, t.col, t.value);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd diagonal = laplacian.diagonal();
  // Vertices without neighbours have no Laplacian.
  const Eigen::VectorXd inverse = (diagonal.array() > 1e-12).select(1 / diagonal.array().max(1e-12), 0.0);
  const Sparse normalized = inverse.asDiagonal() * laplacian;
  const Sparse squared = Sparse(normalized.transpose()) * normalized;
  Sparse stiffness = bending * squared + (stretching / std::max(diagonal.mean(), 1e-12)) * laplacian;
  stiffness.diagonal().array() += 1e-9; // every diagonal entry exists, so that anchors and pulls can be added to it
  return stiffness;
}

/// A linear constraint on the displacement of one surface point: direction . displacement = value, metres; `weight` includes
/// robustness.
struct Pull {
  SurfacePoint surface;
  Eigen::Vector3d direction;
  double value = 0, weight = 0;
};

/// The least-squares system for the displacement U (V, 3) of all vertices:
/// stiffness (V, V, the same for x, y, z) + anchors + pulls, solved by conjugate gradients preconditioned with the part without
/// coupling of x, y, z.
class DisplacementSystem {
public:
  void set_stiffness(const Sparse &stiffness) {
    stiffness_ = stiffness;
    diagonal_.resize(stiffness.rows());
    for (int i = 0; i < stiffness.rows(); ++i)
      diagonal_[i] = stiffness.coeff(i, i);
    preconditioner_.analyze(stiffness_);
  }

  /// `anchor` (V) weights of the pull to `target` (V, 3); the stiffness is at rest at the displacement `relaxed` (V, 3); `start`
  /// (V, 3) is refined.
  Vertices solve(const Eigen::VectorXd &anchor, const Vertices &target, const Vertices &relaxed, const std::vector<Pull> &pulls,
                 const Faces &faces, const Vertices &start) {
    Eigen::VectorXd uncoupled = anchor;
    Vertices right = anchor.asDiagonal() * target;
    right += stiffness_ * relaxed;
    for (const Pull &p : pulls)
      for (int c = 0; c < 3; ++c) {
        const int i = faces(p.surface.face, c);
        const double b = p.surface.barycentric[c];
        uncoupled[i] += p.weight * b / 3; // lumped over the corners and over x, y, z
        right.row(i) += p.weight * b * p.value * p.direction.transpose();
      }
    Sparse without_coupling = stiffness_;
    for (int i = 0; i < without_coupling.rows(); ++i)
      without_coupling.coeffRef(i, i) = diagonal_[i] + uncoupled[i] + 1e-9;
    if (!preconditioner_.factorize(without_coupling))
      throw Error("surface refinement: the linear system is singular; the mesh has vertices that nothing holds");
    const auto apply = [&](const Vertices &u) {
      Vertices out = stiffness_ * u;
      out += anchor.asDiagonal() * u;
      for (const Pull &p : pulls) {
        const double along = p.direction.dot(p.surface.position(u, faces));
        for (int c = 0; c < 3; ++c)
          out.row(faces(p.surface.face, c)) += p.weight * p.surface.barycentric[c] * along * p.direction.transpose();
      }
      return out;
    };
    return conjugate_gradients(apply, right, start);
  }

private:
  template <class Apply> Vertices conjugate_gradients(const Apply &apply, const Vertices &right, const Vertices &start) const {
    constexpr int kMost = 60;
    // Of the right-hand side. Single vertices are then still on their way where one camera alone pulls, but captures are as near
    // to the truth as with 1e-7 (docs/results-by-stage.md, "The surface's equations").
    constexpr double kTolerance = 1e-4;
    Vertices u = start, residual = right - apply(u), z = preconditioner_.solve(residual), p = z;
    double rz = residual.cwiseProduct(z).sum();
    const double stop = kTolerance * right.norm() + 1e-300;
    for (int k = 0; k < kMost && residual.norm() > stop; ++k) {
      const Vertices q = apply(p);
      const double step = rz / p.cwiseProduct(q).sum();
      u += step * p;
      residual -= step * q;
      z = preconditioner_.solve(residual);
      const double next = residual.cwiseProduct(z).sum();
      p = z + next / rz * p;
      rz = next;
    }
    return u;
  }

  Sparse stiffness_;
  Eigen::VectorXd diagonal_;
  Preconditioner preconditioner_;
};

class LaplacianRefiner : public SurfaceRefiner {
public:
  explicit LaplacianRefiner(const SurfaceOptions &options) : options_(options) {}

  SurfaceEstimate refine(const SurfaceProblem &problem, const Context &context) override {
    prepare(problem);
    const Vertices to_skinned = problem.skinned - problem.base;
    Vertices displacement = Vertices::Zero(problem.base.rows(), 3);
    SurfaceEstimate estimate;
    estimate.vertices = problem.base;
    for (int k = 0; k < options_.iterations; ++k) {
      const double progress = options_.iterations > 1 ? static_cast<double>(k) / (options_.iterations - 1) : 1.0;
      const double gate = options_.gate_start * std::pow(options_.gate_end / options_.gate_start, progress);
      const double scale = options_.scale_start * std::pow(options_.scale_end / options_.scale_start, progress);
      const std::vector<Pull> pulls = find_pulls(problem, estimate, displacement, gate, scale, context);
      // What has already left its skinned position is not held there: the anchor, too, is robust.
      const Eigen::ArrayXd away =
          (displacement - to_skinned).rowwise().squaredNorm().array() / (options_.anchor_falloff * options_.anchor_falloff);
      const Eigen::VectorXd rigid = problem.reliability.array() / (1 + away).square();
      const Eigen::VectorXd anchor = options_.anchor_cloth + (options_.anchor_rigid - options_.anchor_cloth) * rigid.array();
      displacement = system_.solve(anchor, rigid.asDiagonal() * to_skinned, options_.offset_prior_share * to_skinned, pulls,
                                   problem.actor->mesh.faces, displacement);
      estimate.vertices = problem.base + displacement;
      context.throw_if_cancelled();
    }
    measure(problem, estimate);
    return estimate;
  }

private:
  static bool same(const Mesh &a, const Mesh &b) {
    return a.vertices.rows() == b.vertices.rows() && a.faces.rows() == b.faces.rows() && a.vertices == b.vertices &&
           a.faces == b.faces;
  }

  void prepare(const SurfaceProblem &problem) {
    if (!problem.actor || !problem.rig || !problem.outlines || problem.outlines->size() != problem.rig->size())
      throw std::invalid_argument("SurfaceRefiner: the problem needs an actor, a rig and one outline per camera");
    const Mesh &mesh = problem.actor->mesh;
    if (problem.base.rows() != mesh.vertices.rows() || problem.skinned.rows() != mesh.vertices.rows() ||
        problem.reliability.size() != mesh.vertices.rows())
      throw std::invalid_argument("SurfaceRefiner: the problem needs a base, a skinned position and a reliability per vertex");
    detail::require_tracks(problem.tracks, problem.rig->size(), mesh.faces, "SurfaceRefiner");
    matches_.assign(problem.rig->size(), {});
    actor_ = problem.actor;
    if (same(actor_->mesh, factorised_)) // by content: another actor may be at the same address
      return;
    factorised_ = actor_->mesh;
    system_.set_stiffness(stiffness_matrix(factorised_, options_.bending, options_.stretching));
  }

  std::vector<Pull> find_pulls(const SurfaceProblem &problem, const SurfaceEstimate &estimate, const Vertices &displacement,
                               double gate, double scale, const Context &context) {
    RimMatchOptions options;
    options.count = options_.rims_per_view;
    options.gate = gate;
    const Faces &faces = actor_->mesh.faces;
    const int views = static_cast<int>(problem.rig->size());
    const ShownSurface shown(estimate.vertices, problem.timing);
    parallel_for(context, views, [&](int v) {
      const Outline &measured = (*problem.outlines)[v];
      const Camera &camera = (*problem.rig)[v];
      if (measured.empty())
        return;
      const Rims rims = find_rims(shown.in(v), faces, actor_->face_valid, camera, options_.raster_size);
      matches_[v] = match_rims(rims, measured, OutlineIndex(measured, camera.width, camera.height), v, camera, options);
    });
    std::vector<Pull> pulls;
    for (int v = 0; v < views; ++v)
      for (const RimConstraint &c : matches_[v].constraints)
        add_pull(shown.in(v), displacement, (*problem.rig)[v], c.surface, c.normal, c.target, scale, 1.0, pulls);
    for (const SurfaceTrack &track : problem.tracks)
      for (int axis = 0; axis < 2; ++axis)
        add_pull(shown.in(track.view), displacement, (*problem.rig)[track.view], track.surface, Eigen::Vector2d::Unit(axis),
                 track.pixel, scale, options_.sift_weight * track.weight, pulls);
    return pulls;
  }

  /// Linearises normal . (project(x) - target) = 0 at the current surface, in metres on the surface.
  void add_pull(const Vertices &vertices, const Vertices &displacement, const Camera &camera, const SurfacePoint &surface,
                const Eigen::Vector2d &normal, const Eigen::Vector2d &target, double scale, double weight,
                std::vector<Pull> &pulls) const {
    const Faces &faces = actor_->mesh.faces;
    const Eigen::Vector3d x = surface.position(vertices, faces);
    if (!actor_->face_valid[surface.face] || camera.depth(x) <= 0)
      return;
    const Eigen::Vector3d slope = camera.project_jacobian(x).transpose() * normal; // pixels a metre
    const double length = slope.norm();
    if (!(length > 0))
      return;
    Pull pull;
    pull.surface = surface;
    pull.direction = slope / length;
    const double residual = normal.dot(camera.project(x) - target) / length;
    pull.value = pull.direction.dot(surface.position(displacement, faces)) - residual;
    const double robust = scale * scale / (residual * residual + scale * scale);
    pull.weight = weight * robust * robust;
    pulls.push_back(pull);
  }

  void measure(const SurfaceProblem &problem, SurfaceEstimate &estimate) const {
    double rim = 0, sift = 0;
    int rims = 0;
    const ShownSurface shown(estimate.vertices, problem.timing);
    for (const RimMatches &matches : matches_)
      for (const RimConstraint &c : matches.constraints) {
        rim += std::abs(rim_residual(c, shown.in(c.view), actor_->mesh.faces, (*problem.rig)[c.view]));
        ++rims;
      }
    for (const SurfaceTrack &track : problem.tracks)
      sift += ((*problem.rig)[track.view].project(track.surface.position(shown.in(track.view), actor_->mesh.faces)) - track.pixel)
                  .norm();
    estimate.rim_px = rims > 0 ? rim / rims : 0;
    estimate.sift_px = problem.tracks.empty() ? 0 : sift / problem.tracks.size();
  }

  SurfaceOptions options_;
  const RiggedMesh *actor_ = nullptr;
  Mesh factorised_; ///< that system_ was made for
  DisplacementSystem system_;
  std::vector<RimMatches> matches_;
};

} // namespace

bool is_overstretched(const Vertices &vertices, const Mesh &rest, int face) {
  constexpr double kMost = 2;
  double now = 0, before = 0;
  for (int c = 0; c < 3; ++c) {
    const int a = rest.faces(face, c), b = rest.faces(face, (c + 1) % 3);
    now = std::max(now, (vertices.row(a) - vertices.row(b)).squaredNorm());
    before = std::max(before, (rest.vertices.row(a) - rest.vertices.row(b)).squaredNorm());
  }
  return now > kMost * kMost * before;
}

std::unique_ptr<SurfaceRefiner> SurfaceRefiner::create(const SurfaceOptions &options) {
  options.validate();
  return std::make_unique<LaplacianRefiner>(options);
}

} // namespace doublet
