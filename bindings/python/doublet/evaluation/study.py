"""Studies: many fits or evaluations, over sessions, seeds, options or materials, through any `concurrent.futures.Executor`.

A job is a dict of paths and plain values, so that it travels to other processes and machines; its results are too. `run` is the
loop: results are written as they come, a job whose worker died is sent again, a restarted study skips what is done. See
docs/studies.md.
"""

from __future__ import annotations

import concurrent.futures
import copy
import hashlib
import json
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby, product
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import read_json, write_text
from ..reconstruct import OPTION_GROUPS, make_options, recorded_session

#: Of this module in files of results of doublet 0.1, and now: a study goes on with them.
FORMER_NAME = ("doublet.study.", f"{__name__}.")
INPUTS = ("actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "proxies.json", "garment.npz")


# --- the loop


def run(
    function: Callable[[dict], object],
    jobs: Iterable[dict],
    executor,
    results: Path | None = None,
    attempts: int = 3,
    on_row: Callable[[dict, int, int], None] | None = None,
    batch: int = 16,
) -> list[dict]:
    """One row a job, in the order of the jobs: {"function", "job", "result" or "error", "seconds"}.

    function: importable by name in the workers, job -> plain values. executor: an Executor, or a function that makes one (then a
    pool that broke is made again). results: a file of JSON lines; jobs that it has results of are not run again. What a job
    raises is its row's "error"; it is tried again by the next study. A worker that dies costs time only: its jobs are sent again,
    and when a round brings nothing one at a time; a job that is lost `attempts` times when alone gets an "error", too.
    on_row(row, done, all): after every new row.
    batch: how many jobs a worker gets at once, if the function has an attribute `together`, jobs -> their results, which is
    quicker than one by one.
    """
    jobs = list(jobs)
    name = name_of(function, results)
    keys = [key_of(name, job) for job in jobs]
    rows = read_rows(results) if results else {}
    waiting = list({k: job for k, job in zip(keys, jobs) if k not in rows}.items())
    alone = 0  # rounds without any result
    while waiting:
        lost = []
        with opened(executor) as pool:
            size = batch if hasattr(function, "together") and not alone else 1
            for entries, answers in replies(pool, function, batches(waiting[:1] if alone else waiting, size)):
                if isinstance(answers, BaseException):
                    lost.append(answers)
                    if alone < attempts:
                        continue
                    text = f"its worker was lost {alone} times, at last with {type(answers).__name__}: {answers}"
                    answers = [{"error": text, "seconds": 0.0}]
                for (key, job), answer in zip(entries, answers):
                    rows[key] = {"function": name, "job": job, **answer}
                    append_row(results, rows[key])
                    if on_row:
                        on_row(rows[key], sum(k in rows for k in keys), len(keys))
        before, waiting = len(waiting), [(k, job) for k, job in waiting if k not in rows]
        alone = 0 if len(waiting) < before else alone + 1
    if results:
        ordered = {k: rows[k] for k in keys}
        write_text(results, "".join(json.dumps(row) + "\n" for row in {**ordered, **rows}.values()))
    return [rows[k] for k in keys]


def name_of(function: Callable, results: Path | None) -> str:
    """Raises ValueError for one without a name of its own if a file keeps results: they would be taken for those of another."""
    name = getattr(function, "__qualname__", f"<{type(function).__name__}>")
    if results and "<" in name:
        raise ValueError(f"{results}: expected results of a function that can be imported by its name, found {name}")
    return f"{function.__module__}.{name}"


def batches(entries: list, size: int) -> list[list]:
    return [entries[i : i + size] for i in range(0, len(entries), size)]


def key_of(function: str, job: dict) -> str:
    """Where a job leaves what it has is not what it is: that folder is named after the file of results, which may be renamed."""
    return json.dumps([function, {name: value for name, value in job.items() if name != "checkpoints"}], sort_keys=True)


def read_rows(path: Path) -> dict[str, dict]:
    """Results of earlier studies by key. Errors are left out, and a line that a killed study did not finish. Raises RuntimeError
    for a file of something else, which stays as it is."""
    rows = {}
    if not Path(path).exists():
        return rows
    for line in Path(path).read_text(encoding="utf-8").split("\n"):
        try:
            row = json.loads(line)
        except ValueError:
            row = {"error": "cut off"} if line[:1] in ("", "{") else None
        if not isinstance(row, dict) or not ("error" in row or {"function", "job"} <= row.keys()):
            raise RuntimeError(f"{path}: expected results of a study, an object a line, found '{line[:40]}'; give another name")
        if "error" not in row:
            row["function"] = row["function"].replace(*FORMER_NAME)
            rows[key_of(row["function"], row["job"])] = row
    write_text(path, "".join(json.dumps(row) + "\n" for row in rows.values()))
    return rows


def append_row(path: Path | None, row: dict) -> None:
    if path is None:
        return
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with Path(path).open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(row) + "\n")
        stream.flush()
        os.fsync(stream.fileno())


