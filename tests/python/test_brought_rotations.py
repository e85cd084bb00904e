"""Poses of the SMPL family as programs write them: axis times angle, matrices, six numbers; one motion."""

import doublet as d
import numpy as np
import pytest
from doublet.export.clips import JOINTS, read_smpl_motion

FRAMES, COUNT = 6, 24


def turned() -> np.ndarray:
    """(T, 24, 3, 3), whatever turns, half turns among them."""
    random = np.random.default_rng(5)
    axes = random.normal(size=(FRAMES, COUNT, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    angles = random.uniform(0, np.pi, (FRAMES, COUNT, 1))
    angles[2:4, 3:9] = np.pi
    angles[:, 0] = 0.1
    vectors = axes * angles
    x, y, z = np.moveaxis(axes, -1, 0)
    cross = np.stack([0 * x, -z, y, z, 0 * x, -x, -y, x, 0 * x], axis=-1).reshape(FRAMES, COUNT, 3, 3)
    s, c = np.sin(angles)[..., None], np.cos(angles)[..., None]
    return vectors, np.eye(3) + s * cross + (1 - c) * cross @ cross


VECTORS, MATRICES = turned()
SIX = MATRICES[..., :2]
FORMS = {
    "matrices": {"poses": MATRICES},
    "matrices in rows": {"poses": MATRICES.reshape(FRAMES, -1)},
    "root and body": {"global_orient": MATRICES[:, :1], "body_pose": MATRICES[:, 1:]},
    "root and 21 joints of SMPL-X": {"global_orient": MATRICES[:, :1], "body_pose": MATRICES[:, 1:22]},
    "six numbers": {"poses": SIX.reshape(FRAMES, -1)},
    "six numbers of each joint": {"poses": SIX.reshape(FRAMES, COUNT, 6)},
    "vectors of each joint": {"poses": VECTORS},
    "SMPL-H": {"poses": np.concatenate([VECTORS[:, :22], np.zeros((FRAMES, 30, 3))], axis=1).reshape(FRAMES, -1)},
    "SMPL-X": {"poses": np.concatenate([VECTORS[:, :22], np.zeros((FRAMES, 33, 3))], axis=1).reshape(FRAMES, -1)},
}


def read(path, **arrays):
    np.savez(path, trans=np.zeros((FRAMES, 3)), fps=30, **arrays)
    return read_smpl_motion(path)


@pytest.mark.parametrize("form", FORMS)
def test_one_motion_in_every_form(tmp_path, form):
    expected = read(tmp_path / "a.npz", poses=VECTORS.reshape(FRAMES, -1))
    found = read(tmp_path / "b.npz", **FORMS[form])
    same = np.abs(np.sum(expected.rotations * found.rotations, axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-6)
    np.testing.assert_allclose(found.positions, expected.positions, atol=1e-5)
    assert found.joint_names == [name for name, _, _ in JOINTS]


def test_the_only_one_of_several_people_is_read(tmp_path):
    """As programs write it that follow people through a video."""
    parts = {"root_orient": VECTORS[:, 0], "pose_body": VECTORS[:, 1:22].reshape(FRAMES, -1)}
    expected = read(tmp_path / "a.npz", **parts)
    for people in (1, 2):
        of_all = {name: np.stack([part] * people) for name, part in {**parts, "trans": np.zeros((FRAMES, 3))}.items()}
        np.savez(tmp_path / f"{people}.npz", fps=30, seq_name=np.array({"a": 1}, dtype=object), **of_all)
    np.testing.assert_array_equal(read_smpl_motion(tmp_path / "1.npz").positions, expected.positions)
    with pytest.raises(ValueError, match=r"2\.npz: expected poses of one person, found 'trans' of shape \(2, 6, 3\); choose one"):
        read_smpl_motion(tmp_path / "2.npz")


@pytest.mark.parametrize(
    "poses",
    [
        MATRICES[..., :2].swapaxes(-1, -2).reshape(FRAMES, -1),  # rows or columns: nobody can tell
        np.random.default_rng(1).normal(size=(FRAMES, 144)),  # of a network, never brought to axes
        np.random.default_rng(1).normal(size=(FRAMES, 24, 3, 3)),
        np.zeros((FRAMES, 96)),  # quaternions
        -MATRICES,
        np.float64(3),
    ],
    ids=["six in rows", "six of a network", "no rotations", "quaternions", "mirrors", "one number"],
)
def test_what_is_no_rotation_is_refused(tmp_path, poses):
    with pytest.raises(
        ValueError, match=r"b\.npz: expected 'poses' with a row of at least 66 angles a frame .* or of rotation matrices, found"
    ):
        read(tmp_path / "b.npz", poses=poses)
    assert issubclass(d.Error, RuntimeError)
