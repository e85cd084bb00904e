#pragma once
// Every described field of an options struct, set to what it does not take.

#include "doublet/options/options.h"

#include <gtest/gtest.h>

#include <set>

namespace doublet {

/// The numbers next to a range, of the type that the option has; not finite ones where it can hold them.
template <class Number> std::vector<Number> outside(const options::Range &range) {
  std::vector<Number> numbers;
  if constexpr (std::is_floating_point_v<Number>) {
    numbers = {std::numeric_limits<Number>::quiet_NaN(), std::numeric_limits<Number>::infinity()};
    if (std::isfinite(range.lower))
      numbers.push_back(range.open_below() ? range.lower : std::nextafter(range.lower, -1e300));
    if (std::isfinite(range.upper))
      numbers.push_back(range.open_above() ? range.upper : std::nextafter(range.upper, 1e300));
  } else {
    if (std::is_signed_v<Number> && std::isfinite(range.lower))
      numbers.push_back(static_cast<Number>(range.lower) - 1);
    if (std::isfinite(range.upper))
      numbers.push_back(static_cast<Number>(range.upper) + 1);
  }
  return numbers;
}

template <class T> void expect_refused(const T &object, const std::string &field) {
  const std::string name = T::describe().name;
  try {
    options::validate(object);
    ADD_FAILURE() << name << ": " << field << ": took " << options::to_pairs(object).front().second;
  } catch (const std::invalid_argument &error) {
    EXPECT_EQ(std::string(error.what()).rfind(name + ": " + field + ": expected ", 0), 0u) << error.what();
    EXPECT_NE(std::string(error.what()).find(", found "), std::string::npos) << error.what();
  }
}

/// The default is valid, and whatever lies outside the range of one field is refused with a sentence that names it.
template <class T> void expect_ranges() {
  T defaults;
  options::validate(defaults);
  std::set<const void *> described;
  options::for_each_field(defaults, [&](const auto &field, auto &value) {
    EXPECT_TRUE(described.insert(&value).second) << field.name << " is described twice";
    using Value = std::remove_cvref_t<decltype(value)>;
    T object;
    auto &member = object.*field.member;
    if constexpr (options::Described<Value>) {
      expect_ranges<Value>();
    } else if constexpr (std::is_same_v<decltype(field.allowed), options::Choices>) {
      if constexpr (std::is_enum_v<Value>)
        member = static_cast<Value>(field.allowed.size());
      else if constexpr (std::is_same_v<Value, std::string>)
        member = "nobody";
      else
        member = {"nobody"};
      expect_refused(object, field.name);
    } else if constexpr (std::is_same_v<decltype(field.allowed), options::Range>) {
      if constexpr (std::is_arithmetic_v<Value>) {
        for (const Value bad : outside<Value>(field.allowed)) {
          member = bad;
          expect_refused(object, field.name);
        }
      } else {
        using Element = std::remove_cvref_t<decltype(member[0])>;
        for (const Element bad : outside<Element>(field.allowed)) {
          if constexpr (requires { Value::SizeAtCompileTime; })
            member[0] = bad;
          else
            member = {bad};
          expect_refused(object, field.name);
        }
      }
    }
  });
}

} // namespace doublet
