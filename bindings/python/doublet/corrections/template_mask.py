"""Which triangles of the template count as invalid: the suggestion, and the user's own mask, which goes before it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..common.files import arrays_of, sha256, written_atomically

SUGGESTED, EDITED = "template_suggestion.npz", "template_mask.npz"


def read_suggestion(out: Path) -> np.ndarray:
    """(F) bool, false: suggested as invalid."""
    with arrays_of(Path(out) / SUGGESTED) as file:
        return file["face_valid"].astype(bool)


def read(out: Path) -> np.ndarray:
    """(F) bool: the edited mask if there is one, else the suggestion. Raises RuntimeError if the mask does not fit."""
    suggested, path = read_suggestion(out), Path(out) / EDITED
    if not path.exists():
        return suggested
    with arrays_of(path) as file:
        mask, made_for = file["face_valid"], str(file["template"]) if "template" in file else None
    try:
        mask = checked(mask, len(suggested))
    except ValueError as error:
        expected = f"a mask of the template's {len(suggested)} triangles, as {SUGGESTED} beside it has them"
        raise RuntimeError(f"{path}: expected {expected}, found {error}") from error
    if made_for not in (None, sha256(Path(out) / "template.ply")):
        raise RuntimeError(f"{path} was made for another template.ply than the one beside it; delete it or paint it again")
    return mask


def checked(mask, count: int) -> np.ndarray:
    """`mask` as (count) bool; raises ValueError saying what is wrong with it."""
    mask = np.asarray(mask)
    if mask.shape != (count,):
        raise ValueError(f"{' x '.join(map(str, mask.shape)) or 'no'} values, not one for each of {count} triangles")
    if not np.isin(mask, (0, 1)).all():
        raise ValueError("values that are neither 0 nor 1")
    if not mask.any():
        raise ValueError("no valid triangle")
    return mask.astype(bool)


def write(out: Path, mask) -> None:
    """Writes the edited mask for the template in `out`; raises ValueError if it is none."""
    mask = checked(mask, len(read_suggestion(out)))
    with written_atomically(Path(out) / EDITED) as beside:
        np.savez_compressed(beside, face_valid=mask, template=sha256(Path(out) / "template.ply"))
