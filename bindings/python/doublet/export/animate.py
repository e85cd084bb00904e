"""From a character and a motion to a new animation."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from ..common.video import VideoWriter
from .clips import read_motion
from .usd import usd_modules, write_usdc

FORMATS = (".npz", ".glb", ".usdc", ".bvh", ".mp4")


@dataclass
class Output:
    """What a new animation is written with, beside its motion."""

    animation: d.AnimateOptions = field(default_factory=d.AnimateOptions)
    glb: d.BakedGlbOptions = field(default_factory=d.BakedGlbOptions)
    bone_map: Path | None = None
    clip: str = ""  # of a .glb with several animations: name, or number from 1


def animate(
    character_file: Path,
    motion_file: Path,
    out: Path,
    console: Console,
    retargeting: d.RetargetOptions,
    output: Output | None = None,
) -> int:
    """A new animation as .npz, .glb, .usdc, .bvh or .mp4; returns the number of frames."""
    if out.suffix not in FORMATS:
        raise ValueError(f"{out} must end in one of {', '.join(FORMATS)}")
    if out.suffix == ".usdc":
        usd_modules()  # before the work
    context, output = console.context(), output or Output()
    character = d.Character.read(character_file)
    motion = read_motion(motion_file, character, retargeting, context, output.bone_map, output.clip)
    if out.suffix == ".mp4":
        return write_video(character, motion, out, context, options=output.animation)
    if out.suffix == ".usdc":
        return write_usdc(out, character, motion, output.animation, context)
    if out.suffix == ".bvh":
        motion = d.resample(character.actor.skeleton, motion, 1 / character.solver.dt)
        d.write_bvh(out, character.actor.skeleton, motion)
        return len(motion)
    animation = d.animate(character, motion, output.animation, context)
    frames = len(animation.dofs)
    if out.suffix == ".npz":
        d.write_baked_npz(out, character, animation)
    elif (keys := d.write_baked_glb(out, character, animation, output.glb)) < frames:
        console.say(f"{out}: {keys} shapes for {frames} frames, between which viewers blend (--glb-max-keys allows more)")
    return frames


def cameras_along(character: d.Character, motion: d.Motion, count: int, size: int) -> list[d.Camera]:
    """One camera a frame, from the front and a little above: still if the whole motion fits, else it follows the actor."""
    joints = np.array([character.actor.skeleton.joint_positions(dofs) for dofs in motion.dofs])
    low, high = joints.min(axis=(0, 1)) - 0.25, joints.max(axis=(0, 1)) + 0.25
    radius = max(np.hypot(*(high - low)[[0, 2]]), high[1] - low[1]) / 2
    if radius < 1.8:
        return [d.orbit_camera((low + high) / 2, radius, 0.35, 0.15, size, size)] * count
    middle = joints.mean(axis=1)
    window = max(1, round(motion.fps))  # one second
    padded = np.pad(middle, ((window // 2, window - 1 - window // 2), (0, 0)), mode="edge")
    smooth = np.stack([np.convolve(padded[:, k], np.ones(window) / window, mode="valid") for k in range(3)], axis=1)
    targets = smooth[np.linspace(0, len(smooth) - 1, count).round().astype(int)]
    return [d.orbit_camera(target, 1.25, 0.35, 0.15, size, size) for target in targets]


def write_video(
    character: d.Character,
    motion: d.Motion,
    out: Path,
    context: d.Context,
    size: int = 720,
    options: d.AnimateOptions | None = None,
) -> int:
    """Headless: the library's own renderer, piped to ffmpeg."""
    fps = 1 / character.solver.dt
    count = int(len(motion) * fps / motion.fps) + 2  # at least as many as animate() makes of it
    cameras = cameras_along(character, motion, count, size)
    floor = d.RenderOptions(floor_height=float(character.actor.mesh.vertices[:, 1].min()))
    renderer = d.CharacterRenderer(character)
    with VideoWriter(out, size, size, fps) as video:

        def draw(frame: d.AnimationFrame) -> None:
            camera = cameras[min(frame.index, count - 1)]
            video.write(renderer.render(frame.surface, frame.high, frame.body, camera, floor))

        return d.animate_each(character, motion, draw, options or d.AnimateOptions(), context)


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
