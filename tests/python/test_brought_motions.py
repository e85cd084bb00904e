"""Motion files as people have them: names of other programs, or of none, text as editors leave it, several skins and
animations."""

import json

import doublet as d
import numpy as np
import pytest
from doublet.export.clips import read_clip
from test_gltf_motion import ABOUT_X, ABOUT_Z, NONE, arm, write_glb

#: Our joints of a plain figure -> (parent, offset in cm); left is +x, it faces +z.
LIMBS = {
    "hip": ("pelvis", (9, -5, 0)),
    "knee": ("hip", (1, -41, 0)),
    "ankle": ("knee", (0, -40, -2)),
    "toe": ("ankle", (0, -7, 13)),
}
ARMS = {
    "clavicle": ("chest", (4, 14, 0)),
    "shoulder": ("clavicle", (13, 2, 0)),
    "elbow": ("shoulder", (28, 0, 0)),
    "wrist": ("elbow", (25, 0, 0)),
    "hand": ("wrist", (9, 0, 0)),
}
TRUNK = {
    "spine": ("pelvis", (0, 12, 0)),
    "chest": ("spine", (0, 20, 0)),
    "neck": ("chest", (0, 20, 0)),
    "head": ("neck", (0, 10, 2)),
}


def figure() -> dict:
    joints = {"pelvis": (None, (0, 95, 0)), **TRUNK}
    for side, sign in (("l_", 1), ("r_", -1)):
        for part, (parent, (x, y, z)) in {**ARMS, **LIMBS}.items():
            joints[side + part] = (parent if parent in joints else side + parent, (sign * x, y, z))
    return joints


def bvh(names: dict, frames: int = 3, joints: dict | None = None) -> str:
    """names: our joint -> the file's."""
    joints = joints or figure()
    channels = []

    def write(part: str, indent: str) -> list[str]:
        parent, offset = joints[part]
        channels.append(part)
        lines = [f"{indent}{'JOINT' if parent else 'ROOT'} {names[part]}", indent + "{"]
        lines += [f"{indent}  OFFSET {' '.join(map(str, offset))}"]
        lines += [f"{indent}  CHANNELS {'3' if parent else '6 Xposition Yposition Zposition'} Zrotation Xrotation Yrotation"]
        below = [other for other, (above, _) in joints.items() if above == part]
        for other in below:
            lines += write(other, indent + "  ")
        if not below:
            lines += [f"{indent}  End Site", indent + "  {", f"{indent}    OFFSET 0 1 0", indent + "  }"]
        return [*lines, indent + "}"]

    text = "HIERARCHY\n" + "\n".join(write("pelvis", "")) + f"\nMOTION\nFrames: {frames}\nFrame Time: 0.025\n"
    for t in range(frames):
        text += " ".join(["0 95 0", *(f"{5 * t if part.endswith('knee') else 0} 0 0" for part in channels)]) + "\n"
    return text


def sided(left: str, right: str, limbs: dict, trunk: dict, form="{side}{name}") -> dict:
    both = {
        f"{s}_{part}": form.format(side=side, name=name)
        for s, side in (("l", left), ("r", right))
        for part, name in limbs.items()
    }
    return {**trunk, **both}


def named(parts: str, names: str) -> dict:
    return dict(zip(parts.split(), names.split()))


