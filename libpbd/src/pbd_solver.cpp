// Simulations into lanes, lanes through the frame, and back.

#include "capsule_motion.h"
#include "doublet/pbd/detail/lanes.h"
#include "lane_group.h"
#include "pbd_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace doublet::pbd {
namespace {

/// Stiffness of one of n projections that together do what one with stiffness k does: 1 - (1 - k)^(1/n), Mueller et al. 2007,
/// Sect. 3.3.
float share_of(double k, int n) {
  return static_cast<float>(1 - std::pow(1 - k, 1.0 / n));
}
/// The most of a fold that one projection closes. Neighbouring bends share vertices; were each closed at once, rigid edges would
/// pump the folds up instead of letting them settle, and a cloth that moves would end as a heap; closed by half, cloth without
/// drag still shakes. Of Sweeps only k_bend above 1 - 0.65^iterations can tell.
constexpr float kMostBend = 0.35f;
/// The same for a compliant bend, which one projection closes by 1 / (1 + compliance): its projections are under-relaxed, so that
/// sweeps that converge have the same answer. Of 4 substeps only k_bend above 0.896 can tell.
float bend_relaxation_of(float compliance) {
  return std::min(1.0f, kMostBend * (1 + compliance));
}
/// alpha / (h^2 sum of w |grad C|^2) of a constraint that one step of kComplianceStep brings the share k nearer.
float compliance_of(double k, double h) {
  return static_cast<float>((1 / std::max(k, 1e-6) - 1) * std::pow(kComplianceStep / h, 2));
}

/// One simulation of a group.
struct Lane {
  ClothState *state;
  const StepInputs *in;
  const Material *material;
  int bad_vertex; ///< the first that came out not finite, else -1
};
constexpr int kMostLanes = 16;

/// Value j of `value`, which holds floats alone, to row[j lanes + l].
template <class Value> void put(const Value &value, float *row, int lanes, int l) {
  float values[sizeof(Value) / sizeof(float)];
  std::memcpy(values, &value, sizeof value);
  for (size_t j = 0; j < std::size(values); ++j)
    row[j * lanes + l] = values[j];
}

/// While it lives, numbers too small for a float's exponent count as 0: cloth collapsed to a point is full of them, and x86 takes
/// a hundred times as long for each.
class FlushToZero {
#ifdef __SSE2__
public:
  FlushToZero() {
    _mm_setcsr(before_ | 0x8040); // results and operands
  }
  ~FlushToZero() {
    _mm_setcsr(before_);
  }
  FlushToZero(const FlushToZero &) = delete;

private:
  unsigned before_ = _mm_getcsr();
#endif
};

/// The lanes of a running frame, in coordinates local to an origin of their own so that float keeps micrometres far from the
/// world's. An origin is a whole number of metres: exact to subtract.
class RunningGroup {
public:
  RunningGroup(LaneGroup *group) : group_(group), origins_(group->lanes()) {}
  int lanes() const { return group_->lanes(); }

  /// A frame of each; lanes without a simulation do as the last. One that comes out not finite leaves its state as it was.
  void step(const PbdModel &model, std::span<Lane> lanes) {
    load(model, lanes);
    [[maybe_unused]] const FlushToZero flush;
    const int n = substeps_of(model.options(), *lanes[0].in);
    group_->find_knots();
    for (int i = 0; i < n; ++i) {
      set_capsules(lanes, static_cast<double>(i) / n, static_cast<double>(i + 1) / n);
      group_->advance(static_cast<float>(i + 1) / static_cast<float>(n));
    }
    find_bad_vertices(model.vertex_count(), lanes);
    store(model.vertex_count(), lanes);
  }

private:
  static const Lane &lane(std::span<const Lane> lanes, int l) { return lanes[std::min<size_t>(l, lanes.size() - 1)]; }

