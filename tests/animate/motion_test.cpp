#include "doublet/animate/plant_feet.h"
#include "doublet/animate/retarget.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/files/files.h"
#include "figure_character.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <iomanip>
#include <random>

using namespace doublet;
using namespace doublet::testing;

namespace {

const char *kTwoBones = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Arm
  {
    OFFSET 0 10 0
    CHANNELS 3 Yrotation Zrotation Xrotation
    End Site
    {
      OFFSET 5 0 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.025
0 0 0 0 0 0 0 0 0
1 2 3 90 0 0 0 90 0
)";

std::string replaced(std::string text, const std::string &from, const std::string &to) {
  return text.replace(text.find(from), from.size(), to);
}

void expect_error(const std::string &bvh, const std::string &line) {
  try {
    parse_bvh(bvh, "clip.bvh");
    ADD_FAILURE() << "no error for line " << line;
  } catch (const Error &error) {
    EXPECT_EQ(std::string(error.what()).rfind("clip.bvh:" + line + ":", 0), 0u) << error.what();
  }
}

/// Our own skeleton and pose as BVH, rest = rest pose, lengths times `unit`, bones of the limbs times `stretch`.
std::string figure_bvh(const Skeleton &skeleton, const MatrixRM &dofs, double unit, double fps, double stretch = 1) {
  std::ostringstream out;
  out << std::setprecision(10) << "HIERARCHY\n";
  std::vector<std::vector<int>> children(skeleton.joint_count());
  for (int j = 1; j < skeleton.joint_count(); ++j)
    children[skeleton.joints[j].parent].push_back(j);
  std::vector<int> order;
  const std::function<void(int)> write = [&](int j) {
    const Joint &joint = skeleton.joints[j];
    order.push_back(j);
    Eigen::Vector3d offset =
        joint.parent < 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(joint.rest - skeleton.joints[joint.parent].rest);
    offset *= unit * stretch;
    out << (j == 0 ? "ROOT " : "JOINT ") << joint.name << "\n{\nOFFSET " << offset.transpose() << "\nCHANNELS "
        << (j == 0 ? 6 : 3) << (j == 0 ? " Xposition Yposition Zposition" : "") << " Yrotation Xrotation Zrotation\n";
    for (int c : children[j])
      write(c);
    if (children[j].empty())
      out << "End Site\n{\nOFFSET 0 0.1 0\n}\n";
    out << "}\n";
  };
  write(0);
  out << "MOTION\nFrames: " << dofs.rows() << "\nFrame Time: " << 1 / fps << "\n";
  for (Eigen::Index t = 0; t < dofs.rows(); ++t) {
    const Transforms world = forward_kinematics(skeleton, dofs.row(t));
    for (int j : order) {
      const int p = skeleton.joints[j].parent;
      const Eigen::Matrix3d local =
          p < 0 ? Eigen::Matrix3d(world[j].linear()) : Eigen::Matrix3d(world[p].linear().transpose() * world[j].linear());
      if (p < 0)
        out << (unit * stretch * (world[0] * skeleton.joints[0].rest)).transpose() << " ";
      const double x = std::asin(std::clamp(-local(1, 2), -1.0, 1.0));
      out << std::atan2(local(0, 2), local(2, 2)) * 180 / pi << " " << x * 180 / pi << " "
          << std::atan2(local(1, 0), local(1, 1)) * 180 / pi << " ";
    }
    out << "\n";
  }
  return out.str();
}

RetargetOptions alone() {
  RetargetOptions options;
  options.hold_seconds = options.blend_seconds = 0;
  options.plant_feet = false;
  return options;
}

/// Mean distance of the joints in two poses, m.
double joint_distance(const Skeleton &skeleton, const Eigen::VectorXd &a, const Eigen::VectorXd &b) {
  return (joint_positions(skeleton, forward_kinematics(skeleton, a)) - joint_positions(skeleton, forward_kinematics(skeleton, b)))
      .rowwise()
      .norm()
      .mean();
}

const char *kAsf = R"(:version 1.10
:name TEST
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name upper
    direction 1 0 0
    length 2
    axis 0 0 90 XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-70.0 70.0)
  end
  begin
    id 2
    name lower
    direction 0 1 0
    length 3
    axis 0 0 0 XYZ
    dof rz
  end
:hierarchy
  begin
    root upper
    upper lower
  end
)";

} // namespace

