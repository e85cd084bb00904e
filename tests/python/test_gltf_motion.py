"""Clips in .glb: known poses under scaled and turned parents, the three ways between keys, and what is refused."""

import json
import struct

import doublet as d
import numpy as np
import pytest

QUARTER = np.sqrt(0.5)  # sine and cosine of half a right angle
ABOUT_X = [QUARTER, 0, 0, QUARTER]
ABOUT_Z = [0, 0, QUARTER, QUARTER]
NONE = [0, 0, 0, 1]


def write_glb(path, nodes, tracks, skins=(), change=lambda gltf: None):
    """tracks: (node, path, times, values, interpolation)."""
    binary, views, accessors, channels, samplers = b"", [], [], [], []

    def put(values):
        nonlocal binary
        data = np.asarray(values, "<f4")
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": data.nbytes})
        kind = "SCALAR" if data.ndim == 1 else "MAT4" if data.ndim == 3 else f"VEC{data.shape[1]}"
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "type": kind, "count": len(data)})
        binary += data.tobytes()
        return len(accessors) - 1

    for node, what, times, values, between in tracks:
        samplers.append({"input": put(times), "output": put(values), "interpolation": between})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": what}})
    skins = [{**skin, "inverseBindMatrices": put(skin["inverseBindMatrices"])} if len(skin) > 1 else skin for skin in skins]
    gltf = {"asset": {"version": "2.0"}, "nodes": nodes, "bufferViews": views, "accessors": accessors, "skins": skins}
    gltf.update(buffers=[{"byteLength": len(binary)}], animations=[{"channels": channels, "samplers": samplers}])
    change(gltf)
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    size = 28 + len(text) + len(binary)
    path.write_bytes(
        struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
        + text
        + struct.pack("<II", len(binary), 0x004E4942)
        + binary
    )
    return path


def arm(**more):
    """In centimetres and with +Z up below a node that makes metres and +Y of it: a shoulder, an elbow 30 cm along x, a wrist."""
    nodes = [
        {"name": "Armature", "scale": [0.01] * 3, "rotation": [-QUARTER, 0, 0, QUARTER], "children": [1]},
        {"name": "shoulder", "translation": [0, 0, 140], "children": [2]},
        {"name": "elbow", "translation": [30, 0, 0], "children": [3]},
        {"name": "wrist", "translation": [25, 0, 0]},
        {"name": "lamp", "rotation": ABOUT_X},
    ]
    tracks = [(2, "rotation", [0, 0.5, 1], [NONE, ABOUT_Z, NONE], "LINEAR"), (4, "rotation", [0, 9], [NONE, ABOUT_X], "LINEAR")]
    return {"nodes": nodes, "tracks": tracks, "skins": [{"joints": [3, 1, 2]}], **more}


def test_what_stands_behind_a_clip_is_left_aside(tmp_path):
    path = write_glb(tmp_path / "arm.glb", **arm())
    whole = path.read_bytes()
    frames = d.SourceMotion.read(path).frame_count
    path.write_bytes(whole + bytes(7))
    assert d.SourceMotion.read(path).frame_count == frames
    for length in (0, 12, 27, 28, len(whole) - 40):  # as it says
        path.write_bytes(whole[:8] + struct.pack("<I", length) + whole[12:])
        with pytest.raises(d.Error, match=r"arm\.glb: expected"):
            d.SourceMotion.read(path)


@pytest.mark.parametrize("rate", [30, 60, 120])
def test_key_times_of_whole_milliseconds_keep_their_rate(tmp_path, rate):
    times, half = np.round(np.arange(rate + 1) / rate, 3), np.linspace(0, 0.5, rate + 1)
    turns = np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], axis=1)
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(tracks=[(2, "rotation", times, turns, "LINEAR")])))
    assert (clip.fps, clip.frame_count) == (rate, rate + 1)


@pytest.mark.parametrize("rate", [24 / 1.001, 30 / 1.001, 60 / 1.001])
def test_a_broadcast_rate_is_kept(tmp_path, rate):
    """At a whole one the poses would lie between the keys."""
    times, half = np.arange(31) / rate, np.linspace(0, 0.5, 31)
    turns = np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], axis=1)
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(tracks=[(2, "rotation", times, turns, "LINEAR")])))
    assert clip.fps == pytest.approx(rate, rel=1e-9) and clip.frame_count == 31


