"""Modules that are loaded when they are first named, and those that have another name than they had."""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.machinery
import sys
import warnings
from collections.abc import Callable


def lazy_modules(package: str, names: tuple[str, ...]) -> tuple[Callable, Callable]:
    """What a package needs as `__getattr__` and `__dir__` to have these modules without importing them."""

    def get(name: str):
        if name in names:
            return importlib.import_module(f"{package}.{name}")
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *names})

    return get, list_names


class RenamedModules(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports a deprecated name as the module that has its place: the same object, so that what is set in one is set in both."""

    def __init__(self, renamed: dict[str, str]):
        self.renamed = renamed

    def find_spec(self, name, path=None, target=None):
        return importlib.machinery.ModuleSpec(name, self) if name in self.renamed else None

    def exec_module(self, module) -> None:
        name = module.__name__
        warnings.warn(f"{name} is deprecated: use {self.renamed[name]}", DeprecationWarning, stacklevel=2)
        sys.modules[name] = importlib.import_module(self.renamed[name])
