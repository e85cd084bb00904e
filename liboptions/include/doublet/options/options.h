#pragma once
// An options struct describes each of its fields once: name, range, unit, meaning and reason. Checks, JSON, fingerprints, the
// Python classes, the command line and the tables of docs/ are derived from it.
//
//   struct PressOptions {
//     double heat = 150;
//     bool steam = true;
//     static constexpr auto describe() {
//       using namespace options;
//       using O = PressOptions;
//       return Description{
//           "PressOptions",
//           option(&O::heat, "heat", Range{0, 220}, "degrees", "of the plate"),
//           option(&O::steam, "steam", "wet the cloth first"),
//       };
//     }
//     void validate() const { options::check(*this); } // and whatever ties fields together
//   };

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace doublet::options {

enum class Open { None, Below, Above, Both };

/// The values that an option, or each of its elements, may have; always finite.
struct Range {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  Open open = Open::None;

  constexpr bool open_below() const { return open == Open::Below || open == Open::Both; }
  constexpr bool open_above() const { return open == Open::Above || open == Open::Both; }
  bool contains(double value) const {
    return std::isfinite(value) && (open_below() ? value > lower : value >= lower) &&
           (open_above() ? value < upper : value <= upper);
  }
};
constexpr Range at_least(double lower) {
  return {.lower = lower};
}
constexpr Range above(double lower) {
  return {.lower = lower, .open = Open::Below};
}

/// The names that an option may have: those of an enumeration in its order, or the texts themselves.
using Choices = std::span<const char *const>;

struct Unconstrained {}; ///< a bool, a text or a nested struct: any value
struct NotSerialised {}; ///< a callback or a file: neither checked nor stored

template <class Struct, class Value, class Allowed> struct Field {
  Value Struct::*member;
  const char *name;
  Allowed allowed;
  const char *unit;
  const char *meaning; ///< a sentence of at most 100 characters
  const char *why;     ///< reasons, experience, what the paper has; may be empty
};

template <class S, class V>
constexpr Field<S, V, Range> option(V S::*member, const char *name, Range range, const char *unit, const char *meaning,
                                    const char *why = "") {
  return {member, name, range, unit, meaning, why};
}
template <class S, class V>
constexpr Field<S, V, Choices> option(V S::*member, const char *name, Choices choices, const char *meaning,
                                      const char *why = "") {
  return {member, name, choices, "", meaning, why};
}
template <class S, class V>
constexpr Field<S, V, Unconstrained> option(V S::*member, const char *name, const char *meaning, const char *why = "") {
  return {member, name, {}, "", meaning, why};
}
template <class S, class V>
constexpr Field<S, V, NotSerialised> not_serialised(V S::*member, const char *name, const char *meaning, const char *why = "") {
  return {member, name, {}, "", meaning, why};
}

namespace detail {

struct Whatever {
  template <class T> operator T() const;
};

/// Number of members of an aggregate: as many as its braces may contain.
template <class T, class... Members> constexpr std::size_t member_count() {
  if constexpr (requires { T{Members{}..., Whatever{}}; })
    return member_count<T, Members..., Whatever>();
  else
    return sizeof...(Members);
}

} // namespace detail

/// Does not compile if a member of the struct is left out.
template <class Struct, class... Fields> struct Description {
  const char *name;
  std::tuple<Fields...> fields;

  constexpr Description(const char *struct_name, Fields... described) : name(struct_name), fields(described...) {
    static_assert(detail::member_count<Struct>() == sizeof...(Fields), "every member of an options struct must be described");
  }
};
template <class S, class... V, class... A> Description(const char *, Field<S, V, A>...) -> Description<S, Field<S, V, A>...>;

template <class T>
concept Described = requires {
  T::describe();
};

/// visit(field, value) for every option of `object`, in order.
template <class T, class Visit> void for_each_field(T &object, Visit &&visit) {
  const auto one = [&](const auto &field) {
    if constexpr (!std::is_same_v<decltype(field.allowed), NotSerialised>)
      visit(field, object.*field.member);
  };
  std::apply([&](const auto &...field) { (one(field), ...); }, std::remove_const_t<T>::describe().fields);
}

/// The shortest text that parses to the same bits.
inline std::string to_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// Rounded to `digits` significant digits, 1 to 15; a number with more digits before the point is rounded to an integer.
inline std::string to_text(double value, int digits) {
  char text[32];
  const bool large = std::abs(value) >= std::pow(10.0, digits);
  return {text, std::to_chars(text, text + sizeof text, large ? std::round(value) : value, std::chars_format::general,
                              large ? 15 : digits)
                    .ptr};
}

/// "a number in [0, 1]", "a number of at least 0", "one of 'a', 'b'".
inline std::string to_text(const Range &range) {
  const bool below = std::isfinite(range.lower), above = std::isfinite(range.upper);
  if (below && above)
    return "a number in " + std::string(range.open_below() ? "(" : "[") + to_text(range.lower) + ", " + to_text(range.upper) +
           (range.open_above() ? ")" : "]");
  if (below)
    return (range.open_below() ? "a number above " : "a number of at least ") + to_text(range.lower);
  return "a finite number";
}
inline std::string to_text(const Choices &choices) {
  std::string text;
  for (const char *name : choices)
    text += (text.empty() ? "one of '" : ", '") + std::string(name) + "'";
  return text;
}

/// Throws std::invalid_argument, e.g. "ClothOptions: substeps: expected a number in [1, 1000], found 0".
[[noreturn]] inline void throw_invalid(const std::string &where, const std::string &expected, const std::string &found) {
  throw std::invalid_argument(where + ": expected " + expected + ", found " + found);
}

inline std::size_t index_of(const Choices &choices, const std::string &name, const std::string &where) {
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (name == choices[i])
      return i;
  throw_invalid(where, to_text(choices), "'" + name + "'");
}

namespace detail {

template <class Value>
void check_range(const Value &value, const Range &range, const char *where, const char *name, const char *unit) {
  if constexpr (std::is_arithmetic_v<Value>) {
    if (!range.contains(static_cast<double>(value)))
      throw_invalid(std::string(where) + ": " + name, to_text(range) + (*unit ? " " : "") + unit,
                    to_text(static_cast<double>(value)));
  } else {
    for (const auto &element : value)
      check_range(element, range, where, name, unit);
  }
}

template <class Value> void check_choice(const Value &value, const Choices &choices, const std::string &where) {
  if constexpr (std::is_enum_v<Value>) {
    if (static_cast<std::size_t>(value) >= choices.size())
      throw_invalid(where, to_text(choices), to_text(static_cast<double>(value)));
  } else if constexpr (std::is_same_v<Value, std::string>) {
    index_of(choices, value, where);
  } else {
    for (const std::string &name : value)
      index_of(choices, name, where);
  }
}

} // namespace detail

template <Described T> void validate(const T &object);

/// Throws std::invalid_argument naming struct, option, allowed values and value found, unless every option is in its range.
template <class T> void check(const T &object) {
  for_each_field(object, [](const auto &field, const auto &value) {
    constexpr const char *where = T::describe().name;
    if constexpr (std::is_same_v<decltype(field.allowed), Range>)
      detail::check_range(value, field.allowed, where, field.name, field.unit);
    else if constexpr (std::is_same_v<decltype(field.allowed), Choices>)
      detail::check_choice(value, field.allowed, std::string(where) + ": " + field.name);
    else if constexpr (Described<std::remove_cvref_t<decltype(value)>>)
      validate(value);
  });
}

/// The struct's own validate(), which also checks constraints between fields; check() if it has none.
template <Described T> void validate(const T &object) {
  if constexpr (requires { object.validate(); })
    object.validate();
  else
    check(object);
}

namespace detail {

template <class Field, class Value> std::string text_of(const Field &field, const Value &value) {
  if constexpr (std::is_same_v<Value, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_enum_v<Value>) {
    return field.allowed[static_cast<std::size_t>(value)];
  } else if constexpr (std::is_integral_v<Value>) {
    return std::to_string(value);
  } else if constexpr (std::is_floating_point_v<Value>) {
    return to_text(value);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return "'" + value + "'";
  } else if constexpr (requires { value.first; }) {
    return text_of(field, value.first) + "=" + text_of(field, value.second);
  } else {
    std::string text;
    for (const auto &element : value)
      text += (text.empty() ? "" : ", ") + text_of(field, element);
    return "(" + text + ")";
  }
}

} // namespace detail

/// Every option with its value as text, in order; those of nested structs as "cloth.substeps". Two objects have the same texts
/// if, and only if, they have the same bits (but for NaN).
template <class T> std::vector<std::pair<std::string, std::string>> to_pairs(const T &object, const std::string &prefix = {}) {
  std::vector<std::pair<std::string, std::string>> list;
  for_each_field(object, [&](const auto &field, const auto &value) {
    if constexpr (Described<std::remove_cvref_t<decltype(value)>>) {
      for (auto &entry : to_pairs(value, prefix + field.name + "."))
        list.push_back(std::move(entry));
    } else {
      list.emplace_back(prefix + field.name, detail::text_of(field, value));
    }
  });
  return list;
}

} // namespace doublet::options
