"""A calibration that is off is mended by the take, and whatever comes after goes by the mended one."""

import json
import shutil

import doublet as d
import numpy as np
import pytest
from conftest import doublet
from doublet import reconstruct

pytestmark = pytest.mark.slow
OPTIONS = ("--capture-frame-count", 4, "--template-poisson-depth", 8, "--keep-going")


def turned(camera, degrees, axis):
    """About its centre (Rodrigues' formula)."""
    a, angle = np.asarray(axis) / np.linalg.norm(axis), np.radians(degrees)
    cross = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    centre = -camera.R.T @ camera.t
    camera.R = turn @ camera.R
    camera.t = -camera.R @ centre
    return camera


@pytest.fixture(scope="module")
def made(shipped, tmp_path_factory):
    """The session with every camera turned by 0.3 degrees, and what was captured of it."""
    session, out = tmp_path_factory.mktemp("turned"), tmp_path_factory.mktemp("out")
    for name in ("session.json", "scan.ply", "joints.json", "motion.bvh"):
        shutil.copy(shipped / name, session / name)
    (session / "videos").symlink_to(shipped.resolve() / "videos")
    random = np.random.default_rng(3)
    cameras = [turned(camera, 0.3, random.normal(size=3)) for camera in d.Session(shipped).rig]
    d.write_calibration(session / "calibration.yml", cameras)
    done = doublet("capture", session, "-o", out, *OPTIONS)
    assert done.returncode in (0, 3), done.stderr  # 3: something is doubtful
    return session, out, done.stderr


def pixels(rig, points):
    def project(camera):
        x = points @ camera.R.T + camera.t
        return x[:, :2] / x[:, 2:] * np.diag(camera.K)[:2] + camera.K[:2, 2]

    return np.stack([project(camera) for camera in rig])


def error(rig, truth, points):
    """Mean distance in the pictures, pixels."""
    return np.linalg.norm(pixels(rig, points) - pixels(truth, points), axis=-1).mean()


def test_the_cameras_of_out_are_nearer_to_the_true_ones(made, shipped):
    session, out, shown = made
    truth, given = d.Session(shipped).rig, d.Session(session).rig
    points = np.asarray(d.read_mesh(out / "template.ply").vertices)
    refined = reconstruct.Job(session, out).filmed
    assert refined.calibration == out / "calibration.yml"
    assert error(refined.rig, truth, points) < 0.3 * error(given, truth, points)
    assert error(d.read_observations(out / "observations.npz").cameras, refined.rig, points) < 1e-6
    assert "mm off on the actor" in shown and str(out / "calibration.yml") in shown


def test_the_record_says_how_far_each_camera_moved(made):
    _, out, _ = made
    summary = json.loads((out / "run.json").read_text())["stages"]["performance"]["summary"]
    assert summary["cameras_refined"] is True
    assert [camera["camera"] for camera in summary["cameras"]] == [f"cam{c}" for c in range(8)]
    assert all(camera["seen"] and 0 < camera["sure_mm"] < 5 for camera in summary["cameras"])
    assert 3 < np.mean([camera["moved_mm"] for camera in summary["cameras"]]) < 40


@pytest.mark.slow
def test_without_refinement_the_given_cameras_stay(made):
    session, out, _ = made
    done = doublet("capture", session, "-o", out, *OPTIONS, "--no-capture-refine-cameras")
    assert done.returncode in (0, 3), done.stderr  # 3: something is doubtful
    assert not (out / "calibration.yml").exists()
    assert reconstruct.Job(session, out).filmed.calibration == session / "calibration.yml"
    assert json.loads((out / "run.json").read_text())["stages"]["performance"]["summary"]["cameras"] == []


def test_a_late_camera_is_read_later(shipped, tmp_path):
    session = d.Session(shipped)
    late = [d.CalibratedCamera(camera, late=int(camera.name == "cam1")) for camera in session.rig]
    d.write_calibration(tmp_path / "calibration.yml", late)
    moved = session.recalibrated(tmp_path / "calibration.yml")
    assert [camera.late for camera in moved.cameras] == [0, 1, 0, 0, 0, 0, 0, 0]
    frames, moved_frames = d.FrameSource.open(session), d.FrameSource.open(moved)
    assert np.array_equal(moved_frames.image(1, 3), frames.image(1, 4))
    assert np.array_equal(moved_frames.image(0, 3), frames.image(0, 3))
    assert moved_frames.image(1, session.frame_count - 1).size == 0  # its film is over
    with pytest.raises(FileNotFoundError, match="expected a calibration, found no such file"):
        session.recalibrated(tmp_path / "none.yml")
