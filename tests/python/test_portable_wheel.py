"""The wheel of scripts/build-wheel.sh: what may be in it, and that it works where nothing else is installed."""

import importlib.util
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SPEC = importlib.util.spec_from_file_location("check_wheel", ROOT / "packaging" / "wheel" / "check.py")
check = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check)


def library(folder: Path, name: str, *needed: Path) -> Path:
    """A shared library that needs others."""
    source = folder / "nothing.c"
    source.write_text("int nothing;\n")
    path = folder / name
    command = ["cc", "-shared", f"-Wl,-soname,{name}", "-Wl,--no-as-needed", "-o", path, source, *needed]
    subprocess.run([str(c) for c in command], check=True)
    return path


class Made:
    """A wheel as auditwheel leaves it."""

    def __init__(self, folder: Path):
        self.folder, self.path = folder, folder / "doublet-9.9-cp311-cp311-manylinux_2_35_x86_64.whl"

    def of(self, *libraries: Path, licences: int = 9) -> list[str]:
        module = library(self.folder, "_doublet.so", *libraries)
        with zipfile.ZipFile(self.path, "w") as wheel:
            wheel.write(module, "doublet/_doublet.so")
            for path in libraries:
                wheel.write(path, f"doublet.libs/{path.name}")
            for number in range(licences):
                wheel.writestr(f"doublet-9.9.dist-info/licenses/libraries/{number}.txt", "do as you like")
        return check.problems_of(self.path)


def test_what_may_be_in_it_is_let_through(tmp_path):
    assert Made(tmp_path).of(library(tmp_path, "libpng16-01234567.so.16")) == []


@pytest.mark.parametrize(
    "name", ["libx264-01234567.so.164", "libx265-01234567.so.199", "libpoppler-01234567.so.126", "libgmp.so.10"]
)
def test_a_library_whose_licence_nobody_read_is_refused(tmp_path, name):
    assert Made(tmp_path).of(library(tmp_path, name)) == [f"expected libraries whose licence has been read, found {name}"]


def test_a_library_that_is_left_behind_is_named(tmp_path):
    behind = library(tmp_path, "libbehind.so.1")
    png = library(tmp_path, "libpng16-01234567.so.16", behind)
    (problem,) = Made(tmp_path).of(png)
    assert problem.startswith("libpng16-01234567.so.16: expected what it needs") and "libbehind.so.1" in problem


def test_licences_are_in_it(tmp_path):
    (problem,) = Made(tmp_path).of(library(tmp_path, "libpng16-01234567.so.16"), licences=0)
    assert "a licence for each" in problem


def test_it_has_a_tag_and_is_not_large(tmp_path, monkeypatch):
    made = Made(tmp_path)
    made.path = tmp_path / "doublet-9.9-cp311-cp311-linux_x86_64.whl"
    monkeypatch.setattr(check, "LARGEST", 100)
    assert [problem.split(",")[0] for problem in made.of()] == ["expected at most 0 MB", "expected a tag of manylinux"]


def test_the_tag_asks_for_the_glibc_that_the_page_names():
    tag = re.search(r"manylinux_(\d+)_(\d+)_", (ROOT / "scripts" / "build-wheel.sh").read_text(encoding="utf-8"))
    page = re.search(r"glibc (\d+)\.(\d+)", (ROOT / "docs" / "install.md").read_text(encoding="utf-8"))
    assert tag.groups() == page.groups()


@pytest.fixture(scope="module")
def wheel():
    path = os.environ.get("DOUBLET_PORTABLE_WHEEL")
    if not path:
        pytest.skip("DOUBLET_PORTABLE_WHEEL does not name a wheel (tests/run_nightly.sh wheel sets it)")
    return Path(path)


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Python of an environment that has it and what pip gives to it."""
    folder = tmp_path_factory.mktemp("bare") / "venv"
    subprocess.run(["/usr/bin/python3", "-m", "venv", folder], check=True)
    subprocess.run([folder / "bin" / "python", "-m", "pip", "install", "-q", wheel], check=True)
    return folder / "bin" / "python"


def test_nothing_is_wrong_with_the_wheel(wheel):
    assert check.problems_of(wheel) == []


def test_the_viewers_page_is_in_it(wheel):
    assert "doublet/data/viewer/page.html" in zipfile.ZipFile(wheel).namelist()


LOADED = """
import bz2, lzma, os, re, sys, numpy  # what Python itself loads
def libraries():
    return {line.split()[-1] for line in open("/proc/self/maps") if re.search(r"\\.so(\\.|$)", line.split()[-1])}
before = libraries()
import doublet
print("\\n".join(sorted(libraries() - before)))
"""


def test_importing_it_loads_nothing_of_the_systems_but_what_every_linux_has(installed):
    loaded = subprocess.run([installed, "-c", LOADED], capture_output=True, text=True, check=True).stdout.splitlines()
    own = [path for path in loaded if "/doublet.libs/" in path]
    assert len(own) >= 10
    python = ("/lib-dynload/", "/site-packages/")
    others = [path for path in loaded if path not in own and not any(part in path for part in python)]
    assert {Path(path).name for path in others} <= check.SYSTEM


FRAMES = """
import sys, doublet, hashlib, numpy
session = doublet.Session(sys.argv[1])
frames = doublet.FrameSource.open(session)
for camera in range(len(session.cameras)):
    print(hashlib.sha256(numpy.ascontiguousarray(frames.image(camera, 64))).hexdigest())
"""


def test_it_reads_the_shipped_session_as_the_build_of_the_tests_does(installed):
    session = ROOT / "examples" / "data" / "session"
    read = [subprocess.run([p, "-c", FRAMES, session], capture_output=True, text=True) for p in (installed, sys.executable)]
    assert read[0].returncode == 0, read[0].stderr
    assert read[0].stdout == read[1].stdout and len(read[0].stdout.split()) == 8
