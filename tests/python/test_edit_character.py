"""`doublet edit-character`: another material, texture, colour under the garment."""

import io
import json
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli
from doublet.export import character_edit
from doublet.export.character_edit import set_body_colour, set_texture, set_underwear, write_texture
from doublet.reconstruct.options import plain
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402


@pytest.fixture(scope="module")
def world():
    return World()


@pytest.fixture
def file(world, tmp_path):
    world.character.write(tmp_path / "character.glb")
    return tmp_path / "character.glb"


def picture(character):
    return np.asarray(Image.open(io.BytesIO(bytes(character.texture))).convert("RGB")).astype(int)


def run(*arguments):
    return cli.main(["edit-character", *map(str, arguments)])


def test_a_material_of_every_region(file, tmp_path):
    out = tmp_path / "other.glb"
    assert run(file, "--material", "k_bend=0.4", "d_n=3", "-o", out) == 0
    before, after = d.Character.read(file).materials, d.Character.read(out).materials
    assert [(m.k_bend, m.d_n) for m in after] == [(0.4, 3)] * len(before)
    assert [m.k_stretch for m in after] == [m.k_stretch for m in before]


def test_a_material_from_a_file(file, tmp_path, capsys):
    """As the page of `doublet view` saves it."""
    one = '{"parameters": {"d_n": 2.5, "d_t": 1, "k_bend": 0.25, "k_stretch": 0.99, "k_friction": 0.1, "k_damping": 0}}'
    (tmp_path / "m.json").write_text(f'{{"regions": [{one}]}}')
    assert run(file, "--material-file", tmp_path / "m.json", "--material", "d_t=3", "-o", tmp_path / "other.glb") == 0
    (found,) = d.Character.read(tmp_path / "other.glb").materials
    assert (found.d_n, found.d_t, found.k_bend) == (2.5, 3, 0.25)
    (tmp_path / "m.json").write_text(f'{{"regions": [{one}, {one}]}}')
    assert run(file, "--material-file", tmp_path / "m.json", "-o", tmp_path / "no.glb") == 1
    assert "m.json: expected materials of the character's 1 cloth regions, found 2" in capsys.readouterr().err


def test_a_material_of_another_solver_is_refused(file, tmp_path, capsys):
    """The same numbers are another cloth there."""
    character = d.Character.read(file)
    solver, region = character.solver.to_dict(), {"parameters": character.materials[0].to_dict()}
    solver["cloth"] = {name: plain(value) for name, value in solver["cloth"].to_dict().items()}
    for dt, status in ((solver["dt"], 0), (2 * solver["dt"], 1)):
        fitted = {"version": 2, "solver": {**solver, "dt": dt}, "regions": [region]}
        (tmp_path / "m.json").write_text(json.dumps(fitted))
        assert run(file, "--material-file", tmp_path / "m.json", "-o", tmp_path / "other.glb") == status
    assert f"m.json: solver setting dt: expected {solver['dt']:g}, found {2 * solver['dt']:g}" in capsys.readouterr().err


def test_a_material_needs_cloth(world, tmp_path, capsys):
    actor, nothing = world.actor, np.zeros(len(world.actor.mesh.vertices))
    bare = d.Segmentation(nothing, nothing, np.full(len(nothing), -1, np.int32))
    d.make_character(actor, bare, d.BodyFit(), [], [], d.SolverSettings(1 / 40)).write(tmp_path / "bare.glb")
    assert run(tmp_path / "bare.glb", "--material", "k_bend=0.4", "-o", tmp_path / "out.glb") == 1
    assert "--material: expected a character with cloth, found none in " in capsys.readouterr().err
    words = ["synthesize", tmp_path / "bare.glb", "--motion", "m.npz", "-o", tmp_path / "s", "--material", "k_bend=0.4"]
    assert cli.main([*map(str, words)]) == 1
    assert "--material: expected a character with cloth, found none in " in capsys.readouterr().err


