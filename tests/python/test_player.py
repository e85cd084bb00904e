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
        (lambda p, pose: setattr(p, "materials", []), "expected 1 materials, one per cloth region, found 0"),
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


@pytest.fixture
def loose_end(shapes):
    """A player of a tube on a joint that swings, whose end beyond the joint is cloth."""
    vertices, faces = shapes["tube"](0.06, 0.4, 1.0, around=16, rows=16)
    skeleton = d.Skeleton([d.JointAnnotation("root", "", [0, 1.6, 0], 6), d.JointAnnotation("limb", "root", [0, 1.2, 0], 3)])
    weights = np.tile([0.0, 1.0], (len(vertices), 1))
    cloth = (vertices[:, 1] < 0.9).astype(float)
    segmentation = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    material, solver = d.Material(k_stretch=1.0), d.SolverSettings(1 / 40)
    stays_caught = d.AnimateOptions(settle_seconds=0.1, edge_collision=False)
    return d.Player(d.make_character(actor, segmentation, d.BodyFit(), [], [material], solver), stays_caught)


def test_what_was_caught_is_not_torn_off_a_limb_that_moves(loose_end):
    """In half a second it goes over to cloth that is put on anew, while the limb swings."""
    pose = np.zeros(9)
    loose_end.reset(pose)
    state = loose_end.state
    regions = state.regions
    positions = np.array(regions[0].positions)
    positions[positions[:, 1] < 0.7] *= [1, 1, -1]  # its front hangs behind
    regions[0].positions = positions
    state.regions = regions
    loose_end.state = state
    faces = loose_end.character.actor.mesh.faces
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    for _ in range(31):  # 0.75 s after which it is looked at, and a frame
        caught = loose_end.step(pose).surface.copy()
    longest = []
    for _ in range(12):
        pose = pose + np.eye(9)[6] * 0.1
        surface = loose_end.step(pose).surface.copy()
        longest.append(np.linalg.norm(surface[edges[:, 0]] - surface[edges[:, 1]], axis=1).max())
    assert np.any(d.self_intersecting_faces(d.Mesh(caught, faces)))
    assert max(longest) < 0.1
