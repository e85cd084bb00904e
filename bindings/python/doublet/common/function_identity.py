"""Which function is it? Its name does not tell one lambda from the next, nor a function from what it was before it was edited."""

from __future__ import annotations

import hashlib
import warnings
from functools import partial
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType

PLAIN = (type(None), type(...), bool, int, float, complex, str, bytes)


def function_identity(function) -> str:
    """ "package.module.function 5e0c3d1f": its name, and a hash of its code and of what it holds (defaults, variables of the
    function around it, arguments of a partial, attributes of an object that is called), not of what it calls. Raises TypeError
    if it holds what has no value to hash, such as an open file."""
    named = function
    while isinstance(named, partial):
        named = named.func
    held = [function]
    if not hasattr(named, "__qualname__"):  # an object that is called
        named = type(named)
        held.append(named.__call__)
    name = f"{named.__module__}.{named.__qualname__}"
    try:
        return f"{name} {digest(held, ()).hex()[:8]}"
    except Exception as error:  # whatever an object says that cannot be taken apart
        raise TypeError(
            f"{name} cannot be told from another of that name ({error}); give it a name of its own, runner='...'"
        ) from error


def digest(value, around: tuple[int, ...]) -> bytes:
    """SHA-256 of a value, the same in every process. `around`: ids of the values that it is part of."""
    if type(value) in PLAIN:
        return hashed(type(value).__name__, [value if type(value) is bytes else repr(value).encode()])
    if id(value) in around:  # a function that calls itself
        return hashed("around", [str(around[::-1].index(id(value))).encode()])
    around = (*around, id(value))
    if isinstance(value, (type, BuiltinFunctionType)):
        return hashed("name", [f"{value.__module__}.{value.__qualname__}".encode()])
    if isinstance(value, ModuleType):
        return hashed("name", [value.__name__.encode()])
    if isinstance(value, (set, frozenset)):  # whose order is another in every process
        return hashed("set", sorted(digest(each, around) for each in value))
    return hashed(type(value).__name__, [digest(part, around) for part in parts(value)])


def parts(value) -> list:
    if isinstance(value, FunctionType):
        return [value.__code__, value.__defaults__, value.__kwdefaults__, list(value.__closure__ or ())]
    if isinstance(value, CodeType):
        return [value.co_code, value.co_names, value.co_varnames, value.co_consts]
    if isinstance(value, CellType):
        return [value.cell_contents] if value != CellType() else []
    if isinstance(value, MethodType):
        return [value.__func__, value.__self__]
    if type(value) in (list, tuple):
        return list(value)
    if type(value) is dict:
        return [part for item in value.items() for part in item]
    if isinstance(value, partial):
        return [value.func, value.args, value.keywords]
    try:
        return list(value.__reduce_ex__(4))
    except TypeError:
        return properties(value)


def properties(value) -> list:
    """Of an object of the native half that cannot be pickled: the names and values of its properties."""
    kind = type(value)
    names = [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
    if not kind.__module__.startswith(__name__.partition(".")[0] + ".") or not names:
        raise TypeError(f"no value of a {kind.__name__} tells it from another")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return [part for name in names for part in (name, getattr(value, name))]


def hashed(kind: str, of: list[bytes]) -> bytes:
    return hashlib.sha256(kind.encode() + b"".join(hashlib.sha256(each).digest() for each in of)).digest()
