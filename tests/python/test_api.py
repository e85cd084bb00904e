"""The public API is the one of the snapshot (scripts/api-snapshot.py, docs/stability.md)."""

import importlib.util
from pathlib import Path

import doublet as d
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def api():
    spec = importlib.util.spec_from_file_location("api_snapshot", ROOT / "scripts" / "api-snapshot.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_api_is_that_of_the_snapshot(api):
    changed = api.changes(api.known(), api.snapshot())
    assert not changed, "python scripts/api-snapshot.py, after a line in CHANGELOG.md: " + "; ".join(changed)


def test_a_change_needs_a_line_in_the_changelog(api, tmp_path, monkeypatch, capsys):
    header = "/// m\nstruct A {\n  int a = 1; ///< so many\n};\n"
    assert api.declarations(header) == api.declarations(header.replace("so many", "a count"))
    assert api.declarations(header) != api.declarations(header.replace("= 1", "= 2"))
    option = 'option(&O::a, "a", "Number of them", "More take longer")'
    assert api.declarations(option) == api.declarations(option.replace("of them", 'that are "\n  "counted'))
    assert api.declarations(option) != api.declarations(option.replace('"a"', '"b"'))
    root, include = tmp_path, tmp_path / "libcore/include/doublet/core"
    (include / "parts").mkdir(parents=True)
    (root / "tests").mkdir()
    (root / "_doublet.pyi").write_text('def f(a: int) -> int:\n    """Doc."""\n')
    (include / "a.h").write_text(header)
    (include / "parts" / "b.h").write_text(header)
    changelog = root / "CHANGELOG.md"
    changelog.write_text("# Changes\n\n## Unreleased\n\n### Added\n\n- all\n")
    monkeypatch.setattr(api, "ROOT", root)
    monkeypatch.setattr(api, "STUB", root / "_doublet.pyi")
    monkeypatch.setattr(api, "SNAPSHOT", root / "tests" / "api.txt")
    assert api.main([]) == 0
    (include / "parts" / "b.h").write_text("")
    assert api.main(["--check"]) == 0  # experimental
    (include / "a.h").write_text(header.replace("= 1", "= 2"))
    assert api.main(["--check"]) == 1
    assert api.main([]) == 1 and "changed: doublet/core/a.h" in capsys.readouterr().out
    changelog.write_text(changelog.read_text() + "- a begins at two\n")
    assert api.main([]) == 0 and api.main(["--check"]) == 0


PLACES = {
    "CMakeLists.txt": " VERSION {} ",
    "pyproject.toml": 'version = "{}"',
    "CITATION.cff": "version: {}",
    "packaging/conda/recipe.yaml": 'version: "{}"',
}


def test_versions_compare():
    assert ".".join(map(str, d.version_info)) == d.__version__ and (0, 0, 99) < d.version_info < (1000,)


@pytest.mark.parametrize("place", PLACES)
def test_the_version_is_one(place):
    assert PLACES[place].format(d.__version__) in (ROOT / place).read_text(encoding="utf-8")
