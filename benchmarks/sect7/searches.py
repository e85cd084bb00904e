"""Searches: the energy around the answer, the answer from other starts, the answer of another optimiser."""

import json
import statistics
import time
from pathlib import Path

import doublet as d
import matplotlib
import numpy as np
from doublet.common.console import Console
from doublet.evaluation import metrics as evaluate
from doublet.evaluation import study
from reconstructions import NAMES, energies, energy_job, estimate, markdown, plain_job, run, simulate

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FACTORS = (1, 2, 4)
#: What the search offers beyond the paper: name -> groups of options.
VARIANTS = {
    "as the paper": {},
    "search in the box itself": {"space": {"warp_parameters": False}},
    "windows of 40 frames": {"energy": {"window": 40}},
    "penalty omega 256": {"fit": {"penalty": 256}},
    "population 16": {"fit": {"population": 16}},
    "CMA-ES": {"fit": {"optimizer": "cma-es"}},
}


def search(job: dict) -> dict:
    """An estimation: study.fit, and the first region's evaluations, best energy so far and mean (box units) after every
    generation. job["start"] and job["sigma"], if there: the first distribution of CMA-ES, box units."""
    made = study.film_of(job)
    options = made.fit_options()
    if "start" in job:
        options.make_optimizer = lambda n, seed: cma_from(padded(job["start"], n), job["sigma"], seed, options)
    take, context = made.results.take(made.solver), d.Context(threads=job["threads"])
    start = time.monotonic()
    result = d.estimate_material([take], options, context)
    seconds = time.monotonic() - start
    steps = [[row.evaluations, row.best, row.mean.ravel().tolist()] for row in result.log if row.part == 0]
    return {**study.plain_fit(result), "steps": steps, "seconds": seconds}


def padded(start: list[float], count: int) -> list[float]:
    """The width of a garment that offers several is a coordinate behind those of the material: it begins in the middle."""
    return [*start, *[0.5] * (count - len(start))]


def cma_from(start: list[float], sigma: float, seed: int, options: d.FitOptions) -> d.Optimizer:
    """CMA-ES with a mean of its own along every axis: its state before the first generation, moved."""
    chosen = d.CmaEsOptions(initial_sigma=sigma, max_evaluations=options.max_evaluations, seed=seed)
    chosen.population, chosen.min_deviation = options.population, options.min_deviation
    optimizer = d.create_cma_es(len(start), chosen)
    optimizer.restore(json.dumps({**json.loads(optimizer.save()), "mean": list(start)}))
    return optimizer


def variants(out: Path, session, truth_folder: Path | None, evaluations: int, seeds: list[int], work: Path, workers: int):
    """Beyond the paper: the same budget under each switch of the search. All answers are compared by the plain energy, and by the
    distance to the true garment where there is one; seconds are of one estimation on `workers` threads, no other beside it."""
    jobs = []
    for groups in VARIANTS.values():
        chosen = {**groups, "fit": {"max_evaluations": evaluations, **groups.get("fit", {})}}
        jobs += [{**plain_job(out, session, threads=workers, **chosen), "seed": seed} for seed in seeds]
    results = run(search, jobs, work, 1)
    base = plain_job(out, session)
    rows = []
    for name, job, found in zip([name for name in VARIANTS for _ in seeds], jobs, results):
        means = [d.Material(**region["parameters"]) for region in found["regions"]]
        bests = [d.Material(**region["best_sample"]["parameters"]) for region in found["regions"]]
        costs = [sum(cost) for cost in run(energies, [energy_job(base, [means, bests])], work, 1)[0]]
        apart = [resim_cm(out, base, truth_folder, materials) if truth_folder else "" for materials in (means, bests)]
        rows.append([name, job["seed"], found["seconds"], *costs, *apart])
    header = [
        "search",
        "seed",
        "s",
        "E_fit of the answer, px^2",
        "of the best sample",
        "resim_cloth_cm of the answer",
        "of the best sample",
    ]
    print(markdown(header, rows))
    return rows


def resim_cm(out: Path, base: dict, truth_folder: Path, materials: list[d.Material]) -> float:
    recon, truth = evaluate.Reconstruction(out), evaluate.Truth(truth_folder)
    moving = recon.animated(simulate(study.film_of(base), materials))
    return evaluate.cloth_rms_cm(moving, truth, 2, Console(quiet=True).context(), "re-animation")


def landscape(out: Path, session, size: int, work: Path, workers: int):
    """Fig. 5a: E_fit over (d_n, k_bend), all other parameters at the estimate; a picture a cloth region."""
    own, axis, jobs = estimate(out), np.linspace(0, 1, size), []
    spaces = [d.ParameterSpace(names=["d_n", "k_bend"], fixed=m) for m in own]
    base = plain_job(out, session)
    for bend in axis:
        jobs.append(energy_job(base, [[space.material([x, bend]) for space in spaces] for x in axis]))
    (at_estimate,) = run(energies, [energy_job(base, [own])], work, 1)[0]
    costs = np.array(run(energies, jobs, work, workers))  # (k_bend, d_n, region)
    rows, files = [], []
    for region, (space, found) in enumerate(zip(spaces, own)):
        cost = costs[:, :, region]
        row, column = np.unravel_index(cost.argmin(), cost.shape)
        lowest = space.material([axis[column], axis[row]])
        local = sum(is_local_minimum(cost, i, j) for i in range(size) for j in range(size))
        rows.append([region, at_estimate[region], float(cost.min()), lowest.d_n, lowest.k_bend, float(cost.max()), local])
        files.append(work / f"landscape_{region}.png")
        draw_landscape(files[-1], axis, cost, space, found)
    print(markdown(["region", "at the estimate, px^2", "lowest", "its d_n", "its k_bend", "highest", "local minima"], rows))
    print("\n" + "\n".join(map(str, files)))
    return costs


