"""Defects of a character's animation on many clips, one row per clip (docs/animation.md).

python benchmarks/clips.py CHARACTER.glb CLIP... [--hold 3] [--every 8]

skin: frames in which over 2 cm^2 of the person (without arms) come through the garment in the worst of 8 views, and the largest
area; within: the same where the garment lies between the person's front and back (display_hem.py); stretch: the largest ratio of
the length of an edge of the drawn garment to that in the garment's rest shape (2 mm if it is shorter there), the frame, and how
many edges are ever over 3 times as long; floor: height of the lowest point of the feet over the floor, its minimum and maximum
over the frames; slide: speed of a foot's lowest point along the floor while it is within 1 cm of it, 95 % quantile; rest: speed
of the garment in the last half second of the held last pose, 95 % quantile over vertices; crossing: faces of the simulated
garment that pass through others, when the motion ends and when the hold ends.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from display_hem import SEEN, Drawn, worst_view
from doublet.common.console import Console

ON_FLOOR, SHORTEST = 0.01, 0.002  # m
TOO_LONG = 3  # times


def held(motion: d.Motion, seconds: float) -> d.Motion:
    """The motion, and its last pose for some seconds."""
    last = np.repeat(motion.dofs[-1:], round(seconds * motion.fps), axis=0)
    return d.Motion(motion.fps, np.vstack([motion.dofs, last]))


def rest_of(character: d.Character) -> np.ndarray:
    """(VH, 3) m: M_high where the garment has its rest shape."""
    segmentation, coarse = character.segmentation, np.array(character.actor.mesh.vertices)
    rest = np.asarray(segmentation.rest)
    if len(rest):
        worn = np.asarray(segmentation.region) >= 0
        coarse[worn] = rest[worn]
    return d.DisplaySurface(character).apply(coarse)


class GarmentWatcher:
    """Measures the garment in the frames of an animation as they come: how far it is stretched, whether it crosses itself."""

    def __init__(self, character: d.Character, drawn: Drawn, motion_frames: int):
        self.motion_frames = motion_frames
        faces, region = character.actor.mesh.faces, np.asarray(character.segmentation.region)
        self.worn = faces[(region[faces] >= 0).all(axis=1)]
        faces = drawn.faces[drawn.cloth]
        self.edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        self.rest = np.maximum(self.length(rest_of(character)), SHORTEST)
        self.stretch, self.crossing, self.over = [], [], np.zeros(len(self.edges), bool)

    def length(self, vertices: np.ndarray) -> np.ndarray:
        return np.linalg.norm(vertices[self.edges[:, 0]] - vertices[self.edges[:, 1]], axis=1)

    def __call__(self, frame: d.AnimationFrame) -> None:
        self.last = np.array(frame.surface)
        if frame.index < self.motion_frames:
            stretched = self.length(frame.high) / self.rest
            self.over |= stretched > TOO_LONG
            self.stretch.append(float(stretched.max()))
        if frame.index == self.motion_frames - 1:
            self.crossing.append(self.count_crossing())

    def count_crossing(self) -> int:
        """Faces of the simulated garment that pass through others in the last frame."""
        return int(np.sum(d.self_intersecting_faces(d.Mesh(self.last, self.worn))))


class Watcher(GarmentWatcher):
    """And the person: skin that comes through, feet, and whether the garment comes to rest."""

    def __init__(self, character: d.Character, drawn: Drawn, motion_frames: int, every: int):
        super().__init__(character, drawn, motion_frames)
        self.drawn, self.every, self.fps = drawn, every, 1 / character.solver.dt
        actor = character.actor
        self.free = np.asarray(character.segmentation.clothness) > 0.5
        names, weights = list(actor.skeleton.joint_names), np.asarray(actor.weights)
        self.feet = [np.flatnonzero((weights[:, names.index(n)] > 0.5) & ~self.free) for n in names if "ankle" in n]
        self.through, self.lowest, self.slides, self.speeds, self.before = [], [], [], [], None

    def __call__(self, frame: d.AnimationFrame) -> None:
        super().__call__(frame)
        surface = self.last
        if frame.index < self.motion_frames:
            self.watch_feet(surface)
            if frame.index % self.every == 0:
                self.through.append(self.drawn.through(frame))
        elif self.before is not None:
            self.speeds.append(np.linalg.norm((surface - self.before)[self.free], axis=1) * self.fps)
        self.before = surface

    def watch_feet(self, surface: np.ndarray) -> None:
        self.lowest.append(min(surface[foot, 1].min() for foot in self.feet))
        if self.before is None:
            return
        for foot in self.feet:
            low = foot[surface[foot, 1].argmin()]
            if surface[low, 1] < ON_FLOOR:
                self.slides.append(np.linalg.norm((surface[low] - self.before[low])[[0, 2]]) * self.fps)

    def row(self) -> list:
        at, half = int(np.argmax(self.stretch)), int(self.fps / 2)
        rest = np.percentile(np.concatenate(self.speeds[-half:]), 95)
        self.crossing.append(self.count_crossing())
        skin, _, within = worst_view(self.through).T
        return [
            *(f"{(areas > SEEN).mean():.1%}, {areas.max():.1f} cm2" for areas in (skin, within)),
            f"{self.stretch[at]:.1f} ({at}), {self.over.sum()}",
            f"{100 * min(self.lowest):.1f}, {100 * max(self.lowest):.1f}",
            f"{100 * np.percentile(self.slides, 95):.0f}" if self.slides else "-",
            f"{1000 * rest:.1f}",
            f"{self.crossing[0]}, {self.crossing[-1]}",
        ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("character", type=Path, metavar="CHARACTER.glb")
    parser.add_argument("clips", type=Path, nargs="+", metavar="CLIP")
    parser.add_argument("--hold", type=float, default=3, metavar="S", help="the last pose is held so long (default: 3)")
    parser.add_argument("--every", type=int, default=8, metavar="N", help="frames between two in which skin is looked for")
    chosen = parser.parse_args()
    if not chosen.hold > 0:
        parser.error(f"--hold: expected seconds above 0, found {chosen.hold:g}")
    character, console = d.Character.read(chosen.character), Console()
    drawn = Drawn(character)
    print("| clip | frames | skin | within | stretch (frame), over 3 | floor, cm | slide, cm/s | rest, mm/s | crossing |")
    print("| --- " * 9 + "|")
    for clip in chosen.clips:
        retargeting = d.RetargetOptions(fps=1 / character.solver.dt)
        motion = d.retarget(d.SourceMotion.read(clip), character.actor.skeleton, retargeting)
        watcher = Watcher(character, drawn, len(motion), chosen.every)
        d.animate_each(character, held(motion, chosen.hold), watcher, d.AnimateOptions(), console.context())
        console.finish()
        print(f"| {clip.name} | {len(motion)} | " + " | ".join(watcher.row()) + " |", flush=True)


if __name__ == "__main__":
    main()
