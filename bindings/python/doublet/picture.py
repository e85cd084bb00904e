"""Pictures of meshes by the library's own z-buffer, for the report: no window, no graphics card."""

from __future__ import annotations

import base64
import io

import numpy as np
from PIL import Image

from . import _doublet as d

SKIN, CLOTH, GREY, PROXY = (np.array(c, float) for c in ((224, 196, 172), (196, 78, 82), (176, 180, 186), (76, 114, 176)))
BACKGROUND = 250


def shade(vertices, faces, camera, colours, backdrop=None) -> np.ndarray:
    """(H, W, 3) uint8 RGB. colours: one (3) or per face (F, 3), 0-255. Lit from the camera, with a little light from above."""
    face, _ = d.rasterize(vertices, faces, camera)
    picture = np.full((*face.shape, 3), BACKGROUND, float) if backdrop is None else backdrop.astype(float)
    normals = d.face_normals(vertices, faces)
    view = camera.R.T @ [0.0, 0.0, -1.0]
    light = np.clip(0.35 + 0.55 * np.abs(normals @ view) + 0.10 * normals[:, 1], 0, 1)
    lit = np.broadcast_to(colours, (len(faces), 3)) * light[:, None]
    hit = face >= 0
    picture[hit] = lit[face[hit]]
    return picture.astype(np.uint8)


def outline(vertices, faces, camera) -> np.ndarray:
    """(H, W) bool: pixels of the silhouette beside the background."""
    inside = np.pad(d.rasterize(vertices, faces, camera)[0] >= 0, 1)
    core = inside[:-2, 1:-1] & inside[2:, 1:-1] & inside[1:-1, :-2] & inside[1:-1, 2:]
    return inside[1:-1, 1:-1] & ~core


def draw_outline(picture: np.ndarray, edge: np.ndarray, colour=(255, 0, 120)) -> np.ndarray:
    drawn = picture.copy()
    drawn[edge] = colour
    return drawn


def around(vertices, azimuth: float, size: int = 480) -> d.Camera:
    """A camera that sees all vertices from `azimuth` rad around +Y (0 = from +Z, the front)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    distance = 4 * radius
    back = np.array([np.sin(azimuth), 0, np.cos(azimuth)])  # from the centre to the camera
    camera = d.Camera()
    camera.R = np.array([np.cross([0, 1.0, 0], back), [0, -1.0, 0], -back])
    camera.t = -camera.R @ (centre + distance * back)
    focal = 0.48 * size * distance / radius
    camera.K = np.array([[focal, 0, size / 2], [0, focal, size / 2], [0, 0, 1]])
    camera.width = camera.height = size
    return camera


def crop_box(vertices, camera, margin: int = 20) -> tuple[slice, slice]:
    """Rows and columns of the image around the projected vertices."""
    pixels = np.array([camera.project(v) for v in vertices])
    low = np.maximum(pixels.min(axis=0).astype(int) - margin, 0)
    high = np.minimum(pixels.max(axis=0).astype(int) + margin, [camera.width - 1, camera.height - 1])
    return slice(low[1], high[1] + 1), slice(low[0], high[0] + 1)


def capsule_mesh(p0, p1, r0: float, r1: float, steps: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of a tapered capsule: the two spheres' caps and the cone that touches both."""
    axis = p1 - p0
    length = np.linalg.norm(axis)
    axis = axis / length if length > 0 else np.array([0.0, 1.0, 0.0])
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    # The cone touches both spheres at this latitude; if one sphere contains the other, the caps meet at its pole.
    touch = np.arcsin(np.clip((r0 - r1) / max(length, 1e-9), -1, 1))
    rings = [(p0, r0, a) for a in np.linspace(-np.pi / 2, touch, 8)] + [(p1, r1, a) for a in np.linspace(touch, np.pi / 2, 8)]
    turn = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    circle = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    vertices = np.vstack([p + r * (np.sin(a) * axis + np.cos(a) * circle) for p, r, a in rings])
    here = np.arange(len(rings) - 1)[:, None] * steps + np.arange(steps)
    ahead = np.arange(len(rings) - 1)[:, None] * steps + (np.arange(steps) + 1) % steps
    faces = np.stack([np.stack([here, ahead, ahead + steps], -1), np.stack([here, ahead + steps, here + steps], -1)])
    return vertices, faces.reshape(-1, 3).astype(np.int32)


def data_uri(picture: np.ndarray, quality: int = 80) -> str:
    """A JPEG to put into a page."""
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "JPEG", quality=quality)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode()
