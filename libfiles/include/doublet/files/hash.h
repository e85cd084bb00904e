#pragma once
// Hashes of files.

#include "doublet/files/files.h"

#include <string>

namespace doublet {

/// SHA-256 of a file in hexadecimal digits; of a folder (image sequences) that of the names and contents of all files in it.
/// Throws FileNotFound, or Error naming the file that cannot be read.
std::string hash_files(const Path &path);

} // namespace doublet