  /// Calls work(lane, first, last) for `vertices` vertices of `count` lanes, a few at a time: a lane is strewn over all of the
  /// arrays, and what the first one brought into the cache is to be there for the last.
  template <class Work> static void in_blocks(int vertices, int count, const Work &work) {
    constexpr int kBlock = 128;
    for (int first = 0; first < vertices; first += kBlock)
      for (int l = 0; l < count; ++l)
        work(l, first, std::min(first + kBlock, vertices));
  }

  void load(const PbdModel &model, std::span<const Lane> simulations) {
    const int n = model.vertex_count(), lanes = group_->lanes(), stride = group_->vertex_stride();
    for (int l = 0; l < lanes; ++l) {
      const Vertices &x = lane(simulations, l).state->positions;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int i = 0; i < n; ++i)
        sum += x.row(i).transpose();
      origins_[l] = (sum / n).array().round();
      put(substep_of(model.options(), lane(simulations, l)), group_->substep(), lanes, l);
    }
    in_blocks(n, lanes, [&](int l, int first, int last) {
      const ClothState &state = *lane(simulations, l).state;
      const double *x = state.positions.data(), *v = state.velocities.data();
      float *px = group_->positions() + l, *pv = group_->velocities() + l;
      const double origin[3] = {origins_[l][0], origins_[l][1], origins_[l][2]};
      for (int i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k) {
          px[i * stride + k * lanes] = static_cast<float>(x[i * 3 + k] - origin[k]);
          pv[(i * 3 + k) * lanes] = static_cast<float>(v[i * 3 + k]);
        }
    });
    const LaneModel &m = model.arrays();
    in_blocks(m.follower_count, lanes, [&](int l, int first, int last) {
      const StepInputs &in = *lane(simulations, l).in;
      const Eigen::Map<const Vertices> after = in.targets.map();
      const Eigen::Map<const Vertices> before = in.previous_targets.empty() ? after : in.previous_targets.map();
      float *start = group_->targets_start() + l, *end = group_->targets_end() + l;
      for (int i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k) {
          start[(i * 3 + k) * lanes] = static_cast<float>(before(m.followers[i], k) - origins_[l][k]);
          end[(i * 3 + k) * lanes] = static_cast<float>(after(m.followers[i], k) - origins_[l][k]);
        }
    });
  }

  static int substeps_of(const ClothOptions &options, const StepInputs &in) {
    return in.substeps > 0 ? in.substeps : options.substeps;
  }
  static Substep<float> substep_of(const ClothOptions &options, const Lane &lane) {
    const Material &material = *lane.material;
    const int substeps = substeps_of(options, *lane.in);
    const double h = lane.in->dt / substeps;
    const bool compliant = options.stiffness == Stiffness::Compliance;
    const auto stiffness = [&](double k) { return compliant ? compliance_of(k, h) : share_of(k, options.iterations); };
    Substep<float> s{};
    s.h = static_cast<float>(h);
    s.k_bend = compliant ? stiffness(material.k_bend) : std::min(stiffness(material.k_bend), kMostBend);
    s.bend_relaxation = compliant ? bend_relaxation_of(s.k_bend) : 1;
    s.k_stretch = stiffness(material.k_stretch);
    s.k_friction = share_of(material.k_friction, substeps);
    s.k_damping = share_of(material.k_damping, substeps);
    s.half_dn_h = static_cast<float>(0.5 * material.d_n * h);
    s.tangential_factor = static_cast<float>(std::exp(-0.5 * material.d_t * h));
    const Eigen::Vector3d gravity = lane.in->gravity.value_or(options.gravity);
    for (int k = 0; k < 3; ++k) {
      s.wind[k] = static_cast<float>(lane.in->wind[k]);
      s.gravity[k] = static_cast<float>(gravity[k]);
    }
    return s;
  }

