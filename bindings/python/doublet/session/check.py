"""The picture of a session's check: scan, silhouettes and joints in every camera."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from .. import _doublet as d
from ..common import drawing
from ..common.files import written_atomically

COLUMNS, WIDTH = 4, 500  #: tiles in a row, px of a tile: at least what a checked image has


def check_and_draw(
    session: d.Session,
    frames: d.FrameSource,
    extractor: d.SilhouetteExtractor | None,
    path: Path,
    context: d.Context | None = None,
) -> d.SessionCheck:
    """Every check, and the picture of it."""
    checked = d.check_session(session, frames, extractor, context or d.Context())
    with written_atomically(path) as partial:
        Image.fromarray(draw(checked, frames)).save(partial, "PNG")
    return checked


def draw(checked: d.SessionCheck, frames: d.FrameSource) -> np.ndarray:
    """(H, W, 3) RGB: the frame that was looked at, of every camera, with the outlines of scan (magenta) and silhouette (green),
    the joints (yellow), and the camera's name and overlap; without a scan, silhouettes alone."""
    tiles = [tile(checked, c, frames.image(c, checked.frame)) for c in range(len(checked.rig))]
    height = max(tile.shape[0] for tile in tiles)
    columns = min(COLUMNS, len(tiles))
    tiles = [np.pad(tile, ((0, height - tile.shape[0]), (0, WIDTH - tile.shape[1]), (0, 0))) for tile in tiles]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[r : r + columns]) for r in range(0, len(tiles), columns)])


def tile(checked: d.SessionCheck, c: int, image: np.ndarray) -> np.ndarray:
    camera, silhouette, text = checked.rig[c], checked.silhouettes[c], checked.rig[c].name
    photo = np.full((camera.height, camera.width, 3), 100, np.uint8)
    if image.size:
        photo = np.asarray(Image.fromarray(image[..., ::-1]).resize((camera.width, camera.height)))
    if silhouette.size:
        photo = drawing.draw_outline(photo, drawing.mask_outline(silhouette > 0), (0, 220, 60))
    if checked.shadows:
        photo = drawing.draw_outline(photo, drawing.mask_outline(checked.shadows[c] > 0))
        text += f"  overlap {checked.overlaps[c, c]:.2f}"
    for joint in checked.joints:
        dot(photo, camera.project(joint))
    return labelled(photo, text)


def labelled(image: np.ndarray, text: str) -> np.ndarray:
    shown = Image.fromarray(image)
    ImageDraw.Draw(shown).text((8, 6), text, fill=(255, 255, 255), stroke_width=1, stroke_fill=(0, 0, 0))
    return np.array(shown)


def dot(image: np.ndarray, place) -> None:
    x, y = np.ravel(place)
    if np.isfinite([x, y]).all() and 0 <= x < image.shape[1] and 0 <= y < image.shape[0]:
        x, y = int(x), int(y)
        image[max(0, y - 2) : y + 3, max(0, x - 2) : x + 3] = (255, 220, 0)
