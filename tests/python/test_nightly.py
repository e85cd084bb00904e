"""tests/run_nightly.sh in a folder in which its parts are stand-ins: it goes on after a failure, and says which part failed."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "tests" / "run_nightly.sh"
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
    shutil.copy(SCRIPT, tmp_path / "tests")
    return tmp_path


def write(path: Path, what: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/bash\n{what}\n")
    path.chmod(0o755)


def nightly(repo: Path, *parts: str) -> tuple[int, list[str]]:
    """Status, and the lines of the summary."""
    environment = {"PATH": f"{repo / 'bin'}:/usr/bin:/bin"}
    done = subprocess.run([repo / "tests" / "run_nightly.sh", *parts], capture_output=True, text=True, env=environment)
    return done.returncode, done.stdout.partition("== summary\n")[2].splitlines() or [done.stderr.strip()]


def test_all_parts_by_default(repo):
    status, lines = nightly(repo)
    assert status == 0 and lines == [f"{part}: passed, 0 min" for part in PARTS]


def test_it_goes_on_after_a_failure_and_tells(repo):
    write(repo / "tests" / "fuzz" / "run.sh", 'echo "$*" && exit 1')
    status, lines = nightly(repo, "conda", "fuzz", "mutate")
    assert status == 1
    assert lines == ["conda: passed, 0 min", "fuzz: FAILED, see build/nightly/fuzz.log, 0 min", "mutate: passed, 0 min"]
    assert (repo / "build" / "nightly" / "fuzz.log").read_text() == "60\n"


@pytest.mark.parametrize("step", ["--preset", "--build"])
def test_no_tests_are_run_on_a_build_that_failed(repo, step):
    write(repo / "bin" / "cmake", f'[ "$1" != {step} ]')
    assert nightly(repo, "threads")[0] == 1


def test_a_part_that_is_not_there(repo):
    assert nightly(repo, "fuzz", "nonsense") == (2, [f"run_nightly.sh: expected some of {' '.join(PARTS)}, found nonsense"])


def test_its_beginning_and_the_workflow_name_every_part():
    beginning = re.findall(r"^#   (\w+) ", SCRIPT.read_text(), re.MULTILINE)
    matrix = re.search(r"parts: \[(.*)\]", (ROOT / ".github" / "workflows" / "nightly.yml").read_text())[1]
    assert beginning == PARTS and sorted(re.findall(r"\w+", matrix)) == sorted(PARTS)