TEST(Bvh, ForwardKinematicsHasKnownValues) {
  const SourceMotion clip = parse_bvh(kTwoBones, "clip.bvh");
  ASSERT_EQ(clip.joints.size(), 3u);
  EXPECT_EQ(clip.joints[2].name, "Arm_end");
  EXPECT_DOUBLE_EQ(clip.fps, 40);
  EXPECT_TRUE(clip.zero_positions().row(2).isApprox(Eigen::RowVector3d(5, 10, 0)));
  // The root at (1, 2, 3) turns by 90 degrees about z: +y becomes -x. The arm turns by 90 degrees more: its +x points to -x of
  // the world.
  EXPECT_TRUE(clip.positions[1].row(1).isApprox(Eigen::RowVector3d(-9, 2, 3), 1e-12));
  EXPECT_TRUE(clip.positions[1].row(2).isApprox(Eigen::RowVector3d(-14, 2, 3), 1e-12));
}

TEST(Bvh, RotationOrderIsThatOfTheChannels) {
  const std::string zxy = replaced(kTwoBones, "1 2 3 90 0 0 0 90 0", "0 0 0 90 90 0 0 0 0");
  // R = Rz(90) Rx(90): +y -> +z -> +z
  EXPECT_TRUE(parse_bvh(zxy, "a").positions[1].row(1).isApprox(Eigen::RowVector3d(0, 0, 10), 1e-12));
  const std::string xzy = replaced(zxy, "Zrotation Xrotation Yrotation", "Xrotation Zrotation Yrotation");
  // R = Rx(90) Rz(90): +y -> -x -> -x
  EXPECT_TRUE(parse_bvh(xzy, "a").positions[1].row(1).isApprox(Eigen::RowVector3d(-10, 0, 0), 1e-12));
}

TEST(Bvh, PositionChannelsReplaceOrAddToTheOffset) {
  std::string text = replaced(kTwoBones, "CHANNELS 3 Yrotation Zrotation Xrotation",
                              "CHANNELS 6 Zposition Xposition Yposition Yrotation Zrotation Xrotation");
  std::string replaces = replaced(replaced(text, "0 0 0 0 0 0 0 0 0", "0 0 0 0 0 0 0 0 10 0 0 0"), "1 2 3 90 0 0 0 90 0",
                                  "0 0 0 0 0 0 1 0 11 0 0 0");
  EXPECT_TRUE(parse_bvh(replaces, "a").positions[1].row(1).isApprox(Eigen::RowVector3d(0, 11, 1), 1e-12));
  std::string adds =
      replaced(replaced(text, "0 0 0 0 0 0 0 0 0", "0 0 0 0 0 0 0 0 0 0 0 0"), "1 2 3 90 0 0 0 90 0", "0 0 0 0 0 0 1 0 1 0 0 0");
  EXPECT_TRUE(parse_bvh(adds, "a").positions[1].row(1).isApprox(Eigen::RowVector3d(0, 11, 1), 1e-12));
}

TEST(Bvh, WhoLiesLowIsNotTakenForOneWhosePlaceIsAddedToTheOffset) {
  const TempFolder folder;
  const Skeleton skeleton = figure_skeleton();
  MatrixRM lying = marching(skeleton, 20, 40);
  lying.col(1).array() += 0.2 - skeleton.joints[0].rest.y(); // face down, 20 cm over the floor
  lying.col(4).setConstant(M_PI / 2);
  write_bvh(folder / "lying.bvh", skeleton, {40, lying}); // the root's OFFSET is its place in the rest pose
  const SourceMotion clip = read_motion_file(folder / "lying.bvh");
  for (int t = 0; t < 20; ++t)
    EXPECT_LT((clip.positions[t].row(0) - joint_positions(skeleton, forward_kinematics(skeleton, lying.row(t))).row(0)).norm(),
              1e-5);
  // Nor if he hangs on a root that stands still.
  const std::string root = "ROOT " + skeleton.joints[0].name;
  const std::string below = replaced(
      replaced(read_text(folder / "lying.bvh"), root, "ROOT Reference\n{\nOFFSET 0 0 0\nJOINT hips"), "MOTION", "}\nMOTION");
  const SourceMotion carried = parse_bvh(below, "a");
  for (int t = 0; t < 20; ++t)
    EXPECT_LT((carried.positions[t].bottomRows(clip.positions[t].rows()) - clip.positions[t]).norm(), 1e-9);
  const Motion motion = retarget(clip, skeleton, alone());
  const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(19)));
  EXPECT_LT(joints.row(skeleton.find("chest")).y() - joints.row(skeleton.find("l_hip")).y(), 0.1); // nor set upright
  // What stands at 0, its lowest joint as far below: added.
  std::string stands = replaced(kTwoBones, "1 2 3 90 0 0 0 90 0", "0 0 0 0 0 0 0 0 0");
  stands = replaced(replaced(stands, "OFFSET 0 10 0", "OFFSET 0 -10 0"), "OFFSET 0 0 0", "OFFSET 0 10 0");
  EXPECT_TRUE(parse_bvh(stands, "a").positions[0].row(0).isApprox(Eigen::RowVector3d(0, 10, 0), 1e-12));
}

