"""Writes the files of a new session: videos, masks, clean plates, calibration, session.json."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from PIL import Image

from .. import _doublet as d
from ..common.console import Console
from ..common.files import write_json
from ..common.images import ImageSeries, converted, read_image
from ..common.video import VideoWriter, read_video
from .external_masks import require_plausible, require_size
from .filmed_cameras import SQUEEZED, common_factor
from .keypoints import write_keypoints
from .request import FilmedCamera, Request
from .timing import SAME_RATE

CRF = 14  #: of libx264: what is coded a second time loses next to nothing
ABSENT = 0.75  #: of a frame, by which the nearest image may be off
PNG_MODES = ("1", "L", "LA", "P", "RGB", "RGBA", "I", "I;16")  #: of an image that is written as it is
PLATE_FRAMES = 25  #: of a clean plate's video, whose median is taken


def write_session(
    folder: Path,
    request: Request,
    cameras: Sequence[FilmedCamera],
    numbers: np.ndarray,
    fps: float,
    seen: Sequence[np.ndarray] | None,
    console: Console,
    messages: list[str],
) -> None:
    """`numbers` (C, T): which frame of its video is which of the session; `seen`: keypoints (T, 12, 3) of these, by camera."""
    write_cameras(folder, cameras)
    described, kept = [], []
    for index, (camera, chosen) in enumerate(zip(cameras, numbers)):

        def report(share: float, index: int = index) -> None:
            console.progress("writing", (index + share) / len(cameras))

        entry = {"name": camera.name}
        entry["video"] = write_frames(folder, camera, chosen, fps, request.copy, report)
        if is_kept(camera, chosen, fps):
            kept.append(camera.name)
            if first := first_frame(camera, chosen):
                entry["first_frame"] = first
        if camera.masks:
            start = entry.get("first_frame", 0)
            absent = absent_frames(camera.source, chosen, fps)
            entry["masks"] = write_masks(folder, camera, np.r_[np.arange(start), chosen], absent, report)
        if camera.plate:
            entry["background"] = write_plate(folder, camera, messages)
        described.append(entry)
    console.finish()
    coded = [camera.name for camera in cameras if camera.name not in kept]
    messages += [f"as they were filmed: {', '.join(kept)}"] if kept else []
    messages += [f"coded anew: {', '.join(coded)}"] if coded else []
    session = {
        "name": request.name or request.out.absolute().name,
        "fps": fps,
        "frame_count": numbers.shape[1],
        "cameras": described,
    }
    session["calibration"] = "calibration.yml"
    if seen:
        whole = [of_whole_file(*camera, fps) for camera in zip(seen, cameras, numbers, described)]
        session["keypoints"] = write_keypoints(folder, [camera.name for camera in cameras], whole)
    for key, path in (("scan", request.scan), ("markers", request.joints)):
        if path:
            session[key] = ("scan" if key == "scan" else "joints") + path.suffix
            link_or_copy(path, folder / session[key], copy=True)
    write_json(folder / "session.json", session)


def write_cameras(folder: Path, cameras: Sequence[FilmedCamera]) -> None:
    d.write_calibration(folder / "calibration.yml", [camera.calibrated for camera in cameras])


def is_kept(camera: FilmedCamera, chosen: np.ndarray, fps: float) -> bool:
    """Nothing has to change: images may be chosen one by one, of a video no frame is left out after the first that is used."""
    if isinstance(camera.source, ImageSeries):
        return not camera.source.is_turned
    same_rate = abs(camera.source.fps - fps) <= SAME_RATE * fps
    return same_rate and camera.source.counted and not camera.source.rotation and bool((np.diff(chosen) == 1).all())


def first_frame(camera: FilmedCamera, chosen: np.ndarray) -> int:
    """Of a file that is kept: the frame that is the session's frame 0."""
    return 0 if isinstance(camera.source, ImageSeries) else int(chosen[0])


def of_whole_file(seen: np.ndarray, camera: FilmedCamera, chosen: np.ndarray, entry: dict, fps: float) -> np.ndarray:
    """Keypoints of all frames of a camera's file in the session; nothing was seen before the session's first, nor where an image
    is missing."""
    seen = seen.copy()
    seen[sorted(absent_frames(camera.source, chosen, fps))] = 0
    return np.concatenate([np.zeros((entry.get("first_frame", 0), *seen.shape[1:])), seen])


