"""tests/run_nightly.sh in a folder in which its parts are stand-ins: it goes on after a failure, and says which part failed."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "tests" / "run_nightly.sh"
PASSED = "passed, 0 min"
PARTS = re.search(r'^parts="(.*)"$', SCRIPT.read_text(), re.MULTILINE)[1].split()


@pytest.fixture
def repo(tmp_path):
    """Everything passes."""
    stand_ins = ["scripts/apt-install.sh", "scripts/build-wheel.sh"]
    stand_ins += ["scripts/make-pictures.sh", "tests/fuzz/run.sh", "tests/run_tests.sh"]
    stand_ins += ["tests/slow/other_pythons.sh"]
    stand_ins += [f"build/tests-venv/bin/{name}" for name in ("doublet", "pip", "python")]
    stand_ins += [f"bin/{name}" for name in ("cmake", "ctest")]
    for name in stand_ins:
        write(tmp_path / name, "exit 0")
    write(
        tmp_path / "examples" / "quickstart.sh",
        'cd "$(dirname "$0")/.." && mkdir -p out/quickstart && cd out/quickstart && '
        "touch report.html character.glb new_motion.mp4",
    )
    shutil.copy(SCRIPT, tmp_path / "tests")
    (tmp_path / ".gitignore").write_text("build\n")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "all")
    return tmp_path


def git(repo: Path, *arguments: str) -> None:
    who = ["-c", "user.name=night", "-c", "user.email=night@localhost"]
    subprocess.run(["git", *who, *arguments], cwd=repo, check=True)


def write(path: Path, what: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/bash\n{what}\n")
    path.chmod(0o755)


def nightly(repo: Path, *parts: str) -> tuple[int, dict[str, str]]:
    """Status, and the summary: part -> how it ended."""
    environment = {"PATH": f"{repo / 'bin'}:/usr/bin:/bin"}
    done = subprocess.run([repo / "tests" / "run_nightly.sh", *parts], capture_output=True, text=True, env=environment)
    lines = done.stdout.partition("== summary")[2].splitlines()[1:]
    return done.returncode, dict(line.split(": ", 1) for line in lines or [done.stderr.strip()])


def test_all_parts_by_default(repo):
    assert nightly(repo) == (0, dict.fromkeys(PARTS, PASSED))


def test_it_goes_on_after_a_failure_and_tells(repo):
    write(repo / "tests" / "fuzz" / "run.sh", 'echo "$*" && exit 1')
    status, summary = nightly(repo, "conda", "fuzz", "mutate")
    assert status == 1
    ended = {"conda": PASSED, "fuzz": "FAILED, see build/nightly/fuzz.log, 0 min", "mutate": PASSED}
    assert summary == {**dict.fromkeys(PARTS, "not run"), **ended}
    assert (repo / "build" / "nightly" / "fuzz.log").read_text() == "60\n"


def test_a_second_call_runs_what_has_not_passed(repo):
    write(repo / "scripts" / "build-wheel.sh", "echo >>wheels")
    write(repo / "tests" / "fuzz" / "run.sh", "echo >>fuzzed; [ -e mended ]")
    (repo / ".gitignore").write_text("build\nwheels\nfuzzed\nmended\n")
    ran = lambda name: len((repo / name).read_text().splitlines())  # noqa: E731
    assert nightly(repo)[0] == 1 and (ran("wheels"), ran("fuzzed")) == (1, 1)
    (repo / "mended").touch()
    assert nightly(repo) == (0, dict.fromkeys(PARTS, PASSED)) and (ran("wheels"), ran("fuzzed")) == (1, 2)
    assert nightly(repo)[0] == 0 and (ran("wheels"), ran("fuzzed")) == (1, 2)
    assert nightly(repo, "wheel")[0] == 0 and (ran("wheels"), ran("fuzzed")) == (2, 2)  # asked for


@pytest.mark.parametrize("change", ["a commit", "a file that differs", "a new file"])
def test_what_passed_for_something_else_is_run_again(repo, change):
    assert nightly(repo, "conda")[1]["conda"] == PASSED
    if change == "a commit":
        git(repo, "commit", "-q", "--allow-empty", "-m", "another")
    else:
        write(repo / ("tests/run_tests.sh" if change == "a file that differs" else "new.h"), "exit 0 # changed")
    assert nightly(repo, "fuzz")[1]["conda"] == "not run"


@pytest.mark.parametrize("step", ["--preset", "--build"])
def test_no_tests_are_run_on_a_build_that_failed(repo, step):
    write(repo / "bin" / "cmake", f'[ "$1" != {step} ]')
    assert nightly(repo, "threads")[0] == 1


@pytest.mark.parametrize("part", ["headers", "mutate", "slow"])
def test_nothing_is_run_on_a_package_that_is_not_built(repo, part):
    write(repo / "tests" / "run_tests.sh", '[ "$1" != --build-only ]')
    assert nightly(repo, part)[0] == 1


def test_the_quickstart_is_that_of_a_clone(repo):
    """Which has neither what is built here nor what is not committed."""
    (repo / "examples" / "quickstart.sh").write_text('cd "$(dirname "$0")/.." && [ ! -e build ] && mkdir -p out/quickstart\n')
    git(repo, "commit", "-q", "-a", "-m", "a quickstart without results")
    assert nightly(repo, "quickstart")[0] == 1
    with (repo / "examples" / "quickstart.sh").open("a") as file:
        file.write("cd out/quickstart && touch report.html character.glb new_motion.mp4\n")
    assert nightly(repo, "quickstart")[0] == 1
    git(repo, "commit", "-q", "-a", "-m", "with them")
    assert nightly(repo, "quickstart")[0] == 0


def test_a_part_that_is_not_there(repo):
    assert nightly(repo, "fuzz", "nonsense") == (2, {"run_nightly.sh": f"expected some of {' '.join(PARTS)}, found nonsense"})


def test_its_beginning_and_the_workflow_name_every_part():
    beginning = re.findall(r"^#   (\w+) ", SCRIPT.read_text(), re.MULTILINE)
    matrix = re.search(r"parts: \[(.*)\]", (ROOT / ".github" / "workflows" / "nightly.yml").read_text())[1]
    assert beginning == PARTS and sorted(re.findall(r"\w+", matrix)) == sorted(PARTS)
