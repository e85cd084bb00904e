#include "doublet/animate/motion_file.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"
#include "line_reader.h"
#include "motion_bounds.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

namespace doublet {
namespace {

using Eigen::Vector3d;

struct Channel {
  int joint;
  int axis;      ///< 0 x, 1 y, 2 z
  bool rotation; ///< else position
};

struct Hierarchy {
  std::vector<SourceJoint> joints;
  std::vector<Channel> channels;
};

void read_channels(const LineReader &reader, const TextLine &line, int joint, Hierarchy &out) {
  const double count = reader.number(line, 1, "CHANNELS and their number"); // any number: not yet to be made an integer
  if (count < 0 || count > 6 || static_cast<double>(line.words.size()) != count + 2)
    reader.fail(line, "CHANNELS, a number from 0 to 6 and as many names");
  for (std::size_t c = 2; c < line.words.size(); ++c) {
    const std::string name = lower(line.words[c]);
    const int axis = name.empty() ? -1 : name[0] - 'x';
    const bool rotation = name.substr(1) == "rotation";
    if (axis < 0 || axis > 2 || (!rotation && name.substr(1) != "position"))
      reader.fail(line, "channels like Xposition or Zrotation");
    out.channels.push_back({joint, axis, rotation});
  }
}

std::string joined(const TextLine &line, std::size_t from) {
  std::string name;
  for (std::size_t i = from; i < line.words.size() && line.words[i] != "{"; ++i)
    name += (name.empty() ? "" : " ") + line.words[i];
  return name;
}

/// A ROOT, JOINT or End Site line: adds the joint.
int open_joint(const LineReader &reader, const TextLine &line, int parent, Hierarchy &out) {
  const std::string word = lower(line.words[0]);
  const bool end = word == "end";
  std::string name = end ? (parent < 0 ? "" : out.joints[parent].name + "_end") : joined(line, 1);
  if (name.empty() || (word == "root") != (parent < 0))
    reader.fail(line, parent < 0 ? "ROOT and a name" : "JOINT and a name, End Site or }");
  if (out.joints.size() >= kMostJoints)
    reader.fail(line, "a skeleton of at most " + std::to_string(kMostJoints) + " joints");
  out.joints.push_back({name, parent, Vector3d::Zero()});
  return static_cast<int>(out.joints.size()) - 1;
}

Hierarchy read_hierarchy(LineReader &reader) {
  Hierarchy out;
  const TextLine &first = reader.next("HIERARCHY");
  if (lower(first.words[0]) != "hierarchy")
    reader.fail(first, "HIERARCHY");
  std::vector<int> open; // joints whose brace is open
  int pending = -1;      // joint whose brace comes next
  do {
    const TextLine &line = reader.next("the end of the hierarchy");
    const std::string word = lower(line.words[0]);
    if (word == "{" && pending >= 0) {
      open.push_back(pending);
      pending = -1;
    } else if (pending >= 0) {
      reader.fail(line, "{");
    } else if (word == "}" && !open.empty()) {
      open.pop_back();
    } else if (word == "offset" && !open.empty()) {
      for (int k = 0; k < 3; ++k)
        out.joints[open.back()].offset[k] = reader.number(line, 1 + k, "OFFSET and three numbers");
    } else if (word == "channels" && !open.empty()) {
      read_channels(reader, line, open.back(), out);
    } else if (word == "root" || word == "joint" || word == "end") {
      pending = open_joint(reader, line, open.empty() ? -1 : open.back(), out);
      if (line.words.back() == "{") {
        open.push_back(pending);
        pending = -1;
      }
    } else {
      reader.fail(line, open.empty() ? "ROOT and a name" : "OFFSET, CHANNELS, JOINT, End Site or }");
    }
  } while (!open.empty() || pending >= 0);
  return out;
}

/// A line "Key: value", whether or not there are blanks beside the colon.
TextLine with_blanks(const TextLine &line) {
  TextLine result{line.number, {}};
  for (const std::string &word : line.words) {
    const std::size_t behind = word.find(':') + 1; // 0: none
    if (behind > 0)
      result.words.push_back(word.substr(0, behind));
    if (behind < word.size())
      result.words.push_back(word.substr(behind));
  }
  return result;
}

/// Rows of channel values, one frame a line.
MatrixRM read_values(LineReader &reader, const Hierarchy &hierarchy, const std::string &source, double &fps) {
  const auto channels = static_cast<Eigen::Index>(hierarchy.channels.size());
  const TextLine &motion = reader.next("MOTION");
  if (lower(motion.words[0]) == "root")
    reader.fail(motion, "MOTION, as a clip has one skeleton");
  if (lower(motion.words[0]) != "motion")
    reader.fail(motion, "MOTION");
  const TextLine frames = with_blanks(reader.next("Frames: and their number"));
  const std::string key = lower(frames.words[0]);
  const double count = reader.number(frames, frames.words.size() - 1, "Frames: and their number");
  if (key.rfind("frames", 0) != 0 || count < 1 || count > 1e7 || count != std::floor(count))
    reader.fail(frames, "Frames: and a number from 1");
  if (channels == 0)
    reader.fail(frames, "joints with CHANNELS before this");
  require_poses(count, hierarchy.joints.size(), source);
  const TextLine time = with_blanks(reader.next("Frame Time: and seconds"));
  const double seconds = reader.number(time, time.words.size() - 1, "Frame Time: and seconds");
  if (lower(time.words[0]) != "frame" || seconds < 1 / kHighestRate || seconds > 1 / kLowestRate)
    reader.fail(time, "Frame Time: and seconds above 0, at most 10");
  fps = 1 / seconds;
  const std::string expected = std::to_string(channels) + " channel values";
  std::vector<double> values;
  const auto rows = static_cast<Eigen::Index>(count);
  for (Eigen::Index t = 0; t < rows; ++t) {
    const TextLine &line = reader.next("frame " + std::to_string(t + 1) + " of " + std::to_string(rows));
    if (static_cast<Eigen::Index>(line.words.size()) != channels)
      reader.fail(line, expected + " (there are " + std::to_string(line.words.size()) + ")");
    for (Eigen::Index c = 0; c < channels; ++c)
      values.push_back(reader.number(line, c, expected));
  }
  if (!reader.done())
    reader.fail(reader.peek(""), "no more than " + std::to_string(rows) + " frames");
  return Eigen::Map<const MatrixRM>(values.data(), rows, channels);
}

/// Are the position channels of a joint that hangs on another added to its OFFSET? Most programs replace it; then their values
/// lie around the OFFSET, not around 0.
bool added_to_offset(const Vector3d &offset, std::vector<Vector3d> positions) {
  if (offset.squaredNorm() == 0)
    return false;
  std::vector<double> ratio;
  for (const Vector3d &p : positions)
    ratio.push_back(p.dot(offset) / offset.squaredNorm());
  std::nth_element(ratio.begin(), ratio.begin() + ratio.size() / 2, ratio.end());
  return ratio[ratio.size() / 2] < 0.5;
}

std::vector<bool> find_added(const Hierarchy &hierarchy, const MatrixRM &values) {
  std::vector<bool> added(hierarchy.joints.size(), false);
  for (std::size_t j = 1; j < added.size(); ++j) {
    std::vector<Vector3d> positions(values.rows(), hierarchy.joints[j].offset);
    bool any = false;
    for (std::size_t c = 0; c < hierarchy.channels.size(); ++c) {
      const Channel &channel = hierarchy.channels[c];
      if (channel.joint != static_cast<int>(j) || channel.rotation)
        continue;
      any = true;
      for (Eigen::Index t = 0; t < values.rows(); ++t)
        positions[t][channel.axis] = values(t, c);
    }
    added[j] = any && added_to_offset(hierarchy.joints[j].offset, std::move(positions));
  }
  return added;
}

void pose_frame(const Hierarchy &hierarchy, const std::vector<bool> &added, const Eigen::VectorXd &row, Vertices &positions,
                std::vector<Eigen::Quaterniond> &rotations) {
  const std::size_t count = hierarchy.joints.size();
  std::vector<Vector3d> local(count);
  std::vector<Eigen::Quaterniond> turn(count, Eigen::Quaterniond::Identity());
  for (std::size_t j = 0; j < count; ++j)
    local[j] = hierarchy.joints[j].offset;
  for (std::size_t c = 0; c < hierarchy.channels.size(); ++c) {
    const Channel &channel = hierarchy.channels[c];
    if (channel.rotation)
      turn[channel.joint] = turn[channel.joint] * Eigen::AngleAxisd(row[c] * M_PI / 180, Vector3d::Unit(channel.axis));
    else
      local[channel.joint][channel.axis] =
          row[c] + (added[channel.joint] ? hierarchy.joints[channel.joint].offset[channel.axis] : 0.0);
  }
  positions.resize(count, 3);
  rotations.resize(count);
  for (std::size_t j = 0; j < count; ++j) {
    const int p = hierarchy.joints[j].parent;
    positions.row(j) = p < 0 ? local[j] : Vector3d(positions.row(p).transpose() + rotations[p] * local[j]);
    rotations[j] = (p < 0 ? turn[j] : rotations[p] * turn[j]).normalized();
  }
}

/// A joint that carries the whole body, and how many joints it and what hangs on it are.
struct Carrier {
  std::size_t joint, count;
};

/// The root, and what is between it and the limbs: hips below a "Reference".
std::vector<Carrier> carriers(const Hierarchy &hierarchy) {
  constexpr std::size_t kLimb = 3; // joints of one at least
  const std::vector<SourceJoint> &joints = hierarchy.joints;
  std::vector<std::size_t> count(joints.size(), 1);
  for (std::size_t j = joints.size() - 1; j > 0; --j)
    count[joints[j].parent] += count[j];
  std::vector<Carrier> result{{0, joints.size()}};
  for (;;) {
    std::size_t limbs = 0, next = 0;
    for (std::size_t j = result.back().joint + 1; j < joints.size(); ++j)
      if (joints[j].parent == static_cast<int>(result.back().joint) && count[j] >= kLimb) {
        ++limbs;
        next = j;
      }
    if (limbs == 0)
      return {result[0]}; // a chain has no body
    if (limbs > 1)
      return result;
    result.push_back({next, count[next]});
  }
}

/// Moves the body by the OFFSET of a joint that carries it, if its position channels are added to that, or back if they are not.
/// Its values alone do not tell: of who lies they are as small. But without the OFFSET the body would hang below the floor, and
/// the lowest joint as deep as the OFFSET is high.
void settle_offsets(const Hierarchy &hierarchy, const std::vector<bool> &added, SourceMotion &clip) {
  for (const auto &[joint, count] : carriers(hierarchy)) {
    Vector3d offset = Vector3d::Zero(); // along axes with a channel
    for (const Channel &channel : hierarchy.channels)
      if (channel.joint == static_cast<int>(joint) && !channel.rotation)
        offset[channel.axis] = hierarchy.joints[joint].offset[channel.axis];
    if (offset.squaredNorm() == 0)
      continue;
    const int parent = hierarchy.joints[joint].parent;
    const auto way = [&](std::size_t t) { return parent < 0 ? offset : Vector3d(clip.rotations[t][parent] * offset); };
    const auto first = static_cast<Eigen::Index>(joint), rows = static_cast<Eigen::Index>(count);
    std::vector<double> lowest; // in lengths of the OFFSET, if it is not added
    for (std::size_t t = 0; t < clip.positions.size(); ++t) {
      const Vector3d from = parent < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(clip.positions[t].row(parent));
      const Eigen::VectorXd heights = clip.positions[t].middleRows(first, rows) * way(t);
      lowest.push_back((heights.minCoeff() - from.dot(way(t))) / offset.squaredNorm() - (added[joint] ? 1.0 : 0.0));
    }
    const bool is_added = median(lowest) < -0.5 && (parent < 0 || added[joint]);
    if (is_added == added[joint])
      continue;
    for (std::size_t t = 0; t < clip.positions.size(); ++t)
      clip.positions[t].middleRows(first, rows).rowwise() += (is_added ? 1.0 : -1.0) * way(t).transpose();
  }
}

// --- writing

constexpr const char *kPlaceChannels = "Xposition Yposition Zposition ", *kTurnChannels = "Yrotation Xrotation Zrotation";

std::string three(const Vector3d &v) {
  return fixed_point(v.x() + 0.0, 6) + " " + fixed_point(v.y() + 0.0, 6) + " " + fixed_point(v.z() + 0.0, 6);
}

/// A joint and what hangs on it; `order` takes the joints as they come, which is the order of the channels.
void write_joint(std::ostream &out, const Skeleton &skeleton, int joint, const std::string &indent, std::vector<int> &order) {
  const Joint &j = skeleton.joints[joint];
  order.push_back(joint);
  const bool root = j.parent < 0;
  out << indent << (root ? "ROOT " : "JOINT ") << j.name << "\n" << indent << "{\n";
  const std::string inner = indent + "\t";
  out << inner << "OFFSET " << three(root ? j.rest : Vector3d(j.rest - skeleton.joints[j.parent].rest)) << "\n";
  out << inner << "CHANNELS " << (root ? "6 " : "3 ") << (root ? kPlaceChannels : "") << kTurnChannels << "\n";
  bool is_end = true;
  for (int child = joint + 1; child < skeleton.joint_count(); ++child)
    if (skeleton.joints[child].parent == joint) {
      write_joint(out, skeleton, child, inner, order);
      is_end = false;
    }
  if (is_end)
    out << inner << "End Site\n" << inner << "{\n" << inner << "\tOFFSET 0.000000 0.000000 0.000000\n" << inner << "}\n";
  out << indent << "}\n";
}

/// Degrees about Y, X and Z, of R = Ry Rx Rz.
Vector3d yxz_degrees(const Eigen::Matrix3d &r) {
  const double x = std::asin(std::clamp(-r(1, 2), -1.0, 1.0));
  const bool locked = std::abs(r(1, 2)) > 1 - 1e-12; // Y and Z are one axis then
  const double y = locked ? std::atan2(-r(2, 0), r(0, 0)) : std::atan2(r(0, 2), r(2, 2));
  const double z = locked ? 0 : std::atan2(r(1, 0), r(1, 1));
  return Vector3d(y, x, z) * 180 / M_PI;
}

/// The same turn nearest to the one of the frame before, so that a program that blends between frames does not spin.
Vector3d continued(const Vector3d &angles, const Vector3d &before) {
  const auto near_before = [&](Vector3d a) {
    for (int k = 0; k < 3; ++k)
      a[k] += 360 * std::round((before[k] - a[k]) / 360);
    return a;
  };
  const Vector3d one = near_before(angles), other = near_before({angles[0] + 180, 180 - angles[1], angles[2] + 180});
  return (one - before).norm() <= (other - before).norm() ? one : other;
}

} // namespace

void write_bvh(const std::filesystem::path &path, const Skeleton &skeleton, const Motion &motion) {
  if (motion.dofs.rows() == 0 || motion.dofs.cols() != skeleton.dof_count() || !motion.dofs.allFinite() ||
      !(motion.fps >= kLowestRate && motion.fps <= kHighestRate))
    throw std::invalid_argument("write_bvh: expected finite poses of " + std::to_string(skeleton.dof_count()) +
                                " degrees of freedom and a rate in [0.1, 100000], found (" + std::to_string(motion.dofs.rows()) +
                                ", " + std::to_string(motion.dofs.cols()) + ") at " + options::to_text(motion.fps) + " 1/s");
  write_stream(path, [&](std::ostream &out) {
    std::vector<int> order;
    out << "HIERARCHY\n";
    write_joint(out, skeleton, 0, "", order);
    out << "MOTION\nFrames: " << motion.dofs.rows() << "\nFrame Time: " << fixed_point(1 / motion.fps, 9) << "\n";
    std::vector<Vector3d> before(order.size(), Vector3d::Zero());
    for (Eigen::Index t = 0; t < motion.dofs.rows(); ++t) {
      const Transforms world = forward_kinematics(skeleton, motion.dofs.row(t));
      out << three(world[0] * skeleton.joints[0].rest);
      for (std::size_t i = 0; i < order.size(); ++i) {
        const int j = order[i], p = skeleton.joints[j].parent;
        const Eigen::Matrix3d turn =
            p < 0 ? Eigen::Matrix3d(world[j].linear()) : Eigen::Matrix3d(world[p].linear().transpose() * world[j].linear());
        before[i] = continued(yxz_degrees(turn), before[i]);
        out << " " << three(before[i]);
      }
      out << "\n";
    }
  });
}

SourceMotion parse_bvh(const std::string &text, const std::string &source) {
  LineReader reader(text, source, false);
  const Hierarchy hierarchy = read_hierarchy(reader);
  SourceMotion clip;
  clip.source = source;
  const MatrixRM values = read_values(reader, hierarchy, source, clip.fps);
  const std::vector<bool> added = find_added(hierarchy, values);
  clip.joints = hierarchy.joints;
  clip.positions.resize(values.rows());
  clip.rotations.resize(values.rows());
  for (Eigen::Index t = 0; t < values.rows(); ++t)
    pose_frame(hierarchy, added, values.row(t), clip.positions[t], clip.rotations[t]);
  settle_offsets(hierarchy, added, clip);
  return clip;
}

} // namespace doublet
