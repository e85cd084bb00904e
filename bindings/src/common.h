#pragma once
// What every binding file shares: images as arrays, options with keywords, interruptible contexts.

#include "member.h"

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

namespace doublet::python {

/// Is it, or is in it, a complex number? NumPy would hand over its real part.
bool has_complex(const pybind11::handle &object);

} // namespace doublet::python

namespace pybind11::detail {

/// Numbers (N), none of them complex.
template <> struct type_caster<std::vector<double>> : list_caster<std::vector<double>, double> {
  bool load(handle source, bool convert) {
    return !doublet::python::has_complex(source) && list_caster<std::vector<double>, double>::load(source, convert);
  }
};

/// doublet::Image <-> numpy uint8 (height, width) or (height, width, 3). To Python the pixels move, they are not copied.
template <> struct type_caster<doublet::Image> {
  PYBIND11_TYPE_CASTER(doublet::Image, const_name("numpy.ndarray[numpy.uint8]"));

  bool load(handle source, bool) {
    if (!isinstance<array>(source))
      return false;
    const pybind11::dtype given = reinterpret_borrow<array>(source).dtype(); // of what was pickled it is an object of its own
    if (given.kind() != 'u' || given.itemsize() != 1)
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

/// Masks (N) <-> numpy bool; any sequence of bools, or of whole numbers in [0, 255], is taken. A member of a class is a copy that
/// cannot be written to: what one would write to it would be lost.
template <> struct type_caster<doublet::Mask> {
#if PYBIND11_VERSION_HEX >= 0x03000000
  PYBIND11_TYPE_CASTER(doublet::Mask, io_name("numpy.typing.ArrayLike", "numpy.typing.NDArray[numpy.bool_]"));
#else
  PYBIND11_TYPE_CASTER(doublet::Mask, const_name("numpy.typing.NDArray[numpy.bool_]"));
#endif

  bool load(handle source, bool convert) {
    if (!isinstance<array>(source)) {
      list_caster<doublet::Mask, std::uint8_t> list;
      if (!list.load(source, convert))
        return false;
      value = std::move(static_cast<doublet::Mask &>(list));
      return true;
    }
    const auto given = reinterpret_borrow<array>(source);
    const char kind = given.dtype().kind();
    if (given.ndim() != 1 || (given.size() && kind != 'b' && kind != 'i' && kind != 'u'))
      return false;
    const auto numbers = array_t<std::int64_t, array::c_style | array::forcecast>::ensure(given);
    value.assign(numbers.size(), 0);
    for (ssize_t i = 0; i < numbers.size(); ++i) {
      value[i] = static_cast<std::uint8_t>(numbers.at(i));
      if (value[i] != numbers.at(i))
        return false;
    }
    return true;
  }

  static handle cast(const doublet::Mask &values, return_value_policy policy, handle) {
    array_t<bool> result(static_cast<ssize_t>(values.size()));
    std::transform(values.begin(), values.end(), result.mutable_data(), [](std::uint8_t value) { return value != 0; });
    if (policy == return_value_policy::reference_internal)
      array_proxy(result.ptr())->flags &= ~npy_api::NPY_ARRAY_WRITEABLE_;
    return result.release();
  }
};

} // namespace pybind11::detail

namespace doublet::python {

/// An array made for its caller from what a class keeps otherwise: it cannot be written to, as what one would write to it would
/// be lost.
template <class Array> struct ReadOnly { Array values; };

} // namespace doublet::python

namespace pybind11::detail {

template <class Array> struct type_caster<doublet::python::ReadOnly<Array>> {
  static constexpr auto name = make_caster<Array>::name;
  static handle cast(doublet::python::ReadOnly<Array> &&made, return_value_policy, handle parent) {
    const handle result = make_caster<Array>::cast(std::move(made.values), return_value_policy::move, parent);
    if (result)
      array_proxy(result.ptr())->flags &= ~npy_api::NPY_ARRAY_WRITEABLE_;
    return result;
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

/// From now on no array of complex numbers becomes one of real ones on its way into the module, be it Eigen's or NumPy's: both
/// pass through two functions of NumPy's, which would hand over the real parts.
void refuse_complex_arrays();

/// Calls a Python override, on whatever thread: `where` = "Class.method". Throws TypeError naming it if it returns something that
/// is no `R`, RuntimeError if the class has no such method. What it raises itself comes back as it is.
template <class R, class Base, class... Arguments>
R call_override(const Base *self, const std::string &where, const char *expected, Arguments &&...arguments) {
  const py::gil_scoped_acquire gil;
  const py::function method = py::get_override(self, where.substr(where.find('.') + 1).c_str());
  if (!method)
    throw std::runtime_error(where + " is not defined by the subclass");
  const py::object result = method(std::forward<Arguments>(arguments)...);
  if (has_complex(result))
    throw py::type_error(where + " must return " + expected + ", found complex numbers in " + described(result));
  const auto refuse = [&] { throw py::type_error(where + " must return " + expected + ", found " + described(result)); };
  try {
    return result.template cast<R>();
  } catch (const py::cast_error &) {
    refuse();
    throw;
  } catch (const py::type_error &) { // of name_makers()
    refuse();
    throw;
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

/// A class of the module whose setters have a named argument, which pybind11's have not.
template <class T, class... Extra> class Class : public py::class_<T, Extra...> {
public:
  using Base = py::class_<T, Extra...>;
  using Base::Base;

  template <class... Arguments> Class &def(Arguments &&...arguments) {
    Base::def(std::forward<Arguments>(arguments)...);
    return *this;
  }
  template <class... Arguments> Class &def_static(Arguments &&...arguments) {
    Base::def_static(std::forward<Arguments>(arguments)...);
    return *this;
  }
  template <class... Arguments> Class &def_readonly(Arguments &&...arguments) {
    Base::def_readonly(std::forward<Arguments>(arguments)...);
    return *this;
  }
  template <class Getter, class... More>
  Class &def_property_readonly(const char *name, const Getter &getter, const More &...more) {
    Base::def_property_readonly(name, without_loss(getter), more...);
    return *this;
  }
  template <class Getter, class Setter, class... More>
  Class &def_property(const char *name, const Getter &getter, Setter setter, const More &...more) {
    Base::def_property(name, without_loss(getter),
                       py::cpp_function(std::move(setter), py::name(name), py::is_method(*this), py::arg("value")), more...);
    return *this;
  }
  template <class C, class Value, class... More> Class &def_readwrite(const char *name, Value C::*member, const More &...more) {
    const py::cpp_function get([member](const T &self) -> const Value & { return self.*member; }, py::is_method(*this),
                               py::return_value_policy::reference_internal);
    return def_property(
        name, get, [member](T &self, const Value &value) { set_member(self, member, value); }, more...);
  }
  /// For copy.copy() and copy.deepcopy(), which are the same: a value has no other objects in it.
  Class &def_copies() {
    def("__copy__", [](const T &self) { return self; });
    return def(
        "__deepcopy__", [](const T &self, const py::dict &) { return self; }, py::arg("memo"));
  }
  /// Numbers (N) as an array, like a member of bytes: a copy that cannot be written to.
  template <class C> Class &def_numbers(const char *name, std::vector<int> C::*member, const char *doc) {
    Base::def_property_readonly(
        name, [member](const T &self) { return read_only(self.*member); }, doc);
    return *this;
  }
  template <class C> Class &def_numbers_readwrite(const char *name, std::vector<int> C::*member, const char *doc) {
    return def_property(
        name, [member](const T &self) { return read_only(self.*member); },
        [member](T &self, std::vector<int> value) { self.*member = std::move(value); }, doc);
  }

private:
  template <class Value>
  static constexpr bool kIsArray = kIsEigen<Value> || std::is_base_of_v<py::array, Value> || std::is_same_v<Value, Image>;
  /// What returns an array of its own returns one that cannot be written to; every other getter is left as it is.
  template <class Getter> static auto without_loss(const Getter &getter) {
    if constexpr (std::is_invocable_v<Getter, const T &>) {
      using Value = std::invoke_result_t<Getter, const T &>;
      if constexpr (kIsArray<Value>)
        return [getter](const T &self) { return ReadOnly<Value>{std::invoke(getter, self)}; };
      else
        return getter;
    } else {
      return getter;
    }
  }
  static py::array_t<int> read_only(const std::vector<int> &values) {
    py::array_t<int> result(static_cast<py::ssize_t>(values.size()), values.data());
    result.attr("flags").attr("writeable") = false;
    return result;
  }
};

/// "m, kept between cloth and proxies: a number in [0, 1]".
template <class Field> std::string docstring(const Field &field) {
  std::string text = *field.unit ? std::string(field.unit) + ", " + field.meaning : field.meaning;
  if constexpr (!std::is_same_v<decltype(field.allowed), options::Unconstrained>)
    text += ": " + options::to_text(field.allowed);
  return *field.why ? text + ". " + field.why : text;
}

/// What a field says about itself: unit, meaning, why, and what it takes.
template <class Field> py::dict described_field(const Field &field) {
  py::dict result;
  result["unit"] = field.unit;
  result["meaning"] = field.meaning;
  result["why"] = field.why;
  result["takes"] = py::none();
  if constexpr (std::is_same_v<decltype(field.allowed), options::Choices>)
    result["choices"] = std::vector<std::string>(field.allowed.begin(), field.allowed.end());
  if constexpr (std::is_same_v<decltype(field.allowed), options::Range>) {
    result["lower"] = field.allowed.lower;
    result["upper"] = field.allowed.upper;
  }
  if constexpr (!std::is_same_v<decltype(field.allowed), options::Unconstrained>)
    result["takes"] = options::to_text(field.allowed);
  return result;
}

template <class> inline constexpr bool kIsFunction = false;
template <class Signature> inline constexpr bool kIsFunction<std::function<Signature>> = true;

/// Are two members of an options struct the same, if they are no options? A function is like no other.
template <class Value> bool same_value(const Value &one, const Value &other) {
  if constexpr (kIsFunction<Value>)
    return !one && !other;
  else if constexpr (requires { one.rows(); })
    return one.rows() == other.rows() && one.cols() == other.cols() && one == other;
  else
    return one == other;
}

template <class T> bool same_fields(const T &one, const T &other);

template <class Field, class T> bool same_field(const Field &field, const T &one, const T &other) {
  using Value = std::remove_cvref_t<decltype(one.*field.member)>;
  if constexpr (std::is_same_v<decltype(field.allowed), options::NotSerialised>)
    return same_value(one.*field.member, other.*field.member);
  else if constexpr (options::Described<Value>)
    return same_fields(one.*field.member, other.*field.member);
  else
    return options::detail::text_of(field, one.*field.member) == options::detail::text_of(field, other.*field.member);
}

/// By their description: options of the same bits, and the same paths, samples ... beside them.
template <class T> bool same_fields(const T &one, const T &other) {
  return std::apply([&](const auto &...field) { return (same_field(field, one, other) && ...); }, T::describe().fields);
}

/// A struct of options (doublet/options/options.h) with keyword construction: Options(field=value, ...), which is validated. What
/// follows from its description: a dict, comparison, copies, pickles, and a repr of what is not as by default.
template <class T> class OptionsClass {
public:
  OptionsClass(py::module_ &m, const char *doc) : class_(m, T::describe().name, doc) {
    class_.def(py::init([](const py::kwargs &fields) {
                 const T object = from_dict(fields);
                 options::validate(object);
                 return object;
               }),
               "Every field may be given by keyword.");
    T defaults;
    options::for_each_field(defaults, [this](const auto &field, auto &) { bind(field); });
    class_.def("__repr__", &text);
    class_.def("to_dict", &to_dict, "Name -> value of every option.");
    class_.def(
        "__eq__",
        [](const T &self, const py::object &other) -> py::object {
          if (!py::isinstance<T>(other))
            return py::reinterpret_borrow<py::object>(Py_NotImplemented);
          const T &options = other.cast<const T &>();
          return py::bool_(&self == &options || same_fields(self, options));
        },
        py::arg("other"));
    class_.def_copies();
    class_.def(py::pickle(&pickled, &from_dict), py::arg("state"));
    if constexpr (requires { T::paper(); })
      class_.def_static("paper", &T::paper, "The settings of the paper.");
    class_.def_static(
        "described",
        [] {
          py::dict fields;
          const T object;
          options::for_each_field(object, [&](const auto &field, const auto &) { fields[field.name] = described_field(field); });
          return fields;
        },
        "Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.");
  }
  Class<T> &get() { return class_; }

private:
  /// Not validated. Throws TypeError for what is no option.
  static T from_dict(const py::dict &fields) {
    T object;
    const py::object self = py::cast(&object, py::return_value_policy::reference);
    for (const auto &[key, value] : fields) {
      if (!py::hasattr(self, key))
        throw py::type_error(py::str("{} has no option '{}'").format(T::describe().name, key));
      py::setattr(self, key, value);
    }
    return object;
  }

  static py::dict to_dict(const py::object &self) {
    py::dict values;
    options::for_each_field(self.cast<const T &>(),
                            [&](const auto &field, const auto &) { values[field.name] = self.attr(field.name); });
    return values;
  }

  template <class Field> static constexpr bool is_function(const Field &field) {
    return kIsFunction<std::remove_cvref_t<decltype(std::declval<T &>().*field.member)>>;
  }

  /// visit(field) for every field that differs from the default.
  template <class Visit> static void each_chosen(const T &object, Visit &&visit) {
    const T defaults;
    const auto one = [&](const auto &field) {
      if (!same_field(field, object, defaults))
        visit(field);
    };
    std::apply([&](const auto &...field) { (one(field), ...); }, T::describe().fields);
  }

  /// "ClothOptions(iterations=8)": reads back as equal options, but for functions, which are shown as "...".
  static std::string text(const py::object &self) {
    std::string list;
    each_chosen(self.cast<const T &>(), [&](const auto &field) {
      py::object value = self.attr(field.name);
      if (py::isinstance<py::array>(value))
        value = value.attr("tolist")(); // with every digit
      const std::string shown = is_function(field) ? "..." : py::repr(value).template cast<std::string>();
      list += (list.empty() ? "" : ", ") + std::string(field.name) + "=" + shown;
    });
    return T::describe().name + ("(" + list + ")");
  }

  static py::dict pickled(const py::object &self) {
    py::dict state;
    each_chosen(self.cast<const T &>(), [&](const auto &field) {
      if (is_function(field))
        throw py::type_error(std::string(T::describe().name) + ": cannot be pickled with '" + field.name + "'");
      state[field.name] = self.attr(field.name);
    });
    return state;
  }

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
  Class<T> class_;
};

/// Classes of the module say which function makes an object, to who calls a class without a constructor or gives another object.
void name_makers(const py::module_ &m);

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
void bind_reconstruct(py::module_ &m);

} // namespace doublet::python
