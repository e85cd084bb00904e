#pragma once
// Options as JSON: one key per field, enumerations by name, vectors as arrays, nested structs as objects. `Json` is
// nlohmann::json or any type with its interface, so that public headers include no JSON library.

#include "doublet/options/options.h"

#include <cmath>
#include <limits>

namespace doublet::options {

template <class Json, class T> Json to_json(const T &object) {
  Json json = Json::object();
  for_each_field(object, [&](const auto &field, const auto &value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (Described<Value>)
      json[field.name] = to_json<Json>(value);
    else if constexpr (std::is_enum_v<Value>)
      json[field.name] = field.allowed[static_cast<std::size_t>(value)];
    else if constexpr (requires { Value::SizeAtCompileTime; })
      json[field.name] = std::vector<double>(value.begin(), value.end());
    else
      json[field.name] = value;
  });
  return json;
}

/// Throws what `Json` throws if an option is missing or of another type, std::invalid_argument if it is out of range or a
/// fraction where a whole number belongs.
template <class Json, class T> void from_json(const Json &json, T &object) {
  for_each_field(object, [&](const auto &field, auto &value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (Described<Value>) {
      from_json(json.at(field.name), value);
    } else if constexpr (std::is_enum_v<Value>) {
      const auto name = json.at(field.name).template get<std::string>();
      value = static_cast<Value>(index_of(field.allowed, name, std::string(T::describe().name) + ": " + field.name));
    } else if constexpr (requires { Value::SizeAtCompileTime; }) {
      for (int i = 0; i < static_cast<int>(value.size()); ++i)
        value[i] = json.at(field.name).at(static_cast<std::size_t>(i)).template get<double>();
    } else {
      if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) { // of 6.9 a JSON library makes 6
        using Limits = std::numeric_limits<Value>;
        const auto number = json.at(field.name).template get<double>();
        if (!(number >= static_cast<double>(Limits::min()) && number <= static_cast<double>(Limits::max()) &&
              number == std::floor(number)))
          throw std::invalid_argument(std::string(T::describe().name) + ": " + field.name + ": expected a whole number, found " +
                                      json.at(field.name).dump());
      }
      value = json.at(field.name).template get<Value>();
    }
  });
  validate(object);
}

} // namespace doublet::options
