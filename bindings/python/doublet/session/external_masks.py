"""Silhouettes that another program made: grey images or videos, cut-outs with an alpha channel, numbers of objects."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from ..common.video import ImageSeries, VideoFile, read_image, read_video

NOTHING, TOO_MUCH = 0.0005, 0.6  #: share of the image
LOOKED_AT = 12  #: images of a series from which its kind is told
MOST_NUMBERS = 31  #: a series without brighter pixels holds numbers of objects
MOST_GAPS = 2  #: how often somebody may leave the picture and come back
KINDS = {
    "alpha": "where they are not transparent (cut-outs)",
    "numbers": "where their pixels are not 0 (numbers of objects)",
    "grey": "where they are brighter than half",
}


@dataclass(frozen=True)
class ExternalMasks:
    """Masks of one camera, one for each frame of its video."""

    source: VideoFile | ImageSeries
    kind: str  # of KINDS

    @property
    def count(self) -> int:
        return len(self.source.times)

    def masks(self, size: tuple[int, int] | None = None) -> Iterator[np.ndarray]:
        """Every mask: bool (H, W), true = actor; of another `size` (width, height) if that is given."""
        if isinstance(self.source, VideoFile):
            for frame in self.source.frames(size, grey=True):
                yield frame > 127
            return
        for file in self.source.files:
            mask = decoded(read_image(file), self.kind)
            yield np.asarray(Image.fromarray(mask).resize(size)) if size else mask


def read_masks(path: Path, images: tuple[Path, ...] = ()) -> ExternalMasks:
    """A video, or the images of a series. Raises FileNotFoundError or RuntimeError naming the file."""
    if not images:
        return ExternalMasks(read_video(path), "grey")
    chosen = np.unique(np.linspace(0, len(images) - 1, LOOKED_AT).round().astype(int))
    return ExternalMasks(ImageSeries(path, images, fps=1), kind_of([read_image(images[i]) for i in chosen]))


def kind_of(images: list[Image.Image]) -> str:
    """What their pixels mean: a palette has an object's number for each pixel, an alpha channel counts if it is used."""
    if all(image.mode == "P" for image in images):
        return "numbers"
    if all("A" in image.getbands() for image in images) and any(image.getextrema()[-1][0] < 255 for image in images):
        return "alpha"
    brightest = max(brightness(image).max() for image in images)
    return "numbers" if 0 < brightest <= MOST_NUMBERS else "grey"


def brightness(image: Image.Image) -> np.ndarray:
    """(H, W), 0 to 255: the brightest channel, so that a red mask is one, too; two bytes are brought to one if they are used."""
    if image.mode.startswith(("I", "F")):
        values = np.asarray(image).astype(np.float32)
        return values / 257 if values.max() > 255 else values
    if image.mode in ("L", "1"):
        return np.asarray(image.convert("L"))
    return np.asarray(image.convert("RGB")).max(axis=2)


def decoded(image: Image.Image, kind: str) -> np.ndarray:
    """bool (H, W)"""
    if kind == "alpha":
        return np.asarray(image.getchannel("A")) > 127
    if kind == "numbers":
        return (np.asarray(image) if image.mode == "P" else brightness(image)) > 0
    return brightness(image) > 127


def require_size(found: tuple[int, int], wanted: tuple[int, int], where: str) -> None:
    """Both width and height, px."""
    if found != wanted:
        raise ValueError(
            f"{where}: expected masks of {wanted[0]} x {wanted[1]} pixels as the video has, found {found[0]} x {found[1]}"
        )


def require_count(masks: ExternalMasks, frames: int) -> None:
    if masks.count != frames:
        raise ValueError(f"{masks.source.path}: expected {frames} masks, one for each frame of the video, found {masks.count}")


def require_plausible(shares: np.ndarray, where: str) -> None:
    """`shares` (T) of the image that the masks cover. Raises ValueError in one sentence if they cannot show a person."""
    empty, count = shares < NOTHING, len(shares)
    if empty.all():
        raise ValueError(f"{where}: expected masks that show a person, found black ones, all {count}")
    middle = float(np.median(shares[~empty]))
    if middle > TOO_MUCH:
        what = "white ones" if middle > 0.999 else f"ones that cover {100 * middle:.0f} % of the image"
        raise ValueError(f"{where}: expected masks that show a person, found {what}; are they inverted?")
    gaps = int((np.diff(empty.astype(int)) == 1).sum()) - int(empty[-1])  # those that end again
    if empty.mean() > 0.5 or gaps > MOST_GAPS:
        raise ValueError(
            f"{where}: expected masks that always show a person, found nothing in {empty.sum()} of {count}, with {gaps} gaps"
        )
