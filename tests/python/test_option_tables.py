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
    "options": r"<!-- options|animation\.md#options",
}
STAGES = (
    "scan", "capture-template", "capture-tracking", "calibration-refinement", "segmentation", "body-model", "garment", "cloth",
    "material-estimation", "animation", "player",
)  # fmt: skip
OF_THE_PAPER = set(STAGES) - {"scan", "calibration-refinement", "player"}


@pytest.mark.parametrize("stage", STAGES)
def test_the_page_of_a_stage_is_whole(stage):
    page = PAGES[f"{stage}.md"]
    assert [name for name, pattern in PARTS.items() if not re.search(pattern, page)] == []
    before, *sections = re.split(r"^## ", page, flags=re.MULTILINE)
    assert "![" in before, "what it does is shown in a picture"
    assert [text.partition("\n")[0] for text in sections] == ["Example", "How it works", "Options", "Limits"]
    if stage in OF_THE_PAPER:
        assert "### Departures from the paper" in page


#: Words of pages that tell how something came to be. What was tried is in docs/notes.
HISTORY = re.compile(
    r"\b(no longer|any ?more|formerly|previously|in a trial|as before|older build|earlier (build|version)s?|tried,|was tried|"
    r"tried (in the same way|on top|before)|used to (be|have)|until (version|now)|not kept)\b|\| (before|old|now|new) \|",
    re.IGNORECASE,
)


@pytest.mark.parametrize("page", [*PAGES, "../README.md"])
def test_a_page_says_what_is_true_now(page):
    assert [m[0] for m in HISTORY.finditer((tables.DOCS / page).read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize("page", [*PAGES, "../README.md"])
def test_every_row_of_a_table_has_its_columns(page):
    """A bar in code parts cells, too, unless a backslash stands before it."""
    text = re.sub(r"```.*?```", "", (tables.DOCS / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        bars = [len(re.findall(r"(?<!\\)\|", row)) for row in table.splitlines()]
        assert bars == [bars[0]] * len(bars), table.splitlines()[bars.index(next(n for n in bars if n != bars[0]))]


def test_the_results_fit_on_one_page():
    assert PAGES["results.md"].count("\n") <= 150
