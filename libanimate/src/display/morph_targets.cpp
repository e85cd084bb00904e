#include "morph_targets.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

constexpr int kByte = 127; ///< 1 in normalised bytes
constexpr int kBatch = 32; ///< frames that are in work at a time
/// Of which principal components are found, a minute's at 40 a second: what that takes grows with the cube of their number.
constexpr Eigen::Index kMostShapes = 2400;

using Eigen::Index;

/// (keys, 3 vertices) m
FloatRows shapes_at(const BoundMesh &mesh, const std::vector<int> &keys, const Context &context) {
  FloatRows shapes(keys.size(), 3 * mesh.influences.size());
  parallel_for(context, static_cast<int>(keys.size()), [&](int key) {
    const Floats3 shape = shape_at(mesh, keys[key]);
    shapes.row(key) = Eigen::Map<const Eigen::RowVectorXf>(shape.data(), shape.size());
  });
  return shapes;
}

/// (count, 3 vertices) of keys from `first` on
FloatRows normals_from(const BoundMesh &mesh, const std::vector<int> &keys, int first, int count, const Context &context) {
  FloatRows normals(count, 3 * mesh.influences.size());
  parallel_for(context, count, [&](int i) {
    const Floats3 at_key = normals_at(mesh, keys[first + i]);
    normals.row(i) = Eigen::Map<const Eigen::RowVectorXf>(at_key.data(), at_key.size());
  });
  return normals;
}

Floats3 as_vectors(const Eigen::RowVectorXf &row) {
  return Eigen::Map<const Floats3>(row.data(), row.size() / 3, 3);
}

Eigen::Map<const Eigen::RowVectorXf> as_row(const Floats3 &vectors) {
  return {vectors.data(), vectors.size()};
}

struct NormalStep {
  Eigen::RowVector3f step; ///< each within [-1, 1], as bytes are
  float cosine;            ///< of the angle that is left
};

/// What to add to one normal to have the direction of another; the sum may be shorter than 1.
NormalStep byte_step(const Eigen::RowVector3f &from, const Eigen::RowVector3f &to) {
  constexpr float kNearEnough = 0.996f; // 5 degrees
  NormalStep best{Eigen::RowVector3f::Zero(), -2};
  for (const float length : {1.0f, 0.7f, 0.4f, 0.2f, 0.1f}) {
    const Eigen::RowVector3f step = (length * to - from).cwiseMin(1).cwiseMax(-1);
    const float cosine = (from + step).normalized().dot(to);
    if (cosine > best.cosine)
      best = {step, cosine};
    if (cosine > kNearEnough)
      break;
  }
  return best;
}

/// The mesh's own normals: those of the first key, or where bytes do not reach from there to those of all others, their mean.
Floats3 reaching_normals(const FloatRows &normals) {
  constexpr float kReached = 0.94f; // 20 degrees
  Floats3 own = as_vectors(normals.row(0));
  for (Index v = 0; v < own.rows(); ++v) {
    Eigen::RowVector3f sum = Eigen::RowVector3f::Zero();
    bool reached = true;
    for (Index key = 0; key < normals.rows(); ++key) {
      const Eigen::RowVector3f normal = normals.row(key).segment<3>(3 * v);
      sum += normal;
      reached = reached && byte_step(own.row(v), normal).cosine > kReached;
    }
    if (!reached && sum.norm() > 0)
      own.row(v) = sum.normalized();
  }
  return own;
}

/// [3 vertices] what the bones leave of lengths there, over the keys (root of the mean square): blends of rotations shrink.
Eigen::RowVectorXf stretch(const BoundMesh &mesh, const std::vector<int> &keys) {
  Eigen::RowVectorXd squares = Eigen::RowVectorXd::Zero(3 * static_cast<Index>(mesh.influences.size()));
  for (int key : keys) {
    const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(mesh.influences, (*mesh.poses)[key]);
    for (std::size_t v = 0; v < blends.size(); ++v)
      squares.segment<3>(3 * static_cast<Index>(v)).array() += blends[v].linear().squaredNorm() / 3;
  }
  return (squares / static_cast<double>(keys.size())).cwiseSqrt().cast<float>();
}

