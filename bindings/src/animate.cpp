#include "common.h"

#include "doublet/animate/character_simulator.h"

namespace doublet::python {
namespace {

void bind_simulator(py::module_ &m) {
  py::class_<PosedFrame>(m, "PosedFrame", "A pose worked out once: skinned surface and proxies.")
      .def_readonly("skinned", &PosedFrame::skinned, "(V, 3) m")
      .def_readonly("capsules", &PosedFrame::capsules);
  py::class_<CharacterState>(m, "CharacterState", "Simulated state of all cloth regions; copy() saves it.")
      .def_readwrite("regions", &CharacterState::regions)
      .def("copy", [](const CharacterState &state) { return state; });
  py::class_<CharacterSimulator>(m, "CharacterSimulator", "The forward model: pose in, surface out.")
      .def(py::init<const RiggedMesh &, const Clothness &, const std::vector<TaperedCapsule> &, const pbd::ClothOptions &>(),
           py::arg("actor"), py::arg("clothness"), py::arg("proxies"), py::arg("options") = pbd::ClothOptions{}, Release())
      .def_property_readonly("region_count", [](const CharacterSimulator &s) { return s.regions().size(); })
      .def_property_readonly("actor", &CharacterSimulator::actor)
      .def("pose", &CharacterSimulator::pose, py::arg("dofs"), Release())
      .def(
          "start",
          [](const CharacterSimulator &simulator, const PosedFrame &frame, const std::optional<Vertices> &surface) {
            return simulator.start(frame, surface ? &*surface : nullptr);
          },
          py::arg("frame"), py::arg("surface") = std::nullopt, Release())
      .def("settle", &CharacterSimulator::settle, py::arg("state"), py::arg("frame"), py::arg("materials"), py::arg("dt"),
           py::arg("frames"), Release())
      .def("step", &CharacterSimulator::step, py::arg("state"), py::arg("previous"), py::arg("current"), py::arg("materials"),
           py::arg("dt"), Release())
      .def("surface", &CharacterSimulator::surface, py::arg("state"), py::arg("frame"), Release(), "(V, 3) m");
}

} // namespace

void bind_animate(py::module_ &m) {
  bind_simulator(m);
}

} // namespace doublet::python
