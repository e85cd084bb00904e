#include "doublet/simulate/character_simulator.h"

#include "doublet/core/error.h"
#include "doublet/core/skinning.h"

#include <algorithm>

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

Vertices gather(const Vertices &all, const std::vector<int> &rows) {
  Vertices part(rows.size(), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    part.row(i) = all.row(rows[i]);
  return part;
}

ClothRegion make_region(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &areas, int region,
                        const pbd::ClothOptions &options, const pbd::ClothSolverFactory &make_solver) {
  const std::vector<int> faces = region_faces(actor, segmentation, areas, region);
  if (faces.empty())
    throw Error("CharacterSimulator: cloth region " + std::to_string(region) + " has no valid triangle");
  ClothRegion result;
  const Mesh sub = submesh(actor.mesh, faces, &result.vertex_from_cloth);
  Eigen::VectorXd delta(sub.vertices.rows()), fullness = Eigen::VectorXd::Ones(sub.vertices.rows());
  for (Eigen::Index i = 0; i < delta.size(); ++i) {
    const int v = result.vertex_from_cloth[i];
    delta[i] = segmentation.region[v] == region ? segmentation.clothness[v] : 0.0;
    if (segmentation.fullness.size() > 0)
      fullness[i] = segmentation.fullness[v];
  }
  const Vertices rest = segmentation.rest.rows() > 0 ? gather(segmentation.rest, result.vertex_from_cloth) : sub.vertices;
  result.model = pbd::ClothModel::create(rest, sub.faces, delta, options, fullness);
  result.solver = make_solver ? make_solver(result.model) : pbd::ClothSolver::create(result.model);
  if (!result.solver || &result.solver->model() != result.model.get())
    throw std::invalid_argument("CharacterSimulator: make_solver must return a solver of the model that it is given, found " +
                                std::string(result.solver ? "one of another" : "none"));
  return result;
}

void check_regions(const CharacterState &state, const std::vector<pbd::Material> &materials, std::size_t count) {
  if (materials.size() != count || state.regions.size() != count)
    throw std::invalid_argument("CharacterSimulator::step: the character has " + std::to_string(count) + " cloth regions, got " +
                                std::to_string(materials.size()) + " materials and " + std::to_string(state.regions.size()) +
                                " states");
}

/// What a region's solver is told about a frame.
struct RegionInputs {
  Vertices targets, previous_targets;
  pbd::StepInputs view;
  RegionInputs(const ClothRegion &region, const PosedFrame &previous, const PosedFrame &current, double dt)
      : targets(gather(current.skinned, region.vertex_from_cloth)),
        previous_targets(gather(previous.skinned, region.vertex_from_cloth)) {
    view.targets = &targets;
    view.previous_targets = &previous_targets;
    view.capsules = &current.capsules;
    view.previous_capsules = &previous.capsules;
    view.dt = dt;
  }
  RegionInputs(const RegionInputs &) = delete; // view points into this one
};

} // namespace

CharacterSimulator::CharacterSimulator(const RiggedMesh &actor, const Segmentation &segmentation,
                                       const std::vector<TaperedCapsule> &proxies, const pbd::ClothOptions &options,
                                       const pbd::ClothSolverFactory &make_solver)
    : actor_(actor), proxies_(proxies), options_(options), rest_(segmentation.rest) {
  require_actor(actor, "CharacterSimulator");
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "CharacterSimulator");
  require_proxies(proxies, actor.skeleton, "CharacterSimulator");
  const Eigen::VectorXd areas = face_areas(actor.mesh.vertices, actor.mesh.faces);
  for (int r = 0; r < segmentation.region_count; ++r)
    regions_.push_back(make_region(actor, segmentation, areas, r, options, make_solver));
}

PosedFrame CharacterSimulator::pose(const Eigen::VectorXd &dofs) const {
  if (dofs.size() != actor_.skeleton.dof_count())
    throw std::invalid_argument("CharacterSimulator::pose: dofs has " + std::to_string(dofs.size()) +
                                " entries, the skeleton has " + std::to_string(actor_.skeleton.dof_count()) +
                                " degrees of freedom");
  PosedFrame frame;
  frame.world_from_rest = forward_kinematics(actor_.skeleton, dofs);
  frame.skinned = dual_quaternion_skinning(actor_.mesh.vertices, actor_.weights, frame.world_from_rest);
  for (const PosedCapsule &c : pose_capsules(proxies_, actor_.skeleton, frame.world_from_rest))
    frame.capsules.push_back({c.p0, c.p1, c.r0, c.r1});
  return frame;
}