TEST(Bvh, BrokenFilesNameTheLine) {
  expect_error("", "0");
  expect_error("ROOT Hips\n", "1");
  expect_error(replaced(kTwoBones, "OFFSET 0 10 0", "OFFSET 0 ten 0"), "8");
  expect_error(replaced(kTwoBones, "OFFSET 0 10 0", "OFFSET 0 10"), "8");
  expect_error(replaced(kTwoBones, "Yrotation Zrotation Xrotation", "Yrotation Zrotation Wrotation"), "9");
  expect_error(replaced(kTwoBones, "CHANNELS 3", "CHANNELS 4"), "9");
  expect_error(replaced(kTwoBones, "MOTION", "NOTION"), "16");
  expect_error(replaced(kTwoBones, "Frame Time: 0.025", "Frame Time: 0"), "18");
  expect_error(replaced(kTwoBones, "Frames: 2", "Frames: 3"), "20");
  expect_error(replaced(kTwoBones, "Frames: 2", "Frames: 1"), "20");
  expect_error(replaced(kTwoBones, "1 2 3 90 0 0 0 90 0", "1 2 3 90 0 0 0 90"), "20");
  expect_error(replaced(kTwoBones, "1 2 3 90", "1 2 nan 90"), "20");
  expect_error(std::string(kTwoBones).substr(0, 150), "9");
}

TEST(Acclaim, ForwardKinematicsHasKnownValues) {
  const SourceMotion clip =
      parse_acclaim(kAsf, ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 0 0 90\nupper 90 0\nlower 90\n", "a.asf", "a.amc");
  ASSERT_EQ(clip.joints.size(), 4u);
  EXPECT_TRUE(clip.zero_positions().row(3).isApprox(Eigen::RowVector3d(2, 3, 0)));
  // The root turns by 90 about z. `upper` turns by 90 about its own x, which its axis frame points along the rest pose's y, and
  // with the root along the world's -x: the bone along the world's y is carried to -z.
  EXPECT_TRUE(clip.positions[0].row(2).isApprox(Eigen::RowVector3d(1, 2, 1), 1e-9)) << clip.positions[0];
  // C M C^-1 = Ry(90); the chain Rz(90) Ry(90) Rz(90) takes `lower` from +y: -x -> +z -> +z.
  EXPECT_TRUE(clip.positions[0].row(3).isApprox(Eigen::RowVector3d(1, 2, 4), 1e-9)) << clip.positions[0];
}

TEST(Acclaim, AnglesAreThoseOfTheSkeletonUnlessTheMotionSaysOthers) {
  const std::string radians = replaced(kAsf, "angle deg", "angle rad"), frame = "1\nroot 0 0 0 0 0 1.5\nupper 0 0\nlower 0\n";
  const auto turned = [](const SourceMotion &clip) { return 2 * std::acos(clip.rotations[0][0].w()); };
  EXPECT_NEAR(turned(parse_acclaim(radians, frame, "a.asf", "a.amc")), 1.5, 1e-9);
  EXPECT_NEAR(turned(parse_acclaim(radians, ":DEGREES\n" + frame, "a.asf", "a.amc")), 1.5 * M_PI / 180, 1e-9);
  EXPECT_NEAR(turned(parse_acclaim(kAsf, ":RADIANS\n" + frame, "a.asf", "a.amc")), 1.5, 1e-9);
}

TEST(Acclaim, BrokenFilesNameTheLine) {
  const auto message = [](const std::string &asf, const std::string &amc) -> std::string {
    try {
      parse_acclaim(asf, amc, "a.asf", "a.amc");
      return "no error";
    } catch (const Error &error) {
      return error.what();
    }
  };
  const std::string amc = ":DEGREES\n1\nroot 0 0 0 0 0 0\nupper 0 0\nlower 0\n";
  EXPECT_EQ(message(kAsf, amc), "no error");
  EXPECT_EQ(message(kAsf, replaced(amc, "upper 0 0", "upper 0")).rfind("a.amc:4:", 0), 0u);
  EXPECT_EQ(message(kAsf, replaced(amc, "upper 0 0", "other 0 0")).rfind("a.amc:4:", 0), 0u);
  EXPECT_EQ(message(kAsf, replaced(amc, "lower 0\n", "")).rfind("a.amc:2:", 0), 0u);
  EXPECT_EQ(message(kAsf, "").rfind("a.amc:", 0), 0u);
  EXPECT_EQ(message(replaced(kAsf, "length 3", "length x"), amc).rfind("a.asf:27:", 0), 0u)
      << message(replaced(kAsf, "length 3", "length x"), amc);
  EXPECT_EQ(message(replaced(kAsf, "upper lower", "upper nobody"), amc).rfind("a.asf:34:", 0), 0u);
  EXPECT_NE(message("", amc), "no error");
}

TEST(MotionFile, FindsTheSkeletonOfAnAmc) {
  const TempFolder folder;
  write_text(folder / "dance.asf", kAsf);
  write_text(folder / "dance2.amc", ":DEGREES\n1\nroot 0 0 0 0 0 0\nupper 0 0\nlower 0\n");
  EXPECT_EQ(read_motion_file(folder / "dance2.amc").frame_count(), 1);
  write_text(folder / "walk.amc", "");
  EXPECT_THROW(read_motion_file(folder / "walk.amc"), FileNotFound);
  EXPECT_THROW(read_motion_file(folder / "none.bvh"), FileNotFound);
  EXPECT_THROW(read_motion_file(folder / "dance.fbx"), Error);
}

TEST(MotionFile, DamagedTextIsReadOrRefusedNeverMore) {
  const Skeleton skeleton = figure_skeleton();
  const std::string bvh = figure_bvh(skeleton, marching(skeleton, 3, 40), 1, 40);
  const std::string amc = ":DEGREES\n1\nroot 0 0 0 0 0 0\nupper 0 0\nlower 0\n";
  std::mt19937 random(7);
  const auto damaged = [&](std::string text) {
    for (int i = 0; i < 3 && !text.empty(); ++i) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, random() % 40);
      else
        text[at] = static_cast<char>(random() % 96 + 32);
    }
    return text;
  };
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    try {
      const SourceMotion clip = parse_bvh(damaged(bvh), "a.bvh");
      const Motion motion = retarget(clip, skeleton);
      EXPECT_TRUE(motion.dofs.allFinite());
    } catch (const Error &) {
      ++refused;
    }
    try {
      parse_acclaim(damaged(kAsf), damaged(amc), "a.asf", "a.amc");
    } catch (const Error &) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
}

