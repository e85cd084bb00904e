#include "cloth.h"

#include "doublet/simulate/character_simulator.h"
#include "doublet/simulate/solver_settings.h"

namespace doublet::python {
void bind_simulate(py::module_ &m) {
  OptionsClass<SolverSettings>(m, "Settings with which the cloth was simulated when its material was estimated.")
      .get()
      .def(py::init([](double dt, const pbd::ClothOptions &cloth) {
             return SolverSettings{dt, cloth};
           }),
           py::arg("dt"), py::arg("cloth") = pbd::ClothOptions{});
  Class<PosedFrame>(m, "PosedFrame", "A posed character without cloth simulation: skinned surface and proxies.")
      .def_readonly("skinned", &PosedFrame::skinned, "(V, 3) m")
      .def_readonly("capsules", &PosedFrame::capsules, "proxies in the pose");
  Class<CharacterState>(m, "CharacterState", "Simulated state of all cloth regions; copy() saves it.")
      .def_readwrite("regions", &CharacterState::regions, "ClothState of each cloth region")
      .def(
          "copy", [](const CharacterState &state) { return state; }, "An independent copy.");
  Class<ClothRegion>(
      m, "ClothRegion",
      "One piece of cloth: the faces with a vertex of the region, including the rigid vertices that it is attached to.")
      .def_readonly("vertex_from_cloth", &ClothRegion::vertex_from_cloth, "(N) index into the actor's vertices")
      .def_property_readonly(
          "model", [](const ClothRegion &region) { return std::const_pointer_cast<pbd::ClothModel>(region.model); },
          "ClothModel");
  Class<CharacterSimulator>(m, "CharacterSimulator", "The forward model: pose in, surface out.")
      .def(py::init([](const RiggedMesh &actor, const Segmentation &segmentation, const std::vector<TaperedCapsule> &proxies,
                       const pbd::ClothOptions &options, const SolverMaker &make_solver) {
             const pbd::ClothSolverFactory make = solver_factory(make_solver);
             const py::gil_scoped_release release;
             return std::make_unique<CharacterSimulator>(actor, segmentation, proxies, options, make);
           }),
           py::arg("actor"), py::arg("segmentation"), py::arg("proxies"), py::arg("options") = pbd::ClothOptions{},
           py::arg("make_solver") = py::none(),
           "make_solver(ClothModel) -> ClothSolver, of each cloth region; None = the built-in one.")
      .def_property_readonly(
          "region_count", [](const CharacterSimulator &s) { return s.regions().size(); }, "cloth regions")
      .def_property_readonly("regions", &CharacterSimulator::regions, "ClothRegion of each")
      .def_property_readonly("actor", &CharacterSimulator::actor, "RiggedMesh that is simulated")
      .def("pose", py::overload_cast<const Eigen::VectorXd &>(&CharacterSimulator::pose, py::const_), py::arg("dofs"), Release(),
           "The PosedFrame of a pose (D).")
      .def(
          "start",
          [](const CharacterSimulator &simulator, const PosedFrame &frame, const std::optional<Vertices> &surface) {
            return simulator.start(frame, surface ? &*surface : nullptr);
          },
          py::arg("frame"), py::arg("surface") = std::nullopt, Release(),
          "Cloth with velocity 0: at `surface` (V, 3) m if given, else at its skinned rest shape or skinned position.")
      .def("settle", &CharacterSimulator::settle, py::arg("state"), py::arg("frame"), py::arg("materials"), py::arg("dt"),
           py::arg("frames"), Release(),
           "Lets the cloth fall into place in a still pose for so many frames, then takes its velocity.")
      .def(
          "step",
          py::overload_cast<CharacterState &, const PosedFrame &, const PosedFrame &, const std::vector<pbd::Material> &, double>(
              &CharacterSimulator::step, py::const_),
          py::arg("state"), py::arg("previous"), py::arg("current"), py::arg("materials"), py::arg("dt"), Release(),
          "Advances every cloth region from one posed frame to the next; materials: one per region.")
      .def(
          "step_batch",
          [](const CharacterSimulator &simulator, const std::vector<CharacterState *> &states, const PosedFrame &previous,
             const PosedFrame &current, const std::vector<std::vector<pbd::Material>> &materials, double dt) {
            std::vector<const std::vector<pbd::Material> *> lists;
            for (const std::vector<pbd::Material> &list : materials)
              lists.push_back(&list);
            std::vector<std::pair<int, int>> failed;
            for (const DivergedRegion &one :
                 simulator.step_batch(require_objects(states, "states"), previous, current, lists, dt))
              failed.emplace_back(one.character, one.region);
            return failed;
          },
          py::arg("states"), py::arg("previous"), py::arg("current"), py::arg("materials"), py::arg("dt"), Release(),
          "step() for several states side by side in the lanes of SIMD registers, with the same bits; materials[i]: one per "
          "region of states[i]. Returns pairs (index of the state, region) of regions that are not finite after the step; their "
          "states are unchanged.")
      .def("surface", py::overload_cast<const CharacterState &, const PosedFrame &>(&CharacterSimulator::surface, py::const_),
           py::arg("state"), py::arg("frame"), Release(), "(V, 3) m");
}

} // namespace doublet::python
