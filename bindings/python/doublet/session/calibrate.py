"""Cameras of a new session from the person who moves before them, where there is no board: her joints as a program finds them in
the images, and her silhouettes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from ..common.images import ImageSeries, read_image
from ..common.video import VideoFile, probe
from .import_calibration import camera_line, distances
from .request import FilmedCamera, Request

HEIGHT = 1.7  #: m, of a person of whom it is not said
SILHOUETTES = 40  #: frames whose silhouettes are used, spread over the take
FILM = 36.0  #: mm, the larger side of the film to which focal lengths in pictures' metadata are related
FOCAL_ERROR = 0.1  #: share by which such a focal length may be off: video shows less than the whole sensor
EXIF, EXIF_FOCAL = 0x8769, 0xA405  #: of the EXIF standard: the directory, FocalLengthIn35mmFilm
APPLE_FOCAL = "com.apple.quicktime.camera.focal_length.35mm_equivalent"
DOUBTFUL_SHARE, DOUBTFUL_TANGENT = 0.6, 0.01  #: of keypoints that agree, below; m, between silhouettes' planes, above


def require_one_way(request: Request) -> None:
    if request.calibration is None and request.keypoints is None:
        raise ValueError(
            "expected --calibration FILE, or --calibrate KEYPOINTS (the person's joints in the videos, as MediaPipe or OpenPose "
            "write them), found neither"
        )
    if request.without and not request.calibration:
        raise ValueError("--without: expected --calibration, of whose cameras it leaves out some, found --calibrate")
    for flag, value, least, most in (("--height", request.height, 0.3, 3), ("--field-of-view", request.field_of_view, 1, 170)):
        if value is None:
            continue
        if request.calibration:
            raise ValueError(f"{flag}: expected --calibrate, which it is for, found --calibration")
        if not least <= value <= most:
            raise ValueError(f"{flag}: expected a number in [{least}, {most}], found {value:g}")


class PersonCalibrator:
    """Gives the cameras their places. `seen`: (T, 12, 3) keypoints of the session's frames for each."""

    def __init__(self, request: Request, cameras: Sequence[FilmedCamera], seen: list[np.ndarray], messages: list[str]):
        self.seen = seen
        self.focals = [focal_of(camera, request.field_of_view, messages) for camera in cameras]
        error = {} if request.field_of_view or not any(self.focals) else {"focal_error": FOCAL_ERROR}
        self.options = d.PersonCalibrationOptions(height=request.height or HEIGHT, **error)
        if not request.height:
            messages.append(f"the person is taken to be {HEIGHT} m tall: --height")

    def calibrate(
        self,
        cameras: Sequence[FilmedCamera],
        frames: d.FrameSource,
        extractor: d.SilhouetteExtractor | None,
        console: Console,
        messages: list[str],
    ) -> list[d.Finding]:
        """Sets the cameras. Raises RuntimeError where keypoints do not go together."""
        silhouettes = hulls(frames, extractor, console)
        views = [
            d.PersonView(camera.name, camera.size, seen, focal, outlines)
            for camera, seen, focal, outlines in zip(cameras, self.seen, self.focals, silhouettes)
        ]
        found = d.calibrate_from_person(views, self.options, d.Context(progress=console.progress))
        console.finish()
        for camera, placed in zip(cameras, found.rig):
            camera.calibrated = d.CalibratedCamera(placed)
        messages += [
            f"{camera_line(camera.calibrated)}; {100 * fit.agreeing:.0f} % of its keypoints agree, to {fit.error:.1f} px, "
            f"and silhouettes to {1000 * fit.tangent_error:.1f} mm"
            for camera, fit in zip(cameras, found.cameras)
        ]
        messages.append(f"calibrated by the person: {len(cameras)} cameras{distances([c.calibrated for c in cameras])}")
        return doubts(cameras, found.cameras)


def doubts(cameras: Sequence[FilmedCamera], fits: Sequence[d.PersonCamera]) -> list[d.Finding]:
    findings = []
    for camera, fit in zip(cameras, fits):
        if fit.agreeing < DOUBTFUL_SHARE:
            found = f"expected that {100 * DOUBTFUL_SHARE:.0f} % of its keypoints agree with the other cameras"
            findings.append(d.Finding(False, f"camera '{camera.name}': {found}, found {100 * fit.agreeing:.0f} %"))
        if not fit.tangent_error < DOUBTFUL_TANGENT:
            found = f"found {1000 * fit.tangent_error:.0f} mm" if math.isfinite(fit.tangent_error) else "found none to compare"
            expected = f"expected silhouettes that agree with the other cameras' to {1000 * DOUBTFUL_TANGENT:.0f} mm"
            findings.append(d.Finding(False, f"camera '{camera.name}': {expected}, {found}"))
    return findings


def hulls(frames: d.FrameSource, extractor: d.SilhouetteExtractor | None, console: Console) -> list[list[np.ndarray]]:
    """[camera][frame]: corners (n, 2) of the hulls of silhouettes, in some frames of the take."""
    count, cameras = frames.frame_count, frames.camera_count
    chosen = np.unique(np.linspace(0, count - 1, SILHOUETTES).round().astype(int))
    found = [[np.zeros((0, 2))] * count for _ in range(cameras)]
    for index, frame in enumerate(map(int, chosen)):
        for camera in range(cameras):
            mask = d.read_view(frames, camera, frame, extractor).mask
            if mask.size:
                found[camera][frame] = d.silhouette_hull(mask)
        console.progress("outlines", (index + 1) / len(chosen))
    console.finish()
    return found


# --- focal lengths


def focal_of(camera: FilmedCamera, field_of_view: float | None, messages: list[str]) -> float:
    """px, as it was said, or as the file says; 0 = unknown."""
    side = max(camera.size)
    if field_of_view:
        return side / 2 / math.tan(math.radians(field_of_view) / 2)
    stated = stated_focal(camera.source)
    if stated:
        messages.append(f"{camera.name}: a focal length of {stated:g} mm on small-picture film, as its file says")
    return side * stated / FILM


def stated_focal(source: VideoFile | ImageSeries) -> float:
    """mm, on film of 36 mm; 0 = the file does not say."""
    if isinstance(source, ImageSeries):
        value = read_image(source.files[0]).getexif().get_ifd(EXIF).get(EXIF_FOCAL, 0)
    else:
        value = probe(source.path, "V:0", "format_tags").get("format", {}).get("tags", {}).get(APPLE_FOCAL, 0)
    try:
        stated = float(value)
    except (TypeError, ValueError):
        return 0.0
    return stated if 5 <= stated <= 500 else 0.0
