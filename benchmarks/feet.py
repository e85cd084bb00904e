"""How feet stand, touch down and leave in clips that are retargeted to a character, without cloth (docs/animation.md, Feet).

python benchmarks/feet.py CHARACTER.glb CLIP...

One row per clip, before and after plant_feet, without the blend from the rest pose. The lowest point of a foot of the coarse mesh
counts as sliding while it is lower than 0.5, 1 or 1.5 cm: the number of such foot frames, and median and 95 % of that point's
speed along the floor since the frame before. Lifting feet makes the numbers smaller, so a gain is one if it is there at every
height. `near` are the frames within 0.075 s of a contact of the clip, but not in it, the same before and after: median height,
median and 95 % of the speed. `standing` are those in a contact: median and 95 % of the height. `lowest` is the lowest point of
both feet over the clip, `below` the share of foot frames that are more than 3 mm below the floor, `floats` that of the frames
with a contact in the clip in which no foot is within 1 cm. `knee` and `hip` are the fastest turns.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np

HEIGHTS = 0.005, 0.01, 0.015  # m
BELOW, ON_FLOOR = 0.003, 0.01  # m
AROUND = 0.075  # s

COLUMNS = (
    "clip",
    "0.5 cm",
    "1 cm",
    "1.5 cm",
    "near: cm; cm/s",
    "standing, cm",
    "lowest, cm",
    "below",
    "floats",
    "knee, hip, rad/s",
)


class Feet:
    """The feet of a character's coarse mesh in a motion."""

    def __init__(self, character: d.Character):
        actor = character.actor
        self.skeleton = actor.skeleton
        names, weights = list(self.skeleton.joint_names), np.asarray(actor.weights)
        rigid = np.asarray(character.segmentation.clothness) <= 0.5
        self.ankles = [names.index(side + "_ankle") for side in "lr"]
        vertices = [np.flatnonzero((weights[:, ankle] > 0.5) & rigid) for ankle in self.ankles]
        self.rests = [np.asarray(actor.mesh.vertices)[v] for v in vertices]
        self.weights = [weights[v] for v in vertices]

    def lowest(self, motion: d.Motion) -> tuple[np.ndarray, np.ndarray]:
        """(T, 2) m, height of each foot's lowest point, and (T - 1, 2) m/s, its speed along the floor since then."""
        heights, speeds, before = [], [], None
        for dofs in motion.dofs:
            world = self.skeleton.forward_kinematics(dofs)
            feet = [d.dual_quaternion_skinning(r, w, world) for r, w in zip(self.rests, self.weights)]
            low = [foot[:, 1].argmin() for foot in feet]
            heights.append([foot[k, 1] for foot, k in zip(feet, low)])
            if before is not None:
                speeds.append([np.linalg.norm((b[k] - a[k])[[0, 2]]) * motion.fps for a, b, k in zip(before, feet, low)])
            before = feet
        return np.array(heights), np.array(speeds)

    def fastest(self, motion: d.Motion) -> tuple[float, float]:
        """rad/s of knees and hips."""
        names, parents = list(self.skeleton.joint_names), np.asarray(self.skeleton.joint_parents)
        world = np.array([self.skeleton.forward_kinematics(dofs)[:, :3, :3] for dofs in motion.dofs])
        turns = []
        for joint in "knee", "hip":
            at = [names.index(f"{side}_{joint}") for side in "lr"]
            own = np.swapaxes(world[:, parents[at]], -1, -2) @ world[:, at]
            step = np.swapaxes(own[:-1], -1, -2) @ own[1:]
            cosine = np.clip((np.trace(step, axis1=-2, axis2=-1) - 1) / 2, -1, 1)
            turns.append(float(np.arccos(cosine).max() * motion.fps))
        return turns[0], turns[1]


def contacts(skeleton: d.Skeleton, clip: d.Motion) -> np.ndarray:
    """(T, 2) whether each foot stands."""
    return np.array([np.asarray(f.heel, bool) | np.asarray(f.ball, bool) for f in d.find_contacts(skeleton, clip)]).T


def widened(flags: np.ndarray, frames: int) -> np.ndarray:
    result = flags.copy()
    for k in range(1, frames + 1):
        result[k:] |= flags[:-k]
        result[:-k] |= flags[k:]
    return result


def middle_and_most(values: np.ndarray, unit: float, digits: int) -> str:
    if not values.size:
        return "-"
    return f"{unit * np.median(values):.{digits}f}, {unit * np.percentile(values, 95):.{digits}f}"


def measured(feet: Feet, motion: d.Motion, stand: np.ndarray) -> list[str]:
    heights, speeds = feet.lowest(motion)
    near = widened(stand, round(AROUND * motion.fps)) & ~stand
    sliding = [(heights[1:] < h) for h in HEIGHTS]
    floats = (heights[stand.any(axis=1)] > ON_FLOOR).all(axis=1)
    knee, hip = feet.fastest(motion)
    return [
        *(f"{s.sum()}: {middle_and_most(speeds[s], 100, 0)}" for s in sliding),
        f"{100 * np.median(heights[near]):.1f}; {middle_and_most(speeds[near[1:]], 100, 0)}" if near.any() else "-",
        middle_and_most(heights[stand], 100, 2),
        f"{100 * heights.min():.2f}",
        f"{(heights < -BELOW).mean():.1%}",
        f"{floats.mean() if floats.size else 0:.1%}",
        f"{knee:.1f}, {hip:.1f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("character", type=Path, metavar="CHARACTER.glb")
    parser.add_argument("clips", type=Path, nargs="+", metavar="CLIP")
    chosen = parser.parse_args()
    character = d.Character.read(chosen.character)
    feet = Feet(character)
    plain = d.RetargetOptions(fps=1 / character.solver.dt, plant_feet=False, hold_seconds=0, blend_seconds=0)
    print("| " + " | ".join(COLUMNS) + " |")
    print("| --- " * len(COLUMNS) + "|")
    for clip in chosen.clips:
        before = d.retarget(d.SourceMotion.read(clip), feet.skeleton, plain)
        stand = contacts(feet.skeleton, before)
        for name, motion in ("before", before), ("planted", d.plant_feet(feet.skeleton, before)):
            print(f"| {clip.stem}, {name} | " + " | ".join(measured(feet, motion, stand)) + " |", flush=True)


if __name__ == "__main__":
    main()