def test_a_texture_is_the_file_as_it_is_and_the_body_follows(file, tmp_path):
    character = d.Character.read(file)
    character.body_colour = [0.2, 0.2, 0.2]
    skin = np.full((64, 64, 3), round(255 * 0.2 ** (1 / 2.2)), np.uint8)
    skin[:, 32:] = 255
    Image.fromarray(skin).save(tmp_path / "before.png")
    character.texture = (tmp_path / "before.png").read_bytes()
    skin[:, :32], skin[:, 32:] = [200, 100, 50], [0, 0, 9]
    Image.fromarray(skin).resize((128, 128)).save(tmp_path / "after.png")
    set_texture(character, tmp_path / "after.png")
    assert character.texture == (tmp_path / "after.png").read_bytes()
    np.testing.assert_allclose(character.body_colour, (np.array([200, 100, 50]) / 255) ** 2.2, rtol=0.01)


@pytest.mark.parametrize("suffix", ["jpg", "png"])
def test_a_texture_that_was_turned_by_its_camera_is_taken_as_it_looks(file, tmp_path, suffix):
    """Stored lying on its side, with EXIF data that turn it upright: renderers take what is stored."""
    character = d.Character.read(file)
    upright = np.full(picture(character).shape, 20, np.uint8)
    upright[: len(upright) // 2] = [200, 100, 50]
    turned = Image.Exif()
    turned[0x0112] = 6  # a quarter turn clockwise
    Image.fromarray(np.rot90(upright)).save(tmp_path / f"turned.{suffix}", exif=turned, quality=95)
    set_texture(character, tmp_path / f"turned.{suffix}")
    assert np.abs(picture(character) - upright).mean() < 2
    assert Image.open(io.BytesIO(bytes(character.texture))).getexif().get(0x0112, 1) == 1


def test_a_texture_in_printers_inks_becomes_one_of_light(file, tmp_path):
    """glTF has no CMYK: viewers that do not decode it, and the validator, refuse the whole file."""
    character = d.Character.read(file)
    painted = Image.fromarray(np.full(picture(character).shape, [200, 100, 50], np.uint8))
    painted.convert("CMYK").save(tmp_path / "print.jpg", quality=95)
    set_texture(character, tmp_path / "print.jpg")
    assert Image.open(io.BytesIO(bytes(character.texture))).mode == "RGB"
    assert np.abs(picture(character) - np.array(painted, float)).mean() < 3


def test_what_is_written_is_the_texture(file, tmp_path, capsys):
    assert run(file, "--write-texture", tmp_path / "atlas.xyz") == 0
    path = Path(capsys.readouterr().out.strip())
    assert path.read_bytes() == bytes(d.Character.read(file).texture) and path.suffix in (".png", ".jpg")
    assert write_texture(d.Character.read(file), path) == path


def test_colours_of_a_body_drawn_apart(file, tmp_path):
    out = tmp_path / "other.glb"
    assert run(file, "--body-colour", "#ff8000", "-o", out) == 0
    np.testing.assert_allclose(d.Character.read(out).body_colour, [1, (128 / 255) ** 2.2, 0], atol=1e-6)
    assert run(file, "--underwear", "navy", "-o", out) == 0
    np.testing.assert_allclose(d.Character.read(out).body_colour, [0, 0, (128 / 255) ** 2.2], atol=1e-6)


class Worn:
    """A character with a hidden body in its texture, as edits see one: eight triangles in an atlas of 64 px, of which those of
    `hidden` are the body's."""

    name, body_colour = "worn", np.zeros(3)

    def __init__(self, world, monkeypatch, hidden):
        self.actor = world.actor
        vertices = [[0, 1.4 - 0.2 * (k // 2), 0] for k in range(8)]
        self.high = d.Mesh([[x + e, y, z] for x, y, z in vertices for e in (0, 1, 2)], np.arange(24).reshape(8, 3))
        corner = np.array([[2, 2], [12, 2], [2, 12]])
        self.texcoords = np.concatenate([(corner + [16 * (k % 4), 32 * (k // 4)]) / 64 for k in range(8)])
        kept = io.BytesIO()
        Image.fromarray(np.full((64, 64, 3), 90, np.uint8)).save(kept, "PNG")
        self.texture = kept.getvalue()
        monkeypatch.setattr(character_edit.d, "hidden_faces", lambda character: np.array(hidden, bool))

    def at(self, face):
        """The colour in the middle of a triangle."""
        x, y = (64 * self.texcoords[3 * face : 3 * face + 3].mean(axis=0)).astype(int)
        return picture(self)[y, x].tolist()


def test_the_hidden_body_of_a_texture_is_painted(world, monkeypatch):
    character = Worn(world, monkeypatch, [1, 0, 1, 0, 1, 0, 1, 0])
    set_body_colour(character, (10, 20, 30))
    assert [character.at(k) for k in range(8)] == [[10, 20, 30], [90, 90, 90]] * 4
    corners = np.floor(64 * character.texcoords).astype(int)  # texels that are mixed in at the border
    assert all(picture(character)[y, x].tolist() == [10, 20, 30] for x, y in corners[:3])


def test_underwear_reaches_to_the_thighs(world, monkeypatch):
    """Hip at 1.2 m, knee at 0.8 m: down to 1 m, the middle of each pair of triangles being at 1.4, 1.2, 1.0, 0.8."""
    character = Worn(world, monkeypatch, [1] * 8)
    marks = [d.JointAnnotation("l_hip", "", [0, 1.2, 0], 6), d.JointAnnotation("l_knee", "l_hip", [0, 0.79, 0], 3)]
    character.actor = d.RiggedMesh(world.mesh, [1] * len(world.mesh.faces), world.weights, d.Skeleton(marks))
    set_underwear(character, (0, 0, 200))
    assert [character.at(k)[2] for k in range(8)] == [200] * 4 + [200, 200, 90, 90]


def test_underwear_ends_along_a_line(world, monkeypatch):
    """A triangle whose first corner is above the line and whose others are as far below: a quarter of it is painted."""
    character = Worn(world, monkeypatch, [1] + [0] * 7)
    vertices = np.array(character.high.vertices)
    vertices[:3, 1] = [1.2, 0.8, 0.8]
    character.high = d.Mesh(vertices, character.high.faces)
    character_edit.paint(character, np.array([True] + [False] * 7), (0, 0, 200), above=1.0)
    cell = picture(character)[:16, :16, 2] == 200
    assert cell[3, 3] and not cell[3, 10] and not cell[10, 3]
    character_edit.paint(character, np.array([True] + [False] * 7), (0, 0, 200))
    whole = picture(character)[:16, :16, 2] == 200
    assert cell.sum() < 0.55 * whole.sum()  # with the border round either


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--material", "k_bend=2"], "k_bend"),
        (["--material", "k_bent=0.2"], "--material: expected one of d_n"),
        (["--material", "k_bend=0.2", "--region", "4"], "--region: expected one of the character's 1 cloth regions"),
        (["--region", "0", "--body-colour", "red"], "--region: expected --material beside it"),
        (["--body-colour", "skinn"], "--body-colour: expected a colour such as '#336699' or 'teal', found 'skinn'"),
        (["--texture", "{folder}/no.png"], "no.png"),
        (["--texture", "{folder}/character.glb"], "character.glb"),
        (["--texture", "{folder}/wide.png"], "wide.png: expected the proportions of the character's own picture (64 x 64"),
        (["--texture", "{folder}/deep.png"], "deep.png: expected 8 bits per channel, as in files that are drawn, found 16"),
    ],
)
def test_what_is_refused(file, tmp_path, capsys, flags, said):
    flags = [flag.format(folder=tmp_path) for flag in flags]
    Image.new("RGB", (96, 48)).save(tmp_path / "wide.png")
    Image.fromarray(np.zeros((64, 64), np.uint16)).save(tmp_path / "deep.png")
    assert run(file, *flags, "-o", tmp_path / "out.glb") == 1
    assert said in capsys.readouterr().err and not (tmp_path / "out.glb").exists()
