"""The page that `doublet edit-segmentation` opens, in a headless browser: borders, skin, save, and what the stage makes of it."""

import json
import signal
import subprocess
import sys
import urllib.request
from functools import partial

import doublet as d
import numpy as np
import pytest
from conftest import doublet
from doublet import reconstruct
from doublet.common.console import Console
from page_posts import post

pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402
from test_edit_template import browser, press, stroke, wait_for_status  # noqa: E402, F401

PAINTED, FOUND = "segmentation_paint.npz", "segmentation_found.npz"
AS_FOUND, SKIN, BORDER = -1, 0, 2
AROUND, ROWS, HEIGHT, RADIUS = 24, 25, 1.2, 0.15


def tube(radii: np.ndarray) -> np.ndarray:
    """(ROWS * AROUND, 3) m about +Y, of these radii (ROWS)."""
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    rows = [radii[:, None] * np.sin(turn), np.tile(heights()[:, None], AROUND), radii[:, None] * np.cos(turn)]
    return np.stack(rows, axis=-1).reshape(-1, 3)


def heights() -> np.ndarray:
    return np.linspace(0, HEIGHT, ROWS)


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """As after the stage `performance`: a tube that is loose between 0.2 and 0.9 m."""
    out = tmp_path_factory.mktemp("edit") / "out"
    out.mkdir()
    here = (np.arange(ROWS - 1)[:, None] * AROUND + np.arange(AROUND)).ravel()
    ahead = (np.arange(ROWS - 1)[:, None] * AROUND + (np.arange(AROUND) + 1) % AROUND).ravel()
    halves = [np.stack([here, ahead, ahead + AROUND], 1), np.stack([here, ahead + AROUND, here + AROUND], 1)]
    faces = np.vstack(halves).astype(np.int32)
    still = tube(np.full(ROWS, RADIUS))
    loose = np.where((heights() > 0.2) & (heights() < 0.9), 0.03, 0.0)
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.6, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(still, faces), [1] * len(faces), np.ones((len(still), 1)), skeleton)
    performance, count = d.ReferencePerformance(), 12
    performance.dofs, performance.joints = np.zeros((count, 6)), np.zeros((count, 1, 3))
    performance.frames = list(range(count))
    performance.surface = d.MeshSequence(faces, np.stack([tube(RADIUS + np.sin(t) * loose) for t in range(count)]))
    d.write_mesh(out / "template.ply", actor.mesh)
    d.write_actor(out / "actor.npz", actor)
    d.write_performance(out / "performance.npz", performance)
    return out


@pytest.fixture
def job(out, tmp_path):
    (out / PAINTED).unlink(missing_ok=True)
    by_motion_alone = d.SegmentOptions(colour=0)  # there are no videos
    job = reconstruct.Job(tmp_path, out, {"segment": by_motion_alone}, console=Console(quiet=True))
    session = d.Session()
    session.folder, session.scan, session.markers = tmp_path, tmp_path / "scan.ply", tmp_path / "joints.json"
    session.joints = [d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)]
    session.markers.write_text("{}")
    job.session = session
    job.run(["segment"])
    return job


@pytest.fixture
def served(out, job):
    command = [sys.executable, "-m", "doublet", "edit-segmentation", str(out), "--no-browser"]
    listen = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listen)
    yield process.stdout.readline().split()[0], process
    process.kill()
    process.communicate()


def across(browser) -> None:  # noqa: F811
    """Over the tube in the middle of the view, from one side of it to the other."""
    stroke(browser, (-60, 0), (-30, 0), *[(12, 0)] * 15)


def wait_for_regions(browser, text: str) -> None:  # noqa: F811
    WebDriverWait(browser, 30).until(lambda b: b.find_element(By.ID, "regions").text == text)