TEST(Retarget, OwnMotionComesBack) {
  const Skeleton skeleton = figure_skeleton();
  const MatrixRM dofs = marching(skeleton, 40, 40);
  RetargetOptions options = alone();
  options.ground_feet = false; // the figure marches on straight legs
  const Motion motion = retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "own.bvh"), skeleton, options);
  ASSERT_EQ(motion.dofs.rows(), 40);
  EXPECT_NEAR(motion.fps, 40, 1e-6);
  for (int t = 0; t < 40; ++t)
    EXPECT_LT(joint_distance(skeleton, motion.dofs.row(t), dofs.row(t)), 2e-3) << t;
}

TEST(Retarget, NeitherUnitNorSizeMatters) {
  const Skeleton skeleton = figure_skeleton();
  const MatrixRM dofs = marching(skeleton, 20, 40);
  const Motion metres = retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "m.bvh"), skeleton, alone());
  for (const auto &[unit, stretch] : {std::pair{100.0, 1.0}, {39.37, 1.0}, {1.0, 1.3}}) {
    const Motion other = retarget(parse_bvh(figure_bvh(skeleton, dofs, unit, 40, stretch), "u.bvh"), skeleton, alone());
    for (int t = 0; t < 20; ++t)
      EXPECT_LT(joint_distance(skeleton, metres.dofs.row(t), other.dofs.row(t)), 1e-4) << unit << " " << stretch;
  }
}

TEST(Retarget, FacingAndPlaceOfTheFileDoNotMatter) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 20, 40), turned = dofs;
  turned.col(0).array() += 3;
  turned.col(3).array() += 2;
  const Motion a = retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh"), skeleton, alone());
  const Motion b = retarget(parse_bvh(figure_bvh(skeleton, turned, 1, 40), "b.bvh"), skeleton, alone());
  for (int t = 0; t < 20; ++t)
    EXPECT_LT(joint_distance(skeleton, a.dofs.row(t), b.dofs.row(t)), 2e-3);
  RetargetOptions keep = alone();
  keep.align_start = false;
  const Motion c = retarget(parse_bvh(figure_bvh(skeleton, turned, 1, 40), "c.bvh"), skeleton, keep);
  EXPECT_NEAR(c.dofs(0, 0), 3, 0.02);
  EXPECT_NEAR(c.dofs(0, 3), 2, 0.02);
}

