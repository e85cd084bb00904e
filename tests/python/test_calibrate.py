"""`doublet new-session --calibrate`: four videos of the example's dance, and where its joints are in them, to three pixels."""

import json
import shutil
import subprocess
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.cli import main
from doublet.common.images import ImageSeries
from doublet.common.video import read_video
from doublet.evaluation.cameras import compare, moved
from doublet.session.calibrate import stated_focal
from doublet.session.keypoints import JOINTS, CameraKeypoints
from PIL import Image

EXAMPLE = Path(__file__).parents[2] / "examples" / "data" / "session"
CAMERAS = ("cam0", "cam2", "cam4", "cam6")
NOISE = 3.0  #: px, of a keypoint
HEIGHT = 1.68


@pytest.fixture(scope="module")
def filmed(tmp_path_factory):
    """videos/ and keypoints/ of four cameras, as MediaPipe writes them."""
    folder, random = tmp_path_factory.mktemp("filmed"), np.random.default_rng(1)
    (folder / "videos").mkdir()
    (folder / "keypoints").mkdir()
    with np.load(EXAMPLE / "ground_truth" / "skeleton.npz") as truth:
        joints, names = truth["joints"], truth["joint_names"].tolist()
    chosen = [names.index(name) for name in JOINTS]
    for camera in d.Session(EXAMPLE).rig:
        if camera.name not in CAMERAS:
            continue
        shutil.copy(EXAMPLE / "videos" / f"{camera.name}.mp4", folder / "videos")
        frames = np.zeros((len(joints), 33, 3))
        seen = np.array([[camera.project(joint) for joint in frame] for frame in joints[:, chosen]])
        frames[:, [11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28], :2] = seen + random.normal(0, NOISE, seen.shape)
        frames[..., 2] = 0.9
        (folder / "keypoints" / f"{camera.name}.json").write_text(json.dumps(frames.tolist()))
    return folder


def call(folder, out, *more, status=0):
    command = ["new-session", str(folder / "videos"), "-o", str(out), "--quiet", "--sync", "none"]
    assert main([*command, *map(str, more)]) == status


def test_cameras_come_from_the_person(filmed, tmp_path, capsys):
    call(filmed, tmp_path / "new", "--calibrate", filmed / "keypoints", "--height", HEIGHT)
    said = capsys.readouterr().out
    assert "of its keypoints agree" in said and "calibrated by the person: 4 cameras" in said
    truth = {camera.name: camera for camera in d.Session(EXAMPLE).rig}
    with np.load(EXAMPLE / "ground_truth" / "skeleton.npz") as arrays:
        joints = arrays["joints"][::8].reshape(-1, 3)
    errors = compare(d.Session(tmp_path / "new").rig, [truth[name] for name in CAMERAS], joints)
    assert errors.scale == pytest.approx(1, abs=0.04) and errors.tilt < np.radians(2)  # as tall, and upright
    assert errors.pixels.max() < 1.5  # of 502 pixels; keypoints are off by 3
    frames = d.FrameSource.open(d.Session(tmp_path / "new"))  # the session keeps them, for the scan and for tracking
    assert np.abs(frames.keypoints(2, 100) - keypoints_of(filmed, "cam4")[100]).max() < 1e-3


def keypoints_of(folder, camera: str) -> np.ndarray:
    keypoints = CameraKeypoints(folder / "keypoints" / f"{camera}.json", (640, 480))
    return np.stack([keypoints.of(frame) for frame in range(keypoints.count)])


def test_a_calibrated_session_keeps_keypoints(filmed, tmp_path, capsys):
    more = ["--calibration", EXAMPLE / "calibration.yml", "--without", "cam1", "cam3", "cam5", "cam7", "--keypoints"]
    call(filmed, tmp_path / "new", *more, filmed / "keypoints", "--start", "0.1", "--offset", "cam2=0.05")
    session = d.Session(tmp_path / "new")
    frames = d.FrameSource.open(session)
    for index, camera in enumerate(session.cameras):
        assert camera.first_frame == (4 if camera.name == "cam2" else 6)
        seen = keypoints_of(filmed, camera.name)[camera.first_frame + 50]
        assert np.abs(frames.keypoints(index, 50) - seen).max() < 1e-3


