"""Animatable doubles of people in loose clothing, from video.

Stages (each callable alone): build_template / rig_template, PerformanceCapture, ClothSegmenter, BodyFitter, fit_proxies,
CharacterSimulator, estimate_material. `doublet.pipeline.reconstruct` runs them all, `doublet.evaluate.evaluate` measures what
comes out.
Arrays are NumPy; metres, seconds, radians, +Y up. Stages release the GIL, report progress through `Context`, and stop at Ctrl-C.
"""

import importlib
from pathlib import Path

from . import _doublet
from ._doublet import *  # noqa: F403
from ._doublet import __version__ as __version__

__all__ = [name for name in dir(_doublet) if not name.startswith("_")] + ["__version__", "body_model_path"]

#: Modules that are loaded when they are first named.
MODULES = (
    "character",
    "evaluate",
    "garment_motion",
    "motions",
    "optimizers",
    "pipeline",
    "report",
    "segmentation_paint",
    "study",
    "synthesize",
    "template_mask",
)


def __getattr__(name: str):
    if name in MODULES:
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *MODULES})


def body_model_path() -> Path:
    """The statistical body model that ships with the package."""
    return Path(__file__).parent / "data" / "body_model.npz"
