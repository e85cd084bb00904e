"""How the simulated garment lies on the body: gap and bulge where the true one rests on it, and penetration of the body.

python benchmarks/garment_gap.py OUT --truth SESSION/ground_truth [--every N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation import metrics as evaluate

RESTS = 0.02  #: m, true cloth nearer to the true body rests on it


def heights(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(N) m, signed distance of points (N, 3) to a surface: below 0 inside."""
    nearest, _, on_surface = d.RayScene(d.Mesh(vertices, faces)).closest(points)
    off = points - on_surface
    inside = (off * d.face_normals(vertices, faces)[nearest]).sum(axis=1) < 0
    return np.where(inside, -1, 1) * np.linalg.norm(off, axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--truth", type=Path, required=True, metavar="DIR", help="ground_truth folder")
    parser.add_argument("--every", type=int, default=4, metavar="N", help="every n-th frame that has a truth (default: 4)")
    chosen = parser.parse_args()
    made, truth = evaluate.Reconstruction(chosen.out), evaluate.Truth(chosen.truth)
    moving = made.reanimated
    cloth_faces = moving.faces[(moving.clothness[moving.faces] > 0.5).all(axis=1)]
    true_gap, gap, inside = [], [], []
    for frame in evaluate.shared_frames(moving, truth.chunks, chosen.every):
        body, garment = truth.frame(frame)
        surface = moving.surfaces[frame]
        lies = heights(garment, body, truth.body_faces)
        resting = lies < RESTS
        _, _, ours = d.RayScene(d.Mesh(surface, cloth_faces)).closest(garment[resting])
        true_gap.append(lies[resting])
        gap.append(heights(ours, body, truth.body_faces))
        inside.append(heights(surface[moving.cloth], body, truth.body_faces))
    true_gap, gap, inside = (1000 * np.concatenate(part) for part in (true_gap, gap, inside))
    bulge = np.percentile(gap - true_gap, [50, 95])
    deep = -inside[inside < 0]
    depth = [np.percentile(deep, p) if len(deep) else 0.0 for p in (50, 95)]
    print(f"where the true garment rests on the body ({len(true_gap)} points within {1000 * RESTS:.0f} mm):")
    print(f"  gap: true {true_gap.mean():.1f} mm, simulated {gap.mean():.1f} mm")
    print(f"  bulge, simulated beyond true: median {bulge[0]:.1f} mm, 95 % {bulge[1]:.1f} mm")
    print(f"inside the true body: {100 * (inside < 0).mean():.1f} %, depth: median {depth[0]:.1f} mm, 95 % {depth[1]:.1f} mm")


if __name__ == "__main__":
    main()