LIMB_PARTS = "clavicle shoulder elbow wrist hand hip knee ankle toe"
TRUNK_PARTS = "pelvis spine chest neck head"
CONVENTIONS = {
    "SMPL": sided(
        "Left_", "Right_", named(LIMB_PARTS, "collar shoulder elbow wrist hand hip knee ankle foot"),
        named(TRUNK_PARTS, "Pelvis Spine1 Spine3 Neck Head"),
    ),
    "Poser": sided(
        "l", "r", named(LIMB_PARTS, "Collar Shldr ForeArm Hand Mid1 Thigh Shin Foot Toe"),
        named(TRUNK_PARTS, "hip abdomen chest neck head"),
    ),
    "DAZ Genesis 8": sided(
        "l", "r", named(LIMB_PARTS, "Collar ShldrBend ForearmBend Hand Mid1 ThighBend Shin Foot Toe"),
        named(TRUNK_PARTS, "pelvis abdomenLower chestUpper neckLower head"),
    ),
    "VRoid": sided(
        "L", "R", named(LIMB_PARTS, "Shoulder UpperArm LowerArm Hand Middle1 UpperLeg LowerLeg Foot ToeBase"),
        named(TRUNK_PARTS, "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_UpperChest J_Bip_C_Neck J_Bip_C_Head"), "J_Bip_{side}_{name}",
    ),
    "Second Life": sided(
        "Left", "Right", named(LIMB_PARTS, "Collar Shoulder Elbow Wrist HandMiddle1 Hip Knee Ankle Toe"),
        named(TRUNK_PARTS, "mPelvis mTorso mChest mNeck mHead"), "m{name}{side}",
    ),
    "OptiTrack": sided(
        "L", "R", named(LIMB_PARTS, "Shoulder UArm FArm Hand Middle1 Thigh Shin Foot Toe"),
        named(TRUNK_PARTS, "Hip Ab Chest Neck Head"),
    ),
    "MakeHuman": sided(
        "L", "R", named(LIMB_PARTS, "clavicle upperarm01 lowerarm01 wrist hand upperleg01 lowerleg01 foot toe1-1"),
        named(TRUNK_PARTS, "root spine05 spine02 neck01 head"), "{name}.{side}",
    ),
    "Rigify": sided(
        "L", "R", named(LIMB_PARTS, "shoulder upper_arm forearm hand f_middle.01 thigh shin foot toe"),
        named(TRUNK_PARTS, "DEF-spine DEF-spine.001 DEF-spine.003 DEF-spine.004 DEF-spine.006"), "DEF-{name}.{side}",
    ),
    "Advanced Skeleton": sided(
        "L", "R", named(LIMB_PARTS, "Scapula Shoulder Elbow Wrist MiddleFinger1 Hip Knee Ankle Toes"),
        named(TRUNK_PARTS, "Root_M Spine1_M Chest_M Neck_M Head_M"), "{name}_{side}",
    ),
    "a rig with the hero's name and joints": sided(
        "L", "R", named(LIMB_PARTS, "clavicle upperarm forearm hand fingers thigh calf foot ball"),
        {part: f"Hero_{name}_jnt" for part, name in named(TRUNK_PARTS, "pelvis spine chest neck head").items()},
        "Hero_{side}_{name}_jnt",
    ),
}  # fmt: skip
#: Whose names say nothing, or only on which side they are.
WORDLESS = {
    "numbers": {part: f"bone_{i}" for i, part in enumerate(figure())},
    "another language": sided(
        "G_", "D_", named(LIMB_PARTS, "cla bra avb mai doi cui tib pie ort"), named(TRUNK_PARTS, "bas dos tor cou tet")
    ),
}


def matched(path) -> dict:
    clip = d.SourceMotion.read(path)
    return {match.part: clip.joint_names[match.joint] for match in d.explain_match(clip) if match.joint >= 0}


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_names_of_other_programs(tmp_path, convention):
    (tmp_path / "clip.bvh").write_text(bvh(CONVENTIONS[convention]))
    found = matched(tmp_path / "clip.bvh")
    assert {part: found.get(part) for part in CONVENTIONS[convention]} == CONVENTIONS[convention]


def test_arms_that_hang_on_the_neck_do_not_make_it_the_chest(tmp_path):
    """Biped of 3ds Max: the neck turns with the head, the chest does not."""
    limbs = named(LIMB_PARTS, "Clavicle UpperArm Forearm Hand Finger2 Thigh Calf Foot Toe0")
    trunk = {part: f"Bip01 {name}" for part, name in named(TRUNK_PARTS, "Pelvis Spine Spine1 Neck Head").items()}
    names, joints = sided("L", "R", limbs, trunk, "Bip01 {side} {name}"), figure()
    for side, sign in (("l", 1), ("r", -1)):
        joints[f"{side}_clavicle"] = ("neck", (sign * 4, -6, 0))
    (tmp_path / "clip.bvh").write_text(bvh(names, joints=joints))
    found = matched(tmp_path / "clip.bvh")
    assert {part: found.get(part) for part in trunk} == trunk


@pytest.mark.parametrize("convention", WORDLESS)
def test_names_that_say_nothing_are_told_by_shape(tmp_path, convention):
    (tmp_path / "clip.bvh").write_text(bvh(WORDLESS[convention]))
    found = matched(tmp_path / "clip.bvh")
    assert {part: found.get(part) for part in figure()} == WORDLESS[convention]
    clip = d.SourceMotion.read(tmp_path / "clip.bvh")
    assert "by its place and length" in {match.part: match.reason for match in d.explain_match(clip)}["l_knee"]


