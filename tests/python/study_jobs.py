"""Jobs that kill their worker, importable by name in the workers."""

import os
import signal
import time
from pathlib import Path

from doublet.evaluation import study


def square(job):
    """Kills its process the first job["deaths"] times; the folder counts."""
    folder = Path(job["folder"])
    runs = folder / f"{job['x']}.runs"
    with runs.open("a") as stream:
        stream.write("x")
    if len(runs.read_text()) <= job.get("deaths", 0):
        os.kill(os.getpid(), signal.SIGKILL)
    if job["x"] == job.get("fails"):
        raise ValueError(f"no square of {job['x']}")
    return job["x"] ** 2


def cube(job):
    return square(job) * job["x"]


def cubes(jobs):
    with (Path(jobs[0]["folder"]) / "calls").open("a") as stream:
        stream.write(f"{len(jobs)}\n")
    return [cube(job) for job in jobs]


cube.together = cubes


def wait(job):
    time.sleep(job["seconds"])


def fit_after_death(job):
    """A fit whose worker is killed in the middle of the search, once: when the first checkpoint is there."""
    checkpoint = Path(job["checkpoints"]) / f"{study.checkpoint_name(job)}.json"
    if job["seed"] == 2 and not checkpoint.exists():
        pid = os.fork()
        if pid == 0:  # the killer
            while not checkpoint.exists():
                pass
            os.kill(os.getppid(), signal.SIGKILL)
            os._exit(0)
    return study.fit(job)