@contextmanager
def opened(executor):
    """The executor; one that is made here is closed here, at once if something failed."""
    if isinstance(executor, concurrent.futures.Executor):
        yield executor
        return
    others = set(multiprocessing.active_children())
    pool = executor()
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False)
        for worker in set(multiprocessing.active_children()) - others:
            worker.terminate()  # the end of this process would wait for its job
        raise
    pool.shutdown()


def replies(pool, function, groups):
    """(entries, answers) as they come: what `attempt` returns, or the exception of a lost worker."""
    sent = {}
    try:
        for entries in groups:
            try:
                sent[pool.submit(attempt, function, [job for _, job in entries])] = entries
            except concurrent.futures.BrokenExecutor:
                break  # what is not sent stays waiting
        if not sent:
            raise RuntimeError("study: the executor is broken; give a function that makes one, so that it can be made again")
        for future in concurrent.futures.as_completed(sent):
            error = concurrent.futures.CancelledError() if future.cancelled() else future.exception()
            yield sent[future], error or future.result()
    finally:
        for future in sent:
            future.cancel()


def attempt(function, jobs: list[dict]) -> list[dict]:
    """In the worker. Errors of a job come back as values, so that every other exception means a lost worker."""
    start = time.monotonic()
    if len(jobs) > 1:
        try:
            found = function.together(jobs)
            seconds = round((time.monotonic() - start) / len(jobs), 3)
            return [{"result": result, "seconds": seconds} for result in found]
        except Exception:
            pass  # of one of them: alone, each has its own
    return [attempt_one(function, job) for job in jobs]


def attempt_one(function, job: dict) -> dict:
    start = time.monotonic()
    try:
        reply = {"result": function(job)}
    except Exception as error:
        reply = {"error": f"{type(error).__name__}: {error}"}
    return {**reply, "seconds": round(time.monotonic() - start, 3)}


# --- executors


def local_workers(count: int):
    """Makes pools of `count` processes on this machine."""
    fresh = multiprocessing.get_context("spawn")  # forks of a process with threads may hang
    quiet = {
        "initializer": signal.signal,
        "initargs": (signal.SIGINT, signal.SIG_DFL),
    }  # Ctrl-C ends a worker without a traceback
    return lambda: concurrent.futures.ProcessPoolExecutor(count, fresh, **quiet)


def dask_workers(address: str):
    """The workers of a Dask scheduler (`pip install distributed`), e.g. "tcp://host:8786"."""
    from distributed import Client

    return Client(address).get_executor(pure=False)


# --- jobs


def plain_job(out: Path, options: dict, fps: float | None, threads: int) -> dict:
    """What every job says: where its inputs are, what they were, and how to use them."""
    out = Path(out).resolve()
    for name in INPUTS:
        if not (out / name).exists():
            raise FileNotFoundError(f"{out / name} is missing; a study needs a reconstruction up to stage 'garment'")
    if fps is None:
        session = recorded_session(out)
        fps = float(read_json(session / "session.json")["fps"])
    job = {"out": str(out), "inputs": inputs_hash(out), "fps": fps, "threads": threads, "options": dict(options)}
    option_groups(job)  # wrong names and values are found now
    return job


def inputs_hash(out: Path) -> str:
    return " ".join(d.hash_files(Path(out) / name)[:16] for name in INPUTS)


def option_groups(job: dict) -> dict:
    """{"fit.seed": 2} -> {"fit": FitOptions(seed=2)}, for all groups of the pipeline."""
    chosen: dict[str, dict] = {}
    for name, value in job["options"].items():
        group, _, field = name.partition(".")
        if group not in OPTION_GROUPS or not field:
            raise ValueError(f"option '{name}': expected GROUP.FIELD with a group of {', '.join(OPTION_GROUPS)}")
        chosen.setdefault(group, {})[field] = value
    return {g: make_options(g, c, **chosen.get(g, {})) for g, c in OPTION_GROUPS.items()}


def fit_jobs(
    outs, seeds=(1,), options=({},), fps: float | None = None, threads: int = 1, checkpoints: Path | None = None
) -> list[dict]:
    """One job for `fit` per OUT folder, option set and seed. options: sets like {"fit.max_evaluations": 64}. fps: of the video,
    None = as the session of each folder says. checkpoints: folder in which killed fits leave what they had, to go on from
    there."""
    jobs = []
    for out, chosen in product(outs, options):
        base = plain_job(out, chosen, fps, threads)
        for seed in seeds:
            job = {**base, "seed": int(seed)}
            if checkpoints is not None:
                job["checkpoints"] = str(Path(checkpoints).resolve())
            jobs.append(job)
    return jobs


