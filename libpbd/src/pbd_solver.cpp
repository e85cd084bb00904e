// The step of Stoll et al. 2010, Sect. 6, for one simulation.

#include "capsule_motion.h"
#include "pbd_model.h"
#include "self_collision.h"

#include <Eigen/Dense>
#include <mutex>
#include <stdexcept>

namespace doublet::pbd {
namespace {

constexpr float kMaxSpeed =
    100; ///< m/s, safety clamp: four times what a person's hand can do, three times a falling skydiver's speed
constexpr float kDepenetrationSpeed = 1; ///< m/s at which a penetration that the start brought along is opened
constexpr float kNear = 0.02f;           ///< m from a proxy within which a vertex is watched during the iterations
constexpr float kMinAgreement =
    0.5f; ///< cosine between closest normal and entry normal up to which a vertex has not passed the axis

/// Scratch memory of one running step, in coordinates local to `origin` so that float keeps micrometres far from the world's
/// origin.
struct Workspace {
  Eigen::Vector3d origin;
  std::vector<Point> x, p;                             ///< start, end; with the spare vertices
  std::vector<Vec3f> v, v_free, normals;               ///< velocity, the same before contacts, unit normals
  std::vector<Vec3f> target_start, target_end, target; ///< of the frame; of the substep
  std::vector<CapsuleMotion> capsules;
  std::vector<CapsuleContact<float>> contacts; ///< ordered by capsule, then vertex
  std::vector<SelfContact<float>> self_contacts;
  PairFinder finder;
  std::vector<Box> boxes;
};

/// One substep's numbers.
struct Substep {
  float h;                     ///< s
  float begin, end;            ///< fractions of the frame
  float k_bend, k_stretch;     ///< per iteration
  float k_friction, k_damping; ///< per substep
  float half_dn_h, tangential_factor;
  Vec3f wind, gravity;
};

Vec3f to_float(const Eigen::Vector3d &v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
Vec3f row(const Vertices &m, int i, const Eigen::Vector3d &origin) {
  return {static_cast<float>(m(i, 0) - origin[0]), static_cast<float>(m(i, 1) - origin[1]),
          static_cast<float>(m(i, 2) - origin[2])};
}
/// Stiffness of one of n projections that together do what one with stiffness k does: 1 - (1 - k)^(1/n), Mueller et al. 2007,
/// Sect. 3.3.
float share_of(double k, int n) {
  return static_cast<float>(1 - std::pow(1 - k, 1.0 / n));
}

[[noreturn]] void refuse(const std::string &what) {
  throw std::invalid_argument("cloth step: " + what);
}

void check_vertices(const Vertices *m, int n, const char *name) {
  if (m->rows() != n)
    refuse(std::string(name) + " must have " + std::to_string(n) + " rows, found " + std::to_string(m->rows()));
  if (!m->allFinite())
    refuse(std::string(name) + " holds a value that is not finite");
}

void check_inputs(const PbdModel &model, const ClothState &state, const StepInputs &in) {
  const int n = model.vertex_count();
  check_vertices(&state.positions, n, "state.positions");
  check_vertices(&state.velocities, n, "state.velocities");
  if (!in.targets && model.follows_targets())
    refuse("targets are missing, and the model has vertices that follow them");
  if (in.targets)
    check_vertices(in.targets, n, "targets");
  if (in.previous_targets)
    check_vertices(in.previous_targets, n, "previous_targets");
  if (!(in.dt > 0 && in.dt <= 1))
    refuse("dt must lie in (0, 1] s, found " + std::to_string(in.dt));
  if (!in.wind.allFinite())
    refuse("wind is not finite");
  if (in.capsules && in.previous_capsules && in.capsules->size() != in.previous_capsules->size())
    refuse("capsules and previous_capsules must be equally many, found " + std::to_string(in.capsules->size()) + " and " +
           std::to_string(in.previous_capsules->size()));
  for (const std::vector<Capsule> *list : {in.capsules, in.previous_capsules})
    if (list)
      for (size_t i = 0; i < list->size(); ++i) {
        const Capsule &c = (*list)[i];
        if (!c.p0.allFinite() || !c.p1.allFinite() || !(c.r0 >= 0 && c.r0 < 1e3) || !(c.r1 >= 0 && c.r1 < 1e3))
          refuse("capsule " + std::to_string(i) + " must have finite ends and radii in [0, 1000) m, found radii " +
                 std::to_string(c.r0) + " and " + std::to_string(c.r1));
      }
}

class PbdSolver final : public ClothSolver {
public:
  explicit PbdSolver(std::shared_ptr<const PbdModel> model) : model_(std::move(model)) {}
  const ClothModel &model() const override { return *model_; }
  void step(ClothState &state, const StepInputs &inputs, const Material &material) const override;

private:
  void load(Workspace &w, const ClothState &state, const StepInputs &in) const;
  void store(const Workspace &w, ClothState &state) const;
  void advance(Workspace &w, const Substep &s, const StepInputs &in) const;
  void set_scene(Workspace &w, const Substep &s, const StepInputs &in) const;
  void update_normals(Workspace &w) const;
  void apply_forces(Workspace &w, const Substep &s) const;
  void damp(Workspace &w, float k) const;
  void predict(Workspace &w, const Substep &s) const;
  void find_capsule_contacts(Workspace &w, const Substep &s) const;
  void iterate(Workspace &w, const Substep &s) const;
  void push_out_strays(Workspace &w) const;
  void update_velocities(Workspace &w, const Substep &s) const;
  void limit_speed(Workspace &w) const;
  void rub_capsules(Workspace &w, const Substep &s) const;
  void rub_self(Workspace &w, const Substep &s) const;
  float bounce(float approach, float free_approach, const Substep &s) const;

  /// Workspaces are lent to running steps and reused: no allocation once warm, any number of threads.
  std::unique_ptr<Workspace> borrow() const;
  void give_back(std::unique_ptr<Workspace> w) const;

  std::shared_ptr<const PbdModel> model_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Workspace>> idle_;
};

std::unique_ptr<Workspace> PbdSolver::borrow() const {
  const std::lock_guard lock(mutex_);
  if (idle_.empty())
    return std::make_unique<Workspace>();
  std::unique_ptr<Workspace> w = std::move(idle_.back());
  idle_.pop_back();
  return w;
}

void PbdSolver::give_back(std::unique_ptr<Workspace> w) const {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(w));
}

void PbdSolver::step(ClothState &state, const StepInputs &in, const Material &material) const {
  validate(material);
  check_inputs(*model_, state, in);
  const ClothOptions &options = model_->options();
  const int n = options.substeps;
  const double h = in.dt / n;
  Substep s{};
  s.h = static_cast<float>(h);
  s.k_bend = share_of(material.k_bend, options.iterations);
  s.k_stretch = share_of(material.k_stretch, options.iterations);
  s.k_friction = share_of(material.k_friction, n);
  s.k_damping = share_of(material.k_damping, n);
  s.half_dn_h = static_cast<float>(0.5 * material.d_n * h);
  s.tangential_factor = static_cast<float>(std::exp(-0.5 * material.d_t * h));
  s.wind = to_float(in.wind);
  s.gravity = to_float(options.gravity);

  std::unique_ptr<Workspace> w = borrow();
  load(*w, state, in);
  for (int i = 0; i < n; ++i) {
    s.begin = static_cast<float>(i) / static_cast<float>(n);
    s.end = static_cast<float>(i + 1) / static_cast<float>(n);
    advance(*w, s, in);
  }
  store(*w, state);
  give_back(std::move(w));
}

void PbdSolver::load(Workspace &w, const ClothState &state, const StepInputs &in) const {
  const int n = model_->vertex_count();
  w.origin = state.positions.colwise().mean().array().round().matrix().transpose(); // whole metres: exact to subtract
  const Vertices &last = in.targets ? *in.targets : state.positions;
  const Vertices &first = in.previous_targets && in.targets ? *in.previous_targets : last;
  for (std::vector<Point> *a : {&w.x, &w.p}) {
    a->resize(n + kSpareVertices);
    for (int k = 0; k < kSpareVertices; ++k)
      (*a)[n + k] = Vec3f{static_cast<float>(k & 1), static_cast<float>(k >> 1), 0};
  }
  for (std::vector<Vec3f> *a : {&w.v, &w.v_free, &w.normals, &w.target_start, &w.target_end, &w.target})
    a->resize(n);
  for (int i = 0; i < n; ++i) {
    w.x[i] = row(state.positions, i, w.origin);
    w.v[i] = row(state.velocities, i, Eigen::Vector3d::Zero());
    w.target_start[i] = row(first, i, w.origin);
    w.target_end[i] = row(last, i, w.origin);
  }
}

void PbdSolver::store(const Workspace &w, ClothState &state) const {
  for (int i = 0; i < model_->vertex_count(); ++i) {
    const Vec3f x = w.x[i], v = w.v[i];
    if (!(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z) && std::isfinite(v.x) && std::isfinite(v.y) &&
          std::isfinite(v.z)))
      throw std::runtime_error("cloth step: vertex " + std::to_string(i) +
                               " came out with a position or velocity that is not finite");
  }
  for (int i = 0; i < model_->vertex_count(); ++i) {
    const Vec3f x = w.x[i], v = w.v[i];
    state.positions.row(i) << x.x + w.origin[0], x.y + w.origin[1], x.z + w.origin[2];
    state.velocities.row(i) << v.x, v.y, v.z;
  }
}

void PbdSolver::advance(Workspace &w, const Substep &s, const StepInputs &in) const {
  set_scene(w, s, in);
  update_normals(w);
  apply_forces(w, s);
  if (s.k_damping > 0)
    damp(w, s.k_damping);
  predict(w, s);
  find_capsule_contacts(w, s);
  w.self_contacts.clear();
  if (model_->options().self_collision)
    find_self_contacts(*model_, w.x, w.p, kDepenetrationSpeed * s.h, w.finder, w.boxes, w.self_contacts);
  iterate(w, s);
  push_out_strays(w);
  update_velocities(w, s);
  rub_self(w, s);
  rub_capsules(w, s);
  limit_speed(w);
  std::swap(w.x, w.p);
}

/// Targets at the end of the substep, proxies at both of its ends.
void PbdSolver::set_scene(Workspace &w, const Substep &s, const StepInputs &in) const {
  for (size_t i = 0; i < w.target.size(); ++i)
    w.target[i] = s.end == 1 ? w.target_end[i] : w.target_start[i] + s.end * (w.target_end[i] - w.target_start[i]);
  w.capsules.clear();
  if (!in.capsules)
    return;
  for (size_t i = 0; i < in.capsules->size(); ++i) {
    const Capsule &last = (*in.capsules)[i], &first = in.previous_capsules ? (*in.previous_capsules)[i] : last;
    const auto at = [&](double t) {
      Capsule c = last; // keeps its radii
      c.p0 = first.p0 + t * (last.p0 - first.p0);
      c.p1 = first.p1 + t * (last.p1 - first.p1);
      return c;
    };
    w.capsules.push_back(capsule_motion(at(s.begin), at(s.end), w.origin));
  }
}

/// Unit normals, area-weighted; zero where the faces cancel (drag then takes all motion as tangential).
void PbdSolver::update_normals(Workspace &w) const {
  std::fill(w.normals.begin(), w.normals.end(), Vec3f{0, 0, 0});
  const Faces &faces = model_->faces();
  for (int f = 0; f < faces.rows(); ++f) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    const Vec3f n = cross(w.x[b] - w.x[a], w.x[c] - w.x[a]);
    w.normals[a] += n;
    w.normals[b] += n;
    w.normals[c] += n;
  }
  for (Vec3f &n : w.normals)
    n = (1.0f / lane_max(lane_sqrt(dot(n, n)), 1e-12f)) * n;
}

