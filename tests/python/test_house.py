"""The rules of the house: who may include and link whom, and what stays out of public headers."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAY_USE = {
    "options": set(),
    "types": set(),
    "core": {"options", "types"},
    "rays": {"options", "types", "core"},
    "files": {"options", "types", "core"},
    "capture": {"options", "types", "core", "rays", "files"},
    "segment": {"options", "types", "core", "rays"},
    "bodymodel": {"options", "types", "core", "rays", "files"},
    "pbd": {"options", "types"},
    "simulate": {"options", "types", "core", "pbd"},
    "animate": {"options", "types", "core", "rays", "files", "pbd", "simulate"},
    "fit": {"options", "types", "core", "rays", "files", "pbd", "simulate"},
    "reconstruct": {
        "options",
        "types",
        "core",
        "rays",
        "files",
        "capture",
        "segment",
        "bodymodel",
        "pbd",
        "simulate",
        "animate",
        "fit",
    },
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
    text = (ROOT / "cmake" / "doubletRooms.cmake").read_text(encoding="utf-8")
    found = re.findall(rf"set\(doublet_{room}_links ([^)]*)\)", text)
    assert set(" ".join(found).split()) == MAY_USE[room] - {"options", "types"}  # headers alone, always there


def test_stable_headers_include_no_experimental_ones():
    """What is promised does not rest on what is not (docs/stability.md)."""
    stable = [p for paths in SOURCES.values() for p in paths if "include" in p.parts and "parts" not in p.parts]
    assert len(stable) > 50
    assert {str(p.relative_to(ROOT)): found for p in stable if (found := [i for i in includes(p) if "/parts/" in i])} == {}


@pytest.mark.parametrize("room", MAY_USE)
def test_public_classes_own_what_they_keep(room):
    """Members (name_) that are references or pointers to what somebody else owns (docs/architecture.md)."""
    for path in (p for p in SOURCES[room] if "include" in p.parts and "testing" not in p.parts and "detail" not in p.parts):
        text = path.read_text(encoding="utf-8")
        kept = re.findall(r"^ +(?:const )?[\w:<>, ]+ ?[&*] ?(\w+_)(?: = nullptr)?;", text, re.MULTILINE)
        assert kept == (["data_"] if path.name == "geometry.h" else []), path.relative_to(ROOT)  # a VerticesView is a pointer


def public_headers() -> dict[str, str]:
    """Name -> text, of those that others include; not of a kit or of what is not promised."""
    paths = [p for found in SOURCES.values() for p in found if "include" in p.parts and not {"testing", "detail"} & {*p.parts}]
    return {str(p.relative_to(ROOT)): p.read_text(encoding="utf-8") for p in paths}


def test_every_interface_says_what_is_called_from_several_threads():
    """docs/architecture.md, "The shape of a stage"."""
    classes = re.compile(r"((?:^///[^\n]*\n)*)^class (\w+)[^;{]*\{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
    interfaces = {
        name: comment + body
        for text in public_headers().values()
        for comment, name, body in classes.findall(text)
        if re.search(r"virtual [^;]*= 0;", body)
    }
    assert len(interfaces) == 14, sorted(interfaces)
    assert [name for name, text in interfaces.items() if "Threads:" not in text] == []


def test_public_headers_have_types_in_the_place_of_bytes_and_words():
    """A mask is a Mask; a word of a few is an enumeration. Files in memory and free texts are what they are."""
    headers = public_headers()
    bytes_of = {name for name, text in headers.items() if "vector<std::uint8_t>" in text}
    files = {"animate/character.h", "animate/parts/image_file.h", "core/image.h", "files/npz.h", "types/geometry.h"}
    assert {name.partition("include/doublet/")[2] for name in bytes_of} == files
    words = {word for text in headers.values() for word in re.findall(r"^ +std::string (\w+) = \"", text, re.MULTILINE)}
    assert words == {"name", "licence", "units", "options"}


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


# --- the Python package

PACKAGE = ROOT / "bindings" / "python" / "doublet"
MODULES = sorted(PACKAGE.rglob("*.py"))
ALONE = {"optimizers", "testing"}  # modules that are rooms of their own


def room_table() -> dict[str, set[str]]:
    """Room -> rooms that it may import: the table of docs/architecture.md."""
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = text.split("## The Python package")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \| .* \| ([^|]*) \|$", table, re.MULTILINE)
    rooms = [room for room, _ in rows]
    return {room: set(rooms) if may == "all" else set(re.findall(r"\w+", may)) - {"nothing"} for room, may in rows}


def name_of(path: Path) -> str:
    """reconstruct.stages; a package by its own name."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def imported(path: Path) -> frozenset[str]:
    """What of the package a module imports, wherever the import stands: names of modules, "" = the package itself."""
    here = path.relative_to(PACKAGE).parent.parts
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {a.name.partition(".")[2] for a in node.names if a.name.split(".")[0] == "doublet"}
        if not isinstance(node, ast.ImportFrom) or (node.level == 0 and (node.module or "").split(".")[0] != "doublet"):
            continue
        base = here[: len(here) - node.level + 1] if node.level else ()
        inside = (node.module or "").split(".")[0 if node.level else 1 :]
        at = [*base, *(part for part in inside if part)]
        for alias in node.names:
            whole = ".".join([*at, alias.name])
            found.add(whole if whole in KNOWN else ".".join(at))
    return frozenset(found)


KNOWN = {name_of(path) for path in MODULES} | {"_doublet"}


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_no_python_module_or_class_is_too_long(path):
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= 400
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ClassDef):
            assert node.end_lineno - node.lineno < 300, node.name


def test_the_table_of_rooms_is_that_of_the_folders_and_has_no_circle():
    table, above = room_table(), set()
    assert table.keys() == {p.parent.name for p in PACKAGE.glob("*/__init__.py")}
    assert {p.stem for p in PACKAGE.glob("*.py") if not p.stem.startswith("_")} == ALONE
    for room, may in table.items():
        assert may - {room} <= above, f"{room} may import what stands below it"
        above.add(room)


@pytest.mark.parametrize("path", [p for p in MODULES if p.parent != PACKAGE], ids=name_of)
def test_a_room_of_the_package_imports_what_it_may(path):
    room = name_of(path).split(".")[0]
    for name in imported(path) - {"_doublet", "_lazy"}:
        used = name.split(".")[0]
        assert used, "the package itself"
        assert used in room_table()[room] | {room}, f"{name_of(path)} imports {name}"


def test_python_modules_do_not_import_in_circles():
    uses = {name_of(path): imported(path) - {"_doublet", ""} for path in MODULES}
    for start in uses:
        reached, left = set(), list(uses[start])
        while left:
            name = left.pop()
            if name not in reached:
                reached.add(name)
                left += uses.get(name, ())
        assert start not in reached, f"{start} imports itself by way of others"
