"""What another program sees of a baked animation."""

import doublet as d
import numpy as np
import pytest
from glb_viewer import Viewer

FPS, FRAMES = 40.0, 33


@pytest.fixture(scope="module")
def turning(shapes):
    """A bell-shaped person who bends and turns by 200 degrees a second, in cloth that the body stands out of."""
    vertices, faces = shapes["tube"](lambda h: 0.35 - 0.15 * h, 0.5, 1.5, around=24, rows=21)
    skeleton = d.Skeleton([d.JointMark("pelvis", "", [0, 0.9, 0], 6), d.JointMark("spine", "pelvis", [0, 1.1, 0], 3)])
    upper = np.clip((vertices[:, 1] - 0.9) / 0.4, 0, 1)
    weights = np.stack([1 - upper, upper], axis=1)
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    clothness = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    fit = d.BodyFit()
    fit.body = d.Mesh(*shapes["tube"](lambda h: 0.36 - 0.15 * h, 0.5, 1.5, around=20, rows=15))
    character = d.make_character(actor, clothness, fit, [], [d.Material(k_stretch=1.0)], d.SolverSettings(1 / FPS))
    dofs = np.zeros((FRAMES, 9))
    dofs[:, 4] = np.radians(200) * np.arange(FRAMES) / FPS
    dofs[:, 6] = 0.8 * np.sin(np.arange(FRAMES) / FPS * 6)
    return character, d.animate(character, d.Motion(FPS, dofs), d.AnimateOptions(high=False))


@pytest.fixture(scope="module")
def viewers(turning, tmp_path_factory):
    """With a key every frame, and every fourth."""
    folder = tmp_path_factory.mktemp("baked")
    d.write_baked_glb(folder / "every.glb", *turning)
    d.write_baked_glb(folder / "fourth.glb", *turning, d.BakedGlbOptions(keys_per_second=FPS / 4))
    return Viewer(folder / "every.glb"), Viewer(folder / "fourth.glb")


def off(shown, true):
    return np.linalg.norm(shown - true, axis=-1).max()


def test_every_frame_is_exact(turning, viewers):
    for frame in range(FRAMES):
        assert off(viewers[0].mesh("surface", frame / FPS), turning[1].surface[frame]) < 1e-5


def test_between_keys_skin_follows_the_bones(turning, viewers):
    character, surface = turning[0], turning[1].surface
    skin = np.asarray(character.segmentation.clothness) == 0
    halfway = [off(viewers[1].mesh("surface", t / FPS)[skin], surface[t][skin]) for t in range(2, FRAMES, 4)]
    straight = [off(((surface[t - 2] + surface[t + 2]) / 2)[skin], surface[t][skin]) for t in range(2, FRAMES, 4)]
    assert max(straight) > 0.01  # m, what shapes in the world would be off
    assert max(halfway) < 0.002


def test_the_body_is_the_one_under_the_cloth(turning, viewers):
    character, animation = turning
    used = np.unique(character.body.faces[np.asarray(character.body_shown, bool)])
    for frame in (0, 16, FRAMES - 1):
        assert off(viewers[0].mesh("body", frame / FPS), animation.body[frame][used]) < 1e-5
