"""The site of these pages, with the reference of C++ (Doxygen, Breathe) and Python (autodoc): scripts/build-docs.sh builds it."""

import inspect
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import doublet
from doublet import _doublet

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
XML = ROOT / "build" / "docs" / "doxygen" / "xml"
#: Written here on every build, and not committed.
API = DOCS / "api"

project = "doublet"
version = release = doublet.__version__
copyright = "the doublet authors, BSD 3-clause licence"
root_doc = "contents"
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
exclude_patterns = ["notes"]  # measured and tried, for whoever changes a stage
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"doublet {version}"
highlight_language = "text"
autodoc_typehints = "none"
breathe_projects = {"doublet": str(XML)}
breathe_default_project = "doublet"
breathe_default_members = ("members",)
breathe_show_include = False
#: Every header opens the namespace again; a link to a file of the sources is a copy of it.
suppress_warnings = ["duplicate_declaration.cpp"]

#: Modules of Python that others build on (stability.md).
MODULES = (
    "common.console", "evaluation.cameras", "evaluation.metrics", "evaluation.motion_metrics", "evaluation.study",
    "evaluation.synthesize", "export.animate", "export.bone_map", "export.character_edit", "export.clips", "export.cloth",
    "export.level_of_detail", "export.usd", "export.vertex_animation", "optimizers", "pages.report", "reconstruct", "scan",
    "session.new_session", "testing",
)  # fmt: skip

#: Folder of a library -> what its page says.
ROOMS = {
    "core": "Meshes, skeleton, skinning, cameras, z-buffer",
    "rays": "Rays, closest points, distances",
    "files": "`.npz`, the files between stages",
    "capture": "Scan to rigged template; videos to reference performance; calibrations",
    "segment": "Which vertices are loose cloth; the garment's own mesh",
    "bodymodel": "Statistical body, its fit under clothes, collision proxies",
    "pbd": "Position-based cloth",
    "simulate": "Pose in, surface out",
    "animate": "Motion files and retargeting, display, `character.glb`",
    "fit": "Image energy and search, to the material",
    "reconstruct": "All stages, each when it is out of date",
}


# --- C++


def run_doxygen() -> None:
    """XML of the public headers. What Doxygen complains about is an error here, too."""
    XML.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(["doxygen", str(DOCS / "Doxyfile")], cwd=ROOT, check=True)
    for path in XML.glob("*.xml"):
        tree = ElementTree.parse(path)
        for compound in tree.getroot().iter("compounddef"):
            tidy(compound)
        tree.write(path, encoding="utf-8", xml_declaration=True)


def tidy(compound) -> None:
    """Leaves out what is private, and says of every option what it says of itself (`describe`)."""
    name = compound.findtext("compoundname", "").split("::")[-1]
    options = getattr(doublet, name, None)
    described = options.described() if hasattr(options, "described") else {}
    for section in compound.findall("sectiondef"):
        if section.get("kind", "").startswith("private"):
            compound.remove(section)
            continue
        for member in section.findall("memberdef"):
            if member.findtext("name") == "describe":
                section.remove(member)
            initializer = member.find("initializer")
            if initializer is not None and re.search(r"\{\s*\.|\[\]", "".join(initializer.itertext())):
                member.remove(initializer)  # a designated initializer, a lambda: Sphinx reads neither
            brief, told = member.find("briefdescription"), described.get(member.findtext("name"))
            if told and brief is not None and not "".join(brief.itertext()).strip():
                takes = " ".join(t for t in (told["takes"], told["unit"]) if t)
                ElementTree.SubElement(brief, "para").text = told["meaning"] + (f"; {takes}" if takes else "")


def cpp_page(room: str) -> str:
    lines = [f"# C++: doublet::{room}", "", f"{ROOMS[room]}. `find_package(doublet COMPONENTS {room})`.", ""]
    for part in ("types", room) if room == "core" else (room,):  # headers that come with every library
        for header in sorted((ROOT / f"lib{part}" / "include" / "doublet" / part).glob("*.h")):
            lines += [f"## doublet/{part}/{header.name}", "", f"```{{doxygenfile}} {header.name}", "```", ""]
    return "\n".join(lines)


