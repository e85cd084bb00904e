"""Modules that are loaded when they are first named, and names that are deprecated (docs/stability.md)."""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.machinery
import sys
import warnings
from collections.abc import Callable

PACKAGE = __name__.rpartition(".")[0]
#: Modules that were known under another name -> where they are.
DEPRECATED_MODULES = {
    "bone_map": "export.bone_map",
    "character": "export.animate",
    "console": "common.console",
    "evaluate": "evaluation.metrics",
    "garment_motion": "evaluation.motion_metrics",
    "keypoints": "session.keypoints",
    "motions": "export.clips",
    "new_session": "session.new_session",
    "pipeline": "reconstruct",
    "ready_masks": "session.external_masks",
    "report": "pages.report",
    "study": "evaluation.study",
    "synthesize": "evaluation.synthesize",
    "usd": "export.usd",
}
KITS = (
    "body_fitter", "body_model", "cloth_segmenter", "cloth_solver", "feature_tracker", "frame_source", "garment_mesher",
    "limb_search", "objective", "optimizer", "performance_capture", "pose_optimizer", "silhouette_extractor", "surface_refiner",
)  # fmt: skip
#: Names of the package -> the module that has them.
DEPRECATED_NAMES = {f"{kit}_violations": "testing" for kit in KITS}


def warn(old: str, new: str) -> None:
    warnings.warn(f"{PACKAGE}.{old} is deprecated: use {PACKAGE}.{new}", DeprecationWarning, stacklevel=3)


def renamed_to(name: str) -> str | None:
    from .common.renamed import NAMES  # which needs this module itself

    return NAMES.get(name)


def lazy_modules(package: str, names: tuple[str, ...], deprecated: dict[str, str] | None = None) -> tuple[Callable, Callable]:
    """What a package needs as `__getattr__` and `__dir__` to have these modules without importing them, and names that are
    deprecated."""

    def get(name: str):
        if name in names:
            return importlib.import_module(f"{package}.{name}")
        if name in (deprecated or {}):
            warn(name, f"{deprecated[name]}.{name}")
            return getattr(importlib.import_module(f"{package}.{deprecated[name]}"), name)
        if package == PACKAGE and (new := renamed_to(name)):
            warn(name, new)
            return getattr(sys.modules[package], new)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *names} - DEPRECATED_MODULES.keys())

    return get, list_names


class DeprecatedModules(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports a deprecated name as the module that has its place: the same object, so that what is set in one is set in both."""

    def find_spec(self, name, path=None, target=None):
        known = name.rpartition(".")[0] == PACKAGE and name.rpartition(".")[2] in DEPRECATED_MODULES
        return importlib.machinery.ModuleSpec(name, self) if known else None

    def exec_module(self, module) -> None:
        old = module.__name__.rpartition(".")[2]
        warn(old, DEPRECATED_MODULES[old])
        sys.modules[module.__name__] = importlib.import_module(f"{PACKAGE}.{DEPRECATED_MODULES[old]}")


def find_deprecated_modules() -> None:
    sys.meta_path.append(DeprecatedModules())
