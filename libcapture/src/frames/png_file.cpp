#include "png_file.h"

#include "doublet/core/error.h"
#include "image_file.h"

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <png.h>
#include <vector>

namespace doublet::detail {
namespace {

/// Between libpng's callbacks, which know C alone, and the decoder. Nothing in it is destroyed by a jump.
struct Reading {
  const std::string &data;
  std::size_t at = 0;
  char complaint[200] = "";
};

void read_bytes(png_structp png, png_bytep to, png_size_t count) {
  Reading &reading = *static_cast<Reading *>(png_get_io_ptr(png));
  if (count > reading.data.size() - reading.at)
    png_error(png, "the file ends too early");
  std::memcpy(to, reading.data.data() + reading.at, count);
  reading.at += count;
}

void fail(png_structp png, png_const_charp complaint) {
  Reading &reading = *static_cast<Reading *>(png_get_error_ptr(png));
  std::snprintf(reading.complaint, sizeof reading.complaint, "%s", complaint);
  png_longjmp(png, 1);
}

void ignore(png_structp, png_const_charp) {}

/// Whatever the file has becomes three bytes a pixel: of 16 bits the upper ones, of palettes their colours, no alpha.
void ask_for_bgr(png_structp png, png_infop info) {
  const png_byte kind = png_get_color_type(png, info), bits = png_get_bit_depth(png, info);
  if (bits == 16)
    png_set_strip_16(png);
  if (kind == PNG_COLOR_TYPE_PALETTE)
    png_set_palette_to_rgb(png);
  if (kind == PNG_COLOR_TYPE_GRAY && bits < 8)
    png_set_expand_gray_1_2_4_to_8(png);
  if (!(kind & PNG_COLOR_MASK_COLOR))
    png_set_gray_to_rgb(png);
  png_set_strip_alpha(png);
  png_set_bgr(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

/// The part between which libpng may jump: no object with a destructor lives in it. False on a jump.
bool read_header(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)))
    return false;
  png_read_info(png, info);
  return true;
}

bool read_rows(png_structp png, png_infop info, png_bytep *rows) {
  if (setjmp(png_jmpbuf(png)))
    return false;
  ask_for_bgr(png, info);
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

class PngDecoder {
public:
  explicit PngDecoder(const std::string &data) : reading_{data} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading_, fail, ignore);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, &reading_, read_bytes);
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder &) = delete;
  PngDecoder &operator=(const PngDecoder &) = delete;

  cv::Mat decode() {
    require(read_header(png_, info_));
    const png_uint_32 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    require_bounded(width, height);
    cv::Mat image(static_cast<int>(height), static_cast<int>(width), CV_8UC3, cv::Scalar::all(0));
    std::vector<png_bytep> rows;
    for (int y = 0; y < image.rows; ++y)
      rows.push_back(image.ptr(y));
    require(read_rows(png_, info_, rows.data()));
    return image;
  }

private:
  void require(bool done) const {
    if (!done)
      throw Error(reading_.complaint);
  }

  Reading reading_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

} // namespace

cv::Mat decode_png(const std::string &data) {
  return PngDecoder(data).decode();
}

} // namespace doublet::detail
