#include "capture_checkpoint.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace doublet {
namespace {

constexpr const char *kKind = "doublet capture checkpoint, format ";
constexpr int kFormat = 2;

template <class T> bool read_number(std::istream &in, T &value) {
  return static_cast<bool>(in.read(reinterpret_cast<char *>(&value), sizeof value));
}

template <class T> void write_number(std::ostream &out, T value) {
  out.write(reinterpret_cast<const char *>(&value), sizeof value);
}

} // namespace

std::string CaptureCheckpoint::header() const {
  return kKind + std::to_string(kFormat) + ", problem " + std::to_string(problem_) + "\n";
}

/// Why a file that starts so is not used; empty if it is.
std::string CaptureCheckpoint::why_not(const std::string &start) const {
  if (start == header())
    return "";
  const std::string kind = kKind;
  const std::size_t comma = start.find(',', kind.size());
  if (start.rfind(kind, 0) != 0 || comma == std::string::npos)
    return "is damaged";
  if (const std::string found = start.substr(kind.size(), comma - kind.size()); found != std::to_string(kFormat))
    return "is of format " + found + ", expected " + std::to_string(kFormat);
  return "belongs to other data or options";
}

std::uint64_t CaptureCheckpoint::checksum(const std::string &bytes) const {
  return Fingerprint().bytes(&chain_, sizeof chain_).add(bytes).value();
}

std::vector<TrackedFrame> CaptureCheckpoint::read(std::size_t most, const Context &context) {
  if (!used())
    return {};
  if (!std::filesystem::is_regular_file(path_)) {
    start_over(); // which refuses what is no file
    return {};
  }
  std::string start(header().size(), '\0');
  std::ifstream(path_, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  if (const std::string why = why_not(start); !why.empty()) {
    context.log_line("capture: " + path_.string() + " " + why + "; starting over");
    start_over();
    return {};
  }
  return read_records(most, context);
}

std::vector<TrackedFrame> CaptureCheckpoint::read_records(std::size_t most, const Context &context) {
  std::vector<TrackedFrame> frames;
  const std::uint64_t file_size = std::filesystem::file_size(path_);
  std::uint64_t whole = header().size(), size = 0, sum = 0;
  std::ifstream in(path_, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(whole));
  try {
    for (std::string bytes; frames.size() < most && read_number(in, size) && size <= file_size;) {
      bytes.resize(size);
      in.read(bytes.data(), static_cast<std::streamsize>(size));
      if (!in || !read_number(in, sum) || sum != checksum(bytes))
        break;
      frames.push_back(from_bytes(bytes));
      chain_ = sum;
      whole += size + sizeof size + sizeof sum;
    }
  } catch (const Error &) { // the right checksum of something else
  }
  in.close();
  if (whole < file_size) {
    context.log_line("capture: " + path_.string() + " is damaged or cut short after " + std::to_string(frames.size()) +
                     " frames; what follows is not used");
    std::error_code error;
    std::filesystem::resize_file(path_, whole, error);
    if (error)
      throw Error(path_.string() + ": cannot be written: " + error.message());
  }
  return frames;
}

void CaptureCheckpoint::start_over() {
  chain_ = problem_;
  if (used())
    write_text(path_, header());
}

void CaptureCheckpoint::append(const TrackedFrame &frame) {
  if (!used())
    return;
  const std::string bytes = to_bytes(frame);
  chain_ = checksum(bytes);
  errno = 0;
  std::ofstream out(path_, std::ios::binary | std::ios::app);
  write_number(out, static_cast<std::uint64_t>(bytes.size()));
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  write_number(out, chain_);
  out.close();
  if (!out)
    throw Error(path_.string() + ": cannot be written: " + (errno ? std::strerror(errno) : "the disk is full"));
}

} // namespace doublet
