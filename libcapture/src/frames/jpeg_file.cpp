#include "jpeg_file.h"

#include "doublet/core/error.h"
#include "image_file.h"

#include <csetjmp>
#include <cstdint>
#include <cstdio> // before jpeglib.h, which does not include it
#include <cstring>
#include <jerror.h>
#include <jpeglib.h>
#include <string_view>

namespace doublet::detail {
namespace {

/// What libjpeg calls where it would end the process. Nothing in it is destroyed by a jump.
struct Complaints {
  jpeg_error_mgr calls; // first: libjpeg hands it back
  std::jmp_buf back;
  char said[JMSG_LENGTH_MAX];
  bool ends_early;
};

void fail(j_common_ptr jpeg) {
  auto &complaints = *reinterpret_cast<Complaints *>(jpeg->err);
  jpeg->err->format_message(jpeg, complaints.said);
  std::longjmp(complaints.back, 1);
}

/// Of warnings one counts: libjpeg makes up what is missing. Bytes too many, which cameras write, do not.
void note(j_common_ptr jpeg, int level) {
  const int code = jpeg->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER))
    reinterpret_cast<Complaints *>(jpeg->err)->ends_early = true;
}

/// The parts between which libjpeg may jump: no object with a destructor lives in them. False on a jump.
bool read_header(jpeg_decompress_struct &jpeg, Complaints &complaints, const std::string &data) {
  if (setjmp(complaints.back))
    return false;
  jpeg_create_decompress(&jpeg);
  jpeg_save_markers(&jpeg, JPEG_APP0 + 1, 0xffff); // EXIF
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char *>(data.data()), data.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = jpeg.num_components == 4 ? JCS_CMYK : JCS_EXT_BGR;
  return true;
}

bool read_rows(jpeg_decompress_struct &jpeg, Complaints &complaints, unsigned char *pixels, std::size_t row) {
  if (setjmp(complaints.back))
    return false;
  jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW to = pixels + jpeg.output_scanline * row;
    jpeg_read_scanlines(&jpeg, &to, 1);
  }
  jpeg_finish_decompress(&jpeg);
  return true;
}

/// A tag of a TIFF header's first directory that is one short number; 0 = not there.
int tiff_short(std::string_view tiff, unsigned tag) {
  const bool big = tiff.starts_with("MM");
  const auto number = [&](std::size_t at, int bytes) {
    unsigned value = 0;
    for (int k = 0; k < bytes && at + bytes <= tiff.size(); ++k)
      value |= static_cast<unsigned char>(tiff[at + k]) << 8 * (big ? bytes - 1 - k : k);
    return value;
  };
  const std::size_t directory = number(4, 4), count = number(directory, 2);
  for (std::size_t entry = directory + 2; entry < directory + 2 + 12 * count && entry + 12 <= tiff.size(); entry += 12)
    if (number(entry, 2) == tag)
      return static_cast<int>(number(entry + 8, 2));
  return 0;
}

/// EXIF's orientation: 1 to 8, 1 = as it is.
int orientation_of(const jpeg_decompress_struct &jpeg) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  constexpr unsigned kOrientation = 0x0112;
  for (auto *marker = jpeg.marker_list; marker; marker = marker->next) {
    const std::string_view data(reinterpret_cast<const char *>(marker->data), marker->data_length);
    if (data.starts_with(kExif))
      if (const int said = tiff_short(data.substr(kExif.size()), kOrientation); said >= 1 && said <= 8)
        return said;
  }
  return 1;
}

/// Upright, of an image that is stored with EXIF's `orientation`: 1 as it is, 2 mirrored, 3 upside down, 4 both; 5 to 8 the same,
/// of columns that are stored as rows.
cv::Mat turned(const cv::Mat &image, int orientation) {
  cv::Mat out = orientation > 4 ? image.t() : image;
  const bool mirrored = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool upended = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  if (mirrored || upended)
    cv::flip(out, out, mirrored && upended ? -1 : mirrored ? 1 : 0);
  return out;
}

/// Adobe's programs store the four colours inverted, as nearly all files have them: so much of each is light.
cv::Mat bgr_of_cmyk(const cv::Mat &cmyk) {
  cv::Mat bgr(cmyk.size(), CV_8UC3);
  for (int y = 0; y < cmyk.rows; ++y)
    for (int x = 0; x < cmyk.cols; ++x) {
      const auto &ink = cmyk.at<cv::Vec4b>(y, x);
      for (int k = 0; k < 3; ++k)
        bgr.at<cv::Vec3b>(y, x)[2 - k] = static_cast<unsigned char>(ink[3] - ((255 - ink[k]) * ink[3] >> 8));
    }
  return bgr;
}

class JpegDecoder {
public:
  explicit JpegDecoder(const std::string &data) {
    std::memset(&jpeg_, 0, sizeof jpeg_);
    jpeg_.err = jpeg_std_error(&complaints_.calls);
    complaints_.calls.error_exit = fail;
    complaints_.calls.emit_message = note;
    require(read_header(jpeg_, complaints_, data));
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg_); }
  JpegDecoder(const JpegDecoder &) = delete;
  JpegDecoder &operator=(const JpegDecoder &) = delete;

  cv::Mat decode() {
    require_bounded(jpeg_.image_width, jpeg_.image_height);
    const int channels = jpeg_.num_components == 4 ? 4 : 3;
    cv::Mat image(static_cast<int>(jpeg_.image_height), static_cast<int>(jpeg_.image_width), CV_8UC(channels));
    const int orientation = orientation_of(jpeg_); // the markers go with the last row
    require(read_rows(jpeg_, complaints_, image.data, image.step));
    if (complaints_.ends_early)
      throw Error("it is damaged, or ends too early");
    return turned(channels == 4 ? bgr_of_cmyk(image) : image, orientation);
  }

private:
  void require(bool done) {
    if (!done) {
      jpeg_destroy_decompress(&jpeg_);
      throw Error(complaints_.said);
    }
  }

  Complaints complaints_{};
  jpeg_decompress_struct jpeg_;
};

} // namespace

cv::Mat decode_jpeg(const std::string &data) {
  return JpegDecoder(data).decode();
}

} // namespace doublet::detail