@pytest.mark.slow
def test_a_border_all_around_parts_two_regions(out, job, served, browser):  # noqa: F811
    url, process = served
    browser.get(url)
    wait_for_status(browser, "Ready")
    assert job.results.segmentation().region_count == 1
    wait_for_regions(browser, "1 region")
    press(browser, "border")
    across(browser)
    for side in ("1.5708", "3.1416", "-1.5708"):
        wait_for_regions(browser, "1 region")
        browser.find_element(By.CSS_SELECTOR, f"[data-turn='{side} 0']").click()
        across(browser)
    wait_for_regions(browser, "2 regions")
    press(browser, "undo")
    wait_for_regions(browser, "1 region")
    across(browser)
    wait_for_regions(browser, "2 regions")
    press(browser, "save")
    wait_for_status(browser, "Saved")
    process.send_signal(signal.SIGINT)
    shown, errors = process.communicate(timeout=30)
    assert process.returncode == 0 and errors == "" and "uses it" in shown

    found = job.results.segmentation()
    assert job.run(["segment"]) and not job.run(["segment"])
    corrected, height = job.results.segmentation(), tube(np.full(ROWS, RADIUS))[:, 1]
    assert corrected.region_count == 2 and (corrected.clothness == found.clothness).all()
    border = height[d.read_segmentation_paint(out, len(height)) == BORDER]
    assert len(border) > AROUND and (np.abs(border - HEIGHT / 2) < 0.1).all()
    parts = [corrected.region[(height > low) & (height < high)] for low, high in ((0.25, 0.45), (0.75, 0.85))]
    assert len(set(parts[0])) == len(set(parts[1])) == 1 and parts[0][0] != parts[1][0]
    assert job.record.data["stages"]["segment"]["summary"]["corrections"] == "painted"

    (out / PAINTED).unlink()
    assert job.run(["segment"])
    assert job.results.segmentation().region_count == 1 and not (out / FOUND).exists()


def test_skin_and_cloth_are_painted_in_any_frame(out, job, served, browser):  # noqa: F811
    url, _ = served
    browser.get(url)
    wait_for_status(browser, "Ready")
    browser.execute_script("const f = document.getElementById('frame'); f.value = f.max; f.oninput();")
    press(browser, "skin")
    stroke(browser, (0, -20))
    press(browser, "save")
    wait_for_status(browser, "Saved")
    found, painted = job.results.segmentation().clothness, d.read_segmentation_paint(out, ROWS * AROUND)
    skin = painted == SKIN
    assert skin.any() and (found[skin] == 1).all() and (tube(np.full(ROWS, RADIUS))[skin, 2] > 0).all()
    assert job.run(["segment"])
    corrected = job.results.segmentation().clothness
    assert (corrected[skin] == 0).all() and (corrected[~skin] == found[~skin]).all()
    # The page goes on from what was painted, and "as found" is what was found, not what came of it.
    shown = json.loads(urllib.request.urlopen(url + "segmentation.json", timeout=30).read())
    assert (np.array(shown["clothness"])[skin] == 1).all()
    errors = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE" and "favicon" not in entry["message"]]
    assert errors == []


def test_what_is_no_paint_is_refused(out, served):
    url, _ = served
    good = json.dumps({"painted": [-1] * (ROWS * AROUND)}).encode()
    assert post(url, "paint", good, Content_Type="text/plain") == 400  # any page may send this
    assert post(url, "paint", b"{") == 400
    assert post(url, "paint", b'{"painted": [0, 1]}') == 400
    assert post(url, "paint", good.replace(b"-1", b"7", 1)) == 400
    assert not (out / PAINTED).exists()
    assert post(url, "paint", good) == 200
    assert (d.read_segmentation_paint(out, ROWS * AROUND) == AS_FOUND).all()


@pytest.mark.parametrize(
    "arrays, said",
    [
        ({"painted": np.zeros(3, np.int8)}, "3 values, not one for each of 600 vertices"),
        ({"painted": np.full(ROWS * AROUND, 4, np.int8)}, "none of -1"),
        ({"paint": np.zeros(ROWS * AROUND, np.int8)}, "painted"),
        ({"painted": np.zeros(ROWS * AROUND, np.int8), "template": np.array("0" * 64)}, "another template.ply"),
    ],
)
def test_a_file_that_does_not_fit_stops_the_stage(out, job, arrays, said):
    np.savez(out / PAINTED, **arrays)
    with pytest.raises(RuntimeError, match=said) as caught:
        job.run(["segment"])
    assert PAINTED in str(caught.value)


def test_without_a_segmentation(tmp_path):
    done = doublet("edit-segmentation", tmp_path, "--no-browser", timeout=30)
    assert done.returncode == 1 and "actor.npz is missing" in done.stderr and "Traceback" not in done.stderr
