"""`doublet edit-segmentation OUT`: a page on this machine on which the user corrects what is cloth, and where garments end."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.packaged import DATA
from .page_server import LocalPage, surface_page

PAGE = DATA / "edit_segmentation.html"
PAINTED = "segmentation_paint.npz"
AS_FOUND = -1  # among skin 0, cloth 1 and border 2
FRAMES = 24  # of the captured motion, shown on demand


def shown_rows(count: int) -> np.ndarray:
    """Rows of so many captured frames, spread over all of them."""
    return np.unique(np.linspace(0, count - 1, min(count, FRAMES)).round().astype(int))


def segmentation_json(out: Path) -> bytes:
    """What the page shows: vertices (3 V) m, faces (3 F), which the scan has (F), clothness as found (V), what is painted (V),
    and the captured surface in some frames, all in one place."""
    actor, found = d.read_actor(out / "actor.npz"), d.read_found_segmentation(out)
    count = len(actor.mesh.vertices)
    if len(found.clothness) != count:
        raise RuntimeError(f"{out / 'actor.npz'} has {count} vertices, the segmentation {len(found.clothness)}")
    painted = d.read_segmentation_paint(out, count)
    performance = d.read_performance(out / "performance.npz", actor)
    rows = shown_rows(len(performance.frames))
    middle = actor.mesh.vertices.mean(axis=0)
    moved = [np.asarray(performance.surface.frames[row]) for row in rows]
    arrays = {
        "vertices": np.round(actor.mesh.vertices, 5),
        "faces": actor.mesh.faces,
        "valid": np.asarray(actor.face_valid).astype(int),
        "clothness": np.round(found.clothness, 3),
        "painted": np.full(count, AS_FOUND) if painted is None else painted,
    }
    frames = [np.round(vertices - vertices.mean(axis=0) + middle, 4).ravel().tolist() for vertices in moved]
    numbers = [int(performance.frames[row]) for row in rows]
    shown = {"name": str(out), "frames": frames, "frame_numbers": numbers, **{k: v.ravel().tolist() for k, v in arrays.items()}}
    return json.dumps(shown).encode()


def save_paint(out: Path, count: int, body: bytes) -> dict:
    """Writes what the page sent; raises ValueError saying what is wrong with it."""
    try:
        values = json.loads(body)["painted"]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError('expected {"painted": [...]}') from error
    if not isinstance(values, list) or not all(isinstance(v, int) for v in values):
        raise ValueError("expected a list of the integers -1, 0, 1 and 2")
    d.write_segmentation_paint(out, values, count)
    return {"saved": str(out / PAINTED), "painted": len(values) - values.count(AS_FOUND)}


def open_page(out: Path, port: int = 0) -> LocalPage:
    for name in ("actor.npz", "performance.npz", "segmentation.npz"):
        if not (out / name).exists():
            raise FileNotFoundError(f"{out / name} is missing; `doublet segment {out}` and the stages before write it")
    count = len(d.read_found_segmentation(out).clothness)
    shown = {"/segmentation.json": ("application/json", segmentation_json(out)), **surface_page()}
    return LocalPage(PAGE, shown, "/paint", lambda body: save_paint(out, count, body), 1000 + 4 * count, port)


def edit_segmentation(out: Path, port: int = 0, browser: bool = True) -> None:
    """Serves the page until Ctrl-C."""
    with open_page(Path(out), port) as page:
        page.run(browser)
    painted = Path(out) / PAINTED
    print(f"{painted}: the next command on {out} uses it" if painted.exists() else "nothing saved; the segmentation stays")
