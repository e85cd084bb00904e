"""What another program sees of a baked animation."""

import io
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet.export.level_of_detail import level_of_detail
from glb_viewer import Viewer
from PIL import Image

FPS, FRAMES = 40.0, 33
ROOT = Path(__file__).parents[2]
PLAY = ROOT / "tests" / "support" / "play_glb.mjs"
SCRIPT = ROOT / "examples" / "blender_character.py"
NEAR = 1e-4  # m


def painted(character, shapes):
    """A texture of soft stripes, as four cameras see them."""
    cameras = [shapes["camera"](azimuth, name=f"cam{i}", height=1.0, size=320) for i, azimuth in enumerate((0, 1.6, 3.1, 4.7))]
    y, x = np.mgrid[:320, :320]
    image = np.stack([128 + 100 * np.sin(x / 20), 128 + 100 * np.cos(y / 15), 90 + 0 * x], axis=-1).astype(np.uint8)
    options = d.TextureOptions(size=512)
    seen = d.texture_character(character, character.actor.mesh.vertices, cameras, [image] * 4, [], options)
    assert seen > 0.8


@pytest.fixture(scope="module")
def turning(shapes):
    """A bell-shaped person in a painted skirt who bends and turns by 200 degrees a second; the body stands out of the cloth."""
    bell = shapes["tube"]
    vertices, faces = bell(lambda h: 0.35 - 0.15 * h, 0.5, 1.5, around=24, rows=21)
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.9, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.1, 0], 3)])
    upper = np.clip((vertices[:, 1] - 0.9) / 0.4, 0, 1)
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.stack([1 - upper, upper], axis=1), skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    clothness = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    fit = d.BodyFit()
    fit.body = d.Mesh(*bell(lambda h: 0.36 - 0.15 * h, 0.5, 1.5, around=20, rows=15))
    high = d.Mesh(*bell(lambda h: 0.35 - 0.15 * h, 0.5, 1.5, around=48, rows=41))
    shown = (high.vertices[high.faces].mean(axis=1)[:, 1] < 1.45).astype(np.uint8)
    materials, solver = [d.Material(k_stretch=1.0)], d.SolverSettings(1 / FPS)
    character = d.make_character(actor, clothness, fit, [], materials, solver, high, shown)
    painted(character, shapes)
    dofs = np.zeros((FRAMES, 9))
    dofs[:, 4] = np.radians(200) * np.arange(FRAMES) / FPS
    dofs[:, 6] = 0.8 * np.sin(np.arange(FRAMES) / FPS * 6)
    return character, d.animate(character, d.Motion(FPS, dofs))


@pytest.fixture(scope="module")
def folder(turning, tmp_path_factory):
    """With a shape a frame, and every fourth; with principal shapes; and as arrays."""
    folder = tmp_path_factory.mktemp("baked")
    for most in (400, FRAMES):
        every = d.write_baked_glb(folder / "every.glb", *turning, d.BakedGlbOptions(max_error=0, max_keys=most))
        assert every.keys == FRAMES
    fourth = d.BakedGlbOptions(max_error=0, keys_per_second=FPS / 4)
    assert d.write_baked_glb(folder / "fourth.glb", *turning, fourth).keys == FRAMES // 4 + 1
    assert d.write_baked_glb(folder / "principal.glb", *turning).keys == FRAMES
    d.write_baked_npz(folder / "arrays.npz", *turning)
    return folder


@pytest.fixture(scope="module")
def viewers(folder):
    return Viewer(folder / "every.glb"), Viewer(folder / "fourth.glb")


@pytest.fixture(scope="module")
def principal(folder):
    return Viewer(folder / "principal.glb")


def drawn_faces(character, name):
    if name == "body":
        return character.body.faces[np.asarray(character.body_shown, bool)]
    return character.high.faces[np.asarray(character.high_valid, bool)]


def original(character, name, triangles):
    """(V) which of the character's vertices each of a file's is: files have the faces in the character's order."""
    shown = np.empty(triangles.max() + 1, int)
    shown[triangles.ravel()] = drawn_faces(character, name).ravel()
    return shown


