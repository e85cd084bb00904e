"""Whether the material search finds the minimum from every seed, and whether its error bars are true.

python benchmarks/search_reliability.py OUT... [--seeds 20] [--workers 2 | --dask ADDRESS] [--work DIR]
python benchmarks/search_reliability.py OUT --films 40 [--seeds 1] ...

The first searches every OUT (a reconstruction up to stage 'garment') from each seed: how many end within 5 % of the lowest
energy known, how far the answers spread in units of the interval that they state, evaluations and seconds. An energy is the mean
of eight simulations that differ by chaos alone.

The second films the character of OUT in that many materials, so that the truth is known: the six of the paper's Table 1, ten from
the corners and edges of the box, the others anywhere in it (of cloth: k_stretch above 0.988); and prints in how many of them the
truth lies inside the 90 % interval, parameter by parameter, beside the same table. `--frames`, `--cameras`: of the films.
Results are kept in DIR; a run that was stopped goes on.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation import study

sys.path.insert(0, str(Path(__file__).parent / "sect7"))
from filmed import Filming, filmed  # noqa: E402
from reconstructions import NAMES, markdown, table_1  # noqa: E402

NEAR = 0.05  # of the lowest energy known
EDGES = 10


def materials(count: int) -> list[d.Material]:
    """Table 1, then edges and corners of the box, then any."""
    random, space = np.random.default_rng(7), d.ParameterSpace()
    found = list(table_1().values())[:count]
    while len(found) < count:
        unit = random.random(len(NAMES))
        stretch = 1 - 0.33 * random.random()  # k_stretch above 0.988
        if len(found) < len(table_1()) + EDGES:
            on_edge = random.random(len(NAMES)) < 0.6
            unit = np.where(on_edge, unit > 0.5, unit)
            stretch = 1.0
        unit[NAMES.index("k_stretch")] = stretch
        found.append(space.material(unit))
    for material in found:
        material.k_damping = space.fixed.k_damping
    return found


def near(rows: list[dict]) -> dict[str, list[dict]]:
    """OUT -> results of its searches, of the first region."""
    found: dict[str, list[dict]] = {}
    for row in rows:
        if "error" in row:
            raise RuntimeError(f"{row['job']['out']}, seed {row['job']['seed']}: {row['error']}")
        found.setdefault(row["job"]["out"], []).append({**row["result"]["regions"][0], "seconds": row["seconds"]})
    return found


def reliability(found: dict[str, list[dict]]) -> str:
    header = ["", "seeds", "lowest, px²", "within 5 %", "median, worst over the lowest", "evaluations", "s"]
    header += [f"{name}: spread over stated" for name in next(iter(found.values()))[0]["interval"]]
    table = []
    for out, results in found.items():
        energies = np.array([r["energy"] for r in results])
        lowest = energies.min()
        over = energies / lowest - 1
        spreads = []
        for name in results[0]["interval"]:
            answers = np.array([r["answer"][name] for r in results])
            half = np.median([np.ptp(r["interval"][name]) / 2 for r in results])
            spreads.append(f"{1.645 * answers.std() / half:.2f}" if half > 0 else "-")
        table.append(
            [Path(out).name, len(results), f"{lowest:.1f}", f"{100 * (over <= NEAR).mean():.0f} %",
             f"{100 * np.median(over):.1f} %, {100 * over.max():.1f} %",
             f"{np.median([r['evaluations'] for r in results]):.0f}, at most {max(r['evaluations'] for r in results)}",
             f"{np.median([r['seconds'] for r in results]):.0f}", *spreads]
        )  # fmt: skip
    return markdown(header, table)


def coverage(found: dict[str, list[dict]], truths: dict[str, d.Material]) -> str:
    """In how many searches the truth is inside the interval; a truth on a face of the box may lie 0.02 outside of it."""
    space, rows = d.ParameterSpace(), []
    for i, name in enumerate(NAMES):
        inside, lengths, errors = [], [], []
        for out, results in found.items():
            truth = float(space.unit(truths[out])[i])
            for result in results:
                low, high = result["interval"][name]
                slack = 0.02 if truth < 0.02 or truth > 0.98 else 0
                inside.append(low - slack <= truth <= high + slack)
                lengths.append(high - low)
                errors.append(abs(result["answer"][name] - truth))
        rows.append(
            [name, f"{100 * np.mean(inside):.0f} % of {len(inside)}", float(np.median(lengths)), float(np.median(errors))]
        )
    return markdown(
        ["parameter", "truth inside the 90 % interval", "median length, of the box", "median error, of the box"], rows
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("outs", type=Path, nargs="+", metavar="OUT")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--films", type=int, default=0, metavar="N", help="search N films of known materials instead")
    parser.add_argument("--frames", type=int, default=-1, help="of the films (default: all)")
    parser.add_argument("--cameras", type=int, default=0, help="of the films (default: all)")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--threads", type=int, default=1, help="of a worker")
    parser.add_argument("--dask", metavar="ADDRESS", help="of a scheduler, in the place of workers here")
    parser.add_argument("--work", type=Path, default=Path("out/search_reliability"))
    arguments = parser.parse_args()

    outs, truths, options = [out.resolve() for out in arguments.outs], {}, {}
    if arguments.films:
        how = Filming(cameras=arguments.cameras, frames=arguments.frames, perfect=True)
        films = []
        for truth in materials(arguments.films):
            folder, options = filmed(outs[0], None, truth, how, arguments.work.resolve())
            films.append(folder)
            truths[str(folder)] = truth
        outs = films
    fps = study.plain_job(arguments.outs[0], {}, None, 1)["fps"]
    seeds = range(1, arguments.seeds + 1)
    jobs = study.fit_jobs(outs, seeds, [options], fps=fps if truths else None, threads=arguments.threads)
    executor = study.dask_workers(arguments.dask) if arguments.dask else study.local_workers(arguments.workers)

    def show(row, done, count):
        print(f"  {done}/{count}, {row['seconds']:.0f} s", file=sys.stderr, flush=True)

    found = near(study.run(study.fit, jobs, executor, arguments.work / "rows.jsonl", on_row=show))
    print(reliability(found))
    if truths:
        print("\n" + coverage(found, truths))


if __name__ == "__main__":
    main()
