#pragma once
// Names that the field gives to the joints of a human skeleton.

#include <map>
#include <string>
#include <vector>

namespace doublet {

/// Standard name (l_knee, neck, ...) -> indices of `names` that may be it, best first. A joint is named after the bone that
/// starts there. Knows our own names, CMU/cgspeed, Acclaim, Mixamo/MotionBuilder, iClone (CC_Base), 3ds Max Biped, Unreal,
/// Blender's Rigify, SMPL, Poser/DAZ, VRoid, Second Life, Xsens, OptiTrack, MakeHuman, Kinect; of a prefix that nearly all names
/// have, nothing.
std::map<std::string, std::vector<int>> joints_by_name(const std::vector<std::string> &names);

/// 'l' or 'r' if a word of the name says so; 0 otherwise.
char side_of(const std::string &name);

} // namespace doublet
