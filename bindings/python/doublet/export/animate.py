"""From a character and a motion to a new animation."""

from __future__ import annotations

import os
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from ..common.files import require_other_file
from ..common.video import VideoWriter
from . import bone_names
from .clips import at_own_rate, centred, read_motion
from .level_of_detail import level_of_detail, only_drawn
from .usd import usd_modules, write_usdc
from .vertex_animation import write_vertex_animation
from .video_camera import Shot, cameras_along

FORMATS = (".npz", ".glb", ".usdc", ".bvh", ".mp4", "_vat.png")
#: One B frame, fewer frames to look ahead, coarser motion: two fifths less of the encoder's time, files an eighth larger.
FAST_CODING = ("-bf", "1", "-rc-lookahead", "5", "-subq", "1")


@dataclass
class Output:
    """What a new animation is written with, beside its motion."""

    animation: d.AnimateOptions = field(default_factory=d.AnimateOptions)
    glb: d.BakedGlbOptions = field(default_factory=d.BakedGlbOptions)
    bone_map: Path | None = None
    clip: str = ""  # of a .glb with several animations: name, or number from 1
    shot: Shot | None = None  # of a video
    bone_names: str = ""  # of bone_names.SCHEMES, in a .bvh or .glb; empty = ours
    triangles: int = 0  # of the display surface, at about this level of detail; 0 = all of them
    centre: bool = False  # the motion begins over the world's origin, not where the scan stood


def animate(
    character_file: Path,
    motion_file: Path,
    out: Path,
    console: Console,
    retargeting: d.RetargetOptions,
    output: Output | None = None,
) -> int:
    """A new animation as .npz, .glb, .usdc, .bvh, .mp4 or _vat.png; returns the number of frames."""
    if not out.name.endswith(FORMATS):
        raise ValueError(f"{out} must end in one of {', '.join(FORMATS)}")
    require_other_file(out, character_file, motion_file)
    if output and output.shot and out.suffix != ".mp4":
        raise ValueError(f"{out}: expected an .mp4 for a size, camera or background, found {out.suffix}")
    if output and output.bone_names and out.suffix not in (".bvh", ".glb"):
        raise ValueError(f"{out}: expected a .bvh or .glb for bones of other names, found {out.suffix}")
    if output and output.triangles and out.suffix == ".bvh":
        raise ValueError(f"{out}: expected a .glb, .npz, .usdc, .mp4 or _vat.png for a level of detail, found {out.suffix}")
    if output and output.triangles and not output.animation.high:
        raise ValueError("--lod: expected the display surface to draw less of, found it left out (--no-animate-high)")
    if out.suffix == ".usdc":
        usd_modules()  # before the work
    context, output = console.context(), output or Output()
    character = d.Character.read(character_file)
    drawn = level_of_detail(character, output.triangles) if output.triangles else d.TexturedFaces()
    motion = read_motion(motion_file, character, retargeting, context, output.bone_map, output.clip)
    if output.centre:
        motion = centred(motion, character.actor.skeleton)
    if out.suffix == ".mp4":
        shown = only_drawn(character_file, drawn) if output.triangles else character
        return write_video(character, motion, out, context, output.shot, output.animation, shown)
    if out.suffix == ".usdc":
        return write_usdc(out, character, motion, output.animation, context, drawn)
    if out.suffix == ".png":
        return write_vertex_animation(out, character, motion, output.animation, context, drawn)
    if out.suffix == ".bvh":
        motion = at_own_rate(motion, character)
        d.write_bvh(out, character.actor.skeleton, motion)
        if output.bone_names:
            bone_names.rename(out, output.bone_names)
        return len(motion)
    animation = d.animate(character, motion, output.animation, context)
    frames = len(animation.dofs)
    if out.suffix == ".npz":
        d.write_baked_npz(out, character, animation, drawn)
        return frames
    baked = d.write_baked_glb(out, character, animation, output.glb, drawn, context)
    for line in baked_lines(out, baked, frames, output.glb):
        console.say(line)
    if output.bone_names:
        bone_names.rename(out, output.bone_names)
    return frames


