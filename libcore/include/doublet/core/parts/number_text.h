#pragma once
// Numbers as text in files: with a decimal point, whatever the locale.

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace doublet {

/// With `decimals` digits after the point.
inline std::string fixed_point(double value, int decimals) {
  char text[400]; // more than the largest number has
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr};
}

/// The number if the whole text is one, NaN and infinity included; none for any other text, or a number too large or small for
/// double.
inline std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-"))
    text.remove_prefix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size())
    return std::nullopt;
  return value;
}

} // namespace doublet
