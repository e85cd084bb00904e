"""The stub in the installed package names what the module has (bindings/make_stub.py writes it while building)."""

import ast
import subprocess
import sys
from pathlib import Path

import doublet as d
from doublet import _doublet
from doublet.common.renamed import ATTRIBUTES

STUBS = Path(d.__file__).with_name("_doublet.pyi")
MAKE = Path(__file__).parents[2] / "bindings" / "make_stub.py"


def members(node: ast.ClassDef) -> set[str]:
    methods = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
    return methods | {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}


def test_stubs_are_up_to_date():
    tree = ast.parse(STUBS.read_text(encoding="utf-8"))
    classes = {node.name: members(node) for node in tree.body if isinstance(node, ast.ClassDef)}
    functions = {n.name for n in tree.body if isinstance(n, ast.FunctionDef)}
    public = {name for name in dir(_doublet) if not name.startswith("_")}
    assert set(classes) | functions == public
    for name, described in classes.items():
        missing = (
            {m for m in vars(getattr(_doublet, name)) if not m.startswith("_")} - described - ATTRIBUTES.get(name, {}).keys()
        )
        assert not missing, f"{name}: {missing} are not in the stubs"


def test_every_option_is_a_typed_keyword_with_its_default():
    """Of the constructor, for editors and type checkers."""
    tree = ast.parse(STUBS.read_text(encoding="utf-8"))
    for node in (n for n in tree.body if isinstance(n, ast.ClassDef) and hasattr(getattr(d, n.name), "described")):
        options_class = getattr(d, node.name)
        made = [n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__" and n.args.kwonlyargs]
        (arguments,) = [n.args for n in made]
        given = [a.arg for a in arguments.kwonlyargs]
        assert given[: len(options_class.described())] == list(options_class.described()), node.name
        assert all(a.annotation for a in arguments.kwonlyargs)
        for name, default in zip(given, arguments.kw_defaults):
            if ast.unparse(default) != "...":
                assert ast.literal_eval(default) == options_class().to_dict()[name], f"{node.name}.{name}"


def test_no_stub_is_an_error(tmp_path):
    """Of the build, which ends: a package without one would look whole."""
    (tmp_path / "_doublet.py").write_text("raise ImportError('no symbol x')")
    command = [sys.executable, MAKE, tmp_path / "_doublet.py", tmp_path / "made.pyi"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode != 0 and not (tmp_path / "made.pyi").exists()
    assert "_doublet.py: expected a module that" in done.stderr and done.stderr.endswith("its stub, found no symbol x\n")
