"""The page that `doublet edit-joints` opens, in a headless browser: drag, undo, save; and what is refused."""

import json
import os
import signal
import subprocess
import sys
from functools import partial

import doublet as d
import numpy as np
import pytest
from doublet.pages import edit_joints

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from test_edit_template import browser, press, wait_for_status  # noqa: E402, F401


def test_a_joint_is_dragged_and_saved(broken_session, browser):  # noqa: F811
    command = [sys.executable, "-m", "doublet", "edit-joints", str(broken_session), "--no-browser"]
    listen = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listen)
    browser.get(process.stdout.readline().split()[0])
    wait_for_status(browser, "Ready")
    before = positions(broken_session)
    camera = edit_joints.smaller(d.Session(broken_session).rig[2])
    start = np.ravel(camera.project(before["l_elbow"]))
    canvas = browser.find_element(By.ID, "view2")
    from_middle = np.round(start - [camera.width / 2, camera.height / 2]).astype(int).tolist()
    mouse = ActionChains(browser).move_to_element_with_offset(canvas, *from_middle).click_and_hold()
    mouse.move_by_offset(15, -5).move_by_offset(15, -5).release().perform()
    folder = os.environ.get("DOUBLET_SCREENSHOTS")
    if folder:
        browser.save_screenshot(f"{folder}/edit-joints.png")
    assert asks_before_leaving(browser)
    press(browser, "save")
    wait_for_status(browser, "Saved")
    assert not asks_before_leaving(browser)
    after = positions(broken_session)
    np.testing.assert_allclose(np.ravel(camera.project(after["l_elbow"])) - start, [30, -10], atol=2)
    depth = np.asarray(camera.R)[2] @ (after["l_elbow"] - before["l_elbow"])
    assert abs(depth) < 0.001
    assert all((after[name] == before[name]).all() for name in before if name != "l_elbow")
    assert json.loads((broken_session / "joints.json").read_text())["joints"]["l_elbow"]["parent"] == "l_shoulder"

    press(browser, "undo")
    press(browser, "save")
    wait_for_status(browser, "Saved")
    np.testing.assert_allclose(positions(broken_session)["l_elbow"], before["l_elbow"], atol=1e-4)
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert [entry for entry in severe if "favicon" not in entry["message"]] == []
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    assert process.returncode == 0


def asks_before_leaving(browser) -> bool:  # noqa: F811
    """What was moved and not saved would be lost."""
    leave = (
        "const leaving = new Event('beforeunload', {cancelable: true}); dispatchEvent(leaving); return leaving.defaultPrevented"
    )
    return browser.execute_script(leave)


def positions(session) -> dict:
    return {joint.name: np.ravel(joint.position) for joint in d.Session(session).joints}


def test_what_is_no_joints_is_refused(broken_session):
    path = broken_session / "joints.json"
    before = path.read_bytes()
    marks = edit_joints.read_marks(path)
    good = {"joints": {name: joint["position"] for name, joint in marks["joints"].items()}, "landmarks": marks["landmarks"]}
    for spoil, words in (
        (lambda sent: sent.pop("joints"), "expected {"),
        (lambda sent: sent["joints"].pop("l_knee"), "expected the joints of the file, pelvis"),
        (lambda sent: sent["joints"].update(tail=[0, 0, 0]), "expected the joints of the file, pelvis"),
        (lambda sent: sent["joints"].update(l_knee=[0, 0]), "l_knee: expected three numbers, m"),
        (lambda sent: sent["joints"].update(l_knee=[0, 0, float("nan")]), "l_knee: expected three numbers, m"),
        (lambda sent: sent["landmarks"].update(nose_tip="here"), "nose_tip: expected three numbers, m"),
    ):
        sent = json.loads(json.dumps(good))
        spoil(sent)
        with pytest.raises(ValueError, match=words):
            edit_joints.save_joints(path, json.dumps(sent).encode())
    with pytest.raises(ValueError, match="expected"):
        edit_joints.save_joints(path, b"[")
    assert path.read_bytes() == before


def test_a_session_without_joints_is_refused(broken_session):
    described = json.loads((broken_session / "session.json").read_text())
    (broken_session / "session.json").write_text(json.dumps({k: v for k, v in described.items() if k != "markers"}))
    with pytest.raises(RuntimeError, match="names no joints; `doublet scan .*` makes them"):
        edit_joints.open_page(broken_session)
