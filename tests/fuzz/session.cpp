// A session's three texts, beside masks and a scan that are whole.
#include "doublet/capture/session.h"
#include "harness.h"

namespace {

using namespace doublet;

/// Two cameras of three frames, as the corpus has them. PGM: OpenCV goes by the content.
bool put_images() {
  const std::string pgm = "P5 48 48 255\n" + std::string(48 * 48, '\xFF');
  for (const char *name : {"cam0_0000", "cam0_0001", "cam0_0002", "cam1_0000", "cam1_0001", "cam1_0002"})
    fuzz::put(std::string("session/masks/") + name + ".png", pgm);
  fuzz::put("session/scan.ply", "ply\n");
  return true;
}

} // namespace

DOUBLET_HARNESS(session) {
  [[maybe_unused]] static const bool ready = put_images();
  const auto files = fuzz::files_of(input, {"session.json", "joints.json", "calibration.yml"});
  for (const char *name : {"session.json", "joints.json", "calibration.yml"})
    fuzz::put(std::string("session/") + name, files.count(name) ? files.at(name) : "");
  fuzz::expect_read_or_refused([] { read_session(fuzz::folder() / "session"); });
}
