"""Images, and series of them, which are read as a video is."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps

MOST_NUMBER = 10**12  #: of an image; what is larger is a time
LEAST_TICKS = 10  #: of a clock between two images
UNEVEN = 0.3  #: of the usual step, by which one may be off
ORIENTATION = 0x0112  #: EXIF's tag: how an image is turned, 1 = as it is stored
COUNTERS = (10**4, 10**5, 10**6, 2**16, 2**32)  #: how many numbers a camera has before it begins anew


@dataclass(frozen=True)
class ImageSeries:
    """Numbered images, read as a video."""

    path: Path  # the folder
    files: tuple[Path, ...]
    fps: float
    origin: int | None = None  # number of the image at 0 s; None = the first one's
    rotation = 0
    sound_start = None
    alpha = None
    interlaced = False

    @cached_property
    def numbers(self) -> np.ndarray:
        """(N) of the images, those that are missing left out; 0 to N - 1 if their names do not count."""
        return counted([file.stem for file in self.files])

    @property
    def times(self) -> np.ndarray:
        first = self.numbers[0] if self.origin is None else self.origin
        return (self.numbers - first) / self.fps

    @cached_property
    def size(self) -> tuple[int, int]:
        return read_image(self.files[0]).size

    @property
    def stored_size(self) -> tuple[int, int]:
        return self.size

    @property
    def shown_size(self) -> tuple[int, int]:
        return self.size

    @cached_property
    def is_turned(self) -> bool:
        """Do EXIF data turn one of them that the library would show as it is stored?"""
        return any(is_turned(file) for file in self.files)

    def frames(self, size: tuple[int, int] | None = None, grey: bool = False, upright: bool = True) -> Iterator[np.ndarray]:
        """As those of a video."""
        for file in self.files:
            image = converted(read_image(file), "L" if grey else "RGB")
            image = image.resize(size, Image.BOX) if size else image
            yield np.asarray(image) if grey else np.asarray(image)[..., ::-1]


def seconds_in(stems: Sequence[str]) -> list[int] | None:
    """Nanoseconds, of names that end in times in seconds (1403636579.76), more than one; None of others."""
    times = [re.search(r"(\d+)\.(\d+)\D*$", stem) for stem in stems]
    if not all(times) or len({time[1] for time in times}) < 2:
        return None
    return [int(time[1]) * 10**9 + int(time[2][:9].ljust(9, "0")) for time in times]


def numbers_of(stems: Sequence[str]) -> list[int]:
    """The last number of each name, or the last that is not the same in all (000101_cam2); -1 = none; or seconds_in()."""
    numbers = [[int(digits) for digits in re.findall(r"\d+", stem)] for stem in stems]
    differing = [len(set(column)) > 1 for column in zip(*numbers)] if len({len(of) for of in numbers}) == 1 else []
    last = max((k for k, differs in enumerate(differing) if differs), default=-1)
    return seconds_in(stems) or [of[last] if of else -1 for of in numbers]


def in_order(files: Sequence[Path]) -> list[Path]:
    """By their numbers; where these do not count them one by one, by all that are in a name: 12-30-59-960, 12-31-00-000."""
    stems = [file.stem for file in files]
    numbers = numbers_of(stems)
    steps = sorted(np.diff(np.array(sorted(numbers), dtype=object)))
    if not seconds_in(stems) and steps and steps[len(steps) // 2] != 1:
        return sorted(files, key=lambda file: ([int(digits) for digits in re.findall(r"\d+", file.stem)], file.name))
    ordered = sorted((number, file.name, file) for number, file in zip(numbers, files))
    first = begun_anew([number for number, _, _ in ordered])
    return [file for _, _, file in ordered[first:] + ordered[:first]]


def begun_anew(numbers: Sequence[int]) -> int:
    """Where a series begins whose counter came to its end and began anew (9998, 9999, 1, 2), in rising order; 0 = it did not."""
    steps = np.diff(np.array(numbers, dtype=object))
    if len(steps) and numbers[0] in (0, 1) and numbers[-1] + 1 in COUNTERS and 4 * steps.max() > numbers[-1]:
        return int(steps.argmax()) + 1
    return 0


def counted(stems: Sequence[str]) -> np.ndarray:
    """(N) the numbers in names, in steps of the usual one (every image, every second): where one is missing, they leave it out.
    From 0 on if they are times of a clock; 0 to N - 1 if they are no such numbers (of cameras)."""
    found = numbers_of(stems)
    steps = np.diff(np.array(found, dtype=object))
    if step := clock_step(stems):
        return np.concatenate([[0], np.cumsum(np.rint((steps / step).astype(float)))]).astype(np.int64)
    usual = sorted(steps)[len(steps) // 2] if len(steps) else 1
    regular = min(found) >= 0 and usual >= 1 and all(step >= 1 and step % usual == 0 for step in steps)
    if not regular or max(found) > MOST_NUMBER or max(steps, default=1) > usual * len(found):
        return np.arange(len(stems))
    first = found[0] // usual
    return np.array([first + (number - found[0]) // usual for number in found], dtype=np.int64)


def clock_step(stems: Sequence[str]) -> int:
    """Between two images whose names are times of a clock, which are large, or uneven; 0 = they are none."""
    found = numbers_of(stems)
    steps = np.diff(np.array(found, dtype=object))
    usual = sorted(steps)[len(steps) // 2] if len(steps) else 0
    if min(found) < 0 or usual < LEAST_TICKS or max(steps) > usual * len(found):
        return 0
    if max(found) <= MOST_NUMBER and all(step % usual == 0 for step in steps):
        return 0
    gaps = (steps / usual).astype(float)
    return usual if np.rint(gaps).min() >= 1 and np.abs(gaps - np.rint(gaps)).max() <= UNEVEN else 0


def is_turned(path: Path) -> bool:
    """Is an image stored otherwise than its EXIF data say that it is shown? Of a JPEG the library itself looks at these."""
    with opened(path) as image:
        return image.format not in ("JPEG", "MPO") and image.getexif().get(ORIENTATION, 1) not in (0, 1)


def sides_of(path: Path) -> list[int]:
    """The shorter and the longer one, px, whatever EXIF data turn, without decoding the image."""
    with opened(path) as image:
        return sorted(image.size)


def read_image(path: Path) -> Image.Image:
    """Decoded, and turned as its EXIF data say. Raises RuntimeError naming the file if that is not possible."""
    with opened(path) as image:
        image.load()
        return ImageOps.exif_transpose(image)


def converted(image: Image.Image, mode: str) -> Image.Image:
    """Of 16 bits the upper eight count, as in the library."""
    if image.mode.startswith("I"):
        image = Image.fromarray((np.asarray(image) >> 8).astype(np.uint8))
    return image.convert(mode)


@contextmanager
def opened(path: Path) -> Iterator[Image.Image]:
    """Raises RuntimeError naming the file for what cannot be read of it."""
    try:
        with Image.open(path) as image:
            yield image
    except FileNotFoundError:
        raise
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise RuntimeError(f"{path}: expected an image, found a file that cannot be decoded ({error})") from error
