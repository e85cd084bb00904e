#include "cloth.h"

#include "doublet/animate/animator.h"
#include "doublet/animate/baked_file.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/level_of_detail.h"
#include "doublet/animate/parts/arm_penetration.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/animate/plant_feet.h"
#include "doublet/animate/renderer.h"
#include "doublet/animate/retarget.h"
#include "doublet/animate/surface_transfer.h"
#include "doublet/animate/texture_baker.h"

#include <algorithm>
#include <pybind11/typing.h>

namespace doublet::python {
namespace {

/// (T, V, 3), stacked at the first access and kept with the result: the display mesh of a clip is hundreds of megabytes. It
/// cannot be written to: no file would have what one wrote.
py::object stacked_once(const py::object &self, const char *key, const std::vector<Vertices> &frames) {
  if (!py::hasattr(self, key)) {
    const py::array_t<double> array = stack(frames);
    array.attr("flags").attr("writeable") = false;
    py::setattr(self, key, array);
  }
  return self.attr(key);
}

SourceMotion source_motion(const std::vector<std::string> &names, const std::vector<int> &parents, const Vertices &offsets,
                           const py::array_t<double, py::array::c_style | py::array::forcecast> &positions,
                           const py::array_t<double, py::array::c_style | py::array::forcecast> &rotations, double fps,
                           const std::string &source, const Eigen::Vector3d &up) {
  const std::size_t joints = names.size();
  if (parents.size() != joints || offsets.rows() != static_cast<Eigen::Index>(joints))
    throw std::invalid_argument("SourceMotion: expected a parent and an offset for each of " + std::to_string(joints) +
                                " joints, found " + std::to_string(parents.size()) + " and " + std::to_string(offsets.rows()));
  if (rotations.ndim() != 3 || rotations.shape(1) != static_cast<py::ssize_t>(joints) || rotations.shape(2) != 4)
    throw std::invalid_argument("SourceMotion: rotations: expected the shape (frames, " + std::to_string(joints) +
                                ", 4), found " + std::string(py::str(rotations.attr("shape"))));
  SourceMotion motion;
  motion.source = source;
  motion.fps = fps;
  motion.up = up;
  for (std::size_t j = 0; j < joints; ++j)
    motion.joints.push_back({names[j], parents[j], offsets.row(static_cast<Eigen::Index>(j))});
  motion.positions = unstack(positions, "positions");
  const auto wxyz = rotations.unchecked<3>();
  for (py::ssize_t t = 0; t < rotations.shape(0); ++t) {
    motion.rotations.emplace_back();
    for (py::ssize_t j = 0; j < rotations.shape(1); ++j)
      motion.rotations.back().emplace_back(wxyz(t, j, 0), wxyz(t, j, 1), wxyz(t, j, 2), wxyz(t, j, 3));
  }
  validate(motion);
  return motion;
}

py::array_t<double> as_quaternions(const SourceMotion &motion) {
  py::array_t<double> result({py::ssize_t(motion.frame_count()), py::ssize_t(motion.joints.size()), py::ssize_t(4)});
  auto out = result.mutable_unchecked<3>();
  for (py::ssize_t t = 0; t < out.shape(0); ++t)
    for (py::ssize_t j = 0; j < out.shape(1); ++j) {
      const Eigen::Quaterniond &q = motion.rotations[t][j];
      out(t, j, 0) = q.w();
      out(t, j, 1) = q.x();
      out(t, j, 2) = q.y();
      out(t, j, 3) = q.z();
    }
  return result;
}

void bind_character(py::module_ &m) {
  Class<Character>(m, "Character", "The animatable character: everything that a new animation needs (character.glb).")
      .def_copies()
      .def("__repr__",
           [](const Character &character) {
             return py::str("Character({!r}, {} vertices, {} joints, {} materials)")
                 .format(character.name, character.actor.mesh.vertices.rows(), character.actor.skeleton.joints.size(),
                         character.materials.size());
           })
      .def_static("read", &read_character, py::arg("path"), Release(),
                  "character.glb. Raises FileNotFoundError, or Error naming the file; other files are never followed.")
      .def(
          "write", [](const Character &character, const std::filesystem::path &path) { write_character(path, character); },
          py::arg("path"), Release(), "Writes character.glb atomically.")
      .def_readwrite("name", &Character::name, "of the character")
      .def_readwrite("actor", &Character::actor, "RiggedMesh: surface, skeleton, skin weights")
      .def_readwrite("segmentation", &Character::segmentation, "which of its vertices are cloth")
      .def_readwrite("proxies", &Character::proxies, "TaperedCapsules that the cloth collides with")
      .def_readwrite("materials", &Character::materials, "one per cloth region")
      .def_readwrite("solver", &Character::solver, "SolverSettings for which the materials are valid")
      .def_readwrite("body", &Character::body, "the body under the clothes, scan pose; may be empty")
      .def_readwrite("body_shown", &Character::body_shown, "(FB) 1 = hidden under cloth in the scan, must be drawn")
      .def_readwrite("high_body", &Character::high_body,
                     "indices into `body` of the last vertices of M_high's skin, if the hidden body is welded to it; empty = the "
                     "hidden body is drawn as a separate mesh")
      .def_readwrite("body_colour", &Character::body_colour, "linear RGB in [0, 1]")
      .def_readwrite("high", &Character::high, "M_high, the display surface, scan pose; may be empty: then M is displayed")
      .def_readwrite("high_valid", &Character::high_valid, "(FH) 0 = a face of M_high that is not drawn")
      .def_readwrite("garment_subdivisions", &Character::garment_subdivisions, "of the garment in `high`; -1 = none is")
      .def_readwrite("texcoords", &Character::texcoords, "(3 FH, 2) per corner of `high`")
      .def_property(
          "texture",
          [](const Character &character) {
            return py::bytes(reinterpret_cast<const char *>(character.texture.data()), character.texture.size());
          },
          [](Character &character, const py::bytes &file) {
            const std::string_view content = file;
            character.texture.assign(content.begin(), content.end());
          },
          "a PNG or JPEG file as bytes; empty = none");
  m.def("make_character", &make_character, py::arg("actor"), py::arg("segmentation"), py::arg("body"), py::arg("proxies"),
        py::arg("materials"), py::arg("solver"), py::arg("high") = Mesh{}, py::arg_v("high_valid", Mask{}, "[]"),
        py::arg("garment_subdivisions") = -1, Release(),
        "Assembles a Character: computes the skin weights of the body, which is drawn where cloth hides it in the scan.");
}

void bind_motion(py::module_ &m) {
  Class<Motion>(m, "Motion", "Poses of a character's skeleton at a constant rate.")
      .def_copies()
      .def("__repr__",
           [](const Motion &motion) {
             return py::str("Motion({} frames at {:.6g} fps, {} degrees of freedom)")
                 .format(motion.dofs.rows(), motion.fps, motion.dofs.cols());
           })
      .def(py::init([](double fps, MatrixRM dofs) {
             return Motion{fps, std::move(dofs)};
           }),
           py::arg("fps"), py::arg("dofs"))
      .def_readwrite("fps", &Motion::fps, "frames a second")
      .def_readwrite("dofs", &Motion::dofs, "(T, D) rad and m")
      .def("__len__", [](const Motion &motion) { return motion.dofs.rows(); });
  Class<SourceMotion>(m, "SourceMotion", "A motion capture clip on its own skeleton.")
      .def_copies()
      .def("__repr__",
           [](const SourceMotion &clip) {
             return py::str("SourceMotion({!r}, {} joints, {} frames at {:.6g} fps)")
                 .format(clip.source, clip.joints.size(), clip.frame_count(), clip.fps);
           })
      .def_static(
          "read",
          [](const std::filesystem::path &path, const std::optional<std::filesystem::path> &skeleton,
             const std::string &animation) {
            return read_motion_file(path, skeleton.value_or(std::filesystem::path()), animation);
          },
          py::arg("path"), py::arg("skeleton") = std::nullopt, py::arg("animation") = "", Release(),
          ".bvh, .amc, .fbx or .glb; skeleton: the .asf of an .amc; animation: of a .glb or .fbx, by name or number from 1, "
          "'' = the first that moves the body")
      .def(py::init(&source_motion), py::arg("joint_names"), py::arg("joint_parents"), py::arg("offsets"), py::arg("positions"),
           py::arg("rotations"), py::arg("fps"), py::arg("source") = "arrays", py::arg("up") = Eigen::Vector3d::Zero().eval(),
           "From arrays, parents before children (-1 = root): offsets (J, 3) from the parent in the zero pose, positions (T, J, "
           "3) in the world, rotations (T, J, 4) in the world, relative to the zero pose, unit quaternions w x y z. Any unit of "
           "length. up: the axis of the world that usually points up in such clips; 0 = unknown.")
      .def_readonly("source", &SourceMotion::source, "file name, for messages")
      .def_readonly("animations", &SourceMotion::animations,
                    "names of all animations in the file, if the format can have several (.glb, .fbx)")
      .def_readonly("animation", &SourceMotion::animation, "index of this one in `animations`")
      .def_readonly("fps", &SourceMotion::fps, "frames a second")
      .def_readonly("up", &SourceMotion::up, "up axis of the world if the format defines one; 0 = unknown")
      .def_property_readonly("frame_count", &SourceMotion::frame_count, "T")
      .def_property_readonly(
          "joint_names",
          [](const SourceMotion &motion) {
            std::vector<std::string> names;
            for (const SourceJoint &joint : motion.joints)
              names.push_back(joint.name);
            return names;
          },
          "(J) as in the file")
      .def_property_readonly(
          "joint_parents",
          [](const SourceMotion &motion) {
            Eigen::VectorXi parents(static_cast<Eigen::Index>(motion.joints.size()));
            for (Eigen::Index j = 0; j < parents.size(); ++j)
              parents[j] = motion.joints[static_cast<std::size_t>(j)].parent;
            return parents;
          },
          "(J) indices, -1 = none")
      .def_property_readonly(
          "offsets",
          [](const SourceMotion &motion) {
            Vertices offsets(motion.joints.size(), 3);
            for (std::size_t j = 0; j < motion.joints.size(); ++j)
              offsets.row(static_cast<Eigen::Index>(j)) = motion.joints[j].offset;
            return offsets;
          },
          "(J, 3) from the parent in the zero pose, file units")
      .def_property_readonly("rotations", &as_quaternions, "(T, J, 4) world, relative to the zero pose, w x y z; a copy")
      .def_property_readonly(
          "positions", [](const SourceMotion &motion) { return stack(motion.positions); }, "(T, J, 3) world, file units; a copy");
  OptionsClass<RetargetOptions>(m, "Options of retarget.");
  m.def("retarget", &retarget, py::arg("clip"), py::arg("skeleton"), py::arg("options") = RetargetOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "A clip on its own skeleton -> Motion of our skeleton; joints are matched by name and topology.");
  m.def("up_of_world", &up_of_world, py::arg("clip"), py::arg("given") = std::map<std::string, std::string>{}, Release(),
        "The axis of the clip's world that points up, as retarget() determines it. given: our joint -> name in the clip.");
  Class<JointMatch>(m, "JointMatch", "Which joint of a clip plays one of our joints, and why.")
      .def_readonly("part", &JointMatch::part, "our joint")
      .def_readonly("joint", &JointMatch::joint, "index into the clip's joint_names; -1 = none")
      .def_readonly("reason", &JointMatch::reason, "why, in words");
  m.def("explain_match", &explain_match, py::arg("clip"), py::arg("given") = std::map<std::string, std::string>{},
        "A JointMatch for each of our joints. given: our joint -> name in the clip, '' = none.");
  m.def("resample", &resample, py::arg("skeleton"), py::arg("motion"), py::arg("fps"),
        "The same Motion at another rate; the first pose stays, and the last one if it falls on a frame of the new rate.");
  OptionsClass<PlantOptions>(m, "Options of plant_feet and find_contacts.");
  Class<FootContacts>(m, "FootContacts", "Contacts of heel and ball of one foot.")
      .def_readonly("ankle", &FootContacts::ankle, "joint")
      .def_property_readonly(
          "heel", [](const FootContacts &foot) { return foot.heel; }, "(T,) bool")
      .def_property_readonly(
          "ball", [](const FootContacts &foot) { return foot.ball; }, "(T,) bool");
  m.def("find_contacts", &find_contacts, py::arg("skeleton"), py::arg("motion"), py::arg("options") = PlantOptions{}, Release(),
        "A FootContacts for each foot of the Motion that can be planted: the frames in which its heel and ball stand.");
  m.def("plant_feet", &plant_feet, py::arg("skeleton"), py::arg("motion"), py::arg("options") = PlantOptions{}, Release(),
        "The Motion with planted feet: a foot that stands stays in place on the floor, and no foot is below it.");
  m.def("write_bvh", &write_bvh, py::arg("path"), py::arg("skeleton"), py::arg("motion"), Release(),
        "Writes a Motion as BVH in metres and degrees, +Y up, atomically.");
}

void bind_animator(py::module_ &m) {
  m.def("resolve_arm_penetration", &resolve_arm_penetration, py::arg("character"), py::arg("motion"),
        py::arg("context") = interruptible_context(), Release(),
        "The Motion with the shoulders turned until forearms and hands are clear of the body; animate() does it by default.");
  OptionsClass<AnimateOptions>(m, "Options of animate.");
  Class<AnimationResult>(m, "AnimationResult", py::dynamic_attr(),
                         "An animation in memory. Arrays are assembled at the first access and cached: read-only copies.")
      .def_readonly("fps", &AnimationResult::fps, "frames per second, the character's")
      .def_readonly("dofs", &AnimationResult::dofs, "(T, D)")
      .def_property_readonly(
          "surface",
          [](const py::object &self) { return stacked_once(self, "_surface", self.cast<const AnimationResult &>().surface); },
          "(T, V, 3) m")
      .def_property_readonly(
          "joints",
          [](const py::object &self) { return stacked_once(self, "_joints", self.cast<const AnimationResult &>().joints); },
          "(T, J, 3) m")
      .def_property_readonly(
          "high", [](const py::object &self) { return stacked_once(self, "_high", self.cast<const AnimationResult &>().high); },
          "(T, VH, 3) m")
      .def_property_readonly(
          "body", [](const py::object &self) { return stacked_once(self, "_body", self.cast<const AnimationResult &>().body); },
          "(T, B, 3) m");
  m.def(
      "animate",
      [](const Character &character, const Motion &motion, const AnimateOptions &options, const Context &context,
         const SolverMaker &make_solver) {
        const pbd::ClothSolverFactory make = solver_factory(make_solver);
        const py::gil_scoped_release release;
        return animate(character, motion, options, context, make);
      },
      py::arg("character"), py::arg("motion"), py::arg("options") = AnimateOptions{},
      py::arg("context") = interruptible_context(), py::arg("make_solver") = py::none(),
      "The whole animation in memory. The motion is resampled to the character's own rate. Raises Error naming the frame if the "
      "cloth is no longer finite. make_solver: as in CharacterSimulator.");
}

void bind_streaming(py::module_ &m) {
  Class<AnimationFrame>(m, "AnimationFrame", "One frame of an animation; keep copies, the arrays are gone after the call.")
      .def_readonly("index", &AnimationFrame::index, "of the animation, from 0")
      .def_readonly("dofs", &AnimationFrame::dofs, "(D)")
      .def_readonly("joints", &AnimationFrame::joints, "(J, 3) m")
      .def_readonly("surface", &AnimationFrame::surface, "(V, 3) m")
      .def_readonly("high", &AnimationFrame::high, "(VH, 3) m, or empty")
      .def_readonly("body", &AnimationFrame::body, "(B, 3) m, or empty");
  m.def(
      "animate_each",
      [](const Character &character, const Motion &motion, const std::function<void(const AnimationFrame &)> &frame,
         const AnimateOptions &options, const Context &context, const SolverMaker &make_solver) {
        const pbd::ClothSolverFactory make = solver_factory(make_solver);
        const py::gil_scoped_release release;
        return animate(character, motion, options, frame, context, make);
      },
      py::arg("character"), py::arg("motion"), py::arg("frame"), py::arg("options") = AnimateOptions{},
      py::arg("context") = interruptible_context(), py::arg("make_solver") = py::none(),
      "animate(), but calls frame(AnimationFrame) in order and stores nothing.");
  m.def("write_baked_npz", &write_baked_npz, py::arg("path"), py::arg("character"), py::arg("animation"),
        py::arg_v("drawn", TexturedFaces{}, "TexturedFaces()"), Release(),
        "Writes an animation as arrays (docs/formats.md), atomically. drawn: faces instead of M_high's.");
  OptionsClass<BakedGlbOptions>(m, "Options of write_baked_glb.");
  Class<BakedMeshSummary>(m, "BakedMeshSummary", "Difference between what a viewer shows of a baked mesh and the animation.")
      .def_readonly("name", &BakedMeshSummary::name, "of the node: surface, body")
      .def_readonly("vertices", &BakedMeshSummary::vertices, "in the file; a vertex on a seam of the texture counts twice")
      .def_readonly("shapes", &BakedMeshSummary::shapes, "morph targets")
      .def_readonly("rms_error", &BakedMeshSummary::rms_error, "m, over all frames and vertices")
      .def_readonly("error_95", &BakedMeshSummary::error_95, "m, 95 % quantile")
      .def_readonly("max_error", &BakedMeshSummary::max_error, "m");
  Class<BakedGlbSummary>(m, "BakedGlbSummary", "What write_baked_glb stored.")
      .def_readonly("keys", &BakedGlbSummary::keys, "times at which the weights of the shapes are stored")
      .def_readonly("meshes", &BakedGlbSummary::meshes, "a BakedMeshSummary each");
  m.def("write_baked_glb", &write_baked_glb, py::arg("path"), py::arg("character"), py::arg("animation"),
        py::arg("options") = BakedGlbOptions{}, py::arg_v("drawn", TexturedFaces{}, "TexturedFaces()"),
        py::arg("context") = interruptible_context(), Release(),
        "Writes an animation as glTF 2.0 that any viewer plays, atomically: bones, and morph targets of textured M_high (of M if "
        "the animation has no M_high) and of the body. drawn: faces instead of M_high's. Returns a BakedGlbSummary.");
}

/// What the player returns is its own: a view, which the next step writes over.
void bind_player(py::module_ &m) {
  constexpr auto kView = py::return_value_policy::reference_internal;
  Class<Player>(m, "Player",
                "Interactive simulation of a character: a pose in, a surface out, one frame at a time. The arrays of the "
                "returned AnimationFrame are views that the next step overwrites: copy what you keep.")
      .def(py::init([](const Character &character, const AnimateOptions &options, const SolverMaker &make_solver) {
             const pbd::ClothSolverFactory make = solver_factory(make_solver);
             const py::gil_scoped_release release;
             return std::make_unique<Player>(character, options, make);
           }),
           py::arg("character"), py::arg("options") = AnimateOptions{}, py::arg("make_solver") = py::none(),
           "Starts in the rest pose, with the cloth not settled; begin with reset(). make_solver: as in CharacterSimulator.")
      .def("reset", &Player::reset, py::arg("dofs"), kView, Release(),
           "Restarts in this pose (D): the cloth is draped and settles for AnimateOptions.settle_seconds.")
      .def(
          "step",
          [](Player &player, const Eigen::VectorXd &dofs, std::optional<double> seconds) -> const AnimationFrame & {
            return seconds ? player.step(dofs, *seconds) : player.step(dofs);
          },
          py::arg("dofs"), py::arg("seconds") = py::none(), kView, Release(),
          "Advances to this pose (D) by `seconds`, in (0, 1]; None = the character's own step. The cloth moves alike at every "
          "frame rate. Raises Error if it is not finite after the step; it then stays where it last was, and reset() recovers.")
      .def("teleport", &Player::teleport, py::arg("dofs"), kView, Release(),
           "Jumps to this pose (D); the cloth and its velocities move rigidly with the root.")
      .def_property_readonly("frame", &Player::frame, kView, "The last AnimationFrame.")
      .def_property_readonly("character", &Player::character, kView,
                             "the Character as it was given; set the properties below to change how it plays")
      .def_property("materials", &Player::materials, &Player::set_materials, py::return_value_policy::copy,
                    "One per cloth region; assign a list to change them.")
      .def_property("wind", &Player::wind, &Player::set_wind, py::return_value_policy::copy, "(3) m/s")
      .def_property("gravity", &Player::gravity, &Player::set_gravity, py::return_value_policy::copy, "(3) m/s^2, within 1000")
      .def_property("proxies", &Player::proxies, &Player::set_proxies, py::return_value_policy::copy,
                    "Tapered capsules that the cloth collides with; assign a list to change them.")
      .def_property("state", &Player::state, &Player::set_state, py::return_value_policy::copy,
                    "A copy of the cloth's positions and velocities; assign it to restore them.")
      .def(
          "copy", [](const Player &player) { return player; },
          "An independent copy, which shares what never changes: see step_players.");
  m.def(
      "step_players",
      [](const std::vector<Player *> &players, const std::vector<Eigen::VectorXd> &dofs, double seconds, int threads) {
        step_players(require_objects(players, "players"), dofs, seconds, threads);
      },
      py::arg("players"), py::arg("dofs"), py::arg("seconds"), py::arg("threads") = 1, Release(),
      "player.step(pose, seconds) for several copies of one player, side by side in the lanes of SIMD registers and on up to "
      "`threads` threads, with the same bits; dofs: one pose (D) for each.");
}

void bind_pictures(py::module_ &m) {
  Class<RenderMesh>(m, "RenderMesh", "One mesh of a picture; colours in [0, 1], RGB.")
      .def(py::init([](Vertices vertices, Faces faces, const Eigen::Vector3d &colour, const std::optional<Vertices> &colours,
                       Mask face_valid) {
             RenderMesh mesh;
             mesh.vertices = std::move(vertices);
             mesh.faces = std::move(faces);
             mesh.colour = colour;
             if (colours)
               mesh.colours = *colours;
             mesh.face_valid = std::move(face_valid);
             return mesh;
           }),
           py::arg("vertices"), py::arg("faces"), py::arg("colour") = Eigen::Vector3d(0.75, 0.75, 0.75),
           py::arg("colours") = std::nullopt, py::arg_v("face_valid", Mask{}, "[]"))
      .def_readwrite("vertices", &RenderMesh::vertices, "(V, 3) m")
      .def_readwrite("faces", &RenderMesh::faces, "(F, 3)")
      .def_readwrite("colour", &RenderMesh::colour, "(3) R G B in [0, 1]");
  OptionsClass<RenderOptions>(m, "Options of render.");
  m.def("hidden_faces", &hidden_faces, py::arg("character"), Release(),
        "(FH) 1 = the face of M_high belongs to the hidden body, or joins it to the scan.");
  m.def("render", &render, py::arg("meshes"), py::arg("camera"), py::arg("options") = RenderOptions{}, Release(),
        "(H, W, 3) uint8, BGR");
  m.def("orbit_camera", &orbit_camera, py::arg("target"), py::arg("radius"), py::arg("azimuth"), py::arg("elevation"),
        py::arg("width"), py::arg("height"), "Looks at target from azimuth (rad, 0 = from +Z) and elevation.");
  Class<CharacterRenderer>(m, "CharacterRenderer", "Renders one character in many frames; thread-safe.")
      .def(py::init<const Character &>(), py::arg("character"), Release())
      .def("meshes", &CharacterRenderer::meshes, py::arg("surface"), py::arg("high"), py::arg("body"), Release(),
           "The RenderMesh objects of a frame.")
      .def("render", &CharacterRenderer::render, py::arg("surface"), py::arg("high"), py::arg("body"), py::arg("camera"),
           py::arg("options") = RenderOptions{}, Release(), "(H, W, 3) uint8, BGR");
}

using Images = std::pair<std::vector<Image>, std::vector<Image>>;
using ImagesOfFrame = py::typing::Callable<Images(int)>;

FrameImages images_of(const ImagesOfFrame &images, int frame) {
  const py::gil_scoped_acquire gil;
  const py::object found = images(frame);
  try {
    auto [pictures, masks] = found.cast<Images>();
    return {std::move(pictures), std::move(masks)};
  } catch (const py::cast_error &) {
    throw py::type_error("images must return two lists, pictures (H, W, 3) and masks (H, W) of uint8, found " + described(found));
  }
}

void bind_texture(py::module_ &m) {
  OptionsClass<TextureOptions>(m, "Options of texture_character.");
  m.def("texture_character",
        py::overload_cast<Character &, const Vertices &, const CameraRig &, const std::vector<Image> &,
                          const std::vector<Image> &, const TextureOptions &, const Context &>(&texture_character),
        py::arg("character"), py::arg("surface"), py::arg("cameras"), py::arg("images"), py::arg("masks") = std::vector<Image>{},
        py::arg("options") = TextureOptions{}, py::arg("context") = interruptible_context(), Release(),
        "Bakes the texture of the character from the images of a frame in which M is at `surface` (V, 3); the hidden body gets "
        "the colour of the skin beyond the garment's boundary. Returns the share of the surface that a camera saw.");
  m.def(
      "texture_character_from_take",
      [](Character &character, const std::vector<Vertices> &surfaces, const CameraRig &cameras, const ImagesOfFrame &images,
         const TextureOptions &options, const Context &context) {
        const FilmedSurface filmed{static_cast<int>(surfaces.size()), [&](int frame) { return surfaces[frame]; },
                                   [&](int frame) { return images_of(images, frame); }};
        return texture_character(character, filmed, cameras, options, context);
      },
      py::arg("character"), py::arg("surfaces"), py::arg("cameras"), py::arg("images"), py::arg("options") = TextureOptions{},
      py::arg("context") = interruptible_context(), Release(),
      "The same from the frames of a take in which M is at `surfaces` (a list of (V, 3)): images(i) returns the images and the "
      "masks of frame i, two lists with one entry per camera; it is called for few frames, in ascending order.");
  m.def("sample_colours", &sample_colours, py::arg("mesh"), py::arg("face_valid"), py::arg("cameras"), py::arg("images"),
        py::arg("masks") = std::vector<Image>{}, py::arg("options") = TextureOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "(10 F, 3) B G R, 0 to 255, at 10 points of every face, NaN where no camera sees it: for SegmentInputs.colours.");
  Class<DisplayMesh>(m, "DisplayMesh", "The display surface of a character, in the scan pose.")
      .def_readonly("mesh", &DisplayMesh::mesh, "M_high, scan pose")
      .def_readonly("valid", &DisplayMesh::valid, "(FH) 0 = not drawn")
      .def_readonly("garment_subdivisions", &DisplayMesh::garment_subdivisions, "-1 = `mesh` is one surface, as scanned");
  m.def("build_display_mesh", &build_display_mesh, py::arg("actor"), py::arg("segmentation"), py::arg("high"),
        py::arg("body") = Mesh{}, Release(),
        "The display surface; if the actor wears a garment with a mesh of its own, the garment replaces the scan's faces that it "
        "covers. Surface that lies on `body` like skin is not mistaken for the surface that closes the scan below a hem.");
  m.def("drawn_faces", &drawn_faces, py::arg("character"), Release(),
        "TexturedFaces of the valid faces of M_high. Raises Error naming the part of the character that does not fit.");
  m.def("reduce_faces", &reduce_faces, py::arg("vertices"), py::arg("drawn"), py::arg("triangles"), Release(),
        "TexturedFaces reduced to about `triangles` triangles, with the same vertices: boundaries and seams of the texture lose "
        "vertices only where they are straight.");
  Class<DisplaySurface>(m, "DisplaySurface", "The display mesh of a character, which follows its M.")
      .def(py::init<const Character &>(), py::arg("character"), Release())
      .def("apply", py::overload_cast<const Vertices &>(&DisplaySurface::apply, py::const_), py::arg("surface"), Release(),
           "(VH, 3) for the vertices (V, 3) of M")
      .def("sample", &DisplaySurface::sample, py::arg("values"), Release(), "(VH, C) values of M's vertices (V, C)");
  Class<SurfaceTransfer>(m, "SurfaceTransfer", "A fine mesh that follows a coarse one.")
      .def(py::init<const Mesh &, const Mask &, const Mesh &, const Mask &>(), py::arg("coarse"), py::arg("coarse_valid"),
           py::arg("fine"), py::arg("fine_valid"), Release())
      .def("apply", py::overload_cast<const Vertices &>(&SurfaceTransfer::apply, py::const_), py::arg("coarse"), Release(),
           "(V', 3) fine vertices for the coarse (V, 3)");
}

} // namespace

void bind_animate(py::module_ &m) {
  bind_character(m);
  bind_motion(m);
  bind_animator(m);
  bind_streaming(m);
  bind_player(m);
  bind_pictures(m);
  bind_texture(m);
}

} // namespace doublet::python
