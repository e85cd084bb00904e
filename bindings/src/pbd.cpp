#include "cloth.h"
#include "doublet/testing/cloth_solver_conformance.h"

#include <set>

namespace doublet::python {
namespace {

using pbd::ClothModel;
using pbd::ClothOptions;
using pbd::ClothSolver;
using pbd::ClothState;
using pbd::Material;
using pbd::StepInputs;

/// StepInputs with its arrays: C++ passes views, Python values.
struct OwnedInputs {
  Vertices targets, previous_targets;
  std::vector<Capsule> capsules, previous_capsules;
  double dt = 1.0 / 40.0;
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> gravity;
  int substeps = 0;

  StepInputs view() const { return {targets, previous_targets, capsules, previous_capsules, dt, wind, gravity, substeps}; }
  /// An override in Python need not know that nothing was given at the start of a frame.
  static OwnedInputs copy_of(const StepInputs &in) {
    const VerticesView first = in.previous_targets.empty() ? in.targets : in.previous_targets;
    const std::span<const Capsule> before = in.previous_capsules.empty() ? in.capsules : in.previous_capsules;
    return {
        in.targets.map(), first.map(), {in.capsules.begin(), in.capsules.end()}, {before.begin(), before.end()}, in.dt, in.wind,
        in.gravity,       in.substeps};
  }
};

class PyClothSolver : public ClothSolver {
public:
  using ClothSolver::ClothSolver;

private:
  /// Python gets states of its own, which it may keep; what comes back finite is taken over.
  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int threads) const override {
    const py::gil_scoped_acquire gil;
    py::list own_states, own_inputs, own_materials;
    py::object shared;
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (i < inputs.size())
        shared = py::cast(OwnedInputs::copy_of(inputs[i]));
      own_states.append(py::cast(states[i]));
      own_inputs.append(shared);
      own_materials.append(py::cast(materials[i]));
    }
    const auto named = call_override<std::optional<std::vector<int>>>(
        static_cast<const ClothSolver *>(this), "ClothSolver.advance", "indices of simulations that are not finite, or None",
        own_states, own_inputs, own_materials, threads);
    std::set<int> failed(named ? std::set<int>(named->begin(), named->end()) : std::set<int>());
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto &state = own_states[i].cast<const ClothState &>();
      if (!state.positions.allFinite() || !state.velocities.allFinite())
        failed.insert(static_cast<int>(i));
      else if (!failed.contains(static_cast<int>(i)))
        states[i] = state;
    }
    return {failed.begin(), failed.end()};
  }
};

/// States lie one behind the other in C++; Python holds each on its own.
std::vector<int> step_batch(const ClothSolver &solver, const std::vector<ClothState *> &states,
                            const std::vector<OwnedInputs> &inputs, const std::vector<Material> &materials, int threads) {
  std::vector<ClothState> stepped;
  for (const ClothState *state : states) {
    if (!state)
      throw py::type_error("states: expected ClothState objects, found None");
    stepped.push_back(*state);
  }
  std::vector<StepInputs> views;
  for (const OwnedInputs &one : inputs)
    views.push_back(one.view());
  const std::vector<int> failed = solver.step_batch(stepped, views, materials, threads);
  for (std::size_t i = 0; i < states.size(); ++i)
    *states[i] = stepped[i]; // copied, to where NumPy may look
  return failed;
}

void bind_material(py::module_ &m) {
  OptionsClass<Material>(m, "Material of a piece of cloth; see Material.described() for units and ranges.")
      .get()
      .def_static(
          "boxes",
          [] {
            py::dict result;
            for (const auto &parameter : pbd::material_parameters())
              result[parameter.name] = py::make_tuple(parameter.lower, parameter.upper);
            return result;
          },
          "Name -> (lower, upper) of every parameter.");
  m.def("spring_constant", &pbd::spring_constant, py::arg("k"), py::arg("response"),
        "The physical spring constant of k_stretch (N/m) or k_bend (N m) with 'compliance': k / ((1 - k) (1/40 s)^2 response); "
        "infinite for k = 1. response: the sum of |grad C|^2 / mass over the vertices of a constraint C: for an edge 1 / m_a + 1 "
        "/ m_b, 1/kg; for a hinge, whose C is its angle, in 1/(kg m^2). The masses of a ClothModel are areas, m^2: multiply them "
        "by the areal density, kg/m^2.");
  m.def("stiffness_of_spring", &pbd::stiffness_of_spring, py::arg("constant"), py::arg("response"),
        "The inverse of spring_constant(): the stiffness k.");
}

