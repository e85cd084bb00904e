// Acclaim ASF/AMC. Every bone has an axis frame C (constant) and a motion M in it; its world rotation is that of its parent times
// C M C^-1, and it points along `direction` (world axes of the rest pose). Rotation triples "rx ry rz" turn about x first: M = Rz
// Ry Rx.

#include "doublet/animate/motion_file.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"
#include "line_reader.h"
#include "motion_bounds.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace doublet {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Bone {
  std::string name;
  int parent = -1;
  Vector3d tip = Vector3d::Zero(); ///< from its start to its end, rest pose, file units
  Quaterniond axis = Quaterniond::Identity();
  std::vector<std::string> dofs; ///< lower case: tx ty tz rx ry rz l
  bool placed = false;           ///< found in the hierarchy
};

struct AcclaimSkeleton {
  std::vector<Bone> bones; ///< [0] is the root
  Vector3d position = Vector3d::Zero();
  double radians = M_PI / 180;
  std::map<std::string, int> index;
};

/// Turns about the axes named in `order` ("XYZ"), the first one first.
Quaterniond turns(const std::string &order, const Vector3d &angles) {
  Quaterniond result = Quaterniond::Identity();
  for (int k = 0; k < 3; ++k)
    result = Eigen::AngleAxisd(angles[k], Vector3d::Unit(order[k] - 'x')) * result;
  return result;
}

Vector3d three(const LineReader &reader, const TextLine &line, const std::string &expected) {
  Vector3d v;
  for (int k = 0; k < 3; ++k)
    v[k] = reader.number(line, 1 + k, expected);
  return v;
}

std::string axis_order(const LineReader &reader, const TextLine &line, std::size_t word) {
  std::string order = word < line.words.size() ? lower(line.words[word]) : "";
  std::string sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "xyz")
    reader.fail(line, "an axis order like XYZ");
  return order;
}

void read_dofs(const LineReader &reader, const TextLine &line, Bone &bone) {
  static const std::vector<std::string> known{"tx", "ty", "tz", "rx", "ry", "rz", "l"};
  bone.dofs.clear();
  for (std::size_t i = 1; i < line.words.size(); ++i) {
    const std::string dof = lower(line.words[i]);
    if (std::find(known.begin(), known.end(), dof) == known.end())
      reader.fail(line, "degrees of freedom out of tx ty tz rx ry rz l");
    bone.dofs.push_back(dof);
  }
}

void read_units(const LineReader &reader, const TextLine &line, AcclaimSkeleton &out) {
  if (lower(line.words[0]) == "angle")
    out.radians = line.words.size() > 1 && lower(line.words[1]).rfind("rad", 0) == 0 ? 1.0 : M_PI / 180;
  else if (lower(line.words[0]) == "length")
    reader.number(line, 1, "length and a number");
}

struct RootAxis {
  std::string order = "xyz";
  Vector3d orientation = Vector3d::Zero();
};

void read_root(const LineReader &reader, const TextLine &line, AcclaimSkeleton &out, RootAxis &axis) {
  const std::string key = lower(line.words[0]);
  if (key == "order")
    read_dofs(reader, line, out.bones[0]);
  else if (key == "axis")
    axis.order = axis_order(reader, line, 1);
  else if (key == "position")
    out.position = three(reader, line, "position and three numbers");
  else if (key == "orientation")
    axis.orientation = three(reader, line, "orientation and three angles");
  else
    reader.fail(line, "order, axis, position or orientation");
}

void read_bone(LineReader &reader, AcclaimSkeleton &out, const std::string &source) {
  Bone bone;
  Vector3d direction = Vector3d::Zero();
  double length = 0;
  for (;;) {
    const TextLine &line = reader.next("end of a bone");
    const std::string key = lower(line.words[0]);
    if (key == "end") {
      if (bone.name.empty() || out.index.count(bone.name))
        reader.fail(line, "a bone with a name of its own before this (its name: '" + bone.name + "')");
      break;
    }
    if (key == "name" && line.words.size() > 1)
      bone.name = line.words[1];
    else if (key == "direction")
      direction = three(reader, line, "direction and three numbers");
    else if (key == "length")
      length = reader.number(line, 1, "length and a number");
    else if (key == "axis")
      bone.axis = turns(axis_order(reader, line, 4), out.radians * three(reader, line, "axis and three angles"));
    else if (key == "dof")
      read_dofs(reader, line, bone);
    else if (key != "id" && key != "limits" && key[0] != '(' && key != "bodymass" && key != "cofmass")
      reader.fail(line, "id, name, direction, length, axis, dof, limits or end");
  }
  if (out.bones.size() >= kMostJoints)
    throw Error(source + ": expected a skeleton of at most " + std::to_string(kMostJoints) + " bones, found more");
  if (direction.norm() > 0)
    bone.tip = length * direction.normalized();
  out.index[bone.name] = static_cast<int>(out.bones.size());
  out.bones.push_back(bone);
}