/// Half of gravity, drag, the other half: symmetric, so that the terminal velocity is right to second order in h.
void PbdSolver::apply_forces(Workspace &w, const Substep &s) const {
  const Vec3f half = (0.5f * s.h) * s.gravity;
  const std::vector<float> &weights = model_->weights();
  for (size_t i = 0; i < w.v.size(); ++i) {
    if (weights[i] == 0)
      continue;
    const Vec3f u = w.v[i] + half - s.wind;
    w.v[i] = apply_drag(u, w.normals[i], s.half_dn_h, s.tangential_factor) + s.wind + half;
  }
}

/// Mueller et al. 2007, Sect. 3.5: velocities move by k towards the rigid motion with the same momentum and angular momentum.
void PbdSolver::damp(Workspace &w, float k) const {
  const Eigen::VectorXd &weights = model_->inverse_masses();
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  const auto vec = [](const Vec3f &a) { return Eigen::Vector3d(a.x, a.y, a.z); };
  for (size_t i = 0; i < w.v.size(); ++i)
    if (weights[static_cast<int>(i)] > 0) {
      const double m = 1 / weights[static_cast<int>(i)];
      mass += m;
      centre += m * vec(w.x[i]);
      velocity += m * vec(w.v[i]);
    }
  if (mass == 0)
    return;
  centre /= mass;
  velocity /= mass;
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < w.v.size(); ++i)
    if (weights[static_cast<int>(i)] > 0) {
      const double m = 1 / weights[static_cast<int>(i)];
      const Eigen::Vector3d r = vec(w.x[i]) - centre;
      angular_momentum += m * r.cross(vec(w.v[i]));
      inertia += m * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
    }
  // A piece crumpled into a line has no inertia about it: leave that turn alone.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a)
    if (axes.eigenvalues()[a] > 1e-9 * axes.eigenvalues()[2])
      spin += axes.eigenvectors().col(a).dot(angular_momentum) / axes.eigenvalues()[a] * axes.eigenvectors().col(a);
  for (size_t i = 0; i < w.v.size(); ++i)
    if (weights[static_cast<int>(i)] > 0) {
      const Eigen::Vector3d rigid = velocity + spin.cross(vec(w.x[i]) - centre);
      w.v[i] += k * (to_float(rigid) - w.v[i]);
    }
}

