"""What a person painted over the segmentation: cloth, skin, and borders between regions, which go before what was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import arrays_of, sha256, written_atomically

PAINTED, FOUND = "segmentation_paint.npz", "segmentation_found.npz"
NONE, SKIN, CLOTH, BORDER = -1, 0, 1, 2


def checked(painted, count: int) -> np.ndarray:
    """`painted` as (count) int32; raises ValueError saying what is wrong with it."""
    painted = np.asarray(painted)
    if painted.shape != (count,):
        raise ValueError(f"{' x '.join(map(str, painted.shape)) or 'no'} values, not one for each of {count} vertices")
    if not np.isin(painted, (NONE, SKIN, CLOTH, BORDER)).all():
        raise ValueError("values that are none of -1 (as found), 0 (skin), 1 (cloth) and 2 (border)")
    return painted.astype(np.int32)


def read(out: Path, count: int) -> np.ndarray | None:
    """(count) int32, or None if nothing was painted. Raises RuntimeError if the file does not fit."""
    path = Path(out) / PAINTED
    if not path.exists():
        return None
    with arrays_of(path) as file:
        painted, made_for = file["painted"], str(file["template"]) if "template" in file else None
    try:
        painted = checked(painted, count)
    except ValueError as error:
        raise RuntimeError(f"{path}: expected what was painted on the template's vertices, found {error}") from error
    template = Path(out) / "template.ply"
    if made_for is not None and template.exists() and made_for != sha256(template):
        raise RuntimeError(f"{path} was made for another template.ply than the one beside it; delete it or paint it again")
    return painted


def write(out: Path, painted, count: int) -> None:
    """Writes it for the template in `out`; raises ValueError if it is not one of the four values a vertex."""
    painted, template = checked(painted, count), Path(out) / "template.ply"
    arrays = {"painted": painted.astype(np.int8)}
    if template.exists():
        arrays["template"] = np.array(sha256(template))
    with written_atomically(Path(out) / PAINTED) as beside:
        np.savez_compressed(beside, **arrays)


def read_found(out: Path) -> d.Segmentation:
    """The segmentation as it was before anything was painted."""
    found = Path(out) / FOUND
    return d.read_segmentation(found if found.exists() else Path(out) / "segmentation.npz")
