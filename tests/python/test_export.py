"""Animations for other programs: BVH of the skeleton, USD, vertex animation textures; and the map of bones, as a file."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli
from doublet.export import bone_map, vertex_animation
from doublet.export.clips import read_clip, read_motion
from doublet.export.usd import identifier, identifiers, texture_path, write_usdc
from doublet.export.vertex_animation import write_vertex_animation
from doublet.pages.view import poses_of
from glb_viewer import Viewer
from test_motions import actor_skeleton

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402

FRAMES = 12


@pytest.fixture(scope="module")
def character():
    """Someone with arms and legs to steer, and a tube for a body."""
    world, skeleton = World(), actor_skeleton()
    weights = np.zeros((len(world.mesh.vertices), len(skeleton.joint_names)))
    for name, column in zip(("pelvis", "spine"), world.weights.T):
        weights[:, skeleton.find(name)] = column
    actor = d.RiggedMesh(world.mesh, [1] * len(world.mesh.faces), weights, skeleton)
    solver = d.SolverSettings(1 / 40)
    made = d.make_character(actor, world.segmentation, world.body, [], [world.material], solver, world.high)
    images, masks = [world.picture] * 2, [world.mask] * 2
    d.texture_character(made, world.mesh.vertices, world.cameras, images, masks, d.TextureOptions(size=64))
    return made


@pytest.fixture(scope="module")
def motion(character):
    """Every degree of freedom moves, the root through more than a turn."""
    skeleton = character.actor.skeleton
    phase = np.arange(len(skeleton.dof_names))
    dofs = 0.4 * np.sin(0.5 * np.arange(FRAMES)[:, None] + phase)
    dofs[:, skeleton.dof_names.index("pelvis.ry")] = np.linspace(0, 8, FRAMES)
    return d.Motion(1 / character.solver.dt, dofs)


# --- levels of detail


def test_a_level_of_detail_is_written_everywhere_but_in_bvh(character, motion, tmp_path, capsys):
    pxr = pytest.importorskip("pxr.Usd")
    character.write(tmp_path / "c.glb")
    np.savez(tmp_path / "own.npz", dofs=0.3 * motion.dofs)
    shown = int(np.sum(np.asarray(character.high_valid, bool)))

    def run(name, *flags):
        return cli.main(["animate", *(str(tmp_path / file) for file in ("c.glb", "own.npz")), "-o", str(tmp_path / name), *flags])

    for name in ("few.npz", "few.usdc", "few.glb", "few.mp4", "few_vat.png"):
        assert run(name, "--lod", str(shown // 3), "--quiet") == 0
        assert (tmp_path / name).stat().st_size > 0
    with np.load(tmp_path / "few.npz") as arrays:
        faces, places = arrays["high_faces"], arrays["high_vertices"]
    assert 4 <= len(faces) <= shown // 3 and len(np.unique(faces)) == places.shape[1]
    stage = pxr.Stage.Open(str(tmp_path / "few.usdc"))
    mesh = stage.GetPrimAtPath("/character/surface")
    np.testing.assert_array_equal(np.reshape(mesh.GetAttribute("faceVertexIndices").Get(), (-1, 3)), faces)
    np.testing.assert_allclose(mesh.GetAttribute("points").Get(3), places[3], atol=1e-5)
    capsys.readouterr()
    assert run("few.bvh", "--lod", "8") != 0 and "expected a .glb, .npz, .usdc, .mp4 or _vat.png" in capsys.readouterr().err
    assert run("few.npz", "--lod", "3") != 0 and "--lod: expected at least 4 triangles, found 3" in capsys.readouterr().err


def test_the_command_says_what_a_baked_file_keeps(character, motion, tmp_path, capsys):
    character.write(tmp_path / "c.glb")
    np.savez(tmp_path / "own.npz", dofs=0.3 * motion.dofs)
    out = tmp_path / "own.glb"
    assert cli.main(["animate", str(tmp_path / "c.glb"), str(tmp_path / "own.npz"), "-o", str(out)]) == 0
    said = capsys.readouterr().err
    assert f"{out}: {out.stat().st_size / 1e6:.1f} MB" in said
    assert "takes more than" not in said
    few = ["--glb-max-keys", "2", "--glb-max-error", "0.0001"]
    assert cli.main(["animate", str(tmp_path / "c.glb"), str(tmp_path / "own.npz"), "-o", str(out), *few]) == 0
    assert "surface: 0.1 mm takes more than 2 shapes (--glb-max-keys, " in capsys.readouterr().err
    assert re.search(r"surface: \d+ shapes, off by 0\.\d\d mm \(RMS\), 95 % below \d\.\d\d, at most \d+\.\d\d mm", said)


# --- BVH


def degrees_between(a, b):
    """Of unit quaternions w x y z."""
    return np.degrees(2 * np.arccos(np.clip(np.abs(np.sum(a * b, axis=-1)), 0, 1)))


def test_bvh_comes_back_as_it_went(character, motion, tmp_path):
    skeleton = character.actor.skeleton
    d.write_bvh(tmp_path / "own.bvh", skeleton, motion)
    clip = d.SourceMotion.read(tmp_path / "own.bvh")
    assert clip.fps == pytest.approx(motion.fps, rel=1e-6) and clip.frame_count == FRAMES
    at = [clip.joint_names.index(name) for name in skeleton.joint_names]
    for t in range(FRAMES):
        world = np.asarray(skeleton.forward_kinematics(motion.dofs[t]))
        np.testing.assert_allclose(clip.positions[t][at], skeleton.joint_positions(motion.dofs[t]), atol=1e-4)
        for j, k in enumerate(at):
            w, x, y, z = clip.rotations[t, k]
            turned = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z)]])
            np.testing.assert_allclose(turned, world[j][:2, :2], atol=np.radians(0.01))
    np.testing.assert_allclose(clip.offsets[at[0]], skeleton.joint_positions(0 * motion.dofs[0])[0], atol=1e-6)


def test_bvh_retargets_to_the_motion_that_it_was(character, motion, tmp_path):
    """The joints have our own names: nothing is guessed, nothing is adapted."""
    skeleton = character.actor.skeleton
    small = d.Motion(motion.fps, 0.3 * motion.dofs)
    d.write_bvh(tmp_path / "own.bvh", skeleton, small)
    options = d.RetargetOptions(
        align_start=False, ground_feet=False, plant_feet=False, apply_limits=False, hold_seconds=0, blend_seconds=0
    )
    again = d.retarget(d.SourceMotion.read(tmp_path / "own.bvh"), skeleton, options)
    places = [[skeleton.joint_positions(dofs) for dofs in m.dofs] for m in (small, again)]
    np.testing.assert_allclose(places[0], places[1], atol=0.002)  # m


def test_a_baked_glb_retargets_to_the_motion_that_it_was(character, motion, tmp_path):
    """Its joints hang below a node of the character and turn at the clip's rate."""
    skeleton = character.actor.skeleton
    small = d.Motion(motion.fps, 0.3 * motion.dofs)
    d.write_baked_glb(tmp_path / "own.glb", character, d.animate(character, small))
    clip = d.SourceMotion.read(tmp_path / "own.glb")
    assert clip.fps == motion.fps and clip.frame_count == FRAMES
    options = d.RetargetOptions(
        align_start=False, ground_feet=False, plant_feet=False, apply_limits=False, hold_seconds=0, blend_seconds=0
    )
    again = d.retarget(clip, skeleton, options)
    places = [[skeleton.joint_positions(dofs) for dofs in m.dofs] for m in (small, again)]
    np.testing.assert_allclose(places[0], places[1], atol=0.002)  # m


