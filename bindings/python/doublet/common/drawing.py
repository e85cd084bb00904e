"""Pictures for the report and the video: the library's renderer, outlines on video, JPEG for a page."""

from __future__ import annotations

import base64
import io

import numpy as np
from PIL import Image

from .. import _doublet as d

SKIN, CLOTH, PROXY = (np.array(c) for c in ((0.85, 0.72, 0.62), (0.75, 0.25, 0.28), (0.30, 0.45, 0.70)))
UNSURE = np.array((0.95, 0.85, 0.2))


def cloth_colours(clothness: np.ndarray) -> np.ndarray:
    """(V, 3) from skin to cloth."""
    return (1 - clothness[:, None]) * SKIN + clothness[:, None] * CLOTH


def probability_colours(probability: np.ndarray) -> np.ndarray:
    """(V, 3) from skin to cloth, yellow where it may be either."""
    certain = np.abs(2 * probability - 1)[:, None]
    return certain * cloth_colours((probability > 0.5).astype(float)) + (1 - certain) * UNSURE


def shade(meshes: list[d.RenderMesh], camera: d.Camera) -> np.ndarray:
    """(H, W, 3) RGB on white, lit from over the photographer's shoulder."""
    right, _, forward = camera.R
    light = 0.4 * right - forward + [0, 0.8, 0]
    return d.render(meshes, camera, d.RenderOptions(background=[1, 1, 1], floor=False, light_direction=light))[..., ::-1]


def around(vertices, azimuth: float, size: int = 480) -> d.Camera:
    """A camera that sees all vertices from `azimuth` rad around +Y (0 = from +Z, the front)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return d.orbit_camera((low + high) / 2, 0.52 * np.linalg.norm(high - low), azimuth, 0.0, size, size)


def outline(vertices, faces, camera) -> np.ndarray:
    """(H, W) bool: the two pixels on either side of the silhouette."""
    return mask_outline(d.rasterize(vertices, faces, camera)[0] >= 0)


def mask_outline(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool: the pixels of a mask (H, W) bool and of what is around it that meet."""
    inside = np.pad(mask, 1)
    around_it = (inside[:-2, 1:-1], inside[2:, 1:-1], inside[1:-1, :-2], inside[1:-1, 2:])
    return np.any([other != inside[1:-1, 1:-1] for other in around_it], axis=0)


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    """Intersection over union of two masks (H, W) bool; 0 if both are empty."""
    return float((one & other).sum() / max((one | other).sum(), 1))


def mean_overlap(vertices, faces, cameras, masks: dict[int, np.ndarray]) -> float:
    """Of a surface with the masks (H, W) bool of the cameras that have one: index in `cameras` -> mask, at least one."""
    return float(np.mean([overlap(d.rasterize(vertices, faces, cameras[c])[0] >= 0, mask) for c, mask in masks.items()]))


def edges(vertices, faces, camera) -> np.ndarray:
    """(H, W) bool: where the visible triangles meet."""
    face = d.rasterize(vertices, faces, camera)[0]
    seen = np.zeros(face.shape, bool)
    seen[:, 1:] |= face[:, 1:] != face[:, :-1]
    seen[1:] |= face[1:] != face[:-1]
    return seen


def draw_outline(picture: np.ndarray, edge: np.ndarray, colour=(255, 0, 120)) -> np.ndarray:
    drawn = picture.copy()
    drawn[edge] = colour
    return drawn


def crop_box(vertices, camera, margin: int = 20) -> tuple[slice, slice]:
    """Rows and columns of the image around the projected vertices."""
    pixels = np.array([camera.project(v) for v in vertices])
    low = np.clip(pixels.min(axis=0).astype(int) - margin, 0, [camera.width - 1, camera.height - 1])
    high = np.clip(pixels.max(axis=0).astype(int) + margin, low, [camera.width - 1, camera.height - 1])
    return slice(low[1], high[1] + 1), slice(low[0], high[0] + 1)


def data_uri(picture: np.ndarray, quality: int = 80) -> str:
    """A JPEG to put into a page."""
    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture)).save(buffer, "JPEG", quality=quality)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode()
