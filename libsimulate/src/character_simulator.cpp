#include "doublet/simulate/character_simulator.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/self_intersection.h"
#include "doublet/core/skinning.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

constexpr double kDegenerateArea = 1e-14; // m^2, as in MeshReport

/// Valid, non-degenerate faces with at least one vertex of the region.
std::vector<int> region_faces(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &areas,
                              int region) {
  std::vector<int> chosen;
  for (int f = 0; f < actor.mesh.faces.rows(); ++f) {
    if (!actor.face_valid[f] || areas[f] < kDegenerateArea)
      continue;
    for (int k = 0; k < 3; ++k)
      if (segmentation.region[actor.mesh.faces(f, k)] == region) {
        chosen.push_back(f);
        break;
      }
  }
  return chosen;
}

void gather(const Vertices &all, const std::vector<int> &rows, Vertices &part) {
  part.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    part.row(static_cast<Eigen::Index>(i)) = all.row(rows[i]);
}
Vertices gather(const Vertices &all, const std::vector<int> &rows) {
  Vertices part;
  gather(all, rows, part);
  return part;
}

ClothRegion make_region(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &areas, int region,
                        const pbd::ClothOptions &options, const pbd::ClothSolverFactory &make_solver) {
  const std::vector<int> faces = region_faces(actor, segmentation, areas, region);
  if (faces.empty())
    throw Error("CharacterSimulator: cloth region " + std::to_string(region) + " has no valid triangle");
  ClothRegion result;
  const Mesh sub = submesh(actor.mesh, faces, &result.vertex_from_cloth);
  Eigen::VectorXd delta(sub.vertices.rows());
  for (Eigen::Index i = 0; i < delta.size(); ++i) {
    const int v = result.vertex_from_cloth[i];
    delta[i] = segmentation.region[v] == region ? segmentation.clothness[v] : 0.0;
  }
  const Vertices rest = segmentation.rest.rows() > 0 ? gather(segmentation.rest, result.vertex_from_cloth) : sub.vertices;
  result.model = pbd::ClothModel::create(rest, sub.faces, delta, options);
  result.solver = make_solver ? make_solver(result.model) : pbd::ClothSolver::create(result.model);
  if (!result.solver || &result.solver->model() != result.model.get())
    throw std::invalid_argument("CharacterSimulator: make_solver must return a solver of the model that it is given, found " +
                                std::string(result.solver ? "one of another" : "none"));
  return result;
}

/// Does a bone pass through the region's cloth at these positions (V, 3), in the rest pose, but not through the scan's?
bool bones_leave(const ClothRegion &region, const Vertices &positions, const RiggedMesh &actor) {
  const Mesh cloth{gather(positions, region.vertex_from_cloth), region.model->faces()},
      scan{gather(actor.mesh.vertices, region.vertex_from_cloth), region.model->faces()};
  const std::vector<Joint> &joints = actor.skeleton.joints;
  return std::any_of(joints.begin(), joints.end(), [&](const Joint &joint) {
    if (joint.parent < 0)
      return false;
    const Eigen::Vector3d &from = joints[joint.parent].rest;
    return crosses_surface(from, joint.rest, cloth) && !crosses_surface(from, joint.rest, scan);
  });
}

const RiggedMesh &checked(const RiggedMesh &actor) {
  require_actor(actor, "CharacterSimulator");
  return actor;
}

void check_regions(const CharacterState &state, const std::vector<pbd::Material> &materials, std::size_t count) {
  if (materials.size() != count || state.regions.size() != count)
    throw std::invalid_argument("CharacterSimulator::step: the character has " + std::to_string(count) + " cloth regions, got " +
                                std::to_string(materials.size()) + " materials and " + std::to_string(state.regions.size()) +
                                " states");
}

/// A state is lent to the solver, which it cannot be twice.
void require_distinct(std::span<CharacterState *const> states, const char *caller) {
  std::vector<CharacterState *> sorted(states.begin(), states.end());
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw std::invalid_argument(std::string(caller) + ": expected every state once, found one twice");
}

/// What a region's solver is told about a frame; `targets` must outlive it.
pbd::StepInputs region_inputs(const ClothRegion &region, const PosedFrame &previous, const PosedFrame &current,
                              const StepEnvironment &world, Vertices &previous_targets, Vertices &targets) {
  gather(previous.skinned, region.vertex_from_cloth, previous_targets);
  gather(current.skinned, region.vertex_from_cloth, targets);
  return {targets, previous_targets, current.capsules, previous.capsules, world.dt, world.wind, world.gravity, world.substeps};
}

} // namespace

