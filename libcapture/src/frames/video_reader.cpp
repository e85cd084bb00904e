#include "video_reader.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/number_text.h"
#include "file_memo.h"
#include "image_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <system_error>

namespace doublet::detail {
namespace fs = std::filesystem;
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// ffmpeg, and what comes before every input: nothing is asked, and no file names another, in the net or here.
std::vector<std::string> ffmpeg() {
  const char *chosen = std::getenv("DOUBLET_FFMPEG");
  return {chosen && *chosen ? chosen : "ffmpeg", "-nostdin", "-loglevel", "error", "-protocol_whitelist", "file"};
}

/// A name as it is, whatever it begins with or contains.
std::string input_name(const fs::path &path) {
  return "file:" + path.string();
}

constexpr const char *kAdvice = "videos, and images that are neither PNG nor JPEG, need it (apt install ffmpeg, or "
                                "pip install imageio-ffmpeg)";

/// What ffmpeg says, without the part of it that says so, and without the file's name.
std::string complaint_of(Subprocess &process, const fs::path &path) {
  std::string said = process.complaint();
  if (const std::size_t part = said.find("] "); said.starts_with("[") && part != said.npos)
    said.erase(0, part + 2);
  if (const std::string name = input_name(path) + ": "; said.starts_with(name))
    said.erase(0, name.size());
  return said;
}

std::vector<std::string> joined(std::vector<std::string> command, const std::vector<std::string> &more) {
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

std::vector<std::string> decoding(const fs::path &path, double seconds, int skipped) {
  std::vector<std::string> command = ffmpeg();
  if (seconds > 0)
    command = joined(command, {"-ss", fixed_point(seconds, 6)});
  // The time of every picture goes to file 3. Colours by the matrix of BT.601 whatever the file says, as OpenCV has it: so masks
  // and plates of one camera agree with its video.
  std::string filters = "metadata=add:key=x:value=x,metadata=print:direct=1:file='pipe\\:3',";
  filters += "scale=in_color_matrix=bt601:flags=bicubic,";
  // Then every picture once, whatever its time: at an even rate, for the option that says so has changed its name.
  filters += "settb=AVTB,setpts=N/25/TB";
  if (skipped)
    filters = "select='gte(n\\," + std::to_string(skipped) + ")'," + filters;
  return joined(command, {"-i", input_name(path), "-map", "0:V:0", "-vf", filters, "-r", "25", "-c:v", "ppm", "-pix_fmt", "rgb24",
                          "-f", "image2pipe", "-"});
}

/// "frame:0    pts:128     pts_time:0.0125", and a line for what is stated of it.
double read_time(std::FILE *notes) {
  char line[200];
  if (!std::fgets(line, sizeof line, notes))
    return kUnknown;
  const char *said = std::strstr(line, "pts_time:");
  double time = kUnknown;
  const bool known = said && std::from_chars(said + 9, line + std::strlen(line), time).ec == std::errc();
  return std::fgets(line, sizeof line, notes) && known ? time : kUnknown;
}

struct Packet {
  double time = kUnknown;
  bool shown = true;
};

/// A line of ffmpeg's list: "0, -512, 0, 256, 14026, 0xe70b05fc, F=0x4": stream, order, time, length, bytes, checksum, flags.
Packet parse_packet(const char *line, double tick) {
  long long time = 0;
  unsigned flags = 0;
  const bool timed = std::sscanf(line, "%*d, %*[^,], %lld,", &time) == 1;
  if (const char *said = std::strstr(line, "F=0x"))
    std::sscanf(said + 4, "%x", &flags);
  constexpr unsigned kDiscarded = 4; // what was cut off by copying is decoded, but not shown
  return {timed ? static_cast<double>(time) * tick : kUnknown, !(flags & kDiscarded)};
}

VideoIndex list_frames(const fs::path &path) {
  Subprocess list(joined(ffmpeg(), {"-i", input_name(path), "-map", "0:V:0", "-c", "copy", "-f", "framecrc", "-"}), kAdvice);
  VideoIndex index;
  double tick = 0;
  bool hidden = false;
  char line[400];
  while (std::fgets(line, sizeof line, list.output())) {
    int above = 0, below = 0;
    if (std::sscanf(line, "#tb 0: %d/%d", &above, &below) == 2 && below > 0)
      tick = static_cast<double>(above) / below;
    hidden = hidden || std::strstr(line, "#codec_id 0: vp8"); // has packets that are never shown
    if (line[0] == '#')
      continue;
    if (const Packet packet = parse_packet(line, tick); packet.shown)
      index.times.push_back(packet.time);
  }
  const bool content = list.wait();
  const std::string complaint = complaint_of(list, path);
  if (!content || index.times.empty())
    throw Error(path.string() + ": expected a complete video file, found one that cannot be opened (" +
                (complaint.empty() ? "truncated, or not a video" : "ffmpeg says: " + complaint) + ")");
  index.damaged = !complaint.empty();
  const bool known = std::none_of(index.times.begin(), index.times.end(), [](double time) { return std::isnan(time); });
  if (known)
    std::sort(index.times.begin(), index.times.end());
  index.timed = known && !hidden && std::adjacent_find(index.times.begin(), index.times.end()) == index.times.end();
  return index;
}

} // namespace

FrameStream::FrameStream(const fs::path &path, double seconds, int skipped)
    : path_(path), start_(seconds), ffmpeg_(decoding(path, seconds, skipped), kAdvice) {}

std::string FrameStream::complaint() {
  return complaint_of(ffmpeg_, path_);
}

bool FrameStream::next(cv::Mat &image) {
  if (!read_ppm(ffmpeg_.output(), image))
    return false;
  time_ = start_ + read_time(ffmpeg_.notes());
  return true;
}

double VideoIndex::fps() const {
  const double span = timed && times.size() > 1 ? times.back() - times.front() : 0;
  return span > 0 ? static_cast<double>(times.size() - 1) / span : 0;
}

VideoIndex index_video(const fs::path &path) {
  static FileMemo<VideoIndex> memo;
  return memo.of(path, ffmpeg().front(), [&] { return list_frames(path); });
}

ProbedFrames probe_video(const fs::path &path, int frame_count) {
  static FileMemo<ProbedFrames> memo;
  return memo.of(path, ffmpeg().front() + " " + std::to_string(frame_count), [&]() -> ProbedFrames {
    VideoReader video(path);
    const VideoIndex &index = video.index();
    if (const int found = static_cast<int>(index.times.size()); found < frame_count)
      throw Error(path.string() + ": expected " + std::to_string(frame_count) + " frames as session.json says, found " +
                  std::to_string(found) + (index.damaged ? "; the video is damaged or truncated" : ""));
    return {video.read(frame_count - 1).size(), index.fps()}; // all of a video are of one size
  });
}

VideoReader::VideoReader(const fs::path &path) : path_(path) {
  if (!fs::exists(path))
    throw FileNotFound(path.string() + ": the video does not exist");
}

const VideoIndex &VideoReader::index() {
  if (!index_)
    index_ = index_video(path_);
  return *index_;
}

const cv::Mat &VideoReader::read(int frame) {
  constexpr int kSkim = 32; // frames; up to here decoding on is not slower than jumping to a key frame
  if (frame == shown_)
    return image_;
  shown_ = -1; // whatever is thrown below
  if (!stream_ || frame < next_ || frame > next_ + kSkim)
    start_at(frame);
  for (; next_ <= frame; ++next_) {
    if (!stream_->next(image_))
      fail(next_);
    check_time(next_);
  }
  shown_ = frame;
  return image_;
}

void VideoReader::start_at(int frame) {
  stream_.reset();
  next_ = frame;
  if (frame >= static_cast<int>(index().times.size()))
    fail(frame);
  const std::vector<double> &times = index_->times;
  if (frame > 0 && index_->timed) {
    const double gap = times[frame] - times[frame - 1];
    auto jumped = std::make_unique<FrameStream>(path_, times[frame] - gap / 2);
    if (jumped->next(image_) && std::abs(jumped->time() - times[frame]) < gap / 4) {
      stream_ = std::move(jumped);
      ++next_;
      return;
    } // otherwise this container does not allow a jump: decode from the start
  }
  stream_ = std::make_unique<FrameStream>(path_, 0, frame);
}

/// A frame that cannot be decoded is left out by ffmpeg, and those behind it move up. What is stated of the times is wrong where
/// ffmpeg is content and they differ: then they count no more.
void VideoReader::check_time(int frame) {
  if (!index().timed || frame == 0)
    return;
  const std::vector<double> &times = index_->times;
  const bool stated = frame < static_cast<int>(times.size());
  if (stated && std::abs(stream_->time() - times[frame]) < (times[frame] - times[frame - 1]) / 2)
    return;
  if (!stream_->complaint().empty())
    fail(frame);
  index_->timed = false;
}

void VideoReader::fail(int frame) {
  const std::string complaint = stream_ ? stream_->complaint() : "";
  stream_.reset();
  throw Error(path_.string() + ": frame " + std::to_string(frame) + " cannot be decoded (the video has " +
              std::to_string(index().times.size()) + " frames; it may be truncated" +
              (complaint.empty() ? ")" : "; ffmpeg says: " + complaint + ")"));
}

} // namespace doublet::detail