def test_arms_are_on_the_side_of_their_legs_where_both_legs_begin_in_the_pelvis(tmp_path):
    """As CMU's do, with a joint of no length before each hip; the names say nothing."""
    joints = figure()
    for side in ("l_", "r_"):
        joints[side + "hip_joint"] = ("pelvis", (0, 0, 0))
        joints[side + "hip"] = (side + "hip_joint", joints[side + "hip"][1])
    names = {part: f"bone{i}" for i, part in enumerate(joints)}
    (tmp_path / "clip.bvh").write_text(bvh(names, joints=joints))
    found = matched(tmp_path / "clip.bvh")
    assert {part: found.get(part) for part in figure()} == {part: names[part] for part in figure()}


def test_a_mirrored_figure_has_its_left_where_its_feet_say(tmp_path):
    """Who faces -z has the left at -x."""
    text = bvh(WORDLESS["numbers"])
    for z in ("0 -7 13", "-0 -7 13"):
        text = text.replace(f"OFFSET {z}", f"OFFSET {z.replace('13', '-13')}")
    (tmp_path / "clip.bvh").write_text(text)
    found, names = matched(tmp_path / "clip.bvh"), WORDLESS["numbers"]
    assert found["l_knee"] == names["r_knee"] and found["r_wrist"] == names["l_wrist"]


def test_a_table_is_no_human(tmp_path):
    text = "HIERARCHY\nROOT top\n{\nOFFSET 0 70 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
    for i in range(4):
        text += f"JOINT leg{i}\n{{\nOFFSET {i} 0 0\nCHANNELS 0\nEnd Site\n{{\nOFFSET 0 -70 0\n}}\n}}\n"
    (tmp_path / "table.bvh").write_text(text + "}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n")
    parts = {match.part: match for match in d.explain_match(d.SourceMotion.read(tmp_path / "table.bvh"))}
    assert parts["l_knee"].joint == -1 and parts["l_knee"].reason == "needed, and not found"


CLEAN = bvh(CONVENTIONS["Poser"])


@pytest.mark.parametrize(
    "text",
    [
        b"\xef\xbb\xbf" + CLEAN.encode(),
        CLEAN.replace("\n", "\r").encode(),
        CLEAN.replace("\n", "\r\n").encode(),
        CLEAN.replace("Frames: ", "Frames:").replace("Frame Time: ", "Frame Time:").encode(),
        CLEAN.replace("Frames: ", "Frames :").rstrip("\n").encode(),
    ],
    ids=["byte order mark", "CR", "CRLF", "no blank", "blank before the colon, no end"],
)
def test_text_as_editors_leave_it(tmp_path, text):
    (tmp_path / "clean.bvh").write_text(CLEAN)
    (tmp_path / "clip.bvh").write_bytes(text)
    clean, clip = d.SourceMotion.read(tmp_path / "clean.bvh"), d.SourceMotion.read(tmp_path / "clip.bvh")
    assert clip.fps == clean.fps and clip.joint_names == clean.joint_names
    np.testing.assert_array_equal(clip.positions, clean.positions)


def test_utf_16_is_named(tmp_path):
    (tmp_path / "clip.bvh").write_bytes(CLEAN.encode("utf-16"))
    with pytest.raises(d.Error, match=r"clip\.bvh: expected text in ASCII or UTF-8, found UTF-16"):
        d.SourceMotion.read(tmp_path / "clip.bvh")


def test_two_skeletons_in_a_file_are_named(tmp_path):
    (tmp_path / "clip.bvh").write_text(CLEAN.replace("MOTION", "ROOT another\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\nMOTION"))
    with pytest.raises(d.Error, match=r"expected MOTION, as a clip has one skeleton, found 'ROOT another'"):
        d.SourceMotion.read(tmp_path / "clip.bvh")


def test_frames_of_an_amc_follow_each_other(tmp_path):
    bone = "begin\nname arm\ndirection 1 0 0\nlength 1\nend\n"
    (tmp_path / "a.asf").write_text(f":root\norder TX\n:bonedata\n{bone}:hierarchy\nbegin\nroot arm\nend\n")
    for numbers in ((7, 8, 9), (7, 8, 10)):
        (tmp_path / "a.amc").write_text(":degrees\n" + "".join(f"{n}\nroot {n}\n" for n in numbers))
        if numbers[-1] == 9:
            assert d.SourceMotion.read(tmp_path / "a.amc").frame_count == 3
    with pytest.raises(d.Error, match=r"a\.amc:6: expected frame 9, as frames follow each other, found '10'"):
        d.SourceMotion.read(tmp_path / "a.amc")


