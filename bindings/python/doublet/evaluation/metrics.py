"""Errors of a reconstruction against a ground truth: the table of docs/formats.md."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from ..common.drawing import overlap
from ..common.images import read_image
from ..common.scan_frame import scan_frame
from ..export.animate import animate_exactly
from .reconstruction import Animated, Reconstruction
from .truth import Missing, Truth

#: Name -> (unit, meaning); the order of the table.
METRICS = {
    "template_invented_found": ("", "share of the template's area over 10 mm from any true surface that is marked invalid"),
    "template_true_marked": ("", "share of the visible true surface that lies nearest to a triangle marked invalid"),
    "joint_mm": ("mm", "mean distance of the marked joints, over joints and frames"),
    "jitter_ratio": ("", "mean |second difference| of the marked joints over time, captured over true"),
    "surface_body_mm": ("mm", "mean distance from the visible true body to the captured surface"),
    "surface_cloth_mm": ("mm", "mean distance from the visible true garment to the captured surface"),
    "silhouette_iou": ("", "captured surface's mask against the true mask, mean over cameras and frames"),
    "cloth_iou": ("", "clothness > 0.5 against the true garment, by area of the visible surface in the scan pose"),
    "hidden_body_mm": ("mm", "mean distance from the true body hidden by the garment to the fitted body, scan pose"),
    "resim_cloth_cm": ("cm", "RMS distance from the true garment to the re-animated character"),
    "resim_two_sided_cm": ("cm", "the same, and from the character's cloth to the true garment"),
    "hem_height_cm": ("cm", "lowest point of the garment around the pelvis, re-animated minus true, RMS over frames"),
    "flare_cm": ("cm", "95 % radius of the garment around the pelvis, re-animated minus true, RMS over frames"),
    "novel_cloth_cm": ("cm", "resim_cloth_cm on a motion that was not used"),
}
AZIMUTHS = 24  # bins around the pelvis


def seen_faces(vertices: np.ndarray, faces: np.ndarray, cameras) -> np.ndarray:
    """Which faces show at a pixel of at least one camera; bool (F)."""
    seen = np.zeros(len(faces), bool)
    for camera in cameras:
        face, _ = d.rasterize(vertices, faces, camera)
        seen[np.unique(face[face >= 0])] = True
    return seen


def centroids(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return vertices[faces].mean(axis=1)


def averaged(values: np.ndarray, areas: np.ndarray, what: str) -> float:
    """Mean over faces, weighted by area."""
    if not areas.sum() > 0:
        raise Missing(f"the truth has no {what}")
    return float(np.average(values, weights=areas))


def require_scan_pose(truth: Truth, scan: int) -> None:
    if scan not in truth.chunks:
        raise Missing(f"the truth does not hold frame {scan}, the scan pose")


def template_mask(made: Reconstruction, truth: Truth, cameras, scan: int = 0) -> dict[str, float]:
    """In the scan pose, which is that of frame `scan`; samples are centroids of faces, weighted by area."""
    require_scan_pose(truth, scan)
    vertices, faces, _ = truth.surface(scan)
    mesh, valid = made.actor.mesh, np.asarray(made.actor.face_valid, bool)
    area = d.face_areas(mesh.vertices, mesh.faces)
    far = d.distances_to_surface(centroids(mesh.vertices, mesh.faces), d.Mesh(vertices, faces)) > 0.01
    seen = seen_faces(vertices, faces, cameras)
    nearest, _, _ = d.RayScene(mesh).closest(centroids(vertices, faces[seen]))
    found = float(area[far & ~valid].sum() / area[far].sum()) if far.any() else 1.0
    marked = averaged(~valid[nearest], d.face_areas(vertices, faces[seen]), "true surface that a camera sees")
    return {"template_invented_found": found, "template_true_marked": marked}


def shared_joints(made: Reconstruction, truth: Truth) -> tuple[list[int], list[int], dict[int, np.ndarray]]:
    """Indices of the joints that both have, ours and the truth's, and frame -> (J, 3)."""
    names, true_joints = truth.joints()
    ours = made.actor.skeleton.joint_names
    shared = [n for n in ours if n in names]
    if not shared:
        raise Missing("no joint of the character has a true one of its name")
    return [ours.index(n) for n in shared], [names.index(n) for n in shared], true_joints


