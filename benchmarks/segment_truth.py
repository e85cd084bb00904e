"""What limits cloth_iou, capture or segmentation? Segments true surfaces of a session instead of the captured ones.

python benchmarks/segment_truth.py OUT SESSION [--even-odds 3 --colour 4.5]

The template follows the true surface (the nearest point that a camera sees in the scan pose): all of it, only its skin, or only
its cloth; the skeleton is the captured one. The last line is eq. 1 of the paper, two thresholds on the captured surface's
deviation. One line each: cloth_iou as `doublet evaluate` has it, false and missed cloth in m^2,
and where (by the joint that moves it, from 0.01 m^2).
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation.metrics import Reconstruction, Truth, cloth_iou, seen_faces


def barycentric(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(N, 3) of points (N, 3) in triangles (N, 3, 3)."""
    a, b, to = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    aa, ab, bb = (a * a).sum(1), (a * b).sum(1), (b * b).sum(1)
    ta, tb = (to * a).sum(1), (to * b).sum(1)
    size = np.maximum(aa * bb - ab * ab, 1e-18)
    v, w = (bb * ta - ab * tb) / size, (aa * tb - ab * ta) / size
    return np.stack([1 - v - w, v, w], axis=1)


def carried(made: Reconstruction, truth: Truth, cameras) -> tuple[np.ndarray, np.ndarray]:
    """(T, V, 3) m: the template where the true surface takes it, and which of its vertices are truly cloth (V)."""
    vertices, faces, garment = truth.surface(0)
    seen = np.flatnonzero(seen_faces(vertices, faces, cameras))
    near, _, points = d.RayScene(d.Mesh(vertices, faces[seen])).closest(made.actor.mesh.vertices)
    corners = faces[seen[near]]
    weights = barycentric(vertices[corners], points)
    frames = [np.vstack(truth.frame(f))[corners] for f in made.performance.frames]
    return np.einsum("vk,tvkc->tvc", weights, np.array(frames)), garment[seen[near]]


def by_thresholds(mesh: d.Mesh, sigma: np.ndarray, rigid=0.0025, cloth=0.006, length=0.03) -> np.ndarray:
    """(V) eq. 1 of the paper out of the deviations (V, m; NaN = not known): its two thresholds, and an implicit step of the
    diffusion over the surface. All lengths in m."""
    corners = mesh.vertices[mesh.faces]
    system = np.diag(np.where(np.isnan(sigma), 0.0, d.vertex_areas(mesh.vertices, mesh.faces)) + 1e-12)
    right = system @ np.clip((np.nan_to_num(sigma) - rigid) / (cloth - rigid), 0, 1)
    for k in range(3):  # cotangents of the angles opposite to the edges
        a, b = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        weight = length**2 * np.maximum((a * b).sum(1) / np.maximum(np.linalg.norm(np.cross(a, b), axis=1), 1e-12), 1e-3) / 2
        i, j = mesh.faces[:, (k + 1) % 3], mesh.faces[:, (k + 2) % 3]
        for at, to, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            np.add.at(system, (at, to), sign * weight)
    return np.linalg.solve(system, right)


def where(joints: list[str], owner: np.ndarray, area: np.ndarray) -> str:
    sums = {joints[j]: area[owner == j].sum() for j in np.unique(owner)}
    return ", ".join(f"{name} {total:.3f}" for name, total in sums.items() if total >= 0.01) or "-"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("session", type=Path)
    defaults = d.SegmentOptions()
    parser.add_argument("--even-odds", type=float, default=defaults.even_odds)
    parser.add_argument("--colour", type=float, default=defaults.colour)
    options = parser.parse_args()
    made, truth, session = Reconstruction(options.out), Truth(options.session / "ground_truth"), d.Session(options.session)
    cameras = session.rig
    segmenter = d.ClothSegmenter.create(d.SegmentOptions(even_odds=options.even_odds, colour=options.colour))
    performance = made.performance
    silhouettes = d.session_silhouettes(session, d.FrameSource.open(session))
    views = d.read_views(session, performance.frames[0], silhouettes)
    first = d.Mesh(performance.surface.frames[0], made.actor.mesh.faces)
    colours = d.sample_colours(first, made.actor.face_valid, session.rig, views.images, views.masks)
    captured = np.array(performance.surface.frames)
    dressed = d.dressed_all_over(made.actor)
    model = d.BodyModel.read(d.body_model_path())
    body = d.BodyFitter.create().fit(made.actor, dressed, model, session.landmarks).body
    true, cloth = carried(made, truth, cameras)
    area = np.asarray(d.vertex_areas(made.actor.mesh.vertices, made.faces))
    owner, joints = np.asarray(made.actor.weights).argmax(axis=1), made.actor.skeleton.joint_names
    for name, taken in {"captured": [], "all true": ..., "true skin": ~cloth, "true cloth": cloth, "eq. 1": []}.items():
        frames = captured.copy()
        frames[:, taken] = true[:, taken]
        performance.surface.frames = list(frames)
        found = d.segment_performance(made.actor, performance, segmenter, colours, body)
        seen = d.Mesh(first.vertices, made.faces)
        made.clothness = by_thresholds(seen, found.sigma) if name == "eq. 1" else found.clothness
        found = made.clothness > 0.5
        false, missed = area * (found & ~cloth), area * (cloth & ~found)
        print(f"{name:<11} cloth_iou {cloth_iou(made, truth, cameras):.3f}", end="")
        print(f"  false {false.sum():.3f} ({where(joints, owner, false)})", end="")
        print(f"  missed {missed.sum():.3f} ({where(joints, owner, missed)})")


if __name__ == "__main__":
    main()