def absent_frames(source, chosen: np.ndarray, fps: float) -> set[int]:
    """Frames of the session whose image is missing in a series, where a neighbour would stand. The first and the last stay."""
    if not isinstance(source, ImageSeries) or len(chosen) < 3:
        return set()
    late = source.times[chosen] - np.arange(len(chosen)) / fps
    return {int(frame) for frame in np.flatnonzero(np.abs(late - np.median(late)) > ABSENT / fps)} - {0, len(chosen) - 1}


def write_frames(folder: Path, camera: FilmedCamera, chosen: np.ndarray, fps: float, copy: bool, report) -> str:
    """Returns the name in session.json."""
    if isinstance(camera.source, ImageSeries):
        kept, absent = is_kept(camera, chosen, fps), absent_frames(camera.source, chosen, fps)
        suffix = camera.source.files[0].suffix if kept else ".png"
        for frame, number in enumerate(chosen):
            if frame in absent:
                continue
            source, target = camera.source.files[number], folder / "videos" / camera.name / f"{frame:04d}{suffix}"
            if kept:
                link_or_copy(source, target, copy)
            else:
                write_upright(source, target)
        return f"videos/{camera.name}/%04d{suffix}"
    if is_kept(camera, chosen, fps):
        name = f"videos/{camera.name}{camera.source.path.suffix}"
        link_or_copy(camera.source.path, folder / name, copy)
        return name
    name = f"videos/{camera.name}.mp4"
    with VideoWriter(folder / name, *camera.size, fps, CRF) as video:
        for frame in chosen_frames(camera.source.frames(upright=camera.upright), chosen, report):
            video.write(frame)
    return name


def chosen_frames(frames, chosen: np.ndarray, report):
    """Those whose numbers (T, rising) are chosen, some of them more than once; stops reading after the last."""
    with ExitStack() as stack:
        stack.callback(getattr(frames, "close", lambda: None))
        wanted = 0
        for number, frame in enumerate(frames):
            while wanted < len(chosen) and chosen[wanted] == number:
                yield frame
                wanted += 1
            report(wanted / len(chosen))
            if wanted == len(chosen):
                return


def write_upright(path: Path, target: Path) -> None:
    """An image that EXIF data turn, as it is shown, without loss."""
    target.parent.mkdir(parents=True, exist_ok=True)
    image = read_image(path)
    (image if image.mode in PNG_MODES else image.convert("RGB")).save(target)


def link_or_copy(path: Path, target: Path, copy: bool) -> None:
    """A hard link where the disk allows one and no copy is wanted."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    target.parent.mkdir(parents=True, exist_ok=True)
    if not copy:
        try:
            os.link(path.resolve(), target)
            return
        except OSError:
            pass  # another disk, or one without links
    shutil.copyfile(path, target)


def write_masks(folder: Path, camera: FilmedCamera, chosen: np.ndarray, absent: set[int], report) -> str:
    where, shares = str(camera.masks.source.path), []
    target = folder / "masks" / camera.name
    target.mkdir(parents=True)
    for frame, mask in enumerate(chosen_frames(camera.masks.masks(), chosen, report)):
        require_size(mask.shape[::-1], camera.size, where)
        shares.append(mask.mean())
        if frame not in absent:
            Image.fromarray(mask.astype(np.uint8) * 255).save(target / f"{frame:04d}.png")
    require_plausible(np.array(shares), where)
    return f"masks/{camera.name}/%04d.png"


def write_plate(folder: Path, camera: FilmedCamera, messages: list[str]) -> str:
    name = f"background/{camera.name}.png"
    plate = plate_of(camera.plate.path)
    if plate.size != camera.size:
        stored = common_factor(plate.size, camera.size)
        across, down = camera.size[0] / plate.width, camera.size[1] / plate.height
        if not stored and not max(across / down, down / across) < SQUEEZED:
            found = f"found {plate.width} x {plate.height}"
            raise ValueError(
                f"{camera.plate.path}: expected {camera.size[0]} x {camera.size[1]} pixels as the video has, {found}"
            )
        messages.append(f"{camera.name}: clean plate of {plate.width} x {plate.height} scaled to the video's size")
        plate = plate.resize(camera.size, Image.BICUBIC)
    (folder / name).parent.mkdir(exist_ok=True)
    plate.save(folder / name)
    return name


def plate_of(path: Path) -> Image.Image:
    """An image, or the median of a video's frames."""
    try:
        return converted(read_image(path), "RGB")
    except RuntimeError:
        video = read_video(path)
    chosen = np.unique(np.linspace(0, len(video.times) - 1, PLATE_FRAMES).round().astype(int))
    frames = list(chosen_frames(video.frames(), chosen, lambda share: None))
    return Image.fromarray(np.median(frames, axis=0).astype(np.uint8)[..., ::-1])
