#include "common.h"

#include "doublet/animate/animator.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/retarget.h"
#include "doublet/animate/surface_transfer.h"

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

void bind_character(py::module_ &m) {
  py::class_<SolverSettings>(m, "SolverSettings", "How the cloth was simulated when its material was estimated.")
      .def(py::init([](double dt, const pbd::ClothOptions &cloth) {
             return SolverSettings{dt, cloth};
           }),
           py::arg("dt") = 1.0 / 40.0, py::arg("cloth") = pbd::ClothOptions{})
      .def_readwrite("dt", &SolverSettings::dt, "s, one frame")
      .def_readwrite("cloth", &SolverSettings::cloth);
  py::class_<Character>(m, "Character", "The animatable character: everything that a new animation needs (character.glb).")
      .def_static("read", &read_character, py::arg("path"), Release())
      .def(
          "write", [](const Character &character, const std::filesystem::path &path) { write_character(path, character); },
          py::arg("path"), Release())
      .def_readwrite("name", &Character::name)
      .def_readwrite("actor", &Character::actor)
      .def_readwrite("clothness", &Character::clothness)
      .def_readwrite("proxies", &Character::proxies)
      .def_readwrite("materials", &Character::materials)
      .def_readwrite("solver", &Character::solver)
      .def_readwrite("body", &Character::body)
      .def_readwrite("body_shown", &Character::body_shown, "(FB) 1 = hidden under cloth in the scan, must be drawn")
      .def_readwrite("body_colour", &Character::body_colour, "linear RGB in [0, 1]")
      .def_readwrite("high", &Character::high)
      .def_readwrite("high_valid", &Character::high_valid)
      .def_readwrite("texcoords", &Character::texcoords, "(3 FH, 2) per corner of `high`")
      .def_property_readonly("texture", [](const Character &character) {
        return py::bytes(reinterpret_cast<const char *>(character.texture.data()), character.texture.size());
      });
  m.def("make_character", &make_character, py::arg("actor"), py::arg("clothness"), py::arg("body"), py::arg("proxies"),
        py::arg("materials"), py::arg("solver"), py::arg("high") = Mesh{}, py::arg("high_valid") = std::vector<std::uint8_t>{},
        Release());
}

void bind_motion(py::module_ &m) {
  py::class_<Motion>(m, "Motion", "Poses of a character's skeleton at a constant rate.")
      .def(py::init([](double fps, MatrixRM dofs) {
             return Motion{fps, std::move(dofs)};
           }),
           py::arg("fps"), py::arg("dofs"))
      .def_readwrite("fps", &Motion::fps)
      .def_readwrite("dofs", &Motion::dofs, "(T, D) rad and m")
      .def("__len__", [](const Motion &motion) { return motion.dofs.rows(); });
  py::class_<SourceMotion>(m, "SourceMotion", "A motion capture clip on its own skeleton.")
      .def_static(
          "read",
          [](const std::filesystem::path &path, const std::optional<std::filesystem::path> &skeleton) {
            return read_motion_file(path, skeleton.value_or(std::filesystem::path()));
          },
          py::arg("path"), py::arg("skeleton") = std::nullopt, Release(), ".bvh or .amc; skeleton: the .asf of an .amc")
      .def_readonly("source", &SourceMotion::source)
      .def_readonly("fps", &SourceMotion::fps)
      .def_property_readonly("frame_count", &SourceMotion::frame_count)
      .def_property_readonly("joint_names",
                             [](const SourceMotion &motion) {
                               std::vector<std::string> names;
                               for (const SourceJoint &joint : motion.joints)
                                 names.push_back(joint.name);
                               return names;
                             })
      .def_property_readonly(
          "positions", [](const SourceMotion &motion) { return stack(motion.positions); }, "(T, J, 3) world, file units; a copy");
  OptionsClass<RetargetOptions>(m, "RetargetOptions", "Options of retarget.")
      .field("fps", &RetargetOptions::fps, "1/s, of the result; 0 = that of the file")
      .field("first_second", &RetargetOptions::first_second, "s, where in the file to start")
      .field("last_second", &RetargetOptions::last_second, "s, where to stop")
      .field("align_start", &RetargetOptions::align_start, "start where the actor stands in the rest pose")
      .field("apply_limits", &RetargetOptions::apply_limits, "keep joints inside the skeleton's limits")
      .field("ground_feet", &RetargetOptions::ground_feet, "one height for the whole clip so that the feet reach the floor")
      .field("hold_seconds", &RetargetOptions::hold_seconds, "s, in the rest pose before the motion")
      .field("blend_seconds", &RetargetOptions::blend_seconds, "s, from the rest pose to the first pose")
      .get()
      .def_readwrite("joint_names", &RetargetOptions::joint_names, "our joint -> joint of the file");
  m.def("retarget", &retarget, py::arg("clip"), py::arg("skeleton"), py::arg("options") = RetargetOptions{},
        py::arg("context") = interruptible_context(), Release());
}

void bind_animator(py::module_ &m) {
  OptionsClass<AnimateOptions>(m, "AnimateOptions", "Options of animate.")
      .field("settle_seconds", &AnimateOptions::settle_seconds, "s, the cloth falls into place before the animation starts")
      .field("high", &AnimateOptions::high, "also the display mesh")
      .field("body", &AnimateOptions::body, "also the body under the clothes");
  py::class_<AnimationResult>(m, "AnimationResult", "An animation in memory; arrays are copies.")
      .def_readonly("fps", &AnimationResult::fps)
      .def_readonly("dofs", &AnimationResult::dofs, "(T, D)")
      .def_property_readonly(
          "surface", [](const AnimationResult &r) { return stack(r.surface); }, "(T, V, 3) m")
      .def_property_readonly(
          "joints", [](const AnimationResult &r) { return stack(r.joints); }, "(T, J, 3) m")
      .def_property_readonly(
          "high", [](const AnimationResult &r) { return stack(r.high); }, "(T, VH, 3) m")
      .def_property_readonly(
          "body", [](const AnimationResult &r) { return stack(r.body); }, "(T, B, 3) m");
  m.def(
      "animate",
      [](const Character &character, const Motion &motion, const AnimateOptions &options, const Context &context) {
        return animate(character, motion, options, context);
      },
      py::arg("character"), py::arg("motion"), py::arg("options") = AnimateOptions{},
      py::arg("context") = interruptible_context(), Release());
}

} // namespace

void bind_animate(py::module_ &m) {
  bind_simulator(m);
  bind_character(m);
  bind_motion(m);
  bind_animator(m);
}

} // namespace doublet::python
