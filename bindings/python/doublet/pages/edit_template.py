"""`doublet edit-template OUT`: a page on this machine on which the user paints the invalid triangles of the template."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.packaged import DATA
from .page_server import LocalPage, surface_page

PAGE = DATA / "edit_template.html"
SUGGESTED, EDITED = "template_suggestion.npz", "template_mask.npz"


def template_json(out: Path) -> bytes:
    """What the page shows: vertices (3 V) m, faces (3 F), the mask as it is and as suggested (F)."""
    mesh = d.read_mesh(out / "template.ply")
    suggested, mask = d.read_suggested_mask(out), d.read_template_mask(out)
    if len(mask) != len(mesh.faces):
        raise RuntimeError(f"{out / 'template.ply'} has {len(mesh.faces)} triangles, its suggestion {len(mask)}")
    arrays = {
        "vertices": np.round(mesh.vertices, 6),
        "faces": mesh.faces,
        "valid": mask.astype(int),
        "suggested": suggested.astype(int),
    }
    return json.dumps({"name": str(out), **{k: v.ravel().tolist() for k, v in arrays.items()}}).encode()


def save_mask(out: Path, body: bytes) -> dict:
    """Writes the mask that the page sent; raises ValueError saying what is wrong with it."""
    try:
        values = json.loads(body)["face_valid"]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError('expected {"face_valid": [...]}') from error
    if not isinstance(values, list) or not all(isinstance(v, int) for v in values):
        raise ValueError("expected a list of the integers 0 and 1")
    d.write_template_mask(out, values)
    return {"saved": str(out / EDITED), "invalid": values.count(0)}


def open_page(out: Path, port: int = 0) -> LocalPage:
    for name in ("template.ply", SUGGESTED):
        if not (out / name).exists():
            raise FileNotFoundError(f"{out / name} is missing; `doublet template SESSION -o {out}` writes it")
    largest = 1000 + 4 * len(d.read_suggested_mask(out))
    shown = {"/template.json": ("application/json", template_json(out)), **surface_page()}
    return LocalPage(PAGE, shown, "/mask", lambda body: save_mask(out, body), largest, port)


def edit_template(out: Path, port: int = 0, browser: bool = True) -> None:
    """Serves the page until Ctrl-C."""
    with open_page(Path(out), port) as page:
        page.run(browser)
    edited = Path(out) / EDITED
    print(f"{edited}: the next command on {out} uses it" if edited.exists() else "nothing saved; the suggestion stays")