def joint_mm(made: Reconstruction, truth: Truth, every: int) -> float:
    mine, theirs, true_joints = shared_joints(made, truth)
    joints = made.performance.joints
    errors = [joints[row][mine] - true_joints[frame][theirs] for row, frame in made.rows(true_joints, every)]
    return 1000 * float(np.linalg.norm(errors, axis=-1).mean())


def jitter_ratio(made: Reconstruction, truth: Truth) -> float:
    """Joint positions, so that skeletons of other degrees of freedom compare; all frames that follow each other."""
    mine, theirs, true_joints = shared_joints(made, truth)
    joints = made.performance.joints
    rows = made.rows(true_joints, 1)
    triples = [t for t in zip(rows, rows[1:], rows[2:]) if t[2][1] - t[0][1] == 2]
    if not triples:
        raise Missing("no three consecutive captured frames have ground truth")

    def jitter(at) -> float:
        return float(np.mean([np.linalg.norm(at(a) - 2 * at(b) + at(c), axis=-1).mean() for a, b, c in triples]))

    true_jitter = jitter(lambda pair: true_joints[pair[1]][theirs])
    if true_jitter == 0:
        raise Missing("the true joints do not move")
    return jitter(lambda pair: np.asarray(joints[pair[0]])[mine]) / true_jitter


def surface_mm(made: Reconstruction, truth: Truth, cameras, every: int, context: d.Context) -> dict[str, float | Missing]:
    """Samples are the centroids of the true faces that a camera sees, weighted by area."""
    rows = made.rows(truth.chunks, every)
    frames = made.performance.surface.frames
    total, weight = np.zeros(2), np.zeros(2)
    for done, (row, frame) in enumerate(rows):
        context.report_progress("evaluate surface", done / len(rows))
        vertices, faces, garment = truth.surface(frame)
        seen = seen_faces(vertices, faces, cameras)
        distance = d.distances_to_surface(centroids(vertices, faces[seen]), d.Mesh(frames[row], made.faces))
        area = d.face_areas(vertices, faces[seen])
        for label in (0, 1):
            chosen = garment[seen] == bool(label)
            total[label] += (distance * area)[chosen].sum()
            weight[label] += area[chosen].sum()
    found: dict[str, float | Missing] = {}
    for name, what, sum_, area in zip(("surface_body_mm", "surface_cloth_mm"), ("body", "garment"), total, weight):
        found[name] = 1000 * sum_ / area if area > 0 else Missing(f"no camera sees a true {what}")
    return found


def silhouette_iou(made: Reconstruction, truth: Truth, cameras, every: int, context: d.Context) -> float:
    masks = truth.masks()
    rows = {frame: row for row, frame in made.rows({frame for _, frame, _ in masks}, every)}
    by_name = {camera.name: camera for camera in cameras}
    chosen = [m for m in masks if m[0] in by_name and m[1] in rows]
    frames, values = made.performance.surface.frames, []
    for done, (name, frame, path) in enumerate(chosen):
        context.report_progress("evaluate silhouettes", done / len(chosen))
        mask = np.asarray(read_image(path).convert("L")) > 0
        camera = by_name[name].resized(mask.shape[1], mask.shape[0])
        face, _ = d.rasterize(frames[rows[frame]], made.faces, camera)
        values.append(overlap(face >= 0, mask))
    if not values:
        raise Missing("no true mask belongs to a captured frame and camera")
    return float(np.mean(values))


def cloth_iou(made: Reconstruction, truth: Truth, cameras, scan: int = 0) -> float:
    """Over the template faces seen in the scan pose, which is that of frame `scan`; the true label is that of the closest true
    face that a camera sees."""
    require_scan_pose(truth, scan)
    clothness = made.clothness
    vertices, faces, garment = truth.surface(scan)
    seen = seen_faces(vertices, faces, cameras)
    if not seen.any():
        raise Missing("the truth has no surface that a camera sees")
    ours = made.actor.mesh.vertices
    our_faces = made.faces[seen_faces(ours, made.faces, cameras)]
    nearest, _, _ = d.RayScene(d.Mesh(vertices, faces[seen])).closest(centroids(ours, our_faces))
    true_cloth = garment[seen][nearest]
    cloth = clothness[our_faces].mean(axis=1) > 0.5
    area = d.face_areas(ours, our_faces)
    union = area[cloth | true_cloth].sum()
    return float(area[cloth & true_cloth].sum() / union) if union > 0 else 1.0