/// (keys, keys) the products of all shapes with all, their columns scaled; the lower half.
Eigen::MatrixXd gram(const FloatRows &shapes, const Eigen::RowVectorXf &scale) {
  constexpr Index kColumns = 4096; // floats are summed as such over so many; then as doubles
  const Index keys = shapes.rows();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(keys, keys);
  for (Index first = 0; first < shapes.cols(); first += kColumns) {
    const Index count = std::min(kColumns, shapes.cols() - first);
    const Eigen::MatrixXf scaled = shapes.middleCols(first, count) * scale.segment(first, count).asDiagonal();
    Eigen::MatrixXf part = Eigen::MatrixXf::Zero(keys, keys);
    part.selfadjointView<Eigen::Lower>().rankUpdate(scaled);
    sum += part.cast<double>();
  }
  return sum;
}

struct Components {
  Eigen::VectorXd left;    ///< [number of components that are kept] m^2, what they leave, summed over keys and vertices
  Eigen::MatrixXf weights; ///< (keys, components) orthonormal, the largest component first
};

/// So many as leave `max_square` m^2.
Components principal_components(const FloatRows &centred, const Eigen::RowVectorXf &scale, double max_square, int max_count) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram(centred, scale));
  const Eigen::VectorXd squares = solver.eigenvalues().reverse().cwiseMax(0);
  const auto most = std::min<Index>(squares.size() - 1, max_count);
  Index count = 0;
  while (count < most && squares.tail(squares.size() - count).sum() > max_square)
    ++count;
  Components components;
  components.left.resize(count + 1);
  for (Index i = 0; i <= count; ++i)
    components.left[i] = squares.tail(squares.size() - i).sum();
  components.weights = solver.eigenvectors().rightCols(count).rowwise().reverse().cast<float>();
  return components;
}

/// The same of a clip so long that this would take hours: the components of some of its shapes, and how much of each there is in
/// all of them.
Components components_of_many(const FloatRows &centred, const Eigen::RowVectorXf &scale, double max_square, int max_count) {
  constexpr double kBetween = 0.5; // of the square: shapes between those that are looked at leave a little more
  const Index step = (centred.rows() + kMostShapes - 1) / kMostShapes, count = (centred.rows() + step - 1) / step;
  FloatRows some(count, centred.cols());
  for (Index i = 0; i < count; ++i)
    some.row(i) = centred.row(i * step);
  const double share = static_cast<double>(count) / static_cast<double>(centred.rows());
  const Eigen::MatrixXf few = principal_components(some, scale, kBetween * share * max_square, max_count).weights;
  Components components;
  components.left = Eigen::VectorXd::Zero(few.cols() + 1);
  for (Index key = 0; key < centred.rows(); ++key)
    components.left[0] += centred.row(key).cwiseProduct(scale).cast<double>().squaredNorm();
  components.weights.resize(centred.rows(), few.cols());
  if (few.cols() == 0)
    return components;
  FloatRows shapes = few.transpose() * some;
  shapes.array().rowwise() *= scale.array().square();
  const Eigen::MatrixXf shares = centred * shapes.transpose();
  const Eigen::HouseholderQR<Eigen::MatrixXf> orthonormal(shares);
  components.weights = orthonormal.householderQ() * Eigen::MatrixXf::Identity(shares.rows(), shares.cols());
  const FloatRows taken = components.weights.transpose() * centred;
  for (Index i = 0; i < taken.rows(); ++i) {
    const double square = taken.row(i).cwiseProduct(scale).cast<double>().squaredNorm();
    components.left[i + 1] = std::max(0.0, components.left[i] - square);
  }
  return components;
}

/// In whole steps, as 16 bits have them.
FloatRows rounded_steps(const FloatRows &steps, double step) {
  return (steps / static_cast<float>(step)).array().round().cwiseMin(kMostSteps).cwiseMax(-kMostSteps);
}

