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
from doublet.session.calibrate import stated_focal
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
    chosen = [names.index(name) for name in d.CALIBRATION_JOINTS]
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


def similarity(source, target):
    """Factor, rotation, shift (Umeyama 1991)."""
    a, b = source - source.mean(0), target - target.mean(0)
    u, s, v = np.linalg.svd(b.T @ a)
    sign = np.diag([1, 1, np.linalg.det(u @ v)])
    turn, factor = u @ sign @ v, (s * np.diag(sign)).sum() / (a**2).sum()
    return factor, turn, target.mean(0) - factor * turn @ source.mean(0)


def test_cameras_come_from_the_person(filmed, tmp_path, capsys):
    call(filmed, tmp_path / "new", "--calibrate", filmed / "keypoints", "--height", HEIGHT)
    said = capsys.readouterr().out
    assert "of its keypoints agree" in said and "calibrated by the person: 4 cameras" in said
    session, truth = d.Session(tmp_path / "new"), {c.name: c for c in d.Session(EXAMPLE).rig}
    with np.load(EXAMPLE / "ground_truth" / "skeleton.npz") as arrays:
        joints = arrays["joints"][::8].reshape(-1, 3)
    found = []
    for joint in joints:
        seen = np.array([[*truth[name].project(joint), 1.0] for name in CAMERAS])
        found.append(d.triangulate([d.CalibratedCamera(c) for c in session.rig], seen))
    assert all(point is not None for point in found)
    factor, turn, shift = similarity(joints, np.array(found))
    assert factor == pytest.approx(1, abs=0.04) and turn[1, 1] > np.cos(np.radians(2))  # as tall, and upright
    for camera in session.rig:
        there = joints @ (factor * turn).T + shift
        apart = [camera.project(x) - truth[camera.name].project(y) for x, y in zip(there, joints)]
        assert np.sqrt(np.mean(np.square(apart))) < 1.5, camera.name  # of 502 pixels; keypoints are off by 3


@pytest.mark.parametrize(
    "more, expected",
    [
        ((), "expected either --calibration FILE or --calibrate KEYPOINTS"),
        (("--calibration", EXAMPLE / "calibration.yml", "--height", 1.7), "--height: expected --calibrate"),
        (("--calibrate", "keypoints", "--height", 170), "--height: expected a number in [0.3, 3], found 170"),
        (("--calibrate", "keypoints", "--field-of-view", 0), "--field-of-view: expected a number in [1, 170], found 0"),
        (("--calibrate", "nothing"), "expected a folder with the keypoints of each camera, found none"),
    ],
)
def test_wrong_arguments_are_one_sentence(filmed, tmp_path, capsys, more, expected):
    more = [filmed / part if part in ("keypoints", "nothing") else part for part in more]
    call(filmed, tmp_path / "new", *more, status=1)
    assert expected in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_keypoints_of_another_video_name_the_camera(filmed, tmp_path, capsys):
    shutil.copytree(filmed / "keypoints", tmp_path / "keypoints")
    wrong = tmp_path / "keypoints" / "cam4.json"
    wrong.write_text(json.dumps(json.loads(wrong.read_text())[64:] + json.loads(wrong.read_text())[:64]))
    call(filmed, tmp_path / "new", "--calibrate", tmp_path / "keypoints", status=1)
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