def baked_lines(out: Path, summary: d.BakedGlbSummary, frames: int, options: d.BakedGlbOptions) -> list[str]:
    """What a baked file keeps of its animation, in words."""
    lines = [f"{out}: {out.stat().st_size / 1e6:.1f} MB"]
    for mesh in summary.meshes:
        rms, of_95, largest = (f"{1000 * error:.2f}" for error in (mesh.rms_error, mesh.error_95, mesh.max_error))
        lines.append(f"{mesh.name}: {mesh.shapes} shapes, off by {rms} mm (RMS), 95 % below {of_95}, at most {largest} mm")
        if 0 < options.max_error < mesh.rms_error:
            allowed = f"{1000 * options.max_error:g} mm takes more than {options.max_keys} shapes"
            lines.append(f"{mesh.name}: {allowed} (--glb-max-keys, --glb-max-error, --lod)")
    if summary.keys < frames:
        lines.append(f"{summary.keys} keys for {frames} frames, between which viewers blend")
    return lines


def write_video(
    character: d.Character,
    motion: d.Motion,
    out: Path,
    context: d.Context,
    shot: Shot | None = None,
    options: d.AnimateOptions | None = None,
    shown: d.Character | None = None,
) -> int:
    """Headless: the library's own renderer, piped to ffmpeg. Pictures are drawn on other threads while the cloth goes on, and so
    is what they need, while it settles. `shown`: what is drawn, if that is not the character itself."""
    shot = shot or Shot()
    shot.validate()
    fps, threads = 1 / character.solver.dt, context.threads or os.cpu_count() or 1
    drawn: deque[Future] = deque()
    # Players take colours of which nothing is said for BT.601 or BT.709, by the size of the picture.
    writer = VideoWriter(out, shot.width, shot.height, fps, preset="veryfast", matrix="bt709", coding=FAST_CODING)
    with writer as video, ThreadPoolExecutor(threads) as pool:
        film = pool.submit(Film, character, motion, shot, shown or character)

        def draw(frame: d.AnimationFrame) -> None:
            shapes = (np.array(frame.surface), np.array(frame.high), np.array(frame.body))
            drawn.append(pool.submit(lambda index: film.result().picture(index, shapes), frame.index))
            while len(drawn) > 2 * threads:
                video.write(drawn.popleft().result())

        frames = d.animate_each(character, motion, draw, options or d.AnimateOptions(), context)
        while drawn:
            video.write(drawn.popleft().result())
    return frames


class Film:
    """What the pictures of a motion have in common."""

    def __init__(self, character: d.Character, motion: d.Motion, shot: Shot, shown: d.Character):
        count = int(len(motion) / (character.solver.dt * motion.fps)) + 2  # at least as many as animate() makes of it
        self.cameras = cameras_along(character, motion, count, shot)
        floor = float(character.actor.mesh.vertices[:, 1].min())
        self.look = d.RenderOptions(floor_height=floor, background=shot.background)
        self.renderer = d.CharacterRenderer(shown)

    def picture(self, index: int, shapes: tuple[np.ndarray, ...]) -> np.ndarray:
        """(H, W, 3) uint8 BGR of frame `index`; shapes: surface, high, body."""
        return self.renderer.render(*shapes, self.cameras[min(index, len(self.cameras) - 1)], self.look)


def exact_motion(character: d.Character, motion_file: Path, fps: float, context: d.Context) -> d.Motion:
    """A motion of the character's own skeleton, whose first frame is the rest pose: nothing is put in front of it, nothing
    adapted to the floor."""
    as_it_is = d.RetargetOptions(
        fps=fps, apply_limits=False, ground_feet=False, plant_feet=False, hold_seconds=0.0, blend_seconds=0.0
    )
    return d.retarget(d.SourceMotion.read(motion_file), character.actor.skeleton, as_it_is, context)


def animate_exactly(character: d.Character, motion_file: Path, fps: float, context: d.Context) -> np.ndarray:
    """(T, V, 3) m: the character on an `exact_motion`, by the solver that its material was fitted with."""
    motion = exact_motion(character, motion_file, fps, context)
    return d.animate(character, motion, d.AnimateOptions(high=False, body=False, edge_collision=False), context).surface
