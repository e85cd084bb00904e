#!/usr/bin/env python3
"""The module's stub, for editors and type checkers: pybind11-stubgen's, with plain types, and a typed keyword for every option.

make_stub.py MODULE STUB: MODULE is _doublet*.so as it was built. CMake calls it (CMakeLists.txt here), and installs the stub.
"""

import ast
import importlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

#: What pybind11-stubgen writes -> what one would.
PLAIN = (
    ("typing.SupportsFloat | typing.SupportsIndex", "float"),
    ("typing.SupportsInt | typing.SupportsIndex", "int"),
    ("typing.Annotated[numpy.ndarray, numpy.uint8]", "numpy.typing.NDArray[numpy.uint8]"),
    ("def __eq__(self, other: typing.Any) -> typing.Any:", "def __eq__(self, other: object) -> bool:"),
)
#: Of a class whose methods are there to be defined by subclasses, in its docstring.
SWAPPED = re.compile(r"Swap point|Subclass to replace|To replace it")
ANY_KEYWORD = "def __init__(self, **kwargs) -> None:"


def setters(node: ast.ClassDef) -> dict[str, str]:
    """Name -> type of everything that can be set."""
    found = {}
    for method in node.body:
        if isinstance(method, ast.FunctionDef) and any(ast.unparse(x).endswith(".setter") for x in method.decorator_list):
            found[method.name] = ast.unparse(method.args.args[1].annotation)
    return found


def keywords(options_class, types: dict[str, str]) -> str:
    """iterations: int = 8, substeps: int = 4, ... in the order of the description, then what is no option."""
    described, defaults = options_class.described(), options_class().to_dict()
    words = []
    for name in [*described, *sorted(types.keys() - described.keys())]:
        choices = described.get(name, {}).get("choices")
        kind = f"typing.Literal[{', '.join(map(repr, choices))}]" if choices and types[name] == "str" else types[name]
        default = repr(defaults[name]) if isinstance(defaults.get(name), (bool, int, float, str)) else "..."
        words.append(f"{name}: {kind} = {default}")
    return f"def __init__(self, *, {', '.join(words)}) -> None:"


def without_hooks(text: str) -> str:
    """Without __init_subclass__, which a type checker takes for a demand."""
    return re.sub(r"(    @\w+\n)?    def __init_subclass__\(.*\n +\.\.\.\n", "", text)


def given_arrays(text: str) -> str:
    """What subclasses define is given arrays, and may say so: whoever calls it gives it some."""
    lines = text.split("\n")
    for node in ast.parse(text).body:
        if not isinstance(node, ast.ClassDef) or not SWAPPED.search(ast.get_docstring(node) or ""):
            continue
        for method in (m for m in node.body if isinstance(m, ast.FunctionDef) and m.name != "__init__"):
            line = lines[method.lineno - 1]
            lines[method.lineno - 1] = re.sub(
                r"typing\.Annotated\[numpy\.typing\.ArrayLike, (numpy\.\w+), ",
                r"typing.Annotated[numpy.typing.NDArray[\1], ",
                line,
            )
    return "\n".join(lines)


def tidy(text: str, native) -> str:
    """`native` is the module that the text describes."""
    for before, after in PLAIN:
        text = text.replace(before, after)
    text = re.sub(r"(\b[a-z_]+: [A-Z]\w+) = None", r"\1 | None = None", text)
    text = given_arrays(without_hooks(text))
    lines = text.split("\n")
    for node in ast.parse(text).body:
        options_class = getattr(native, node.name, None) if isinstance(node, ast.ClassDef) else None
        if not hasattr(options_class, "described"):
            continue
        (at,) = [i for i in range(node.lineno - 1, node.end_lineno) if lines[i].strip() == ANY_KEYWORD]
        lines[at] = re.match(r" *", lines[at])[0] + keywords(options_class, setters(node))
    return "\n".join(lines)


def imported(module: Path):
    sys.path.insert(0, str(module.parent))
    try:
        return importlib.import_module(module.name.partition(".")[0])
    except ImportError as error:
        sys.exit(f"{module}: expected a module that {sys.executable} imports, to make its stub, found {error.__cause__ or error}")


def generated(module: Path, name: str) -> str:
    """What pybind11-stubgen writes; what it cannot name in Python, such as a type of another room, it says in a comment."""
    with tempfile.TemporaryDirectory() as folder:
        options = ["--ignore-all-errors", "--numpy-array-wrap-with-annotated", "-o", folder]
        command = [sys.executable, "-m", "pybind11_stubgen", name, *options]
        done = subprocess.run(command, env={**os.environ, "PYTHONPATH": path_with(module.parent)}, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{module}: expected pybind11-stubgen to make its stub, found\n{done.stdout}{done.stderr}")
        return (Path(folder) / f"{name}.pyi").read_text(encoding="utf-8")


def path_with(folder: Path) -> str:
    """PYTHONPATH: pip's isolated build has set one."""
    return os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])


if __name__ == "__main__":
    module, stub = map(Path, sys.argv[1:])
    native = imported(module)
    stub.write_text(tidy(generated(module, native.__name__), native), encoding="utf-8")
