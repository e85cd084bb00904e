#pragma once
// Damage inside an archive that is whole: its checksums would catch what is done from outside, and nothing behind them be
// reached.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <zip.h>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t *data, std::size_t size, std::size_t max_size);

namespace doublet::fuzz {

using Members = std::map<std::string, std::string>;

/// Empty if it is no archive.
inline Members unzip(const std::uint8_t *data, std::size_t size) {
  zip_source_t *source = zip_source_buffer_create(data, size, 0, nullptr);
  zip_t *zip = source ? zip_open_from_source(source, ZIP_RDONLY, nullptr) : nullptr;
  if (!zip) {
    zip_source_free(source);
    return {};
  }
  Members members;
  for (zip_int64_t i = 0; i < zip_get_num_entries(zip, 0); ++i)
    if (zip_file_t *file = zip_fopen_index(zip, static_cast<zip_uint64_t>(i), 0)) {
      std::string content(1 << 16, '\0');
      const zip_int64_t read = zip_fread(file, content.data(), content.size());
      content.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
      members[zip_get_name(zip, static_cast<zip_uint64_t>(i), 0)] = content;
      zip_fclose(file);
    }
  zip_discard(zip);
  return members;
}

inline std::string zipped(const Members &members) {
  zip_source_t *source = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  zip_source_keep(source);
  zip_t *zip = zip_open_from_source(source, ZIP_TRUNCATE, nullptr);
  for (const auto &[name, content] : members) {
    const zip_int64_t index =
        zip_file_add(zip, name.c_str(), zip_source_buffer(zip, content.data(), content.size(), 0), ZIP_FL_OVERWRITE);
    if (index >= 0)
      zip_set_file_compression(zip, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0);
  }
  std::string bytes;
  if (zip_close(zip) == 0 && zip_source_open(source) == 0) {
    zip_source_seek(source, 0, SEEK_END);
    bytes.resize(static_cast<std::size_t>(zip_source_tell(source)));
    zip_source_seek(source, 0, SEEK_SET);
    zip_source_read(source, bytes.data(), bytes.size());
    zip_source_close(source);
  }
  zip_source_free(source);
  return bytes;
}

inline std::size_t mutate_archive(std::uint8_t *data, std::size_t size, std::size_t max_size, unsigned seed) {
  std::minstd_rand random(seed);
  Members members = unzip(data, size);
  if (members.empty() || random() % 10 == 0)
    return LLVMFuzzerMutate(data, size, max_size);
  auto chosen = members.begin();
  std::advance(chosen, random() % members.size());
  if (random() % 20 == 0) {
    members.erase(chosen);
  } else {
    std::string &content = chosen->second;
    const std::size_t before = content.size(), most = before + 256;
    content.resize(most);
    content.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t *>(content.data()), before, most));
  }
  const std::string bytes = zipped(members);
  if (bytes.empty() || bytes.size() > max_size)
    return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}

} // namespace doublet::fuzz