def test_angles_of_a_bvh_go_on_where_they_were(character, motion, tmp_path):
    """A program that blends between frames must not spin: the root turns by 8 radians in steps of 42 degrees."""
    d.write_bvh(tmp_path / "own.bvh", character.actor.skeleton, motion)
    lines = (tmp_path / "own.bvh").read_text().split("Frame Time:")[1].splitlines()[1:]
    angles = np.array([line.split() for line in lines], float)[:, 3:6]
    assert np.ptp(angles[:, 0]) > 400
    assert np.abs(np.diff(angles, axis=0)).max() < 60


@pytest.mark.parametrize(("fps", "dofs"), [(0, np.zeros((2, 36))), (40, np.zeros((2, 3))), (40, np.zeros((0, 36)))])
def test_no_bvh_of_what_is_no_motion(character, tmp_path, fps, dofs):
    with pytest.raises(ValueError, match="write_bvh: expected finite poses"):
        d.write_bvh(tmp_path / "own.bvh", character.actor.skeleton, d.Motion(fps, dofs))
    assert not (tmp_path / "own.bvh").exists()


def test_a_centred_motion_begins_over_the_origin(character, motion, tmp_path):
    far = np.array(motion.dofs)
    far[:, :3] += [0.7, 0, -0.4]
    np.savez(tmp_path / "far.npz", dofs=far)
    character.write(tmp_path / "c.glb")
    paths = {}
    for name, flags in (("as_it_is", []), ("centred", ["--centre"])):
        out = tmp_path / f"{name}.npz"
        assert (
            cli.main(["animate", *map(str, (tmp_path / "c.glb", tmp_path / "far.npz")), "-o", str(out), "--quiet", *flags]) == 0
        )
        with np.load(out) as arrays:
            paths[name] = arrays["joints"][:, 0]
    np.testing.assert_allclose(paths["centred"][0, [0, 2]], 0, atol=1e-6)
    assert np.linalg.norm(paths["as_it_is"][0, [0, 2]]) > 0.3
    np.testing.assert_allclose(np.ptp(paths["centred"] - paths["as_it_is"], axis=0), 0, atol=1e-5)


