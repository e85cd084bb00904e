// Where a capture stood: the record of one frame as from_bytes() reads it, and whatever else may stand in such a file.
#include "tracking/capture_checkpoint.h"
#include "harness.h"

namespace {

using namespace doublet;

constexpr std::uint64_t kProblem = 7;

/// A file of one whole frame.
std::string whole_start() {
  const Path path = fuzz::put("start.bin", "");
  CaptureCheckpoint checkpoint(path, kProblem);
  checkpoint.start_over();
  checkpoint.append({});
  return read_text(path);
}

std::size_t frames_in(const std::string &content) {
  return CaptureCheckpoint(fuzz::put("capture_checkpoint.bin", content), kProblem).read(99, {}).size();
}

} // namespace

DOUBLET_HARNESS(capture_checkpoint) {
  static const std::string start = whole_start();
  const std::string bytes(input);
  fuzz::expect_read_or_refused([&] {
    const TrackedFrame frame = from_bytes(bytes);
    if (to_bytes(from_bytes(to_bytes(frame))) != to_bytes(frame))
      std::abort();
  });
  fuzz::expect_read_or_refused([&] { frames_in(bytes); });
  fuzz::expect_read_or_refused([&] {
    if (frames_in(start + bytes) < 1)
      std::abort(); // the frame before what is damaged stays
  });
}
