#include "doublet/capture/particle_annealing.h"

#include "doublet/core/parts/normal_generator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet {
namespace {

constexpr double kFloor = 1e-4; // variance that moves keep, in squared deviations, so that the particles never fall into one

class Particles {
public:
  Particles(const Eigen::VectorXd &start, const Eigen::VectorXd &deviation, const Eigen::VectorXd &lower,
            const Eigen::VectorXd &upper, const ParticleAnnealingOptions &options)
      : deviation_(deviation), lower_(lower), upper_(upper), options_(options), random_(options.seed),
        samples_(options.particles, start.size()) {
    for (int i = 0; i < samples_.rows(); ++i)
      for (int d = 0; d < samples_.cols(); ++d)
        samples_(i, d) = start[d] + (i > 0 ? deviation[d] * random_.normal() : 0);
    clamp();
  }

  const Eigen::MatrixXd &samples() const { return samples_; }

  /// A particle stays with probability w / max w; otherwise it becomes a copy of one drawn in proportion to the weights.
  void select(const Eigen::VectorXd &energies, double beta) {
    const Eigen::VectorXd weights = (-beta * (energies.array() - energies.minCoeff())).exp(); // the largest is 1
    std::vector<double> cumulative(weights.size());
    double sum = 0;
    for (int i = 0; i < weights.size(); ++i)
      cumulative[i] = sum += weights[i];
    const Eigen::MatrixXd before = samples_;
    for (int i = 0; i < samples_.rows(); ++i) {
      if (random_.uniform() < weights[i])
        continue;
      const auto drawn = std::upper_bound(cumulative.begin(), cumulative.end(), random_.uniform() * sum) - cumulative.begin();
      samples_.row(i) = before.row(std::min<Eigen::Index>(drawn, before.rows() - 1));
    }
  }

  /// Moves every particle by a normal step with a share of the particles' own covariance.
  void move() {
    const Eigen::MatrixXd scaled = samples_ * deviation_.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd centred = scaled.rowwise() - scaled.colwise().mean();
    Eigen::MatrixXd covariance = options_.covariance_share / (samples_.rows() - 1) * centred.transpose() * centred;
    covariance.diagonal().array() += kFloor;
    const Eigen::MatrixXd root = covariance.llt().matrixL();
    Eigen::VectorXd z(samples_.cols());
    for (int i = 0; i < samples_.rows(); ++i) {
      for (int d = 0; d < z.size(); ++d)
        z[d] = random_.normal();
      samples_.row(i) += (deviation_.asDiagonal() * (root * z)).transpose();
    }
    clamp();
  }

private:
  void clamp() {
    for (int i = 0; i < samples_.rows(); ++i)
      samples_.row(i) = samples_.row(i).cwiseMax(lower_.transpose()).cwiseMin(upper_.transpose());
  }

  const Eigen::VectorXd &deviation_, &lower_, &upper_;
  const ParticleAnnealingOptions &options_;
  NormalGenerator random_;
  Eigen::MatrixXd samples_;
};

} // namespace

ParticleAnnealingResult anneal(const SampleEnergies &energies, const Eigen::VectorXd &start, const Eigen::VectorXd &deviation,
                               const Eigen::VectorXd &lower, const Eigen::VectorXd &upper,
                               const ParticleAnnealingOptions &options) {
  options.validate();
  for (const Eigen::VectorXd *other : {&deviation, &lower, &upper})
    if (other->size() != start.size())
      throw std::invalid_argument("anneal: start, deviation, lower and upper must have one size, got " +
                                  std::to_string(start.size()) + " and " + std::to_string(other->size()));
  if (start.size() == 0 || !(deviation.array() > 0).all())
    throw std::invalid_argument("anneal: expected at least one dimension and positive deviations");
  Particles particles(start, deviation, lower, upper, options);
  ParticleAnnealingResult result;
  result.energy = std::numeric_limits<double>::infinity();
  for (int t = 0; t < options.iterations; ++t) {
    const Eigen::VectorXd found = energies(particles.samples());
    if (found.size() != options.particles || !found.allFinite())
      throw std::invalid_argument("anneal: expected " + std::to_string(options.particles) + " finite energies, got " +
                                  std::to_string(found.size()));
    result.evaluations += options.particles;
    Eigen::Index lowest;
    if (found.minCoeff(&lowest) < result.energy) {
      result.energy = found[lowest];
      result.best = particles.samples().row(lowest);
    }
    particles.select(found, options.coldness * std::pow(t + 1, options.power));
    particles.move();
  }
  return result;
}

} // namespace doublet