@pytest.mark.parametrize(("scheme", "knee", "root"), [("unreal", "calf_l", "pelvis"), ("humanoid", "leftLowerLeg", "hips")])
@pytest.mark.parametrize("suffix", [".bvh", ".glb"])
def test_bones_under_other_names_move_as_they_did(character, motion, tmp_path, suffix, scheme, knee, root):
    """And are known again by those names: the clip plays on the character as it was."""
    np.savez(tmp_path / "own.npz", dofs=0.3 * motion.dofs)
    character.write(tmp_path / "c.glb")
    clips = []
    files = [str(tmp_path / name) for name in ("c.glb", "own.npz")]
    for flags in ([], ["--bone-names", scheme]):
        out = tmp_path / f"{len(flags)}{suffix}"
        assert cli.main(["animate", *files, "-o", str(out), "--quiet", *flags]) == 0
        clips.append(d.SourceMotion.read(out))
    ours, theirs = (clip.joint_names for clip in clips)
    assert {knee, root} <= set(theirs) and "l_knee" in ours and "l_knee" not in theirs
    np.testing.assert_array_equal(clips[0].positions, clips[1].positions)
    np.testing.assert_array_equal(clips[0].rotations, clips[1].rotations)
    # A finger is no hand to who guesses by names; all others are known again.
    played = [{m.part: m.joint for m in d.explain_match(clip) if not m.part.endswith("_hand")} for clip in clips]
    assert played[0] == played[1]


def test_bones_of_a_video_have_no_names(character, tmp_path, capsys):
    character.write(tmp_path / "c.glb")
    (tmp_path / "m.bvh").write_text("")
    files = [str(tmp_path / name) for name in ("c.glb", "m.bvh")]
    assert cli.main(["animate", *files, "-o", str(tmp_path / "o.mp4"), "--bone-names", "unreal"]) == 1
    assert "expected a .bvh or .glb for bones of other names, found .mp4" in capsys.readouterr().err


# --- arrays


def test_arrays_have_the_joints_rotations(character, motion, tmp_path):
    """(T, J, 4) w x y z in the world; the root turns by more than a whole turn, and no quaternion changes its side."""
    d.write_baked_npz(tmp_path / "own.npz", character, d.animate(character, motion))
    with np.load(tmp_path / "own.npz") as arrays:
        w, x, y, z = np.moveaxis(arrays["joint_rotations"].astype(float), -1, 0)
        assert np.sum(arrays["joint_rotations"][1:] * arrays["joint_rotations"][:-1], axis=-1).min() > 0
    columns = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)]
    for t in range(FRAMES):
        world = np.asarray(character.actor.skeleton.forward_kinematics(motion.dofs[t]))
        np.testing.assert_allclose(np.array(columns)[:, t].T, world[:, :3, 0], atol=1e-5)


# --- USD


@pytest.fixture(scope="module")
def usd(character, motion, tmp_path_factory):
    out = tmp_path_factory.mktemp("usd") / "dance.usdc"
    assert write_usdc(out, character, motion) == FRAMES
    return out