CharacterSimulator::CharacterSimulator(const RiggedMesh &actor, const Segmentation &segmentation,
                                       const std::vector<TaperedCapsule> &proxies, const pbd::ClothOptions &options,
                                       const pbd::ClothSolverFactory &make_solver)
    : actor_(checked(actor)), proxies_(proxies), options_(options), skin_(actor.mesh.vertices, actor.weights),
      start_shape_(segmentation.rest) {
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "CharacterSimulator");
  require_proxies(proxies, actor.skeleton, "CharacterSimulator");
  const Eigen::VectorXd areas = face_areas(actor.mesh.vertices, actor.mesh.faces);
  for (int r = 0; r < segmentation.region_count; ++r)
    regions_.push_back(make_region(actor, segmentation, areas, r, options, make_solver));
  for (const ClothRegion &region : regions_)
    if (start_shape_.rows() > 0 && bones_leave(region, start_shape_, actor))
      for (const int v : region.vertex_from_cloth)
        start_shape_.row(v) = actor.mesh.vertices.row(v);
}

PosedFrame CharacterSimulator::pose(const Eigen::VectorXd &dofs) const {
  PosedFrame frame;
  pose(dofs, frame);
  return frame;
}

void CharacterSimulator::pose(const Eigen::VectorXd &dofs, PosedFrame &frame) const {
  if (dofs.size() != actor_.skeleton.dof_count())
    throw std::invalid_argument("CharacterSimulator::pose: dofs has " + std::to_string(dofs.size()) +
                                " entries, the skeleton has " + std::to_string(actor_.skeleton.dof_count()) +
                                " degrees of freedom");
  forward_kinematics(actor_.skeleton, dofs, frame.world_from_rest);
  dual_quaternions(actor_.skeleton, frame.world_from_rest, frame.joints);
  skin_.pose(frame.joints, frame.skinned);
  pose_capsules(proxies_, actor_.skeleton, frame.world_from_rest, frame.capsules);
}

CharacterState CharacterSimulator::start(const PosedFrame &frame, const Vertices *surface) const {
  if (surface && surface->rows() != actor_.mesh.vertices.rows())
    throw std::invalid_argument("CharacterSimulator::start: surface has " + std::to_string(surface->rows()) +
                                " vertices, the character has " + std::to_string(actor_.mesh.vertices.rows()));
  if (surface && !surface->allFinite())
    throw std::invalid_argument("CharacterSimulator::start: surface: expected finite positions, found NaN or infinity");
  require_frame(frame, "CharacterSimulator::start");
  CharacterState state;
  const Vertices spread = has_rest_shape()
                              ? dual_quaternion_skinning(start_shape_, actor_.weights, actor_.skeleton, frame.world_from_rest)
                              : Vertices();
  const Vertices &from = spread.rows() > 0 && !surface ? spread : surface ? *surface : frame.skinned;
  for (const ClothRegion &region : regions_)
    state.regions.push_back(pbd::initial_state(gather(from, region.vertex_from_cloth)));
  pin(state, frame);
  return state;
}

CharacterState CharacterSimulator::drape_along(std::span<const PosedFrame> poses, const std::vector<pbd::Material> &materials,
                                               const StepEnvironment &world) const {
  if (poses.empty())
    throw std::invalid_argument("CharacterSimulator::drape_along: expected at least one pose, found none");
  CharacterState state = start(poses[0]);
  StepBuffers buffers;
  for (std::size_t i = 1; i < poses.size(); ++i)
    step(state, poses[i - 1], poses[i], materials, world, buffers);
  return state;
}

/// The ring the cloth hangs from follows the skeleton.
void CharacterSimulator::pin(CharacterState &state, const PosedFrame &frame) const {
  for (std::size_t r = 0; r < regions_.size(); ++r)
    for (std::size_t i = 0; i < regions_[r].vertex_from_cloth.size(); ++i)
      if (regions_[r].model->inverse_masses()[static_cast<Eigen::Index>(i)] == 0)
        state.regions[r].positions.row(static_cast<Eigen::Index>(i)) = frame.skinned.row(regions_[r].vertex_from_cloth[i]);
}

void CharacterSimulator::move_rigidly(CharacterState &state, const PosedFrame &from, const PosedFrame &to) const {
  require_state(state, "CharacterSimulator::move_rigidly");
  require_frame(from, "CharacterSimulator::move_rigidly");
  require_frame(to, "CharacterSimulator::move_rigidly");
  const Eigen::Isometry3d way = to.world_from_rest.at(0) * from.world_from_rest.at(0).inverse();
  for (pbd::ClothState &cloth : state.regions)
    for (Eigen::Index i = 0; i < cloth.positions.rows(); ++i) {
      cloth.positions.row(i) = way * Eigen::Vector3d(cloth.positions.row(i));
      cloth.velocities.row(i) = way.linear() * Eigen::Vector3d(cloth.velocities.row(i));
    }
  pin(state, to);
}

