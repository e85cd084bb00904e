#include "doublet/animate/parts/image_file.h"

#include "doublet/core/error.h"

#include <tiny_gltf.h>

#include <stdexcept>
#include <string>

namespace doublet {
namespace {

/// TinyGLTF's writer hands images out as a data URI.
std::vector<std::uint8_t> encode(const Image &image, const std::string &file_name) {
  if (image.empty() || (image.channels != 1 && image.channels != 3))
    throw std::invalid_argument("encode image: expected pixels with 1 or 3 channels, found " + std::to_string(image.width) +
                                " x " + std::to_string(image.height) + " with " + std::to_string(image.channels));
  tinygltf::Image raw;
  raw.width = image.width;
  raw.height = image.height;
  raw.component = image.channels;
  raw.bits = 8;
  raw.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  raw.image = image.data;
  for (std::size_t i = 0; image.channels == 3 && i < raw.image.size(); i += 3)
    std::swap(raw.image[i], raw.image[i + 2]);
  std::string uri;
  const std::string folder;
  std::vector<std::uint8_t> bytes;
  std::string mime;
  if (!tinygltf::WriteImageData(&folder, &file_name, &raw, true, &uri, nullptr) ||
      !tinygltf::DecodeDataURI(&bytes, mime, uri, 0, false))
    throw Error("encode image: the encoder failed");
  return bytes;
}

std::uint64_t big_endian(const std::vector<std::uint8_t> &bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = at; i < at + count; ++i)
    value = value << 8 | bytes[i];
  return value;
}

/// Pixels that the header of a PNG (http://www.libpng.org/pub/png/spec/1.2, IHDR) or JPEG (ITU T.81, B.2.2) says; 0 if it is
/// neither, or has none.
std::uint64_t stated_pixels(const std::vector<std::uint8_t> &bytes) {
  const std::size_t size = bytes.size();
  if (size >= 24 && bytes[0] == 0x89 && bytes[1] == 'P')
    return big_endian(bytes, 16, 4) * big_endian(bytes, 20, 4);
  if (size < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8)
    return 0;
  for (std::size_t at = 2; at + 9 <= size && bytes[at] == 0xFF;) {
    const int marker = bytes[at + 1];
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC)
      return big_endian(bytes, at + 5, 2) * big_endian(bytes, at + 7, 2);
    at += marker == 0xFF ? 1 : 2 + big_endian(bytes, at + 2, 2);
  }
  return 0;
}

} // namespace

std::vector<std::uint8_t> encode_png(const Image &image) {
  return encode(image, "image.png");
}

std::vector<std::uint8_t> encode_jpeg(const Image &image) {
  return encode(image, "image.jpg");
}

Image decode_image(const std::vector<std::uint8_t> &bytes) {
  // What deflate, or a JPEG of one colour, may at most unpack to; the decoder would believe more, and ask for the memory.
  constexpr std::uint64_t kMostExpansion = 1100;
  if (const std::uint64_t pixels = stated_pixels(bytes); pixels > kMostExpansion * bytes.size())
    throw Error("decode_image: expected an image that its " + std::to_string(bytes.size()) + " bytes can hold, found one of " +
                std::to_string(pixels) + " pixels");
  tinygltf::Image raw;
  std::string error, warning;
  if (bytes.empty() ||
      !tinygltf::LoadImageData(&raw, 0, &error, &warning, 0, 0, bytes.data(), static_cast<int>(bytes.size()), nullptr) ||
      raw.bits != 8 || raw.component < 3)
    throw Error("decode_image: expected a PNG or JPEG file of 8 bits per channel, found " + std::to_string(bytes.size()) +
                " other bytes");
  Image image(raw.width, raw.height, 3);
  for (std::size_t i = 0; i < static_cast<std::size_t>(raw.width) * raw.height; ++i)
    for (int c = 0; c < 3; ++c)
      image.data[3 * i + c] = raw.image[i * raw.component + (2 - c)];
  return image;
}

} // namespace doublet
