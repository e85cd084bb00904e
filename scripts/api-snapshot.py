#!/usr/bin/env python3
"""tests/api.txt: a line for each stable header and each name of the Python module, with a hash of what it declares.

python scripts/api-snapshot.py          # writes it; refuses unless CHANGELOG.md has a new line under Breaking or Added
python scripts/api-snapshot.py --check  # says what has changed since, and fails if anything has

The Python module is that of the installed package, by its stub.
"""

import ast
import hashlib
import importlib.util
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SNAPSHOT = ROOT / "tests" / "api.txt"
STUB = Path(importlib.util.find_spec("doublet").origin).with_name("_doublet.pyi")
CHANGELOG = "CHANGELOG.md, Unreleased"  # the first line of the snapshot, with a hash of what is said there


def short_hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def declarations(header: str) -> str:
    """A header without comments and layout, and without sentences, which options and kits have for people."""
    code = " ".join(re.sub(r"//[^\n]*|/\*.*?\*/", " ", header, flags=re.DOTALL).split()).replace("( ", "(")
    text = r'"(?:\\.|[^"\\])*"'
    return re.sub(f"{text}(?: {text})*", lambda found: '""' if " " in found[0] else found[0], code)


def stable_headers() -> dict[str, str]:
    found = {}
    for path in sorted(ROOT.glob("lib*/include/doublet/**/*.h")):
        name = path.as_posix().split("/include/")[-1]
        if "/parts/" not in name:
            found[name] = short_hash(declarations(path.read_text(encoding="utf-8")))
    return found


def without_docs(node: ast.AST) -> str:
    """A class or function of the stubs as text, without docstrings."""
    for inner in ast.walk(node):
        if isinstance(inner, (ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(inner) is not None:
            inner.body = inner.body[1:] or [ast.Pass()]
    return ast.unparse(node)


def python_names() -> dict[str, str]:
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    texts: dict[str, str] = {}
    for node in tree.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_"):
            texts[f"doublet.{node.name}"] = texts.get(f"doublet.{node.name}", "") + without_docs(node)
    return {name: short_hash(text) for name, text in sorted(texts.items())}


def announced(changelog: str) -> str:
    """What stands under Breaking and Added of the first version in the changelog."""
    newest = changelog.split("\n## ")[1]
    return "".join(part for part in newest.split("\n### ")[1:] if part.startswith(("Breaking", "Added")))


def snapshot() -> dict[str, str]:
    said = short_hash(announced((ROOT / "CHANGELOG.md").read_text(encoding="utf-8")))
    return {CHANGELOG: said, **stable_headers(), **python_names()}


def known() -> dict[str, str]:
    if not SNAPSHOT.exists():
        return {}
    return dict(line.rsplit(" ", 1) for line in SNAPSHOT.read_text(encoding="utf-8").splitlines())


def changes(before: dict[str, str], now: dict[str, str]) -> list[str]:
    """What differs, but for the changelog itself."""
    names = sorted((before.keys() | now.keys()) - {CHANGELOG})
    kind = {(False, True): "added", (True, False): "removed", (True, True): "changed"}
    return [f"{kind[n in before, n in now]}: {n}" for n in names if before.get(n) != now.get(n)]


def main(arguments: list[str]) -> int:
    before, now = known(), snapshot()
    changed = changes(before, now)
    print("\n".join(changed))
    if arguments == ["--check"]:
        return 1 if changed else 0
    if changed and before.get(CHANGELOG) == now[CHANGELOG]:
        print("CHANGELOG.md: expected a new line under Breaking or Added for what has changed, found none", file=sys.stderr)
        return 1
    SNAPSHOT.write_text("".join(f"{name} {digest}\n" for name, digest in now.items()), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
