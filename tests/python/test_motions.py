"""Poses of the SMPL family become motions of ours: known poses in worlds with any axis up, and what is refused."""

import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.export.clips import JOINTS, read_clip, read_motion, read_smpl_motion

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402

NAMES = [name for name, _, _ in JOINTS]
Z_UP = [np.pi / 2, 0, 0]  # of a body whose zero pose has +Y up
FRAMES = 4


@pytest.fixture(scope="module")
def world():
    return World()


def smpl(path, pose=None, up=Z_UP, names=("poses",), **more):
    """A file of one pose: joint -> axis times angle."""
    angles = np.zeros((FRAMES, 52, 3))
    angles[:, 0] = up
    for joint, rotation in (pose or {}).items():
        angles[:, NAMES.index(joint)] = rotation
    arrays = {"trans": np.zeros((FRAMES, 3)), "mocap_framerate": np.array(120.0)}
    if names == ("poses",):
        arrays["poses"] = angles.reshape(FRAMES, -1)
    else:
        arrays[names[0]], arrays[names[1]] = angles[:, 0], angles[:, 1:22].reshape(FRAMES, -1)
    arrays.update(more)
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def bone(clip, start, end, frame=0):
    names = clip.joint_names
    way = clip.positions[frame][names.index(end)] - clip.positions[frame][names.index(start)]
    return way / np.linalg.norm(way)


@pytest.mark.parametrize("up", [Z_UP, [0, 0, 0], [np.pi, 0, 0]])
def test_the_body_stands_up_whatever_the_axis(tmp_path, up):
    clip = read_smpl_motion(smpl(tmp_path / "a.npz", up=up))
    assert clip.fps == 120 and clip.frame_count == FRAMES and list(clip.up) == [0, 1, 0]
    np.testing.assert_allclose(bone(clip, "pelvis", "neck"), [0, 1, 0], atol=0.1)
    np.testing.assert_allclose(bone(clip, "l_hip", "l_ankle"), [0, -1, 0], atol=0.1)


@pytest.mark.parametrize("names", [("poses",), ("root_orient", "pose_body"), ("global_orient", "body_pose")])
def test_rotations_add_up_along_the_arm(tmp_path, names):
    bent = {"l_shoulder": [0, 0, -np.pi / 2], "l_elbow": [0, -np.pi / 2, 0], "r_knee": [np.pi / 2, 0, 0]}
    clip = read_smpl_motion(smpl(tmp_path / "a.npz", bent, names=names))
    np.testing.assert_allclose(bone(clip, "l_shoulder", "l_elbow"), [0, -1, 0], atol=0.1)  # the T-pose's arm hangs
    np.testing.assert_allclose(bone(clip, "l_elbow", "l_wrist"), [0, 0, 1], atol=0.1)  # the forearm points ahead
    np.testing.assert_allclose(bone(clip, "r_shoulder", "r_elbow"), [-1, 0, 0], atol=0.1)  # the other one is as it was
    np.testing.assert_allclose(bone(clip, "r_knee", "r_ankle"), [0, 0, -1], atol=0.15)


def test_it_walks_the_way_of_the_world(tmp_path):
    """20 cm along +Y of a z-up world: along -Z of ours, which the body, facing -Y there and +Z here, walks backwards."""
    place = np.outer(np.linspace(0, 1, FRAMES), [0, 0.2, 0])
    clip = read_smpl_motion(smpl(tmp_path / "a.npz", trans=place))
    np.testing.assert_allclose(clip.positions[-1][0] - clip.positions[0][0], [0, 0, -0.2], atol=1e-9)


def test_names_may_be_in_capitals(world, tmp_path):
    """As those of other motion files may."""
    assert read_clip(smpl(tmp_path / "a.npz").rename(tmp_path / "AMASS.NPZ")).frame_count == FRAMES
    np.savez(tmp_path / "own.npz", dofs=np.zeros((FRAMES, len(world.skeleton.dof_names))))
    own = (tmp_path / "own.npz").rename(tmp_path / "OWN.NPZ")
    assert len(read_motion(own, world.character, d.RetargetOptions())) == FRAMES