  /// Proxies at both ends of the substep.
  void set_capsules(std::span<const Lane> lanes, double begin, double end) {
    const int count = static_cast<int>(lanes[0].in->capsules.size());
    motions_.resize(count);
    float *values = group_->capsules(count);
    for (int l = 0; l < group_->lanes(); ++l) {
      const bool as_before = l > 0 && lane(lanes, l).in == lane(lanes, l - 1).in && origins_[l] == origins_[l - 1];
      if (!as_before)
        set_motions(*lane(lanes, l).in, begin, end, origins_[l]);
      for (int i = 0; i < count; ++i)
        put(motions_[i], values + i * (sizeof(CapsuleMotion<float>) / sizeof(float)) * group_->lanes(), group_->lanes(), l);
    }
  }
  void set_motions(const StepInputs &in, double begin, double end, const Eigen::Vector3d &origin) {
    for (size_t i = 0; i < motions_.size(); ++i) {
      const Capsule &last = in.capsules[i], &first = in.previous_capsules.empty() ? last : in.previous_capsules[i];
      const auto at = [&](double t) {
        Capsule c = last; // keeps its radii
        c.p0 = first.p0 + t * (last.p0 - first.p0);
        c.p1 = first.p1 + t * (last.p1 - first.p1);
        return c;
      };
      motions_[i] = capsule_motion(at(begin), at(end), origin);
    }
  }

  void find_bad_vertices(int n, std::span<Lane> simulations) const {
    const int lanes = group_->lanes(), stride = group_->vertex_stride();
    const float *x = group_->positions(), *v = group_->velocities(), *zero = group_->zero_if_finite();
    for (size_t l = 0; l < simulations.size(); ++l) {
      int &bad = simulations[l].bad_vertex = -1;
      for (int i = 0; i < n && bad < 0 && zero[l] != 0; ++i)
        for (int k = 0; k < 3; ++k)
          if (!std::isfinite(x[i * stride + k * lanes + l]) || !std::isfinite(v[(i * 3 + k) * lanes + l]))
            bad = i;
    }
  }
  void store(int n, std::span<const Lane> simulations) const {
    const int lanes = group_->lanes(), stride = group_->vertex_stride();
    in_blocks(n, static_cast<int>(simulations.size()), [&](int l, int first, int last) {
      if (simulations[l].bad_vertex >= 0)
        return;
      double *x = simulations[l].state->positions.data(), *v = simulations[l].state->velocities.data();
      const float *px = group_->positions() + l, *pv = group_->velocities() + l;
      const double origin[3] = {origins_[l][0], origins_[l][1], origins_[l][2]};
      for (int i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k) {
          x[i * 3 + k] = px[i * stride + k * lanes] + origin[k];
          v[i * 3 + k] = pv[(i * 3 + k) * lanes];
        }
    });
  }

  std::unique_ptr<LaneGroup> group_;
  std::vector<Eigen::Vector3d> origins_;      ///< of each lane
  std::vector<CapsuleMotion<float>> motions_; ///< of the lane at hand
};

struct Width {
  int lanes;
  LaneGroup *(*make)(const LaneModel &);
};
/// What this program was built for and this processor can run, ascending.
std::vector<Width> supported_widths() {
  std::vector<Width> widths{{1, make_group_1}, {4, make_group_4}};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    widths = {{1, make_group_1_avx2}, {4, make_group_4_avx2}, {8, make_group_8}};
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) {
    widths.back().make = make_group_8_avx512; // twice the registers
    widths.push_back({16, make_group_16});
  }
#endif
  return widths;
}

class PbdSolver final : public ClothSolver {
public:
  PbdSolver(std::shared_ptr<const ClothModel> cloth, std::vector<Width> widths)
      : ClothSolver(cloth), model_(std::move(cloth)), widths_(std::move(widths)), idle_(widths_.size()) {}

private:
  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int threads) const override;
  void step_group(std::span<Lane> lanes) const;

  PbdModel model_;
  std::vector<Width> widths_;
  /// Groups are lent to running steps and reused: no allocation once warm, any number of threads.
  mutable std::mutex mutex_;
  mutable std::vector<std::vector<std::unique_ptr<RunningGroup>>> idle_; ///< [width]
};