void PbdSolver::predict(Workspace &w, const Substep &s) const {
  const std::vector<float> &weights = model_->weights();
  for (size_t i = 0; i < w.v.size(); ++i) {
    w.p[i] = weights[i] > 0 ? w.x[i] + s.h * w.v[i] : w.target[i];
    w.v_free[i] = w.v[i];
  }
}

struct Reach {
  Vec3f lo, hi;
};
/// Box around both ends of a capsule's motion, grown by `margin`.
Reach reach_of(const CapsuleMotion &m, float margin) {
  Reach r{{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};
  for (const CapsuleShape *c : {&m.start, &m.end})
    for (float t : {0.0f, c->length}) {
      const Vec3f p = c->a + t * c->axis;
      const float radius = c->radius - c->slope * t + margin;
      r.lo = {lane_min(r.lo.x, p.x - radius), lane_min(r.lo.y, p.y - radius), lane_min(r.lo.z, p.z - radius)};
      r.hi = {lane_max(r.hi.x, p.x + radius), lane_max(r.hi.y, p.y + radius), lane_max(r.hi.z, p.z + radius)};
    }
  return r;
}
bool may_touch(const Reach &r, Vec3f a, Vec3f b) {
  return lane_min(a.x, b.x) <= r.hi.x && lane_max(a.x, b.x) >= r.lo.x && lane_min(a.y, b.y) <= r.hi.y &&
         lane_max(a.y, b.y) >= r.lo.y && lane_min(a.z, b.z) <= r.hi.z && lane_max(a.z, b.z) >= r.lo.z;
}

/// Vertices that enter a proxy during the step, or are near one at either end. Everything is seen from the moving proxy: a leg
/// that jumps a quarter of a metre between frames sweeps the cloth that stood before it along.
void PbdSolver::find_capsule_contacts(Workspace &w, const Substep &s) const {
  w.contacts.clear();
  const float thickness = static_cast<float>(model_->options().thickness);
  const float margin = thickness + kNear;
  const std::vector<float> &weights = model_->weights();
  for (int k = 0; k < static_cast<int>(w.capsules.size()); ++k) {
    const CapsuleMotion &m = w.capsules[k];
    const Reach reach = reach_of(m, margin);
    for (int i = 0; i < static_cast<int>(w.v.size()); ++i) {
      if (weights[i] == 0 || !may_touch(reach, w.x[i], w.p[i]))
        continue;
      const Distance<float> start = capsule_distance(m.start, w.x[i]);
      CapsuleContact<float> contact{i, k, 0, m.rotate(start.normal), 0, kMinAgreement, 0};
      const float depth = thickness - start.value;
      if (depth > 0) { // starts inside: open it gently by moving start and end alike, which gives no speed
        const float moved = lane_min(depth, kDepenetrationSpeed * s.h);
        w.x[i] += moved * start.normal;
        w.p[i] += moved * start.normal;
        contact.slack = depth - moved;
        contact.plane = dot(contact.reference, m.carry(w.x[i]));
      } else {
        const Vec3f q0 = m.carry(w.x[i]), way = w.p[i] - q0;
        const float t = depth + lane_sqrt(dot(way, way)) > 0 ? entry_time(m.end, q0, w.p[i], thickness) : 2.0f;
        const Vec3f q = t <= 1 ? q0 + t * way : w.p[i];
        const Distance<float> d = capsule_distance(m.end, q);
        if (t > 1 && start.value > margin && d.value > margin)
          continue;
        contact.reference = d.normal;
        contact.plane = dot(d.normal, q) - (d.value - thickness);
        if (t > 1)
          contact.min_agreement = 0; // has not met the proxy, and may yet slide a quarter round it
      }
      w.contacts.push_back(contact);
    }
  }
}

void project_bends(Point *p, const BendBlock &b, Pack4 stiffness) {
  Vec3<Pack4> x0 = gather(p, b.v[0]), x1 = gather(p, b.v[1]), x2 = gather(p, b.v[2]), x3 = gather(p, b.v[3]);
  project_bend(x0, x1, x2, x3, Pack4::load(b.w[0]), Pack4::load(b.w[1]), Pack4::load(b.w[2]), Pack4::load(b.w[3]),
               Pack4::load(b.cos), Pack4::load(b.sin), Pack4::load(b.floor), stiffness);
  scatter(p, b.v[0], x0);
  scatter(p, b.v[1], x1);
  scatter(p, b.v[2], x2);
  scatter(p, b.v[3], x3);
}

void PbdSolver::iterate(Workspace &w, const Substep &s) const {
  const float thickness = static_cast<float>(model_->options().thickness);
  Point *p = w.p.data();
  const Pack4 k_bend(s.k_bend);
  for (int iteration = 0; iteration < model_->options().iterations; ++iteration) {
    for (const StretchConstraint &c : model_->stretches())
      project_stretch(p[c.a], p[c.b], c.share_a, c.share_b, c.length, s.k_stretch);
    if (s.k_bend > 0)
      for (const BendBlock &b : model_->bends())
        project_bends(p, b, k_bend);
    for (const BlendConstraint &c : model_->blends())
      project_blend(p[c.vertex], w.target[c.vertex], c.stiffness);
    for (SelfContact<float> &c : w.self_contacts)
      project_self(p[c.q], p[c.a], p[c.b], p[c.c], c);
    for (CapsuleContact<float> &c : w.contacts)
      project_capsule(p[c.vertex], c, w.capsules[c.capsule].end, thickness);
  }
}

/// Vertices that the iterations dragged into a proxy they were not near before.
void PbdSolver::push_out_strays(Workspace &w) const {
  const float thickness = static_cast<float>(model_->options().thickness);
  const std::vector<float> &weights = model_->weights();
  size_t next = 0;
  for (int k = 0; k < static_cast<int>(w.capsules.size()); ++k) {
    const CapsuleMotion still{w.capsules[k].end, w.capsules[k].end, {}};
    const Reach reach = reach_of(still, thickness);
    for (int i = 0; i < static_cast<int>(w.v.size()); ++i) {
      if (next < w.contacts.size() && w.contacts[next].capsule == k && w.contacts[next].vertex == i) {
        ++next;
        continue;
      }
      if (weights[i] == 0 || !may_touch(reach, w.p[i], w.p[i]))
        continue;
      const Distance<float> d = capsule_distance(still.end, w.p[i]);
      if (d.value < thickness)
        w.p[i] += (thickness - d.value) * d.normal;
    }
  }
}

void PbdSolver::update_velocities(Workspace &w, const Substep &s) const {
  const float rate = 1.0f / s.h;
  for (size_t i = 0; i < w.v.size(); ++i)
    w.v[i] = rate * (w.p[i] - w.x[i]);
}

void PbdSolver::limit_speed(Workspace &w) const {
  for (Vec3f &v : w.v)
    v = lane_min(1.0f, kMaxSpeed / lane_max(lane_sqrt(dot(v, v)), 1e-12f)) * v;
}

/// Normal velocity after a contact: none into it; what came in faster than gravity's own doing in two steps is reflected.
float PbdSolver::bounce(float approach, float free_approach, const Substep &s) const {
  const float e = static_cast<float>(model_->options().restitution);
  const float threshold = 2 * s.h * lane_sqrt(dot(s.gravity, s.gravity));
  const float reflected = free_approach < -threshold ? -e * free_approach : 0.0f;
  return lane_max(approach, reflected);
}

/// Friction and restitution against the proxies, relative to the moving surface.
void PbdSolver::rub_capsules(Workspace &w, const Substep &s) const {
  const float thickness = static_cast<float>(model_->options().thickness);
  for (const CapsuleContact<float> &c : w.contacts) {
    if (c.touched == 0)
      continue;
    const CapsuleMotion &m = w.capsules[c.capsule];
    const Distance<float> d = capsule_distance(m.end, w.p[c.vertex]);
    if (d.value > thickness + 5e-4f) // pulled off again
      continue;
    const Vec3f surface = w.p[c.vertex] - d.value * d.normal;
    const Vec3f surface_velocity = (1.0f / s.h) * (surface - m.carry_back(surface));
    const Vec3f u = w.v[c.vertex] - surface_velocity, u_free = w.v_free[c.vertex] - surface_velocity;
    const float un = dot(u, d.normal);
    const float keep = 1.0f - s.k_friction;
    w.v[c.vertex] = surface_velocity + keep * u + (bounce(un, dot(u_free, d.normal), s) - keep * un) * d.normal;
  }
}

/// The same between cloth and cloth, as impulses that keep the momentum.
void PbdSolver::rub_self(Workspace &w, const Substep &s) const {
  for (const SelfContact<float> &c : w.self_contacts) {
    if (c.touched == 0)
      continue;
    const Distance<float> d = self_distance(w.p[c.q], w.p[c.a], w.p[c.b], w.p[c.c], c.b0, c.b1, c.b2, c.side);
    if (d.value > c.thickness + 5e-4f)
      continue;
    const auto relative = [&](const std::vector<Vec3f> &v) { return v[c.q] - (c.b0 * v[c.a] + c.b1 * v[c.b] + c.b2 * v[c.c]); };
    const Vec3f u = relative(w.v);
    const float un = dot(u, d.normal);
    const float after = bounce(un, dot(relative(w.v_free), d.normal), s);
    const Vec3f change = (-s.k_friction) * u + (after - (1.0f - s.k_friction) * un) * d.normal;
    const Vec3f impulse = c.inverse_sum * change;
    w.v[c.q] += c.wq * impulse;
    w.v[c.a] -= (c.wa * c.b0) * impulse;
    w.v[c.b] -= (c.wb * c.b1) * impulse;
    w.v[c.c] -= (c.wc * c.b2) * impulse;
  }
}

} // namespace

std::unique_ptr<ClothSolver> ClothSolver::create(std::shared_ptr<const ClothModel> model) {
  auto own = std::dynamic_pointer_cast<const PbdModel>(model);
  if (!own)
    throw std::invalid_argument("ClothSolver::create: the model must come from ClothModel::create");
  return std::make_unique<PbdSolver>(std::move(own));
}

void ClothSolver::step_many(std::span<ClothState> states, const StepInputs &inputs, std::span<const Material> materials) const {
  if (states.size() != materials.size())
    throw std::invalid_argument("step_many: states and materials must be equally many, found " + std::to_string(states.size()) +
                                " and " + std::to_string(materials.size()));
  for (size_t i = 0; i < states.size(); ++i)
    step(states[i], inputs, materials[i]);
}

ClothState initial_state(const Vertices &positions) {
  return {positions, Vertices::Zero(positions.rows(), 3)};
}

} // namespace doublet::pbd
