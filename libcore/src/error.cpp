#include "doublet/core/error.h"

namespace doublet {
namespace {

/// Bytes of the character that begins at `at`; 0 if it is not valid UTF-8 (RFC 3629, or longer than 3 bytes).
std::size_t character_length(const std::string &text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0) == 0x80; };
  const unsigned lead = byte(at), second = byte(at + 1);
  if (lead < 0x80)
    return 1;
  if (lead >= 0xC2 && lead < 0xE0 && follows(at + 1))
    return 2;
  const bool three = (lead & 0xF0) == 0xE0 && follows(at + 1) && follows(at + 2);
  const bool overlong = lead == 0xE0 && second < 0xA0, surrogate = lead == 0xED && second >= 0xA0;
  return three && !overlong && !surrogate ? 3 : 0;
}

/// What cannot be shown in a line becomes '?'.
std::string one_line(const std::string &text) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    const bool control = length == 1 && (static_cast<unsigned char>(text[at]) < ' ' || text[at] == 0x7F);
    if (length == 0 || control)
      line += text[at] == '\n' || text[at] == '\t' ? ' ' : '?';
    else
      line.append(text, at, length);
    at += length == 0 ? 1 : length;
  }
  return line;
}

/// Without the middle of what is said behind the name of the file, if that is long: it quotes a file that holds anything.
std::string shortened(const std::string &line) {
  constexpr std::size_t kLongest = 400, kEnd = 100, kStart = kLongest - kEnd - 8;
  const std::size_t said = line.find(": ") == std::string::npos ? 0 : line.find(": ");
  if (line.size() - said <= kLongest)
    return line;
  const auto character = [&](std::size_t at) { // that `at` is in
    while ((static_cast<unsigned char>(line[at]) & 0xC0) == 0x80)
      --at;
    return at;
  };
  return line.substr(0, character(said + kStart)) + " ... " + line.substr(character(line.size() - kEnd));
}

} // namespace

Error::Error(const std::string &message) : std::runtime_error(shortened(one_line(message))) {}

} // namespace doublet