# --- glTF


def test_a_joint_between_those_of_the_skin_belongs_to_the_skeleton(tmp_path):
    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(skins=[{"joints": [1, 3]}])))
    assert clip.joint_names == ["shoulder", "elbow", "wrist"]


def body(**more):
    """Hips that move, a leg, a trunk and an eye; a lamp beside them."""
    nodes = [
        {"name": "hips", "translation": [0, 1, 0], "children": [1, 2]},
        {"name": "leg", "translation": [0.1, -0.1, 0]},
        {"name": "trunk", "translation": [0, 0.3, 0], "children": [3, 4]},
        {"name": "eye", "translation": [0, 0.3, 0.1]},
        {"name": "tip", "translation": [0, 0.4, 0]},
        {"name": "lamp"},
        {"name": "wick"},
    ]
    tracks = [(0, "translation", [0, 1], [[0, 1, 0], [0, 1, 1]], "LINEAR"), (2, "rotation", [0, 1], [NONE, ABOUT_X], "LINEAR")]
    return {"nodes": nodes, "tracks": tracks, **more}


@pytest.mark.parametrize(
    "skins",
    [
        [[3], [0, 1, 2, 3]],
        [[1], [2, 3]],
        [[1, 2, 3]],
        [[5, 6], [3], [0, 1, 2]],
        [[0, 1]],
    ],
    ids=["the eye first", "split below the hips", "hips in no skin", "the lamp first", "the trunk in no skin"],
)
def test_all_skins_of_a_body_are_one_skeleton(tmp_path, skins):
    clip = d.SourceMotion.read(write_glb(tmp_path / "body.glb", **body(skins=[{"joints": joints} for joints in skins])))
    assert sorted(clip.joint_names) == ["eye", "hips", "leg", "tip", "trunk"]
    np.testing.assert_allclose(clip.positions[-1][clip.joint_names.index("leg")], [0.1, 0.9, 1], atol=1e-6)


def pack(gltf):
    """Of the animations the first stands still, the second waves, the third moves everything, the fourth too."""
    samplers = gltf["animations"][0]["samplers"]

    def animation(name, *channels):
        return {"name": name, "samplers": samplers, "channels": [gltf["animations"][0]["channels"][c] for c in channels]}

    gltf["animations"] = [animation("Still", 0), animation("Wave", 1), animation("Walk", 1, 2, 3), animation("Run", 1, 2, 3)]


def several(path):
    turns = [(1, "rotation", [0, 1], [NONE, NONE], "LINEAR")]
    turns += [(node, "rotation", [0, 0.5 * node], [NONE, ABOUT_Z], "LINEAR") for node in (1, 2, 3)]
    return write_glb(path, **arm(tracks=turns, change=pack))


def test_the_animation_that_moves_the_body_is_played_or_the_one_that_is_named(tmp_path):
    path = several(tmp_path / "pack.glb")
    clip = d.SourceMotion.read(path)
    assert clip.animations == ["Still", "Wave", "Walk", "Run"] and clip.animations[clip.animation] == "Walk"
    assert clip.frame_count == 37
    assert d.SourceMotion.read(path, animation="Wave").frame_count == 13
    assert d.SourceMotion.read(path, animation="4").animation == 3
    with pytest.raises(
        d.Error, match=r"expected one of the animations Still, Wave, Walk, Run, or a number from 1 to 4, found '5'"
    ):
        d.SourceMotion.read(path, animation="5")
    (tmp_path / "clip.bvh").write_text(CLEAN)
    with pytest.raises(d.Error, match="expected a .glb or .fbx, which can have several animations"):
        read_clip(tmp_path / "clip.bvh", "Walk")


def test_a_spline_through_a_wide_turn_stays_a_turn(tmp_path):
    flat = [0, 0, 0, 0]
    turned = [0, 0, np.sin(np.radians(85)), np.cos(np.radians(85))]
    values = [flat, NONE, flat, flat, turned, flat]
    path = write_glb(tmp_path / "arm.glb", **arm(tracks=[(2, "rotation", [0, 1], values, "CUBICSPLINE")]))
    middle = np.add(NONE, turned) / np.linalg.norm(np.add(NONE, turned))  # halfway the spline is the mean, brought to length 1
    half = 2 * np.arctan2(middle[2], middle[3])
    expected = [0.3 + 0.25 * np.cos(half), 1.4, -0.25 * np.sin(half)]
    np.testing.assert_allclose(d.SourceMotion.read(path).positions[12][2], expected, atol=1e-6)


