"""What a stage works on."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from .. import _doublet as d
from ..common.console import Console
from ..common.packaged import body_model_path
from .options import OPTION_GROUPS
from .results import Results
from .run_record import RunRecord


@dataclass
class Workspace:
    """What a stage works on: a session, options, and a folder of results."""

    session_folder: Path
    out: Path
    options: dict = field(default_factory=dict)  # group -> Options object
    seed: int = 1
    body_model: Path = field(default_factory=body_model_path)
    console: Console = field(default_factory=Console)
    fps: float | None = None  # of the videos; None = as the session says

    def __post_init__(self):
        self.session_folder, self.out = Path(self.session_folder), Path(self.out)
        self.results = Results(self.out)
        for name, options_class in OPTION_GROUPS.items():
            self.options.setdefault(name, options_class())

    @cached_property
    def session(self) -> d.Session:
        return d.Session(self.session_folder)

    @property
    def filmed(self) -> d.Session:
        """The session with the cameras that the performance was captured with: the refined ones, if there are any."""
        return self.results.recalibrated(self.session)

    @cached_property
    def record(self) -> RunRecord:
        return RunRecord(self.out)

    @cached_property
    def silhouettes(self) -> d.SilhouetteExtractor | None:
        """Trained, for the cameras without ready masks; None if all have some."""
        return d.session_silhouettes(self.session, d.FrameSource.open(self.session), self.group("silhouette"), self.context)

    @property
    def context(self) -> d.Context:
        return self.console.context()

    def path(self, name: str) -> Path:
        return self.out / name

    def group(self, name: str):
        """The options of a group, and in them those of the groups that belong to it."""
        values = self.options[name].to_dict()
        inner = {k: self.group(k) for k, v in values.items() if type(v) is OPTION_GROUPS.get(k)}
        return OPTION_GROUPS[name](**{**values, **inner})

    def read_session_again(self) -> None:
        """After session.json was written."""
        self.__dict__.pop("session", None)