/// Never in another size: NumPy may hold a view of the old values.
void replace(Vertices &values, const Vertices &with, const char *name) {
  if (values.rows() != with.rows())
    throw std::invalid_argument(std::string("ClothState.") + name + " must have " + std::to_string(values.rows()) +
                                " rows, found " + std::to_string(with.rows()));
  values = with;
}

void bind_state(py::module_ &m) {
  Class<Capsule>(m, "Capsule", "Tapered capsule in the world, m.")
      .def(py::init([](Eigen::Vector3d p0, Eigen::Vector3d p1, double r0, double r1) {
             return Capsule{p0, p1, r0, r1};
           }),
           py::arg("p0"), py::arg("p1"), py::arg("r0"), py::arg("r1"))
      .def_readwrite("p0", &Capsule::p0, "(3) m, one end of the axis")
      .def_readwrite("p1", &Capsule::p1, "(3) m, the other end")
      .def_readwrite("r0", &Capsule::r0, "m, radius at p0")
      .def_readwrite("r1", &Capsule::r1, "m, radius at p1");
  Class<ClothState>(m, "ClothState", "Positions (N, 3) m and velocities (N, 3) m/s; copy() saves it.")
      .def(py::init(&pbd::initial_state), py::arg("positions"))
      // Through a plain reference, so that the arrays may be written to in place.
      .def_property(
          "positions", [](ClothState &state) -> Vertices & { return state.positions; },
          [](ClothState &state, const Vertices &positions) { replace(state.positions, positions, "positions"); }, "(N, 3) m")
      .def_property(
          "velocities", [](ClothState &state) -> Vertices & { return state.velocities; },
          [](ClothState &state, const Vertices &velocities) { replace(state.velocities, velocities, "velocities"); },
          "(N, 3) m/s")
      .def(
          "copy", [](const ClothState &state) { return state; }, "An independent copy.");
  Class<OwnedInputs>(m, "StepInputs", "Inputs of one frame.")
      .def(py::init([](Vertices targets, Vertices previous_targets, std::vector<Capsule> capsules,
                       std::vector<Capsule> previous_capsules, double dt, const Eigen::Vector3d &wind,
                       const std::optional<Eigen::Vector3d> &gravity, int substeps) {
             return OwnedInputs{std::move(targets),
                                std::move(previous_targets),
                                std::move(capsules),
                                std::move(previous_capsules),
                                dt,
                                wind,
                                gravity,
                                substeps};
           }),
           py::kw_only(), py::arg("targets") = Vertices(0, 3), py::arg("previous_targets") = Vertices(0, 3),
           py::arg("capsules") = std::vector<Capsule>{}, py::arg("previous_capsules") = std::vector<Capsule>{},
           py::arg("dt") = 1.0 / 40.0, py::arg("wind") = Eigen::Vector3d(0, 0, 0), py::arg("gravity") = std::nullopt,
           py::arg("substeps") = 0)
      .def_readwrite("targets", &OwnedInputs::targets,
                     "(N, 3) m, skinned positions at the end of the frame; empty if no vertex follows them")
      .def_readwrite("previous_targets", &OwnedInputs::previous_targets, "(N, 3) m, at its start; empty = they stand still")
      .def_readwrite("capsules", &OwnedInputs::capsules, "proxies at the end of the frame")
      .def_readwrite("previous_capsules", &OwnedInputs::previous_capsules,
                     "proxies at its start, in the same order; empty = they stand still")
      .def_readwrite("dt", &OwnedInputs::dt, "s")
      .def_readwrite("wind", &OwnedInputs::wind, "m/s")
      .def_readwrite("gravity", &OwnedInputs::gravity, "m/s^2; None = the model's")
      .def_readwrite("substeps", &OwnedInputs::substeps, "number of substeps of the frame; 0 = the model's");
}

} // namespace

