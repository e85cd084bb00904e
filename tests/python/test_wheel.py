"""The wheel as strangers get it: what it links, on another path, without a compiler, under mypy."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from doublet import _doublet

ROOT = Path(__file__).parents[2]
BASE = {"libc6", "libgcc-s1", "libstdc++6"}  # of every Debian
DYNAMIC = subprocess.run(["readelf", "-d", _doublet.__file__], capture_output=True, text=True, check=True).stdout


def packages_of_links() -> set[str]:
    """The Debian packages of what the module links itself."""
    linked = subprocess.run(["ldd", _doublet.__file__], capture_output=True, text=True, check=True).stdout
    places = dict(re.findall(r"(\S+) => (/\S+)", linked))
    found = set()
    for name in re.findall(r"NEEDED.*\[(.*)\]", DYNAMIC):
        path = Path(places.get(name, f"/lib64/{name}")).resolve()
        owner = subprocess.run(["dpkg", "-S", path, str(path).removeprefix("/usr")], capture_output=True, text=True).stdout
        assert owner, f"{name}: {path} is of no Debian package"
        found.add(owner.split(":")[0])
    return found


def test_it_links_what_is_declared():
    """What a machine that only runs doublet installs (scripts/apt-packages-runtime.txt), no more and no less."""
    lines = (ROOT / "scripts" / "apt-packages-runtime.txt").read_text(encoding="utf-8").splitlines()
    declared = {line for line in lines if not line.startswith("#")}
    assert packages_of_links() - BASE == declared - {"ffmpeg"}  # ffmpeg is called


def test_it_looks_for_libraries_nowhere_else():
    """Least of all in the folder that it was built in."""
    places = ":".join(re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", DYNAMIC)).split(":")
    assert [place for place in places if place and not place.startswith("/usr/lib/")] == []


@pytest.fixture(scope="module")
def wheel():
    """That of tests/run_tests.sh."""
    path = os.environ.get("DOUBLET_WHEEL")
    if not path:
        pytest.skip("DOUBLET_WHEEL does not name a wheel (tests/run_tests.sh sets it)")
    return path


def test_licences_of_what_is_compiled_into_it_are_in_it(wheel):
    names = {name.partition(".dist-info/licenses/")[2] for name in zipfile.ZipFile(wheel).namelist()}
    assert {"LICENSE", *(str(path.relative_to(ROOT)) for path in ROOT.glob("third_party/*/LICENSE"))} <= names


@pytest.fixture(scope="module")
def elsewhere(wheel, tmp_path_factory):
    """A clean environment with the wheel."""
    folder = tmp_path_factory.mktemp("some where") / "venv"
    subprocess.run(["/usr/bin/python3", "-m", "venv", folder], check=True)
    subprocess.run([folder / "bin" / "python", "-m", "pip", "install", "-q", wheel], check=True)
    return folder


CHARACTER = """
import sys, doublet as d
sys.path.append(sys.argv[1])
from seeds import World
made = d.animate(World().character, World().motion, d.AnimateOptions(settle_seconds=0.05))
assert len(made.surface) == 3 and d.body_model_path().exists() and "some where" in d.__file__
"""


def test_it_runs_in_a_clean_environment_without_a_compiler(elsewhere, tmp_path):
    empty = tmp_path / "bin"
    empty.mkdir()
    alone = {"PATH": str(empty), "HOME": str(tmp_path)}
    for command in (
        [elsewhere / "bin" / "doublet", "--version"],
        [elsewhere / "bin" / "doublet", "reconstruct", "--write-config", tmp_path / "options.toml"],
        [elsewhere / "bin" / "python", "-c", CHARACTER, ROOT / "tests" / "fuzz"],
    ):
        done = subprocess.run([str(c) for c in command], env=alone, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    assert "[segment]" in (tmp_path / "options.toml").read_text()


def test_a_users_script_is_sound_to_a_strict_type_checker(tmp_path):
    """The package says what it is (py.typed); a mistake in the script is found, and nothing else."""
    script, derived = (ROOT / "tests" / "consumer" / name for name in ("script.py", "derived.py"))
    wrong = tmp_path / "wrong.py"
    wrong.write_text(script.read_text(encoding="utf-8").replace("d.SourceMotion.read(clip)", "d.SourceMotion.read(3.5)"))
    other = tmp_path / "other.py"
    other.write_text(derived.read_text(encoding="utf-8").replace("lambda dimension, seed: Halving", "lambda dimension: Halving"))

    def check(path):
        command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", path]
        return subprocess.run([str(c) for c in command], cwd=tmp_path, capture_output=True, text=True).stdout

    assert "Success: no issues found" in check(script)
    assert "Argument 1" in check(wrong)
    assert "Success: no issues found" in check(derived)
    assert "Incompatible types in assignment" in check(other)
