"""Clips in FBX: a skeleton with known poses, written as text the way Mixamo and Maya write it, and one as Blender writes it."""

from pathlib import Path

import doublet as d
import numpy as np
import pytest
from test_gltf_motion import QUARTER

TICKS = 46186158000  # a second
#: name -> parent, place (cm), orientation (degrees; what FBX calls PreRotation). Straight up +Y, the arm along +X.
BONES = {
    "Hips": (None, (0, 100, 0), (0, 0, 0)),
    "Arm": ("Hips", (0, 40, 0), (0, 0, -90)),
    "ForeArm": ("Arm", (0, 30, 0), (0, 0, 0)),
    "Hand": ("ForeArm", (0, 25, 0), (0, 0, 0)),
}


def vector(name: str, kind: str, values) -> str:
    return f'P: "{name}", "{kind}", "", "A",{",".join(map(str, values))}'


def write_fbx(path, takes, stands=None, fps=30, centimetres=1.0, up=1, bones=BONES):
    """takes: name -> bone -> degrees about its z, a key a frame; stands: bone -> degrees that it is left at."""
    ids = {bone: 100 + i for i, bone in enumerate(bones)}
    objects, links, number = [], [], 1000
    for bone, (parent, place, orientation) in bones.items():
        lines = [vector("Lcl Translation", "Lcl Translation", place)]
        lines += [vector("Lcl Rotation", "Lcl Rotation", (0, 0, (stands or {}).get(bone, 0)))]
        lines += ['P: "RotationActive", "bool", "", "",1', vector("PreRotation", "Vector3D", orientation)]
        objects += [f'Model: {ids[bone]}, "Model::{bone}", "LimbNode" {{ Version: 232\nProperties70: {{', *lines, "} }"]
        objects += [f'NodeAttribute: {ids[bone] + 400}, "NodeAttribute::", "LimbNode" {{ TypeFlags: "Skeleton" }}']
        links += [f'C: "OO",{ids[bone]},{ids[parent] if parent else 0}', f'C: "OO",{ids[bone] + 400},{ids[bone]}']
    for take, turned in takes.items():
        stack, layer, number = number, number + 1, number + 2
        longest = max(len(degrees) for degrees in turned.values())
        ends = f'P: "LocalStart", "KTime", "Time", "",0\nP: "LocalStop", "KTime", "Time", "",{(longest - 1) * TICKS // fps}'
        objects += [f'AnimationStack: {stack}, "AnimStack::{take}", "" {{\nProperties70: {{\n{ends}\n}} }}']
        objects += [f'AnimationLayer: {layer}, "AnimLayer::Base", "" {{ }}']
        links += [f'C: "OO",{layer},{stack}']
        for bone, degrees in turned.items():
            node, curve, number = number, number + 1, number + 2
            times = ",".join(str(frame * TICKS // fps) for frame in range(len(degrees)))
            parts = [f'P: "d|{axis}", "Number", "", "A",0' for axis in "XYZ"]
            objects += [f'AnimationCurveNode: {node}, "AnimCurveNode::R", "" {{\nProperties70: {{', *parts, "} }"]
            objects += [f'AnimationCurve: {curve}, "AnimCurve::", "" {{ Default: 0\nKeyVer: 4008']
            objects += [f"KeyTime: *{len(degrees)} {{ a: {times} }}"]
            objects += [f"KeyValueFloat: *{len(degrees)} {{ a: {','.join(map(str, degrees))} }}"]
            objects += ["KeyAttrFlags: *1 { a: 4 }\nKeyAttrDataFloat: *4 { a: 0,0,0,0 }"]
            objects += [f"KeyAttrRefCount: *1 {{ a: {len(degrees)} }} }}"]
            links += [f'C: "OO",{node},{layer}', f'C: "OP",{node},{ids[bone]}, "Lcl Rotation"']
            links += [f'C: "OP",{curve},{node}, "d|Z"']
    axes = {"UpAxis": up, "UpAxisSign": 1, "FrontAxis": 2 if up == 1 else 1, "FrontAxisSign": 1 if up == 1 else -1}
    axes.update(CoordAxis=0, CoordAxisSign=1, TimeMode={30: 6, 60: 3, 24: 11}[fps])
    settings = [f'P: "{name}", "int", "Integer", "",{value}' for name, value in axes.items()]
    settings += [f'P: "UnitScaleFactor", "double", "Number", "",{centimetres}']
    text = ["; FBX 7.4.0 project file", "FBXHeaderExtension: { FBXVersion: 7400 }", "GlobalSettings: { Version: 1000"]
    text += ["Properties70: {", *settings, "} }", "Objects: {", *objects, "}", "Connections: {", *links, "}"]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
    return path


WAVE = {"Wave": {"Arm": [0, 45, 90, 45, 0], "ForeArm": [0, 0, 90, 0, 0]}}


def test_poses_in_metres_relative_to_how_the_skeleton_was_made(tmp_path):
    clip = d.SourceMotion.read(write_fbx(tmp_path / "wave.fbx", WAVE))
    assert clip.joint_names == list(BONES) and clip.animations == ["Wave"] and clip.fps == 30 and clip.frame_count == 5
    np.testing.assert_allclose(clip.offsets, [[0, 1, 0], [0, 0.4, 0], [0.3, 0, 0], [0.25, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.positions[0], [[0, 1, 0], [0, 1.4, 0], [0.3, 1.4, 0], [0.55, 1.4, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.positions[2], [[0, 1, 0], [0, 1.4, 0], [0, 1.7, 0], [-0.25, 1.7, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.rotations[0], [[1, 0, 0, 0]] * 4, atol=1e-6)
    np.testing.assert_allclose(np.abs(clip.rotations[2][1]), [QUARTER, 0, 0, QUARTER], atol=1e-6)


def test_a_binary_file_of_blenders(tmp_path):
    """Exported from Blender 5.0: an arm that is lifted by 90 degrees about +Z in three frames."""
    (tmp_path / "arm.fbx").write_bytes((Path(__file__).parents[1] / "fuzz/corpus/fbx_motion/blender_binary").read_bytes())
    clip = d.SourceMotion.read(tmp_path / "arm.fbx")
    assert clip.joint_names == ["Hips", "Arm", "Hand"] and clip.fps == 25
    half = 0.3 * QUARTER
    lifted = [[[0, 1, 0], [0, 1.4, 0], [0.3, 1.4, 0]], [[0, 1, 0], [0, 1.4, 0], [half, 1.4 + half, 0]]]
    np.testing.assert_allclose(clip.positions, [*lifted, [[0.1, 1, 0], [0.1, 1.4, 0], [0.1, 1.7, 0]]], atol=1e-5)


@pytest.mark.parametrize("fps", [24, 30, 60])
def test_the_rate_is_the_files(tmp_path, fps):
    clip = d.SourceMotion.read(write_fbx(tmp_path / "wave.fbx", WAVE, fps=fps))
    assert clip.fps == fps and clip.frame_count == 5


def test_inches_and_z_up_become_metres_and_y_up(tmp_path):
    bones = {"Hips": (None, (0, 0, 40), (90, 0, 0)), **{name: bone for name, bone in BONES.items() if name != "Hips"}}
    clip = d.SourceMotion.read(write_fbx(tmp_path / "wave.fbx", WAVE, centimetres=2.54, up=2, bones=bones))
    inch = 0.0254
    expected = [[0, 40 * inch, 0], [0, 80 * inch, 0], [30 * inch, 80 * inch, 0], [55 * inch, 80 * inch, 0]]
    np.testing.assert_allclose(clip.positions[0], expected, atol=1e-6)


def test_a_skeleton_that_is_left_in_a_frame_of_the_clip_was_not_made_so(tmp_path):
    """As Maya leaves it: what is written is the first frame, bent; with nothing turned the arm is straight."""
    bent = {"Wave": {"Arm": [30, 45, 90], "ForeArm": [80, 0, 90]}}
    clip = d.SourceMotion.read(write_fbx(tmp_path / "bent.fbx", bent, stands={"Arm": 30, "ForeArm": 80}))
    np.testing.assert_allclose(clip.offsets, [[0, 1, 0], [0, 0.4, 0], [0.3, 0, 0], [0.25, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(clip.positions[2], [[0, 1, 0], [0, 1.4, 0], [0, 1.7, 0], [-0.25, 1.7, 0]], atol=1e-6)
    elsewhere = d.SourceMotion.read(write_fbx(tmp_path / "posed.fbx", WAVE, stands={"ForeArm": 80}))  # in no frame of it
    assert np.linalg.norm(elsewhere.offsets[3] - [0.25, 0, 0]) > 0.1


def test_takes_are_chosen_by_name_or_number(tmp_path):
    still = {"Still": {"Arm": [0, 0, 0]}, **WAVE}
    path = write_fbx(tmp_path / "takes.fbx", still)
    assert d.SourceMotion.read(path).animation == 1  # the first that moves
    assert d.SourceMotion.read(path, animation="Still").frame_count == 3
    assert d.SourceMotion.read(path, animation="2").frame_count == 5
    with pytest.raises(d.Error, match="takes.fbx: expected one of the animations Still, Wave"):
        d.SourceMotion.read(path, animation="Run")


def test_what_is_no_clip_is_refused_by_name(tmp_path):
    (tmp_path / "a.fbx").write_bytes(b"Kaydara FBX Binary  \x00\x1a\x00" + bytes(40))
    (tmp_path / "b.fbx").write_text("o box\nv 0 0 0\n", encoding="utf-8")  # another format under this name
    (tmp_path / "c.fbx").write_bytes(b"")
    write_fbx(tmp_path / "d.fbx", {})
    write_fbx(tmp_path / "e.fbx", {"Wave": {"Arm": [0, 90]}}).write_text(
        (tmp_path / "e.fbx").read_text(encoding="utf-8").replace(str(TICKS // 30), "9" * 18), encoding="utf-8"
    )
    for name in "abcde":
        with pytest.raises(d.Error, match=f"{name}.fbx: expected"):
            d.SourceMotion.read(tmp_path / f"{name}.fbx")
    with pytest.raises(FileNotFoundError):
        d.SourceMotion.read(tmp_path / "none.fbx")
