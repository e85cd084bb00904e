#pragma once
// The files between stages (docs/formats.md). All writers are atomic (temporary file, then rename). Readers throw FileNotFound,
// or Error naming file, expectation and finding.

#include "doublet/core/garment.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace doublet {

using Path = std::filesystem::path;

/// Format number of the files of a reconstruction (docs/formats.md), in the array or key `format`. Raised when older readers
/// would misread a file.
inline constexpr int kFileFormat = 1;
/// Throws Error naming `source` unless `found` is a format number from 1 to `newest`.
void require_format(int found, int newest, const std::string &source);

/// Runs write(temporary path in the folder of `path`), flushes the file to the disk, then renames it to `path`; removes the
/// temporary file if anything throws. A symbolic link is kept: the file that it points to is replaced. Throws Error naming `path`
/// if it cannot be written, is a folder or a device.
void write_atomically(const Path &path, const std::function<void(const Path &)> &write);
/// The same for a stream. Throws Error unless everything was written (full disk).
void write_stream(const Path &path, const std::function<void(std::ostream &)> &write);
void write_text(const Path &path, const std::string &text);
/// Throws FileNotFound, or Error naming the file; devices and pipes, which may never end, are refused.
std::string read_text(const Path &path);
/// Normalised text: without the byte order mark of UTF-8, line ends \n. Throws Error naming `source` for UTF-16.
std::string plain_text(std::string text, const std::string &source);
/// The text of a JSON file. Throws Error if it is nested more deeply than any of our files, since parsers recurse.
std::string read_json_text(const Path &path);
void require_shallow_json(std::string_view text, const std::string &source);
enum class Markup { Brackets, Toml, Xml }; ///< what nests: [ and { (YAML, JSON), these and dotted keys, elements
/// The same check for files of other programs, before they are parsed. Quotes are ignored, so that brackets in texts count, too.
void require_shallow(std::string_view text, Markup markup, const std::string &source);

void write_actor(const Path &path, const RiggedMesh &actor); // actor.npz
RiggedMesh read_actor(const Path &path);
void write_performance(const Path &path, const ReferencePerformance &performance); // performance.npz; faces come from the actor
ReferencePerformance read_performance(const Path &path, const RiggedMesh &actor);
void write_segmentation(const Path &path, const Segmentation &segmentation); // segmentation.npz
Segmentation read_segmentation(const Path &path);
void write_garment(const Path &path, const Garment &garment); // garment.npz; one without vertices is a file, too
Garment read_garment(const Path &path, const RiggedMesh &actor);
void write_body(const Path &path, const BodyFit &fit); // body.npz
BodyFit read_body(const Path &path);
void write_proxies(const Path &path, const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton); // proxies.json
std::vector<TaperedCapsule> read_proxies(const Path &path, const Skeleton &skeleton);
void write_observations(const Path &path, const Observations &observations); // observations.npz, cameras included
Observations read_observations(const Path &path);

} // namespace doublet
