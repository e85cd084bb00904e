"""Found cameras against true ones. Where a calibration without a board has its world, and how large it is, is its own: the two
worlds are laid over each other by points that both see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import _doublet as d


@dataclass
class CameraErrors:
    """What is wrong with found cameras."""

    placed: list[d.Camera]  # the found ones, in the true world
    scale: float  # found over true
    tilt: float  # rad, between the two +Y
    pixels: np.ndarray  # (C) RMS of where the points appear
    metres: np.ndarray  # (C) the same at the points


def compare(found: Sequence[d.Camera], true: Sequence[d.Camera], points: np.ndarray) -> CameraErrors:
    """Cameras in the same order; points (N, 3) m of the true world, such as joints over a take. Raises ValueError if the found
    cameras do not see points where the true ones do."""
    seen = [[[*camera.project(point), 1.0] for camera in true] for point in points]
    rig = [d.CalibratedCamera(camera) for camera in found]
    there = [d.triangulate(rig, np.array(one)) for one in seen]
    agreed = np.array([point is not None for point in there])
    if agreed.sum() < 3:
        raise ValueError(f"expected found cameras that agree on at least three points, found {agreed.sum()}")
    scale, turn, shift = similarity(points[agreed], np.array([point for point in there if point is not None]))
    placed = [moved(camera, scale, turn, shift) for camera in found]
    pixels = np.array([image_error(one, other, points) for one, other in zip(placed, true)])
    distances = np.array([np.linalg.norm(camera.centre - points, axis=1).mean() / camera.K[0, 0] for camera in true])
    return CameraErrors(placed, scale, float(np.arccos(np.clip(turn[1, 1], -1, 1))), pixels, pixels * distances)


def similarity(source: np.ndarray, target: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Factor, rotation and shift that take points (N, 3) to others in least squares (Umeyama 1991)."""
    a, b = source - source.mean(0), target - target.mean(0)
    u, s, v = np.linalg.svd(b.T @ a)
    sign = np.array([1, 1, np.linalg.det(u @ v)])
    turn, factor = u * sign @ v, (s * sign).sum() / (a**2).sum()
    return factor, turn, target.mean(0) - factor * turn @ source.mean(0)


def moved(camera: d.Camera, scale: float, turn: np.ndarray, shift: np.ndarray) -> d.Camera:
    """Of the world x, where it was one of the world scale turn x + shift."""
    result = d.Camera()
    result.name, result.width, result.height = camera.name, camera.width, camera.height
    result.K, result.distortion, result.R = camera.K, camera.distortion, camera.R @ turn
    result.t = -result.R @ (turn.T @ (camera.centre - shift) / scale)
    return result


def image_error(one: d.Camera, other: d.Camera, points: np.ndarray) -> float:
    """px, RMS."""
    return float(np.sqrt(np.mean([np.sum((one.project(x) - other.project(x)) ** 2) for x in points])))
