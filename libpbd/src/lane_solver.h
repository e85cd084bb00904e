#pragma once
// The step of Stoll et al. 2010, Sect. 6, for as many simulations as T has lanes. One lane (T = float) is the reference; every
// lane of every width gives its bits.

#include "doublet/pbd/parts/longest_stretch.h"
#include "edge_points.h"
#include "pinches.h"
#include "self_collision.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kMaxSpeed =
    100; ///< m/s, safety clamp: four times what a person's hand can do, three times a falling skydiver's speed
constexpr float kDepenetrationSpeed = 1; ///< m/s at which a penetration that the start brought along is opened
constexpr float kViolated = 0.1f;        ///< of its length, by which the sweeps may leave a stretch too long, where edges collide
constexpr auto kLongest = static_cast<float>(kLongestStretch);
constexpr int kLimitSweeps = 20;    ///< at most for either, in a substep
constexpr float kPulledOff = 5e-4f; ///< m beyond the thickness at which a contact no longer rubs

template <class T> class LaneSolver final : public LaneGroup {
public:
  explicit LaneSolver(const LaneModel &model) : m_(model) {
    x_.resize(m_.vertex_count + kSpareVertices);
    p_.resize(m_.vertex_count + kSpareVertices);
    for (int k = 0; k < kSpareVertices; ++k)
      x_[m_.vertex_count + k] = p_[m_.vertex_count + k] =
          Vec3<T>{T(static_cast<float>(k & 1)), T(static_cast<float>(k >> 1)), T(0)};
    v_.resize(m_.vertex_count);
    pinches_.clear(m_);
    if (m_.restitution > 0)
      v_free_.resize(m_.vertex_count);
    target_start_.resize(m_.follower_count);
    target_end_.resize(m_.follower_count);
    target_.resize(m_.follower_count);
    if (m_.compliant) {
      stretch_multipliers_.resize(kBlock * m_.stretch_block_count);
      bend_multipliers_.resize(kBlock * m_.bend_block_count);
    }
  }

  int lanes() const override { return kLanes; }
  int vertex_stride() const override { return sizeof(Place<T>) / sizeof(float); }
  float *positions() override { return reinterpret_cast<float *>(x_.data()); }
  float *velocities() override { return reinterpret_cast<float *>(v_.data()); }
  float *targets_start() override { return reinterpret_cast<float *>(target_start_.data()); }
  float *targets_end() override { return reinterpret_cast<float *>(target_end_.data()); }
  float *capsules(int count) override {
    capsules_.resize(count);
    return reinterpret_cast<float *>(capsules_.data());
  }
  float *substep() override { return reinterpret_cast<float *>(&s_); }

  void find_knots() override {
    if (!m_.self_collision)
      return;
    self_collision_.look_anew();
    knots_.find(m_, x_);
    if (m_.edge_collision)
      knots_.untangle(m_, x_);
  }
  void advance(float end) override {
    set_targets(end);
    update_normals();
    apply_forces();
    damp();
    predict();
    const T opening = T(kDepenetrationSpeed) * s_.h;
    boxes_.set(m_, x_, p_);
    if (m_.edge_collision)
      pinches_.find(m_, capsules_, x_, boxes_);
    find_capsule_contacts(m_, capsules_, x_, p_, opening, pinches_.give(), boxes_, contacts_);
    if (m_.edge_collision) {
      edge_points_.find(m_, capsules_, x_, p_, pinches_.give());
      project_capsules(); // so that the cloth meets itself on the way to where the proxies push it
    }
    self_contacts_.clear();
    edge_contacts_.clear();
    if (m_.self_collision)
      self_collision_.find(m_, x_, p_, opening, knots_, self_contacts_, edge_contacts_);
    iterate();
    if (m_.edge_collision && m_.compliant)
      finish_stretches();
    push_out_strays(m_, capsules_, contacts_, p_, boxes_, watched_);
    if (m_.edge_collision)
      limit_stretch();
    update_velocities();
    rub_self();
    rub_edges();
    rub_capsules();
    limit_speed();
    x_.swap(p_);
  }

  const float *zero_if_finite() override {
    Vec3<T> zero{T(0), T(0), T(0)};
    for (int i = 0; i < m_.vertex_count; ++i)
      zero = mul_add(T(0), x(i), mul_add(T(0), v_[i], zero));
    zero_ = zero.x + zero.y + zero.z;
    return reinterpret_cast<const float *>(&zero_);
  }

private:
  static constexpr bool kSingle = sizeof(T) == sizeof(float);
  static constexpr int kLanes = sizeof(T) / sizeof(float);
  using Side = pbd::Side<T>;                  ///< of constraints that are projected side by side
  static constexpr int kSide = pbd::kSide<T>; ///< so many

  void set_targets(float end) {
    for (int i = 0; i < m_.follower_count; ++i)
      target_[i] = end == 1 ? target_end_[i] : target_start_[i] + T(end) * (target_end_[i] - target_start_[i]);
  }

  /// Unit normals, area-weighted; zero where the faces cancel (drag then takes all motion as tangential). They lie in p_, which
  /// has nothing else to hold before the prediction: the fewer arrays, the more of them stay in the cache.
  void update_normals() {
    for (int i = 0; i < m_.vertex_count; ++i)
      p_[i] = Vec3<T>{T(0), T(0), T(0)};
    for (int f = 0; f < m_.face_count; ++f) {
      const int *v = m_.faces[f].v;
      const Vec3<T> n = cross(x(v[1]) - x(v[0]), x(v[2]) - x(v[0]));
      for (int k = 0; k < 3; ++k)
        p_[v[k]] = p(v[k]) + n;
    }
  }

  /// Half of gravity, drag, the other half: symmetric, so that the terminal velocity is right to second order in h.
  void apply_forces() {
    const Vec3<T> half = (T(0.5f) * s_.h) * gravity(), wind{s_.wind[0], s_.wind[1], s_.wind[2]};
    for (int i = 0; i < m_.vertex_count; ++i)
      if (m_.weights[i] > 0) {
        const Vec3<T> n = (T(1) / lane_max(lane_sqrt(dot(p(i), p(i))), T(1e-12f))) * p(i);
        const Vec3<T> u = v_[i] + half - wind;
        v_[i] = apply_drag(u, n, s_.half_dn_h, s_.tangential_factor) + wind + half;
      }
  }

  /// Mueller et al. 2007, Sect. 3.5: velocities move by k_damping towards the rigid motion with the same momentum and angular
  /// momentum.
  void damp() {
    const auto damped = s_.k_damping > T(0);
    if (!any(damped) || m_.mass == 0)
      return;
    const T per_mass(1 / m_.mass);
    Vec3<T> centre{T(0), T(0), T(0)}, velocity = centre, momentum = centre;
    for (int i = 0; i < m_.vertex_count; ++i)
      if (m_.weights[i] > 0) {
        const T mass(1 / m_.weights[i]);
        centre = mul_add(mass, x(i), centre);
        velocity = mul_add(mass, v_[i], velocity);
      }
    centre = per_mass * centre;
    velocity = per_mass * velocity;
    T xx(0), xy(0), xz(0), yy(0), yz(0), zz(0); // second moments
    for (int i = 0; i < m_.vertex_count; ++i)
      if (m_.weights[i] > 0) {
        const T mass(1 / m_.weights[i]);
        const Vec3<T> r = x(i) - centre, moved = mass * r;
        momentum += cross(moved, v_[i]);
        xx = mul_add(moved.x, r.x, xx), xy = mul_add(moved.x, r.y, xy), xz = mul_add(moved.x, r.z, xz);
        yy = mul_add(moved.y, r.y, yy), yz = mul_add(moved.y, r.z, yz), zz = mul_add(moved.z, r.z, zz);
      }
    const T inertia[6] = {yy + zz, -xy, -xz, xx + zz, -yz, xx + yy};
    const Vec3<T> spin = spin_of(inertia, momentum);
    for (int i = 0; i < m_.vertex_count; ++i)
      if (m_.weights[i] > 0) {
        const Vec3<T> rigid = velocity + cross(spin, x(i) - centre);
        v_[i] = select(damped, mul_add(s_.k_damping, rigid - v_[i], v_[i]), v_[i]);
      }
  }
  static Vec3<T> spin_of(const T (&inertia)[6], const Vec3<T> &momentum) {
    Vec3<T> spin;
    for (int l = 0; l < kLanes; ++l) {
      const auto lane = [l](auto *values) { return reinterpret_cast<const float *>(values) + l; };
      float i[6], m[3], w[3];
      for (int k = 0; k < 6; ++k)
        i[k] = *lane(inertia + k);
      m[0] = *lane(&momentum.x), m[1] = *lane(&momentum.y), m[2] = *lane(&momentum.z);
      lane_spin(i, m, w);
      reinterpret_cast<float *>(&spin.x)[l] = w[0];
      reinterpret_cast<float *>(&spin.y)[l] = w[1];
      reinterpret_cast<float *>(&spin.z)[l] = w[2];
    }
    return spin;
  }

  void predict() {
    for (int i = 0; i < m_.vertex_count; ++i)
      p_[i] = mul_add(s_.h, v_[i], x(i));
    for (int i = 0; i < m_.follower_count; ++i)
      if (m_.weights[m_.followers[i]] == 0)
        p_[m_.followers[i]] = target_[i];
  }

  /// Where edges collide, the cloth against itself has the last word: what a proxy pushes through other cloth stays there, but
  /// what it does not push out is under that cloth and nobody sees it.
  void iterate() {
    for (T &multiplier : stretch_multipliers_)
      multiplier = T(0);
    for (T &multiplier : bend_multipliers_)
      multiplier = T(0);
    for (int iteration = 0; iteration < m_.iterations; ++iteration) {
      if (m_.compliant) {
        stretch<true>();
        bend<true>();
      } else {
        stretch<false>();
        bend<false>();
      }
      for (int i = 0; i < m_.blend_count; ++i) {
        const BlendConstraint &c = m_.blends[i];
        project_blend<T>(p_[c.vertex], target_[c.follower], T(c.stiffness));
      }
      project_own();
      project_capsules();
    }
    if (m_.edge_collision)
      project_own();
  }
  void project_own() {
    for (SelfContact<T> &c : self_contacts_)
      project_self<T>(p_[c.q], p_[c.a], p_[c.b], p_[c.c], c);
    for (EdgeContact<T> &c : edge_contacts_)
      project_edges<T>(p_[c.a], p_[c.b], p_[c.c], p_[c.d], c);
  }
  void project_capsules() { project_capsules(T(0) <= T(0)); }
  template <class M> void project_capsules(M where) {
    for (ContactOf<T> &c : contacts_) {
      Vec3<Side> at = points_at(c.vertex);
      project_capsule(at, c, capsules_[c.capsule].end, Side(m_.thickness), on_each_side(where));
      move_points(c.vertex, at);
    }
    edge_points_.project(capsules_, p_, where);
  }
  /// Lanes of what goes side by side; of a single simulation, which is not asked where it is not, all.
  template <class M> static auto on_each_side([[maybe_unused]] M where) {
    if constexpr (kSingle)
      return Side(0) <= Side(0);
    else
      return where;
  }

  template <bool compliant> void stretch() {
    const Side k(s_.k_stretch), relaxation(m_.over_relaxation);
    project_stretches([&](int at, Vec3<Side> &a, Vec3<Side> &b, Side share_a, Side share_b, Side length) {
      if constexpr (compliant) {
        Side multiplier = side_at(stretch_multipliers_, at);
        project_soft_stretch(a, b, share_a, share_b, length, k, relaxation, multiplier);
        put_side(multiplier, stretch_multipliers_, at);
      } else
        project_stretch(a, b, share_a, share_b, length, k);
      return true;
    });
  }
  /// Calls project(place of the multipliers, both ends, their shares, length at rest) for as many stretches at a time as go side
  /// by side; it says whether it moved them. Did it ever?
  template <class Project> bool project_stretches(const Project &project) {
    bool moved = false;
    for (int i = 0; i < m_.stretch_block_count; ++i) {
      const StretchBlock &block = m_.stretch_blocks[i];
      for (int first = 0; first < block.count; first += kSide) {
        Vec3<Side> a = points_at(block.v[0] + first), b = points_at(block.v[1] + first);
        const Side share_a = value_of(block.share[0] + first), share_b = value_of(block.share[1] + first);
        if (!project(kBlock * i + first, a, b, share_a, share_b, value_of(block.length + first)))
          continue;
        move_points(block.v[0] + first, a);
        move_points(block.v[1] + first, b);
        moved = true;
      }
    }
    return moved;
  }
  static Side side_at(const Array<T> &values, int at) {
    Side side;
    __builtin_memcpy(&side, &values[at], sizeof side);
    return side;
  }
  static void put_side(const Side &side, Array<T> &values, int at) { __builtin_memcpy(&values[at], &side, sizeof side); }
  Vec3<Side> points_at(const int *v) const { return pbd::points_at<T>(p_.data(), v); }
  void move_points(const int *v, const Vec3<Side> &to) { pbd::move_points<T>(p_.data(), v, to); }
  static Side value_of(const float *values) {
    if constexpr (kSingle)
      return Side::load(values);
    else
      return Side(*values);
  }

  /// Where the body drags cloth off faster than the sweeps can bring it along, stretches that are violated by more than a tenth
  /// are swept on (Provot 1995), for triangles that are drawn out slip over a thin proxy. What is left after so many sweeps
  /// stays. Other cloth keeps its bits.
  void finish_stretches() {
    for (int sweep = 0; sweep < kLimitSweeps; ++sweep) {
      const auto were = project_violated_stretches();
      if (!any(were))
        return;
      project_capsules(were);
    }
  }
  /// In which lanes there were any.
  auto project_violated_stretches() {
    auto were = T(0) < T(0);
    project_stretches([&](int at, Vec3<Side> &a, Vec3<Side> &b, Side share_a, Side share_b, Side length) {
      Side multiplier = side_at(stretch_multipliers_, at);
      const auto over = project_violated_stretch(a, b, share_a, share_b, length, Side(s_.k_stretch), Side(kViolated), multiplier);
      if (!any(over))
        return false;
      put_side(multiplier, stretch_multipliers_, at);
      if constexpr (kSingle)
        were = true;
      else
        were = were | over;
      return true;
    });
    return were;
  }

  /// Cloth that is still far too long goes through the body instead.
  void limit_stretch() {
    const auto shorten = [](int, Vec3<Side> &a, Vec3<Side> &b, Side share_a, Side share_b, Side length) {
      Side no_force(0);
      return any(project_violated_stretch(a, b, share_a, share_b, length, Side(0), Side(kLongest - 1), no_force));
    };
    for (int sweep = 0; sweep < kLimitSweeps && project_stretches(shorten);)
      ++sweep;
  }

  /// For many lanes two bends of a block go through each stage in turn, so that the processor has one to work at while the other
  /// waits for its results; for four there is no room in the registers.
  template <bool compliant> void bend() {
    for (int i = 0; i < m_.bend_block_count; ++i) {
      const BendBlock &block = m_.bend_blocks[i];
      if constexpr (kSingle)
        for (int first = 0; first < block.count; first += kSide) {
          Vec3<Side> x[4];
          for (int k = 0; k < 4; ++k)
            x[k] = points_at(block.v[k] + first);
          const BendRest<Side> rest = rest_of(block, first);
          const BendTerms<Side> terms = bend_terms(x[0], x[1], x[2], x[3], rest);
          move_bend(terms, rest, bend_multiplier_of<compliant>(terms, rest, i, first), x[0], x[1], x[2], x[3]);
          for (int k = 0; k < 4; ++k)
            move_points(block.v[k] + first, x[k]);
        }
      else
        for (int first = 0; first < block.count; first += 2) {
          const auto corner = [&](int k, int j) -> Vec3<T> & { return p_[block.v[k][first + j]]; };
          const auto rest = [&](int j) { return rest_of(block, first + j); };
          BendTerms<T> terms[2];
          T multipliers[2];
          for (int j = 0; j < 2; ++j)
            terms[j] = bend_terms(corner(0, j), corner(1, j), corner(2, j), corner(3, j), rest(j));
          for (int j = 0; j < 2; ++j)
            multipliers[j] = bend_multiplier_of<compliant>(terms[j], rest(j), i, first + j);
          for (int j = 0; j < 2; ++j)
            move_bend(terms[j], rest(j), multipliers[j], corner(0, j), corner(1, j), corner(2, j), corner(3, j));
        }
    }
  }
  static BendRest<Side> rest_of(const BendBlock &b, int j) {
    const auto value = [j](const float(&values)[kBlock]) { return value_of(values + j); };
    return {value(b.w[0]), value(b.w[1]), value(b.w[2]),  value(b.w[3]),
            value(b.cos),  value(b.sin),  value(b.floor), value(b.response)};
  }
  template <bool compliant> Side bend_multiplier_of(const BendTerms<Side> &terms, const BendRest<Side> &rest, int block, int j) {
    if constexpr (compliant) {
      Side multiplier = side_at(bend_multipliers_, kBlock * block + j);
      const Side move = soft_bend_multiplier(terms, rest.response, Side(s_.k_bend), Side(s_.bend_relaxation), multiplier);
      put_side(multiplier, bend_multipliers_, kBlock * block + j);
      return move;
    } else
      return bend_multiplier(terms, Side(s_.k_bend));
  }

  void update_velocities() {
    if (m_.restitution > 0)
      v_free_.swap(v_);
    const T rate = T(1) / s_.h;
    for (int i = 0; i < m_.vertex_count; ++i)
      v_[i] = rate * (p(i) - x(i));
  }

  void limit_speed() {
    for (Vec3<T> &v : v_) {
      const T square = dot(v, v);
      const auto fast = square > T(kMaxSpeed * kMaxSpeed);
      if (any(fast))
        v = select(fast, (T(kMaxSpeed) / lane_sqrt(square)) * v, v);
    }
  }

  /// Normal velocity after a contact: none into it; what came in faster than gravity's own doing in two steps is reflected.
  /// before_contact(): the same before the contact.
  template <class FreeApproach> T bounce(T approach, FreeApproach &&before_contact) const {
    if (!(m_.restitution > 0))
      return lane_max(approach, T(0));
    const T free_approach = before_contact(), threshold = T(2) * s_.h * lane_sqrt(dot(gravity(), gravity()));
    const T reflected = select(free_approach < -threshold, -T(m_.restitution) * free_approach, T(0));
    return lane_max(approach, reflected);
  }

  /// Friction and restitution against the proxies, relative to the moving surface.
  void rub_capsules() {
    for (const ContactOf<T> &c : contacts_)
      for (int l = 0; l < kSide; ++l)
        if (const T touched = lane_of<T>(c.touched, l); any(touched > T(0)))
          rub(c.vertex[l], capsules_[c.capsule], touched > T(0));
  }
  template <class M> void rub(int vertex, const CapsuleMotion<T> &m, M touched) {
    const Distance<T> d = capsule_distance<T, T>(m.end, p_[vertex]);
    const auto rubs = touched & (d.value <= T(m_.thickness + kPulledOff));
    const Vec3<T> surface = p(vertex) - d.value * d.normal;
    const Vec3<T> surface_velocity = (T(1) / s_.h) * (surface - m.carry_back(surface));
    const Vec3<T> u = v_[vertex] - surface_velocity;
    const T un = dot(u, d.normal), keep = T(1) - s_.k_friction;
    const T after_n = bounce(un, [&] { return dot(v_free_[vertex] - surface_velocity, d.normal); });
    const Vec3<T> after = surface_velocity + keep * u + (after_n - keep * un) * d.normal;
    v_[vertex] = select(rubs, after, v_[vertex]);
  }

  /// The same between cloth and cloth, as impulses that keep the momentum.
  void rub_self() {
    for (const SelfContact<T> &c : self_contacts_) {
      if (!any(c.touched > T(0)))
        continue;
      const Distance<T> d = self_distance<T>(p_[c.q], p_[c.a], p_[c.b], p_[c.c], c.b0, c.b1, c.b2, c.side);
      const auto rubs = (c.touched > T(0)) & (d.value <= c.thickness + T(kPulledOff));
      const auto relative = [&](const Array<Vec3<T>> &v) { return v[c.q] - (c.b0 * v[c.a] + c.b1 * v[c.b] + c.b2 * v[c.c]); };
      const Vec3<T> u = relative(v_);
      const T un = dot(u, d.normal);
      const T after = bounce(un, [&] { return dot(relative(v_free_), d.normal); });
      const Vec3<T> change = (-s_.k_friction) * u + (after - (T(1) - s_.k_friction) * un) * d.normal;
      const Vec3<T> impulse = c.inverse_sum * change;
      v_[c.q] = select(rubs, v_[c.q] + T(c.wq) * impulse, v_[c.q]);
      v_[c.a] = select(rubs, v_[c.a] - (T(c.wa) * c.b0) * impulse, v_[c.a]);
      v_[c.b] = select(rubs, v_[c.b] - (T(c.wb) * c.b1) * impulse, v_[c.b]);
      v_[c.c] = select(rubs, v_[c.c] - (T(c.wc) * c.b2) * impulse, v_[c.c]);
    }
  }

  void rub_edges() {
    for (const EdgeContact<T> &c : edge_contacts_) {
      if (!any(c.touched > T(0)))
        continue;
      const Distance<T> d = edge_distance<T>(p_[c.a], p_[c.b], p_[c.c], p_[c.d], c.s, c.t, c.side);
      const auto rubs = (c.touched > T(0)) & (d.value <= c.thickness + T(kPulledOff));
      const T r = T(1) - c.s, w = T(1) - c.t;
      const auto relative = [&](const Array<Vec3<T>> &v) { return (w * v[c.c] + c.t * v[c.d]) - (r * v[c.a] + c.s * v[c.b]); };
      const Vec3<T> u = relative(v_);
      const T un = dot(u, d.normal);
      const T after = bounce(un, [&] { return dot(relative(v_free_), d.normal); });
      const Vec3<T> change = (-s_.k_friction) * u + (after - (T(1) - s_.k_friction) * un) * d.normal;
      const Vec3<T> impulse = c.inverse_sum * change;
      v_[c.a] = select(rubs, v_[c.a] - (T(c.wa) * r) * impulse, v_[c.a]);
      v_[c.b] = select(rubs, v_[c.b] - (T(c.wb) * c.s) * impulse, v_[c.b]);
      v_[c.c] = select(rubs, v_[c.c] + (T(c.wc) * w) * impulse, v_[c.c]);
      v_[c.d] = select(rubs, v_[c.d] + (T(c.wd) * c.t) * impulse, v_[c.d]);
    }
  }

  const Vec3<T> &x(int i) const { return x_[i]; }
  const Vec3<T> &p(int i) const { return p_[i]; }
  Vec3<T> gravity() const { return {s_.gravity[0], s_.gravity[1], s_.gravity[2]}; }

  const LaneModel &m_;
  Substep<T> s_;
  Array<Place<T>> x_, p_;                             ///< start, end of the substep; with the spare vertices
  Array<Vec3<T>> v_, v_free_;                         ///< velocity; the same before contacts, where they reflect it
  Array<Vec3<T>> target_start_, target_end_, target_; ///< of the followers: in the frame; at the end of the substep
  Array<CapsuleMotion<T>> capsules_;
  Array<ContactOf<T>> contacts_; ///< ordered by capsule
  Array<SelfContact<T>> self_contacts_;
  Array<EdgeContact<T>> edge_contacts_;
  Knots<T> knots_;
  Pinches<T> pinches_;
  EdgePoints<T> edge_points_; ///< where edges collide, else none
  VertexBoxes<T> boxes_;      ///< for a while
  Array<T> watched_;          ///< see push_out_strays
  SelfCollision<T> self_collision_;
  Array<T> stretch_multipliers_, bend_multipliers_;
  T zero_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
