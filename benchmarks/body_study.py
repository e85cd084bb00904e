"""Fit of people left out of training: naked, with parts missing, with wrong marks, in other poses, and dressed.

python benchmarks/body_study.py POPULATION.npz [--people 24] [--only naked skirt]
"""

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from body_subjects import Population, Subject, away, band, dressed, naked, with_hair_and_shoes, with_holes, without
from doublet import _doublet as d

LEFT_OUT = 24
TURN = np.radians(25)


def turned(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """25 degrees more at every large joint; knees only bend the way they can."""
    turns = {f"{s}_{n}": away(rng, TURN) for s in "lr" for n in ("shoulder", "elbow")}
    turns |= {f"{s}_hip": np.array([rng.choice([-1, 1]) * TURN, 0, 0]) for s in "lr"}
    turns |= {f"{s}_knee": np.array([TURN, 0, 0]) for s in "lr"}
    return turns | {"spine1": away(rng, TURN)}


def without_band(subject: Subject, rng) -> Subject:
    return without(subject, band(subject))


#: Name -> (naked subject, random numbers) -> subject.
CASES = {
    "naked": lambda s, rng: s,
    "hip to knee missing": without_band,
    "marks 30 mm off": lambda s, rng: replace(s, marks_off=0.03),
    "25 degrees": None,  # another pose, made from the population itself
    "15 holes": with_holes,
    "hair and shoes": lambda s, rng: with_hair_and_shoes(s),
    "tight trousers": lambda s, rng: dressed(s, "trousers", 0.006, rng),
    **{g.replace("_", " "): (lambda s, rng, g=g: dressed(s, g, 0.03, rng))
       for g in ("skirt", "trousers", "shirt", "dress", "long_dress", "overall")},
}  # fmt: skip


def make(people: Population, mesh: int, case: str, rng: np.random.Generator) -> Subject:
    if case == "25 degrees":
        return naked(people, mesh, turned(rng))
    return CASES[case](naked(people, mesh), rng)


def measure(subject: Subject, model, rng) -> dict[str, float]:
    actor, clothness, landmarks = subject.actor(rng)
    start = time.perf_counter()
    fit = d.BodyFitter.create().fit(actor, clothness, model, landmarks)
    found = {"seconds": time.perf_counter() - start}
    vertex = 1000 * np.linalg.norm(fit.body.vertices - subject.truth, axis=1)
    surface = 1000 * d.distances_to_surface(subject.truth, fit.body)
    found |= {"surface": surface.mean(), "vertex": vertex.mean()}
    if subject.hidden.any():
        found |= {"hidden surface": surface[subject.hidden].mean(), "hidden vertex": vertex[subject.hidden].mean()}
    if (subject.segmentation > 0).any():
        capsules = d.proxy_statistics(d.fit_proxies(fit, actor, clothness), fit, actor, clothness)
        found |= {"capsules": 1000 * capsules.mean_distance, "capsules 95 %": 1000 * capsules.percentile95}
        found["clearance"] = 1000 * capsules.cloth_clearance
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("population", type=Path)
    parser.add_argument("--people", type=int, default=LEFT_OUT, help=f"how many of the {LEFT_OUT} left out are fitted")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    arguments = parser.parse_args()
    if not 1 <= arguments.people <= LEFT_OUT:
        parser.error(f"--people: expected 1 to {LEFT_OUT}, found {arguments.people}")
    people = Population(arguments.population)
    left_out = np.sort(np.random.default_rng(1).permutation(people.people)[:LEFT_OUT])
    options = d.TrainOptions(individuals=[i for i in range(people.people) if i not in left_out])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.npz"
        start = time.perf_counter()
        d.train_body_model(arguments.population, file, options)
        print(f"training: {time.perf_counter() - start:.1f} s; mm, mean over people (worst person)")
        model = d.BodyModel.read(file)
    for case in arguments.only:
        rows = []
        for k in range(arguments.people):
            rng, own = np.random.default_rng(k), np.flatnonzero(people.individual == left_out[k])
            rows.append(measure(make(people, own[k % len(own)], case, rng), model, rng))
        shown = []
        for name in rows[0]:
            values = [row[name] for row in rows]
            worst = min(values) if name == "clearance" else max(values)
            shown.append(f"{name} {np.mean(values):.1f} ({worst:.1f})")
        print(f"{case:<20}", ", ".join(shown), flush=True)


if __name__ == "__main__":
    main()