def hidden_body_mm(made: Reconstruction, truth: Truth, cameras, scan: int = 0) -> float:
    """Under the garment: no camera sees the body face, and the ray along its normal meets the garment first from inside. In the
    scan pose, which is that of frame `scan`."""
    require_scan_pose(truth, scan)
    fit = d.read_body(made.path("body.npz"))
    body, cloth = truth.frame(scan)[0], truth.garment(scan)
    vertices, faces, garment = truth.surface(scan)
    unseen = ~seen_faces(vertices, faces, cameras)[~garment]
    points, normals = centroids(body, truth.body_faces), d.face_normals(body, truth.body_faces)
    hit, _ = d.RayScene(d.Mesh(cloth, truth.cloth_faces)).cast(points, normals, 1e-6)
    from_inside = (normals * d.face_normals(cloth, truth.cloth_faces)[hit]).sum(axis=1) > 0
    hidden = unseen & (hit >= 0) & from_inside
    if not hidden.any():
        raise Missing("no true body face is hidden by the garment")
    distance = d.distances_to_surface(points[hidden], fit.body)
    return 1000 * averaged(distance, d.face_areas(body, truth.body_faces[hidden]), "true body that is hidden")


def shared_frames(moving: Animated, true_frames, every: int) -> list[int]:
    frames = sorted(set(moving.surfaces) & set(true_frames))[::every]
    if not frames:
        raise Missing("no simulated frame has a true one")
    return frames


def cloth_rms_cm(moving: Animated, truth: Truth, every: int, context: d.Context, name: str, two_sided: bool = False) -> float:
    """All true garment vertices, weighted alike, to the surface; `two_sided`: and the cloth to the true garment."""
    frames, squares = shared_frames(moving, truth.chunks, every), []
    for done, frame in enumerate(frames):
        context.report_progress(f"evaluate {name}", done / len(frames))
        surface, garment = moving.surfaces[frame], truth.garment(frame)
        distances = [d.distances_to_surface(garment, d.Mesh(surface, moving.faces))]
        if two_sided:
            distances.append(d.distances_to_surface(surface[moving.cloth], d.Mesh(garment, truth.cloth_faces)))
        squares.append([np.square(distance).mean() for distance in distances])
    return 100 * math.sqrt(np.mean(squares))


def horizontal(points: np.ndarray, pelvis: np.ndarray) -> np.ndarray:
    """(...) z + i x of points (..., 3) seen from the pelvis (..., 3), m: its angle is the azimuth, from +Z to +X."""
    offset = points - pelvis
    return offset[..., 2] + 1j * offset[..., 0]


def azimuth_bins(points: np.ndarray, pelvis: np.ndarray, count: int) -> np.ndarray:
    """(N) in 0 ... count - 1 of points (N, 3) around the pelvis (3)."""
    return np.floor(np.angle(horizontal(points, pelvis)) * count / (2 * np.pi)).astype(int) % count


def lowest(points: np.ndarray, pelvis: np.ndarray) -> float:
    return points[:, 1].min()


def wide_radius(points: np.ndarray, pelvis: np.ndarray) -> float:
    return np.percentile(np.abs(horizontal(points, pelvis)), 95)


def by_azimuth(points: np.ndarray, pelvis: np.ndarray, measure) -> np.ndarray:
    """(AZIMUTHS) measure(points of the bin, pelvis); NaN where there are none."""
    bins, values = azimuth_bins(points, pelvis, AZIMUTHS), np.full(AZIMUTHS, np.nan)
    for k in np.unique(bins):
        values[k] = measure(points[bins == k], pelvis)
    return values


