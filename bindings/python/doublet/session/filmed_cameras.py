"""Which file is which camera's, and whether its calibration is that of its images."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from ..common.images import ImageSeries, clock_step, numbers_of, sides_of
from ..common.video import VideoFile, read_video
from .camera_files import CameraFile, is_given, list_files, match
from .external_masks import KINDS, ExternalMasks, read_masks, require_count, require_size
from .keypoints import match_keypoints
from .request import FilmedCamera, Request

SQUEEZED = 1.1  #: how much more one axis may be scaled than the other
SPELLED = {".jpeg": ".jpg", ".jpe": ".jpg", ".jfif": ".jpg", ".tiff": ".tif"}  #: endings of one format
SQUARE = 0.02  #: share by which the sides of a square pixel may differ


def filmed_cameras(request: Request, console: Console, messages: list[str]) -> list[FilmedCamera]:
    calibrated = chosen_cameras(request, messages) if request.calibration else None
    files = list_files(request.videos)
    names = [c.camera.name for c in calibrated] if calibrated else names_of(files, request)
    if not calibrated:
        require_known("--offset", request.offsets, names, "cameras")
    files = match(names, files, request.cameras)
    masks = match(names, list_files(request.masks), what="mask series") if request.masks else {}
    plates = match(names, list_files(request.background, single_images=True), what="clean plate") if request.background else {}
    if request.keypoints:
        match_keypoints(names, request.keypoints)  # read later, refused before the videos are
    cameras = []
    for index, name in enumerate(names):
        source = read_source(files[name], request.fps)
        messages.append(f"{name}: {source.path}, {describe(source)}")
        if calibrated:
            cameras.append(fitted(calibrated[index], source, request.scale_calibration, messages))
        else:
            require_square(source)
            cameras.append(FilmedCamera(unplaced_camera(name, source.size), source))
        cameras[-1].plate = plates.get(name)
        if name in masks:
            cameras[-1].masks = checked_masks(masks[name], cameras[-1])
        console.progress("reading", (index + 1) / len(names))
    console.finish()
    count_together([camera for camera in cameras if isinstance(camera.source, ImageSeries)], messages)
    if masks:
        kinds = sorted({camera.masks.kind for camera in cameras})
        messages += [f"masks: the actor is {KINDS[kind]}" for kind in kinds]
    return cameras


def chosen_cameras(request: Request, messages: list[str]) -> list[d.CalibratedCamera]:
    said = d.Context(log=messages.append)
    calibrated = d.read_calibration(request.calibration, request.calibration_options, said)
    names = [c.camera.name for c in calibrated]
    for flag, given in (("--without", request.without), ("--offset", request.offsets)):
        require_known(flag, given, names, "calibration's cameras")
    if not set(names) - set(request.without):
        raise ValueError("--without: expected a camera that is left, found none")
    return [c for c in calibrated if c.camera.name not in request.without]


def require_known(flag: str, given: Iterable[str], names: Sequence[str], what: str) -> None:
    for name in given:
        if name not in names:
            raise ValueError(f"{flag} {name}: expected one of the {what} {', '.join(names)}")


def names_of(files: list[CameraFile], request: Request) -> list[str]:
    """Of cameras that no calibration names: as --camera says, otherwise as their files are called."""
    names = []
    for file in files:
        plain = re.sub(r"[^A-Za-z0-9_-]+", "_", file.name)
        given = (name for name, path in request.cameras.items() if is_given(file, path))
        names.append(next(given, plain if plain[:1].isalpha() else f"cam{plain}"))
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ValueError(f"{request.videos[0]}: expected another name for each camera, found '{twice}' twice")
    return names


def unplaced_camera(name: str, size: tuple[int, int]) -> d.CalibratedCamera:
    """One of which only the image is known: at the origin, with any focal length."""
    camera = d.Camera()
    camera.name, (camera.width, camera.height) = name, size
    camera.K = np.array([[max(size), 0, (size[0] - 1) / 2], [0, max(size), (size[1] - 1) / 2], [0, 0, 1]])
    return d.CalibratedCamera(camera)


def read_source(file: CameraFile, fps: float | None) -> VideoFile | ImageSeries:
    if not file.images:
        return read_video(file.path)
    if not fps:
        raise ValueError(f"{file.path}: expected the frame rate of the images, which they do not say: --fps")
    suffixes = sorted({image.suffix for image in file.images})
    if len({SPELLED.get(suffix.lower(), suffix.lower()) for suffix in suffixes}) > 1:
        raise ValueError(f"{file.path}: expected images of one format, found {', '.join(suffixes)}")
    sides = sides_of(file.images[0])
    for image in file.images:
        if (found := sides_of(image)) != sides:
            expected = f"expected an image of {sides[1]} and {sides[0]} pixels as {file.images[0].name} is"
            raise ValueError(f"{image}: {expected}, found {found[1]} and {found[0]}")
    return ImageSeries(file.path, file.images, fps)


def count_together(cameras: list[FilmedCamera], messages: list[str]) -> None:
    """Series of images whose numbers are those of one clock begin at one number: a camera may have lost its first images."""
    firsts = first_numbers([camera.source for camera in cameras])
    lasts = [first + int(c.source.numbers[-1] - c.source.numbers[0]) for first, c in zip(firsts, cameras)]
    for camera in cameras:
        numbers = camera.source.numbers
        if (missing := int(numbers[-1] - numbers[0]) + 1 - len(numbers)) > 0:
            after = camera.source.files[int(np.argmax(np.diff(numbers) > 1))].name
            messages.append(f"{camera.name}: {missing} images are missing by their numbers, the first behind {after}")
    if len(cameras) < 2 or max(firsts) - min(firsts) > 0.5 * (min(lasts) - max(firsts)):
        return
    for camera, first in zip(cameras, firsts):
        camera.source = replace(camera.source, origin=int(camera.source.numbers[0]) - first + min(firsts))
        if first > min(firsts):
            messages.append(
                f"{camera.name}: its images begin at {camera.source.files[0].name}, {first - min(firsts)} behind the first of all"
            )


def first_numbers(series: list[ImageSeries]) -> list[int]:
    """Of the first image of each; of images that are named after one clock, in steps from the first of all."""
    names = [[file.stem for file in one.files] for one in series]
    steps = [clock_step(stems) for stems in names]
    if not all(steps):
        return [int(one.numbers[0]) for one in series]
    times = [numbers_of(stems)[0] for stems in names]
    return [round((time - min(times)) / step) for time, step in zip(times, steps)]


def describe(source: VideoFile | ImageSeries) -> str:
    turned = {
        0: "",
        90: ", turned by 90 degrees to the left",
        180: ", turned by 180 degrees",
        270: ", turned by 90 degrees to the right",
    }
    return (
        f"{source.size[0]} x {source.size[1]}, {len(source.times)} frames at {source.fps:.5g} a second{turned[source.rotation]}"
    )


def checked_masks(file: CameraFile, camera: FilmedCamera) -> ExternalMasks:
    masks = read_masks(file.path, file.images)
    require_count(masks, len(camera.source.times))
    require_size(masks.source.size, camera.size, str(masks.source.path))
    return masks


# --- the calibration's images and the video's


def fitted(calibrated: d.CalibratedCamera, source, squeezed: bool, messages: list[str]) -> FilmedCamera:
    """The camera for the images as they will be written. Raises ValueError if they are no scaled ones of the calibration's."""
    camera = calibrated.camera
    for upright in (True, False):
        width, height = source.size if upright else source.stored_size
        factor = common_factor((camera.width, camera.height), (width, height))
        if factor:
            if not upright:
                messages.append(
                    f"{camera.name}: the calibration is that of the images as they are stored; the file's rotation is left out"
                )
            if (width, height) != (camera.width, camera.height):
                messages.append(f"{camera.name}: calibration of {camera.width} x {camera.height} scaled by {factor:.4g}")
            return FilmedCamera(d.CalibratedCamera(camera.resized(width, height), calibrated.lens), source, upright)
    width, height = source.size
    across, down = width / camera.width, height / camera.height
    close = max(across / down, down / across) < SQUEEZED
    wide = source.shown_size != source.size and common_factor((camera.width, camera.height), source.shown_size)
    if wide or (squeezed and close):
        messages.append(
            f"{camera.name}: calibration of {camera.width} x {camera.height} scaled by {across:.4g} across, {down:.4g} down"
            + (", as the file says that its pixels are not square" if wide else "")
        )
        return FilmedCamera(d.CalibratedCamera(camera.resized(width, height), calibrated.lens), source)
    turned = common_factor((camera.height, camera.width), (width, height))
    advice = "; the video lies on its side, turn it" if turned else ""
    if close:
        advice = "; if it was squeezed to this size, and not cropped, --scale-calibration scales each axis by itself"
    raise ValueError(
        f"{source.path}: expected {camera.width} x {camera.height} pixels as the calibration of camera '{camera.name}' says, "
        f"or these scaled, found {width} x {height}{advice}"
    )


def require_square(source: VideoFile | ImageSeries) -> None:
    """Cameras that are found from a person are taken to have square pixels."""
    shown, size = source.shown_size, source.size
    if abs(shown[0] * size[1] - shown[1] * size[0]) > SQUARE * size[0] * size[1]:
        raise ValueError(
            f"{source.path}: expected square pixels, as --calibrate takes them to be, found a video of {size[0]} x {size[1]} "
            f"that is shown as {shown[0]} x {shown[1]}; ffmpeg -i IN -vf scale=iw*sar:ih,setsar=1 OUT"
        )


def common_factor(before: tuple[int, int], after: tuple[int, int]) -> float:
    """By which both sides are scaled, to a pixel; 0 = there is none."""
    across, down = after[0] / before[0], after[1] / before[1]
    same = abs(after[0] - before[0] * down) <= 1 or abs(after[1] - before[1] * across) <= 1
    return math.sqrt(across * down) if same else 0.0
