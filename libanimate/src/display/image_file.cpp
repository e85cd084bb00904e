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

} // namespace

std::vector<std::uint8_t> encode_png(const Image &image) {
  return encode(image, "image.png");
}

std::vector<std::uint8_t> encode_jpeg(const Image &image) {
  return encode(image, "image.jpg");
}

Image decode_image(const std::vector<std::uint8_t> &bytes) {
  tinygltf::Image raw;
  std::string error, warning;
  if (bytes.empty() ||
      !tinygltf::LoadImageData(&raw, 0, &error, &warning, 0, 0, bytes.data(), static_cast<int>(bytes.size()), nullptr) ||
      raw.bits != 8 || raw.component < 3)
    throw Error("decode_image: expected a PNG or JPEG file of 8 bits a channel, found " + std::to_string(bytes.size()) +
                " other bytes");
  Image image(raw.width, raw.height, 3);
  for (std::size_t i = 0; i < static_cast<std::size_t>(raw.width) * raw.height; ++i)
    for (int c = 0; c < 3; ++c)
      image.data[3 * i + c] = raw.image[i * raw.component + (2 - c)];
  return image;
}

} // namespace doublet
