"""Silhouettes that another program made: grey images or videos, cut-outs with an alpha channel, numbers of objects."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from ..common.images import ImageSeries, read_image
from ..common.video import VideoFile, read_video

NOTHING, TOO_MUCH = 0.0005, 0.6  #: share of the image
LOOKED_AT = 12  #: images of a series from which its kind is told
MOST_NUMBERS = 31  #: of objects, or of values or colours that are such; a series without brighter pixels holds numbers
HALF = 127  #: what is brighter is the actor, or else is not
AREA = 0.2  #: of the pixels of an area at least have all their neighbours in it
NOISE = 8  #: what is darker, and not 0, are traces of a JPEG
MOST_SHOWN, TRACES = 0.7, 0.05  #: share of cut-outs that is not black; share of that which is nearly
TRACE = 32  #: what is darker is black to a video or JPEG
MOST_LOST = 0.1  #: of what is bright, as much as may be dark without a closer look
ON_EDGES = 0.85  #: how often what is bright lies deeper in the actor than what is dark, where that is soft edges (docs/notes)
SMALL, DEEPEST = 512, 64  #: px, images in which depths are told, and the deepest
BLACK = 16  #: what is darker in all channels is black, and what differs by less is grey
MOST_GAPS = 2  #: how often somebody may leave the picture and come back
KINDS = {
    "alpha": "where they are not transparent (cut-outs)",
    "numbers": "where their pixels are not 0 (numbers of objects)",
    "palette": "where their pixels are not of the palette's first colour",
    "colours": "where they are not black (colours of objects, cut-outs on black)",
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
            alpha = self.kind == "alpha"
            for frame in self.source.frames(size, grey=alpha, alpha=alpha):
                yield (frame if alpha else frame.max(axis=2)) > HALF  # a red mask is one, too
            return
        for file in self.source.files:
            mask = decoded(read_image(file), self.kind)
            yield np.asarray(Image.fromarray(mask).resize(size)) if size else mask


def read_masks(path: Path, images: tuple[Path, ...] = ()) -> ExternalMasks:
    """A video, or the images of a series. Raises FileNotFoundError or RuntimeError naming the file."""
    if not images:
        video = read_video(path)
        return ExternalMasks(video, kind_of_video(video))
    chosen = np.unique(np.linspace(0, len(images) - 1, LOOKED_AT).round().astype(int))
    looked = [read_image(images[i]) for i in chosen]
    kind = kind_of(looked)
    if kind == "grey" and not any(image.mode == "F" for image in looked):  # shares of certainty say themselves what is none
        require_masks([brightness(seen(image)) for image in looked], path)
    return ExternalMasks(ImageSeries(path, images, fps=1), kind)


def kind_of_video(video: VideoFile) -> str:
    """By its first frames that show something: the actor may come later."""
    looked: list[np.ndarray] = []
    with closing(video.frames(video.size, alpha=video.alpha is not None)) as frames:
        for frame in frames:
            if (frame[..., 3:] < 255).any():
                return "alpha"  # whatever colours are below it
            values = frame[..., :3].max(axis=2)
            if values.max() > TRACE:
                looked.append(values)
            if len(looked) == LOOKED_AT:
                break
    require_masks(looked, video.path)
    return "grey"


def require_masks(values: list[np.ndarray], path: Path) -> None:
    """Raises ValueError where parts of somebody are not brighter than half and would be lost: of cut-outs on black in a video or
    a JPEG, or of dark numbers of objects there."""
    lost = sum(int(((image > TRACE) & (image <= HALF)).sum()) for image in values)
    kept = sum(int((image > HALF).sum()) for image in values)
    if lost > MOST_LOST * kept and bright_within_dark(values) < ON_EDGES:
        found = f"found areas darker than half in {100 * lost / (lost + kept):.0f} % of what is not black"
        raise ValueError(
            f"{path}: expected masks in black and white, {found}; PNG may have cut-outs, or numbers or colours of objects"
        )


def bright_within_dark(values: list[np.ndarray]) -> float:
    """How likely a bright pixel lies deeper in what is not black than a dark one: 1 on soft edges, a half in dark clothes."""
    dark, bright = np.zeros(DEEPEST + 1), np.zeros(DEEPEST + 1)  # pixels of each depth
    for image in values:
        step = -(-max(image.shape) // SMALL)
        small = image[::step, ::step]
        inside, depth = small > TRACE, np.zeros(small.shape, int)
        for _ in range(DEEPEST):
            depth += inside
            inside = with_neighbours(inside)
        dark += np.bincount(depth[(small > TRACE) & (small <= HALF)], minlength=DEEPEST + 1)
        bright += np.bincount(depth[small > HALF], minlength=DEEPEST + 1)
    return float(bright @ (np.cumsum(dark) - dark / 2)) / max(dark.sum() * bright.sum(), 1)


def kind_of(images: list[Image.Image]) -> str:
    """What their pixels mean. A palette may have its colours in any order: what is seen counts. An alpha channel, or a
    transparent colour, counts if it is used."""
    palette = all(image.mode == "P" for image in images)
    shown = [seen(image) for image in images]
    if all("A" in image.getbands() for image in shown) and any(image.getextrema()[-1][0] < 255 for image in shown):
        return "alpha"
    if any(is_coloured(image) for image in shown) and (palette or has_few_colours(shown) or are_cut_outs(shown)):
        darkest = min(brightness(image).min() for image in shown)
        if palette or darkest < BLACK:
            return "colours" if darkest < BLACK else "palette"
    values = [brightness(image) for image in shown]
    brightest = max(of.max() for of in values)
    return "numbers" if 0 < brightest <= MOST_NUMBERS or are_numbers(values) else "grey"


def seen(image: Image.Image) -> Image.Image:
    """Colours in the place of numbers of them."""
    if "transparency" in image.info and image.mode in ("P", "RGB", "L"):
        return image.convert("RGBA" if image.mode != "L" else "LA")
    return image.convert("RGB") if image.mode == "P" else image


def has_few_colours(images: list[Image.Image]) -> bool:
    """As images of the parts of a person have, without a palette, and pictures do not."""
    if any(image.mode not in ("RGB", "RGBA") for image in images):
        return False
    looked = np.concatenate([np.asarray(image.convert("RGB"))[::5, ::5].reshape(-1, 3) for image in images])
    return len(np.unique(looked, axis=0)) <= MOST_NUMBERS


def are_cut_outs(images: list[Image.Image]) -> bool:
    """Pictures of which everything but the actor was made black, and that no JPEG has blurred since."""
    if any(image.mode not in ("RGB", "RGBA") for image in images):
        return False
    values = np.concatenate([brightness(image)[::5, ::5].ravel() for image in images])
    shown = values[values > 0]
    return len(shown) < MOST_SHOWN * len(values) and bool((shown < NOISE).mean() < TRACES) if len(shown) else False


def are_numbers(images: list[np.ndarray]) -> bool:
    """Are greys below a half numbers of objects, too? They are few, 0 among them, and fill areas: on the edges of a mask they are
    a line."""
    found = np.unique(np.concatenate([image[::5, ::5].ravel() for image in images]))
    if len(found) > MOST_NUMBERS or found[0] > 0 or any(((image > 0) & (image < NOISE)).any() for image in images):
        return False
    return fill_areas([(image > 0) & (image <= HALF) for image in images])


def fill_areas(chosen: list[np.ndarray]) -> bool:
    """Do pixels fill areas? On the edges of a mask they are a line."""
    return sum(int(with_neighbours(c).sum()) for c in chosen) > AREA * sum(int(c.sum()) for c in chosen)


def with_neighbours(chosen: np.ndarray) -> np.ndarray:
    """(H, W) those of which all four neighbours are chosen, too."""
    c = np.pad(chosen, 1)
    return c[1:-1, 1:-1] & c[:-2, 1:-1] & c[2:, 1:-1] & c[1:-1, :-2] & c[1:-1, 2:]


def is_coloured(image: Image.Image) -> bool:
    colours = np.asarray(image.convert("RGB")).reshape(-1, 3).astype(int)
    return bool(np.ptp(colours, axis=1).max() > BLACK)


def brightness(image: Image.Image) -> np.ndarray:
    """(H, W), 0 to 255: the brightest channel, so that a red mask is one, too; two bytes are brought to one if they are used,
    and shares from 0 to 1 to 255."""
    if image.mode.startswith(("I", "F")):
        values = np.asarray(image).astype(np.float32)
        if image.mode == "F" and values.max() <= 1:
            return 255 * values
        return values / 257 if values.max() > 255 else values
    if image.mode in ("L", "1"):
        return np.asarray(image.convert("L"))
    return np.asarray(image.convert("RGB")).max(axis=2)


def decoded(image: Image.Image, kind: str) -> np.ndarray:
    """bool (H, W)"""
    shown = seen(image)
    if kind == "alpha":
        return np.asarray(shown.convert("RGBA").getchannel("A")) > HALF
    if kind == "colours":
        return brightness(shown) >= BLACK
    if kind == "numbers":
        return brightness(shown) > 0
    if kind == "palette":
        return np.asarray(image) > 0
    return brightness(shown) > HALF


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
