#pragma once
// Motion capture files on their own skeleton: BVH, Acclaim ASF/AMC, and glTF; and BVH of a motion of ours.

#include "doublet/animate/motion.h"

#include <filesystem>
#include <string>
#include <vector>

namespace doublet {

struct SourceJoint {
  std::string name;
  int parent = -1;        ///< index, smaller than the joint's own; -1 = root
  Eigen::Vector3d offset; ///< from the parent in the file's zero pose, file units
  std::string part{};     ///< standard name of the joint if the file gives it (VRM); empty = it does not
};

/// A clip as stored in the file. Lengths stay in the file's unit: retargeting measures the legs and needs no unit. The zero pose
/// (all rotations zero) need not be a human stance: some exporters write bone-local frames.
struct SourceMotion {
  std::string source;                  ///< file name, for messages
  std::vector<SourceJoint> joints;     ///< parents first; ends of chains are joints named "<parent>_end"
  std::vector<std::string> animations; ///< names of all animations in the file, if the format can have several (glTF)
  int animation = 0;                   ///< index of this one in `animations`
  double fps = 0;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();           ///< up axis of the world if the format defines one (glTF); 0 = unknown
  std::vector<Vertices> positions;                        ///< T x (J, 3) world, file units
  std::vector<std::vector<Eigen::Quaterniond>> rotations; ///< T x J world, relative to the zero pose
  int frame_count() const { return static_cast<int>(positions.size()); }
  Vertices zero_positions() const; ///< (J, 3) joints of the zero pose
};

constexpr double kLowestRate = 0.1, kHighestRate = 1e5; ///< 1/s, of a clip

/// Throws std::invalid_argument unless there are joints, parents first, and frames of finite positions and unit quaternions for
/// all of them, at a rate in range.
void validate(const SourceMotion &motion);

/// Any channel order on any joint. Position channels replace the OFFSET, as Blender and MotionBuilder read them, unless the
/// clip's own values show that they are added to it (iClone's exporter). A byte order mark is skipped; line ends may be of any
/// kind. Throws Error "source:line: expected ..., found ..." on anything malformed or truncated.
SourceMotion parse_bvh(const std::string &text, const std::string &source);

/// Acclaim skeleton and motion. AMC files contain no frame rate, so `fps` gives it (CMU: 120). Throws Error as parse_bvh.
SourceMotion parse_acclaim(const std::string &asf, const std::string &amc, const std::string &asf_source,
                           const std::string &amc_source, double fps = 120);

/// An animation of a .glb, by its name or its number from 1; without either, the first that moves the body: that rotates at least
/// half as many nodes as the one that rotates the most. The skeleton consists of the connected joints of its skins or, without a
/// skin, of the nodes that are animated or named by VRM, the nodes between them, and those below that have no mesh. The zero pose
/// is the nodes' default pose, or the bind pose of the skin where that differs; lengths are in metres. Sampled at the rate of the
/// track with the most keys, within 24 to 240 1/s. Throws Error naming the file if it is broken, refers to other files, has no
/// such animation, more than 10,000 joints, or more than 2e7 poses of nodes; FileNotFound.
SourceMotion read_gltf_motion(const std::filesystem::path &path, const std::string &animation = {});

/// An animation of an FBX file (a take), chosen as in read_gltf_motion. The skeleton consists of the joints of its skins or,
/// without a skin, of the nodes that the file marks as bones. Converted to metres and +Y up. Sampled at the file's rate, within
/// 24 to 240 1/s. Throws as read_gltf_motion, and Error for a file that takes more memory than 64 MB and 200 times its size, or
/// than 2 GB.
SourceMotion read_fbx_motion(const std::filesystem::path &path, const std::string &animation = {});

/// Chosen by extension: .bvh, .amc, .fbx, .glb, and .vrm and .vrma, which are GLB files. The skeleton of an .amc is `skeleton` if
/// given, else the .asf beside it with the same stem, or with the longest stem that is a prefix of its own. `animation` as above,
/// only for .glb and .fbx. Throws FileNotFound, or Error naming the file.
SourceMotion read_motion_file(const std::filesystem::path &path, const std::filesystem::path &skeleton = {},
                              const std::string &animation = {});

/// Writes a motion of our skeleton as BVH: m, degrees, +Y up; joints by name, the rest pose as the zero pose, rotations in the
/// order Y X Z. The offset of the root is its position in the rest pose. Six decimals: 1e-6 m, 1e-6 degrees. Written to a
/// temporary file, then renamed. Throws std::invalid_argument unless the motion has the skeleton's degrees of freedom, frames and
/// a rate.
void write_bvh(const std::filesystem::path &path, const Skeleton &skeleton, const Motion &motion);

} // namespace doublet
