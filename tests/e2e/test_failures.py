"""A broken session fails within seconds, with one sentence that names what is wrong."""

import json
import re
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


def test_calibration_in_millimetres_stops_before_the_work(broken_session, tmp_path):
    calibration = broken_session / "calibration.yml"
    storage = cv_matrices(calibration.read_text(), "_t", 1000)
    calibration.write_text(storage)
    message = refused(broken_session, tmp_path / "out")
    assert "calibration" in message and "millimetres" in message
    assert (tmp_path / "out" / "check.png").exists() and not (tmp_path / "out" / "template.ply").exists()
    done = doublet("check", broken_session, "-o", tmp_path / "out", "--keep-going")
    assert done.returncode == 3 and "impossible" in done.stderr and "up to date" in done.stderr


def cv_matrices(text, suffix, factor):
    """OpenCV's YAML with the numbers of every matrix whose name ends in `suffix` multiplied."""
    block = re.compile(rf"(cam\d+{suffix}: !!opencv-matrix.*?data: \[)(.*?)(\])", re.S)
    found = block.subn(lambda m: m[1] + ", ".join(str(factor * float(x)) for x in m[2].split(",")) + m[3], text)
    assert found[1] == 8
    return found[0]


def test_doubts_have_an_exit_status_of_their_own(broken_session, tmp_path):
    path = broken_session / "session.json"
    session = json.loads(path.read_text())
    session["fps"] = 30
    path.write_text(json.dumps(session))
    done = doublet("check", broken_session, "-o", tmp_path / "out")
    assert done.returncode == 3 and "expected the videos' frame rate 40, found 30" in done.stderr


def test_results_of_another_session_are_not_recomputed_over(broken_session, shipped, tmp_path):
    out = tmp_path / "out"
    assert doublet("check", shipped, "-o", out).returncode == 0
    before = (out / "check.png").read_bytes()
    path = broken_session / "joints.json"
    marks = path.read_text()
    path.write_text(json.dumps({**json.loads(marks), "note": "another session"}))
    message = refused(broken_session, out)
    assert str(out) in message and str(shipped) in message
    assert (out / "check.png").read_bytes() == before
    path.write_text(marks)
    moved = doublet("check", broken_session, "-o", out)  # the same files elsewhere
    assert moved.returncode == 0 and "check: up to date" in moved.stderr


def test_no_session_there(tmp_path):
    assert "nowhere" in refused(tmp_path / "nowhere", tmp_path / "out")


def test_wrong_option_is_named(shipped, tmp_path):
    done = doublet("reconstruct", shipped, "-o", tmp_path / "out", "--segment-diffusion", "-1")
    assert done.returncode == 1
    assert "diffusion" in done.stderr and "Traceback" not in done.stderr


def test_stage_without_its_input_names_the_stage_that_writes_it(shipped, tmp_path):
    done = doublet("segment", tmp_path, "--session", shipped)
    assert done.returncode == 1
    assert "actor.npz" in done.stderr and "'rig'" in done.stderr


def test_animate_refuses_other_formats(tmp_path):
    done = doublet("animate", tmp_path / "c.glb", tmp_path / "m.bvh", "-o", tmp_path / "x.avi")
    assert done.returncode == 1 and ".mp4" in done.stderr
