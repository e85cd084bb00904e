"""What a stage of a reconstruction is, and how one of them is replaced."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .. import _doublet as d
from .workspace import Workspace


@dataclass(frozen=True)
class Stage:
    name: str
    reads: tuple[str, ...]  # files of OUT
    writes: tuple[str, ...]  # files of OUT
    groups: tuple[str, ...]  # option groups
    run: Callable[[Workspace], dict]  # returns the numbers worth recording
    session_files: Callable[[d.Session], list[Path]] = lambda session: []
    may_read: tuple[str, ...] = ()  # files of OUT that count as inputs if they are there
    uses_seed: bool = False
    uses_body_model: bool = False
    goes_on_from: tuple[str, ...] = ()  # files of OUT that a stage that was stopped goes on from


def with_stage(stages: tuple[Stage, ...], stage: Stage) -> tuple[Stage, ...]:
    """`stages` with `stage` in the place of the one of its name: Job(..., stages=with_stage(STAGES, mine)). Raises ValueError if
    there is none, or a file is missing in `stage.writes` that a later stage reads."""
    names = [s.name for s in stages]
    if stage.name not in names:
        raise ValueError(f"stage '{stage.name}': expected one of {', '.join(names)}")
    at = names.index(stage.name)
    needed = {name for later in stages[at + 1 :] for name in later.reads}
    missing = [name for name in stages[at].writes if name in needed and name not in stage.writes]
    if missing:
        raise ValueError(f"stage '{stage.name}': expected it to write {', '.join(missing)}, which later stages read")
    return (*stages[:at], stage, *stages[at + 1 :])