@pytest.mark.parametrize(("component", "kind", "most"), [(5120, "<i1", 127), (5122, "<i2", 32767)])
def test_rotations_as_normalised_integers(tmp_path, component, kind, most):
    path = write_glb(tmp_path / "arm.glb", **arm())
    content = path.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    gltf, binary = json.loads(content[20 : 20 + length]), content[28 + length :]
    accessor = gltf["accessors"][1]
    view = gltf["bufferViews"][accessor["bufferView"]]
    values = np.frombuffer(binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]], "<f4")
    packed = np.round(values * most).astype(kind).tobytes()
    accessor.update(componentType=component, normalized=True)
    view.update(byteOffset=len(binary), byteLength=len(packed))
    binary += packed
    gltf["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    sizes = [int(n).to_bytes(4, "little") for n in (2, 28 + len(text) + len(binary), len(text), 0x4E4F534A)]
    path.write_bytes(b"glTF" + b"".join(sizes) + text + len(binary).to_bytes(4, "little") + b"BIN\0" + binary)
    np.testing.assert_allclose(d.SourceMotion.read(path).positions[12][2], [0.3, 1.4, -0.25], atol=0.01)


def test_a_compressed_clip_names_the_extension_that_it_needs(tmp_path):
    """As gltfpack writes it: a view is of a buffer that is not in the file."""
    name = "EXT_meshopt_compression"

    def compress(gltf):
        gltf.update(extensionsUsed=[name], extensionsRequired=[name])
        gltf["buffers"].append({"byteLength": 4096, "extensions": {name: {"fallback": True}}})
        for view in gltf["bufferViews"]:
            packed = {"buffer": 0, "byteLength": view["byteLength"], "byteStride": 16, "mode": "ATTRIBUTES", "count": 3}
            view.update(buffer=1, extensions={name: packed})

    with pytest.raises(d.Error, match=rf"arm\.glb: expected uncompressed numbers, found ones that need .* {name}"):
        d.SourceMotion.read(write_glb(tmp_path / "arm.glb", change=compress, **arm()))


@pytest.mark.parametrize("version", ["VRM", "VRMC_vrm"])
def test_vrm_says_which_bone_is_which(tmp_path, version):
    bones = {"leftUpperArm": 1, "leftLowerArm": 2, "leftHand": 3}

    def change(gltf):
        listed = [{"bone": bone, "node": node} for bone, node in bones.items()]
        by_name = {bone: {"node": node} for bone, node in bones.items()}
        gltf["extensions"] = {version: {"humanoid": {"humanBones": listed if version == "VRM" else by_name}}}
        for node in gltf["nodes"]:
            node["name"] = "x" + node["name"]

    clip = d.SourceMotion.read(write_glb(tmp_path / "arm.glb", **arm(change=change)))
    parts = {match.part: match for match in d.explain_match(clip)}
    assert [parts[f"l_{part}"].joint for part in ("shoulder", "elbow", "wrist")] == [0, 1, 2]
    assert parts["l_elbow"].reason == "as the file says"


def test_nodes_that_share_their_keys_take_their_memory_once(tmp_path):
    """3,000 nodes on one accessor of a megabyte."""
    keys = 30_000
    times, turns = np.arange(keys) / 100, np.tile([NONE], (keys, 1))

    def change(gltf):
        gltf["nodes"] = [{"name": f"n{i}", "children": [i + 1]} for i in range(2999)] + [{"name": "last"}]
        gltf["animations"][0]["channels"] = [{"sampler": 0, "target": {"node": i, "path": "rotation"}} for i in range(3000)]

    path = write_glb(tmp_path / "chain.glb", [], [(0, "rotation", times, turns, "LINEAR")], change=change)
    with pytest.raises(d.Error, match="expected at most 5e.07 keys of all animations, found more"):
        d.SourceMotion.read(path)


def test_a_chain_of_5000_turning_nodes_is_read_in_time(tmp_path):
    nodes = [{"name": f"n{i}", "children": [i + 1]} for i in range(4999)] + [{"name": "last"}]

    def change(gltf):
        gltf["animations"][0]["channels"] = [{"sampler": 0, "target": {"node": i, "path": "rotation"}} for i in range(5000)]

    clip = d.SourceMotion.read(
        write_glb(tmp_path / "c.glb", nodes, [(0, "rotation", [0, 1], [NONE, NONE], "LINEAR")], change=change)
    )
    assert len(clip.joint_names) == 5000
