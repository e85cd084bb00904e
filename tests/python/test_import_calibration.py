"""`doublet import-calibration`, and the cameras of a Blender scene."""

import json
import re
import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests" / "fuzz"))
import calibrations  # noqa: E402
from seeds import World, write_session  # noqa: E402


@pytest.mark.parametrize("name", calibrations.WRITERS)
def test_every_format_gives_the_same_cameras(name, tmp_path, capsys):
    path, _ = calibrations.write_all(tmp_path / "in")[name]
    out = tmp_path / "session" / "calibration.yml"
    assert cli.main(["import-calibration", str(path), "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "2 cameras, 4.00 to 4.00 m from each other" in said and "cam0: 1088 x 1920" in said and "height 1.40 m" in said
    for read, (camera, (R, t)) in zip(d.read_calibration(out), calibrations.poses().items()):
        assert read.camera.name == camera
        np.testing.assert_allclose(read.camera.K, calibrations.K, atol=1e-9)
        np.testing.assert_allclose(read.camera.R, R, atol=1e-9)
        np.testing.assert_allclose(read.camera.t, t, atol=1e-9)
        terms = calibrations.TERMS_OF.get(name, calibrations.TERMS)
        np.testing.assert_allclose(read.camera.distortion, [*terms, 0], atol=1e-12)


def test_the_format_may_be_said(tmp_path):
    path, _ = calibrations.write_all(tmp_path)["toml"]
    named = path.rename(path.with_name("calibration.txt"))
    out = str(tmp_path / "calibration.yml")
    assert cli.main(["import-calibration", str(named), "-o", out]) == 1
    assert cli.main(["import-calibration", str(named), "-o", out, "--format", "toml", "--up", "z", "--units", "m"]) == 0


def test_a_negative_axis_and_a_factor(tmp_path):
    path, _ = calibrations.write_all(tmp_path)["toml"]
    options = d.CalibrationOptions(up="-z", units="2")
    turned, straight = d.read_calibration(path, options), d.read_calibration(path)
    for a, b in zip(turned, straight):
        np.testing.assert_allclose(a.camera.centre, 2 * b.camera.centre * [1, -1, -1], atol=1e-9)
    out = tmp_path / "calibration.yml"
    assert cli.main(["import-calibration", str(path), "-o", str(out), "--up=-z", "--units", "2"]) == 0
    np.testing.assert_array_equal(d.read_calibration(out)[1].camera.t, turned[1].camera.t)


@pytest.mark.parametrize("pose", ['rotation = "null"\ntranslation = "null"\n', "rotation = []\ntranslation = []\n"])
def test_a_pose_that_is_null_was_not_found(tmp_path, pose):
    path, _ = calibrations.write_all(tmp_path)["toml"]
    matrix = "matrix = [[900, 0, 640], [0, 900, 360], [0, 0, 1]]\n"
    (tmp_path / "more.toml").write_text(path.read_text() + f'\n[lost]\nname = "lost"\nsize = [1280, 720]\n{matrix}{pose}')
    said = []
    cameras = d.read_calibration(tmp_path / "more.toml", d.CalibrationOptions(), d.Context(log=said.append))
    assert len(cameras) == len(d.read_calibration(path)) and "camera 'lost' has no rotation and translation" in " ".join(said)


def test_a_size_of_floats(tmp_path):
    path, (intri, _) = calibrations.write_all(tmp_path)["easymocap"]
    sizes = [(c.camera.width, c.camera.height) for c in d.read_calibration(path)]
    lines = [f"{line}." if line[:2] in ("W_", "H_") else line for line in intri.read_text().splitlines()]
    assert any(line.endswith(".") for line in lines)
    intri.write_text("\n".join(lines) + "\n")
    assert [(c.camera.width, c.camera.height) for c in d.read_calibration(path)] == sizes


def test_what_is_read_is_not_overwritten(tmp_path, monkeypatch, capsys):
    """Where nothing is said calibration.yml is written, which may be what another program has written."""
    path, *_ = calibrations.write_all(tmp_path)["toml"]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "calibration.yml").symlink_to(path)
    before = path.read_bytes()
    assert cli.main(["import-calibration", str(path)]) == 1
    assert "calibration.yml: expected another file than the one that is read" in capsys.readouterr().err
    assert path.read_bytes() == before


def test_the_size_of_the_images_may_be_said(tmp_path, capsys):
    path, (intri, _) = calibrations.write_all(tmp_path)["easymocap"]
    lines = [line for line in intri.read_text().splitlines() if line[:2] not in ("W_", "H_")]
    intri.write_text("\n".join(lines) + "\n")
    command = ["import-calibration", str(path), "-o", str(tmp_path / "calibration.yml")]
    assert cli.main(command) == 1
    assert "--image-size WxH" in capsys.readouterr().err
    assert cli.main([*command, "--image-size", "1088x1920"]) == 0
    with pytest.raises(SystemExit):
        cli.main([*command, "--image-size", "0x1920"])


def test_a_session_with_a_lens_is_read_as_pinhole_cameras(tmp_path):
    world = World()
    write_session(tmp_path, world)
    path = tmp_path / "calibration.yml"
    cameras = d.read_calibration(path)
    before = d.Session(tmp_path)
    mask = d.FrameSource.open(before).mask(0, 0)
    lens = d.Lens()
    lens.fisheye, lens.distortion = True, [-0.9, 0, 0, 0]  # a strong pincushion: the corners were not filmed
    cameras[0].lens = lens
    d.write_calibration(path, cameras)
    session = d.Session(tmp_path)
    assert [lens.needs_undistortion for lens in session.lenses] == [True, False]
    assert session.lenses[0].fisheye and session.rig[0].distortion.tolist() == [0] * 5
    np.testing.assert_array_equal(session.rig[0].K, before.rig[0].K)
    undone = d.FrameSource.open(session).mask(0, 0)
    assert mask.min() == 255 and undone.shape == mask.shape and undone[24, 24] == 255
    np.testing.assert_array_equal(d.FrameSource.open(session).mask(1, 0), mask)


def test_cameras_can_be_written_as_they_are(tmp_path):
    world = World()
    d.write_calibration(tmp_path / "c.yml", world.cameras)
    for read, camera in zip(d.read_calibration(tmp_path / "c.yml"), world.cameras):
        np.testing.assert_array_equal(read.camera.R, camera.R)
        point = [0.1, 1.2, 0.05]
        np.testing.assert_array_equal(read.project(point), camera.project(point))
        assert not read.lens.needs_undistortion


def test_metashape_places_components_and_has_folders(tmp_path):
    """As version 2 writes it. cam2 was not aligned with the others."""
    path, _ = calibrations.write_all(tmp_path)["metashape"]
    before, text = d.read_calibration(path), path.read_text().replace('sensor_id="0" ', 'sensor_id="0" component_id="0" ')
    transform = text[text.rindex("<transform><rotation>") : text.rindex("</chunk>")]
    text = text.replace(transform, "").replace(
        "</sensors>", f'</sensors><components><component id="0">{transform}</component></components>'
    )
    first = text[text.index("<cameras>") + 9 : text.index("</camera>") + 9]
    apart = first.replace('component_id="0"', 'component_id="1"').replace("cam0", "cam2")
    text = text.replace(first, f'<group id="0" type="folder">{first}{apart}</group>')
    path.write_text(text)
    said = []
    cameras = d.read_calibration(path, context=d.Context(log=said.append))
    assert [c.camera.name for c in cameras] == ["cam0", "cam1"]
    for now, then in zip(cameras, before):
        np.testing.assert_allclose(now.camera.R, then.camera.R, atol=1e-12)
        np.testing.assert_allclose(now.camera.t, then.camera.t, atol=1e-12)
    assert len(said) == 2 and "camera 'cam2.jpg' was not aligned with most of the others" in said[0]


def test_metashape_labels_may_have_dots(tmp_path):
    path, _ = calibrations.write_all(tmp_path)["metashape"]
    path.write_text(path.read_text().replace('"cam0.jpg"', '"rig.cam0"').replace('"cam1.jpg"', '"rig.cam1.JPG"'))
    assert [c.camera.name for c in d.read_calibration(path)] == ["rig_cam0", "rig_cam1"]


@pytest.mark.parametrize(("flag", "fisheye"), [("1", True), ("true", True), ("0", False), ("false", False), ("maybe", None)])
def test_a_fisheye_says_so(tmp_path, flag, fisheye):
    path, files = calibrations.write_all(tmp_path)["opencv"]
    for file in files:
        file.write_text(file.read_text() + f"fisheye_model: {flag}\n")
    if fisheye is None:
        with pytest.raises(d.Error, match="expected fisheye_model to be 1 or 0, true or false, found 'maybe'"):
            d.read_calibration(path)
    else:
        assert [c.lens.fisheye for c in d.read_calibration(path)] == [fisheye, fisheye]


# --- transforms.json of radiance fields


def transforms(tmp_path, change) -> Path:
    path, _ = calibrations.write_all(tmp_path)["nerfstudio"]
    file = json.loads(path.read_text())
    change(file)
    path.write_text(json.dumps(file))
    return path


def test_a_radiance_field_of_a_fisheye(tmp_path):
    path = transforms(tmp_path, lambda file: file.update(camera_model="OPENCV_FISHEYE", k3=0.01, k4=-0.02))
    for camera in d.read_calibration(path.parent):  # the folder does, too
        assert camera.lens.fisheye
        np.testing.assert_array_equal(camera.lens.distortion, [*calibrations.TERMS[:2], 0.01, -0.02])


def test_a_radiance_field_with_an_angle_and_no_size(tmp_path):
    def blender(file):
        for frame in file["frames"]:
            del frame["h"]
        for key in [key for key in file if key != "frames"]:
            del file[key]
        file["camera_angle_x"] = 0.7

    path = transforms(tmp_path, blender)
    with pytest.raises(d.Error, match="expected a size of the images, found none"):
        d.read_calibration(path)
    camera = d.read_calibration(path, d.CalibrationOptions(image_width=800, image_height=600))[0].camera
    focal = 400 / np.tan(0.35)
    np.testing.assert_allclose(camera.K, [[focal, 0, 399.5], [0, focal, 299.5], [0, 0, 1]])


def test_names_of_a_radiance_fields_cameras(tmp_path):
    def named(file):
        for frame, name in zip(file["frames"], ("Cam.01", "Cam.02")):
            frame["camera_name"] = name

    assert [c.camera.name for c in d.read_calibration(transforms(tmp_path, named))] == ["Cam_01", "Cam_02"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"camera_model": "EQUIRECTANGULAR"}, '"camera_model" of a perspective or fisheye lens, found EQUIRECTANGULAR'),
        ({"k4": 0.1}, 'no "k4" of a lens that is no fisheye'),
        ({"fl_x": 0}, 'expected "fl_x" or "camera_angle_x"'),
        ({"from_na": True}, "look along -Z"),
        ({"fl_x": "long"}, "an entry that cannot be read"),
        ({"frames": []}, "expected a list of 1 to 1000 cameras"),
        ({"frames": [{"file_path": "a.png", "h": 9}]}, '"transform_matrix" to be 12 or 16 numbers, found none'),
        ({"frames": [3]}, "an entry that cannot be read"),
    ],
)
def test_a_radiance_field_that_does_not_do(tmp_path, change, said):
    path = transforms(tmp_path, lambda file: file.update(change))
    with pytest.raises(d.Error, match=re.escape(said)):
        d.read_calibration(path)


