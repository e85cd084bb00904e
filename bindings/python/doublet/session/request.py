"""What a new session is made of: what the user gave, and what each camera filmed."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from .. import _doublet as d
from ..common.images import ImageSeries
from ..common.video import VideoFile
from .camera_files import CameraFile
from .external_masks import ExternalMasks


@dataclass
class Request:
    """What the user gave."""

    videos: list[Path]
    calibration: Path | None  # None: made from `keypoints`
    out: Path
    keypoints: Path | None = None  # of the person, for each camera
    height: float | None = None  # m, of the person
    field_of_view: float | None = None  # degrees, across the larger side of the images
    calibration_options: d.CalibrationOptions = field(default_factory=lambda: d.CalibrationOptions())
    scale_calibration: bool = False
    cameras: dict[str, Path] = field(default_factory=dict)  # name -> file
    without: list[str] = field(default_factory=list)
    sync: str = "auto"  # auto, none, sound, silhouettes
    offsets: dict[str, float] = field(default_factory=dict)  # name -> s
    fps: float | None = None
    start: float = 0.0  # s after the last camera has begun
    frames: int | None = None
    masks: list[Path] = field(default_factory=list)
    background: list[Path] = field(default_factory=list)
    scan: Path | None = None
    joints: Path | None = None
    name: str = ""
    copy: bool = False
    force: bool = False


@dataclass
class FilmedCamera:
    """A calibrated camera and what it filmed."""

    calibrated: d.CalibratedCamera
    source: VideoFile | ImageSeries
    upright: bool = True  # false: the calibration is that of the images as they are stored
    masks: ExternalMasks | None = None
    plate: CameraFile | None = None

    @property
    def name(self) -> str:
        return self.calibrated.camera.name

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of what is written, px."""
        return self.source.size if self.upright else self.source.stored_size