def test_usd_has_the_points_of_every_frame(character, motion, usd):
    from pxr import Usd, UsdGeom

    animation = d.animate(character, motion)
    stage = Usd.Stage.Open(str(usd))
    assert stage.GetTimeCodesPerSecond() == pytest.approx(motion.fps)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, FRAMES - 1)
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    shown = {"surface": animation.high if len(character.high.faces) else animation.surface, "body": animation.body}
    for name, frames in shown.items():
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"/character/{name}"))
        assert mesh.GetPointsAttr().GetNumTimeSamples() == FRAMES
        for t in range(FRAMES):
            points = np.asarray(mesh.GetPointsAttr().Get(t))
            np.testing.assert_allclose(points, frames[t], atol=1e-6)
            np.testing.assert_allclose(mesh.GetExtentAttr().Get(t), [points.min(axis=0), points.max(axis=0)], atol=1e-6)


def test_usd_that_is_stopped_leaves_no_texture(character, motion, tmp_path):
    """A picture of another character beside the .usdc of before would be taken for its own."""

    def stop(*_):
        raise KeyboardInterrupt

    assert len(character.texture)
    with pytest.raises(KeyboardInterrupt):
        write_usdc(tmp_path / "new.usdc", character, motion, context=d.Context(progress=stop))
    assert list(tmp_path.iterdir()) == []


def test_usd_of_what_is_left(character, motion, tmp_path, capsys):
    """Without the display surface that of the simulation, in its own faces; without the body none."""
    from pxr import Usd, UsdGeom

    assert write_usdc(tmp_path / "few.usdc", character, motion, d.AnimateOptions(high=False, body=False)) == FRAMES
    stage = Usd.Stage.Open(str(tmp_path / "few.usdc"))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/character/surface"))
    assert len(mesh.GetPointsAttr().Get(0)) == len(character.actor.mesh.vertices)
    faces = np.reshape(mesh.GetFaceVertexIndicesAttr().Get(), (-1, 3))
    np.testing.assert_array_equal(faces, character.actor.mesh.faces[np.asarray(character.actor.face_valid, bool)])
    assert not stage.GetPrimAtPath("/character/body") and [path.name for path in tmp_path.iterdir()] == ["few.usdc"]
    character.write(tmp_path / "c.glb")
    np.savez(tmp_path / "own.npz", dofs=motion.dofs)
    words = ["animate", tmp_path / "c.glb", tmp_path / "own.npz", "-o", tmp_path / "x.glb", "--no-animate-high", "--lod", "8"]
    assert cli.main([*map(str, words)]) == 1
    assert "--lod: expected the display surface to draw less of" in capsys.readouterr().err


def test_usd_has_the_skeleton(character, motion, usd):
    from pxr import Usd, UsdSkel

    stage = Usd.Stage.Open(str(usd))
    skeleton = UsdSkel.Skeleton(stage.GetPrimAtPath("/character/rig/skeleton"))
    query = UsdSkel.Cache().GetSkelQuery(skeleton)
    assert [name.split("/")[-1] for name in query.GetJointOrder()] == character.actor.skeleton.joint_names
    for t in range(FRAMES):
        places = np.asarray(query.ComputeJointSkelTransforms(t))[:, 3, :3]
        np.testing.assert_allclose(places, character.actor.skeleton.joint_positions(motion.dofs[t]), atol=1e-5)


def test_usd_is_what_usdchecker_wants(usd):
    from pxr import Usd, UsdValidation

    registry = UsdValidation.ValidationRegistry()
    validators = registry.GetOrLoadAllValidators()
    assert len(validators) > 10
    errors = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(usd)))
    assert [error.GetMessage() for error in errors] == []


def test_usd_finds_its_texture(character, usd):
    from pxr import Usd, UsdShade

    stage = Usd.Stage.Open(str(usd))
    image = UsdShade.Shader(stage.GetPrimAtPath("/character/materials/surface/image"))
    places = np.asarray(stage.GetPrimAtPath("/character/surface").GetAttribute("primvars:st").Get())
    np.testing.assert_allclose(places, character.texcoords * [1, -1] + [0, 1], atol=1e-6)  # images begin at the bottom
    found = Path(image.GetInput("file").Get().resolvedPath)
    assert found == texture_path(usd, character) and found.read_bytes() == character.texture


