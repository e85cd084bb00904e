#pragma once
// The step of Stoll et al. 2010, Sect. 6, for as many simulations as T has lanes. One lane (T = float) is the reference; every
// lane of every width gives its bits.

#include "capsule_contacts.h"
#include "self_collision.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kMaxSpeed =
    100; ///< m/s, safety clamp: four times what a person's hand can do, three times a falling skydiver's speed
constexpr float kDepenetrationSpeed = 1; ///< m/s at which a penetration that the start brought along is opened
constexpr float kPulledOff = 5e-4f;      ///< m beyond the thickness at which a contact no longer rubs

template <class T> class LaneSolver final : public LaneGroup {
public:
  explicit LaneSolver(const LaneModel &model) : m_(model) {
    x_.resize(m_.vertex_count + kSpareVertices);
    p_.resize(m_.vertex_count + kSpareVertices);
    for (int k = 0; k < kSpareVertices; ++k)
      x_[m_.vertex_count + k] = p_[m_.vertex_count + k] =
          Vec3<T>{T(static_cast<float>(k & 1)), T(static_cast<float>(k >> 1)), T(0)};
    v_.resize(m_.vertex_count);
    v_free_.resize(m_.vertex_count);
    normals_.resize(m_.vertex_count);
    target_start_.resize(m_.follower_count);
    target_end_.resize(m_.follower_count);
    target_.resize(m_.follower_count);
    if (m_.compliant) {
      stretch_multipliers_.resize(m_.stretch_count);
      bend_multipliers_.resize(kSingle ? 4 * m_.block_count : m_.bend_count);
    }
  }

  int lanes() const override { return kLanes; }
  int vertex_stride() const override { return sizeof(Place) / sizeof(float); }
  float *positions() override { return reinterpret_cast<float *>(x_.data()); }
  float *velocities() override { return reinterpret_cast<float *>(v_.data()); }
  float *targets_start() override { return reinterpret_cast<float *>(target_start_.data()); }
  float *targets_end() override { return reinterpret_cast<float *>(target_end_.data()); }
  float *capsules(int count) override {
    capsules_.resize(count);
    return reinterpret_cast<float *>(capsules_.data());
  }
  float *substep() override { return reinterpret_cast<float *>(&s_); }

  void advance(float end) override {
    set_targets(end);
    update_normals();
    apply_forces();
    damp();
    predict();
    const T opening = T(kDepenetrationSpeed) * s_.h;
    find_capsule_contacts(m_, capsules_, x_, p_, opening, contacts_);
    self_contacts_.clear();
    if (m_.self_collision)
      self_collision_.find(m_, x_, p_, opening, self_contacts_);
    iterate();
    push_out_strays(m_, capsules_, contacts_, p_);
    update_velocities();
    rub_self();
    rub_capsules();
    limit_speed();
    for (int i = 0; i < m_.vertex_count; ++i)
      x_[i] = p_[i];
  }

private:
  static constexpr bool kSingle = sizeof(T) == sizeof(float);
  static constexpr int kLanes = sizeof(T) / sizeof(float);
  template <class A, class B, bool first> struct Choice { using Type = A; };
  template <class A, class B> struct Choice<A, B, false> { using Type = B; };
  using Place = typename Choice<Point, Vec3<T>, kSingle>::Type;

  void set_targets(float end) {
    for (int i = 0; i < m_.follower_count; ++i)
      target_[i] = end == 1 ? target_end_[i] : target_start_[i] + T(end) * (target_end_[i] - target_start_[i]);
  }

  /// Unit normals, area-weighted; zero where the faces cancel (drag then takes all motion as tangential).
  void update_normals() {
    for (Vec3<T> &n : normals_)
      n = {T(0), T(0), T(0)};
    for (int f = 0; f < m_.face_count; ++f) {
      const int *v = m_.faces[f].v;
      const Vec3<T> n = cross(x(v[1]) - x(v[0]), x(v[2]) - x(v[0]));
      normals_[v[0]] += n;
      normals_[v[1]] += n;
      normals_[v[2]] += n;
    }
    for (Vec3<T> &n : normals_)
      n = (T(1) / lane_max(lane_sqrt(dot(n, n)), T(1e-12f))) * n;
  }

  /// Half of gravity, drag, the other half: symmetric, so that the terminal velocity is right to second order in h.
  void apply_forces() {
    const Vec3<T> half = (T(0.5f) * s_.h) * gravity(), wind{s_.wind[0], s_.wind[1], s_.wind[2]};
    for (int i = 0; i < m_.vertex_count; ++i)
      if (m_.weights[i] > 0) {
        const Vec3<T> u = v_[i] + half - wind;
        v_[i] = apply_drag(u, normals_[i], s_.half_dn_h, s_.tangential_factor) + wind + half;
      }
  }

  void damp() {
    const float *k = reinterpret_cast<const float *>(&s_.k_damping);
    for (int l = 0; l < kLanes; ++l)
      if (k[l] > 0)
        damp_lane(m_, positions() + l, velocities() + l, vertex_stride(), kLanes, k[l]);
  }

  void predict() {
    for (int i = 0; i < m_.vertex_count; ++i) {
      p_[i] = x(i) + s_.h * v_[i];
      v_free_[i] = v_[i];
    }
    for (int i = 0; i < m_.follower_count; ++i)
      if (m_.weights[m_.followers[i]] == 0)
        p_[m_.followers[i]] = target_[i];
  }

  void iterate() {
    for (T &multiplier : stretch_multipliers_)
      multiplier = T(0);
    for (T &multiplier : bend_multipliers_)
      multiplier = T(0);
    const T thickness(m_.thickness);
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
      for (SelfContact<T> &c : self_contacts_)
        project_self<T>(p_[c.q], p_[c.a], p_[c.b], p_[c.c], c);
      for (CapsuleContact<T> &c : contacts_)
        project_capsule<T>(p_[c.vertex], c, capsules_[c.capsule].end, thickness);
    }
  }

  template <bool compliant> void stretch() {
    const T k = s_.k_stretch;
    for (int i = 0; i < m_.stretch_count; ++i) {
      const StretchConstraint &c = m_.stretches[i];
      if constexpr (compliant)
        project_soft_stretch<T>(p_[c.a], p_[c.b], T(c.share_a), T(c.share_b), T(c.length), k, stretch_multipliers_[i]);
      else
        project_stretch<T>(p_[c.a], p_[c.b], T(c.share_a), T(c.share_b), T(c.length), k);
    }
  }

  template <bool compliant> void bend() {
    const T k = s_.k_bend;
    if constexpr (kSingle) {
      using Four = Pack<4>;
      for (int i = 0; i < m_.block_count; ++i) {
        const BendBlock &b = m_.blocks[i];
        const BendRest<Four> rest{Four::load(b.w[0]), Four::load(b.w[1]), Four::load(b.w[2]),  Four::load(b.w[3]),
                                  Four::load(b.cos),  Four::load(b.sin),  Four::load(b.floor), Four::load(b.response)};
        Vec3<Four> x0 = gather(p_.data(), b.v[0]), x1 = gather(p_.data(), b.v[1]), x2 = gather(p_.data(), b.v[2]),
                   x3 = gather(p_.data(), b.v[3]);
        if constexpr (compliant) {
          Four multipliers = Four::load(&bend_multipliers_[4 * i]);
          project_soft_bend(x0, x1, x2, x3, rest, Four(k), multipliers);
          __builtin_memcpy(&bend_multipliers_[4 * i], &multipliers.lanes, sizeof multipliers.lanes);
        } else
          project_bend(x0, x1, x2, x3, rest, Four(k));
        scatter(p_.data(), b.v[0], x0);
        scatter(p_.data(), b.v[1], x1);
        scatter(p_.data(), b.v[2], x2);
        scatter(p_.data(), b.v[3], x3);
      }
    } else
      for (int i = 0; i < m_.bend_count; ++i) {
        const BendConstraint &c = m_.bends[i];
        const BendRest<T> rest{T(c.w[0]), T(c.w[1]), T(c.w[2]), T(c.w[3]), T(c.cos), T(c.sin), T(c.floor), T(c.response)};
        Vec3<T> &x0 = p_[c.v[0]], &x1 = p_[c.v[1]], &x2 = p_[c.v[2]], &x3 = p_[c.v[3]];
        if constexpr (compliant)
          project_soft_bend(x0, x1, x2, x3, rest, k, bend_multipliers_[i]);
        else
          project_bend(x0, x1, x2, x3, rest, k);
      }
  }

  void update_velocities() {
    const T rate = T(1) / s_.h;
    for (int i = 0; i < m_.vertex_count; ++i)
      v_[i] = rate * (p(i) - x(i));
  }

  void limit_speed() {
    for (Vec3<T> &v : v_)
      v = lane_min(T(1), T(kMaxSpeed) / lane_max(lane_sqrt(dot(v, v)), T(1e-12f))) * v;
  }

  /// Normal velocity after a contact: none into it; what came in faster than gravity's own doing in two steps is reflected.
  T bounce(T approach, T free_approach) const {
    const T threshold = T(2) * s_.h * lane_sqrt(dot(gravity(), gravity()));
    const T reflected = select(free_approach < -threshold, -T(m_.restitution) * free_approach, T(0));
    return lane_max(approach, reflected);
  }

  /// Friction and restitution against the proxies, relative to the moving surface.
  void rub_capsules() {
    for (const CapsuleContact<T> &c : contacts_) {
      if (!any(c.touched > T(0)))
        continue;
      const CapsuleMotion<T> &m = capsules_[c.capsule];
      const Distance<T> d = capsule_distance<T, T>(m.end, p_[c.vertex]);
      const auto rubs = (c.touched > T(0)) & (d.value <= T(m_.thickness + kPulledOff));
      const Vec3<T> surface = p(c.vertex) - d.value * d.normal;
      const Vec3<T> surface_velocity = (T(1) / s_.h) * (surface - m.carry_back(surface));
      const Vec3<T> u = v_[c.vertex] - surface_velocity, u_free = v_free_[c.vertex] - surface_velocity;
      const T un = dot(u, d.normal), keep = T(1) - s_.k_friction;
      const Vec3<T> after = surface_velocity + keep * u + (bounce(un, dot(u_free, d.normal)) - keep * un) * d.normal;
      v_[c.vertex] = select(rubs, after, v_[c.vertex]);
    }
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
      const T after = bounce(un, dot(relative(v_free_), d.normal));
      const Vec3<T> change = (-s_.k_friction) * u + (after - (T(1) - s_.k_friction) * un) * d.normal;
      const Vec3<T> impulse = c.inverse_sum * change;
      v_[c.q] = select(rubs, v_[c.q] + T(c.wq) * impulse, v_[c.q]);
      v_[c.a] = select(rubs, v_[c.a] - (T(c.wa) * c.b0) * impulse, v_[c.a]);
      v_[c.b] = select(rubs, v_[c.b] - (T(c.wb) * c.b1) * impulse, v_[c.b]);
      v_[c.c] = select(rubs, v_[c.c] - (T(c.wc) * c.b2) * impulse, v_[c.c]);
    }
  }

  const Vec3<T> &x(int i) const { return x_[i]; }
  const Vec3<T> &p(int i) const { return p_[i]; }
  Vec3<T> gravity() const { return {T(m_.gravity[0]), T(m_.gravity[1]), T(m_.gravity[2])}; }

  const LaneModel &m_;
  Substep<T> s_;
  Array<Place> x_, p_;                                ///< start, end of the substep; with the spare vertices
  Array<Vec3<T>> v_, v_free_, normals_;               ///< velocity, the same before contacts, unit normals
  Array<Vec3<T>> target_start_, target_end_, target_; ///< of the followers: in the frame; at the end of the substep
  Array<CapsuleMotion<T>> capsules_;
  Array<CapsuleContact<T>> contacts_; ///< ordered by capsule, then vertex
  Array<SelfContact<T>> self_contacts_;
  SelfCollision<T> self_collision_;
  Array<T> stretch_multipliers_, bend_multipliers_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
