#include "common.h"

#include "doublet/pbd/cloth_solver.h"

namespace doublet::python {
namespace {

using pbd::Capsule;
using pbd::ClothModel;
using pbd::ClothOptions;
using pbd::ClothSolver;
using pbd::ClothState;
using pbd::Material;
using pbd::StepInputs;

/// StepInputs with its arrays: C++ passes pointers, Python values.
struct OwnedInputs {
  Vertices targets, previous_targets;
  std::vector<Capsule> capsules, previous_capsules;
  double dt = 1.0 / 40.0;
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();

  StepInputs view() const {
    StepInputs inputs;
    if (targets.rows())
      inputs.targets = &targets;
    inputs.previous_targets = previous_targets.rows() ? &previous_targets : inputs.targets;
    inputs.capsules = &capsules;
    inputs.previous_capsules = previous_capsules.empty() ? &capsules : &previous_capsules;
    inputs.dt = dt;
    inputs.wind = wind;
    return inputs;
  }

  static OwnedInputs copy_of(const StepInputs &inputs) {
    OwnedInputs owned;
    if (inputs.targets)
      owned.targets = *inputs.targets;
    if (inputs.previous_targets)
      owned.previous_targets = *inputs.previous_targets;
    if (inputs.capsules)
      owned.capsules = *inputs.capsules;
    if (inputs.previous_capsules)
      owned.previous_capsules = *inputs.previous_capsules;
    owned.dt = inputs.dt;
    owned.wind = inputs.wind;
    return owned;
  }
};

class PyClothSolver : public ClothSolver {
public:
  explicit PyClothSolver(std::shared_ptr<const ClothModel> model) : model_(std::move(model)) {
    if (!model_)
      throw std::invalid_argument("ClothSolver: expected a ClothModel, found None");
  }
  const ClothModel &model() const override { return *model_; }
  void step(ClothState &state, const StepInputs &inputs, const Material &material) const override {
    const py::gil_scoped_acquire gil;
    const py::function override = py::get_override(static_cast<const ClothSolver *>(this), "step");
    if (!override)
      throw std::runtime_error("a ClothSolver must define step(state, inputs, material)");
    override(py::cast(&state, py::return_value_policy::reference), OwnedInputs::copy_of(inputs), material);
  }

private:
  std::shared_ptr<const ClothModel> model_;
};

/// States lie one behind the other in C++; Python holds each on its own.
std::vector<int> step_each(const ClothSolver &solver, const std::vector<ClothState *> &states,
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
  const std::vector<int> failed = solver.step_each(stepped, views, materials, threads);
  for (std::size_t i = 0; i < states.size(); ++i)
    *states[i] = std::move(stepped[i]);
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
}

void bind_state(py::module_ &m) {
  py::class_<Capsule>(m, "Capsule", "Tapered capsule in the world, m.")
      .def(py::init([](Eigen::Vector3d p0, Eigen::Vector3d p1, double r0, double r1) {
             return Capsule{p0, p1, r0, r1};
           }),
           py::arg("p0"), py::arg("p1"), py::arg("r0"), py::arg("r1"))
      .def_readwrite("p0", &Capsule::p0)
      .def_readwrite("p1", &Capsule::p1)
      .def_readwrite("r0", &Capsule::r0)
      .def_readwrite("r1", &Capsule::r1);
  py::class_<ClothState>(m, "ClothState", "Positions (N, 3) m and velocities (N, 3) m/s; copy() saves it.")
      .def(py::init(&pbd::initial_state), py::arg("positions"))
      // Through a plain reference, so that the arrays may be written to in place.
      .def_property(
          "positions", [](ClothState &state) -> Vertices & { return state.positions; },
          [](ClothState &state, const Vertices &positions) { state.positions = positions; })
      .def_property(
          "velocities", [](ClothState &state) -> Vertices & { return state.velocities; },
          [](ClothState &state, const Vertices &velocities) { state.velocities = velocities; })
      .def(
          "copy", [](const ClothState &state) { return state; }, "A state of its own.");
  py::class_<OwnedInputs>(m, "StepInputs", "What the world does during one frame.")
      .def(py::init([](Vertices targets, Vertices previous_targets, std::vector<Capsule> capsules,
                       std::vector<Capsule> previous_capsules, double dt, const Eigen::Vector3d &wind) {
             return OwnedInputs{
                 std::move(targets), std::move(previous_targets), std::move(capsules), std::move(previous_capsules), dt, wind};
           }),
           py::kw_only(), py::arg("targets") = Vertices(0, 3), py::arg("previous_targets") = Vertices(0, 3),
           py::arg("capsules") = std::vector<Capsule>{}, py::arg("previous_capsules") = std::vector<Capsule>{},
           py::arg("dt") = 1.0 / 40.0, py::arg("wind") = Eigen::Vector3d(0, 0, 0))
      .def_readwrite("targets", &OwnedInputs::targets)
      .def_readwrite("previous_targets", &OwnedInputs::previous_targets)
      .def_readwrite("capsules", &OwnedInputs::capsules)
      .def_readwrite("previous_capsules", &OwnedInputs::previous_capsules)
      .def_readwrite("dt", &OwnedInputs::dt, "s")
      .def_readwrite("wind", &OwnedInputs::wind, "m/s");
}

} // namespace

void bind_pbd(py::module_ &m) {
  bind_material(m);
  bind_state(m);
  OptionsClass<ClothOptions>(m, "Settings of the cloth solver.");
  py::class_<ClothModel, std::shared_ptr<ClothModel>>(m, "ClothModel", "Topology and rest state of a piece of cloth; immutable.")
      .def(py::init([](const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options,
                       const Eigen::VectorXd &fullness) {
             return std::const_pointer_cast<ClothModel>(ClothModel::create(rest, faces, clothness, options, fullness));
           }),
           py::arg("rest"), py::arg("faces"), py::arg("clothness"), py::arg("options") = ClothOptions{},
           py::arg("fullness") = Eigen::VectorXd(), Release())
      .def_property_readonly("vertex_count", &ClothModel::vertex_count)
      .def_property_readonly("options", &ClothModel::options)
      .def_property_readonly("inverse_masses", &ClothModel::inverse_masses);
  py::class_<ClothSolver, PyClothSolver, std::shared_ptr<ClothSolver>>(m, "ClothSolver",
                                                                       "Advances a state by a frame. Subclass to replace it.")
      .def(py::init([](std::shared_ptr<ClothModel> model) { return new PyClothSolver(std::move(model)); }), py::arg("model"))
      .def_static(
          "create",
          [](std::shared_ptr<ClothModel> model) { return std::shared_ptr<ClothSolver>(ClothSolver::create(std::move(model))); },
          py::arg("model"), "The built-in solver.")
      .def_property_readonly("model", &ClothSolver::model)
      .def(
          "step",
          [](const ClothSolver &solver, ClothState &state, const OwnedInputs &inputs, const Material &material) {
            solver.step(state, inputs.view(), material);
          },
          py::arg("state"), py::arg("inputs"), py::arg("material"), Release(), "Advances the state by one frame.")
      .def(
          "step_each", &step_each, py::arg("states"), py::arg("inputs"), py::arg("materials"), py::arg("threads") = 1, Release(),
          "step() for several simulations side by side in the lanes of a register, with the same bits: states[i] with inputs[i], "
          "or inputs[0] if there is but one, and materials[i]. Returns the indices of those that came out not finite and were "
          "left as they were.");
}

} // namespace doublet::python
