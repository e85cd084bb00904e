"""Where the camera of a video stands: so that the person fills the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _doublet as d

CAMERAS = ("auto", "front", "follow", "orbit")
FILLED, FILLED_ACROSS = 0.85, 0.92  # of the picture's height and width, at most
AZIMUTH, ELEVATION = 0.35, 0.1  # rad
STILL = 0.4  # m from the middle, within which a motion is filmed by a camera that stands still
LOOKED_AT, VIEWS = 24, 8  # poses spread over the motion; sides
SMALLEST, LARGEST = 16, 8192  # px


@dataclass
class Shot:
    """How a video is filmed."""

    width: int = 720
    height: int = 720
    camera: str = "auto"  # front: stands still; follow: goes along; orbit: goes along, and round; auto: front if it all fits
    turn_seconds: float = 8.0  # of orbit, once round
    background: tuple[float, float, float] = (0.93, 0.94, 0.96)  # R G B in [0, 1]

    def validate(self) -> None:
        if not all(SMALLEST <= size <= LARGEST for size in (self.width, self.height)):
            expected = f"expected WIDTHxHEIGHT, {SMALLEST} to {LARGEST} px each"
            raise ValueError(f"size: {expected}, found {self.width}x{self.height}")
        if self.camera not in CAMERAS:
            raise ValueError(f"camera: expected one of {', '.join(CAMERAS)}, found '{self.camera}'")
        if not (np.isfinite(self.turn_seconds) and self.turn_seconds > 0):
            raise ValueError(f"turn_seconds: expected s above 0, found {self.turn_seconds:g}")


def cameras_along(character: d.Character, motion: d.Motion, count: int, shot: Shot) -> list[d.Camera]:
    """One camera for each of `count` frames at the character's rate, a little above; behind the motion's end, as there."""
    joints = np.array([character.actor.skeleton.joint_positions(dofs) for dofs in motion.dofs])
    path = smooth_path(joints[:, 0], motion.fps)
    if shot.camera == "front" or (shot.camera == "auto" and reach(path) < STILL):
        bodies = [skinned(character, motion.dofs[t]) for t in looked_at(joints)]
        target, radius = framed(np.concatenate(bodies), shot)
        return [camera_at(target, radius, AZIMUTH, shot)] * count
    around = np.concatenate([skinned(character, motion.dofs[t]) - path[t] for t in looked_at(joints - path[:, None])])
    if shot.camera == "orbit":
        offset, radius = framed_from_all_sides(around, shot)
        azimuths = AZIMUTH + 2 * np.pi * np.arange(count) * character.solver.dt / shot.turn_seconds
    else:
        offset, radius = framed(around, shot)
        azimuths = np.full(count, AZIMUTH)
    frames = np.arange(count) * motion.fps * character.solver.dt  # of the motion, which may have another rate
    places = np.stack([np.interp(frames, np.arange(len(path)), along) for along in path.T], axis=1)
    return [camera_at(place + offset, radius, azimuth, shot) for place, azimuth in zip(places, azimuths)]


def looked_at(joints: np.ndarray) -> np.ndarray:
    """Which poses of (T, J, 3) m the picture is made for: some of all, and those in which a joint is farthest out, which may be
    in between."""
    turns = 2 * np.pi * np.arange(VIEWS) / VIEWS
    ways = np.vstack([np.stack([np.sin(turns), 0 * turns, np.cos(turns)], axis=1), [[0, 1, 0], [0, -1, 0]]])
    farthest = (joints @ ways.T).max(axis=1).argmax(axis=0)
    return np.unique(np.concatenate([np.linspace(0, len(joints) - 1, LOOKED_AT).round().astype(int), farthest]))


def reach(path: np.ndarray) -> float:
    """m from the middle of a path."""
    return float(np.linalg.norm((path - path.mean(axis=0))[:, [0, 2]], axis=1).max())


def camera_at(target: np.ndarray, radius: float, azimuth: float, shot: Shot) -> d.Camera:
    return d.orbit_camera(target, radius, azimuth, ELEVATION, shot.width, shot.height)


def skinned(character: d.Character, dofs: np.ndarray) -> np.ndarray:
    """(N, 3) m: where the surface is, but for the cloth's own motion."""
    shown = np.asarray(character.actor.face_valid, bool)
    return d.pose_surface(character.actor, dofs)[np.unique(character.actor.mesh.faces[shown])]


def smooth_path(path: np.ndarray, fps: float) -> np.ndarray:
    """(T, 3) m: the root's places (T, 3) along the floor, over a second; their height counts as 0."""
    window = max(1, round(fps))
    padded = np.pad(path, ((window // 2, window - 1 - window // 2), (0, 0)), mode="edge")
    smooth = np.stack([np.convolve(padded[:, k], np.ones(window) / window, mode="valid") for k in range(3)], axis=1)
    return smooth * [1, 0, 1]


def framed(points: np.ndarray, shot: Shot) -> tuple[np.ndarray, float]:
    """Target and radius of the camera that stands as near as it can with all points (N, 3) in the picture."""
    unit = camera_at(np.zeros(3), 1.0, AZIMUTH, shot)  # at how many m it stands for each m of radius
    seen = points @ unit.R.T
    slopes = filled(shot) / unit.K[0, 0]
    # The sides of what is seen are planes: each is moved to the points, and the camera is where the narrower pair meets.
    low, high = (seen[:, :2] + slopes * seen[:, 2:]).min(axis=0), (seen[:, :2] - slopes * seen[:, 2:]).max(axis=0)
    depth = ((low - high) / (2 * slopes)).min()
    distance = (seen[:, 2].min() + seen[:, 2].max()) / 2 - depth
    return unit.R.T @ [*((low + high) / 2), depth + distance], distance / np.linalg.norm(unit.centre)


def framed_from_all_sides(points: np.ndarray, shot: Shot) -> tuple[np.ndarray, float]:
    """Target, above or below the origin, and radius of an orbit camera to which the points (N, 3) fill the picture."""
    target, radius = np.array([0, (points[:, 1].min() + points[:, 1].max()) / 2, 0]), 1.0
    for _ in range(8):  # perspective: a step leaves a tenth of what is off
        cameras = [camera_at(target, radius, azimuth, shot) for azimuth in np.linspace(0, 2 * np.pi, VIEWS, endpoint=False)]
        places = np.concatenate([projected(points, camera) for camera in cameras])
        low, high = places.min(axis=0), places.max(axis=0)
        target[1] -= np.linalg.norm(cameras[0].centre - target) * (low + high)[1] / 2
        half = np.array([max(-low[0], high[0]), (high - low)[1] / 2])
        radius *= (half * cameras[0].K[0, 0] / filled(shot)).max()
    return target, radius


def filled(shot: Shot) -> np.ndarray:
    """px from the middle of the picture, across and down, to which people may reach."""
    return np.array([FILLED_ACROSS * shot.width, FILLED * shot.height]) / 2


def projected(points: np.ndarray, camera: d.Camera) -> np.ndarray:
    """(N, 2) over the focal length, from the middle of the picture."""
    seen = points @ camera.R.T + camera.t
    return seen[:, :2] / np.maximum(seen[:, 2:], 0.1)
