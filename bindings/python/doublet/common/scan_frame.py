"""The frame that a session's scan was made in."""

from __future__ import annotations

from pathlib import Path

from .. import _doublet as d
from .files import read_json


def scan_frame(session: d.Session) -> int:
    """As `doublet scan` has written it; 0 of other scans. Raises RuntimeError for what is no frame."""
    path = Path(session.folder) / "session.json"
    frame = read_json(path).get("scan_frame", 0)
    if type(frame) is not int or not 0 <= frame < session.frame_count:
        raise RuntimeError(f"{path}: scan_frame: expected a whole number from 0 to {session.frame_count - 1}, found {frame!r}")
    return frame