def energy_jobs(outs, materials, options=({},), fps: float | None = None, threads: int = 1) -> list[dict]:
    """One job for `energy` per OUT folder, option set and sample. materials: samples, each a list with one Material a region, or
    a dict of its parameters; e.g. those that other sessions were estimated to have (cross-validation). The garment of each OUT is
    as wide as its material.json says, the middle width without one."""
    plain = [[m if isinstance(m, dict) else m.to_dict() for m in sample] for sample in materials]
    bases = [{**plain_job(out, chosen, fps, threads), "widths": widths_of(out)} for out, chosen in product(outs, options)]
    return [{**base, "materials": sample} for base, sample in product(bases, plain)]


def widths_of(out: Path) -> list[float]:
    material = Path(out) / "material.json"
    return d.read_widths(material) if material.exists() else []


@dataclass
class Film:
    """What a fit needs of a reconstruction: its results, and the options of a job."""

    results: d.Results
    options: dict  # option group -> options object
    seed: int
    fps: float

    @property
    def solver(self) -> d.SolverSettings:
        """Without which the materials mean nothing."""
        return d.SolverSettings(1 / self.fps, self.options["cloth"])

    def simulator(self) -> d.CharacterSimulator:
        return self.results.simulator(self.options["cloth"])

    def fit_options(self) -> d.FitOptions:
        options = copy.copy(self.options["fit"])
        options.energy, options.space, options.seed = self.options["energy"], self.options["space"], self.seed
        return options


def film_of(job: dict) -> Film:
    if inputs_hash(job["out"]) != job["inputs"]:
        raise ValueError(f"{job['out']}: the files are not those that the study was made for")
    made = Film(d.Results(job["out"]), option_groups(job), job.get("seed", 1), job["fps"])
    if "widths" in job:
        made.results.set_widths(job["widths"])
    return made


def fit(job: dict) -> dict:
    """Estimates the material; what material.json says, without file."""
    made = film_of(job)
    options = made.fit_options()
    if "checkpoints" in job:
        options.checkpoint = Path(job["checkpoints"]) / f"{checkpoint_name(job)}.json"
    result = d.estimate_material([made.results.take(made.solver)], options, d.Context(threads=job["threads"]))
    if "checkpoints" in job:
        options.checkpoint.unlink(missing_ok=True)
    return plain_fit(result)


def checkpoint_name(job: dict) -> str:
    return hashlib.sha256(json.dumps(job, sort_keys=True).encode()).hexdigest()[:24]


def plain_fit(result: d.FitResult) -> dict:
    values = result.to_dict()
    regions = []
    for region in values["regions"]:
        names, posterior = values["parameters"], region["posterior"]
        regions.append(
            {
                "parameters": region["material"].to_dict(),
                "width": region["width"],
                "energy": region["energy"],
                "energy_noise": region["energy_noise"],
                "energy_at_centre": region["energy_at_centre"],
                "best_sample": {"parameters": region["best"].to_dict(), "energy": region["best_energy"]},
                "answer": dict(zip(names, region["answer"].tolist())),
                "interval": dict(zip(names, np.asarray(posterior.interval).tolist())),
                "deviations": dict(zip(names, region["deviations"].tolist())),
                "confidence": dict(zip(names, region["confidence"])),
                "evaluations": region["evaluations"],
                "stop_reason": region["stop_reason"],
            }
        )
    return {"regions": regions}


def energy(job: dict) -> list[float]:
    """E_fit of one material a region, pixels^2."""
    return energies([job])[0]


def energies(jobs: list[dict]) -> list[list[float]]:
    """The same of many jobs: samples for the same images are simulated side by side, in a fraction of the time."""
    found = []
    for base, same in groupby(jobs, lambda job: json.dumps({k: v for k, v in job.items() if k != "materials"}, sort_keys=True)):
        _, objective = opened_objective(base)
        samples = [[d.Material(**material) for material in job["materials"]] for job in same]
        found += objective.energies(samples, d.Context(threads=json.loads(base)["threads"])).tolist()
    return found


energy.together = energies


@lru_cache(maxsize=1)
def opened_objective(job: str) -> tuple:
    """Kept in the worker: the next job is often about the same images."""
    made = film_of(json.loads(job))
    simulator = made.simulator()
    observations = made.results.observations()
    return simulator, d.MaterialObjective(
        simulator, made.results.dressed_performance(), observations, made.solver.dt, made.options["energy"]
    )


def table(rows: list[dict]) -> str:
    """Results of fits for people: a line per job and region."""
    lines = []
    for row in rows:
        where = f"{Path(row['job']['out']).name}, seed {row['job'].get('seed', '-')}"
        options = ", ".join(f"{k} {v}" for k, v in row["job"]["options"].items())
        where += f", {options}" if options else ""
        if "error" in row:
            lines.append(f"{where}: {row['error']}")
            continue
        for k, region in enumerate(row["result"]["regions"]):
            values = ", ".join(f"{n} {v:.4g}" for n, v in region["parameters"].items() if n in region["deviations"])
            lines.append(f"{where}, region {k}: E_fit {region['energy']:.2f} px^2, {values}")
    return "\n".join(lines)