TEST(Retarget, WhoLiesIsNotSetUprightAndAWorldOnItsSideIs) {
  const Skeleton skeleton = figure_skeleton();
  const MatrixRM upright = marching(skeleton, 20, 40);
  const double hips = skeleton.joints[0].rest.y();
  MatrixRM lying = upright, turned = upright;
  lying.col(1).array() += 0.2 - hips; // face down, 20 cm over the floor
  lying.col(4).setConstant(M_PI / 2);
  turned.col(1).array() -= hips; // the same turn, but where +Z is up the floor is at its feet
  turned.col(2).array() += hips;
  turned.col(4).setConstant(M_PI / 2);
  MatrixRM gets_up = lying;
  gets_up.bottomRows(4) = upright.bottomRows(4);
  const auto chest_from_hip = [&](const MatrixRM &dofs, Eigen::Vector3d up = Eigen::Vector3d::Zero()) {
    SourceMotion clip = parse_bvh(figure_bvh(skeleton, dofs, 100, 40), "a.bvh");
    clip.up = up;
    const Motion motion = retarget(clip, skeleton, alone());
    std::vector<Eigen::Vector3d> ways;
    for (const Eigen::Index t : {Eigen::Index{0}, motion.dofs.rows() - 1}) {
      const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(t)));
      ways.push_back(joints.row(skeleton.find("chest")) - joints.row(skeleton.find("l_hip")));
    }
    return ways;
  };
  const double standing = chest_from_hip(upright)[0].y();
  EXPECT_NEAR(chest_from_hip(turned)[0].y(), standing, 0.02);
  EXPECT_LT(chest_from_hip(lying)[0].y(), 0.3 * standing);
  EXPECT_GT(chest_from_hip(lying)[0].z(), 0.8 * standing) << "the head is where the actor looks in the rest pose";
  EXPECT_LT(chest_from_hip(gets_up)[0].y(), 0.3 * standing);
  EXPECT_NEAR(chest_from_hip(gets_up)[1].y(), standing, 0.02);
  EXPECT_LT(chest_from_hip(turned, Eigen::Vector3d::UnitY())[0].y(), 0.3 * standing) << "the format has +Y up";
}

TEST(Retarget, WhoLiesIsNotSetUprightWhereverTheFloorIs) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM crawling = MatrixRM::Zero(20, skeleton.dof_count()), still = crawling;
  crawling.col(1).setConstant(-3);
  crawling.col(2) = Eigen::VectorXd::LinSpaced(20, 0, 1.5);
  crawling.col(4).setConstant(M_PI / 2); // face down, the head along +Z
  still.col(1).setConstant(-3);
  still.rightCols(still.cols() - 3).leftCols(2).setConstant(M_PI / 2); // along +X
  const auto slope = [&](const MatrixRM &dofs) {
    const Motion motion = retarget(parse_bvh(figure_bvh(skeleton, dofs, 100, 40), "a.bvh"), skeleton, alone());
    const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(19)));
    return (joints.row(skeleton.find("chest")) - joints.row(skeleton.find("l_hip"))).normalized().y();
  };
  EXPECT_LT(slope(crawling), 0.3);
  EXPECT_LT(slope(still), 0.3);
}

TEST(Retarget, TheAxisThatAFormatHasDecidesWhereTheBodyMayLie) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM lying = MatrixRM::Zero(20, skeleton.dof_count());
  lying.col(1) = Eigen::VectorXd::LinSpaced(20, 1, 3); // along +Y of a world with +Z up, 20 cm over the floor
  lying.col(2).setConstant(0.2);
  SourceMotion clip = parse_bvh(figure_bvh(skeleton, lying, 1, 40), "a.bvh");
  const auto slope = [&] {
    const Motion motion = retarget(clip, skeleton, alone());
    const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(19)));
    return (joints.row(skeleton.find("chest")) - joints.row(skeleton.find("l_hip"))).normalized().y();
  };
  EXPECT_GT(slope(), 0.9);
  clip.up = Eigen::Vector3d::UnitZ();
  EXPECT_LT(slope(), 0.3);
}

/// The same motion counted from another zero pose: how the joints stand at a frame.
SourceMotion from_frame(SourceMotion clip, int frame) {
  const Vertices zero = clip.positions[frame];
  const std::vector<Eigen::Quaterniond> turned = clip.rotations[frame];
  for (std::size_t j = 0; j < clip.joints.size(); ++j) {
    const int p = clip.joints[j].parent;
    clip.joints[j].offset = zero.row(j) - (p < 0 ? Eigen::RowVector3d::Zero().eval() : zero.row(p).eval());
    for (auto &rotations : clip.rotations)
      rotations[j] = rotations[j] * turned[j].conjugate();
  }
  return clip;
}

TEST(Retarget, AZeroPoseThatIsAFrameOfTheMotionDoesNotSetTheTrunkUpright) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 40, 40);
  dofs.col(4).setConstant(0.4);                // leans ahead ...
  dofs.bottomRows(20).col(5).setConstant(0.3); // ... then to a side
  const SourceMotion clip = parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh");
  RetargetOptions options = alone();
  options.ground_feet = false;
  const Motion right = retarget(clip, skeleton, options);
  for (const int zero : {0, 10, 35}) {
    const Motion motion = retarget(from_frame(clip, zero), skeleton, options);
    for (int t = 0; t < 40; t += 3)
      EXPECT_LT(joint_distance(skeleton, motion.dofs.row(t), right.dofs.row(t)), 0.03) << zero << " " << t;
  }
}