void CharacterSimulator::settle(CharacterState &state, const PosedFrame &frame, const std::vector<pbd::Material> &materials,
                                double dt, int frames) const {
  if (frames < 0)
    throw std::invalid_argument("CharacterSimulator::settle: expected at least 0 frames, found " + std::to_string(frames));
  for (int i = 0; i < frames; ++i)
    step(state, frame, frame, materials, dt);
  for (pbd::ClothState &region : state.regions)
    region.velocities.setZero();
}

void CharacterSimulator::step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
                              const std::vector<pbd::Material> &materials, double dt) const {
  StepEnvironment world;
  world.dt = dt;
  StepBuffers buffers;
  step(state, previous, current, materials, world, buffers);
}

void CharacterSimulator::step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
                              const std::vector<pbd::Material> &materials, const StepEnvironment &world,
                              StepBuffers &buffers) const {
  check_regions(state, materials, regions_.size());
  require_frame(previous, "CharacterSimulator::step");
  require_frame(current, "CharacterSimulator::step");
  buffers.targets.resize(regions_.size());
  buffers.previous_targets.resize(regions_.size());
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const pbd::StepInputs inputs =
        region_inputs(regions_[r], previous, current, world, buffers.previous_targets[r], buffers.targets[r]);
    if (!regions_[r].solver->step_batch({&state.regions[r], 1}, {&inputs, 1}, {&materials[r], 1}).empty())
      throw Error("CharacterSimulator::step: cloth region " + std::to_string(r) +
                  " came out with a position or velocity that is not finite; expected a stable simulation");
  }
}

std::vector<DivergedRegion> CharacterSimulator::step_batch(std::span<CharacterState *const> states, const PosedFrame &previous,
                                                           const PosedFrame &current,
                                                           std::span<const std::vector<pbd::Material> *const> materials,
                                                           double dt) const {
  const PosedFrame *const before = &previous, *const after = &current;
  StepEnvironment world;
  world.dt = dt;
  return step_batch(states, {&before, 1}, {&after, 1}, materials, {&world, 1});
}

std::vector<DivergedRegion> CharacterSimulator::step_batch(std::span<CharacterState *const> states,
                                                           std::span<const PosedFrame *const> previous,
                                                           std::span<const PosedFrame *const> current,
                                                           std::span<const std::vector<pbd::Material> *const> materials,
                                                           std::span<const StepEnvironment> worlds, int threads) const {
  const std::size_t count = states.size(), poses = current.size();
  if (materials.size() != count)
    throw std::invalid_argument("CharacterSimulator::step_batch: " + std::to_string(count) + " states and " +
                                std::to_string(materials.size()) + " lists of materials, expected equally many");
  if (previous.size() != poses || worlds.size() != poses || (poses != count && poses != 1))
    throw std::invalid_argument(
        "CharacterSimulator::step_batch: expected as many poses before, poses after and worlds as states, "
        "or one of each, found " +
        std::to_string(previous.size()) + ", " + std::to_string(poses) + " and " + std::to_string(worlds.size()) + " for " +
        std::to_string(count));
  require_distinct(states, "CharacterSimulator::step_batch");
  for (std::size_t i = 0; i < count; ++i)
    check_regions(*states[i], *materials[i], regions_.size());
  for (std::size_t i = 0; i < poses; ++i)
    for (const PosedFrame *frame : {previous[i], current[i]})
      require_frame(*frame, "CharacterSimulator::step_batch");
  std::vector<DivergedRegion> failed;
  for (int r = 0; r < static_cast<int>(regions_.size()); ++r)
    for (int i : step_region(r, states, previous, current, materials, worlds, threads))
      failed.push_back({i, r});
  return failed;
}

std::vector<int> CharacterSimulator::step_region(int region, std::span<CharacterState *const> states, const PosedFrame &previous,
                                                 const PosedFrame &current,
                                                 std::span<const std::vector<pbd::Material> *const> materials, double dt) const {
  if (region < 0 || region >= static_cast<int>(regions_.size()) || materials.size() != states.size())
    throw std::invalid_argument("CharacterSimulator::step_region: expected a region below " + std::to_string(regions_.size()) +
                                " and as many lists of materials as states, found " + std::to_string(region) + ", " +
                                std::to_string(materials.size()) + " and " + std::to_string(states.size()));
  require_distinct(states, "CharacterSimulator::step_region");
  for (std::size_t i = 0; i < states.size(); ++i)
    check_regions(*states[i], *materials[i], regions_.size());
  require_frame(previous, "CharacterSimulator::step_region");
  require_frame(current, "CharacterSimulator::step_region");
  const PosedFrame *const before = &previous, *const after = &current;
  StepEnvironment world;
  world.dt = dt;
  return step_region(region, states, {&before, 1}, {&after, 1}, materials, {&world, 1}, 1);
}