# --- ActorsHQ


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ((", fy", ", focal"), 'line 2: expected a column "fy", found none'),
        (("cam1, 1088", "cam1"), "line 3: expected 15 cells as the first line has, found 14"),
        (("cam1, 1088", "cam1, wide"), "line 3: expected w to be a number, found 'wide'"),
        (("cam1, 1088", "cam1, 0"), "line 3: expected a size of the images, found none"),
        (("cam1", "cam0"), "expected the names of cameras to differ"),
    ],
)
def test_a_table_of_cameras_that_does_not_do(tmp_path, change, said):
    path, _ = calibrations.write_all(tmp_path)["actorshq"]
    assert change[0] in path.read_text()
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(d.Error, match=re.escape(said)):
        d.read_calibration(path)


# --- Blender


def blender_camera(name, place, turn, **data):
    """An object as bpy has it: rotation (3, 3) and place, columns scaled, as objects in Blender often are."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = 1.7 * turn, place
    given = {"type": "PERSP", "lens": 35.0, "sensor_width": 36.0, "sensor_height": 24.0, "sensor_fit": "AUTO"}
    given |= {"shift_x": 0.0, "shift_y": 0.0} | data
    return SimpleNamespace(name=name, type="CAMERA", matrix_world=matrix.tolist(), data=SimpleNamespace(**given))


def looking(place, at):
    """Axes of a camera in Blender's world as columns: x right, y up, z backward; +Z up."""
    z = (place - at) / np.linalg.norm(place - at)
    x = np.cross([0, 0, 1], z) / np.linalg.norm(np.cross([0, 0, 1], z))
    return np.column_stack([x, np.cross(z, x), z])


