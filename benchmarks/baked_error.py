"""Size and error of a baked .glb: positions over all frames, normals in every 16th frame.

python benchmarks/baked_error.py CHARACTER.glb MOTION [--errors 0 0.0005 0.001 0.002] [-o FOLDER]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import doublet as d
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "python"))
from glb_viewer import Viewer

EVERY = 16  # frames


def turned_degrees(file: Path, character: d.Character, animation: d.AnimationResult) -> np.ndarray:
    """Angles between the normals that a viewer has of the surface and those of the animation."""
    viewer, faces = Viewer(file), character.high.faces[np.asarray(character.high_valid, bool)]
    mesh = viewer.gltf["meshes"][viewer.gltf["nodes"][viewer.node["surface"]]["mesh"]]
    triangles = viewer.array(mesh["primitives"][0]["indices"]).astype(int).ravel()
    original = np.empty(triangles.max() + 1, int)
    original[triangles] = faces.ravel()
    angles = []
    for frame in range(0, len(animation.dofs), EVERY):
        true = d.vertex_normals(animation.high[frame], faces)[original]
        cosines = np.sum(viewer.normals("surface", frame / animation.fps) * true, axis=1)
        angles.append(np.degrees(np.arccos(np.clip(cosines, -1, 1))))
    return np.concatenate(angles)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("character", type=Path, metavar="CHARACTER.glb")
    parser.add_argument("motion", type=Path, metavar="MOTION")
    parser.add_argument("--errors", type=float, nargs="+", default=[0, 5e-4, 1e-3, 2e-3], metavar="M")
    parser.add_argument("-o", "--out", type=Path, metavar="FOLDER", help="where the files stay (default: nowhere)")
    chosen = parser.parse_args()
    character = d.Character.read(chosen.character)
    clip = d.SourceMotion.read(chosen.motion)
    motion = d.retarget(clip, character.actor.skeleton, d.RetargetOptions(fps=1 / character.solver.dt))
    animation = d.animate(character, motion)
    print("| error allowed (m) | MB | shapes | RMS (mm) | 95 % | worst | normals, median (degrees) | 95 % |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch:
        folder = chosen.out or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for error in chosen.errors:
            file = folder / f"{1000 * error:g}mm.glb"
            baked = d.write_baked_glb(file, character, animation, d.BakedGlbOptions(max_error=error)).meshes[0]
            off = [1000 * value for value in (baked.rms_error, baked.error_95, baked.max_error)]
            turned = np.quantile(turned_degrees(file, character, animation), (0.5, 0.95))
            numbers = " | ".join(f"{value:.2f}" for value in (*off, *turned))
            print(f"| {error:g} | {file.stat().st_size / 1e6:.1f} | {baked.shapes} | {numbers} |", flush=True)


if __name__ == "__main__":
    main()
