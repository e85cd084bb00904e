#pragma once
// The files between stages (docs/formats.md). Every writer writes beside and renames: a file is complete or not there.
// Readers throw FileNotFound or Error naming file, expectation and finding.

#include "doublet/core/garment.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <functional>
#include <string>

namespace doublet {

using Path = std::filesystem::path;

/// Runs write(temporary path beside `path`), then renames; removes the temporary if write throws.
void write_atomically(const Path &path, const std::function<void(const Path &)> &write);
void write_text(const Path &path, const std::string &text);
std::string read_text(const Path &path);

void write_actor(const Path &path, const RiggedMesh &actor); // actor.npz
RiggedMesh read_actor(const Path &path);
void write_performance(const Path &path, const ReferencePerformance &performance); // performance.npz; faces come from the actor
ReferencePerformance read_performance(const Path &path, const RiggedMesh &actor);
void write_clothness(const Path &path, const Clothness &clothness); // segmentation.npz
Clothness read_clothness(const Path &path);
void write_garment(const Path &path, const Garment &garment); // garment.npz; one without vertices is a file, too
Garment read_garment(const Path &path, const RiggedMesh &actor);
void write_body(const Path &path, const BodyFit &fit); // body.npz
BodyFit read_body(const Path &path);
void write_proxies(const Path &path, const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton); // proxies.json
std::vector<TaperedCapsule> read_proxies(const Path &path, const Skeleton &skeleton);
void write_observations(const Path &path, const Observations &observations); // observations.npz, cameras included
Observations read_observations(const Path &path);

} // namespace doublet
