#include "baked_animation.h"

#include "doublet/animate/baked_file.h"
#include "doublet/animate/level_of_detail.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace doublet {
namespace {

std::vector<double> flatten(const std::vector<Vertices> &frames) {
  std::vector<double> values;
  values.reserve(frames.size() * static_cast<std::size_t>(frames[0].size()));
  for (const Vertices &frame : frames)
    values.insert(values.end(), frame.data(), frame.data() + frame.size());
  return values;
}

std::vector<int> flatten(const Faces &faces) {
  return {faces.data(), faces.data() + faces.size()};
}

/// (T, J, 4) w x y z, in the world from the rest pose; each on the side of its last, so that who blends does not go the long way.
std::vector<double> joint_rotations(const Skeleton &skeleton, const MatrixRM &dofs) {
  std::vector<double> values;
  std::vector<Eigen::Quaterniond> last(skeleton.joints.size(), Eigen::Quaterniond::Identity());
  for (Eigen::Index t = 0; t < dofs.rows(); ++t) {
    const Transforms world_from_rest = forward_kinematics(skeleton, dofs.row(t));
    for (std::size_t j = 0; j < last.size(); ++j) {
      Eigen::Quaterniond turn(world_from_rest[j].linear());
      if (turn.dot(last[j]) < 0)
        turn.coeffs() *= -1;
      last[j] = turn;
      values.insert(values.end(), {turn.w(), turn.x(), turn.y(), turn.z()});
    }
  }
  return values;
}

} // namespace

void require_animation(const Character &character, const AnimationResult &animation) {
  validate_character(character);
  const auto frames = static_cast<Eigen::Index>(animation.surface.size());
  const auto has_all = [&](const std::vector<Vertices> &of_frames, Eigen::Index rows) {
    return static_cast<Eigen::Index>(of_frames.size()) == frames &&
           std::all_of(of_frames.begin(), of_frames.end(), [&](const Vertices &frame) { return frame.rows() == rows; });
  };
  const Skeleton &skeleton = character.actor.skeleton;
  if (frames == 0 || !(animation.fps > 0) || animation.dofs.rows() != frames || animation.dofs.cols() != skeleton.dof_count() ||
      !has_all(animation.surface, character.actor.mesh.vertices.rows()) || !has_all(animation.joints, skeleton.joint_count()) ||
      (!animation.body.empty() && !has_all(animation.body, character.body.vertices.rows())) ||
      (!animation.high.empty() && !has_all(animation.high, character.high.vertices.rows())))
    throw std::invalid_argument("baked animation: expected frames of this character with poses, joints and a rate, found " +
                                std::to_string(frames) + " frames of another kind");
}

TexturedFaces faces_to_draw(const Character &character, const AnimationResult &animation, const TexturedFaces &drawn) {
  if (drawn.faces.rows() == 0)
    return drawn_faces(character);
  if (animation.high.empty() || drawn.faces.minCoeff() < 0 || drawn.faces.maxCoeff() >= character.high.vertices.rows() ||
      drawn.texcoords.rows() != (character.texcoords.rows() > 0 ? 3 * drawn.faces.rows() : 0))
    throw std::invalid_argument("baked animation: drawn: expected faces of the character's display surface, with texture "
                                "coordinates if that has some, found others");
  return drawn;
}

void write_baked_npz(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                     const TexturedFaces &drawn) {
  require_animation(character, animation);
  const auto frames = static_cast<std::int64_t>(animation.surface.size());
  const Skeleton &skeleton = character.actor.skeleton;
  std::vector<std::string> names;
  for (const Joint &joint : skeleton.joints)
    names.push_back(joint.name);
  Npz npz;
  npz.set_f4("vertices", {frames, animation.surface[0].rows(), 3}, flatten(animation.surface));
  npz.set_i4("faces", {character.actor.mesh.faces.rows(), 3}, flatten(character.actor.mesh.faces));
  npz.set_b1("face_valid", character.actor.face_valid);
  npz.set_f4("joints", {frames, skeleton.joint_count(), 3}, flatten(animation.joints));
  npz.set_f4("joint_rotations", {frames, skeleton.joint_count(), 4}, joint_rotations(skeleton, animation.dofs));
  npz.set_text("joint_names", names);
  npz.set_f4("dofs", {frames, animation.dofs.cols()}, {animation.dofs.data(), animation.dofs.data() + animation.dofs.size()});
  npz.set_f8("fps", {}, {animation.fps});
  if (!animation.body.empty()) {
    npz.set_f4("body_vertices", {frames, animation.body[0].rows(), 3}, flatten(animation.body));
    npz.set_i4("body_faces", {character.body.faces.rows(), 3}, flatten(character.body.faces));
    npz.set_b1("body_shown", character.body_shown);
  }
  if (drawn.faces.rows() > 0) {
    const Faces faces = faces_to_draw(character, animation, drawn).faces;
    std::vector<int> all(faces.rows()), vertices;
    std::iota(all.begin(), all.end(), 0);
    const Mesh shown = submesh({character.high.vertices, faces}, all, &vertices);
    std::vector<Vertices> moved;
    for (const Vertices &frame : animation.high)
      moved.push_back(frame(vertices, Eigen::all));
    npz.set_f4("high_vertices", {frames, moved[0].rows(), 3}, flatten(moved));
    npz.set_i4("high_faces", {shown.faces.rows(), 3}, flatten(shown.faces));
    npz.set_b1("high_valid", Mask(shown.faces.rows(), 1));
  } else if (!animation.high.empty()) {
    npz.set_f4("high_vertices", {frames, animation.high[0].rows(), 3}, flatten(animation.high));
    npz.set_i4("high_faces", {character.high.faces.rows(), 3}, flatten(character.high.faces));
    npz.set_b1("high_valid", character.high_valid);
  }
  npz.write(path, kFileFormat);
}

} // namespace doublet
