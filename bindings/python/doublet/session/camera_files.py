"""Which file is which camera: videos, folders of images, masks and clean plates, matched to the names of a calibration."""

from __future__ import annotations

import os
import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..common.images import in_order, numbers_of

VIDEOS = {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mts", ".m2ts", ".ts", ".mpg", ".mpeg", ".vob", ".wmv", ".mxf"}
VIDEOS |= {".3gp", ".3g2", ".ogv", ".flv", ".y4m", ".h264", ".hevc", ".mjpeg"}
IMAGES = {".png", ".jpg", ".jpeg", ".jpe", ".jfif", ".jp2", ".bmp", ".tif", ".tiff", ".webp", ".tga", ".ppm", ".pgm"}


@dataclass(frozen=True)
class CameraFile:
    """What one camera filmed, by the name that may tell which: a video, or the images of a series in their order."""

    name: str
    path: Path  # file, or folder of the images
    images: tuple[Path, ...] = ()


def list_files(paths: Sequence[Path], single_images: bool = False) -> list[CameraFile]:
    """One for each camera: files and folders as they are given, or what is in the one folder that is given. `single_images`: an
    image is a camera's only one, not one of a series. Raises FileNotFoundError for what is not there, ValueError for a folder
    without videos or images."""
    for path in paths:
        if not path.exists():
            raise FileNotFoundError(f"{path}: no such file or folder")
    if len(paths) == 1 and paths[0].is_dir():
        found = inside(paths[0], single_images)
    else:
        found = [file for path in paths for file in (one_folder(path, single_images) if path.is_dir() else [of_file(path)])]
    if not found:
        raise ValueError(f"{paths[0]}: expected videos or images in the folder, found none")
    return told_apart(found)


def inside(folder: Path, single_images: bool) -> list[CameraFile]:
    """Videos, subfolders with a camera each, and images, which are series by their names."""
    children = visible(folder)
    found = [of_file(path) for path in children if path.suffix.lower() in VIDEOS]
    found += [file for path in children if path.is_dir() for file in one_folder(path, single_images)]
    images = [path for path in children if path.suffix.lower() in IMAGES]
    if single_images:
        return found + [of_file(path) for path in images]
    return found + series_of(folder, images)


def one_folder(folder: Path, single_images: bool) -> list[CameraFile]:
    """A camera's own folder: its images, or its only video; the folder's name is the camera's."""
    children = visible(folder)
    videos = [path for path in children if path.suffix.lower() in VIDEOS]
    images = [path for path in children if path.suffix.lower() in IMAGES]
    if len(videos) > 1:
        return [of_file(path) for path in videos]
    if videos or (images and single_images):
        return [CameraFile(folder.name, (videos or images)[0])]
    require_one_series(folder, images)
    return [CameraFile(folder.name, folder, tuple(in_order(images)))] if images else []


def require_one_series(folder: Path, images: Sequence[Path]) -> None:
    """Raises ValueError where others are among them, of the same numbers or of none, which would be taken for frames."""
    forms = {re.sub(r"\d+", "#", image.stem): image.name for image in reversed(images)}
    numbers = numbers_of([image.stem for image in images])
    twice = len(set(numbers)) < len(numbers)
    first = next((form for form in forms if "#" not in form), None)  # image.png, image1.png, image2.png
    others = first is not None and not all(form.startswith(first) for form in forms)
    if len(forms) > 1 and max(numbers) >= 0 and (twice or others):
        found = ", ".join(sorted(forms.values())[:4])
        raise ValueError(f"{folder}: expected the images of one series, found {found}; put others into another folder")


def visible(folder: Path, pattern: str = "*") -> list[Path]:
    """What is in a folder, without what the system keeps there: ._cam0.mp4 beside cam0.mp4."""
    return sorted(path for path in folder.glob(pattern) if not path.name.startswith("."))


def of_file(path: Path) -> CameraFile:
    return CameraFile(path.stem, path)


def series_of(folder: Path, images: list[Path]) -> list[CameraFile]:
    """cam0_0000.png, cam0_0001.png, cam1_0000.png: two series."""
    groups = defaultdict(list)
    for image in images:
        groups[re.sub(r"[_\-. ]*\d+$", "", image.stem)].append(image)
    return [CameraFile(name or folder.name, folder, tuple(in_order(group))) for name, group in groups.items()]


def told_apart(files: list[CameraFile]) -> list[CameraFile]:
    """cam0/video.mp4, cam1/video.mp4: the folders' names tell, not the files'."""
    count = Counter(file.name for file in files)
    if all(count[file.name] > 1 and not file.images for file in files) and len({file.path.parent for file in files}) == len(
        files
    ):
        return [replace(file, name=file.path.parent.name) for file in files]
    return files


def match(
    cameras: Sequence[str], files: Sequence[CameraFile], given: dict[str, Path] | None = None, what: str = "video"
) -> dict[str, CameraFile]:
    """The file of each camera: as `given`, else by equal names, else the only file whose name contains the camera's (or the other
    way round), else by the numbers in which the names differ, if both sides have the same. Raises ValueError listing what is
    left."""
    found = given_files(cameras, files, given or {})
    for rule in (same_name, contained_name, by_numbers):
        left = [camera for camera in cameras if camera not in found]
        free = [file for file in files if file not in found.values()]
        found.update(rule(left, free))
    left = [camera for camera in cameras if camera not in found]
    free = [file for file in files if file not in found.values()]
    refuse_two(cameras, found, free, what)
    if left or free:
        found_instead = unmatched(left, free, cameras, files) + advice(left, free, what)
        raise ValueError(f"expected one {what} for each camera, by name, found {found_instead}")
    return {camera: found[camera] for camera in cameras}


def unmatched(left: Sequence[str], free: Sequence[CameraFile], cameras: Sequence[str], files: Sequence[CameraFile]) -> str:
    """Both sides, in words."""

    def shown(some: Sequence[CameraFile]) -> str:
        return ", ".join(str(file.path) for file in some)

    if not free:
        return f"none for {', '.join(left)} among {shown(files)}"
    if not left:
        return f"{shown(free)} beside those of {', '.join(cameras)}"
    return f"none for {', '.join(left)}, and {shown(free)}, whose camera is not clear"


def advice(left: Sequence[str], free: Sequence[CameraFile], what: str) -> str:
    if what != "video":
        return f"; name each {what} after its camera"
    if not free:
        return "; leave cameras out: --without NAME"
    return "; say which is which: --camera NAME=FILE" if left else "; leave it out"


def given_files(cameras: Sequence[str], files: Sequence[CameraFile], given: dict[str, Path]) -> dict[str, CameraFile]:
    found = {}
    for camera, path in given.items():
        if camera not in cameras:
            raise ValueError(f"--camera {camera}={path}: expected one of the cameras {', '.join(cameras)}")
        same = [file for file in files if is_given(file, path)]
        found[camera] = (same or list_files([path, path])[:1])[0]
    if len({file.path for file in found.values()}) < len(found):
        raise ValueError(f"--camera: expected another file for each camera, found {', '.join(map(str, given.values()))}")
    return found


def is_given(file: CameraFile, path: Path) -> bool:
    """By its name in the folder, or by any way that leads to it."""
    return path == Path(file.path.name) or path.resolve() == file.path.resolve()


def refuse_two(cameras: Sequence[str], found: dict[str, CameraFile], free: Sequence[CameraFile], what: str) -> None:
    for camera in cameras:
        also = [file for file in free if is_same(camera, file.name)]
        if also:
            files = [*([found[camera]] if camera in found else []), *also]
            raise ValueError(f"camera '{camera}': expected one {what}, found {', '.join(str(file.path) for file in files)}")


def plain_name(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def is_same(camera: str, name: str) -> bool:
    """Calibrations put `cam` before a name that begins with a digit."""
    return plain_name(camera) in (plain_name(name), "cam" + plain_name(name))


def contains(whole: str, part: str) -> bool:
    """cam1 is in take2_cam1, not in cam10, and a is in cam_a alone."""
    if len(part) == 1 and part.isalpha():
        return bool(re.search(rf"(?<![a-z]){part}(?![a-z])", whole))
    return bool(re.search(rf"(?<!\d){re.escape(part)}(?!\d)" if part[:1].isdigit() else rf"{re.escape(part)}(?!\d)", whole))


def only_pairs(cameras: Sequence[str], files: Sequence[CameraFile], fits) -> dict[str, CameraFile]:
    """Pairs of which neither side has another."""
    table = {camera: [file for file in files if fits(camera, file.name)] for camera in cameras}
    claims = Counter(file.path.as_posix() + file.name for fitting in table.values() for file in fitting)
    return {
        camera: fitting[0]
        for camera, fitting in table.items()
        if len(fitting) == 1 and claims[fitting[0].path.as_posix() + fitting[0].name] == 1
    }


def same_name(cameras, files):
    return only_pairs(cameras, files, is_same)


def contained_name(cameras, files):
    """A serial number, too, is in a file's name without the `cam` that calibrations put before it."""

    def fits(camera: str, name: str) -> bool:
        known, name = re.sub(r"^cam(?=\d{4,}$)", "", plain_name(camera)), plain_name(name)
        return contains(name, known) or contains(known, name)

    return only_pairs(cameras, files, fits)


def by_numbers(cameras, files):
    """Only if both sides differ in a number, and in the same ones."""
    of_cameras, of_files = varying_numbers(cameras), varying_numbers([file.name for file in files])
    if not of_cameras or sorted(of_cameras) != sorted(of_files):
        return {}
    return {camera: files[of_files.index(number)] for camera, number in zip(cameras, of_cameras)}


def varying_numbers(names: Sequence[str]) -> list[int]:
    """The number in which the names differ, for each; empty if that is not what they differ in."""
    before = len(re.sub(r"\d+$", "", os.path.commonprefix(list(names))))
    after = len(re.sub(r"^\d+", "", os.path.commonprefix([name[::-1] for name in names])[::-1]))
    middles = [name[before : len(name) - after] for name in names]
    if len(names) == 1 and names[0]:  # differs from nothing: its last number
        middles = re.findall(r"\d+", names[0])[-1:]
    numbers = [int(middle) for middle in middles if middle.isdigit()]
    return numbers if len(set(numbers)) == len(names) else []
