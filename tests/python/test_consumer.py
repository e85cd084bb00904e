"""doublet as a user's CMake project sees it: installed, inside the tree, and the cloth library alone."""

import os
import re
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CONSUMERS = ROOT / "tests" / "consumer"


@pytest.fixture(scope="session")
def build_dir():
    folder = os.environ.get("DOUBLET_BUILD_DIR")
    if not folder:
        pytest.skip("DOUBLET_BUILD_DIR does not name a build folder (tests/run_tests.sh sets it)")
    return Path(folder)


#: What was compiled in another temporary folder need not be compiled again.
CACHED = {**os.environ, "CCACHE_BASEDIR": tempfile.gettempdir(), "CCACHE_NOHASHDIR": "1"}
if shutil.which("ccache"):
    CACHED["CMAKE_CXX_COMPILER_LAUNCHER"] = "ccache"


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=900, env=CACHED)
    assert done.returncode == 0, f"{command}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def build(source: Path, folder: Path, *definitions) -> Path:
    run("cmake", "-S", source, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *definitions)
    run("cmake", "--build", folder)
    return folder / "consumer"


@pytest.fixture(scope="session")
def installed(build_dir, tmp_path_factory):
    """Installed, and then moved to another place: nothing may know where it was."""
    first, prefix = tmp_path_factory.mktemp("first") / "prefix", tmp_path_factory.mktemp("moved") / "to here"
    run("cmake", "--install", build_dir, "--component", "development", "--prefix", first)
    first.rename(prefix)
    for path in prefix.rglob("*.cmake"):
        text = path.read_text(encoding="utf-8")
        assert str(first) not in text and str(build_dir) not in text and str(ROOT) not in text, path
    return prefix


def test_installed_package(installed, tmp_path):
    program = build(CONSUMERS / "installed", tmp_path, f"-DCMAKE_PREFIX_PATH={installed}")
    assert "no such session" in run(program)


def test_licences_are_installed(installed):
    found = {path.parent.name for path in installed.glob("share/doc/doublet/**/LICENSE")}
    assert found == {"doublet", *(path.parent.name for path in ROOT.glob("third_party/*/LICENSE"))}


OTHERS = ("OpenCV", "PNG", "JPEG", "OpenMesh", "embree", "nlohmann_json", "TinyGLTF", "PkgConfig")  # all that is not Eigen


@pytest.mark.slow
def test_installed_cloth_library_brings_nothing_else(installed, tmp_path):
    """Where none of the others can be found. A solver of a stranger's passes the kit there."""
    hidden = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in OTHERS]
    program = build(CONSUMERS / "pbd", tmp_path, f"-DCMAKE_PREFIX_PATH={installed}", *hidden)
    run(program, tmp_path / "cloth.obj")
    run(program.with_name("mass_spring"))
    libraries = run("ldd", program)
    assert not any(name in libraries for name in ("opencv", "png", "embree", "zip", "tinygltf"))


@pytest.mark.slow
def test_shared_libraries(tmp_path):
    """The cloth library as one, installed, is what a program loads."""
    only = ("-DCMAKE_BUILD_TYPE=Release", "-DDOUBLET_COMPONENTS=pbd", "-DBUILD_SHARED_LIBS=ON")
    run("cmake", "-S", ROOT, "-B", tmp_path / "library", "-G", "Ninja", *only)
    run("cmake", "--build", tmp_path / "library")
    run("cmake", "--install", tmp_path / "library", "--component", "development", "--prefix", tmp_path / "prefix")
    program = build(CONSUMERS / "pbd", tmp_path / "program", f"-DCMAKE_PREFIX_PATH={tmp_path / 'prefix'}")
    run(program, tmp_path / "cloth.obj")
    assert str(tmp_path / "prefix") in run("ldd", program)
    assert (tmp_path / "cloth.obj").stat().st_size > 0


ROOMS = ("core", "rays", "files", "capture", "segment", "bodymodel", "pbd", "simulate", "animate", "fit")
COMPONENT = """cmake_minimum_required(VERSION 3.25)
project(alone LANGUAGES CXX)
find_package(doublet REQUIRED COMPONENTS {room})
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE "$<LINK_LIBRARY:WHOLE_ARCHIVE,doublet::{room}>") # every symbol that it needs
"""


@pytest.fixture(scope="module")
def alone(installed, tmp_path_factory):
    """Room -> what its component says, asked for alone: the complaint, or nothing. Two at a time."""

    def built(room: str) -> str:
        folder = tmp_path_factory.mktemp(room)
        headers = sorted((installed / "include" / "doublet" / room).glob("*.h"))
        lines = [*(f"#include <doublet/{room}/{header.name}>" for header in headers), "int main() {}"]
        (folder / "main.cpp").write_text("\n".join(lines) + "\n")
        (folder / "CMakeLists.txt").write_text(COMPONENT.format(room=room))
        try:
            run(build(folder, folder / "build", f"-DCMAKE_PREFIX_PATH={installed}", "-DCMAKE_CXX_FLAGS=-O0 -Wall -Werror"))
        except AssertionError as error:
            return str(error)
        return ""

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(ROOMS, pool.map(built, ROOMS)))