void PbdSolver::step_group(std::span<Lane> lanes) const {
  size_t width = 0;
  while (width + 1 < widths_.size() && widths_[width].lanes < static_cast<int>(lanes.size()))
    ++width;
  std::unique_ptr<RunningGroup> group;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_[width].empty()) {
      group = std::move(idle_[width].back());
      idle_[width].pop_back();
    }
  }
  if (!group)
    group = std::make_unique<RunningGroup>(widths_[width].make(model_.arrays()));
  group->step(model_, lanes);
  const std::lock_guard lock(mutex_);
  idle_[width].push_back(std::move(group));
}

/// Calls work(i) for i in [0, count) on up to `threads` threads.
template <class Work> void share_out(int count, int threads, const Work &work) {
  std::exception_ptr error;
  std::mutex mutex;
  const auto run = [&](int first) {
    try {
      for (int i = first; i < count; i += threads)
        work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      error = std::current_exception();
    }
  };
  const int wanted = std::clamp(threads, 1, std::max(1, count));
  std::vector<std::thread> others;
  others.reserve(wanted - 1); // of one thread nothing is allocated
  int next = 1;
  try {
    for (; next < wanted; ++next)
      others.emplace_back(run, next);
  } catch (const std::exception &) {
    // The machine gives no more threads: this one does their share, with the same result.
  }
  run(0);
  for (; next < wanted; ++next)
    run(next);
  for (std::thread &t : others)
    t.join();
  if (error)
    std::rethrow_exception(error);
}

std::vector<int> PbdSolver::advance(std::span<ClothState> states, std::span<const StepInputs> inputs,
                                    std::span<const Material> materials, int threads) const {
  const auto input_of = [&](size_t i) -> const StepInputs & { return inputs[inputs.size() == 1 ? 0 : i]; };
  // Full registers first, but no idle thread for their sake.
  const int count = static_cast<int>(states.size()), widest = widths_.back().lanes;
  threads = std::clamp(threads, 1, std::max(1, count));
  const int groups = std::max((count + widest - 1) / widest, std::min(threads, (count + 3) / 4));
  std::vector<int> failed; // empty, as a rule
  std::mutex mutex;
  share_out(groups, threads, [&](int g) {
    const int first = count * g / groups, last = count * (g + 1) / groups;
    std::array<Lane, kMostLanes> lanes;
    for (int i = first; i < last; ++i)
      lanes[i - first] = {&states[i], &input_of(i), &materials[i], -1};
    step_group(std::span(lanes).first(last - first));
    for (int i = first; i < last; ++i)
      if (lanes[i - first].bad_vertex >= 0) {
        const std::lock_guard lock(mutex);
        failed.push_back(i);
      }
  });
  std::sort(failed.begin(), failed.end());
  return failed;
}

} // namespace

std::unique_ptr<ClothSolver> ClothSolver::create(std::shared_ptr<const ClothModel> model) {
  return std::make_unique<PbdSolver>(std::move(model), supported_widths());
}

std::vector<int> detail::supported_lanes() {
  std::vector<int> lanes;
  for (const Width &w : supported_widths())
    lanes.push_back(w.lanes);
  return lanes;
}

std::unique_ptr<ClothSolver> detail::create_with_lanes(std::shared_ptr<const ClothModel> model, int lanes) {
  std::vector<Width> widths = supported_widths();
  std::erase_if(widths, [&](const Width &w) { return w.lanes != lanes; });
  if (widths.empty())
    throw std::invalid_argument("create_with_lanes: lanes must be one of supported_lanes(), found " + std::to_string(lanes));
  return std::make_unique<PbdSolver>(std::move(model), std::move(widths));
}

} // namespace doublet::pbd