def triangles_of(viewer, name):
    mesh = viewer.gltf["meshes"][viewer.gltf["nodes"][viewer.node[name]]["mesh"]]
    return viewer.array(mesh["primitives"][0]["indices"]).astype(int).reshape(-1, 3)


def off(shown, true):
    return np.linalg.norm(shown - true, axis=-1).max()


@pytest.mark.parametrize("name", ["surface", "body"])
def test_every_frame_is_exact(turning, viewers, name):
    character, animation = turning
    which = original(character, name, triangles_of(viewers[0], name))
    frames = animation.high if name == "surface" else animation.body
    for frame in range(FRAMES):
        assert off(viewers[0].mesh(name, frame / FPS), frames[frame][which]) < NEAR


def vertex_normals(vertices, faces):
    """(V, 3), weighted by angle."""
    normals = np.zeros_like(vertices)
    for k in range(3):
        at, after, before = (vertices[faces[:, (k + step) % 3]] for step in range(3))
        across = np.cross(after - at, before - at)
        sine = np.linalg.norm(across, axis=1, keepdims=True)
        angle = np.arctan2(sine, np.sum((after - at) * (before - at), axis=1, keepdims=True))
        np.add.at(normals, faces[:, k], angle * across / np.maximum(sine, 1e-30))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)


@pytest.mark.parametrize("file", ["every", "principal"])
def test_normals_follow_the_cloth(turning, folder, file):
    """Those of bytes, where cloth has turned far from its bones; across the seams of the texture, too."""
    character, high, viewer = turning[0], turning[1].high, Viewer(folder / f"{file}.glb")
    which = original(character, "surface", triangles_of(viewer, "surface"))
    for frame in (0, 12, FRAMES - 1):
        true = vertex_normals(high[frame], drawn_faces(character, "surface"))[which]
        cosines = np.sum(viewer.normals("surface", frame / FPS) * true, axis=1)
        assert np.quantile(cosines, 0.01) > np.cos(np.radians(10)) and cosines.mean() > np.cos(np.radians(3))


def mesh_of(viewer, name):
    return viewer.gltf["meshes"][viewer.gltf["nodes"][viewer.node[name]]["mesh"]]


@pytest.mark.parametrize("name", ["surface", "body"])
def test_principal_shapes_are_off_by_what_the_file_says(turning, principal, name):
    character, animation = turning
    which = original(character, name, triangles_of(principal, name))
    frames = animation.high if name == "surface" else animation.body
    errors = [principal.mesh(name, frame / FPS) - frames[frame][which] for frame in range(FRAMES)]
    errors = np.linalg.norm(errors, axis=-1)
    said = mesh_of(principal, name)["extras"]
    assert said["rms_error"] == pytest.approx(np.sqrt(np.mean(errors**2)), rel=0.01) and said["rms_error"] < 1e-3
    assert said["error_95"] == pytest.approx(np.quantile(errors, 0.95), rel=0.02)
    assert said["max_error"] == pytest.approx(errors.max(), rel=0.02)
    assert said["shapes"] == len(mesh_of(principal, name)["primitives"][0]["targets"]) < FRAMES


def test_principal_shapes_are_small_and_their_weights_positive(folder, principal):
    """Blender and Unity cut weights off at 0 and 1; small steps are bytes."""
    assert (folder / "principal.glb").stat().st_size < 0.7 * (folder / "every.glb").stat().st_size
    targets = mesh_of(principal, "surface")["primitives"][0]["targets"]
    kinds = {principal.gltf["accessors"][target["POSITION"]]["componentType"] for target in targets}
    assert kinds == {5120, 5122}
    weights = principal.array(principal.channels[principal.node["surface"], "weights"]["output"])
    assert len(weights) == FRAMES * len(targets) and 0 <= weights.min() < 1e-6 and weights.max() == pytest.approx(1)
    own = principal.array(mesh_of(principal, "surface")["primitives"][0]["attributes"]["NORMAL"])
    assert np.allclose(np.linalg.norm(own, axis=1), 1, atol=1e-5)


