#pragma once
// character.glb: the whole animatable character in one glTF 2.0 file. Other viewers see a skinned, textured person; what the
// simulation needs lies in the extension DOUBLET_character (docs/animation.md), which they ignore.

#include "doublet/animate/character.h"

#include <filesystem>

namespace doublet {

/// Geometry and weights are stored as float32, parameters as JSON numbers. Written to a temporary file, then renamed. Throws
/// Error.
void write_character(const std::filesystem::path &path, const Character &character);

/// Throws FileNotFound, or Error naming the file and what is wrong with it.
Character read_character(const std::filesystem::path &path);

} // namespace doublet
