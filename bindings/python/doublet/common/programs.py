"""Programs that run beside this one."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

CHOSEN = "DOUBLET_FFMPEG"  #: environment: what runs as ffmpeg; the native module asks it, too


def ffmpeg() -> str:
    return os.environ.get(CHOSEN) or "ffmpeg"


def as_file(path: Path) -> str:
    """A name as it is for ffmpeg and ffprobe: what stands before a colon is no protocol."""
    return f"file:{path}"


def use_packaged_ffmpeg() -> None:
    """Where there is no ffmpeg, that of the package imageio-ffmpeg, if it is installed."""
    if shutil.which(ffmpeg()):
        return
    try:
        import imageio_ffmpeg

        os.environ[CHOSEN] = imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):  # RuntimeError: the package has none for this machine
        return
