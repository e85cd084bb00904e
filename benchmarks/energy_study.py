"""How well E_fit predicts the distance to the true garment: rank correlation over random materials with k_stretch 1.

python benchmarks/energy_study.py OUT --truth SESSION/ground_truth [--materials N] [--every N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet import reconstruct
from doublet.common.console import Console
from doublet.evaluation import metrics as evaluate
from sect7.reconstructions import random_materials

#: Of the energy: the paper's form, in which a miss is free; nothing free, images alone; features weighted less; the default.
ENERGIES = {
    "the paper's": {"beta": 10.0, "gamma": 0.0, "delta": 0.0, "fixed_correspondences": False, "speed_dependent_cap": False},
    "images alone, beta 10": {"beta": 10.0, "delta": 0.0},
    "images alone, beta 1": {"delta": 0.0},
    "the default": {},
}


def ranks(values: np.ndarray) -> np.ndarray:
    return np.argsort(np.argsort(values)).astype(float)


def rank_correlation(a, b) -> float:
    return float(np.corrcoef(ranks(np.asarray(a)), ranks(np.asarray(b)))[0, 1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="a reconstruction up to stage 'garment'")
    parser.add_argument("--truth", type=Path, required=True)
    parser.add_argument("--materials", type=int, default=64)
    parser.add_argument("--every", type=int, default=4, help="compare every n-th frame that has a truth")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()

    job = reconstruct.Job(reconstruct.recorded_session(arguments.out), arguments.out)
    simulator = job.results.simulator(job.options["cloth"])
    performance, dt = job.results.dressed_performance(), 1 / job.session.fps
    made, truth, context = evaluate.Reconstruction(arguments.out), evaluate.Truth(arguments.truth), Console(quiet=True).context()
    regions = job.results.dressed.segmentation.region_count
    materials, distances = random_materials(arguments.materials, arguments.seed), []
    for material in materials:
        settle = job.options["energy"].settle_frames
        moving = made.animated(d.simulate_reference(simulator, performance, [material] * regions, dt, settle))
        distances.append(
            [evaluate.cloth_rms_cm(moving, truth, arguments.every, context, "", two_sided=both) for both in (False, True)]
        )
    one, two = np.transpose(distances)
    print(f"{len(materials)} materials: resim_cloth_cm {one.min():.2f} to {one.max():.2f}")
    observations = d.read_observations(job.path("observations.npz"))
    for name, changed in ENERGIES.items():
        options = d.EnergyOptions(**{**job.fit_options().energy.to_dict(), **changed})
        objective = d.MaterialObjective(simulator, performance, observations, dt, options)
        energies = np.sum(objective.energies([[m] * regions for m in materials], d.Context()), axis=1)
        low = energies.argsort()[: len(energies) // 3]
        print(
            f"{name}: Spearman with resim_cloth_cm {rank_correlation(energies, one):.3f}, "
            f"with resim_two_sided_cm {rank_correlation(energies, two):.3f}; in the lowest third "
            f"{rank_correlation(energies[low], one[low]):.3f}, {rank_correlation(energies[low], two[low]):.3f}; "
            f"the lowest is {one[energies.argmin()]:.2f}, {two[energies.argmin()]:.2f} cm away"
        )


if __name__ == "__main__":
    main()