/// In 127ths; what is a degree or less is left out where there is no step, so that nothing needs to be stored there.
FloatRows rounded_turns(const FloatRows &turns, const FloatRows &rounded_steps) {
  constexpr float kLeft = 2;
  FloatRows rounded = (turns * kByte).array().round().cwiseMin(kByte).cwiseMax(-kByte);
  for (Index target = 0; target < turns.rows(); ++target)
    for (Index v = 0; v < turns.cols(); v += 3)
      if (rounded_steps.row(target).segment<3>(v).isZero(0) && rounded.row(target).segment<3>(v).cwiseAbs().maxCoeff() <= kLeft)
        rounded.row(target).segment<3>(v).setZero();
  return rounded;
}

/// Weights that go from 0 to 1, since Blender and Unity cut off others; `steps` and `turns` are what is added at 1, before they
/// are rounded.
struct PrincipalTargets {
  Floats3 mean, mean_normals;
  FloatRows steps, turns;
  Eigen::RowVectorXf mean_weights;
  Eigen::MatrixXf weights;
};

/// m^2, summed over keys and vertices: what is lost where a component's shape is rounded. The mean of it is made good elsewhere.
double rounding_square(const Eigen::RowVectorXf &shape, const Eigen::VectorXf &weights, const Eigen::RowVectorXf &scale,
                       double step) {
  const Eigen::ArrayXf counts = shape.transpose() / static_cast<float>(step);
  const double lost = ((counts - counts.round()) * scale.transpose().array()).square().cast<double>().sum() * step * step;
  return lost * (weights.array() - weights.mean()).square().sum();
}

/// The first components, so many that what they leave and what rounding adds is within `max_square` m^2; all if that is not so.
Index least_count(const Components &components, const PrincipalTargets &targets, const Eigen::RowVectorXf &scale, double step,
                  double max_square) {
  double rounding = 0;
  for (Index count = 0; count < components.weights.cols(); ++count) {
    if (components.left[count] + rounding <= max_square)
      return count;
    rounding += rounding_square(targets.steps.row(count), targets.weights.col(count), scale, step);
  }
  return components.weights.cols();
}

/// Sets weights and steps of the principal components that are needed; returns the orthonormal weights.
Eigen::MatrixXf set_principal_steps(PrincipalTargets &targets, const FloatRows &centred, const Eigen::RowVectorXf &scale,
                                    double max_error, double step, int max_targets) {
  constexpr double kBesideRounding = 0.75; // of the square; what rounding takes is known when there are shapes
  const double max_square = max_error * max_error * static_cast<double>(centred.size()) / 3;
  const auto found = centred.rows() > kMostShapes ? &components_of_many : &principal_components;
  const Components components = found(centred, scale, kBesideRounding * max_square, max_targets);
  const Eigen::RowVectorXf least = components.weights.colwise().minCoeff();
  const Eigen::RowVectorXf range = components.weights.colwise().maxCoeff() - least;
  targets.steps = range.asDiagonal() * (components.weights.transpose() * centred);
  targets.weights = (components.weights.rowwise() - least) * range.cwiseInverse().asDiagonal();
  const Index count = least_count(components, targets, scale, step, max_square);
  targets.steps.conservativeResize(count, Eigen::NoChange);
  targets.weights.conservativeResize(Eigen::NoChange, count);
  targets.mean_weights = targets.weights.colwise().mean();
  return components.weights.leftCols(count);
}

/// Sets the turns that are nearest to the normals (least squares: `weights` is orthonormal), and the mean.
void set_principal_turns(PrincipalTargets &targets, const BoundMesh &mesh, const std::vector<int> &keys,
                         const Eigen::MatrixXf &weights, const Context &context) {
  const int count = static_cast<int>(keys.size());
  targets.turns = FloatRows::Zero(weights.cols(), targets.steps.cols());
  Eigen::RowVectorXf mean = Eigen::RowVectorXf::Zero(targets.steps.cols());
  for (int first = 0; first < count; first += kBatch) {
    context.throw_if_cancelled();
    const FloatRows normals = normals_from(mesh, keys, first, std::min(kBatch, count - first), context);
    targets.turns += weights.middleRows(first, normals.rows()).transpose() * normals;
    mean += normals.colwise().sum() / static_cast<float>(count);
  }
  const Eigen::RowVectorXf range = weights.colwise().maxCoeff() - weights.colwise().minCoeff();
  targets.turns = range.asDiagonal() * targets.turns;
  targets.mean_normals = as_vectors(mean);
}

