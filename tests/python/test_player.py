"""A character that is played frame by frame: the bits of animate(), at any frame rate, in any company."""

import gc
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402

QUICK = d.AnimateOptions(settle_seconds=0.1)


@pytest.fixture(scope="module")
def world():
    return World()


@pytest.fixture
def player(world):
    return d.Player(world.character, QUICK)


def test_player_plays_what_animate_plays(world, player):
    clip = d.animate(world.character, world.motion, QUICK)
    for t, dofs in enumerate(world.motion.dofs):
        frame = player.step(dofs) if t else player.reset(dofs)
        assert frame.index == t
        for name in ("surface", "high", "body", "joints"):
            np.testing.assert_array_equal(getattr(frame, name), getattr(clip, name)[t], name)


def test_arrays_are_views_that_keep_the_player(world):
    frame = d.Player(world.character, QUICK).reset(world.motion.dofs[0])
    surface = frame.surface
    del frame
    gc.collect()
    assert np.isfinite(surface).all() and not surface.flags.owndata


def test_what_may_change_while_it_plays(world, player):
    pose = world.motion.dofs[0]
    player.reset(pose)
    start = player.state
    still = player.step(pose, 1 / 60).surface.copy()
    player.state = start
    player.wind, player.gravity = [3, 0, 0], [0, -1.6, 0]
    material = player.materials[0]
    material.k_bend = 0.1
    player.materials = [material]
    player.proxies = player.proxies[:1]
    np.testing.assert_array_equal(player.gravity, [0, -1.6, 0])
    assert player.materials[0].k_bend == 0.1 and len(player.proxies) == 1
    assert not np.array_equal(player.step(pose, 1 / 60).surface, still)
    assert len(player.character.proxies) == len(world.proxies)  # the character is as it was


def test_copies_step_together_with_the_same_bits(world, player):
    poses = world.motion.dofs
    player.reset(poses[0])
    alone, together = [player.copy() for _ in range(3)], [player.copy() for _ in range(3)]
    d.step_players(together, [poses[k % len(poses)] for k in range(3)], 1 / 60, threads=2)
    for k in range(3):
        alone[k].step(poses[k % len(poses)], 1 / 60)
        np.testing.assert_array_equal(alone[k].frame.surface, together[k].frame.surface)
    assert player.frame.index == 0


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda p, pose: p.step(pose[:-1]), "expected a pose of 9 finite numbers, found 8"),
        (lambda p, pose: p.reset(pose * np.nan), "found NaN or infinity"),
        (lambda p, pose: p.step(pose, 2), r"expected seconds in \(0, 1\], found 2"),
        (lambda p, pose: setattr(p, "materials", []), "expected 1 materials, one a cloth region, found 0"),
        (lambda p, pose: setattr(p, "wind", [0, np.inf, 0]), "expected a wind within 1000 m/s"),
        (lambda p, pose: d.step_players([p, p], [pose, pose], 0.02), "found one twice"),
        (lambda p, pose: d.step_players([p], [pose, pose], 0.02), "found 2 poses and 1 players"),
    ],
)
def test_wrong_input_gets_its_sentence(world, player, call, sentence):
    pose = np.array(world.motion.dofs[0])
    before = player.reset(pose).surface.copy()
    with pytest.raises(ValueError, match=sentence):
        call(player, pose)
    np.testing.assert_array_equal(player.frame.surface, before)