void bind_pbd(py::module_ &m) {
  bind_material(m);
  bind_state(m);
  OptionsClass<ClothOptions>(m, "Settings of the cloth solver.");
  Class<ClothModel, std::shared_ptr<ClothModel>>(m, "ClothModel",
                                                 "The immutable data of a piece of cloth; its arrays are read-only.")
      .def(py::init([](const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options) {
             return std::const_pointer_cast<ClothModel>(ClothModel::create(rest, faces, clothness, options));
           }),
           py::arg("rest"), py::arg("faces"), py::arg("clothness"), py::arg("options") = ClothOptions{}, Release())
      .def_property_readonly("vertex_count", &ClothModel::vertex_count, "N")
      .def_property_readonly("rest", &ClothModel::rest, "(N, 3) m: defines rest lengths and angles")
      .def_property_readonly("faces", &ClothModel::faces, "(F, 3)")
      .def_property_readonly("clothness", &ClothModel::clothness, "(N) in [0, 1]: 0 = follows its target, 1 = free")
      .def_property_readonly(
          "options", [](const ClothModel &model) { return model.options(); }, "A copy.")
      .def_property_readonly("inverse_masses", &ClothModel::inverse_masses, "(N) 1/m^2, 0 = pinned");
  Class<ClothSolver, PyClothSolver, std::shared_ptr<ClothSolver>>(
      m, "ClothSolver",
      "Advances simulations of one model by a frame. To replace it, define advance(states, inputs, materials, threads) in a "
      "subclass: it gets one of each per simulation, checked, changes the states in place, and may return the indices of those "
      "that are not finite after the step. Their states are restored.")
      .def(py::init_alias<std::shared_ptr<ClothModel>>(), py::arg("model"))
      .def_static(
          "create",
          [](std::shared_ptr<ClothModel> model) { return std::shared_ptr<ClothSolver>(ClothSolver::create(std::move(model))); },
          py::arg("model"), "The built-in solver.")
      .def_property_readonly("model", &ClothSolver::model, "ClothModel that it was made for")
      .def(
          "advance",
          [](const ClothSolver &, const std::vector<ClothState *> &, const std::vector<OwnedInputs> &,
             const std::vector<Material> &, int) -> std::optional<std::vector<int>> {
            throw std::logic_error("ClothSolver.advance is for subclasses to define; call step_batch");
          },
          py::arg("states"), py::arg("inputs"), py::arg("materials"), py::arg("threads"),
          "Defined by subclasses and called by step_batch: changes the states in place; returns the indices of those that are "
          "not finite after the step, or None.")
      .def(
          "step",
          [](const ClothSolver &solver, ClothState &state, const OwnedInputs &inputs, const Material &material) {
            solver.step(state, inputs.view(), material);
          },
          py::arg("state"), py::arg("inputs"), py::arg("material"), Release(), "Advances the state by one frame.")
      .def("step_batch", &step_batch, py::arg("states"), py::arg("inputs"), py::arg("materials"), py::arg("threads") = 1,
           Release(),
           "step() for several simulations side by side in the lanes of SIMD registers, with the same bits: states[i] with "
           "inputs[i], or inputs[0] if there is only one, and materials[i]. Returns the indices of simulations that are not "
           "finite after the step; their states are unchanged.");
  m.def(
      "cloth_solver_violations",
      [](const SolverMaker &make_solver) {
        const pbd::ClothSolverFactory make = solver_factory(make_solver);
        const py::gil_scoped_release release;
        return testing::cloth_solver_violations(make);
      },
      py::arg("make_solver"),
      "One sentence for each rule that the solvers of make_solver(model) (None = ours) break: the rest state rests, cloth falls, "
      "pinned vertices obey, a copied state replays, other simulations and threads change nothing, the corners of the material "
      "box stay finite, wrong input is refused.");
}

pbd::ClothSolverFactory solver_factory(const py::object &make) {
  const auto made = factory_from<ClothSolver, std::shared_ptr<ClothModel>>(make, "make_solver must return a ClothSolver");
  if (!made)
    return &ClothSolver::create;
  return [made](std::shared_ptr<const ClothModel> model) { return made(std::const_pointer_cast<ClothModel>(std::move(model))); };
}

} // namespace doublet::python