/// Where weights are 0, normals are `floor`, whose direction becomes the mesh's own. Normals may have any length when they are
/// added up: they are made so short that neither turns nor what the own lack is more than 1. Returns the latter.
Floats3 shorten_normals(PrincipalTargets &targets, const Floats3 &floor, Floats3 &own) {
  Floats3 lacking(floor.rows(), 3);
  own.resize(floor.rows(), 3);
  for (Index v = 0; v < floor.rows(); ++v) {
    auto turns = targets.turns.middleCols(3 * v, 3);
    const float length = floor.row(v).norm(), largest = turns.size() > 0 ? turns.cwiseAbs().maxCoeff() : 0.0f;
    const float factor = 1 / std::max({1.0f, largest, length / 2});
    turns *= factor;
    own.row(v) = length > 1e-3f ? Eigen::RowVector3f(floor.row(v) / length) : Eigen::RowVector3f::UnitY();
    lacking.row(v) = factor * floor.row(v) - own.row(v);
  }
  return lacking;
}

/// m; larger than `step` where 16 bits would not do, for a shape or for all together.
double reaching_step(const PrincipalTargets &targets, double step) {
  if (targets.steps.rows() == 0)
    return step;
  const float farthest =
      std::max(targets.steps.cwiseAbs().maxCoeff(), (targets.mean_weights * targets.steps).cwiseAbs().maxCoeff());
  return std::max<double>(step, farthest / (kMostSteps - 1));
}

/// Rounds the targets, and adds one that is always there: what own vertices and normals lack of those at weights of 0, with what
/// rounding has taken on the average.
MorphTargets with_constant(PrincipalTargets principal, double step) {
  const Index count = principal.steps.rows(), columns = principal.mean.size();
  MorphTargets targets;
  targets.own = principal.mean;
  targets.step = reaching_step(principal, step);
  const Eigen::RowVectorXf floor_normals = as_row(principal.mean_normals) - principal.mean_weights * principal.turns;
  const Floats3 lacking = shorten_normals(principal, as_vectors(floor_normals), targets.own_normals);
  targets.steps.resize(count + 1, columns);
  targets.turns.resize(count + 1, columns);
  targets.steps.topRows(count) = rounded_steps(principal.steps, targets.step);
  targets.turns.topRows(count) = rounded_turns(principal.turns, targets.steps.topRows(count));
  const FloatRows step_back = -principal.mean_weights * targets.steps.topRows(count);
  const FloatRows turn = as_row(lacking) + principal.mean_weights * (principal.turns - targets.turns.topRows(count) / kByte);
  targets.steps.row(count) = rounded_steps(step_back, 1);
  const Eigen::RowVectorXf rest = static_cast<float>(targets.step) * (step_back - targets.steps.row(count));
  targets.own += as_vectors(rest); // floats
  targets.turns.row(count) = rounded_turns(turn, targets.steps.row(count));
  targets.weights.resize(principal.weights.rows(), count + 1);
  targets.weights << principal.weights, Eigen::VectorXf::Ones(principal.weights.rows());
  if (count == 0 && targets.turns.isZero(0)) { // the bones carry all
    targets.steps.resize(0, columns);
    targets.turns.resize(0, columns);
    targets.weights.resize(principal.weights.rows(), 0);
  }
  return targets;
}

