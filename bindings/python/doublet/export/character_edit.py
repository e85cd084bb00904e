"""A character in other colours: another texture, another skin under the garment, something to wear there."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageColor, ImageDraw

from .. import _doublet as d
from ..common.files import written_atomically
from ..common.images import read_image

PNG, JPEG = b"\x89PNG", b"\xff\xd8\xff"
BIT_DEPTH = 24  # where a PNG says it
GAMMA = 2.2  # about that of sRGB, which images are in
ALIKE = 30  # of 255 in each channel, to which a texel is of the hidden body's colour
QUALITY = 95  # of a JPEG that is written anew
ORIENTATION = 0x0112  # of EXIF: how a picture is turned to be looked at; 1 = not
THIGH = 0.5  # of the way from hip to knee, to which a garment under the garment reaches
BORDER = 3  # px of a line round a triangle, for what is read between its texels and those beside its chart


def colour_of(text: str, flag: str) -> tuple[int, int, int]:
    """sRGB of '#aabbcc', 'teal' or 'rgb(1, 2, 3)'. Raises ValueError naming the flag."""
    try:
        return ImageColor.getrgb(text)[:3]
    except ValueError:
        raise ValueError(f"{flag}: expected a colour such as '#336699' or 'teal', found '{text}'") from None


def linear(rgb: Sequence[int]) -> np.ndarray:
    return (np.asarray(rgb, float) / 255) ** GAMMA


def set_texture(character: d.Character, file: Path) -> None:
    """Another picture for M_high, laid out as its own (write_texture() has that): what is drawn of the hidden body apart from it
    takes the colour that its like has in the new picture. A picture that EXIF data turn, or in printer's inks (CMYK), is taken as
    it looks. Raises RuntimeError naming the file if it is no PNG or JPEG, or of other proportions."""
    if not len(character.texcoords):
        raise ValueError(f"{character.name}: expected a character with a texture to replace, found none")
    picture, content = read_image(file), Path(file).read_bytes()
    if not content.startswith((PNG, JPEG)):
        raise RuntimeError(f"{file}: expected a PNG or JPEG, found another kind of image")
    if content.startswith(PNG) and content[BIT_DEPTH] > 8:
        raise RuntimeError(f"{file}: expected 8 bits per channel, as in files that are drawn, found {content[BIT_DEPTH]}")
    before = character_picture(character)
    if before is not None:
        require_shape(file, picture.size, before.size)
        follow(character, np.asarray(before), np.asarray(picture.convert("RGB").resize(before.size, Image.BOX)))
    character.texture = as_it_looks(picture, content)


def as_it_looks(picture: Image.Image, content: bytes) -> bytes:
    """The file's content; of a picture that EXIF data turn, the turned one written anew: renderers look at no such data. So is
    one in CMYK, which glTF does not have."""
    stored = Image.open(io.BytesIO(content))
    if stored.mode == "CMYK":
        return encoded(picture.convert("RGB"), png=False)
    return encoded(picture, content.startswith(PNG)) if stored.getexif().get(ORIENTATION, 1) != 1 else content


def encoded(picture: Image.Image, png: bool) -> bytes:
    kept = io.BytesIO()
    picture.save(kept, **({"format": "PNG"} if png else {"format": "JPEG", "quality": QUALITY, "subsampling": 0}))
    return kept.getvalue()


def require_shape(file: Path, size: tuple[int, int], own: tuple[int, int]) -> None:
    """A picture of other proportions cannot be laid out as the character's own."""
    if abs(size[0] / size[1] - own[0] / own[1]) > 0.01 * own[0] / own[1]:
        expected = f"the proportions of the character's own picture ({own[0]} x {own[1]}; --write-texture writes it)"
        raise RuntimeError(f"{file}: expected {expected}, found {size[0]} x {size[1]}")


def follow(character: d.Character, before: np.ndarray, after: np.ndarray) -> None:
    """The hidden body's colour, from the texels that had it."""
    colour = np.round(255 * np.asarray(character.body_colour) ** (1 / GAMMA)).astype(int)
    alike = (np.abs(before.astype(int) - colour) < ALIKE).all(axis=2)
    if alike.sum() >= 100:
        character.body_colour = linear(np.median(after[alike], axis=0))


def character_picture(character: d.Character) -> Image.Image | None:
    return Image.open(io.BytesIO(bytes(character.texture))).convert("RGB") if len(character.texture) else None


def set_body_colour(character: d.Character, rgb: Sequence[int]) -> None:
    """The skin under the garment, flat."""
    character.body_colour = linear(rgb)
    paint(character, np.asarray(d.hidden_faces(character), bool), rgb)


def set_underwear(character: d.Character, rgb: Sequence[int]) -> None:
    """Something plain on the hidden body, down to the middle of the thighs. A character whose hidden body is drawn apart from
    the texture has but one colour for it, and gets this."""
    hidden = np.asarray(d.hidden_faces(character), bool)
    if not hidden.any():
        character.body_colour = linear(rgb)
        return
    paint(character, hidden, rgb, height_of_legs(character))


def height_of_legs(character: d.Character) -> float:
    """m, in the scan's pose; below everything without joints of that name."""
    skeleton = character.actor.skeleton
    places = skeleton.joint_positions(np.zeros(len(skeleton.dof_names)))
    heights = {
        part: [places[j, 1] for j, name in enumerate(skeleton.joint_names) if name.endswith(part)] for part in ("hip", "knee")
    }
    if not all(heights.values()):
        return -np.inf
    hip, knee = (float(np.mean(heights[part])) for part in ("hip", "knee"))
    return (1 - THIGH) * hip + THIGH * knee


def paint(character: d.Character, faces: np.ndarray, rgb: Sequence[int], above: float = -np.inf) -> None:
    """Triangles of the texture, where the character has a texture: what of them is higher than `above` m in the scan's pose."""
    picture = character_picture(character)
    if picture is None or not faces.any():
        return
    corners = character.texcoords.reshape(-1, 3, 2)[faces] * picture.size - 0.5
    heights = character.high.vertices[character.high.faces[faces], 1]
    draw, colour = ImageDraw.Draw(picture), tuple(map(int, rgb))
    for corner, height in zip(corners, heights):
        points = part_above(corner, height, above)
        if len(points) > 2:
            draw.polygon(points, fill=colour)
            draw.line([*points, points[0]], fill=colour, width=BORDER)
    character.texture = encoded(picture, bytes(character.texture).startswith(PNG))


def part_above(corners: np.ndarray, heights: np.ndarray, above: float) -> list[tuple[float, float]]:
    """A triangle, cut at a height (Sutherland, Hodgman 1974)."""
    if not np.isfinite(above):
        return [tuple(corner) for corner in corners]
    kept = []
    for k in range(3):
        here, there = heights[k] - above, heights[(k + 1) % 3] - above
        if here >= 0:
            kept.append(tuple(corners[k]))
        if here * there < 0:
            share = here / (here - there)
            kept.append(tuple((1 - share) * corners[k] + share * corners[(k + 1) % 3]))
    return kept


def texture_suffix(character: d.Character) -> str:
    return ".png" if bytes(character.texture).startswith(PNG) else ".jpg"


def write_texture(character: d.Character, path: Path) -> Path:
    """The texture as it is in the file, to be painted on. Returns `path`, with the suffix that the picture has."""
    if not len(character.texture):
        raise ValueError(f"{character.name}: expected a character with a texture, found none")
    path = Path(path).with_suffix(texture_suffix(character))
    with written_atomically(path) as beside:
        beside.write_bytes(bytes(character.texture))
    return path
