#pragma once
// What every binding file shares: images as arrays, options with keywords, interruptible contexts.

#include "doublet/core/context.h"
#include "doublet/core/image.h"
#include "doublet/core/types.h"
#include "doublet/options/options.h"

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pybind11::detail {

/// doublet::Image <-> numpy uint8 (height, width) or (height, width, 3). To Python the pixels move, they are not copied.
template <> struct type_caster<doublet::Image> {
  PYBIND11_TYPE_CASTER(doublet::Image, const_name("numpy.ndarray[numpy.uint8]"));

  bool load(handle source, bool) {
    if (!isinstance<array>(source) || !reinterpret_borrow<array>(source).dtype().is(pybind11::dtype::of<std::uint8_t>()))
      return false;
    const auto pixels = array_t<std::uint8_t, array::c_style | array::forcecast>::ensure(source);
    if (pixels.ndim() != 2 && !(pixels.ndim() == 3 && (pixels.shape(2) == 3 || pixels.shape(2) == 1)))
      return false;
    value.height = static_cast<int>(pixels.shape(0));
    value.width = static_cast<int>(pixels.shape(1));
    value.channels = pixels.ndim() == 3 ? static_cast<int>(pixels.shape(2)) : 1;
    value.data.assign(pixels.data(), pixels.data() + pixels.size());
    return true;
  }

  static handle cast(doublet::Image image, return_value_policy, handle) {
    std::vector<ssize_t> shape{image.height, image.width};
    if (image.channels != 1)
      shape.push_back(image.channels);
    auto *pixels = new std::vector<std::uint8_t>(std::move(image.data));
    const capsule owner(pixels, [](void *p) { delete static_cast<std::vector<std::uint8_t> *>(p); });
    return array_t<std::uint8_t>(shape, pixels->data(), owner).release();
  }
};

} // namespace pybind11::detail

namespace doublet::python {

namespace py = pybind11;
using Release = py::call_guard<py::gil_scoped_release>;

/// "an array of int64 (3, 4)", "a list": what a user's function returned.
std::string described(const py::object &object);

/// A context that Ctrl-C interrupts: the default of every long call.
Context interruptible_context();

/// Calls a Python override, on whatever thread: `where` = "Class.method". Throws TypeError naming it if it returns something that
/// is no `R`, RuntimeError if the class has no such method. What it raises itself comes back as it is.
template <class R, class Base, class... Arguments>
R call_override(const Base *self, const std::string &where, const char *expected, Arguments &&...arguments) {
  const py::gil_scoped_acquire gil;
  const py::function method = py::get_override(self, where.substr(where.find('.') + 1).c_str());
  if (!method)
    throw std::runtime_error(where + " is not defined by the subclass");
  const py::object result = method(std::forward<Arguments>(arguments)...);
  try {
    return result.template cast<R>();
  } catch (const py::cast_error &) {
    throw py::type_error(where + " must return " + expected + ", found " + described(result));
  }
}

/// A C++ owner of an object that may be a Python subclass: keeps the Python half alive, too. None = null.
template <class T> std::shared_ptr<T> kept(const py::object &object) {
  if (object.is_none())
    return nullptr;
  PyObject *owned = py::object(object).release().ptr();
  return std::shared_ptr<T>(object.cast<T *>(), [owned](T *) {
    const py::gil_scoped_acquire gil;
    Py_DECREF(owned);
  });
}

/// Wraps `make(arguments...) -> T` written in Python, to be called on whatever thread; None = an empty function. Throws TypeError
/// if what comes back is not `expected`, e.g. "make_optimizer must return an Optimizer".
template <class T, class... Arguments>
std::function<std::shared_ptr<T>(Arguments...)> factory_from(const py::object &make, const char *expected) {
  if (make.is_none())
    return {};
  // Shared, so that copies of the function made without the GIL never touch the reference count.
  const std::shared_ptr<py::object> function(new py::object(make), [](py::object *object) {
    const py::gil_scoped_acquire gil;
    delete object;
  });
  return [function, expected](Arguments... arguments) {
    const py::gil_scoped_acquire gil;
    const py::object made = (*function)(arguments...);
    if (!py::isinstance<T>(made))
      throw py::type_error(std::string(expected) + ", found " + described(made));
    return kept<T>(made);
  };
}

/// What a caller gave as a list of objects; None is no object.
template <class T> std::vector<T *> require_objects(const std::vector<T *> &objects, const char *what) {
  if (std::find(objects.begin(), objects.end(), nullptr) != objects.end())
    throw py::type_error(std::string(what) + ": expected objects, found None");
  return objects;
}

/// An array that owns `values` without a copy.
template <class T> py::array_t<T> move_to_array(std::vector<T> values, const std::vector<py::ssize_t> &shape) {
  auto *kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void *p) { delete static_cast<std::vector<T> *>(p); });
  return py::array_t<T>(shape, kept->data(), owner);
}

