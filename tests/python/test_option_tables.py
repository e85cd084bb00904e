"""The option tables of docs/*.md are those that scripts/option-tables.py writes."""

import importlib.util
import re
from pathlib import Path

import doublet as d
import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "option-tables.py"
spec = importlib.util.spec_from_file_location("option_tables", SCRIPT)
tables = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tables)
PAGES = {path.name: path.read_text(encoding="utf-8") for path in sorted(tables.DOCS.glob("*.md"))}


@pytest.mark.parametrize("page", PAGES)
def test_tables_are_up_to_date(page):
    assert tables.written(PAGES[page]) == PAGES[page], "python scripts/option-tables.py writes the tables again"


def test_every_options_class_has_one_table():
    marked = sorted(m[2] for page in PAGES.values() for m in tables.MARKED.finditer(page))
    assert marked == sorted(n for n in dir(d) if hasattr(getattr(d, n), "described") and n != "SolverSettings")


PARTS = {
    "citation": r"\d{4}",
    "picture": r"!\[",
    "snippet": r"```(cpp|python)",
    "options": r"<!-- options",
    "departures": r"## Departures",
}
STAGES = (
    "capture-template", "capture-tracking", "segmentation", "body-model", "garment", "cloth", "material-estimation", "animation",
)  # fmt: skip


@pytest.mark.parametrize("stage", STAGES)
def test_the_page_of_a_stage_is_whole(stage):
    missing = [name for name, pattern in PARTS.items() if not re.search(pattern, PAGES[f"{stage}.md"])]
    assert missing == []