void read_children(const LineReader &reader, const TextLine &line, AcclaimSkeleton &out) {
  const auto find = [&](const std::string &name) {
    const auto it = out.index.find(name);
    if (it == out.index.end())
      reader.fail(line, "bones of :bonedata (there is no '" + name + "')");
    return it->second;
  };
  const int parent = find(line.words[0]);
  if (!out.bones[parent].placed)
    reader.fail(line, "a parent that has a parent itself");
  for (std::size_t i = 1; i < line.words.size(); ++i) {
    Bone &child = out.bones[find(line.words[i])];
    if (child.placed)
      reader.fail(line, "every bone once ('" + child.name + "' has a parent already)");
    child.parent = parent;
    child.placed = true;
  }
}

AcclaimSkeleton read_skeleton(const std::string &text, const std::string &source) {
  LineReader reader(text, source, true);
  AcclaimSkeleton out;
  out.bones.emplace_back();
  out.bones[0].name = "root";
  out.bones[0].placed = true;
  out.index["root"] = 0;
  RootAxis root_axis;
  std::string section;
  while (!reader.done()) {
    const TextLine &line = reader.next("a section");
    const std::string key = lower(line.words[0]);
    if (key[0] == ':')
      section = key;
    else if (section == ":units")
      read_units(reader, line, out);
    else if (section == ":root")
      read_root(reader, line, out, root_axis);
    else if (section == ":bonedata" && key == "begin")
      read_bone(reader, out, source);
    else if (section == ":hierarchy" && key != "begin" && key != "end")
      read_children(reader, line, out);
    else if (section.empty())
      reader.fail(line, "a section like :units");
  }
  out.bones[0].axis = turns(root_axis.order, out.radians * root_axis.orientation);
  if (out.bones.size() < 2 || out.bones[0].dofs.empty())
    throw Error(source + ": expected :root with an order and :bonedata with bones, found an incomplete skeleton");
  for (const Bone &bone : out.bones)
    if (!bone.placed)
      throw Error(source + ": the bone '" + bone.name + "' is missing in :hierarchy");
  return out;
}

/// Bones sorted parents first.
std::vector<int> bone_order(const AcclaimSkeleton &skeleton) {
  std::vector<int> order{0};
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t b = 1; b < skeleton.bones.size(); ++b)
      if (skeleton.bones[b].parent == order[i])
        order.push_back(static_cast<int>(b));
  return order;
}

struct BoneMotion {
  Quaterniond turn = Quaterniond::Identity();
  Vector3d shift = Vector3d::Zero();
};

BoneMotion read_bone_motion(const LineReader &reader, const TextLine &line, const Bone &bone, double radians) {
  if (line.words.size() != bone.dofs.size() + 1)
    reader.fail(line, "'" + bone.name + "' and " + std::to_string(bone.dofs.size()) + " values");
  BoneMotion motion;
  for (std::size_t d = 0; d < bone.dofs.size(); ++d) {
    const double value = reader.number(line, d + 1, "'" + bone.name + "' and " + std::to_string(bone.dofs.size()) + " values");
    if (bone.dofs[d][0] == 'r')
      motion.turn = Eigen::AngleAxisd(value * radians, Vector3d::Unit(bone.dofs[d][1] - 'x')) * motion.turn;
    else if (bone.dofs[d][0] == 't')
      motion.shift[bone.dofs[d][1] - 'x'] = value;
  }
  return motion;
}

/// The joints of the result: one per bone, at its start, and one at the end of every chain. `bone_of_joint` is -1 for those.
void make_joints(const AcclaimSkeleton &skeleton, const std::vector<int> &order, SourceMotion &clip,
                 std::vector<int> &bone_of_joint) {
  std::vector<int> joint_of_bone(skeleton.bones.size(), -1);
  std::vector<bool> leaf(skeleton.bones.size(), true);
  for (int b : order) {
    const Bone &bone = skeleton.bones[b];
    joint_of_bone[b] = static_cast<int>(clip.joints.size());
    const Vector3d offset = bone.parent < 0 ? skeleton.position : skeleton.bones[bone.parent].tip;
    clip.joints.push_back({bone.name, bone.parent < 0 ? -1 : joint_of_bone[bone.parent], offset});
    bone_of_joint.push_back(b);
    if (bone.parent >= 0)
      leaf[bone.parent] = false;
  }
  for (int b : order)
    if (leaf[b] && b != 0) {
      clip.joints.push_back({skeleton.bones[b].name + "_end", joint_of_bone[b], skeleton.bones[b].tip});
      bone_of_joint.push_back(-1);
    }
}

