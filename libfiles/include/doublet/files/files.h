#pragma once
// The files between stages (docs/formats.md). Every writer writes beside and renames: a file is complete or not there.
// Readers throw FileNotFound or Error naming file, expectation and finding.

#include "doublet/core/garment.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace doublet {

using Path = std::filesystem::path;

/// Of the files of a reconstruction (docs/formats.md): array or key `format`. Raised when a reader of before would misread.
inline constexpr int kFileFormat = 1;
/// Throws Error naming the file if its format is of no version up to `newest`.
void require_format(int found, int newest, const std::string &source);

/// Runs write(temporary path beside `path`), has it brought to the disk, then renames; removes the temporary if anything throws.
/// A symbolic link stays: the file that it leads to is replaced.
/// Throws Error naming `path` if it cannot be written, is a folder or a device.
void write_atomically(const Path &path, const std::function<void(const Path &)> &write);
/// The same for what goes into a stream; all that it was given is there in the end, or Error says why not (full disk).
void write_stream(const Path &path, const std::function<void(std::ostream &)> &write);
void write_text(const Path &path, const std::string &text);
/// Throws FileNotFound, or Error naming the file; a device or pipe, which may never end, is none.
std::string read_text(const Path &path);
/// Text as it is meant: without the byte order mark of UTF-8, every line ended by one \n. Throws Error naming `source` for
/// UTF-16.
std::string plain_text(std::string text, const std::string &source);
/// The text of a file that is to hold JSON. Throws Error if it is nested deeper than any of ours: parsers recurse.
std::string read_json_text(const Path &path);
void require_shallow_json(std::string_view text, const std::string &source);
enum class Markup { Brackets, Toml, Xml }; ///< what nests: [ and { (YAML, JSON), these and dotted keys, elements
/// The same for the files of others, before a parser sees them. Quotes do not count: what is one is the parser's to say.
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