def blender_pixel(camera, render, point):
    """As Blender's manual has it: the view's frame is sensor / lens wide at distance 1 on the fitted side, shifted by shares of
    that side; pixels have their corner at integers there, their centre here."""
    width, height = (s * render.resolution_percentage / 100 for s in (render.resolution_x, render.resolution_y))
    wide, high = width * render.pixel_aspect_x, height * render.pixel_aspect_y
    data, matrix = camera.data, np.array(camera.matrix_world)
    x, y, z = matrix[:3, :3].T / 1.7 @ (point - matrix[:3, 3])
    fit = data.sensor_fit if data.sensor_fit != "AUTO" else ("HORIZONTAL" if wide >= high else "VERTICAL")
    sensor = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    longest = wide if fit == "HORIZONTAL" else high
    frame = np.array([wide, high]) / longest * sensor / data.lens  # at distance 1
    shift = np.array([data.shift_x, data.shift_y]) * sensor / data.lens
    share = (np.array([x, y]) / -z - shift) / frame + 0.5  # from the lower left
    return np.array([share[0] * width - 0.5, (1 - share[1]) * height - 0.5])


@pytest.fixture
def blender(monkeypatch):
    bpy = ModuleType("bpy")
    place = np.array([2.5, -3.0, 1.6])
    turn = looking(place, np.array([0, 0, 1.0]))
    objects = [
        blender_camera("Camera", place, turn),
        blender_camera("Camera.001", place + [0.3, 0, 0.2], turn, shift_x=0.1, shift_y=-0.07, sensor_fit="VERTICAL"),
        blender_camera("front left", place * [-1, 1, 1], looking(place * [-1, 1, 1], np.zeros(3)), sensor_fit="HORIZONTAL"),
        SimpleNamespace(name="Cube", type="MESH"),
    ]
    render = SimpleNamespace(
        resolution_x=1920, resolution_y=1080, resolution_percentage=50, pixel_aspect_x=1.0, pixel_aspect_y=1.0
    )
    units = SimpleNamespace(scale_length=1.0)
    bpy.context = SimpleNamespace(scene=SimpleNamespace(objects=objects, render=render, unit_settings=units))
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    return bpy.context.scene


