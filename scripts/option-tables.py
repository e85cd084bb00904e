"""Writes the tables between `<!-- options CLASS -->` and `<!-- /options -->` in docs/*.md: what options say of themselves."""

import re
from pathlib import Path

import doublet as d
from doublet import reconstruct
from doublet.cli.commands.animate import ANIMATE_GROUPS
from doublet.cli.option_flags import to_text
from doublet.reconstruct.options import plain
from doublet.scan.make_scan import GROUPS as SCAN_GROUPS

DOCS = Path(__file__).resolve().parents[1] / "docs"
MARKED = re.compile(r"(<!-- options (\w+) -->\n).*?(<!-- /options -->)", re.DOTALL)
#: Name on the command line (`--GROUP-OPTION`) of the classes that are there.
GROUPS = {
    c.__name__: g for g, c in {**reconstruct.OPTION_GROUPS, **SCAN_GROUPS, **ANIMATE_GROUPS, "train": d.TrainOptions}.items()
}


def as_text(value) -> str:
    return f"{value:g}" if isinstance(value, float) else to_text(value)


def default_of(value, papers, unit: str) -> str:
    """A default with its unit, and the paper's if that differs."""
    text = f"{as_text(value)} {unit}".strip()
    return text if plain(papers) == plain(value) else f"{text}; the paper's: {as_text(papers)}"


def table(class_name: str) -> str:
    options_class = getattr(d, class_name)
    group = GROUPS.get(class_name, "")
    described = options_class.described()
    papers = options_class.paper().to_dict() if hasattr(options_class, "paper") else {}
    flags = f" (`--{group}-...`)" if group else ""
    rows = [f"| `{class_name}`{flags} | default | takes | |", "| --- | --- | --- | --- |"]
    for name, value in options_class().to_dict().items():
        if type(value).__name__.endswith("Options") or type(value) is d.ParameterSpace:
            continue  # a table of its own
        told = described[name]
        takes = (told["takes"] or "").removeprefix("a number ").removeprefix("of ")
        meaning = ". ".join(text for text in (told["meaning"], told["why"]) if text).replace("|", "\\|")
        rows.append(f"| `{name}` | {default_of(value, papers.get(name, value), told['unit'])} | {takes} | {meaning} |")
    return "\n".join(rows) + "\n"


def written(page: str) -> str:
    """A page with its tables as they should be."""
    return MARKED.sub(lambda m: m[1] + table(m[2]) + m[3], page)


if __name__ == "__main__":
    for path in DOCS.glob("*.md"):
        path.write_text(written(path.read_text(encoding="utf-8")), encoding="utf-8")
