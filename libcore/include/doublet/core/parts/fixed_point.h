#pragma once
// Numbers as files and programs want them.

#include <charconv>
#include <string>

namespace doublet {

/// With so many decimals, and a point, whatever the user's language has.
inline std::string fixed_point(double value, int decimals) {
  char text[400]; // more than the largest number has
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr};
}

} // namespace doublet
