"""Frames in which a true garment passes through itself, and errors against it before and after.

python benchmarks/truth_knots.py SESSION/ground_truth [--simulated OUT] [--again FOLDER] [--every N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation import metrics as evaluate

NAMES = ("resim_cloth_cm", "resim_two_sided_cm", "hem_height_cm", "flare_cm")


class Part(evaluate.Truth):
    """Some frames of a truth."""

    def __init__(self, truth: evaluate.Truth, frames: list[int]):
        super().__init__(truth.folder)
        self.chunks = {frame: truth.chunks[frame] for frame in frames}


def garment_of(truth: evaluate.Truth, frames: list[int]) -> evaluate.Animated:
    """Another truth in the place of a simulation."""
    surfaces = {frame: truth.frame(frame)[1] for frame in frames}
    return evaluate.Animated(surfaces, truth.cloth_faces, np.ones(len(surfaces[frames[0]])))


def distances(moving: evaluate.Animated, truth: evaluate.Truth) -> str:
    found = [evaluate.cloth_rms_cm(moving, truth, 1, d.Context(), "", two_sided) for two_sided in (False, True)]
    found += [evaluate.outline_rms_cm(moving, truth, 1, measure) for measure in (evaluate.lowest, evaluate.wide_radius)]
    return ", ".join(f"{name} {value:.2f}" for name, value in zip(NAMES, found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("truth", type=Path, metavar="TRUTH", help="ground_truth folder")
    parser.add_argument("--simulated", type=Path, metavar="OUT", help="a reconstruction of the film")
    parser.add_argument("--again", type=Path, metavar="FOLDER", help="another truth of the film")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every n-th frame that has a truth (default: 1)")
    chosen = parser.parse_args()
    truth, crossing = evaluate.Truth(chosen.truth), {}
    pelvis = truth.pelvis()
    print(f"of {len(truth.cloth_faces)} faces pass through others; flare, cm")
    for frame in sorted(truth.chunks)[:: chosen.every]:
        garment = truth.frame(frame)[1]
        crossing[frame] = int(np.sum(d.self_intersecting_faces(d.Mesh(garment, truth.cloth_faces))))
        flare = np.nanmean(evaluate.by_azimuth(garment, pelvis[frame], evaluate.wide_radius))
        print(f"frame {frame:>4}: {crossing[frame]:>5}; {100 * flare:.1f}", flush=True)
    first = next((frame for frame, count in crossing.items() if count), len(pelvis))
    parts = {"all": list(crossing), f"before {first}": [f for f in crossing if f < first]}
    parts[f"from {first} on"] = [f for f in crossing if f >= first]
    compared = {}
    if chosen.simulated:
        compared["simulated"] = evaluate.Reconstruction(chosen.simulated).reanimated
    if chosen.again:
        compared["again"] = garment_of(evaluate.Truth(chosen.again), list(crossing))
    for name, moving in compared.items():
        for where, frames in parts.items():
            if frames:
                print(f"{name}, {where}: {distances(moving, Part(truth, frames))}")


if __name__ == "__main__":
    main()
