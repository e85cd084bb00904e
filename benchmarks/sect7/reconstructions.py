"""What the claims share: a reconstruction with the options it was made with, rival materials, energies, errors, tables."""

import json
import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation import study

NAMES = ("d_n", "d_t", "k_bend", "k_stretch", "k_friction")  # in the paper's order
#: Table 1. Its column "d_t (x 10^3)" is read as it stands, see docs/results.md.
TABLE_1 = {
    "1a": (7.054, 0.119, 0.195, 1.0, 0.129),
    "1b": (5.198, 0.553, 0.134, 1.0, 0.401),
    "2": (0.876, 1.603, 0.575, 1.0, 0.790),
    "3": (0.774, 0.452, 0.888, 1.0, 0.070),
    "4": (1.184, 0.621, 0.100, 1.0, 0.228),
    "5": (1.727, 3.587, 0.382, 1.0, 0.558),
}
MODEL = ("cloth.", "energy.")  # option groups
SEARCH = (*MODEL, "fit.")
CLOSE = 0.001  # of the box: another material for the solver, the same for everybody else


def material(values) -> d.Material:
    return d.Material(**dict(zip(NAMES, map(float, values))))


def table_1() -> dict[str, d.Material]:
    return {f"Table 1, {name}": material(values) for name, values in TABLE_1.items()}


def box_centre() -> d.Material:
    return d.ParameterSpace().material(np.full(len(NAMES), 0.5))


def stiff_centre() -> d.Material:
    """The box's centre, but for k_stretch: half of it is rubber, which no garment is."""
    centre = box_centre()
    centre.k_stretch = 1.0
    return centre


def nudged(of: d.Material) -> d.Material:
    """`of` moved by CLOSE along d_n: how far two runs come apart that should be one, because the motion is chaotic."""
    space = d.ParameterSpace(fixed=of)
    unit = space.unit(of)
    unit[0] += CLOSE if unit[0] < 0.5 else -CLOSE
    return space.material(unit)


def random_materials(count: int, seed: int) -> list[d.Material]:
    """Stiff cloth: uniform in bending and friction, in drag denser near 0, where cloth is."""
    draws = np.random.default_rng(seed).random((count, 4))
    return [d.Material(d_n=32 * n * n, d_t=32 * t * t, k_bend=b, k_stretch=1.0, k_friction=f) for n, t, b, f in draws]


def recorded_options(out: Path, groups: tuple[str, ...] = MODEL) -> dict:
    """{"cloth.iterations": 6, ...}: how the cloth of OUT was simulated and compared when its material was estimated; with SEARCH
    also how it was searched for."""
    stages = d.RunRecord(out).data.get("stages", {})
    options = stages.get("fit", {}).get("options", {})
    return {name: value for name, value in options.items() if name.startswith(groups)}


def plain_job(out: Path, session: Path | None = None, threads: int = 1, **changed) -> dict:
    """The job of a study of OUT under its own options; changed: cloth={"iterations": 18} and the like."""
    options = recorded_options(out)
    options.update({f"{group}.{name}": value for group, values in changed.items() for name, value in values.items()})
    fps = d.Session(session).fps if session else None
    return study.plain_job(out, options, fps, threads)


def simulate(made: study.Film, materials: list[d.Material]) -> np.ndarray:
    """(T, V, 3) m: the reference motion, animated again."""
    settle = made.options["energy"].settle_frames
    return d.simulate_reference(made.simulator(), made.results.dressed_performance(), materials, 1 / made.fps, settle)


def rms_cm(a: np.ndarray, b: np.ndarray, made: study.Film) -> float:
    """Over the cloth's vertices (clothness > 0.5) and all frames."""
    apart = (a - b)[:, made.results.dressed.segmentation.clothness > 0.5]
    return 100 * float(np.sqrt(np.square(apart).sum(axis=2).mean()))


def energies(job: dict) -> list[list[float]]:
    """E_fit, pixels^2, of job["samples"] (S, regions): `study.energy` for many, that go side by side through the solver."""
    base = {key: value for key, value in job.items() if key != "samples"}
    _, objective = study.opened_objective(json.dumps(base, sort_keys=True))
    samples = [[d.Material(**values) for values in sample] for sample in job["samples"]]
    return objective.energies(samples, d.Context(threads=job["threads"])).tolist()


def energy_job(base: dict, samples: list[list[d.Material]]) -> dict:
    return {**base, "samples": [[m.to_dict() for m in sample] for sample in samples]}


def run(function, jobs: list[dict], work: Path, workers: int) -> list:
    """Results in the order of the jobs; those of an earlier run are taken from work/rows.jsonl."""

    def show(row, done, count):
        print(f"  {done}/{count}, {row['seconds']:.0f} s", file=sys.stderr, flush=True)

    rows = study.run(function, jobs, study.local_workers(workers), work / "rows.jsonl", on_row=show)
    failed = [row["error"] for row in rows if "error" in row]
    if failed:
        raise RuntimeError(f"{len(failed)} of {len(rows)} jobs failed, the first with: {failed[0]}")
    return [row["result"] for row in rows]


def estimate(out: Path) -> list[d.Material]:
    return d.read_materials(Path(out) / "material.json")


def markdown(header: list[str], rows: list[list]) -> str:
    shown = [[f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row] for row in rows]
    lines = [header, ["---"] * len(header), *shown]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