TEST(Retarget, FeetReachTheFloor) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 30, 40);
  dofs.col(1).array() += 0.4; // floats
  const Motion motion = retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh"), skeleton, alone());
  double lowest = 1e9;
  for (int t = 0; t < 30; ++t) {
    const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(t)));
    for (const char *name : {"l_ankle", "r_ankle", "l_toe", "r_toe"})
      lowest = std::min(lowest, joints(skeleton.find(name), 1) - skeleton.joints[skeleton.find(name)].rest.y());
  }
  EXPECT_NEAR(lowest, 0, 0.005);
}

TEST(Retarget, FeetArePlantedUnlessRefused) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 30, 40);
  const SourceMotion clip = parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh");
  RetargetOptions options = alone();
  const Motion off = retarget(clip, skeleton, options);
  options.plant_feet = true;
  const Motion on = retarget(clip, skeleton, options);
  EXPECT_EQ(on.dofs, plant_feet(skeleton, off).dofs);
  EXPECT_NE(on.dofs, off.dofs);
}

TEST(Retarget, StartBlendsOutOfTheRestPose) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 20, 40);
  dofs.col(skeleton.joints[skeleton.find("l_shoulder")].first_dof + 2).array() += 1;
  RetargetOptions options;
  options.hold_seconds = 0.1;
  options.blend_seconds = 0.5;
  const Motion motion = retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh"), skeleton, options);
  ASSERT_EQ(motion.dofs.rows(), 44);
  for (int t = 0; t <= 4; ++t)
    EXPECT_EQ(motion.dofs.row(t).norm(), 0);
  for (int t = 0; t + 1 < 24; ++t)
    EXPECT_LT(joint_distance(skeleton, motion.dofs.row(t), motion.dofs.row(t + 1)), 0.02);
}

TEST(Retarget, ReferenceFirstFrameIsLeftOut) {
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 21, 40);
  dofs.row(0).setZero();
  dofs.bottomRows(20).col(2).array() += 4;
  EXPECT_EQ(retarget(parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "a.bvh"), skeleton, alone()).dofs.rows(), 20);
}

TEST(Retarget, OneJointPlaysOnePart) {
  const Skeleton skeleton = figure_skeleton();
  const SourceMotion clip = parse_bvh(figure_bvh(skeleton, marching(skeleton, 4, 40), 1, 40), "a.bvh");
  const auto message = [&](const std::map<std::string, std::string> &given) -> std::string {
    try {
      match_joints(clip, given);
      return "no error";
    } catch (const Error &error) {
      return error.what();
    }
  };
  const std::string both = "a.bvh: expected another joint for l_hip and r_hip, found 'r_hip' for both";
  EXPECT_EQ(message({{"l_hip", "r_hip"}, {"r_hip", "r_hip"}}).rfind(both, 0), 0u);
  EXPECT_EQ(message({{"l_hip", "r_hip"}}).rfind(both, 0), 0u) << "that of the other is found by its name";
  EXPECT_NE(message({{"l_ankle", "l_toe"}, {"l_toe", "l_toe"}}), "no error");
  EXPECT_NE(message({{"chest", "l_hip"}}), "no error");
  EXPECT_EQ(message({{"chest", "pelvis"}}), "no error") << "a trunk of one piece";
  EXPECT_EQ(message({{"l_hand", "l_wrist"}, {"l_toe", ""}}), "no error");
}

TEST(Retarget, ATrunkOfOneJointStaysUpright) {
  const Skeleton skeleton = figure_skeleton();
  const SourceMotion clip = parse_bvh(figure_bvh(skeleton, marching(skeleton, 20, 40), 100, 40), "a.bvh");
  RetargetOptions one = alone();
  one.joint_names = {{"chest", "pelvis"}, {"spine", ""}};
  const Motion motion = retarget(clip, skeleton, one);
  for (int t = 0; t < 20; ++t) {
    const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, motion.dofs.row(t)));
    const Eigen::RowVector3d trunk = joints.row(skeleton.find("chest")) - joints.row(skeleton.find("pelvis"));
    EXPECT_GT(trunk.y(), 0.95 * trunk.norm()) << t;
  }
}