def test_no_shape_is_added_beyond_those_that_were_asked_for(turning, tmp_path):
    """Then the error is larger, and the file says so."""
    summary = d.write_baked_glb(tmp_path / "few.glb", *turning, d.BakedGlbOptions(max_keys=3))
    assert summary.keys == FRAMES and max(mesh.shapes for mesh in summary.meshes) == 3
    assert summary.meshes[0].rms_error > 1e-3
    assert mesh_of(Viewer(tmp_path / "few.glb"), "surface")["extras"]["rms_error"] == summary.meshes[0].rms_error


def require_frames(turning, folder, file, name, played, triangles):
    """Frames that a program shows: those of the arrays; of principal shapes those that NumPy makes of the file."""
    if file == "principal":
        viewer = Viewer(folder / "principal.glb")
        true = np.array([viewer.mesh(name, frame / FPS) for frame in range(FRAMES)])
    else:
        with np.load(folder / "arrays.npz") as arrays:
            true = arrays["high_vertices" if name == "surface" else "body_vertices"][:, original(turning[0], name, triangles)]
    assert off(played, true) < NEAR


@pytest.mark.parametrize("file", ["every", "principal"])
def test_three_js_plays_what_the_arrays_have(turning, folder, tmp_path, file):
    modules = os.environ.get("DOUBLET_NODE_DIR")
    if not modules:
        pytest.skip("DOUBLET_NODE_DIR does not name a folder with three (tests/run_tests.sh sets it)")
    times = [str(frame / FPS) for frame in range(FRAMES)]
    subprocess.run(["node", PLAY, modules, folder / f"{file}.glb", tmp_path, *times], check=True)
    for name in ("surface", "body"):
        played = np.fromfile(tmp_path / f"{name}.f32", np.float32).reshape(FRAMES, -1, 3)
        triangles = np.fromfile(tmp_path / f"{name}.u32", np.uint32).reshape(-1, 3)
        require_frames(turning, folder, file, name, played, triangles)


def test_between_keys_skin_follows_the_bones(turning, viewers):
    character, high = turning[0], turning[1].high
    which = original(character, "surface", triangles_of(viewers[1], "surface"))
    skin = character.high.vertices[which][:, 1] > 1.06
    assert skin.sum() > 500
    halfway = [off(viewers[1].mesh("surface", t / FPS)[skin], high[t][which][skin]) for t in range(2, FRAMES, 4)]
    straight = [off(((high[t - 2] + high[t + 2]) / 2)[which][skin], high[t][which][skin]) for t in range(2, FRAMES, 4)]
    assert max(straight) > 0.01  # m, what shapes in the world would be off
    assert max(halfway) < 0.002


def sampled(image, places):
    """Colours at texture coordinates (N, 2), of the nearest pixel."""
    pixels = np.clip((places * [image.shape[1], image.shape[0]]).astype(int), 0, np.array(image.shape[1::-1]) - 1)
    return image[pixels[:, 1], pixels[:, 0]].astype(float)


def test_the_texture_shows_what_the_characters_own_does(turning, viewers):
    """In the middle of every triangle, and a tenth of the way from each corner to it."""
    character, viewer = turning[0], viewers[0]
    own, baked = (np.asarray(Image.open(io.BytesIO(file))) for file in (character.texture, viewer.image()))
    primitive = viewer.gltf["meshes"][viewer.gltf["nodes"][viewer.node["surface"]]["mesh"]]["primitives"][0]
    places = viewer.array(primitive["attributes"]["TEXCOORD_0"])[triangles_of(viewer, "surface")]
    theirs = character.texcoords.reshape(-1, 3, 2)[np.asarray(character.high_valid, bool)]
    assert theirs.max() <= 1 and places.min() > 0 and places.max() < 1
    for weights in (np.full(3, 1 / 3), *(0.1 / 3 + 0.9 * np.eye(3))):
        apart = np.abs(sampled(baked, weights @ places) - sampled(own, weights @ theirs))
        assert apart.mean() < 4 and np.quantile(apart, 0.99) < 40  # of 255; JPEG and another grid of pixels


def test_few_vertices_are_there_twice(turning, viewers):
    used = len(np.unique(drawn_faces(turning[0], "surface")))
    assert used < len(viewers[0].mesh("surface", 0)) < 1.25 * used