# --- Python


def room_of(name: str) -> str:
    """The library that a name of the module binds: the source of the bindings that names it."""
    for path in sorted((ROOT / "bindings" / "src").glob("*.cpp")):
        if re.search(rf'"{name}"|OptionsClass<{name}>', path.read_text(encoding="utf-8")):
            return path.stem.partition("_")[0]
    return "core"


def python_page(room: str, names: list[str]) -> str:
    lines = [f"# Python: {room}", "", f"{ROOMS[room]}. All of it is in `doublet`; docs of C++: [{room}](cpp-{room}.md).", ""]
    lines += ["```{eval-rst}", ".. currentmodule:: doublet", ""]
    for name in sorted(names, key=lambda n: (not inspect.isclass(getattr(doublet, n)), n)):
        if inspect.isclass(getattr(doublet, name)):
            lines += [f".. autoclass:: {name}", "   :members:", "   :special-members: __init__", ""]
        else:
            lines += [f".. autofunction:: {name}", ""]
    return "\n".join([*lines, "```", ""])


def modules_page() -> str:
    lines = ["# Python: modules", "", "What is written in Python, behind the command line.", "", "```{eval-rst}"]
    for name in MODULES:
        lines += [f"doublet.{name}", "-" * (8 + len(name)), "", f".. automodule:: doublet.{name}", "   :members:", ""]
    return "\n".join([*lines, "```", ""])


def as_plain_text(app, what, name, obj, options, lines: list[str]) -> None:
    """Our docstrings are plain text, but for names in single backticks."""
    escaped = (re.sub(r"([*|\\]|^\(|\b_|_\b)", r"\\\1", line.strip()) for line in lines)
    lines[:] = [re.sub(r"`([^`]+)`", r"``\1``", line) for line in escaped]


#: What pybind11 writes -> what one would.
SHORTER = (
    (r"doublet\._doublet\.", ""),
    (r"^\(self(: \w+)?(, )?", "("),
    (r"<(\w+) object at 0x[0-9a-f]+>", r"\1()"),
    (r"typing\.Annotated\[numpy\.typing\.(ArrayLike|NDArray\[numpy\.\w+\])(, numpy\.\w+)?(, [\"']\[[^\]]*\][\"'])?\]", "array"),
    (r"collections\.abc\.|typing\.(?=Any|Callable)", ""),
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "float"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "int"),
)


def shorter(text: str | None) -> str | None:
    for pattern, plain in SHORTER:
        text = re.sub(pattern, plain, text) if text else text
    return text


def signature(app, what, name, obj, options, arguments, result):
    return shorter(arguments), shorter(result)


# --- all


def write_api_pages(app) -> None:
    run_doxygen()
    API.mkdir(exist_ok=True)
    names = [name for name in dir(_doublet) if not name.startswith("_") and name not in doublet.testing.__all__]
    rooms = {name: room_of(name) for name in names}
    for room in ROOMS:
        (API / f"cpp-{room}.md").write_text(cpp_page(room), encoding="utf-8")
        own = [name for name in names if rooms[name] == room]
        if own:
            (API / f"python-{room}.md").write_text(python_page(room, own), encoding="utf-8")
    (API / "python-modules.md").write_text(modules_page(), encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("](docs/", "](../")
    (API / "changes.md").write_text(changes, encoding="utf-8")


def links_of_the_site(app, name: str, source: list[str]) -> None:
    source[0] = source[0].replace("](../CHANGELOG.md)", "](api/changes.md)")


def setup(app) -> None:
    app.connect("builder-inited", write_api_pages)
    app.connect("source-read", links_of_the_site)
    app.connect("autodoc-process-docstring", as_plain_text)
    app.connect("autodoc-process-signature", signature)
