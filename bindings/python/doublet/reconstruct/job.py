"""One reconstruction, shown on a console."""

from __future__ import annotations

from pathlib import Path

from .. import _doublet as d
from ..common.console import Console
from ..common.packaged import body_model_path
from .stages import CHECK, REPORT, fit_and_show


class Job(d.Reconstruction):
    """A `doublet.Reconstruction` with the stages that need Python: the picture of the check, the page of the search, the report.

    options: option group -> options object; a group that is part of another, such as `pose` of `capture`, goes before what the
    other says. fps: of the videos; None = as the session says. config: the file that the options are from, for the record."""

    def __init__(
        self,
        session: Path,
        out: Path,
        options: dict | None = None,
        seed: int = 1,
        body_model: Path | None = None,
        console: Console | None = None,
        keep_going: bool = False,
        config: Path | None = None,
        fps: float | None = None,
    ):
        chosen = d.ReconstructionOptions()
        chosen.body_model = body_model or body_model_path()
        chosen.seed, chosen.fps, chosen.keep_going = seed, fps or 0.0, keep_going
        if config:
            chosen.configuration = config
        for group in d.ReconstructionOptions.groups:
            if group in (options or {}):
                chosen[group] = options[group]
        self.console = console or Console()
        super().__init__(session, out, chosen, self.console.context())
        self.announce = self.console.announce
        self.stages = [CHECK, *self.stages[1:], REPORT]
        self.replace("fit", fit_and_show, runner="")
