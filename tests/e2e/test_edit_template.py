"""The page that `doublet edit-template` opens, in a headless browser: paint, undo, save, and what the next stage makes of it."""

import json
import os
import shutil
import signal
import subprocess
import sys
from functools import partial

import doublet as d
import numpy as np
import pytest
from conftest import doublet
from page_posts import post

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

EDITED = "template_mask.npz"
SMALL = ["--template-poisson-depth", 6, "--template-triangles", 1500, "--template-high-triangles", 3000]


@pytest.fixture(scope="module")
def made(shipped, tmp_path_factory):
    out = tmp_path_factory.mktemp("edit")
    done = doublet("template", shipped, "-o", out, *SMALL)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture
def served(made):
    """(address, process) of the page for an OUT without a mask."""
    (made / EDITED).unlink(missing_ok=True)
    command = [sys.executable, "-m", "doublet", "edit-template", str(made), "--no-browser"]
    listen = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listen)
    yield process.stdout.readline().split()[0], process
    process.kill()
    process.communicate()


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    profile = tmp_path_factory.mktemp("profile")
    flags = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--window-size=1000,800"]
    for flag in (*flags, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    yield driver
    driver.quit()


def wait_for_status(browser, text):
    WebDriverWait(browser, 30).until(lambda b: text in b.find_element(By.ID, "status").text)


def press(browser, button):
    browser.find_element(By.ID, button).click()


def stroke(browser, *steps):
    """From the middle of the view by `steps`, pixels, with the left button down."""
    mouse = ActionChains(browser).move_to_element(browser.find_element(By.ID, "view")).click_and_hold()
    for x, y in steps:
        mouse = mouse.move_by_offset(x, y)
    mouse.release().perform()


def test_paint_and_save(made, served, browser):
    url, process = served
    browser.get(url)
    wait_for_status(browser, "Ready")
    suggested = d.read_suggested_mask(made).astype(bool)
    press(browser, "paint")
    stroke(browser, (0, -20), (0, -20))
    press(browser, "save")
    wait_for_status(browser, "Saved")
    mask, mesh = d.read_template_mask(made).astype(bool), d.read_mesh(made / "template.ply")
    painted = mesh.vertices[mesh.faces[suggested & ~mask]].mean(axis=1)
    assert len(painted) > 0 and not (mask & ~suggested).any()
    # The middle of the view shows the middle of the box of the surface, from the front; the stroke goes up from there.
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    up_there = painted - (low + high) / 2
    step = 1.2 * np.linalg.norm(high - low) / browser.execute_script("return document.getElementById('view').clientHeight")
    assert (np.abs(up_there[:, 0]) < 0.05).all()
    assert (up_there[:, 1] > -0.05).all() and (up_there[:, 1] < 40 * step + 0.05).all()
    normals = d.face_normals(mesh.vertices, mesh.faces)[suggested & ~mask]
    assert normals[:, 2].mean() > 0.3  # nothing through the body

    press(browser, "undo")
    press(browser, "save")
    WebDriverWait(browser, 30).until(lambda b: (d.read_template_mask(made).astype(bool) == suggested).all())

    press(browser, "erase")
    browser.find_element(By.CSS_SELECTOR, "[data-turn='0 -1.2']").click()
    folder = os.environ.get("DOUBLET_SCREENSHOTS")
    if folder:
        browser.save_screenshot(f"{folder}/edit-template.png")
    assert [
        entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE" and "favicon" not in entry["message"]
    ] == []


def test_the_next_stage_uses_the_mask_and_ctrl_c_ends_the_page(made, served, shipped, browser):
    url, process = served
    browser.get(url)
    wait_for_status(browser, "Ready")
    stroke(browser, (0, -20))
    press(browser, "save")
    wait_for_status(browser, "Saved")
    process.send_signal(signal.SIGINT)
    shown, errors = process.communicate(timeout=30)
    assert process.returncode == 0 and errors == "" and "uses it" in shown
    done = doublet("template", shipped, "-o", made, *SMALL)
    assert "template: up to date" in done.stderr and f"rig: running ({EDITED} changed)" in done.stderr
    mask = d.read_template_mask(made).astype(bool)
    assert (mask != d.read_suggested_mask(made).astype(bool)).any()
    assert (np.asarray(d.read_actor(made / "actor.npz").face_valid, bool) == mask).all()
    assert json.loads((made / "run.json").read_text())["stages"]["rig"]["summary"]["mask"] == "edited"


def test_what_is_no_mask_is_refused(made, served):
    url, _ = served
    good = json.dumps({"face_valid": d.read_suggested_mask(made).astype(int).tolist()}).encode()
    assert post(url, "mask", good, Content_Type="text/plain") == 400  # any page may send this
    assert post(url, "mask", good, Host="elsewhere.example") == 403
    for token in ("", "guessed", "ü"):  # a page from elsewhere knows none
        assert post(url, "mask", good, X_Page_Token=token.encode().decode("latin-1")) == 403
    for length in ("-1", "5_0", "+5", " ", "1e3", "9" * 30):
        assert post(url, "mask", good, Content_Length=length) == 400
    assert post(url, "mask", b"{") == 400
    assert post(url, "mask", b'{"face_valid": [1, 0]}') == 400
    assert post(url, "mask", b'{"face_valid": "1"}') == 400
    assert post(url, "mask", b" " * 100000) == 400
    assert not (made / EDITED).exists()
    assert post(url, "mask", good) == 200
    assert (d.read_template_mask(made).astype(bool) == d.read_suggested_mask(made).astype(bool)).all()


def test_without_a_template(tmp_path):
    done = doublet("edit-template", tmp_path, "--no-browser", timeout=30)
    assert done.returncode == 1 and "template.ply is missing" in done.stderr and "Traceback" not in done.stderr