TEST(Retarget, NamesOfTheField) {
  const Skeleton skeleton = figure_skeleton();
  const std::string own = figure_bvh(skeleton, marching(skeleton, 4, 40), 1, 40);
  const std::vector<std::map<std::string, std::string>> rigs{{{"hip", "UpLeg"},
                                                              {"knee", "Leg"},
                                                              {"ankle", "Foot"},
                                                              {"toe", "ToeBase"},
                                                              {"clavicle", "Shoulder"},
                                                              {"shoulder", "Arm"},
                                                              {"elbow", "ForeArm"},
                                                              {"wrist", "Hand"},
                                                              {"hand", "HandMiddle1"}},
                                                             {{"hip", "Thigh"},
                                                              {"knee", "Calf"},
                                                              {"ankle", "Foot"},
                                                              {"toe", "ToeBase"},
                                                              {"clavicle", "Clavicle"},
                                                              {"shoulder", "Upperarm"},
                                                              {"elbow", "Forearm"},
                                                              {"wrist", "Hand"},
                                                              {"hand", "Mid1"}}};
  for (std::size_t r = 0; r < rigs.size(); ++r) {
    std::string text = own;
    for (const auto &[ours, theirs] : rigs[r])
      for (const std::string side : {"l", "r"}) {
        const std::string long_side = side == "l" ? "Left" : "Right";
        const std::string name =
            r == 0 ? "mixamorig:" + long_side + theirs : "CC_Base_" + std::string(side == "l" ? "L_" : "R_") + theirs;
        text = replaced(text, "JOINT " + side + "_" + ours + "\n", "JOINT " + name + "\n");
      }
    const auto found = match_joints(parse_bvh(text, "rig.bvh"));
    const auto expected = match_joints(parse_bvh(own, "own.bvh"));
    for (const auto &[part, joint] : expected)
      EXPECT_EQ(found.at(part), joint) << part << " of rig " << r;
  }
}

TEST(Retarget, ArmsAreOnTheSideOfTheirLegsWhereBothLegsBeginInThePelvis) {
  const Skeleton skeleton = figure_skeleton();
  const SourceMotion own = parse_bvh(figure_bvh(skeleton, marching(skeleton, 10, 40), 100, 40), "own.bvh");
  SourceMotion clip = own; // with a joint more a leg, of no length, as CMU's; the names say nothing
  clip.joints.clear();
  std::vector<int> rows, now;
  for (int j = 0; j < static_cast<int>(own.joints.size()); ++j) {
    SourceJoint joint = own.joints[j];
    joint.parent = joint.parent < 0 ? -1 : now[joint.parent];
    if (joint.name == "l_hip" || joint.name == "r_hip") {
      rows.push_back(own.joints[j].parent);
      clip.joints.push_back({"bone" + std::to_string(clip.joints.size()), joint.parent, Eigen::Vector3d::Zero()});
      joint.parent = static_cast<int>(clip.joints.size()) - 1;
    }
    now.push_back(static_cast<int>(clip.joints.size()));
    rows.push_back(j);
    joint.name = "bone" + std::to_string(clip.joints.size());
    clip.joints.push_back(joint);
  }
  for (std::size_t t = 0; t < own.positions.size(); ++t) {
    clip.positions[t].resize(static_cast<Eigen::Index>(rows.size()), 3);
    clip.rotations[t].clear();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      clip.positions[t].row(static_cast<Eigen::Index>(k)) = own.positions[t].row(rows[k]);
      clip.rotations[t].push_back(own.rotations[t][rows[k]]);
    }
  }
  const auto found = match_joints(clip), expected = match_joints(own);
  for (const char *part : {"l_hip", "r_knee", "l_shoulder", "r_elbow", "l_wrist"})
    EXPECT_EQ(found.at(part), now[expected.at(part)]) << part;
}

TEST(Retarget, ZeroPoseNeedNotBeAStance) {
  // The same motion on a rig with bone-local frames: in its zero pose every limb points up. Only the pose of the joints is the
  // same, the roll has to be found from the clip.
  const Skeleton skeleton = figure_skeleton();
  MatrixRM dofs = marching(skeleton, 40, 40);
  for (int t = 0; t < 40; ++t)
    for (const char *joint : {"l_knee", "r_knee", "l_elbow", "r_elbow"})
      dofs(t, skeleton.joints[skeleton.find(joint)].first_dof) = 0.5 + 0.3 * std::sin(0.3 * t);
  SourceMotion clip = parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "own.bvh");
  RetargetOptions options = alone();
  options.ground_feet = false;
  const Motion straight = retarget(clip, skeleton, options);
  std::vector<Eigen::Quaterniond> local(clip.joints.size(), Eigen::Quaterniond::Identity()); // old zero pose from new zero pose
  const Vertices zero = clip.zero_positions();
  for (std::size_t j = 0; j < clip.joints.size(); ++j)
    for (const char *part : {"hip", "knee", "ankle", "shoulder", "elbow", "wrist"})
      for (std::size_t k = 0; k < clip.joints.size(); ++k)
        if (clip.joints[j].name.substr(1) == std::string("_") + part && clip.joints[k].parent == static_cast<int>(j))
          local[j] = Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())) *
                     shortest_turn(Eigen::Vector3d(zero.row(k) - zero.row(j)), Eigen::Vector3d::UnitY());
  for (std::size_t j = 0; j < clip.joints.size(); ++j)
    if (clip.joints[j].parent >= 0)
      clip.joints[j].offset = local[clip.joints[j].parent] * clip.joints[j].offset;
  for (auto &frame : clip.rotations)
    for (std::size_t j = 0; j < clip.joints.size(); ++j)
      frame[j] = frame[j] * local[j].conjugate();
  const Motion found = retarget(clip, skeleton, options);
  double worst = 0;
  for (int t = 0; t < 40; ++t)
    worst = std::max(worst, joint_distance(skeleton, straight.dofs.row(t), found.dofs.row(t)));
  EXPECT_LT(worst, 0.02);
}