def test_cameras_in_another_world_are_the_same_cameras():
    rig = list(d.Session(EXAMPLE).rig)
    angle, points = 0.4, np.random.default_rng(2).normal(0, 0.4, (40, 3)) + [0, 1, 0]
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    elsewhere = [moved(camera, 0.8, turn, np.array([0.3, -0.2, 0.1])) for camera in rig]
    errors = compare(elsewhere, rig, points)
    assert errors.scale == pytest.approx(1 / 0.8) and errors.tilt == pytest.approx(angle)
    assert errors.pixels.max() < 1e-6
    np.testing.assert_allclose(errors.placed[3].t, rig[3].t, atol=1e-9)
    elsewhere[2] = moved(rig[2], 1, np.eye(3), np.array([0, 0.02, 0]))  # 2 cm too low in a world of its own
    assert compare([*rig[:2], elsewhere[2], *rig[3:]], rig, points).metres.argmax() == 2
    with pytest.raises(ValueError, match="agree on at least three points, found 2"):
        compare(rig, rig, points[:2])


@pytest.mark.parametrize(
    "more, expected",
    [
        ((), "expected --calibration FILE, or --calibrate KEYPOINTS"),
        (("--calibration", EXAMPLE / "calibration.yml", "--height", 1.7), "--height: expected --calibrate"),
        (("--calibrate", "keypoints", "--height", 170), "--height: expected a number in [0.3, 3], found 170"),
        (("--calibrate", "keypoints", "--field-of-view", 0), "--field-of-view: expected a number in [1, 170], found 0"),
        (("--calibration", EXAMPLE / "calibration.yml", "--calibrate", "keypoints"), "--calibrate: expected no --calibration"),
        (("--keypoints", "keypoints"), "--keypoints: expected --calibration FILE beside it, found none"),
        (("--calibrate", "keypoints", "--without", "cam0"), "--without: expected --calibration"),
        (("--calibrate", "keypoints", "--offset", "cam1=2"), "--offset cam1: expected one of the cameras cam0, cam2, cam4, cam6"),
        (("--calibrate", "nothing"), "nothing: no such file or folder"),
        (("--calibrate", "videos"), "videos: expected a JSON file, or a folder of them, for each camera, found none"),
    ],
)
def test_wrong_arguments_are_one_sentence(filmed, tmp_path, capsys, more, expected):
    more = [filmed / part if part in ("keypoints", "nothing", "videos") else part for part in more]
    call(filmed, tmp_path / "new", *more, status=1)
    assert expected in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
def test_keypoints_of_another_video_name_the_camera(filmed, tmp_path, capsys):
    shutil.copytree(filmed / "keypoints", tmp_path / "keypoints")
    wrong = tmp_path / "keypoints" / "cam4.json"
    wrong.write_text(json.dumps(json.loads(wrong.read_text())[64:] + json.loads(wrong.read_text())[:64]))
    call(filmed, tmp_path / "new", "--calibrate", tmp_path / "keypoints", "--frames", 64, status=1)
    assert "camera 'cam4'" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_focal_lengths_that_files_state(tmp_path):
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0xA405] = 26
    Image.new("RGB", (64, 48)).save(tmp_path / "a_0001.jpg", exif=exif)
    assert stated_focal(ImageSeries(tmp_path, (tmp_path / "a_0001.jpg",), 25.0)) == 26
    Image.new("RGB", (64, 48)).save(tmp_path / "b_0001.jpg")
    assert stated_focal(ImageSeries(tmp_path, (tmp_path / "b_0001.jpg",), 25.0)) == 0
    tag = "com.apple.quicktime.camera.focal_length.35mm_equivalent=52"
    command = ["ffmpeg", "-loglevel", "error", "-f", "lavfi", "-i", "color=size=64x64:rate=25:duration=0.2"]
    subprocess.run([*command, "-metadata", tag, "-movflags", "use_metadata_tags", str(tmp_path / "c.mov")], check=True)
    assert stated_focal(read_video(tmp_path / "c.mov")) == 52
