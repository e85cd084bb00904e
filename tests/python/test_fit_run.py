"""`doublet fit` as a user runs it: progress, Ctrl-C, kill -9, the page."""

import json
import re
import shutil
import signal
import subprocess
import sys
import time
from functools import partial

import pytest
from doublet.common.console import Console
from doublet.pages.fit_page import describe_confidence

OPTIONS = ["--cloth-iterations", "24", "--cloth-substeps", "1", "--cloth-stiffness", "sweeps", "--cloth-rest-curvature", "1"]
OPTIONS += ["--fit-max-evaluations", "56", "--fit-initial-design-size", "16", "--fit-population", "8", "--fit-min-gain", "0"]
OPTIONS += ["--space-names", "d_n", "k_stretch", "k_friction"]


@pytest.fixture
def out(bell, tmp_path):
    """A copy that is fitted in."""
    copy = tmp_path / "out"
    shutil.copytree(bell, copy)
    return copy


@pytest.fixture
def fit():
    """Starts `doublet fit` without the checks of a whole session."""
    program = (
        "import sys; from pathlib import Path; from doublet.cli import program as cli; from doublet import reconstruct\n"
        "import doublet as d; session = d.Session()\n"
        "session.fps, session.folder, session.name, session.scan = 40.0, Path('session'), 'bell', Path('scan.ply')\n"
        "session.markers = Path('joints.json')\n"
        "session.joints = [d.JointAnnotation('pelvis', '', [0, 0.5, 0], 6)]\n"
        "make = reconstruct.Job.__init__\n"
        "def made(job, *given, **named): make(job, *given, **named); job.session = session\n"
        "reconstruct.Job.__init__ = made\n"
        "sys.exit(cli.main(sys.argv[1:]))"
    )
    started = []

    def start(out, *more, takes=(), **options):
        for folder in (out, *takes):
            if not (folder / "run.json").exists():
                (folder / "run.json").write_text(json.dumps({"session": "session", "stages": {}}))
        command = [sys.executable, "-c", program, "fit", str(out), *map(str, takes), *OPTIONS, *more]
        started.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **options))
        return started[-1]

    yield start
    for process in started:
        process.kill()


def finished(process):
    _, shown = process.communicate(timeout=300)
    assert process.returncode == 0, shown
    return shown


def fitted(out):
    values = json.loads((out / "material.json").read_text())
    return {k: v for k, v in values.items() if k != "seconds"}


def log_without_seconds(out):
    return [line.rpartition(",")[0] for line in (out / "fit_log.csv").read_text().splitlines()]


def wait_for_generations(out, process, count):
    end = time.monotonic() + 120
    while not (out / "fit_log.csv").exists() or len((out / "fit_log.csv").read_text().splitlines()) <= count:
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < end, "timed out"
        time.sleep(0.01)


def test_killed_and_interrupted_runs_end_in_the_same_bits(fit, out, bell, tmp_path):
    whole = tmp_path / "whole"
    shutil.copytree(bell, whole)
    shown = finished(fit(whole))
    assert re.search(r"fit: 50 % after \d+ s \(\d+ evaluations, best [\d.]+, at most \d+ s left\)", shown)

    process = fit(out)
    wait_for_generations(out, process, 2)
    process.kill()
    process.communicate()

    # A test runner in the background may ignore Ctrl-C, and its children would with it.
    process = fit(out, preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL))
    wait_for_generations(out, process, 4)
    process.send_signal(signal.SIGINT)
    _, shown = process.communicate(timeout=60)
    assert process.returncode == 130 and "best material so far" in shown and "Traceback" not in shown
    kept = fitted(out)
    assert kept["interrupted"] and kept["regions"][0]["energy"] == kept["regions"][0]["best_sample"]["energy"]
    assert json.loads((out / "run.json").read_text())["stages"]["fit"]["state"] == "running"

    shown = finished(fit(out))
    assert "resuming after" in (out / "log.txt").read_text()
    assert fitted(out) == fitted(whole) and not fitted(out)["interrupted"]
    assert log_without_seconds(out) == log_without_seconds(whole)
    assert (out / "fit_checkpoint.txt").exists()  # a larger budget goes on from it

    region = fitted(out)["regions"][0]
    low, high = region["interval"]["k_stretch"]
    assert low <= region["parameters"]["k_stretch"] <= high and region["confidence"]["k_stretch"] != "low"
    assert region["confidence"]["k_friction"] == "low"  # the bell touches nothing
    page = (out / "fit_progress.html").read_text()
    assert re.search("Well determined: [^.]*stretching", page)
    assert page.count("<svg") == 3 and "refresh" not in page
    assert any(finding["parameter"] == "k_friction" and finding["kind"] == "guess" for finding in region["findings"])
    assert page.count("Doubtful: k_friction = ") == 1