def outline_rms_cm(moving: Animated, truth: Truth, every: int, measure) -> float:
    """RMS over frames of ours minus true; a frame's value is the mean over the azimuths that have points of both."""
    pelvis, errors = truth.pelvis(), []
    for frame in shared_frames(moving, truth.chunks.keys() & pelvis.keys(), every):
        garments = moving.surfaces[frame][moving.cloth], truth.garment(frame)
        ours, true = (by_azimuth(points, pelvis[frame], measure) for points in garments)
        shared = np.isfinite(ours - true)
        if not shared.any():
            raise Missing(f"around the pelvis, true and simulated garment share no azimuth in frame {frame}")
        errors.append((ours - true)[shared].mean())
    return 100 * math.sqrt(np.square(errors).mean())


def new_motion(made: Reconstruction, truth: Truth, fps: float, context: d.Context) -> tuple[Animated, Truth]:
    """The character on the motion that was not filmed, and that motion's truth."""
    folder = truth.folder / "novel"
    if not (folder / "motion.bvh").exists():
        raise Missing(f"{folder / 'motion.bvh'} does not exist")
    character = d.Character.read(made.path("character.glb"))
    surfaces = animate_exactly(character, folder / "motion.bvh", fps, context)
    faces = character.actor.mesh.faces[np.asarray(character.actor.face_valid, bool)]
    return Animated(dict(enumerate(surfaces)), faces, character.segmentation.clothness), Truth(folder)


def attempt(names, computed: dict) -> tuple[dict[str, float | None], dict[str, str]]:
    """Values, and reasons of the missing ones. A key of `computed` stands for the names that begin with it; its function gives a
    number or, by name, several, each of which may be a Missing. A number that cannot be computed is missing, not 0."""
    values, missing = dict.fromkeys(names), {}
    for start, compute in computed.items():
        try:
            value = compute()
            found = value if isinstance(value, dict) else {start: value}
            missing.update({name: str(one) for name, one in found.items() if isinstance(one, Missing)})
            values.update({name: one for name, one in found.items() if not isinstance(one, Missing)})
        except Missing as reason:
            missing.update(dict.fromkeys((n for n in names if n.startswith(start)), str(reason)))
    return {k: None if v is None else float(f"{v:.5g}") for k, v in values.items()}, missing


def evaluate(out: Path, truth_folder: Path, session: d.Session, console: Console, every: int = 1) -> dict:
    """{"metrics": {name: value or None}, "missing": {name: reason}, ...} of the reconstruction `out` of `session`."""
    if every < 1:
        raise ValueError(f"--every must be 1 or more, found {every}")
    made, truth, context = Reconstruction(out), Truth(truth_folder), console.context()
    cameras, scan = session.rig, scan_frame(session)

    def resim_cm(two_sided: bool) -> float:
        return cloth_rms_cm(made.reanimated, truth, every, context, "re-animation", two_sided)

    def novel_cm() -> float:
        moving, novel = new_motion(made, truth, session.fps, context)
        return cloth_rms_cm(moving, novel, every, context, "new motion")

    computed = {
        "template": lambda: template_mask(made, truth, cameras, scan),
        "joint_mm": lambda: joint_mm(made, truth, every),
        "jitter_ratio": lambda: jitter_ratio(made, truth),
        "surface": lambda: surface_mm(made, truth, cameras, every, context),
        "silhouette_iou": lambda: silhouette_iou(made, truth, cameras, every, context),
        "cloth_iou": lambda: cloth_iou(made, truth, cameras, scan),
        "hidden_body_mm": lambda: hidden_body_mm(made, truth, cameras, scan),
        "resim_cloth_cm": lambda: resim_cm(two_sided=False),
        "resim_two_sided_cm": lambda: resim_cm(two_sided=True),
        "hem_height_cm": lambda: outline_rms_cm(made.reanimated, truth, every, lowest),
        "flare_cm": lambda: outline_rms_cm(made.reanimated, truth, every, wide_radius),
        "novel_cloth_cm": novel_cm,
    }
    metrics, missing = attempt(METRICS, computed)
    console.finish()
    return {"metrics": metrics, "missing": missing, "units": {k: unit for k, (unit, _) in METRICS.items()}, "every": every}


def format_table(result: dict) -> str:
    lines = []
    for name, value in result["metrics"].items():
        shown = f"{value:9.3f}" if value is not None else "  missing"
        lines.append(f"{name:<25}{shown} {METRICS[name][0]:<3} {result['missing'].get(name) or METRICS[name][1]}")
    return "\n".join(lines)
