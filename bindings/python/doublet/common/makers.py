"""Which function makes an object of a class: for who calls a class that has no constructor, or gives an object of another class.

The signatures in the docstrings of the native half are what is looked up."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator

from .. import _doublet as native

SIGNATURE = re.compile(r"^(?:\d+\. )?(\w+)\((.*)\) -> (\S+)$", re.MULTILINE)
OURS = f"{native.__name__}."


def no_constructor(made: type) -> str:
    """A sentence for who calls a class that has no constructor."""
    name = made.__name__
    makers = dict.fromkeys(called for called, taken, result in signatures() if result == name and taken[:1] != [name])
    of_its_own = [called for called in makers if called.startswith(f"{name}.")]
    free = [called for called in makers if "." not in called]
    chosen = of_its_own + free or list(makers)
    return f"doublet.{name} has no constructor: " + (
        f"{listed(chosen)} makes one" if chosen else "other objects and results hold such ones"
    )


def other_class(found: object, wanted: type) -> str:
    """A sentence for who gives an object of another class, or a path, if there is a function that makes of it what is wanted;
    otherwise empty."""
    name = wanted.__name__
    if isinstance(found, (str, os.PathLike)):
        made_of = {called: taken[0] for called, taken, result in signatures() if result == name and taken and "." not in called}
        readers = readers_of(name) or [f"{called}(a {of})" for called, of in made_of.items() if readers_of(of)][:1]
        return f"expected {name}, found {type(found).__name__}; {listed(readers)} makes one" if readers else ""
    if isinstance(found, type) or not any(f"{of.__module__}." == OURS for of in type(found).__mro__):
        return ""
    given = bound_class(type(found)).__name__
    makers = [called for called, taken, result in signatures() if result == name and taken[:1] == [given]]
    return f"expected {name}, found {given}; {listed(makers)} makes one of it" if makers else ""


def readers_of(name: str) -> list[str]:
    """Functions that read an object of that class from a path."""
    reads = [called for called, taken, result in signatures() if result == name and taken[:1] == ["os.PathLike"]]
    return [called for called in reads if called == name or re.search("read|open", called)]


def bound_class(derived: type) -> type:
    return next(of for of in derived.__mro__ if f"{of.__module__}." == OURS)


def listed(names: list[str]) -> str:
    return " or ".join(f"doublet.{name}" for name in dict.fromkeys(names))


def signatures() -> Iterator[tuple[str, list[str], str]]:
    """(name, classes of the arguments, class of the result) of all functions, static methods and methods."""
    for name, value in vars(native).items():
        if not isinstance(value, type):
            yield from signatures_of(name, value)
            continue
        for _, taken, _ in signatures_of("", vars(value).get("__init__")):
            yield name, taken[1:], name
        for method in vars(value):
            if not method.startswith("_"):
                yield from signatures_of(f"{name}.{method}", getattr(value, method))


def signatures_of(name: str, value: object) -> Iterator[tuple[str, list[str], str]]:
    for _, taken, result in SIGNATURE.findall(getattr(value, "__doc__", None) or ""):
        classes = re.findall(r": (?:collections\.abc\.Sequence\[)?([\w.]+)", taken)
        yield name, [of.removeprefix(OURS) for of in classes], result.removeprefix(OURS)