/// (frames from `first` on, 3 vertices) m
FloatRows blended(const MorphTargets &rounded, const std::vector<int> &keys, int first, int count) {
  Eigen::MatrixXf weights(count, rounded.weights.cols());
  for (int i = 0; i < count; ++i) {
    const auto after = std::upper_bound(keys.begin(), keys.end() - 1, first + i);
    const auto key = std::max<Index>(after - keys.begin() - 1, 0);
    const Index next = std::min<Index>(key + 1, rounded.weights.rows() - 1);
    const float share =
        next > key ? static_cast<float>(first + i - keys[key]) / static_cast<float>(keys[next] - keys[key]) : 0.0f;
    weights.row(i) = (1 - share) * rounded.weights.row(key) + share * rounded.weights.row(next);
  }
  Index begin = 0, end = weights.cols(); // of the targets that take part: where each has its key, few
  while (begin < end && weights.col(begin).isZero())
    ++begin;
  while (begin < end && weights.col(end - 1).isZero())
    --end;
  FloatRows shapes =
      static_cast<float>(rounded.step) * weights.middleCols(begin, end - begin) * rounded.steps.middleRows(begin, end - begin);
  shapes.rowwise() += as_row(rounded.own);
  return shapes;
}

} // namespace

MorphTargets key_shapes(const BoundMesh &mesh, const std::vector<int> &keys, const Context &context) {
  MorphTargets targets;
  targets.steps = shapes_at(mesh, keys, context);
  targets.own = as_vectors(targets.steps.row(0));
  targets.steps.rowwise() -= as_row(targets.own);
  targets.turns = normals_from(mesh, keys, 0, static_cast<int>(keys.size()), context);
  targets.own_normals = reaching_normals(targets.turns);
  for (Index key = 0; key < targets.turns.rows(); ++key)
    for (Index v = 0; v < targets.own.rows(); ++v) {
      const Eigen::RowVector3f to = targets.turns.row(key).segment<3>(3 * v);
      targets.turns.row(key).segment<3>(3 * v) = byte_step(targets.own_normals.row(v), to).step;
    }
  constexpr double kLeastStep = 1e-3 / kMostSteps; // m, so that shapes that do not differ have one
  targets.step = std::max<double>(targets.steps.cwiseAbs().maxCoeff() / kMostSteps, kLeastStep);
  targets.steps = rounded_steps(targets.steps, targets.step);
  targets.turns = rounded_turns(targets.turns, targets.steps);
  targets.weights = Eigen::MatrixXf::Identity(targets.steps.rows(), targets.steps.rows());
  return targets;
}

MorphTargets principal_shapes(const BoundMesh &mesh, const std::vector<int> &keys, double max_error, int max_targets,
                              const Context &context) {
  constexpr double kStep = 0.6;    // of the error: most shapes are within 8 bits, and few more are needed
  constexpr double kMargin = 0.99; // what is known of the bones' stretch is a mean
  PrincipalTargets targets;
  FloatRows shapes = shapes_at(mesh, keys, context);
  const Eigen::RowVectorXf mean = shapes.cast<double>().colwise().mean().cast<float>();
  shapes.rowwise() -= mean;
  targets.mean = as_vectors(mean);
  const Eigen::MatrixXf weights =
      set_principal_steps(targets, shapes, stretch(mesh, keys), kMargin * max_error, kStep * max_error, max_targets - 1);
  set_principal_turns(targets, mesh, keys, weights, context);
  return with_constant(std::move(targets), kStep * max_error);
}

std::vector<double> errors(const BoundMesh &mesh, const MorphTargets &targets, const std::vector<int> &keys,
                           const Context &context) {
  const int frames = static_cast<int>(mesh.poses->size());
  const auto vertices = static_cast<std::ptrdiff_t>(mesh.influences.size());
  std::vector<double> all(frames * vertices);
  for (int first = 0; first < frames; first += kBatch) {
    context.throw_if_cancelled();
    const FloatRows shapes = blended(targets, keys, first, std::min(kBatch, frames - first));
    parallel_for(context, static_cast<int>(shapes.rows()), [&](int i) {
      const std::vector<double> of_frame = errors_at(mesh, first + i, as_vectors(shapes.row(i)));
      std::copy(of_frame.begin(), of_frame.end(), all.begin() + (first + i) * vertices);
    });
  }
  return all;
}

} // namespace doublet
