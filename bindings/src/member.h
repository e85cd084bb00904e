#pragma once
// Members that are set while Python still looks into what was in them: `capsule = character.proxies[0]; character.proxies = []`.

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>

namespace doublet::python {

namespace py = pybind11;

template <class Value> inline constexpr bool kIsEigen = std::is_base_of_v<Eigen::EigenBase<Value>, Value>;
/// Is it a class of the module?
template <class Value>
inline constexpr bool kIsBound = std::is_base_of_v<py::detail::type_caster_base<Value>, py::detail::make_caster<Value>>;

/// Does Python get such a member, or what is in the list or map, in place? Everything else it gets as a copy.
template <class Value> constexpr bool is_seen_in_place() {
  if constexpr (kIsEigen<Value> || kIsBound<Value>)
    return true;
  else if constexpr (requires { typename Value::mapped_type; })
    return is_seen_in_place<typename Value::mapped_type>();
  else if constexpr (requires { typename Value::allocator_type; })
    return is_seen_in_place<typename Value::value_type>();
  else
    return false;
}

/// Arrays, or lists of arrays, of the same sizes: a copy goes to where the old values are.
template <class Value> bool is_copied_in_place(const Value &one, const Value &other) {
  if constexpr (kIsEigen<Value>)
    return one.rows() == other.rows() && one.cols() == other.cols();
  else if constexpr (kIsBound<Value> || requires { typename Value::mapped_type; })
    return false;
  else
    return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                      [](const auto &a, const auto &b) { return is_copied_in_place(a, b); });
}

/// Calls visit(object) for the objects of Python that may look at `value`. Arrays are known to nobody but `owner`, on which they
/// hang; objects of our classes are found by their address. One that nobody has is made for the call and goes after it.
template <class Value, class Visit> void each_viewer(const Value &value, const py::object &owner, const Visit &visit) {
  if constexpr (kIsBound<Value>)
    visit(py::cast(&value, py::return_value_policy::reference));
  else if constexpr (kIsEigen<Value>)
    visit(owner);
  else if constexpr (requires { typename Value::mapped_type; })
    for (const auto &[key, one] : value)
      each_viewer(one, owner, visit);
  else
    for (const auto &one : value)
      each_viewer(one, owner, visit);
}

/// member = value. What was in it lives on, at its address, with the objects of Python that look into it.
template <class T, class C, class Value> void set_member(T &object, Value C::*const member, const Value &value) {
  if constexpr (is_seen_in_place<Value>()) {
    if (is_copied_in_place(object.*member, value)) {
      object.*member = value;
      return;
    }
    auto old = std::make_unique<Value>(value);
    std::swap(*old, object.*member);
    const py::object owner = py::cast(&object, py::return_value_policy::reference);
    Value &moved = *old;
    const py::capsule kept(old.release(), [](void *values) { delete static_cast<Value *>(values); });
    const auto keep = [&](const py::object &viewer) { py::detail::keep_alive_impl(viewer, kept); };
    if constexpr (kIsBound<Value>)
      each_viewer(object.*member, owner, keep); // it stays where it is; what it refers to has moved
    else
      each_viewer(moved, owner, keep);
  } else {
    object.*member = value;
  }
}

} // namespace doublet::python
