"""Studies: any executor, workers that die, restarts."""

import concurrent.futures
import json
import multiprocessing
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import doublet as d
import numpy as np
import pytest
import study_jobs
from doublet.evaluation import study

#: The solver of the truth.
BELLS = {"cloth.iterations": 24, "cloth.substeps": 1, "cloth.stiffness": "sweeps", "cloth.rest_curvature": 1.0}
QUICK = {**BELLS, "fit.max_evaluations": 18, "space.names": ["d_n", "k_bend"], "fit.initial_design_size": 16}


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    """Workers import the jobs of this folder."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]))


@pytest.fixture(params=["processes", "threads"])
def executor(request):
    if request.param == "threads":
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            yield pool
    else:
        yield study.local_workers(2)


def squares(folder, count, **more):
    return [{"x": x, "folder": str(folder), **more} for x in range(count)]


def results_of(rows):
    return [row.get("result") for row in rows]


def test_rows_come_in_the_order_of_the_jobs(executor, tmp_path):
    seen = []
    jobs = squares(tmp_path, 8)
    rows = study.run(study_jobs.square, jobs, executor, tmp_path / "rows.jsonl", on_row=lambda *now: seen.append(now[1:]))
    assert results_of(rows) == [x**2 for x in range(8)]
    assert [row["job"] for row in rows] == jobs
    assert seen == [(i + 1, 8) for i in range(8)]
    assert [json.loads(line) for line in (tmp_path / "rows.jsonl").read_text().splitlines()] == rows


@pytest.mark.parametrize("made", [lambda power: lambda job: job["x"] ** power, lambda power: partial(pow, exp=power)])
def test_results_of_a_function_without_a_name_are_not_kept(made, tmp_path):
    """Those of one would be taken for those of another."""
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        with pytest.raises(ValueError, match=r"rows.jsonl: expected results of a function that can be imported by its name"):
            study.run(made(2), [{"x": 3}], pool, tmp_path / "rows.jsonl")
        assert "error" in study.run(partial(pow), [{"x": 3}], pool)[0]
    assert not (tmp_path / "rows.jsonl").exists()


def test_jobs_are_run_together(executor, tmp_path):
    rows = study.run(study_jobs.cube, squares(tmp_path, 8), executor, tmp_path / "rows.jsonl", batch=3)
    assert results_of(rows) == [x**3 for x in range(8)]
    assert sorted((tmp_path / "calls").read_text().split()) == ["2", "3", "3"]
    assert study.run(study_jobs.cube, squares(tmp_path, 8), executor, tmp_path / "rows.jsonl") == rows  # one by one or together


def test_one_that_fails_in_a_batch_fails_alone(tmp_path):
    rows = study.run(study_jobs.cube, squares(tmp_path, 5, fails=3), study.local_workers(1))
    assert results_of(rows) == [0, 1, 8, None, 64]
    assert rows[3]["error"] == "ValueError: no square of 3"


def test_one_that_kills_its_worker_in_a_batch_is_given_up_alone(tmp_path):
    jobs = squares(tmp_path, 5)
    jobs[2]["deaths"] = 99
    rows = study.run(study_jobs.cube, jobs, study.local_workers(1), attempts=2)
    assert results_of(rows) == [0, 1, None, 27, 64]
    assert "worker was lost 2 times" in rows[2]["error"]


def test_a_killed_worker_costs_time_only(tmp_path):
    jobs = squares(tmp_path, 6)
    jobs[2]["deaths"] = 2
    assert results_of(study.run(study_jobs.square, jobs, study.local_workers(2))) == [x**2 for x in range(6)]


def test_a_job_that_always_kills_its_worker_is_given_up_alone(tmp_path):
    jobs = squares(tmp_path, 4)
    jobs[0]["deaths"] = 100
    rows = study.run(study_jobs.square, jobs, study.local_workers(2), attempts=2)
    assert results_of(rows) == [None, 1, 4, 9]
    assert "lost 2 times" in rows[0]["error"] and "BrokenProcessPool" in rows[0]["error"]


def test_a_pool_that_cannot_be_made_again_is_an_error(tmp_path):
    jobs = squares(tmp_path, 1, deaths=1)
    with study.local_workers(1)() as pool, pytest.raises(RuntimeError, match="give a function that makes one"):
        study.run(study_jobs.square, jobs, pool)


def test_what_stops_a_study_ends_its_workers():
    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.run(study_jobs.wait, [{"seconds": s} for s in (0, 300, 301, 302)], study.local_workers(2), on_row=stop)
    deadline = time.monotonic() + 30
    # not join(): the pool's own thread waits for the same children, and who comes second is told that one still runs
    while multiprocessing.active_children() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("content", ["dear diary\n", "[\n 0.5,\n 3\n]\n", '{\n "version": 2\n}\n', '{"a": 1}\n'])
def test_a_file_of_something_else_is_left_as_it_is(tmp_path, content):
    file = tmp_path / "notes"
    file.write_text(content)
    with pytest.raises(
        RuntimeError, match=r"notes: expected results of a study, an object a line, found '.*'; give another name"
    ):
        study.run(study_jobs.wait, [{"seconds": 0}], study.local_workers(1), file)
    assert file.read_text() == content


def test_a_restarted_study_skips_what_is_done_and_tries_again_what_failed(tmp_path):
    file = tmp_path / "rows.jsonl"
    pool = study.local_workers(1)
    first = study.run(study_jobs.square, squares(tmp_path, 3, fails=1), pool, file)
    assert results_of(first) == [0, None, 4] and first[1]["error"] == "ValueError: no square of 1"
    with file.open("a") as stream:
        stream.write('{"function": "cut off by a')
    again = study.run(study_jobs.square, squares(tmp_path, 4, fails=1), pool, file)
    assert results_of(again) == [0, None, 4, 9]
    assert {x: len((tmp_path / f"{x}.runs").read_text()) for x in range(4)} == {0: 1, 1: 2, 2: 1, 3: 1}
    assert len(file.read_text().splitlines()) == 4


def test_results_under_another_name_count(tmp_path):
    """The folder of checkpoints is named after them."""
    executor, results = study.local_workers(1), tmp_path / "study.jsonl"
    for name in ("study", "monday"):
        (row,) = study.run(study_jobs.square, [{"x": 3, "folder": str(tmp_path), "checkpoints": name}], executor, results)
        assert row["result"] == 9
        results = results.rename(tmp_path / "monday.jsonl")
    assert (tmp_path / "3.runs").read_text() == "x" and len(results.read_text().splitlines()) == 1


def test_fits_are_those_of_one_process_even_if_one_is_killed_in_the_middle(bell, tmp_path):
    jobs = study.fit_jobs([bell], seeds=(1, 2), options=[QUICK], fps=40, checkpoints=tmp_path / "checkpoints")
    rows = study.run(study_jobs.fit_after_death, jobs, study.local_workers(2), tmp_path / "rows.jsonl")
    for job, row in zip(jobs, rows):
        assert row["result"] == study.fit(job)
    assert rows[0]["result"] != rows[1]["result"]
    assert not list((tmp_path / "checkpoints").glob("[!.]*.json"))  # a worker that was killed may leave half a file


def test_results_of_a_function_under_its_former_name_count(tmp_path):
    row = {"function": "doublet.study.energy", "job": {"x": 1}, "result": [3.0], "seconds": 1.0}
    (tmp_path / "rows.jsonl").write_text(json.dumps(row) + "\n")
    (known,) = study.run(study.energy, [{"x": 1}], study.local_workers(1), tmp_path / "rows.jsonl")
    assert known == {**row, "function": "doublet.evaluation.study.energy"}


def test_energies_of_given_materials(bell):
    truth = d.Material(d_n=4, d_t=4.9, k_bend=0.3, k_stretch=0.999)
    other = {**truth.to_dict(), "d_n": 20.0}
    jobs = study.energy_jobs([bell], [[truth], [other]], options=[BELLS], fps=40)
    right, wrong = study.run(study.energy, jobs, study.local_workers(1))
    assert right["result"][0] < 0.2 * wrong["result"][0]
    actor = d.read_actor(bell / "actor.npz")
    simulator = d.CharacterSimulator(actor, d.read_segmentation(bell / "segmentation.npz"), [], d.ClothOptions.paper())
    observations = d.read_observations(bell / "observations.npz")
    performance, space = d.read_performance(bell / "performance.npz", actor), d.ParameterSpace.paper()
    objective = d.MaterialObjective(simulator, performance, observations, 1 / 40, space=space)
    assert objective.energies([[truth], [d.Material(**other)]]).tolist() == [right["result"], wrong["result"]]
    unit = objective.space.unit(truth)
    assert objective.evaluate(unit[None])[0, 0] == pytest.approx(right["result"][0])


def test_wrong_jobs_are_refused_at_once(bell, tmp_path):
    with pytest.raises(FileNotFoundError, match="actor.npz is missing"):
        study.fit_jobs([tmp_path], fps=40)
    for options, text in (({"fit.evaluations": 3}, "evaluations"), ({"max_evaluations": 3}, "GROUP.FIELD")):
        with pytest.raises((TypeError, ValueError), match=text):
            study.fit_jobs([bell], options=[options], fps=40)
    job = {**study.fit_jobs([bell], fps=40)[0], "inputs": "others"}
    (row,) = study.run(study.fit, [job], study.local_workers(1))
    assert "not those that the study was made for" in row["error"]


def test_the_command_line(bell, tmp_path):
    (bell / "run.json").write_text(json.dumps({"session": str(tmp_path), "stages": {}}))
    (tmp_path / "session.json").write_text('{"fps": 40}')
    command = [sys.executable, "-m", "doublet", "study", bell, "-o", tmp_path / "rows.jsonl", "--seeds", "1", "2"]
    command += ["--fit-max-evaluations", "8", "--fit-initial-design-size", "4", "--fit-population", "4", "--space-names", "d_n"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 2 and "seed 1" in lines[0] and "E_fit" in lines[0] and "d_n" in lines[1] and "2/2" in done.stderr


# --- a real cluster


@pytest.fixture
def cluster(tmp_path):
    """A Dask scheduler and two workers, each a process of its own; yields (address, workers)."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny"]
    worker += ["--no-dashboard", "--local-directory", str(tmp_path)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    processes = [subprocess.Popen([*dask, "--scheduler-file", str(file)], **quiet)]
    processes += [subprocess.Popen(worker, **quiet) for _ in range(2)]
    yield file, processes[1:]
    for process in processes:
        process.kill()
        process.wait()


def test_a_cluster_with_a_worker_killed_in_the_middle(cluster, bell, tmp_path):
    from distributed import Client

    file, workers = cluster
    with Client(scheduler_file=str(file), timeout="60s") as client:
        client.wait_for_workers(2, timeout=60)
        jobs = study.fit_jobs([bell], seeds=(1, 2, 3), options=[QUICK], fps=40, checkpoints=tmp_path / "checkpoints")
        rows = study.run(study_jobs.fit_after_death, jobs, client.get_executor(pure=False), tmp_path / "rows.jsonl")
        assert sorted(worker.poll() is None for worker in workers) == [False, True]  # seed 2 killed one
    assert results_of(rows) == [study.fit(job) for job in jobs]
    assert np.isfinite([row["result"]["regions"][0]["energy"] for row in rows]).all()
