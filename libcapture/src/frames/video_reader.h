#pragma once
// Videos, by the program ffmpeg: it lists the frames of a file, and writes them into a pipe.

#include "frame_reader.h"
#include "subprocess.h"

#include <optional>
#include <string>
#include <vector>

namespace doublet::detail {

/// Pictures that ffmpeg decodes, one after the other.
class FrameStream {
public:
  /// From the first picture of `path`, which may be an image; from `seconds` after the start, or leaving out the first `skipped`.
  explicit FrameStream(const std::filesystem::path &path, double seconds = 0, int skipped = 0);
  /// BGR into `image`; false after the last picture, or one that cannot be decoded.
  bool next(cv::Mat &image);
  double time() const { return time_; } ///< s after the start, of what next() gave; NaN = unknown
  std::string complaint();              ///< what ffmpeg says is wrong, so far; empty = nothing

private:
  std::filesystem::path path_;
  double start_, time_ = 0;
  Subprocess ffmpeg_;
};

/// The frames of a video in the order in which they are shown.
struct VideoIndex {
  std::vector<double> times; ///< s after the start
  bool timed = false;        ///< the times are known, and differ
  bool damaged = false;      ///< ffmpeg found something amiss
  double fps() const;        ///< measured; 0 = unknown
};
/// Without decoding. Throws Error naming the file if it is no video, or cannot be opened.
VideoIndex index_video(const std::filesystem::path &path);

/// As probe_frames(), of a video.
ProbedFrames probe_video(const std::filesystem::path &path, int frame_count);

class VideoReader : public FrameReader {
public:
  explicit VideoReader(const std::filesystem::path &path); ///< throws FileNotFound
  const cv::Mat &read(int frame) override;
  const VideoIndex &index(); ///< made when first asked for

private:
  void start_at(int frame);
  void check_time(int frame);
  [[noreturn]] void fail(int frame);

  std::filesystem::path path_;
  std::optional<VideoIndex> index_;
  std::unique_ptr<FrameStream> stream_;
  cv::Mat image_;
  int shown_ = -1; ///< frame that image_ is; -1 = none
  int next_ = 0;   ///< frame that stream_ delivers next
};

} // namespace doublet::detail
