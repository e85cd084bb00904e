#pragma once
// E_fit of Sect. 6.2 (eq. 6-8): how well the simulated character explains the images of the reference performance. Unlike the
// paper's it also penalises parts of the images that the character does not explain, so that showing nothing is not free.

#include "doublet/fit/minimise.h"
#include "doublet/options/options.h"
#include "doublet/simulate/character_simulator.h"

#include <map>
#include <string>
#include <vector>

namespace doublet {

struct EnergyOptions {
  double alpha = 1.0;
  /// Small, since folds are chaotic: a simulated fold that is elsewhere in the video causes feature errors in both places, a
  /// missing fold only in one. A large beta therefore favours cloth that is too stiff to fold.
  double beta = 1.0;
  /// Mean squared distance, at most rim_cap, from the part of the measured contour that is the outline of the captured cloth to
  /// the outline of the simulated cloth. E_sil penalises simulated rims that are not seen, this term seen rims that are not
  /// simulated.
  double gamma = 1.0;
  /// Mean squared distance, at most rim_cap, from the simulated cloth to the captured surface, in every fourth frame. It
  /// constrains the cloth between the outlines.
  double delta = 1.0;
  /// A feature that is not visible on the simulated cloth costs the distance from its image position to the projection of the
  /// point that carries it on the captured cloth; a frame without a rim costs rim_cap; a frame in which the captured cloth shows
  /// nothing is left out for every sample. false: what a sample does not show costs nothing.
  bool fixed_correspondences = true;
  int settle_frames = 20;
  double rim_cap = 0.064;
  double feature_cap = 0.032;
  /// Features whose point on the captured cloth projects to within feature_cap of where they are seen are confirmed, however fast
  /// they move. So simulated cloth that stands still where that in the video flies at 5 m/s costs more than cloth that flies
  /// at 3.
  bool speed_dependent_cap = true;
  int outline_size = 251;
  int field_size = 502;
  /// The motion of cloth is chaotic: over a long rollout the noise exceeds the effect of the material.
  int window = 0;
  int window_lead = 8;
  static constexpr auto describe() {
    using namespace options;
    using O = EnergyOptions;
    return Description{
        "EnergyOptions",
        option(&O::alpha, "alpha", at_least(0), "", "Weight of E_sil, simulated rims that are not seen", "1 is the paper's"),
        option(&O::beta, "beta", at_least(0), "", "Weight of E_sift, distance of features from where they are seen",
               "10 is the paper's; large values prefer cloth that is too stiff to fold over folds in other places"),
        option(&O::gamma, "gamma", at_least(0), "", "Weight of E_con, seen rims that are not simulated",
               "1 = as E_sil, 0 = the paper's"),
        option(&O::delta, "delta", at_least(0), "",
               "Weight of E_surf, the distance of the simulated cloth from the captured surface",
               "0 = images alone, the paper's"),
        option(&O::fixed_correspondences, "fixed_correspondences",
               "Every sample is compared with everything that the captured cloth shows",
               "Off = with those that the sample itself shows (the paper's): then showing nothing is free"),
        option(&O::settle_frames, "settle_frames", at_least(0), "",
               "Frames in which the cloth falls into place in the first pose before the first counts",
               "Half a second, for a hem to come to rest"),
        option(&O::rim_cap, "rim_cap", above(0), "", "Largest rim distance that counts, as a share of the larger image side",
               "64 px at 1004: one lost fold must not dominate"),
        option(&O::feature_cap, "feature_cap", above(0), "",
               "Largest feature distance that counts, as a share of the larger image side",
               "32 px at 1004, 3 m/s at 2.4 mm a pixel and 40 fps: a mismatch costs every material the same"),
        option(&O::speed_dependent_cap, "speed_dependent_cap",
               "The cap of a confirmed feature is its displacement plus half of feature_cap, if that is more",
               "Otherwise cloth that stands still where it flies in the video costs no more than cloth that is a little slow"),
        option(&O::outline_size, "outline_size", at_least(16), "px",
               "Larger side of the views in which outline and visibility are decided"),
        option(&O::field_size, "field_size", at_least(16), "",
               "Number of nodes that would span the larger side of a distance field"),
        option(
            &O::window, "window", at_least(0), "", "Frames of the windows that the motion is cut into; 0 = one rollout",
            "Each begins with the captured surface and its velocity: in a long rollout chaos exceeds the effect of the material"),
        option(&O::window_lead, "window_lead", at_least(0), "", "Frames that are simulated before a window counts",
               "The captured surface is not in equilibrium under any material"),
    };
  }
  /// The paper's: eq. 6 to 8 without additions.
  static EnergyOptions paper() {
    EnergyOptions options;
    options.beta = 10;
    options.gamma = options.delta = 0;
    options.fixed_correspondences = options.speed_dependent_cap = false;
    return options;
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Which parameters are searched, and how they map to [0, 1].
struct ParameterSpace {
  std::vector<std::string> names = {"d_n", "d_t", "k_bend", "k_stretch", "k_friction"};
  pbd::Material fixed{.k_damping = 0.05}; ///< without any damping cloth never comes to rest (docs/cloth.md)
  /// Drag is 32 u^2, since cloth has little of it, and k_stretch is 1 - (1 - u)^4, since below 0.9 cloth hangs like rubber.
  bool warp_parameters = true;
  static constexpr auto describe() {
    using namespace options;
    using O = ParameterSpace;
    return Description{
        "ParameterSpace",
        option(&O::names, "names", pbd::kMaterialNames, "Names of the material parameters that are searched"),
        option(&O::fixed, "fixed", "Values of the parameters that are not searched"),
        option(&O::warp_parameters, "warp_parameters",
               "Parameters are warped so that equal steps change the cloth about equally; off = the box itself",
               "drag = 32 u^2, k_stretch = 1 - (1 - u)^4; the paper searches the box"),
    };
  }
  /// The paper's: the box itself, without damping.
  static ParameterSpace paper() {
    ParameterSpace space;
    space.fixed = {};
    space.warp_parameters = false;
    return space;
  }

  void validate() const; ///< throws std::invalid_argument naming option, range and value
  int size() const { return static_cast<int>(names.size()); }
  pbd::Material material(const Eigen::VectorXd &unit) const; ///< (n) in [0, 1], clamped -> material
  Eigen::VectorXd unit(const pbd::Material &material) const; ///< (n) in [0, 1]
};

/// Index, in [0, widths), of the width for a sample's last parameter `unit`: 0 = the first, 1 = the last, in equal steps.
int width_index(double unit, int widths);

/// The terms at one frame for one region.
struct FrameTerms {
  double silhouette = 0, feature = 0, contour = 0, surface = 0; ///< E_sil, E_sift, E_con and E_surf, pixels^2
  int rims = 0, features = 0, points = 0; ///< n_sil, n_sift and the number of points of the measured contour
  int probes = 0;                         ///< number of vertices whose distance to the captured surface was measured
};

/// CPU time of an objective by task, s, summed over all threads.
struct EnergyTimes {
  double set_up = 0;   ///< poses, distance fields, depth of everything that is not cloth
  double simulate = 0; ///< the solver
  double project = 0;  ///< projection of the cloth into the cameras
  double rims = 0;     ///< E_sil
  double contour = 0;  ///< E_con
  double features = 0; ///< E_sift
  double surface = 0;  ///< E_surf
};

/// Threads: immutable after construction; any method may be called from several at once. One part per region. Of the sequence it
/// keeps the 2D data, the point of the captured cloth under each feature and, unless delta is 0, every fourth captured surface.
class MaterialObjective : public Objective {
public:
  /// dt: s, one video frame. Keeps copies of the simulators, which share models and solvers with the originals. Throws
  /// std::invalid_argument if the character has no cloth or dt is not positive, Error if performance and observations do not
  /// belong together (frames, cameras, dofs) or are empty.
  MaterialObjective(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                    const Observations &observations, double dt, const EnergyOptions &options = {},
                    const ParameterSpace &space = {}, const Context &context = {});
  /// The same for a garment in several widths: simulators of one mesh that differ only in the rest shape of their cloth. Each
  /// part then has one more parameter, the last: 0 = the first width, 1 = the last, in equal steps. Throws std::invalid_argument
  /// if there is no simulator, or if their regions differ.
  MaterialObjective(const std::vector<const CharacterSimulator *> &widths, const ReferencePerformance &performance,
                    const Observations &observations, double dt, const EnergyOptions &options = {},
                    const ParameterSpace &space = {}, const Context &context = {});
  ~MaterialObjective() override;

  int parameter_count() const override;
  int width_count() const;
  int part_count() const override;
  /// E_fit (S, R), pixels^2. Samples are simulated side by side on context.thread_count() threads; the result does not depend on
  /// their number. A sample has exploded if its cloth is farther from its skinned position than the actor is long, or not finite:
  /// in all frames from there to the end of the window, every term has its largest possible value.
  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override;
  /// E_fit (S, R) of materials[s][r], at the first width.
  MatrixRM energies(const std::vector<std::vector<pbd::Material>> &materials, const Context &context) const;
  /// [R][T] the terms of one rollout, at the first width.
  std::vector<std::vector<FrameTerms>> terms(const std::vector<pbd::Material> &materials) const;
  /// [R][T] the terms of given surfaces [T] (V, 3), m: the captured one, or a true one transferred to M. Throws
  /// std::invalid_argument for other sizes, or if they are not finite.
  std::vector<std::vector<FrameTerms>> surface_terms(const std::vector<Vertices> &surfaces) const;
  /// (R) E_fit of given surfaces, pixels^2.
  std::vector<double> surface_energy(const std::vector<Vertices> &surfaces) const;
  /// An upper bound of E_fit, pixels^2: the value of the worst region with every term at its maximum, about (alpha + gamma +
  /// delta) rim_cap^2 + beta feature_cap^2.
  double worst_energy() const;
  /// Memory of the image data that is kept, bytes.
  std::size_t image_bytes() const;
  EnergyTimes times() const;
  /// A hash of everything the energy depends on, for checkpoints.
  std::string fingerprint() const;
  const ParameterSpace &space() const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

} // namespace doublet