def run_in_blender(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["blender", "x.blend", "--python", "blender_cameras.py", "--", *map(str, arguments)])
    return runpy.run_path(str(ROOT / "examples" / "blender_cameras.py"), run_name="__main__")


@pytest.mark.parametrize("size", [(1920, 1080), (1080, 1920)])
@pytest.mark.parametrize("aspect", [(1.0, 1.0), (1.0, 1.5), (2.0, 1.0)])
def test_blenders_cameras_see_what_blender_sees(blender, monkeypatch, tmp_path, size, aspect):
    render = blender.render
    (render.resolution_x, render.resolution_y), (render.pixel_aspect_x, render.pixel_aspect_y) = size, aspect
    blender.unit_settings.scale_length = 0.5
    run_in_blender(monkeypatch, tmp_path / "calibration.yml")
    cameras = [c.camera for c in d.read_calibration(tmp_path / "calibration.yml")]
    assert [c.name for c in cameras] == ["Camera", "Camera_001", "front_left"]
    for camera, source in zip(cameras, blender.objects):
        assert (camera.width, camera.height) == (size[0] // 2, size[1] // 2)
        for point in np.random.default_rng(3).uniform(-1, 1, (100, 3)) + [0, 0, 1]:
            ours = 0.5 * np.array([point[0], point[2], -point[1]])  # metres, +Y up
            np.testing.assert_allclose(camera.project(ours), blender_pixel(source, render, point), atol=1e-6)


def test_blenders_cameras_may_be_chosen(blender, monkeypatch, tmp_path):
    run_in_blender(monkeypatch, tmp_path / "calibration.yml", "front left")
    assert [c.camera.name for c in d.read_calibration(tmp_path / "calibration.yml")] == ["front_left"]
    with pytest.raises(SystemExit, match="back"):
        run_in_blender(monkeypatch, tmp_path / "calibration.yml", "back")
    blender.objects[0].data.type = "ORTHO"
    with pytest.raises(SystemExit, match="'Camera'.*ORTHO"):
        run_in_blender(monkeypatch, tmp_path / "calibration.yml")
    with pytest.raises(SystemExit, match="calibration.yml"):
        run_in_blender(monkeypatch)
