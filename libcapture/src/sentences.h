#pragma once
// Numbers and lists in what users read.

#include <cstdio>
#include <string>
#include <vector>

namespace doublet::detail {

/// A number as printf writes it.
inline std::string printed(const char *format, double number) {
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// "a, b, c"
inline std::string joined(const std::vector<std::string> &texts) {
  std::string all;
  for (const std::string &text : texts)
    all += (all.empty() ? "" : ", ") + text;
  return all;
}

} // namespace doublet::detail
