"""The type stubs name what the module has (scripts/make-stubs.sh writes them)."""

import ast
from pathlib import Path

import doublet as d
from doublet import _doublet

STUBS = Path(d.__file__).with_name("_doublet.pyi")


def test_stubs_are_up_to_date():
    tree = ast.parse(STUBS.read_text(encoding="utf-8"))
    classes = {
        n.name: {f.name for f in n.body if isinstance(f, ast.FunctionDef)} for n in tree.body if isinstance(n, ast.ClassDef)
    }
    functions = {n.name for n in tree.body if isinstance(n, ast.FunctionDef)}
    public = {name for name in dir(_doublet) if not name.startswith("_")}
    assert set(classes) | functions == public
    for name, methods in classes.items():
        actual = {m for m in vars(getattr(_doublet, name)) if not m.startswith("_")}
        assert actual <= methods | {"__init__"} or name == "Error", f"{name}: {actual - methods} are not in the stubs"
