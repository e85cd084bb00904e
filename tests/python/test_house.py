"""The rules of the house: who may include and link whom, and what stays out of public headers."""

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAY_USE = {
    "options": set(),
    "core": {"options"},
    "rays": {"options", "core"},
    "files": {"options", "core"},
    "capture": {"options", "core", "rays", "files"},
    "segment": {"options", "core", "rays"},
    "bodymodel": {"options", "core", "rays", "files"},
    "pbd": {"options"},
    "simulate": {"options", "core", "pbd"},
    "animate": {"options", "core", "rays", "files", "pbd", "simulate"},
    "fit": {"options", "core", "files", "pbd", "simulate"},
}
SOURCES = {name: sorted(p for p in (ROOT / f"lib{name}").rglob("*") if p.suffix in {".h", ".cpp"}) for name in MAY_USE}


def includes(path: Path) -> list[str]:
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.parametrize("room", MAY_USE)
def test_includes_only_the_rooms_below(room):
    assert SOURCES[room], f"lib{room} has no sources"
    for path in SOURCES[room]:
        used = {i.split("/")[1] for i in includes(path) if i.startswith("doublet/")} - {"version.h"}  # of all
        assert used <= MAY_USE[room] | {room}, f"{path.relative_to(ROOT)} includes {used - MAY_USE[room] - {room}}"


@pytest.mark.parametrize("room", MAY_USE)
def test_links_only_the_rooms_below(room):
    text = (ROOT / f"lib{room}" / "CMakeLists.txt").read_text(encoding="utf-8")
    linked = set(re.findall(r"doublet(?:::|_)(\w+)", text)) - {"library", "headers", room}
    assert linked <= MAY_USE[room]


def test_pbd_needs_no_library_but_eigen():
    text = (ROOT / "libpbd" / "CMakeLists.txt").read_text(encoding="utf-8")
    assert set(re.findall(r"find_package\((\w+)", text)) <= {"Eigen3", "Threads"}  # those of the C++ library


@pytest.mark.parametrize("room", MAY_USE)
def test_the_package_asks_for_what_a_room_links(room):
    text = (ROOT / "cmake" / "doubletConfig.cmake.in").read_text(encoding="utf-8")
    found = re.findall(rf"set\(doublet_{room}_links ([^)]*)\)", text)
    assert set(" ".join(found).split()) == MAY_USE[room] - {"options"}  # headers alone, always there


@pytest.mark.parametrize("room", MAY_USE)
def test_public_headers_show_no_third_party_types_but_eigens(room):
    for path in SOURCES[room]:
        if "include" not in path.parts:
            continue
        for name in includes(path):
            own_or_standard = name.startswith(("doublet/", "Eigen/")) or re.fullmatch(r"[a-z_]+", name)
            assert own_or_standard, f"{path.relative_to(ROOT)} includes {name}"


def reached_from(path: Path) -> set[Path]:
    """The project's own files that a file includes, directly or not."""
    folders = [ROOT / f"lib{room}" / part for room in MAY_USE for part in ("include", "src")]
    reached, left = set(), [path]
    while left:
        at = left.pop()
        if at not in reached:
            reached.add(at)
            candidates = [folder / name for name in includes(at) for folder in (at.parent, *folders)]
            left.extend(c.resolve() for c in candidates if c.exists())
    return reached


@cache
def types_of(path: Path) -> frozenset[str]:
    text = path.read_text(encoding="utf-8")
    return frozenset(re.findall(r"^(?:class|struct|enum class) (\w+)", text, re.MULTILINE))


@pytest.mark.parametrize("room", MAY_USE)
def test_sources_include_what_declares_the_types_they_name(room):
    """CI compiles several sources at once, where one passes on what another includes."""
    public = {name: path for paths in SOURCES.values() for path in paths if "include" in path.parts for name in types_of(path)}
    for path in (p for p in SOURCES[room] if p.suffix == ".cpp"):
        code = re.sub(r'//.*|"(?:\\.|[^"\\\n])*"', "", path.read_text(encoding="utf-8"))
        named = set(re.findall(r"(?<!::)\b[A-Z]\w+", code)) - set(re.findall(r"(?:class|struct|using) (\w+)", code))
        for name in (named & public.keys()) - {n for reached in reached_from(path.resolve()) for n in types_of(reached)}:
            header = public[name].relative_to(ROOT)
            raise AssertionError(f"{path.relative_to(ROOT)} names {name} without including {header}")


def test_every_room_has_tests():
    for room in MAY_USE:
        assert list((ROOT / "tests" / room).glob("*.cpp")), f"tests/{room} is empty"


def test_python_modules_do_not_import_in_circles():
    """Wherever in the module the import stands; what the package itself exports is none of them."""
    folder = ROOT / "bindings" / "python" / "doublet"
    modules = {p.stem: p.read_text(encoding="utf-8") for p in folder.glob("*.py") if not p.stem.startswith("__")}
    pattern = re.compile(r"^\s*from (?:\.(\w+) import|\. import ([\w, ]+))", re.MULTILINE)
    uses = {name: set(re.findall(r"\w+", str(pattern.findall(text)))) & modules.keys() for name, text in modules.items()}
    for start in modules:
        reached, left = set(), list(uses[start])
        while left:
            name = left.pop()
            if name not in reached:
                reached.add(name)
                left += uses[name]
        assert start not in reached, f"{start}.py imports itself by way of others"