def test_joints_of_the_skin_in_metres_relative_to_how_they_rest(tmp_path):
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm()))
    assert clip.joint_names == ["shoulder", "elbow", "wrist"]
    assert clip.fps == 24 and clip.frame_count == 25  # a second; the lamp's nine are another's
    np.testing.assert_allclose(clip.offsets, [[0, 1.4, 0], [0.3, 0, 0], [0.25, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.positions[0], [[0, 1.4, 0], [0.3, 1.4, 0], [0.55, 1.4, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.positions[12][2], [0.3, 1.4, -0.25], atol=1e-6)  # +Y of the file's is -Z
    np.testing.assert_allclose(clip.rotations[0], [[1, 0, 0, 0]] * 3, atol=1e-6)
    np.testing.assert_allclose(np.abs(clip.rotations[12][2]), [QUARTER, 0, QUARTER, 0], atol=1e-6)  # about +Y of the world


def test_without_a_skin_what_turns_is_a_joint_and_what_hangs_on_it(tmp_path):
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(skins=[])))
    assert clip.joint_names == ["elbow", "wrist"]  # of two that turn, the lamp being the other, the first
    turns = [(node, "rotation", [0, 1], [NONE, ABOUT_Z], "LINEAR") for node in (1, 3)]
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(skins=[], tracks=turns)))
    assert clip.joint_names == ["shoulder", "elbow", "wrist"]  # the elbow is still: exporters leave its track out


@pytest.mark.parametrize("extension", ["VRMC_vrm", "VRMC_vrm_animation"])
def test_vrm_says_which_bone_is_which(tmp_path, extension):
    bones = {"leftUpperArm": {"node": 1}, "leftLowerArm": {"node": 2}, "leftHand": {"node": 3}}

    def say(gltf):
        gltf["extensions"] = {extension: {"humanoid": {"humanBones": bones}}}

    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.vrma", **arm(skins=[], change=say)))
    found = {match.part: clip.joint_names[match.joint] for match in d.explain_match(clip) if match.joint >= 0}
    assert found == {"l_shoulder": "shoulder", "l_elbow": "elbow", "l_wrist": "wrist"}


@pytest.mark.parametrize(
    "mirrored",
    [
        {"scale": [-0.01, 0.01, 0.01]},
        {"scale": [0.01, 0.01, -0.01]},
        {"matrix": np.diag([-0.01, 0.01, 0.01, 1]).ravel().tolist()},
    ],
)
def test_what_hangs_on_a_mirrored_node_turns_the_other_way(tmp_path, mirrored):
    """By the definition of a joint's rotation: it takes the bones of the zero pose to those of the pose."""
    parts = arm()
    parts["nodes"][0] = {"name": "Armature", "children": [1], **mirrored}
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **parts))
    assert abs(clip.positions[12][2][1] - clip.positions[12][1][1]) > 0.2
    w, *v = clip.rotations[12][1]
    turned = clip.offsets[2] + 2 * np.cross(v, np.cross(v, clip.offsets[2]) + w * clip.offsets[2])
    np.testing.assert_allclose(clip.positions[12][2] - clip.positions[12][1], turned, atol=1e-6)


@pytest.mark.parametrize(
    "seen", [np.eye(3), 100 * np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]])], ids=["in the world", "cm, +Z up"]
)
def test_nodes_that_stand_in_some_frame_have_the_pose_of_the_skin_as_zero_pose(tmp_path, seen):
    """`seen`: the mesh's own axes and unit. Matrices that are none leave the nodes as they are."""
    straight = arm()
    joints = straight["skins"][0]["joints"]
    places = {1: [0, 1.4, 0], 2: [0.3, 1.4, 0], 3: [0.55, 1.4, 0]}
    bind = np.tile(np.eye(4), (3, 1, 1))
    for matrix, joint in zip(bind, joints):
        matrix[:3, :3] = seen @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # as the joints' axes are in the world
        matrix[:3, 3] = seen @ places[joint]
    columns = np.swapaxes(np.linalg.inv(bind), 1, 2)
    posed = arm(skins=[{"joints": joints, "inverseBindMatrices": columns}])
    posed["nodes"][2]["rotation"] = [0, 0, np.sin(0.3), np.cos(0.3)]
    clip = d.SourceMotion.read(write_glb(tmp_path / "straight.glb", **straight))
    same = d.SourceMotion.read(write_glb(tmp_path / "posed.glb", **posed))
    np.testing.assert_allclose(same.offsets, clip.offsets, atol=1e-6)
    for now, then in zip(same.rotations[12], clip.rotations[12]):
        assert abs(now @ then) == pytest.approx(1, abs=1e-9)
    posed["skins"][0]["inverseBindMatrices"] = np.tile(np.eye(4), (3, 1, 1))
    unbound = d.SourceMotion.read(write_glb(tmp_path / "unbound.glb", **posed))
    np.testing.assert_allclose(unbound.offsets[2], [0.25 * np.cos(0.6), 0, -0.25 * np.sin(0.6)], atol=1e-6)


