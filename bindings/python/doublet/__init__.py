"""Animatable doubles of people in loose clothing, from video.

Stages (each callable alone): build_template / rig_template, PerformanceCapture, ClothSegmenter, BodyFitter, fit_proxies,
CharacterSimulator, estimate_material. `doublet.pipeline.reconstruct` runs them all, `doublet.evaluate` measures the result.
Arrays are NumPy; metres, seconds, radians, +Y up. Stages release the GIL, report progress through `Context`, and stop at Ctrl-C.
"""

from pathlib import Path

from . import _doublet
from ._doublet import *  # noqa: F403
from ._doublet import __version__

__all__ = [name for name in dir(_doublet) if not name.startswith("_")] + ["__version__", "body_model_path"]


def body_model_path() -> Path:
    """The statistical body model that ships with the package."""
    return Path(__file__).parent / "data" / "body_model.npz"
