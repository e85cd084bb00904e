"""A broken session fails within seconds, with one sentence that names what is wrong."""

import json
import time

import pytest
from conftest import doublet

QUICK = 30  # s, on a busy machine


def refused(session, out):
    start = time.monotonic()
    done = doublet("reconstruct", session, "-o", out)
    assert time.monotonic() - start < QUICK
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith("doublet: ")]
    assert len(lines) == 1, done.stderr
    return lines[0]


def test_missing_video(broken_session, tmp_path):
    (broken_session / "videos" / "cam3.mp4").unlink()
    assert "cam3.mp4" in refused(broken_session, tmp_path / "out")


def test_calibration_lacks_a_camera(broken_session, tmp_path):
    calibration = broken_session / "calibration.yml"
    text = calibration.read_text()
    calibration.write_text(text.replace("cam5_", "spare_"))
    message = refused(broken_session, tmp_path / "out")
    assert "cam5" in message and "calibration.yml" in message


@pytest.mark.parametrize("share", [0.5, 0.95])
def test_truncated_video(broken_session, tmp_path, share):
    video = broken_session / "videos" / "cam6.mp4"
    whole = video.read_bytes()
    video.unlink()
    video.write_bytes(whole[: int(share * len(whole))])
    assert "cam6.mp4" in refused(broken_session, tmp_path / "out")


def test_unknown_joint(broken_session, tmp_path):
    path = broken_session / "joints.json"
    marked = json.loads(path.read_text())
    marked["joints"]["l_knee"]["parent"] = "l_hipp"
    path.write_text(json.dumps(marked))
    assert "l_hipp" in refused(broken_session, tmp_path / "out")


def test_no_session_there(tmp_path):
    assert "nowhere" in refused(tmp_path / "nowhere", tmp_path / "out")


def test_wrong_option_is_named(shipped, tmp_path):
    done = doublet("reconstruct", shipped, "-o", tmp_path / "out", "--segment-rigid-threshold", "-1")
    assert done.returncode == 1
    assert "rigid_threshold" in done.stderr and "Traceback" not in done.stderr


def test_stage_without_its_input_names_the_stage_that_writes_it(shipped, tmp_path):
    done = doublet("segment", tmp_path, "--session", shipped)
    assert done.returncode == 1
    assert "actor.npz" in done.stderr and "'rig'" in done.stderr


def test_animate_refuses_other_formats(tmp_path):
    done = doublet("animate", tmp_path / "c.glb", tmp_path / "m.bvh", "-o", tmp_path / "x.avi")
    assert done.returncode == 1 and ".mp4" in done.stderr