@pytest.mark.parametrize("room", ROOMS)
def test_each_component_alone(alone, room):
    """Its headers compile, and a program links, with what the component itself brings."""
    assert alone[room] == ""


@pytest.mark.slow
def test_inside_the_tree_of_another_project(build_dir, tmp_path):
    quick = ["-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_CXX_FLAGS_RELEASE=-O0"]
    run(build(CONSUMERS / "subdirectory", tmp_path, f"-DDOUBLET_SOURCE={ROOT}", "-DDOUBLET_WERROR=ON", *quick))


def configured(folder: Path, prefix: Path, *lines: str) -> subprocess.CompletedProcess:
    """A project that only looks for doublet."""
    folder.mkdir()
    text = ("cmake_minimum_required(VERSION 3.25)", "project(looks LANGUAGES CXX)", *lines)
    (folder / "CMakeLists.txt").write_text("\n".join(text) + "\n")
    command = ["cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"]
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=300)


def test_components_are_looked_for(installed, tmp_path):
    wrong = configured(tmp_path / "wrong", installed, "find_package(doublet REQUIRED COMPONENTS pbd nonsense)")
    assert wrong.returncode != 0 and "no component 'nonsense'" in wrong.stderr, wrong.stderr
    hidden = [f"set(CMAKE_DISABLE_FIND_PACKAGE_{name} ON)" for name in OTHERS]
    needs = configured(tmp_path / "needs", installed, *hidden, "find_package(doublet REQUIRED COMPONENTS segment)")
    assert needs.returncode != 0 and "embree" in needs.stderr, needs.stderr
    right = configured(
        tmp_path / "right",
        installed,
        "find_package(doublet QUIET COMPONENTS nonsense)",
        'if(doublet_FOUND)\n message(FATAL_ERROR "nonsense was found")\nendif()',
        "find_package(doublet REQUIRED COMPONENTS pbd core OPTIONAL_COMPONENTS nonsense)",
        "foreach(name pbd core)\n if(NOT doublet_${name}_FOUND)\n message(FATAL_ERROR ${name})\n endif()\nendforeach()",
        'if(doublet_nonsense_FOUND)\n message(FATAL_ERROR "nonsense was found")\nendif()',
    )
    assert right.returncode == 0, right.stderr
    optional = configured(
        tmp_path / "optional",
        installed,
        *(hidden + ["find_package(doublet REQUIRED COMPONENTS pbd OPTIONAL_COMPONENTS segment)"]),
        'if(NOT doublet_pbd_FOUND OR doublet_segment_FOUND)\n message(FATAL_ERROR "${doublet_segment_FOUND}")\nendif()',
    )
    assert optional.returncode == 0, optional.stderr


def test_a_component_is_built_with_what_it_links(tmp_path):
    """DOUBLET_COMPONENTS names what is wanted, not what that needs."""
    run("cmake", "-S", ROOT, "-B", tmp_path / "fit", "-G", "Ninja", "-DDOUBLET_COMPONENTS=fit")
    targets = run("cmake", "--build", tmp_path / "fit", "--target", "help")
    built = {room for room in ROOMS if f"libdoublet_{room}.a" in targets}
    assert built == {"core", "rays", "files", "pbd", "simulate", "fit"}
    wrong = ["cmake", "-S", ROOT, "-B", tmp_path / "wrong", "-G", "Ninja", "-DDOUBLET_COMPONENTS=fitt"]
    done = subprocess.run([str(c) for c in wrong], capture_output=True, text=True)
    assert done.returncode != 0 and "found 'fitt'" in " ".join(done.stderr.split())


def test_shared_libraries_find_each_other_wherever_they_are_installed(tmp_path):
    """A library that one of ours alone links is not looked for beside the program."""
    run("cmake", "-S", ROOT, "-B", tmp_path, "-G", "Ninja", "-DDOUBLET_COMPONENTS=fit", "-DBUILD_SHARED_LIBS=ON")
    script = (tmp_path / "cmake_install.cmake").read_text(encoding="utf-8")
    for room in ("core", "rays", "files", "pbd", "simulate", "fit"):
        assert re.search(rf'FILE "[^"]*/libdoublet_{room}\.so"\s+RPATH "\\\$ORIGIN"', script), room


def test_the_build_type_of_a_project_around_it_is_its_own(tmp_path):
    text = (CONSUMERS / "subdirectory" / "CMakeLists.txt").read_text(encoding="utf-8")
    (tmp_path / "CMakeLists.txt").write_text(text.replace("../segment.cpp", str(CONSUMERS / "segment.cpp")))
    run("cmake", "-S", tmp_path, "-B", tmp_path / "build", "-G", "Ninja", f"-DDOUBLET_SOURCE={ROOT}")
    cache = (tmp_path / "build" / "CMakeCache.txt").read_text(encoding="utf-8")
    assert "CMAKE_BUILD_TYPE:STRING=\n" in cache