void pose_frame(const AcclaimSkeleton &skeleton, const std::vector<BoneMotion> &motion, const std::vector<int> &bone_of_joint,
                SourceMotion &clip) {
  Vertices positions(clip.joints.size(), 3);
  std::vector<Quaterniond> rotations(clip.joints.size());
  for (std::size_t j = 0; j < clip.joints.size(); ++j) {
    const SourceJoint &joint = clip.joints[j];
    const int b = bone_of_joint[j];
    Quaterniond local = Quaterniond::Identity();
    Vector3d offset = joint.offset;
    if (b >= 0) {
      const Quaterniond &axis = skeleton.bones[b].axis;
      local = axis * motion[b].turn * axis.conjugate();
      offset += joint.parent < 0 ? motion[b].shift : Vector3d(axis * motion[b].shift);
    }
    if (joint.parent < 0) {
      positions.row(j) = offset;
      rotations[j] = local.normalized();
    } else {
      positions.row(j) = positions.row(joint.parent).transpose() + rotations[joint.parent] * offset;
      rotations[j] = (rotations[joint.parent] * local).normalized();
    }
  }
  clip.positions.push_back(std::move(positions));
  clip.rotations.push_back(std::move(rotations));
}

} // namespace

SourceMotion parse_acclaim(const std::string &asf, const std::string &amc, const std::string &asf_source,
                           const std::string &amc_source, double fps) {
  if (!(fps > 0))
    throw std::invalid_argument("parse_acclaim: fps must be positive, found " + options::to_text(fps));
  const AcclaimSkeleton skeleton = read_skeleton(asf, asf_source);
  SourceMotion clip;
  clip.source = amc_source;
  clip.fps = fps;
  std::vector<int> bone_of_joint;
  make_joints(skeleton, bone_order(skeleton), clip, bone_of_joint);

  LineReader reader(amc, amc_source, true);
  double radians = skeleton.radians, before = 0; // before: the number of the frame before
  while (!reader.done() && reader.peek("").words[0][0] == ':') {
    const std::string key = lower(reader.next("").words[0]);
    radians = key == ":radians" ? 1.0 : key == ":degrees" ? M_PI / 180 : radians;
  }
  while (!reader.done()) {
    const TextLine &number = reader.next("a frame number");
    if (number.words.size() != 1)
      reader.fail(number, "a frame number");
    const double frame = reader.number(number, 0, "a frame number");
    if (!clip.positions.empty() && frame != before + 1)
      reader.fail(number, "frame " + options::to_text(before + 1) + ", as frames follow each other");
    before = frame;
    std::vector<BoneMotion> motion(skeleton.bones.size());
    std::vector<bool> seen(skeleton.bones.size(), false);
    while (!reader.done() && reader.peek("").words.size() > 1) {
      const TextLine &line = reader.next("");
      const auto it = skeleton.index.find(line.words[0]);
      if (it == skeleton.index.end())
        reader.fail(line, "a bone of " + asf_source);
      motion[it->second] = read_bone_motion(reader, line, skeleton.bones[it->second], radians);
      seen[it->second] = true;
    }
    for (std::size_t b = 0; b < seen.size(); ++b)
      if (!seen[b] && !skeleton.bones[b].dofs.empty())
        throw Error(amc_source + ":" + std::to_string(number.number) + ": expected values for the bone '" +
                    skeleton.bones[b].name + "' in this frame, found none");
    require_poses(static_cast<double>(clip.positions.size() + 1), clip.joints.size(), amc_source);
    pose_frame(skeleton, motion, bone_of_joint, clip);
  }
  if (clip.positions.empty())
    throw Error(amc_source + ": expected at least one frame, found none");
  return clip;
}

namespace {

std::filesystem::path skeleton_beside(const std::filesystem::path &amc) {
  const std::string stem = amc.stem().string();
  std::filesystem::path best;
  const std::filesystem::path folder = amc.has_parent_path() ? amc.parent_path() : std::filesystem::path(".");
  for (const auto &entry : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path &path = entry.path();
    if (lower(path.extension().string()) == ".asf" && stem.rfind(path.stem().string(), 0) == 0 &&
        path.stem().string().size() > best.stem().string().size())
      best = path;
  }
  if (best.empty())
    throw FileNotFound(amc.string() +
                       ": expected its skeleton, an .asf whose name this one begins with, in the same folder, found none");
  return best;
}

} // namespace

SourceMotion read_motion_file(const std::filesystem::path &path, const std::filesystem::path &skeleton,
                              const std::string &animation) {
  const std::string extension = lower(path.extension().string());
  const bool gltf = extension == ".glb" || extension == ".vrm" || extension == ".vrma";
  if (!animation.empty() && !gltf && extension != ".fbx")
    throw Error(path.string() + ": expected a .glb or .fbx, which can have several animations, to choose '" + animation + "' of");
  if (extension == ".bvh")
    return parse_bvh(read_text(path), path.string());
  if (gltf)
    return read_gltf_motion(path, animation);
  if (extension == ".fbx")
    return read_fbx_motion(path, animation);
  if (extension != ".amc")
    throw Error(path.string() + ": expected a motion file .bvh, .amc, .glb or .fbx, found '" + extension + "'");
  const std::string amc = read_text(path);
  const std::filesystem::path asf = skeleton.empty() ? skeleton_beside(path) : skeleton;
  return parse_acclaim(read_text(asf), amc, asf.string(), path.string());
}

} // namespace doublet
