"""An option of the garment's mesh by video and by truth: E_fit of the same ordinary materials with each value, and the distance
of the best of them from the truth.

python benchmarks/garment_study.py OUT --values 0.15 0.25 0.35 0.5 [--option NAME] [--truth SESSION/ground_truth] [--materials N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet import reconstruct
from doublet.evaluation import metrics as evaluate


def dressed_faces(job: reconstruct.Job) -> tuple[np.ndarray, np.ndarray]:
    """Faces of the actor in the garment, and how loose its vertices are."""
    actor, bare = job.results.dressed.actor, len(job.results.actor.mesh.vertices)
    faces = actor.mesh.faces[np.asarray(actor.face_valid, bool)]
    return faces, np.repeat([0.0, 1.0], [bare, len(actor.mesh.vertices) - bare])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="a reconstruction up to stage 'body'")
    parser.add_argument(
        "--option",
        default="length_exceedances",
        choices=list(d.GarmentOptions.described()),
        help="of GarmentOptions (default: length_exceedances)",
    )
    parser.add_argument(
        "--values", type=float, nargs="+", required=True, help="of the option; the first is what others are set against"
    )
    parser.add_argument("--truth", type=Path, metavar="DIR", help="ground_truth folder")
    parser.add_argument("--materials", type=int, default=16, metavar="N", help="with which each is tried (default: 16)")
    parser.add_argument("--every", type=int, default=4, metavar="N", help="compare every n-th frame that has a truth")
    arguments = parser.parse_args()

    truth, context = evaluate.Truth(arguments.truth) if arguments.truth else None, d.Context()
    space, first = d.ParameterSpace(), None
    box = np.random.default_rng(1).random((arguments.materials, len(space.names)))
    box[:, list(space.names).index("k_stretch")] = 1
    materials = [space.material(unit) for unit in box]
    lowest = arguments.materials // 4
    for value in arguments.values:
        job = reconstruct.Job(reconstruct.recorded_session(arguments.out), arguments.out)
        chosen = {"length_exceedances": [0.25], arguments.option: [value] if arguments.option == "length_exceedances" else value}
        options = d.GarmentOptions(**{**job.options["garment"].to_dict(), **chosen})
        body, captured = d.read_body(job.path("body.npz")).body, job.results.performance().surface
        job.results.offered_garment = d.GarmentMesher.create(options).mesh(
            job.results.actor, job.results.segmentation(), body, captured, context
        )
        simulator, performance, energy = (
            job.results.simulator(job.options["cloth"]),
            job.results.dressed_performance(),
            job.fit_options().energy,
        )
        observations = d.read_observations(job.path("observations.npz"))
        dt = 1 / job.session.fps
        objective = d.MaterialObjective(simulator, performance, observations, dt, energy, space)
        each = [[material] * simulator.region_count for material in materials]
        costs = np.sum(objective.energies(each, context), axis=1)
        first = costs if first is None else first
        ratio = np.log(costs / first)
        change, error = 100 * np.expm1(ratio.mean()), 100 * ratio.std(ddof=1) / len(ratio) ** 0.5
        line = f"{arguments.option} {value:g}: lowest quarter {np.sort(costs)[:lowest].mean():.0f} px^2, all {costs.mean():.0f}, "
        line += f"{change:+.1f} % to the first, standard error {error:.1f} %"
        if truth:
            faces, clothness = dressed_faces(job)
            distances = []
            for index in np.argsort(costs)[:lowest]:
                frames = d.simulate_reference(simulator, performance, each[index], dt, energy.settle_frames)
                moving = evaluate.Animated(dict(zip(performance.frames, frames)), faces, clothness)
                distances.append(evaluate.cloth_rms_cm(moving, truth, arguments.every, context, ""))
            line += f"; {np.mean(distances):.2f} cm from the truth"
        print(line, flush=True)


if __name__ == "__main__":
    main()