def test_what_the_bones_carry_is_not_stored(turning, viewers):
    primitive = viewers[0].gltf["meshes"][viewers[0].gltf["nodes"][viewers[0].node["surface"]]["mesh"]]["primitives"][0]
    stored = [viewers[0].gltf["accessors"][target["POSITION"]]["sparse"]["count"] for target in primitive["targets"]]
    assert max(stored) < 0.9 * len(viewers[0].mesh("surface", 0))  # above 1.3 m one bone carries all


def test_without_the_display_surface_it_is_the_simulated_one(turning, tmp_path):
    character = turning[0]
    animation = d.animate(character, d.Motion(FPS, turning[1].dofs[:5]), d.AnimateOptions(high=False))
    d.write_baked_glb(tmp_path / "coarse.glb", character, animation, d.BakedGlbOptions(max_error=0))
    viewer = Viewer(tmp_path / "coarse.glb")
    for frame in range(5):
        assert off(viewer.mesh("surface", frame / FPS), animation.surface[frame]) < NEAR
    primitive = viewer.gltf["meshes"][viewer.gltf["nodes"][viewer.node["surface"]]["mesh"]]["primitives"][0]
    assert "COLOR_0" in primitive["attributes"]


# --- a level of detail


@pytest.fixture(scope="module")
def reduced(turning):
    return level_of_detail(turning[0], 1200)


def test_a_level_of_detail_lies_on_the_surface(turning, reduced):
    character = turning[0]
    every = drawn_faces(character, "surface")
    assert 1000 < len(reduced.faces) <= 1200 < len(every) / 2
    vertices = character.high.vertices
    used = np.unique(every)
    on_it = d.RayScene(d.Mesh(vertices, reduced.faces)).closest(vertices[used])[2]
    apart = np.linalg.norm(on_it - vertices[used], axis=1)
    assert np.quantile(apart, 0.95) < 0.003 and apart.max() < 0.02  # m
    assert rim_length(vertices, reduced.faces) == pytest.approx(rim_length(vertices, every), rel=0.02)