def is_local_minimum(cost: np.ndarray, i: int, j: int) -> bool:
    around = cost[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2]
    return bool(cost[i, j] == around.min() and (around > cost[i, j]).sum() == around.size - 1)


def draw_landscape(file: Path, axis: np.ndarray, cost: np.ndarray, space: d.ParameterSpace, found: d.Material) -> None:
    drag = [space.material([x, 0]).d_n for x in axis]
    bend = [space.material([0, x]).k_bend for x in axis]
    figure, axes = plt.subplots(figsize=(5.2, 4.2))
    drawn = axes.contourf(drag, bend, cost, levels=24)
    axes.plot(found.d_n, found.k_bend, "r+", markersize=14, markeredgewidth=2, label="estimate", clip_on=False)
    axes.set(xlabel="$d_n$, 1/m", ylabel="$k_{bend}$")
    axes.legend(loc="upper right")
    figure.colorbar(drawn, label="$E_{fit}$, px$^2$")
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)


def robustness(out: Path, session, starts: int, evaluations: int, work: Path, workers: int):
    """Fig. 5b: estimations that begin with other distributions: means anywhere in the middle 70 % of the box, deviations from
    0.15 to 0.4 of it."""
    random, jobs = np.random.default_rng(1), []
    base = plain_job(out, session, fit={"max_evaluations": evaluations})
    for k in range(starts):
        start, sigma = random.uniform(0.15, 0.85, len(NAMES)), random.uniform(0.15, 0.4)
        jobs.append({**base, "seed": k + 1, "start": start.round(4).tolist(), "sigma": round(float(sigma), 4)})
    results = run(search, jobs, work, workers)
    rows = []
    for job, result in zip(jobs, results):
        for k, region in enumerate(result["regions"]):
            start = " ".join(f"{x:.2f}" for x in job["start"])
            values = [float(region["parameters"][name]) for name in NAMES]
            rows.append([start, float(job["sigma"]), k, region["evaluations"], region["energy"], *values])
    print(markdown(["start, of the box", "sigma", "region", "evaluations", "E_fit, px^2", *NAMES], rows))
    file = work / "robustness.png"
    draw_robustness(file, [result["steps"] for result in results])
    print(f"\n{file}")
    return results


def draw_robustness(file: Path, runs: list[list]) -> None:
    """The best energy so far, and the mean of every parameter (the paper shows that of k_friction), first region."""
    figure, panels = plt.subplots(2, 3, figsize=(11, 6), sharex=True)
    for steps in runs:
        evaluations = [row[0] for row in steps]
        panels.flat[0].plot(evaluations, [row[1] for row in steps])
        for k, axes in enumerate(panels.flat[1:]):
            axes.plot(evaluations, np.clip([row[2][k] for row in steps], 0, 1))  # as the answer is
    panels.flat[0].set_yscale("log")
    for name, axes in zip(("best $E_{fit}$ so far, px$^2$", *NAMES), panels.flat):
        axes.set_title(name)
        axes.grid(alpha=0.3)
    for axes in panels.flat[1:]:
        axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel("mean, of the box")
    for axes in panels[1]:
        axes.set_xlabel("evaluations")
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)


def reached(steps: list, target: float) -> float:
    return next((evaluations for evaluations, best, _ in steps if best <= target), float("inf"))


def annealing(out: Path, session, seeds: list[int], evaluations: int, work: Path, workers: int):
    """Sect. 6.2: evaluations that simulated annealing needs to reach the energy of CMA-ES (the paper: 2-4 times as many), under
    schedules of one, two and four times its evaluations. The target is the energy that CMA-ES came to, plus 5 % of what it gained
    from its first generation; counted is the generation after which the best sample is at or below it."""
    sets = [{"optimizer": "cma-es", "max_evaluations": evaluations}]
    sets += [{"optimizer": "annealing", "max_evaluations": k * evaluations} for k in FACTORS]
    bases = [plain_job(out, session, fit=chosen) for chosen in sets]
    results = run(search, [{**base, "seed": seed} for seed in seeds for base in bases], work, workers)
    rows, ratios = [], []
    for k, seed in enumerate(seeds):
        own, *annealed = (result["steps"] for result in results[k * len(sets) : (k + 1) * len(sets)])
        target = own[-1][1] + 0.05 * (own[0][1] - own[-1][1])
        needed = [reached(steps, target) for steps in (own, *annealed)]
        rows.append([seed, target, *map(str, needed)])
        ratios.append([count / needed[0] for count in needed[1:]])
    print(markdown(["seed", "target px^2", "cma-es", *(f"annealing, {k} x" for k in FACTORS)], rows), "\n")
    for k, counts in zip(FACTORS, zip(*ratios)):
        print(f"annealing over {k} x {evaluations} evaluations: median ratio {statistics.median(counts):.2f}")
    return ratios
