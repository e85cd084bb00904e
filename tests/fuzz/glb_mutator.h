#pragma once
// Damage to the JSON or the arrays of a GLB whose lengths are right again afterwards.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t *data, std::size_t size, std::size_t max_size);

namespace doublet::fuzz {

inline std::uint32_t word(const std::uint8_t *data) {
  std::uint32_t value;
  std::memcpy(&value, data, sizeof value);
  return value;
}

inline std::string chunk(const std::string &content, const char *type) {
  const auto length = static_cast<std::uint32_t>(content.size());
  return std::string(reinterpret_cast<const char *>(&length), 4).append(type, 4) + content;
}

inline void mutate(std::string &content, std::size_t most) {
  const std::size_t before = content.size();
  content.resize(most);
  content.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t *>(content.data()), before, most));
}

inline std::size_t mutate_glb(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  std::minstd_rand random(seed);
  const std::size_t text_size = size >= 28 ? word(data + 12) : 0;
  if (text_size == 0 || text_size > size - 28 || random() % 20 == 0)
    return LLVMFuzzerMutate(data, size, max_size);
  std::string text(reinterpret_cast<const char *>(data) + 20, text_size);
  std::string binary(reinterpret_cast<const char *>(data) + 28 + text_size, size - 28 - text_size);
  std::string &chosen = random() % 4 ? text : binary;
  mutate(chosen, chosen.size() + 64);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string chunks = chunk(text, "JSON") + chunk(binary, std::string("BIN\0", 4).c_str());
  const auto length = static_cast<std::uint32_t>(12 + chunks.size());
  const std::string whole = std::string("glTF\2\0\0\0", 8).append(reinterpret_cast<const char *>(&length), 4) + chunks;
  if (whole.size() > max_size)
    return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, whole.data(), whole.size());
  return whole.size();
}

} // namespace doublet::fuzz