def test_pickled_poses_are_to_be_arrays(world, tmp_path):
    (tmp_path / "wham_output.pkl").write_bytes(b"x")
    with pytest.raises(ValueError, match=r"wham_output\.pkl: expected a clip .*, found '\.pkl'; numpy\.savez writes them"):
        read_motion(tmp_path / "wham_output.pkl", world.character, d.RetargetOptions())
    np.save(tmp_path / "humanml3d.npy", np.zeros((20, 22, 3)))
    with pytest.raises(ValueError, match="places of joints alone, as of HumanML3D, say no rotations"):
        read_motion(tmp_path / "humanml3d.npy", world.character, d.RetargetOptions())


@pytest.mark.parametrize("where", ["along -X", "along +Y", "after a frame in which she stands", "on another floor"])
def test_who_lies_in_amass_is_not_set_upright(tmp_path, where):
    """On the back in a world with +Z up."""
    poses, place = np.zeros((FRAMES, 156)), np.tile([0, 0, 0.2], (FRAMES, 1))
    if where == "along -X":
        poses[:, :3] = [0, 0, np.pi / 2]
    if where == "along +Y":
        place += [0, 3, 0]
    if where == "after a frame in which she stands":
        poses[0, :3] = Z_UP
    if where == "on another floor":
        place += np.outer(np.linspace(0, 1, FRAMES), [0, 0.3, 0]) - [0, 0, 3]
    clip = read_smpl_motion(smpl(tmp_path / "a.npz", trans=place, poses=poses))
    assert abs(bone(clip, "pelvis", "neck", -1)[1]) < 0.2
    np.testing.assert_allclose(clip.positions[-1][0], place[-1][[0, 2, 1]] * [1, 1, -1], atol=1e-9)


def actor_skeleton():
    """An actor who stands with her arms half lowered, as marked in a scan: another rest pose than SMPL's."""
    marks = [d.JointAnnotation("pelvis", "", [0, 0.95, 0]), d.JointAnnotation("spine", "pelvis", [0, 1.1, -0.02])]
    marks += [d.JointAnnotation("chest", "spine", [0, 1.25, -0.02]), d.JointAnnotation("neck", "chest", [0, 1.45, -0.02])]
    marks += [d.JointAnnotation("head", "neck", [0, 1.55, 0.01]), d.JointAnnotation("head_top", "head", [0, 1.72, 0.01])]
    for side, x in (("l_", 1), ("r_", -1)):
        limbs = [("hip", "pelvis", 0.09, 0.9, 0), ("knee", "hip", 0.1, 0.5, 0.02), ("ankle", "knee", 0.11, 0.08, 0)]
        limbs += [("toe", "ankle", 0.12, 0.02, 0.13), ("clavicle", "chest", 0.03, 1.4, -0.01)]
        limbs += [("shoulder", "clavicle", 0.17, 1.4, -0.02), ("elbow", "shoulder", 0.35, 1.2, -0.02)]
        limbs += [("wrist", "elbow", 0.5, 1.03, 0.06), ("hand", "wrist", 0.56, 0.96, 0.1)]
        for name, parent, *place in limbs:
            above = parent if parent in ("pelvis", "chest") else side + parent
            marks.append(d.JointAnnotation(side + name, above, [x * place[0], *place[1:]]))
    return d.Skeleton(marks)