def test_without_usd_core_there_is_a_sentence(character, motion, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(RuntimeError, match=r"needs the package usd-core.*pip install usd-core"):
        write_usdc(tmp_path / "new.usdc", character, motion)
    assert list(tmp_path.iterdir()) == []


def test_names_of_usd():
    assert [identifier(name) for name in ("l_hip", "Left Hip", "1st", "ä")] == ["l_hip", "Left_Hip", "_1st", "_"]
    assert identifiers(["spine", "左腕", "右腕", "spine", "脚"]) == ["spine", "__", "___2", "spine_2", "_"]


# --- vertex animation textures

VALIDATE = Path(__file__).parents[1] / "e2e/validate_gltf.mjs"


class Shader:
    """Plays OUT_vat.png as OpenVAT's shaders do: from TEXCOORD_1 a row further for every frame, half the image for normals."""

    def __init__(self, png):
        self.viewer = Viewer(png.with_suffix(".glb"))
        self.info = json.loads(png.with_name(png.name.replace("_vat.png", "-remap_info.json")).read_text())
        decode = ["ffmpeg", "-loglevel", "error", "-i", png, "-f", "rawvideo", "-pix_fmt", "rgb48le", "-"]
        texels = np.frombuffer(subprocess.run(decode, capture_output=True, check=True).stdout, "<u2")
        width, height = np.frombuffer(png.read_bytes()[16:24], ">u4")
        self.texels = texels.reshape(height, width, 3) / 65535
        self.attributes = self.viewer.gltf["meshes"][0]["primitives"][0]["attributes"]

    def sampled(self, frame, half):
        height, width, _ = self.texels.shape
        u, v = (self.viewer.array(self.attributes["TEXCOORD_1"]) + [0, frame / height + half / 2]).T
        x, z, y = self.texels[(v * height).astype(int), (u * width).astype(int)].T
        return np.column_stack([x, y, z])

    def points(self, frame):
        low, high = (np.array(self.info["os-remap"][end]) for end in ("Min", "Max"))
        x, y, z = (self.sampled(frame, 0) * (high - low)[[0, 2, 1]] + low[[0, 2, 1]]).T
        return self.viewer.array(self.attributes["POSITION"]) + np.column_stack([x, y, -z])

    def normals(self, frame):
        return (2 * self.sampled(frame, 1) - 1) * [1, 1, -1]

    def corners(self, primitive):
        return self.viewer.array(self.viewer.gltf["meshes"][0]["primitives"][primitive]["indices"]).ravel().astype(int)


@pytest.mark.parametrize("columns", [vertex_animation.MOST_COLUMNS, 1000])
def test_a_texture_has_the_points_and_normals_of_every_frame(character, motion, tmp_path, monkeypatch, columns):
    monkeypatch.setattr(vertex_animation, "MOST_COLUMNS", columns)
    assert write_vertex_animation(tmp_path / "dance_vat.png", character, motion) == FRAMES
    animation, shader = d.animate(character, motion), Shader(tmp_path / "dance_vat.png")
    assert shader.info["animations"]["dance"] == {"startFrame": 0, "endFrame": FRAMES - 1, "framerate": 40, "looping": False}
    assert shader.info["os-remap"]["Frames"] == FRAMES and shader.texels.shape[1] <= columns
    assert (len(shader.texels) == 2 * FRAMES) == (columns == vertex_animation.MOST_COLUMNS)  # one row of vertices, or several
    drawn, shown = d.drawn_faces(character).faces.ravel(), np.asarray(character.body_shown, bool)
    every = character.high.faces[np.asarray(character.high_valid, bool)]
    for t in range(FRAMES):
        points, normals = shader.points(t), shader.normals(t)
        body = character.body.faces[shown]
        for primitive, moved, faces, of_all in ((0, animation.high[t], drawn, every), (1, animation.body[t], body.ravel(), body)):
            corners = shader.corners(primitive)
            np.testing.assert_allclose(points[corners], moved[faces], atol=1e-4)
            np.testing.assert_allclose(normals[corners], d.vertex_normals(moved, of_all)[faces], atol=1e-4)


def test_a_texture_without_the_body_has_the_surface_alone(character, motion, tmp_path):
    assert np.any(character.body_shown)
    write_vertex_animation(tmp_path / "dance_vat.png", character, motion, d.AnimateOptions(body=False))
    assert len(Shader(tmp_path / "dance_vat.png").viewer.gltf["meshes"][0]["primitives"]) == 1


def test_the_mesh_of_a_texture_is_textured_and_valid(character, motion, tmp_path):
    modules = os.environ.get("DOUBLET_NODE_DIR")
    if not modules:
        pytest.skip("DOUBLET_NODE_DIR does not name a folder with gltf-validator (tests/run_tests.sh sets it)")
    write_vertex_animation(tmp_path / "dance_vat.png", character, motion)
    shader = Shader(tmp_path / "dance_vat.png")
    places = shader.viewer.array(shader.attributes["TEXCOORD_0"])[shader.corners(0)]
    np.testing.assert_allclose(places, d.drawn_faces(character).texcoords, atol=1e-6)
    assert shader.viewer.image() == character.texture
    shown = subprocess.run(["node", VALIDATE, modules, tmp_path / "dance_vat.glb"], capture_output=True, text=True, check=True)
    issues = json.loads(shown.stdout)["issues"]
    assert issues["numErrors"] == issues["numWarnings"] == 0, issues["messages"]


def test_textures_that_cannot_be_are_refused_before_the_work(character, motion, tmp_path, monkeypatch):
    monkeypatch.setattr(d, "animate_each", None)
    with pytest.raises(ValueError, match=r"expected a name that ends in _vat.png .* found dance.png"):
        write_vertex_animation(tmp_path / "dance.png", character, motion)
    with pytest.raises(ValueError, match=r"expected the display surface .* found it left out"):
        write_vertex_animation(tmp_path / "dance_vat.png", character, motion, d.AnimateOptions(high=False))
    long = d.Motion(motion.fps, np.tile(motion.dofs, (1000, 1)))
    with pytest.raises(ValueError, match=r"expected at most 8192 frames of \d+ vertices, found 12000 \(--lod\)"):
        write_vertex_animation(tmp_path / "dance_vat.png", character, long)
    monkeypatch.setenv("DOUBLET_FFMPEG", "no-such-program")
    with pytest.raises(FileNotFoundError, match="ffmpeg is not installed"):
        write_vertex_animation(tmp_path / "dance_vat.png", character, motion)
    assert list(tmp_path.iterdir()) == []


# --- the map of bones


@pytest.fixture
def folder(character, motion, tmp_path):
    character.write(tmp_path / "c.glb")
    d.write_bvh(tmp_path / "walk.bvh", character.actor.skeleton, d.Motion(motion.fps, 0.2 * motion.dofs))
    return tmp_path


def test_a_bone_map_has_every_joint_and_why(folder):
    command = ["animate", str(folder / "c.glb"), str(folder / "walk.bvh"), "--write-bone-map", str(folder / "map.toml")]
    assert cli.main(command) == 0
    text, clip = (folder / "map.toml").read_text(), read_clip(folder / "walk.bvh")
    for match in d.explain_match(clip):
        name = clip.joint_names[match.joint] if match.joint >= 0 else ""
        assert re.search(rf'^{match.part} = "{name}" +# {match.reason}$', text, re.MULTILINE)
    assert "by its name" in text and "where the legs meet" in text


def test_a_bone_map_is_what_was_guessed(folder, character):
    clip = read_clip(folder / "walk.bvh")
    bone_map.write(folder / "map.toml", clip, {})
    options = d.RetargetOptions()
    guessed, read = (
        read_motion(folder / "walk.bvh", character, options, bone_map=file).dofs for file in (None, folder / "map.toml")
    )
    np.testing.assert_array_equal(guessed, read)


def test_a_bone_map_is_written_from_the_one_that_is_there(folder):
    (folder / "own.toml").write_text('[joints]\nneck = ""\nl_hip = "r_hip"\nr_hip = "l_hip"\n')
    command = ["animate", str(folder / "c.glb"), str(folder / "walk.bvh"), "--bone-map", str(folder / "own.toml")]
    assert cli.main([*command, "--write-bone-map", str(folder / "map.toml"), "--retarget-joint-names", "head="]) == 0
    text = (folder / "map.toml").read_text()
    assert re.search(r'^l_hip = "r_hip" +# given$', text, re.MULTILINE)
    assert all(re.search(rf'^{part} = "" +# not found$', text, re.MULTILINE) for part in ("neck", "head"))


def renamed(text):
    """A clip whose names nobody guesses."""
    numbers = {}
    return re.sub(r"(ROOT|JOINT) (\S+)", lambda m: f"{m[1]} {numbers.setdefault(m[2], f'bone{len(numbers)}')}", text), numbers


def test_a_clip_of_strange_names_plays_with_a_map(folder, character):
    text, numbers = renamed((folder / "walk.bvh").read_text())
    (folder / "strange.bvh").write_text(text)
    strange, known = read_clip(folder / "strange.bvh"), read_clip(folder / "walk.bvh")
    assert "by its place and length" in bone_map.written(strange, {})
    no_knees = {"l_knee": "", "r_knee": ""}
    assert 'l_knee = "" ' in bone_map.written(strange, no_knees) and "needed, and not found" in bone_map.written(
        strange, no_knees
    )
    with pytest.raises(RuntimeError, match="found no joint for"):
        read_motion(folder / "strange.bvh", character, d.RetargetOptions(joint_names=no_knees))
    lines = bone_map.written(known, {})
    for name, number in numbers.items():
        lines = lines.replace(f'= "{name}"', f'= "{number}"').replace(f'= "{name}_end"', f'= "{number}_end"')
    (folder / "map.toml").write_text(lines)
    played = read_motion(folder / "strange.bvh", character, d.RetargetOptions(), bone_map=folder / "map.toml")
    np.testing.assert_array_equal(played.dofs, read_motion(folder / "walk.bvh", character, d.RetargetOptions()).dofs)


@pytest.mark.parametrize("command", ["export-cloth", "view", "synthesize"])
def test_every_command_with_a_motion_takes_a_bone_map(folder, command, capsys):
    """And says when there is nothing to read with it."""
    (folder / "wrong.toml").write_text('[joints]\nl_hip = "no such joint"')
    motion = {"export-cloth": "--motion", "view": "--clip", "synthesize": "--motion"}[command]
    line = [command, str(folder / "c.glb"), "-o", str(folder / "out"), "--bone-map", str(folder / "wrong.toml")]
    assert cli.main([*line, motion, str(folder / "walk.bvh")]) == 1
    assert "wrong.toml: l_hip: expected a joint of" in capsys.readouterr().err
    if command != "synthesize":  # which has no other motion
        assert cli.main(line) == 1
        assert "--bone-map, --animation: expected a motion" in capsys.readouterr().err


def test_poses_of_a_page_are_retargeted_at_the_rate_that_is_asked_for(folder, character):
    own, asked = 1 / character.solver.dt, d.RetargetOptions(fps=8)
    coarse = read_motion(folder / "walk.bvh", character, asked)
    poses = np.frombuffer(poses_of(folder / "walk.bvh", character, asked, d.Context()), "<f8")
    expected = d.resolve_arm_penetration(character, d.resample(character.actor.skeleton, coarse, own)).dofs
    np.testing.assert_array_equal(poses.reshape(-1, expected.shape[1]), expected)
    assert len(expected) > 2 * len(coarse) and asked.fps == 8


def test_a_joint_that_is_left_out_is_not_guessed(folder):
    clip = read_clip(folder / "walk.bvh")
    left_out = {match.part: match for match in d.explain_match(clip, {"l_clavicle": "", "neck": ""})}
    assert left_out["l_clavicle"].joint == left_out["neck"].joint == -1


@pytest.mark.parametrize("name", ["c.glb", "walk.bvh"])
def test_an_animation_does_not_take_the_place_of_what_it_is_made_from(folder, capsys, name):
    before = (folder / name).read_bytes()
    out = folder / ".." / folder.name / name
    assert cli.main(["animate", str(folder / "c.glb"), str(folder / "walk.bvh"), "-o", str(out), "--quiet"]) == 1
    assert f"{name}: expected another file than the one that is read" in capsys.readouterr().err
    assert (folder / name).read_bytes() == before


def test_the_command_writes_bvh(folder, character):
    done = subprocess.run(
        [sys.executable, "-m", "doublet", "animate", folder / "c.glb", folder / "walk.bvh", "-o", folder / "new.bvh"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert d.SourceMotion.read(folder / "new.bvh").fps == pytest.approx(1 / character.solver.dt, rel=1e-6)
