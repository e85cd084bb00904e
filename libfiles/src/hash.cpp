#include "doublet/files/hash.h"

#include "doublet/core/error.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

namespace doublet {

namespace {

class Sha256 {
public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw Error("SHA-256: not available in this build of OpenSSL");
  }
  void add(const char *data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i)
      for (const int half : {digest[i] >> 4, digest[i] & 15})
        text += "0123456789abcdef"[half];
    return text;
  }

private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

std::string hash_file(const Path &path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw FileNotFound(path.string() + " does not exist, or cannot be read");
  Sha256 hash;
  std::array<char, 1 << 16> block;
  do {
    stream.read(block.data(), block.size());
    hash.add(block.data(), static_cast<std::size_t>(stream.gcount()));
  } while (stream);
  if (stream.bad())
    throw Error(path.string() + ": cannot be read");
  return hash.digits();
}

} // namespace

std::string hash_files(const Path &path) {
  if (!std::filesystem::is_directory(path))
    return hash_file(path);
  std::vector<Path> files;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(path))
    if (entry.is_regular_file())
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Sha256 hash;
  for (const Path &file : files) {
    const std::string line = file.lexically_relative(path).generic_string() + " " + hash_file(file) + "\n";
    hash.add(line.data(), line.size());
  }
  return hash.digits();
}

} // namespace doublet