def test_a_larger_budget_goes_on_to_the_bits_of_one_search(fit, out, bell, tmp_path):
    whole = tmp_path / "whole"
    shutil.copytree(bell, whole)
    larger = ["--fit-max-evaluations", "80"]
    finished(fit(whole, *larger))
    assert "resuming" not in (whole / "log.txt").read_text()

    finished(fit(out))
    assert fitted(out)["regions"][0]["evaluations"] == 56
    assert "option fit.max_evaluations changed from 56 to 80" in finished(fit(out, *larger))
    assert "resuming after 56 evaluations" in (out / "log.txt").read_text()
    assert fitted(out) == fitted(whole) and fitted(out)["regions"][0]["evaluations"] == 80
    assert log_without_seconds(out) == log_without_seconds(whole)

    finished(fit(out))  # a smaller one is another search
    assert "belongs to a longer search" in (out / "log.txt").read_text()
    assert fitted(out)["regions"][0]["evaluations"] == 56
    finished(fit(out, "--force"))  # and a forced one begins again
    assert (out / "log.txt").read_text().count("resuming") == 1


def test_two_takes_have_one_material_and_the_sum_of_their_energies(fit, out, bell, tmp_path):
    other, alone = tmp_path / "other", tmp_path / "alone"
    for folder in (other, alone):
        shutil.copytree(bell, folder)
    finished(fit(out, takes=[other]))
    both = fitted(out)
    assert both == fitted(other) and log_without_seconds(out) == log_without_seconds(other)
    record = json.loads((other / "run.json").read_text())["stages"]["fit"]
    assert record["state"] == "done" and record["summary"]["takes"] == [str(out), str(other)]
    assert "fit: up to date" in finished(fit(out)) and fitted(out) == both  # whatever is run of one of them keeps it
    finished(fit(alone))  # the takes are one and the same here: twice the energy, the same minimum
    one, two = fitted(alone)["regions"][0], both["regions"][0]
    assert two["energy_at_centre"] == pytest.approx(2 * one["energy_at_centre"])
    assert two["parameters"] == pytest.approx(one["parameters"], abs=0.05)
    _, shown = fit(out, "--session", "elsewhere", takes=[other]).communicate(timeout=60)
    assert "expected a single OUT beside it" in shown and "Traceback" not in shown


def test_a_damaged_checkpoint_is_named(fit, out):
    (out / "fit_checkpoint.txt").write_text('{"kind": "minimise", "problem": "' + "x" * 10000)
    process = fit(out)
    _, shown = process.communicate(timeout=60)
    (line,) = [line for line in shown.splitlines() if line.startswith("doublet: ")]
    assert process.returncode == 1 and str(out / "fit_checkpoint.txt") in line and "delete it" in line and len(line) < 500


def test_words_follow_the_confidence():
    def region(**levels):
        return {"confidence": levels}

    assert describe_confidence({}) == []
    (line,) = describe_confidence(region(d_n="high", d_t="high", k_bend="high"))
    assert line == "Well determined: drag along the normal, drag along the surface, bending."
    high, medium = describe_confidence(region(d_n="high", k_bend="medium", k_friction="low"))
    assert (high, medium) == ("Well determined: drag along the normal.", "Partly determined: bending.")
    assert describe_confidence(region(k_friction="low")) == []  # the findings say it


def test_progress_shows_what_the_stage_said_last(capsys):
    console = Console()
    context = console.context()
    context.report_progress("fit", 0.1)
    context.log_line("fit: 8 evaluations, best 3.5")
    context.report_progress("fit", 0.6)
    context.report_progress("simulate", 0.6)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].endswith("s (8 evaluations, best 3.5)") and lines[1].endswith(" s")
