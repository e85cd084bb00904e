"""How wide the band is by which a garment hangs: what the video says (the lowest E_fit of several materials), and the truth.

python benchmarks/attachment_study.py OUT [--truth SESSION/ground_truth] [--materials N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet import evaluate, pipeline
from doublet.console import Console
from sect7.reconstructions import random_materials

BANDS = (0.0, 0.02, 0.05, 0.1, 0.2)  #: m, GarmentOptions.band


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="a reconstruction up to stage 'fit'")
    parser.add_argument("--truth", type=Path, metavar="DIR", help="ground_truth folder")
    parser.add_argument("--materials", type=int, default=15, metavar="N", help="random ones beside the estimate (default: 15)")
    parser.add_argument("--every", type=int, default=4, metavar="N", help="compare every n-th frame that has a truth")
    arguments = parser.parse_args()

    out, context = arguments.out, Console(quiet=True).context()
    made = evaluate.Reconstruction(out)
    truth = evaluate.Truth(arguments.truth) if arguments.truth else None
    estimate = d.read_materials(out / "material.json")
    materials = [estimate] + [[m] * len(estimate) for m in random_materials(arguments.materials, 0)]
    for band in BANDS:
        job = pipeline.Job(pipeline.recorded_session(out), out)
        options = d.GarmentOptions(**{**job.options["garment"].to_dict(), "band": band})
        body = d.read_body(job.path("body.npz")).body
        mesher = d.GarmentMesher.create(options)
        job.garment = mesher.mesh(job.actor, job.clothness(), body, job.performance().surface, context)
        simulator, performance = job.simulator(), job.dressed_performance()
        objective = d.MaterialObjective(
            simulator, performance, d.read_observations(job.path("observations.npz")), job.energy_options()
        )
        costs = np.sum(objective.energies(materials, d.Context()), axis=1)
        line = f"band {1000 * band:3.0f} mm: E_fit of the estimate {costs[0]:.0f}, lowest {costs.min():.0f} px^2"
        if truth:
            best, settle = materials[int(costs.argmin())], job.options["energy"].settle_frames
            moving = made.animated(d.simulate_reference(simulator, performance, best, 1 / job.session.fps, settle))
            line += f"; the lowest is {evaluate.cloth_rms_cm(moving, truth, arguments.every, context, ''):.2f} cm from the truth"
        print(line, flush=True)


if __name__ == "__main__":
    main()