std::vector<int> CharacterSimulator::step_region(int region, std::span<CharacterState *const> states,
                                                 std::span<const PosedFrame *const> previous,
                                                 std::span<const PosedFrame *const> current,
                                                 std::span<const std::vector<pbd::Material> *const> materials,
                                                 std::span<const StepEnvironment> worlds, int threads) const {
  const std::size_t count = states.size(), poses = current.size();
  std::vector<pbd::ClothState> cloth(count);
  std::vector<pbd::Material> material(count);
  std::vector<pbd::StepInputs> inputs(poses);
  std::vector<Vertices> targets(poses), previous_targets(poses);
  for (std::size_t i = 0; i < poses; ++i)
    inputs[i] = region_inputs(regions_[region], *previous[i], *current[i], worlds[i], previous_targets[i], targets[i]);
  for (std::size_t i = 0; i < count; ++i)
    material[i] = (*materials[i])[region];
  const auto lend = [&] { // to and fro
    for (std::size_t i = 0; i < count; ++i)
      std::swap(cloth[i], states[i]->regions[region]);
  };
  lend();
  std::vector<int> failed;
  try {
    failed = regions_[region].solver->step_batch(cloth, inputs, material, threads);
  } catch (...) {
    lend();
    throw;
  }
  lend();
  return failed;
}

Vertices CharacterSimulator::surface(const CharacterState &state, const PosedFrame &frame) const {
  Vertices result;
  surface(state, frame, result);
  return result;
}

void CharacterSimulator::surface(const CharacterState &state, const PosedFrame &frame, Vertices &result) const {
  require_state(state, "CharacterSimulator::surface");
  require_frame(frame, "CharacterSimulator::surface");
  result = frame.skinned;
  for (const bool moves : {false, true}) // of regions that touch each has vertices of the other, which hang on the skin there
    for (std::size_t r = 0; r < regions_.size(); ++r)
      for (std::size_t i = 0; i < regions_[r].vertex_from_cloth.size(); ++i)
        if (const auto row = static_cast<Eigen::Index>(i); (regions_[r].model->inverse_masses()[row] > 0) == moves)
          result.row(regions_[r].vertex_from_cloth[i]) = state.regions[r].positions.row(row);
}

void CharacterSimulator::require_frame(const PosedFrame &frame, const char *caller) const {
  const auto vertices = actor_.mesh.vertices.rows();
  const auto joints = static_cast<std::size_t>(actor_.skeleton.joint_count());
  if (frame.skinned.rows() != vertices || frame.world_from_rest.size() != joints)
    throw std::invalid_argument(std::string(caller) + ": the frame has " + std::to_string(frame.skinned.rows()) +
                                " vertices and " + std::to_string(frame.world_from_rest.size()) + " joints, the character " +
                                std::to_string(vertices) + " and " + std::to_string(joints));
}

void CharacterSimulator::require_state(const CharacterState &state, const char *caller) const {
  if (state.regions.size() != regions_.size())
    throw std::invalid_argument(std::string(caller) + ": state has " + std::to_string(state.regions.size()) +
                                " cloth regions, the character " + std::to_string(regions_.size()));
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const auto expected = static_cast<Eigen::Index>(regions_[r].vertex_from_cloth.size());
    for (const Vertices *values : {&state.regions[r].positions, &state.regions[r].velocities})
      if (values->rows() != expected)
        throw std::invalid_argument(std::string(caller) + ": region " + std::to_string(r) + " of the state has " +
                                    std::to_string(values->rows()) + " vertices, that of the character " +
                                    std::to_string(expected));
  }
}

std::vector<Eigen::VectorXd> lead_in_poses(const Skeleton &skeleton, const Eigen::VectorXd &dofs, double dt) {
  constexpr double kSeconds = 0.6, kNear = 0.35; // rad
  if (dofs.size() != skeleton.dof_count() || !dofs.allFinite() || !(dt > 0) || !std::isfinite(dt))
    throw std::invalid_argument("lead_in_poses: expected a pose of " + std::to_string(skeleton.dof_count()) +
                                " finite numbers and a time step above 0");
  Eigen::VectorXd rest = Eigen::VectorXd::Zero(dofs.size());
  for (const Joint &joint : skeleton.joints)
    if (joint.kind == JointKind::Root)
      rest.segment(joint.first_dof, joint.dof_count) = dofs.segment(joint.first_dof, joint.dof_count);
  if ((dofs - rest).lpNorm<Eigen::Infinity>() < kNear)
    return {dofs};
  const auto steps = static_cast<int>(std::ceil(kSeconds / dt));
  std::vector<Eigen::VectorXd> poses{rest};
  for (int i = 1; i < steps; ++i) {
    const double x = static_cast<double>(i) / steps;
    poses.push_back(interpolate_pose(skeleton, rest, dofs, x * x * (3 - 2 * x)));
  }
  poses.push_back(dofs);
  return poses;
}

} // namespace doublet
