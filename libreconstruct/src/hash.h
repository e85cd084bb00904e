#pragma once

#include "doublet/files/files.h"

#include <string>

namespace doublet::detail {

/// SHA-256 of a file in hexadecimal digits. Throws FileNotFound, or Error naming it.
std::string hash_file(const Path &path);

/// The same; of a folder (image sequences) that of the names and contents of all files in it.
std::string hash_files(const Path &path);

} // namespace doublet::detail
