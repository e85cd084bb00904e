"""Error and size of levels of detail of a character's display surface: distance of the surface's vertices to the drawn faces, in
every 16th frame of a clip, and the size of the baked .glb.

python benchmarks/level_of_detail.py CHARACTER.glb MOTION [--triangles 10000 4000 2000] [-o FILE.jpg --frame 120]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import doublet as d
import numpy as np
from doublet.export.level_of_detail import level_of_detail, only_drawn
from doublet.export.video_camera import Shot, cameras_along
from PIL import Image

EVERY = 16  # frames
SIZE = 720, 1080  # px, of a panel ...
MIDDLE = np.s_[210:870, 150:630]  # ... of which this is kept


def distances(animation: d.AnimationResult, every: d.TexturedFaces, drawn: d.TexturedFaces) -> np.ndarray:
    """m, of all vertices that the surface has to the triangles that are drawn."""
    used, found = np.unique(every.faces), []
    for places in animation.high[::EVERY]:
        on_drawn = d.RayScene(d.Mesh(places, drawn.faces)).closest(places[used])[2]
        found.append(np.linalg.norm(on_drawn - places[used], axis=1))
    return np.concatenate(found)


def panel(file: Path, drawn: d.TexturedFaces, animation: d.AnimationResult, frame: int) -> np.ndarray:
    """The character in one frame, as it is drawn with these triangles."""
    character = d.Character.read(file)
    motion = d.Motion(animation.fps, animation.dofs)
    camera = cameras_along(character, motion, len(animation.dofs), Shot(width=SIZE[0], height=SIZE[1], camera="follow"))[frame]
    body = animation.body[frame] if len(animation.body) else np.zeros((0, 3))
    renderer = d.CharacterRenderer(only_drawn(file, drawn))
    image = renderer.render(animation.surface[frame], animation.high[frame], body, camera, d.RenderOptions())
    return image[MIDDLE][:, :, ::-1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("character", type=Path, metavar="CHARACTER.glb")
    parser.add_argument("motion", type=Path, metavar="MOTION")
    parser.add_argument("--triangles", type=int, nargs="+", default=[10000, 4000, 2000], metavar="N")
    parser.add_argument("-o", "--out", type=Path, metavar="FILE.jpg", help="a picture of all of them")
    parser.add_argument("--frame", type=int, default=120, help="of the picture (default: 120)")
    chosen = parser.parse_args()
    character = d.Character.read(chosen.character)
    clip = d.SourceMotion.read(chosen.motion)
    motion = d.retarget(clip, character.actor.skeleton, d.RetargetOptions(fps=1 / character.solver.dt))
    animation, every, panels = d.animate(character, motion), d.drawn_faces(character), []
    print("| triangles | vertices | MB | mean (mm) | 95 % | worst |\n| --- | --- | --- | --- | --- | --- |")
    for triangles in (len(every.faces), *chosen.triangles):
        drawn = level_of_detail(character, triangles)
        off = 1000 * distances(animation, every, drawn)
        with tempfile.TemporaryDirectory() as folder:
            baked = d.write_baked_glb(Path(folder) / "a.glb", character, animation, d.BakedGlbOptions(), drawn).meshes[0]
            size = (Path(folder) / "a.glb").stat().st_size / 1e6
        numbers = f"{off.mean():.1f} | {np.quantile(off, 0.95):.1f} | {off.max():.0f}"
        print(f"| {len(drawn.faces)} | {baked.vertices} | {size:.1f} | {numbers} |", flush=True)
        if chosen.out:
            panels.append(panel(chosen.character, drawn, animation, chosen.frame))
    if chosen.out:
        Image.fromarray(np.ascontiguousarray(np.concatenate(panels, axis=1))).save(chosen.out, quality=88)


if __name__ == "__main__":
    main()