CharacterState CharacterSimulator::start(const PosedFrame &frame, const Vertices *surface) const {
  if (surface && surface->rows() != actor_.mesh.vertices.rows())
    throw std::invalid_argument("CharacterSimulator::start: surface has " + std::to_string(surface->rows()) +
                                " vertices, the character has " + std::to_string(actor_.mesh.vertices.rows()));
  if (surface && !surface->allFinite())
    throw std::invalid_argument("CharacterSimulator::start: surface: expected finite positions, found NaN or infinity");
  CharacterState state;
  const Vertices spread = rest_.rows() > 0 ? dual_quaternion_skinning(rest_, actor_.weights, frame.world_from_rest) : Vertices();
  const Vertices &from = spread.rows() > 0 && !surface ? spread : surface ? *surface : frame.skinned;
  for (const ClothRegion &region : regions_) {
    Vertices positions = gather(from, region.vertex_from_cloth);
    // The ring the cloth hangs from follows the skeleton, wherever the given surface has it.
    for (Eigen::Index i = 0; i < positions.rows(); ++i)
      if (region.model->inverse_masses()[i] == 0)
        positions.row(i) = frame.skinned.row(region.vertex_from_cloth[i]);
    state.regions.push_back(pbd::initial_state(positions));
  }
  return state;
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
  check_regions(state, materials, regions_.size());
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const RegionInputs inputs(regions_[r], previous, current, dt);
    regions_[r].solver->step(state.regions[r], inputs.view, materials[r]);
  }
}

std::vector<FailedRegion> CharacterSimulator::step_each(std::span<CharacterState *const> states, const PosedFrame &previous,
                                                        const PosedFrame &current,
                                                        std::span<const std::vector<pbd::Material> *const> materials,
                                                        double dt) const {
  if (states.size() != materials.size())
    throw std::invalid_argument("CharacterSimulator::step_each: " + std::to_string(states.size()) + " states and " +
                                std::to_string(materials.size()) + " lists of materials, expected equally many");
  for (std::size_t i = 0; i < states.size(); ++i)
    check_regions(*states[i], *materials[i], regions_.size());
  std::vector<FailedRegion> failed;
  std::vector<pbd::ClothState> cloth(states.size());
  std::vector<pbd::Material> material(states.size());
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const RegionInputs inputs(regions_[r], previous, current, dt);
    for (std::size_t i = 0; i < states.size(); ++i) {
      cloth[i] = std::move(states[i]->regions[r]);
      material[i] = (*materials[i])[r];
    }
    for (int i : regions_[r].solver->step_each(cloth, {&inputs.view, 1}, material))
      failed.push_back({i, static_cast<int>(r)});
    for (std::size_t i = 0; i < states.size(); ++i)
      states[i]->regions[r] = std::move(cloth[i]);
  }
  return failed;
}

Vertices CharacterSimulator::surface(const CharacterState &state, const PosedFrame &frame) const {
  if (state.regions.size() != regions_.size())
    throw std::invalid_argument("CharacterSimulator::surface: state has " + std::to_string(state.regions.size()) +
                                " cloth regions, the character " + std::to_string(regions_.size()));
  Vertices result = frame.skinned;
  if (result.rows() != actor_.mesh.vertices.rows())
    throw std::invalid_argument("CharacterSimulator::surface: the frame has " + std::to_string(result.rows()) +
                                " vertices, the character " + std::to_string(actor_.mesh.vertices.rows()));
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (state.regions[r].positions.rows() != static_cast<Eigen::Index>(regions_[r].vertex_from_cloth.size()))
      throw std::invalid_argument("CharacterSimulator::surface: region " + std::to_string(r) + " of the state has " +
                                  std::to_string(state.regions[r].positions.rows()) + " vertices, that of the character " +
                                  std::to_string(regions_[r].vertex_from_cloth.size()));
    for (std::size_t i = 0; i < regions_[r].vertex_from_cloth.size(); ++i)
      result.row(regions_[r].vertex_from_cloth[i]) = state.regions[r].positions.row(i);
  }
  return result;
}

} // namespace doublet
