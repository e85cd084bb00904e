"""Evaluations that CMA-ES and simulated annealing need to reach the same energy, on a reconstruction (the paper: 2-4 times as
many for annealing).

    python benchmarks/annealing_study.py OUT --seeds 1 2 3 --evaluations 256 --workers 2

Every seed runs both, annealing under schedules of one, two and four times the evaluations of CMA-ES. The target is the energy
that CMA-ES came to, plus a margin of 5 % of what it gained from its first generation; counted is the generation after which the
best sample is at or below it. OUT: a reconstruction up to stage `body`.
"""

import argparse
import csv
import io
import statistics
from pathlib import Path

import doublet as d
from doublet import pipeline, study

FACTORS = (1, 2, 4)


def trace(job: dict) -> list:
    """[evaluations, best energy so far] after every generation of the first region."""
    made = study.reconstruction(job)
    observations = d.read_observations(made.path("observations.npz"))
    options = pipeline.fit_options(made)
    context = d.Context(threads=job["threads"])
    result = d.estimate_material(made.simulator(), made.performance(), observations, options, context)
    return [[row.evaluations, row.best] for row in result.log if row.part == 0]


def reached(steps: list, target: float) -> float:
    return next((evaluations for evaluations, best in steps if best <= target), float("inf"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--evaluations", type=int, default=256)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--results", type=Path, help="rows of an earlier run are not repeated")
    arguments = parser.parse_args()
    base = {"fit.influence": False}
    sets = [{**base, "fit.optimizer": "cma-es", "fit.max_evaluations": arguments.evaluations}]
    sets += [{**base, "fit.optimizer": "annealing", "fit.max_evaluations": k * arguments.evaluations} for k in FACTORS]
    jobs = study.fit_jobs([arguments.out], arguments.seeds, sets)
    rows = study.run(trace, jobs, study.local_workers(arguments.workers), arguments.results)
    steps = {}
    for row in rows:
        options = row["job"]["options"]
        steps[options["fit.optimizer"], options["fit.max_evaluations"], row["job"]["seed"]] = row["result"]

    text = io.StringIO()
    table = csv.writer(text, delimiter="\t")
    table.writerow(["seed", "target px^2", "cma-es", *(f"annealing, {k} x" for k in FACTORS)])
    ratios = {k: [] for k in FACTORS}
    for seed in arguments.seeds:
        own = steps["cma-es", arguments.evaluations, seed]
        target = own[-1][1] + 0.05 * (own[0][1] - own[-1][1])
        needed = reached(own, target)
        annealed = [reached(steps["annealing", k * arguments.evaluations, seed], target) for k in FACTORS]
        table.writerow([seed, f"{target:.2f}", needed, *annealed])
        for k, count in zip(FACTORS, annealed):
            ratios[k].append(count / needed)
    print(text.getvalue(), end="")
    for k in FACTORS:
        print(f"annealing over {k} x {arguments.evaluations} evaluations: median ratio {statistics.median(ratios[k]):.2f}")


if __name__ == "__main__":
    main()