TEST(Retarget, HandsWithoutEndsFollowTheForearm) {
  const Skeleton skeleton = figure_skeleton();
  const MatrixRM dofs = marching(skeleton, 10, 40);
  SourceMotion clip = parse_bvh(figure_bvh(skeleton, dofs, 1, 40), "own.bvh");
  RetargetOptions options = alone();
  options.ground_feet = false;
  for (SourceJoint &joint : clip.joints) // no direction left beyond the wrists
    if (joint.name.substr(1) == "_hand" || joint.name.substr(1) == "_hand_end")
      joint.name = "prop";
  const Motion motion = retarget(clip, skeleton, options);
  for (int t = 0; t < 10; ++t)
    EXPECT_LT(joint_distance(skeleton, motion.dofs.row(t), dofs.row(t)), 5e-3) << t;
}

TEST(Retarget, UnknownSkeletonSaysWhatIsMissing) {
  try {
    retarget(parse_bvh(kTwoBones, "arm.bvh"), figure_skeleton());
    ADD_FAILURE();
  } catch (const Error &error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("arm.bvh"), std::string::npos);
    EXPECT_NE(text.find("l_knee"), std::string::npos);
    EXPECT_NE(text.find("Hips"), std::string::npos);
  }
  RetargetOptions bad;
  bad.blend_seconds = -1;
  EXPECT_THROW(retarget(parse_bvh(kTwoBones, "arm.bvh"), figure_skeleton(), bad), std::invalid_argument);
}

TEST(Retarget, BonesHaveALength) {
  const Skeleton skeleton = figure_skeleton();
  SourceMotion clip = parse_bvh(figure_bvh(skeleton, marching(skeleton, 4, 40), 1, 40), "a.bvh");
  const std::map<std::string, int> found = match_joints(clip);
  for (Vertices &places : clip.positions)
    places.row(found.at("l_wrist")) = places.row(found.at("l_elbow")).eval();
  try {
    retarget(clip, skeleton, alone());
    ADD_FAILURE();
  } catch (const Error &error) {
    EXPECT_EQ(std::string(error.what()),
              "a.bvh: expected l_elbow and l_wrist at two places, found 'l_elbow' and 'l_wrist' at one");
  }
}

TEST(Retarget, AStartBehindTheClipIsRefused) {
  const Skeleton skeleton = figure_skeleton();
  const SourceMotion clip = parse_bvh(figure_bvh(skeleton, marching(skeleton, 4, 40), 1, 40), "a.bvh");
  for (const double second : {1.0, 1e8, 1e9}) { // times the rate more than an int holds
    RetargetOptions options = alone();
    options.first_second = second;
    EXPECT_THROW(retarget(clip, skeleton, options), Error) << second;
  }
}

TEST(Motion, ResamplingKeepsTheEnds) {
  const Skeleton skeleton = figure_skeleton();
  const Motion motion{120, marching(skeleton, 61, 120)};
  const Motion slow = resample(skeleton, motion, 40);
  ASSERT_EQ(slow.dofs.rows(), 21);
  EXPECT_LT((slow.dofs.row(20) - motion.dofs.row(60)).norm(), 1e-9);
  EXPECT_LT((slow.dofs.row(7) - motion.dofs.row(21)).norm(), 1e-9);
  const Motion rounded = resample(skeleton, {1 / 0.008333, motion.dofs}, 120); // as a BVH says it
  ASSERT_EQ(rounded.dofs.rows(), 61);
  EXPECT_LT((rounded.dofs.row(60) - motion.dofs.row(60)).norm(), 1e-9);
  EXPECT_THROW(resample(skeleton, motion, 0), std::invalid_argument);
  EXPECT_THROW(resample(skeleton, Motion{}, 40), std::invalid_argument);
}