def test_an_actor_takes_the_pose(tmp_path):
    skeleton = actor_skeleton()
    options = d.RetargetOptions(hold_seconds=0, blend_seconds=0, align_start=False)
    path = smpl(tmp_path / "a.npz", {"l_shoulder": [0, 0, -1.2], "r_shoulder": [0, 0, 1.2], "l_elbow": [0, -1.4, 0]})
    places = skeleton.joint_positions(d.retarget(read_smpl_motion(path), skeleton, options).dofs[-1])
    at = {name: places[skeleton.find(name)] for name in skeleton.joint_names}

    def way(start, end):
        return (at[end] - at[start]) / np.linalg.norm(at[end] - at[start])

    bend = np.degrees(np.arccos(way("l_elbow", "l_wrist") @ way("l_shoulder", "l_elbow")))
    assert bend == pytest.approx(80, abs=8)
    assert way("l_shoulder", "l_elbow")[1] < -0.85 and way("r_shoulder", "r_elbow")[1] < -0.85
    np.testing.assert_allclose(way("l_elbow", "l_wrist"), [0, 0, 1], atol=0.25)
    np.testing.assert_allclose(way("pelvis", "head"), [0, 1, 0], atol=0.1)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"poses": None}, "expected a performance with 'dofs', or 'poses', or 'root_orient' and 'pose_body'"),
        ({"poses": np.zeros((FRAMES, 60))}, r"a row of at least 66 angles a frame .*, found \(4, 60\)"),
        ({"poses": np.zeros(4)}, "at least 66 angles"),
        ({"poses": np.full((FRAMES, 156), np.nan)}, "expected 'poses' to hold finite numbers"),
        ({"poses": np.zeros((0, 156))}, "expected 'poses' to hold finite numbers"),
        ({"poses": np.full((FRAMES, 156), 20.0)}, "more than two turns, as if these were degrees"),
        (
            {"trans": np.arange(3.0 * FRAMES).reshape(FRAMES, 3)},
            "expected 'trans' in metres, found a body that moves by 624 a second",
        ),
        ({"trans": None}, "expected the root's place, 'trans' or 'transl'"),
        ({"trans": np.zeros((3, 3))}, r"expected 'trans' of shape \(4, 3\), found \(3, 3\)"),
        ({"mocap_framerate": None}, "expected a rate, 'mocap_framerate'"),
        ({"mocap_framerate": np.array(0.0)}, r"one rate in \(0, 1000\], found 0"),
        ({"mocap_framerate": np.array("fast")}, "expected 'mocap_framerate' to hold finite numbers"),
    ],
)
def test_wrong_files_get_their_sentence(world, tmp_path, more, sentence):
    path = smpl(tmp_path / "wrong.npz", **more)
    with pytest.raises(ValueError, match=sentence) as error:
        read_motion(path, world.character, d.RetargetOptions())
    assert str(path) in str(error.value)


def test_feet_are_planted_by_retargeting_and_not_on_request(tmp_path):
    skeleton = actor_skeleton()
    dofs = np.zeros((40, len(skeleton.dof_names)))
    dofs[:, 0] = np.linspace(0, 0.05, 40)  # it stands, and slides to its left
    d.write_bvh(tmp_path / "slides.bvh", skeleton, d.Motion(40.0, dofs))
    alone = {"hold_seconds": 0, "blend_seconds": 0}
    off, on = (
        d.retarget(d.SourceMotion.read(tmp_path / "slides.bvh"), skeleton, d.RetargetOptions(plant_feet=planted, **alone))
        for planted in (False, True)
    )
    assert all(foot.heel.all() and foot.ball.all() for foot in d.find_contacts(skeleton, off))
    np.testing.assert_array_equal(d.plant_feet(skeleton, off).dofs, on.dofs)
    ball = skeleton.find("l_toe")
    slid = [np.ptp([skeleton.joint_positions(dofs)[ball, 0] for dofs in m.dofs]) for m in (off, on)]
    assert slid[0] > 0.04
    assert slid[1] < 0.003  # the mark is above the sole, which is what stands


def test_poses_of_the_character_are_one_animation_and_have_no_bones_of_their_own(world, tmp_path):
    path = tmp_path / "performance.npz"
    np.savez(path, dofs=np.zeros((FRAMES, len(world.skeleton.dof_names))))
    assert len(read_motion(path, world.character, d.RetargetOptions())) == FRAMES
    with pytest.raises(ValueError, match=r"performance\.npz: expected a \.glb or \.fbx, which .*, to choose 'dance' of"):
        read_motion(path, world.character, d.RetargetOptions(), animation="dance")
    with pytest.raises(ValueError, match=r"performance\.npz: expected a clip on bones of its own, found poses of a character's"):
        read_clip(path)