def rim_length(vertices, faces):
    """m, of the edges with one face."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    ends = vertices[edges[count == 1]]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()


def test_a_level_of_detail_shows_the_same_texture(turning, reduced):
    """In the middle of its triangles what the surface has there."""
    character = turning[0]
    image = np.asarray(Image.open(io.BytesIO(character.texture)))
    shown = np.asarray(character.high_valid, bool)
    own = character.texcoords.reshape(-1, 3, 2)[shown]
    middles = character.high.vertices[reduced.faces].mean(axis=1)
    faces = character.high.faces[shown]
    face, _, point = d.RayScene(d.Mesh(character.high.vertices, faces)).closest(middles)
    corners = character.high.vertices[faces[face]]
    sides = corners[:, 1:] - corners[:, :1]
    shares = np.einsum("fks,fs->fk", np.linalg.pinv(sides.transpose(0, 2, 1)), point - corners[:, 0])
    there = sampled(image, own[face, 0] + np.einsum("fk,fkc->fc", shares, own[face, 1:] - own[face, :1]))
    apart = np.abs(sampled(image, reduced.texcoords.reshape(-1, 3, 2).mean(axis=1)) - there)
    assert apart.mean() < 6 and np.quantile(apart, 0.95) < 30  # of 255


def test_a_level_of_detail_moves_as_the_surface_does(turning, reduced, tmp_path):
    character, animation = turning
    exact = d.BakedGlbOptions(max_error=0)
    d.write_baked_glb(tmp_path / "few.glb", character, animation, exact, reduced)
    viewer = Viewer(tmp_path / "few.glb")
    triangles = triangles_of(viewer, "surface")
    which = np.empty(triangles.max() + 1, int)
    which[triangles.ravel()] = reduced.faces.ravel()
    for frame in (0, 12, FRAMES - 1):
        assert off(viewer.mesh("surface", frame / FPS), animation.high[frame][which]) < NEAR
    d.write_baked_npz(tmp_path / "few.npz", character, animation, reduced)
    with np.load(tmp_path / "few.npz") as arrays:
        drawn = arrays["high_vertices"][:, arrays["high_faces"]]
        assert len(np.unique(reduced.faces)) == arrays["high_vertices"].shape[1]
        assert off(drawn, animation.high[:, reduced.faces]) < NEAR


def test_faces_of_another_surface_are_refused(turning, tmp_path):
    wrong = d.TexturedFaces([[0, 1, 10**6]], np.zeros((3, 2)))
    with pytest.raises(ValueError, match="drawn: expected faces of the character's display surface"):
        d.write_baked_npz(tmp_path / "no.npz", *turning, wrong)
    assert not (tmp_path / "no.npz").exists()


# --- Blender, which is large: CI does without

in_blender = pytest.mark.skipif(
    not shutil.which("blender"),
    reason="NO BLENDER: nothing here tries examples/blender_character.py (apt-get install blender python3-numpy)",
)


def blender(*arguments):
    command = ["blender", "--background", "--python-exit-code", "1", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


@in_blender
@pytest.mark.parametrize("file", ["every", "principal"])
def test_blender_plays_what_the_arrays_have(turning, folder, tmp_path, file):
    done = blender("--python", SCRIPT, "--", "import", folder / f"{file}.glb", tmp_path / "scene.blend")
    assert done.returncode == 0, done.stdout + done.stderr
    frames = ROOT / "tests" / "support" / "blender_frames.py"
    done = blender(tmp_path / "scene.blend", "--python", frames, "--", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert np.load(tmp_path / "scene.npz")["fps"] == pytest.approx(FPS)
    for name in ("surface", "body"):
        with np.load(tmp_path / f"{name}.npz") as played:
            assert len(played["vertices"]) == FRAMES
            require_frames(turning, folder, file, name, played["vertices"], played["triangles"])


@in_blender
def test_a_character_goes_through_blender(turning, tmp_path):
    turning[0].write(tmp_path / "before.glb")
    assert blender("--python", SCRIPT, "--", "import", tmp_path / "before.glb", tmp_path / "scene.blend").returncode == 0
    done = blender(tmp_path / "scene.blend", "--python", SCRIPT, "--", "export", tmp_path / "again.glb")
    assert done.returncode == 0, done.stdout + done.stderr
    content = (tmp_path / "again.glb").read_bytes()
    gltf = json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])
    assert "Blender" in gltf["asset"]["generator"]
    d.Character.read(tmp_path / "again.glb").write(tmp_path / "after.glb")
    assert (tmp_path / "after.glb").read_bytes() == (tmp_path / "before.glb").read_bytes()


@in_blender
def test_a_scene_without_a_character_is_refused(tmp_path):
    done = blender("--python", SCRIPT, "--", "export", tmp_path / "no.glb")
    assert done.returncode != 0 and "holds no character" in done.stdout + done.stderr


def test_curves_are_found_in_actions_of_either_kind(monkeypatch):
    """Of Blender up to 4.x, and of 5, whose actions have layers: both with no Blender."""
    monkeypatch.setitem(sys.modules, "bpy", SimpleNamespace())
    script = runpy.run_path(str(SCRIPT))
    curves = ["a", "b", "c"]
    bags = [SimpleNamespace(fcurves=curves[:1]), SimpleNamespace(fcurves=curves[1:])]
    layered = SimpleNamespace(layers=[SimpleNamespace(strips=[SimpleNamespace(channelbags=bags)])])
    assert script["curves_of"](SimpleNamespace(fcurves=curves)) == script["curves_of"](layered) == curves


def test_the_script_copies_every_array_of_a_character(monkeypatch):
    """Members of the extension that are indices: those that libanimate writes."""
    monkeypatch.setitem(sys.modules, "bpy", SimpleNamespace())
    known = {(group, name) for group, names in runpy.run_path(str(SCRIPT))["ARRAYS"].items() for name in names}
    written = (ROOT / "libanimate" / "src" / "display" / "character_file.cpp").read_text(encoding="utf-8")
    found = set(re.findall(r'out\["(\w+)"\]\["(\w+)"\] = writer\.', written))
    assert len(found) > 3 and found <= known | {("high", "texture")}