/// (T, V, 3) from T x (V, 3).
py::array_t<double> stack(const std::vector<Vertices> &frames);
/// T x (V, 3) from (T, V, 3); throws ValueError naming `what` for another shape.
std::vector<Vertices> unstack(const py::array_t<double, py::array::c_style | py::array::forcecast> &frames, const char *what);

/// "m, kept between cloth and proxies: a number in [0, 1]".
template <class Field> std::string docstring(const Field &field) {
  std::string text = *field.unit ? std::string(field.unit) + ", " + field.meaning : field.meaning;
  if constexpr (!std::is_same_v<decltype(field.allowed), options::Anything>)
    text += ": " + options::shown(field.allowed);
  return text;
}

/// What a field says about itself: unit, meaning, and what it takes.
template <class Field> py::dict described_field(const Field &field) {
  py::dict result;
  result["unit"] = field.unit;
  result["meaning"] = field.meaning;
  result["takes"] = py::none();
  if constexpr (std::is_same_v<decltype(field.allowed), options::Choices>)
    result["choices"] = std::vector<std::string>(field.allowed.begin(), field.allowed.end());
  if constexpr (std::is_same_v<decltype(field.allowed), options::Range>) {
    result["lower"] = field.allowed.lower;
    result["upper"] = field.allowed.upper;
  }
  if constexpr (!std::is_same_v<decltype(field.allowed), options::Anything>)
    result["takes"] = options::shown(field.allowed);
  return result;
}

/// A struct of options (doublet/options/options.h) with keyword construction: Options(field=value, ...), which is validated, a
/// repr and a dict.
template <class T> class OptionsClass {
public:
  OptionsClass(py::module_ &m, const char *doc) : class_(m, T::describe().name, doc) {
    class_.def(py::init([](const py::kwargs &fields) {
                 T object;
                 const py::object self = py::cast(&object, py::return_value_policy::reference);
                 for (const auto &[key, value] : fields) {
                   if (!py::hasattr(self, key))
                     throw py::type_error(py::str("{} has no option '{}'").format(py::type::of(self).attr("__name__"), key));
                   py::setattr(self, key, value);
                 }
                 options::validate(object);
                 return object;
               }),
               "Every field may be given by keyword.");
    T defaults;
    options::each(defaults, [this](const auto &field, auto &) { bind(field); });
    class_.def("__repr__", [](const py::object &self) {
      return py::str("{}({})").format(py::type::of(self).attr("__name__"), self.attr("to_dict")());
    });
    class_.def(
        "to_dict",
        [](const py::object &self) {
          py::dict values;
          options::each(self.cast<const T &>(),
                        [&](const auto &field, const auto &) { values[field.name] = self.attr(field.name); });
          return values;
        },
        "Name -> value of every option.");
    if constexpr (requires { T::paper(); })
      class_.def_static("paper", &T::paper, "The settings of the paper.");
    class_.def_static(
        "described",
        [] {
          py::dict fields;
          const T object;
          options::each(object, [&](const auto &field, const auto &) { fields[field.name] = described_field(field); });
          return fields;
        },
        "Name -> {unit, meaning, takes} of every option in order, and lower and upper, or choices, where it has them.");
  }
  py::class_<T> &get() { return class_; }

private:
  template <class Value, class Allowed> void bind(const options::Field<T, Value, Allowed> &field) {
    if constexpr (std::is_enum_v<Value>)
      class_.def_property(
          field.name, [field](const T &object) { return field.allowed[static_cast<std::size_t>(object.*field.member)]; },
          [field](T &object, const std::string &name) {
            object.*field.member =
                static_cast<Value>(options::index_of(field.allowed, name, std::string(T::describe().name) + ": " + field.name));
          },
          docstring(field).c_str());
    else
      class_.def_readwrite(field.name, field.member, docstring(field).c_str());
  }
  py::class_<T> class_;
};

void bind_core(py::module_ &m);
void bind_rays(py::module_ &m);
void bind_files(py::module_ &m);
void bind_capture(py::module_ &m);
void bind_capture_parts(py::module_ &m);
void bind_segment(py::module_ &m);
void bind_bodymodel(py::module_ &m);
void bind_pbd(py::module_ &m);
void bind_simulate(py::module_ &m);
void bind_animate(py::module_ &m);
void bind_fit(py::module_ &m);

} // namespace doublet::python
