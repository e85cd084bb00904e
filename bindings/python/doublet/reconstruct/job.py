"""One reconstruction: where from, where to, how."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ..common.quality_checks import Finding
from .stage import Stage
from .stages import STAGES
from .workspace import Workspace


@dataclass
class Job(Workspace):
    """One reconstruction: where from, where to, how."""

    keep_going: bool = False  # past a result that cannot be true
    config: Path | None = None  # the file that options are from, for the record
    stages: tuple[Stage, ...] = field(default_factory=lambda: STAGES)  # see with_stage
    doubts: list[Finding] = field(default_factory=list)  # what the stages that were asked for found doubtful
