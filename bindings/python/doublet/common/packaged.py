"""What ships with the package beside its code."""

from __future__ import annotations

from pathlib import Path

DATA = Path(__file__).parents[1] / "data"


def body_model_path() -> Path:
    """The statistical body model that ships with the package."""
    return DATA / "body_model.npz"
