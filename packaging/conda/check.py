"""Renders recipe.yaml as rattler-build would, without a network, and holds it against pyproject.toml.

python packaging/conda/check.py    # needs Python 3.11, and py-rattler-build from PyPI

It does not build: that needs conda-forge's packages, and so says nothing of whether these are there and fit together.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import tomllib
from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, VariantConfig

RECIPE = Path(__file__).with_name("recipe.yaml")
ROOT = RECIPE.parents[2]
#: What conda-forge pins for every recipe.
PINNED = {"c_stdlib": ["sysroot"], "c_stdlib_version": ["2.17"], "cxx_compiler": ["gxx"], "cxx_compiler_version": ["14"]}
#: PyPI's name -> conda-forge's, where they differ.
RENAMED = {"matplotlib": "matplotlib-base"}


def rendered(python: str, platform: str = "linux-64") -> list[dict]:
    recipe = Stage0Recipe.from_file(RECIPE)
    config = PlatformConfig(target_platform=platform, build_platform=platform, host_platform=platform)
    variants = VariantConfig({"python": [python], **PINNED})
    return [variant.recipe.to_dict() for variant in recipe.render(variants, RenderConfig(platform=config))]


def requirement(line: str, python: str) -> str:
    """A line of pyproject.toml as conda writes it; empty if its marker says that `python` does not need it."""
    name, bound, marker = re.fullmatch(r"([\w-]+)(\S*?)(?:; python_version < '(3\.\d+)')?", line).groups()
    if marker and tuple(map(int, python.split("."))) >= tuple(map(int, marker.split("."))):
        return ""
    return f"{RENAMED.get(name, name)} {bound}"


def problems(python: str, project: dict, build_requires: list[str]) -> list[str]:
    outputs = rendered(python)
    if len(outputs) != 1:
        return [f"expected one package, found {len(outputs)}"]
    recipe = outputs[0]
    wanted = {
        "host": {requirement(line, python) for line in build_requires},
        "run": {requirement(line, python) for line in project["dependencies"]} - {""},
    }
    found = [f"{kind}: expected {line}" for kind, lines in wanted.items() for line in lines - set(recipe["requirements"][kind])]
    scripts = [f"{name} = {function}" for name, function in project["scripts"].items()]
    for what, expected, is_there in (
        ("name", project["name"], recipe["package"]["name"]),
        ("version", project["version"], recipe["package"]["version"]),
        ("entry points", scripts, recipe["build"]["python"]["entry_points"]),
    ):
        if expected != is_there:
            found.append(f"{what}: expected {expected}, found {is_there}")
    files = [RECIPE.parent / source["path"] for source in recipe["source"] if "path" in source]
    files += [ROOT / name for name in recipe["about"]["license_file"]]
    return found + [f"{file}: no such file" for file in files if not file.exists()]


def main() -> int:
    described = tomllib.loads((ROOT / "pyproject.toml").read_text())
    project = described["project"]
    lowest = project["requires-python"].removeprefix(">=")
    skipped = f'match(python, "<{lowest}")' in RECIPE.read_text()  # rendering leaves `skip` away
    print("recipe.yaml:", "skips" if skipped else "expected it to skip", f"Python below {lowest}")
    bad = 0 if skipped else 1
    for python in (lowest, "3.10", "3.11", "3.13"):
        found = problems(python, project, described["build-system"]["requires"])
        print(f"recipe.yaml, Python {python}:", "; ".join(found) or "rendered")
        bad += len(found)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
