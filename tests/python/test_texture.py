"""A character's texture from the frames of a take."""

import io
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402


@pytest.fixture
def world():
    return World()


def plain(world, value):
    """Pictures of one grey, and masks."""
    return [np.full_like(world.picture, value)] * len(world.cameras), [world.mask] * len(world.cameras)


def texture_of(world, surfaces, images, **options):
    character = world.character
    share = d.texture_character_from_take(character, surfaces, world.cameras, images, d.TextureOptions(size=64, **options))
    return share, np.asarray(Image.open(io.BytesIO(character.texture)).convert("L"), float)


def test_frames_are_asked_for_once_in_rising_order(world):
    asked, still = [], np.array(world.mesh.vertices)

    def images(frame):
        asked.append(frame)
        return plain(world, 150)

    share, found = texture_of(world, [still] * 9, images, frames=4, albedo=False, screen_margin=0)
    assert asked[0] == 0 and asked == sorted(set(asked)) and len(asked) == 4
    assert 0 < share <= 1 and abs(np.median(found) - 150) < 4


def test_an_error_of_the_reader_is_handed_on(world):
    def images(frame):
        raise OSError("the disk is gone")

    with pytest.raises(OSError, match="the disk is gone"):
        texture_of(world, [np.array(world.mesh.vertices)], images)


def test_what_does_not_fit_is_refused(world):
    still = np.array(world.mesh.vertices)
    with pytest.raises(ValueError, match="expected a frame or more, found 0"):
        texture_of(world, [], lambda frame: plain(world, 150))
    with pytest.raises(ValueError, match="expected one image per camera, found 1 for"):
        texture_of(world, [still], lambda frame: ([world.picture], []))
    with pytest.raises((ValueError, RuntimeError), match="vertices"):
        texture_of(world, [still, still[:-1]], lambda frame: plain(world, 150))
    with pytest.raises(TypeError, match="images must return two lists"):
        texture_of(world, [still], lambda frame: 7)