def test_steps_are_at_the_times_of_their_keys(tmp_path):
    """Key times are floats, every second of which is a little late."""
    count = 60
    heights = [[0, 0, 100 * t] for t in range(count)]
    track = (1, "translation", np.arange(count) / 30, heights, "STEP")
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(tracks=[track])))
    np.testing.assert_allclose([places[0][1] for places in clip.positions], np.arange(count), atol=1e-4)


def test_pictures_elsewhere_do_not_matter_to_a_motion(tmp_path):
    def textured(gltf):
        gltf["images"] = [{"uri": "shirt.png"}]

    assert d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(change=textured))).frame_count == 25


def test_the_three_ways_between_keys(tmp_path):
    straight = [[0, 0, 140], [0, 0, 141]]
    spline = np.repeat([[[0, 0, 0]], [[0, 0, 140]], [[0, 0, 0]]], 1, axis=1).reshape(-1, 3).tolist()
    spline += [[0, 0, 0], [0, 0, 141], [0, 0, 0]]
    heights = {}
    for between, values in (("LINEAR", straight), ("STEP", straight), ("CUBICSPLINE", spline)):
        clip = d.SourceMotion.read(write_glb(tmp_path / "a.glb", **arm(tracks=[(1, "translation", [0, 1], values, between)])))
        heights[between] = [100 * clip.positions[t][0][1] - 140 for t in (0, 6, 12, 24)]
    np.testing.assert_allclose(heights["LINEAR"], [0, 0.25, 0.5, 1], atol=1e-4)
    np.testing.assert_allclose(heights["STEP"], [0, 0, 0, 1], atol=1e-4)
    np.testing.assert_allclose(heights["CUBICSPLINE"], [0, 0.15625, 0.5, 1], atol=1e-4)  # 3 s^2 - 2 s^3


def node(index, **more):
    return lambda gltf: gltf["nodes"][index].update(more)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"change": lambda gltf: gltf.pop("animations")}, "expected an animation, found none"),
        ({"change": node(3, children=[1])}, "expected one parent for node 1, found two"),
        ({"change": node(0, children=[])}, None),
        ({"change": node(4, children=[4])}, "expected a tree of nodes, found a cycle"),
        ({"change": node(0, children=[77])}, "expected a child to be one of 5 nodes, found 77"),
        ({"change": node(0, rotation=[0, 0, 0, 3])}, "expected unit quaternions, found one of length 3 at node 'Armature'"),
        ({"change": node(0, translation=[0, 1])}, "expected nodes and animations of glTF 2.0"),
        ({"skins": [{"joints": []}]}, "expected joints, found no skin and no node that turns"),
        ({"tracks": [(2, "rotation", [0, 0], [NONE, ABOUT_Z], "LINEAR")]}, "expected key times that ascend"),
        ({"tracks": [(2, "rotation", [0, 1], [NONE], "LINEAR")]}, "expected 8 numbers for 2 keys of an animation, found 4"),
        ({"tracks": [(2, "rotation", [0, 1e9], [NONE, ABOUT_Z], "LINEAR")]}, "expected a clip of at most 2e.07 poses"),
        ({"tracks": [(4, "rotation", [0, 1], [NONE, ABOUT_X], "LINEAR")]}, "expected an animation of joints"),
    ],
)
def test_wrong_files_get_their_sentence(tmp_path, more, sentence):
    path = write_glb(tmp_path / "arm.glb", **arm(**more))
    if sentence is None:
        assert d.SourceMotion.read(path).frame_count == 25
        return
    with pytest.raises(d.Error, match=sentence) as error:
        d.SourceMotion.read(path)
    assert str(path) in str(error.value)
