"""A scan as a scanner leaves it, in any unit, on any axis, with its floor, brought to where the cameras see the person."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from .. import _doublet as d

#: Metres of one unit of a scan.
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inches": 0.0254}
AXES = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}
SAME_HEIGHT = 0.15  #: share by which the heights of scan and hull may differ
FLOOR = 0.02  #: of the scan's height, in which a floor lies
ABOVE_FLOOR = 0.006  #: of the scan's height, below which nothing is kept where there is a floor: a centimetre of the shoes
SPECK = 0.01  #: of the area: smaller pieces go
FLAT = 0.97  #: cosine to the upward direction from which a face is floor
FLOOR_SHARE = 0.1  #: of the area that is flat at the bottom, from which it is a floor and no soles
HEADINGS = 36
SAMPLES = 600
KEPT = 0.8  #: share of the samples that counts: the nearest
BEST = 6  #: placements that are refined
LARGEST = 0.03  #: m, mean distance to the hull from which on the scan is of something else
BEYOND = 0.10  #: m outside the hull from which on it is not the person


@dataclass(frozen=True)
class Aligned:
    """The scan in the session's world, and what was found out about it."""

    mesh: d.Mesh
    unit: str
    up: str
    floor: bool
    distance: float  # m, mean, of the nearest KEPT of its samples to the hull


def align_scan(scan: d.Mesh, hull: d.Mesh) -> Aligned:
    """scan: of one person, in one of UNITS, upright along one of AXES, perhaps on a floor, in the pose of the hull. hull: m, +Y
    up, what the cameras see (scan_from_views). Units and axis follow from the hull's height, the place from the nearest of 36
    headings, refined (iterative closest points). Raises ValueError if no placement is near."""
    target, best = d.RayScene(hull), []
    for (axis, up), (unit, metres) in product(AXES.items(), UNITS.items()):
        turned = d.Mesh(metres * np.asarray(scan.vertices) @ upright(np.array(up, float)).T, scan.faces)
        person, floor = without_floor(turned)
        if person is None or not same_height(person, hull):
            continue
        points = samples(person)
        for angle in np.arange(HEADINGS) * 2 * np.pi / HEADINGS:
            rotation = about_y(angle)
            move = foot_of(np.asarray(hull.vertices)) - foot_of(np.asarray(person.vertices) @ rotation.T)
            best.append((near(target, points @ rotation.T + move), rotation, move, points, person, unit, axis, floor))
    if not best:
        sides = ", ".join(f"{side:.3g}" for side in np.ptp(np.asarray(scan.vertices), axis=0))
        raise ValueError(
            f"scan: expected a person as high as the cameras see, {height(hull):.2f} m, in m, cm, mm or inches along an axis, "
            f"found {sides} units"
        )
    best.sort(key=lambda placement: placement[0])
    refined = [(*refine(target, *placement[1:4]), *placement[4:]) for placement in best[:BEST]]
    distance, rotation, move, person, unit, axis, floor = min(refined, key=lambda placement: placement[0])
    if distance > LARGEST:
        raise ValueError(
            f"scan: expected the person and the pose that the cameras see, found it {1000 * distance:.0f} mm from there at best"
        )
    placed = d.Mesh(np.asarray(person.vertices) @ rotation.T + move, person.faces)
    return Aligned(without_surroundings(placed, target), unit, axis, floor, distance)


# --- the mesh


def height(mesh: d.Mesh) -> float:
    return float(np.ptp(np.asarray(mesh.vertices)[:, 1]))


def same_height(person: d.Mesh, hull: d.Mesh) -> bool:
    return abs(height(person) / height(hull) - 1) < SAME_HEIGHT


def foot_of(vertices: np.ndarray) -> np.ndarray:
    """Middle of the bounding box, at its bottom."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])


def without_floor(mesh: d.Mesh) -> tuple[d.Mesh | None, bool]:
    """What stands on the floor, +Y up; whether there was a floor."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    areas, normals = d.face_areas(vertices, faces), d.face_normals(vertices, faces)
    middles, tall = vertices[faces][:, :, 1].mean(axis=1), np.ptp(vertices[:, 1])
    flat = (middles < middles.min() + FLOOR * tall) & (np.abs(normals[:, 1]) > FLAT)
    if areas[flat].sum() < FLOOR_SHARE * areas.sum():
        return without_specks(vertices, faces), False
    return without_specks(vertices, faces[middles > np.median(middles[flat]) + ABOVE_FLOOR * tall]), True


def without_specks(vertices: np.ndarray, faces: np.ndarray) -> d.Mesh | None:
    """The pieces of some size: a scan with holes has several."""
    if not len(faces):
        return None
    label = np.arange(len(vertices))
    while True:  # every vertex takes the lowest label around it; then that label's own, so that long ways are short
        lowest = label[faces].min(axis=1)
        new = label.copy()
        np.minimum.at(new, faces.ravel(), np.repeat(lowest, 3))
        new = new[new]
        if (new == label).all():
            break
        label = new
    pieces = np.bincount(label[faces[:, 0]], d.face_areas(vertices, faces))
    return compact(vertices, faces[pieces[label[faces[:, 0]]] > SPECK * pieces.sum()])


def compact(vertices: np.ndarray, faces: np.ndarray) -> d.Mesh:
    used, renumbered = np.unique(faces, return_inverse=True)
    return d.Mesh(vertices[used], renumbered.reshape(-1, 3).astype(np.int32))


def without_surroundings(mesh: d.Mesh, hull: d.RayScene) -> d.Mesh:
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    near_hull = hull.closest(vertices)[1] < BEYOND
    return compact(vertices, faces[near_hull[faces].all(axis=1)])


def samples(mesh: d.Mesh) -> np.ndarray:
    """(SAMPLES, 3) centres of faces, as many on equal areas."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    reached = np.cumsum(d.face_areas(vertices, faces))
    chosen = np.searchsorted(reached, (np.arange(SAMPLES) + 0.5) / SAMPLES * reached[-1])
    return vertices[faces[np.minimum(chosen, len(faces) - 1)]].mean(axis=1)


# --- the place


def upright(up: np.ndarray) -> np.ndarray:
    """A rotation that turns `up` to +Y."""
    aside = np.roll(up, 1)
    return np.stack([aside, up, np.cross(aside, up)])


def about_y(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def near(target: d.RayScene, points: np.ndarray) -> float:
    """m, mean distance of the nearest KEPT."""
    return float(np.sort(target.closest(points)[1])[: int(KEPT * len(points))].mean())


def refine(target: d.RayScene, rotation: np.ndarray, move: np.ndarray, points: np.ndarray, rounds: int = 40):
    """(distance, rotation, translation) after iterative closest points over the nearest KEPT."""
    for _ in range(rounds):
        placed = points @ rotation.T + move
        _, distances, closest = target.closest(placed)
        kept = np.argsort(distances)[: int(KEPT * len(points))]
        a, b = placed[kept], closest[kept]
        u, _, v = np.linalg.svd((a - a.mean(axis=0)).T @ (b - b.mean(axis=0)))
        turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
        rotation, move = turn @ rotation, turn @ (move - a.mean(axis=0)) + b.mean(axis=0)
    return near(target, points @ rotation.T + move), rotation, move
