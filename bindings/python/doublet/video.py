"""H.264 video through the ffmpeg program."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np

from .files import written_atomically


class VideoWriter:
    """`with VideoWriter(path, width, height, fps) as video: video.write(bgr)`; the file is complete or absent."""

    def __init__(self, path: Path, width: int, height: int, fps: float):
        self.path, self.shape, self.fps = Path(path), (height, width, 3), fps

    def __enter__(self) -> VideoWriter:
        if not shutil.which("ffmpeg"):
            raise FileNotFoundError("the program ffmpeg is not installed; a video needs it")
        height, width, _ = self.shape
        self._file = written_atomically(self.path)
        raw = ["-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{width}x{height}", "-r", f"{self.fps:g}", "-i", "-"]
        coded = ["-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
        # Without -xerror ffmpeg calls a file success whose end did not fit on the disk.
        command = ["ffmpeg", "-loglevel", "error", "-xerror", "-y", *raw, *coded, str(self._file.__enter__())]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        return self

    def write(self, picture: np.ndarray) -> None:
        if picture.shape != self.shape:
            raise ValueError(f"expected a picture of shape {self.shape}, found {picture.shape}")
        try:
            self._process.stdin.write(np.ascontiguousarray(picture).data)
        except BrokenPipeError:
            self._fail()

    def __exit__(self, kind, error, trace) -> None:
        if kind is not None:
            self._process.kill()
            self._process.communicate()
            self._file.__exit__(kind, error, trace)
            return
        _, message = self._process.communicate()
        if self._process.returncode or message.strip():
            self._fail(message)
        self._file.__exit__(None, None, None)

    def _fail(self, message: bytes = b"") -> None:
        message = message or self._process.communicate()[1]
        said = message.decode(errors="replace").strip().splitlines() or [f"exit status {self._process.returncode}"]
        failure = RuntimeError(f"{self.path}: cannot be written: ffmpeg says: {said[0]}")
        self._file.__exit__(RuntimeError, failure, None)
        raise failure
