"""`doublet view`: its player in WebAssembly beside the native one, and its page in a headless browser, from file://."""

import base64
import io
import json
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from conftest import doublet
from doublet.pages import view
from PIL import Image

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402
from test_edit_template import browser  # noqa: E402, F401

FPS = 40
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def bundle():
    try:
        return view.bundle_folder()
    except RuntimeError as error:
        pytest.skip(f"NOT TESTED, the viewer: {error}")


def tube(radius, low, high, around, rows):
    """Open tube about +Y: vertices, outward faces."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    ring = np.stack([radius * np.sin(turn), np.zeros(around), radius * np.cos(turn)], axis=1)
    vertices = np.concatenate([ring + [0, h, 0] for h in np.linspace(low, high, rows)])
    here = (np.arange(rows - 1)[:, None] * around + np.arange(around)).ravel()
    ahead = (np.arange(rows - 1)[:, None] * around + (np.arange(around) + 1) % around).ravel()
    faces = np.vstack([np.stack([here, ahead, ahead + around], 1), np.stack([here, ahead + around, here + around], 1)])
    return vertices, faces.astype(np.int32)


@pytest.fixture(scope="module")
def character():
    """A column in a skirt."""
    vertices, faces = tube(0.2, 0.4, 1.6, 28, 20)
    marks = [d.JointAnnotation("pelvis", "", [0, 1, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]
    upper = np.clip((vertices[:, 1] - 0.9) / 0.4, 0, 1)
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.stack([1 - upper, upper], 1), d.Skeleton(marks))
    cloth = (vertices[:, 1] < 1).astype(float)
    segmentation = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    body = d.BodyFit()
    body.body, body.model = d.Mesh(*tube(0.16, 0.4, 1.6, 12, 12)), "tube"
    proxies = [d.TaperedCapsule(0, [0, -0.5, 0], [0, 0.1, 0], 0.13, 0.15)]
    high = d.Mesh(*tube(0.2, 0.4, 1.6, 40, 30))
    return d.make_character(actor, segmentation, body, proxies, [d.Material()], d.SolverSettings(1 / FPS), high)


@pytest.fixture(scope="module")
def files(character, tmp_path_factory):
    """Folder with c.glb, and dance.npz of one second."""
    folder = tmp_path_factory.mktemp("view")
    character.write(folder / "c.glb")
    time = np.arange(FPS) / FPS
    dofs = np.zeros((FPS, 9))
    dofs[:, 0], dofs[:, 3], dofs[:, 6] = 0.2 * np.sin(6 * time), 1.5 * np.sin(4 * time), 0.3 * np.sin(9 * time)
    np.savez(folder / "dance.npz", dofs=dofs)
    return folder


def numbers_of(frame):
    return np.concatenate([frame.surface, frame.high, frame.body])


def test_webassembly_plays_what_the_native_player_plays(bundle, files, tmp_path):
    """Without fused multiply-add it rounds otherwise, and a tube that buckles is chaotic. So the native player's cloth goes into
    each step (measured: 0.8 um at the worst vertex of all steps), and of free play it is the first steps that are held
    (0.3 um in the first, 21 um in the fourth; centimetres at the worst vertex after a second)."""
    poses = np.load(files / "dance.npz")["dofs"]
    player = d.Player(d.Character.read(files / "c.glb"), d.AnimateOptions(settle_seconds=0, edge_collision=False))  # as the page
    native, states = [numbers_of(player.reset(poses[0]))], []
    for pose in poses[1:]:
        states.append(np.concatenate([x.ravel() for cloth in player.state.regions for x in (cloth.positions, cloth.velocities)]))
        native.append(numbers_of(player.step(pose)))
    native = np.array(native)
    assert np.linalg.norm(native[-1] - native[0], axis=1).max() > 0.1
    poses.astype("<f8").tofile(tmp_path / "poses")
    np.array(states).tofile(tmp_path / "cloth")

    def played(*cloth):
        files_of = (bundle / "player.mjs", files / "c.glb", tmp_path / "poses", tmp_path / "frames", *cloth)
        done = subprocess.run(["node", HERE / "play_in_node.mjs", *files_of], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[-1000:]
        return np.fromfile(tmp_path / "frames", "<f8").reshape(native.shape)

    def errors(frames):
        return np.abs(frames - native).max(axis=(1, 2))

    assert errors(played(tmp_path / "cloth")).max() < 5e-6
    free = errors(played())
    assert free[:2].max() < 5e-6 and free[:5].max() < 5e-4


# Cloth takes its time to fall into place: the page's clocks go on before there is a first frame.
LATE_START = """
  const post = Worker.prototype.postMessage;
  let last = Promise.resolve();
  Worker.prototype.postMessage = function (message) {
    if (message.how === "reset") last = last.then(() => new Promise((done) => setTimeout(done, 500)));
    last = last.then(() => post.call(this, message));
  };
"""


@pytest.fixture(scope="module")
def page(bundle, files, browser):  # noqa: F811
    done = doublet("view", files / "c.glb", "--clip", files / "dance.npz", "--compare", files / "c.glb", "-o", files / "page")
    assert done.returncode == 0, done.stderr
    browser.set_window_size(500, 420)
    browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": LATE_START})
    browser.get((files / "page" / "index.html").as_uri())
    WebDriverWait(browser, 60).until(lambda _: browser.execute_script("return doubletView.state.actors.length") == 2)
    browser.execute_script("doubletView.stage.lighten(), doubletView.stage.lighten()")  # there is no graphics card
    WebDriverWait(browser, 60).until(lambda _: browser.execute_script("return doubletView.state.time") > 2)
    browser.find_element(By.ID, "fold").click()  # in a window as narrow as a phone's the controls are folded
    return browser


def positions(page, which=0):
    """(V, 3) m of what is drawn of a character's surface."""
    get = f"return Array.from(doubletView.state.actors[{which}].figure.meshes[0].geometry.attributes.position.array)"
    return np.array(page.execute_script(get)).reshape(-1, 3)


def test_the_page_works_from_the_file_system(page, bundle):
    assert page.find_element(By.ID, "status").text == ""
    severe = [entry for entry in page.get_log("browser") if entry["level"] == "SEVERE"]
    assert severe == []
    draw = "doubletView.stage.draw(true); return document.getElementById('stage').toDataURL('image/png').split(',')[1]"
    picture = np.asarray(Image.open(io.BytesIO(base64.b64decode(page.execute_script(draw)))).convert("RGB"), float)
    assert picture.std(axis=(0, 1)).min() > 5 and picture.min() < 120 and picture.max() > 200  # a figure, its shadow, the sky
    assert "ms" in page.find_element(By.ID, "simulated").text
    licences = (bundle / "viewer.js").read_text(encoding="utf-8")[:3000]
    assert "three.js authors" in licences and "permission notice shall be included" in licences


def test_a_slider_changes_the_material_of_one(page):
    before = page.execute_script("return doubletView.state.actors.map(({actor}) => actor.materials[0])")
    page.find_element(By.ID, "k_bend").send_keys(Keys.HOME)
    get = "return doubletView.state.actors.map(({actor}) => actor.materials[0])"  # as the player in WebAssembly has them
    WebDriverWait(page, 20).until(lambda _: page.execute_script(get)[0][2] == 0)
    assert page.execute_script(get)[1] == before[1] and before[0][2] > 0


def test_the_cloth_moves_in_the_wind_while_the_pose_is_held(page):
    page.find_element(By.ID, "hold").click()
    schedule = "return doubletView.state.schedule.slice(-2)"
    time = page.execute_script("return doubletView.state.time")
    WebDriverWait(page, 60).until(lambda _: page.execute_script("return doubletView.state.time") > time + 5)
    assert len(set(page.execute_script(schedule))) == 1
    before = positions(page)
    page.find_element(By.ID, "wind").send_keys(Keys.END)
    time = page.execute_script("return doubletView.state.time")
    WebDriverWait(page, 60).until(lambda _: page.execute_script("return doubletView.state.time") > time + 12)
    moved, skirt = positions(page) - before, before[:, 1] < 0.8
    assert moved[skirt, 2].mean() < -0.03  # blown to the back ...
    assert np.abs(moved[before[:, 1] > 1.1]).max() < 1e-3  # ... and nothing else


def test_what_is_wrong_gets_its_sentence(character, files, tmp_path, monkeypatch):
    other = d.Character.read(files / "c.glb")
    other.solver = d.SolverSettings(1 / 60)
    other.write(tmp_path / "other.glb")
    with pytest.raises(ValueError, match=r"other.glb: expected a character of the same time step as .*, found 0.025 and 0.01"):
        view.write_view(tmp_path / "page", [files / "c.glb", tmp_path / "other.glb"], [], d.RetargetOptions())
    monkeypatch.setenv("DOUBLET_VIEWER_DIR", str(tmp_path))
    with pytest.raises(
        RuntimeError,
        match="expected the viewer's page, found no page.html: this doublet was installed without it; in its sources",
    ):
        view.write_view(tmp_path / "page", [files / "c.glb"], [], d.RetargetOptions())
    assert not (tmp_path / "page").exists()


def test_arms_of_clips_are_kept_out_of_the_body(bundle, files, tmp_path, monkeypatch):
    """Those of a file that is dropped are by player.cpp."""
    monkeypatch.setattr(view.d, "resolve_arm_penetration", lambda _, motion, context: d.Motion(motion.fps, motion.dofs + 1))
    view.write_view(tmp_path, [files / "c.glb"], [files / "dance.npz"], d.RetargetOptions())
    written = json.loads((tmp_path / "data.js").read_text().removeprefix("window.DOUBLET_VIEW = ").rstrip(";\n"))
    (poses,) = written["clips"][0]["poses"]
    np.testing.assert_allclose(np.frombuffer(base64.b64decode(poses), "<f8"), np.load(files / "dance.npz")["dofs"].ravel() + 1)


def test_without_clips_it_turns_if_it_can():
    for dof, most in ((6, view.TURN_ANGLE), (0, 0.0)):
        skeleton = d.Skeleton(
            [d.JointAnnotation("pelvis", "", [0, 1, 0], dof), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]
        )
        still = SimpleNamespace(actor=SimpleNamespace(skeleton=skeleton), solver=d.SolverSettings(1 / FPS))
        assert np.frombuffer(view.turning(still), "<f8").max() == pytest.approx(most)


# --- files that are dropped, keys, time

DROP = """
  const dataTransfer = new DataTransfer(), bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  for (const [name, text] of arguments[0]) dataTransfer.items.add(new File([bytesOf(text)], name));
  const event = (kind) => new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true });
  document.body.dispatchEvent(event("dragover"));
  document.body.dispatchEvent(event("drop"));
"""


def drop(page, *files):
    """files: names and contents, all at once."""
    page.execute_script(DROP, [[name, base64.b64encode(content).decode()] for name, content in zip(files[::2], files[1::2])])


def until(page, expression):
    WebDriverWait(page, 60).until(lambda _: page.execute_script(f"return {expression}"))


@pytest.fixture(scope="module")
def person():
    """Somebody with arms and legs, whom a clip can be retargeted to; the cloth is a band round the hips."""
    sys.path.append(str(HERE.parent / "python"))
    from test_motions import actor_skeleton

    vertices, faces = tube(0.2, 0.4, 1.6, 28, 20)
    skeleton = actor_skeleton()
    weights = np.zeros((len(vertices), len(skeleton.joint_names)))
    weights[:, 0] = 1
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    cloth = (vertices[:, 1] < 0.9).astype(float)
    segmentation = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    return d.make_character(actor, segmentation, d.BodyFit(), [], [d.Material(k_bend=0.25)], d.SolverSettings(1 / FPS))


@pytest.fixture
def own_page(bundle, person, browser, tmp_path):  # noqa: F811
    person.name = "person"
    person.write(tmp_path / "person.glb")
    assert doublet("view", tmp_path / "person.glb", "-o", tmp_path / "page").returncode == 0
    browser.set_window_size(900, 700)
    browser.get((tmp_path / "page" / "index.html").as_uri())
    until(browser, "doubletView.state.time > 2")
    browser.execute_script("doubletView.stage.lighten(), doubletView.stage.lighten()")
    return browser


def test_a_dropped_clip_is_retargeted_as_the_library_does_it(own_page, person, tmp_path):
    skeleton = person.actor.skeleton
    dofs = np.zeros((20, len(skeleton.dof_names)))
    dofs[:, skeleton.dof_names.index("pelvis.tx")] = np.linspace(0, 0.5, 20)
    dofs[:, skeleton.dof_names.index("l_knee.flex")] = np.linspace(0, 0.8, 20)
    d.write_bvh(tmp_path / "dance.bvh", skeleton, d.Motion(FPS, dofs))
    drop(own_page, "dance.bvh", (tmp_path / "dance.bvh").read_bytes())
    until(own_page, "doubletView.state.clip === 1 && doubletView.state.time > 2")
    played = own_page.execute_script("return doubletView.state.actors[0].actor.poses.map((pose) => Array.from(pose))")
    expected = d.retarget(d.SourceMotion.read(tmp_path / "dance.bvh"), skeleton, d.RetargetOptions(fps=FPS)).dofs
    np.testing.assert_allclose(played, expected, atol=1e-6)
    assert own_page.execute_script("return document.getElementById('clip').selectedOptions[0].text") == "dance"


def test_another_character_takes_the_place_of_the_first(own_page, character, files):
    drop(own_page, "other.glb", (files / "c.glb").read_bytes())
    until(own_page, "doubletView.state.actors[0]?.actor.name === 'other' && doubletView.state.time > 1")
    assert len(positions(own_page)) == len(character.high.vertices)
    navy = io.BytesIO()
    Image.new("RGB", (32, 16), "navy").save(navy, "PNG")
    drop(own_page, "no.glb", (files / "c.glb").read_bytes()[:5000], "navy.png", navy.getvalue())
    until(own_page, "document.getElementById('status').classList.contains('problem')")
    until(own_page, "doubletView.state.actors[0].figure.meshes[0].material.map?.image.width === 32")  # the next of them is read


def test_what_is_no_file_of_ours_gets_a_sentence(own_page):
    drop(own_page, "notes.txt", b"nothing")
    until(own_page, "document.getElementById('status').textContent !== ''")
    status = own_page.find_element(By.ID, "status")
    assert status.text == "notes.txt: expected a .bvh, .fbx, .glb, .vrm, .vrma, .png or .jpg"
    assert "problem" in status.get_attribute("class")
    drop(own_page, "arm.fbx", (Path(__file__).parents[1] / "fuzz/corpus/fbx_motion/blender_binary").read_bytes())
    until(own_page, "document.getElementById('status').textContent.startsWith('arm.fbx: expected a human skeleton')")
    drop(own_page, "broken.bvh", b"HIERARCHY\nROOT\n")
    until(own_page, "document.getElementById('status').textContent.startsWith('broken.bvh')")
    drop(own_page, "broken.vrma", b"HIERARCHY\nROOT\n")
    until(own_page, "document.getElementById('status').textContent.startsWith('broken.vrma: expected a GLB')")
    for name, content in (("short.glb", b"glTF"), ("broken.png", b"nothing")):
        drop(own_page, name, content)
        until(own_page, f"document.getElementById('status').textContent.startsWith('{name}: ')")


def test_space_pauses_and_the_timeline_leads_anywhere(own_page):
    body = own_page.find_element(By.TAG_NAME, "body")
    body.send_keys(Keys.SPACE)
    assert own_page.find_element(By.ID, "play").text == "Play"
    body.send_keys(Keys.SPACE)
    assert own_page.find_element(By.ID, "play").text == "Pause"
    lead = "const line = document.getElementById('timeline'); line.value = 90; line.dispatchEvent(new Event('change'));"
    own_page.execute_script(lead)
    until(own_page, "doubletView.state.schedule[0] === 90 && doubletView.state.time > 1")


def test_a_dropped_picture_and_a_saved_material(own_page):
    keep = "URL.createObjectURL = (blob) => (blob.text().then((text) => (window.saved = JSON.parse(text))), 'blob:none');"
    own_page.execute_script(keep)
    own_page.execute_script(
        "[...document.querySelectorAll('button')].find((b) => b.textContent === 'Save material').onclick(); return 1"
    )
    until(own_page, "window.saved")
    assert own_page.execute_script("return window.saved.regions[0].parameters.k_bend") == 0.25
    content = io.BytesIO()
    Image.new("RGB", (32, 16), "navy").save(content, "PNG")
    drop(own_page, "navy.png", content.getvalue())
    until(own_page, "doubletView.state.actors[0].figure.meshes[0].material.map?.image.width === 32")


def test_the_panel_is_of_the_one_that_is_chosen(own_page, person, tmp_path):
    """After a clip was dropped, too. A second one that is loading cannot be taken away."""
    own_page.execute_script("for (const _ of [1, 2]) document.getElementById('compare').click()")
    until(own_page, "doubletView.state.actors.length === 2 && document.getElementById('compare').checked")
    pressed = "return [...document.querySelectorAll('[aria-pressed]')].map((b) => b.ariaPressed)"
    assert own_page.execute_script(pressed) == ["true", "false"]
    own_page.find_elements(By.CSS_SELECTOR, "[aria-pressed]")[1].click()
    assert own_page.execute_script(pressed) == ["false", "true"]
    skeleton = person.actor.skeleton
    d.write_bvh(tmp_path / "still.bvh", skeleton, d.Motion(FPS, np.zeros((9, len(skeleton.dof_names)))))
    drop(own_page, "still.bvh", (tmp_path / "still.bvh").read_bytes())
    until(own_page, "doubletView.state.clip === 1")
    assert own_page.execute_script(pressed) == ["false", "true"]
    own_page.find_element(By.ID, "k_bend").send_keys(Keys.HOME)
    until(own_page, "doubletView.state.actors[1].actor.materials[0][2] === 0")
    assert own_page.execute_script("return doubletView.state.actors[0].actor.materials[0][2]") == 0.25


def test_a_character_without_cloth_has_no_material(bundle, person, browser, tmp_path):  # noqa: F811
    nothing = np.zeros(len(person.actor.mesh.vertices))
    skin = d.Segmentation(nothing, nothing, np.full(len(nothing), -1, np.int32))
    d.make_character(person.actor, skin, d.BodyFit(), [], [], person.solver).write(tmp_path / "skin.glb")
    assert doublet("view", tmp_path / "skin.glb", "-o", tmp_path / "page").returncode == 0
    browser.get_log("browser")  # of pages before
    browser.get((tmp_path / "page" / "index.html").as_uri())
    until(browser, "doubletView.state.time > 2 && document.getElementById('timeline').max > 0")
    assert browser.execute_script("return document.getElementById('k_bend')") is None
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


@contextmanager
def scripted(browser, source):  # noqa: F811
    """Pages that are opened meanwhile run this first."""
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": source})
    yield
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)


def walk(skeleton, path):
    """Two metres in a second."""
    dofs = np.zeros((FPS, len(skeleton.dof_names)))
    dofs[:, skeleton.dof_names.index("pelvis.tx")] = np.linspace(0, 2, FPS)
    d.write_bvh(path, skeleton, d.Motion(FPS, dofs))
    return path.read_bytes()


def test_cloth_comes_along_when_a_clip_that_began_in_the_middle_begins_again(own_page, person, tmp_path):
    drop(own_page, "walk.bvh", walk(person.actor.skeleton, tmp_path / "walk.bvh"))
    until(own_page, "doubletView.state.clip === 1 && doubletView.state.time > 2")
    own_page.execute_script(
        """const { actor } = doubletView.state.actors[0], arrive = actor.on_frame.bind(actor);
        window.how = [];
        actor.on_frame = (message) => (window.how.push(message.how), arrive(message));
        const line = document.getElementById("timeline");
        line.value = 30;
        line.dispatchEvent(new Event("change"));"""
    )
    until(own_page, "window.how.includes('beginAgain')")
    how = [one for one in own_page.execute_script("return window.how.slice(window.how.indexOf('reset'))") if one != "step"]
    assert how == ["reset", "reset", "beginAgain"]  # what is kept of the first is of another pose


def test_files_of_two_drops_are_taken_one_after_the_other(own_page, files):
    for name in ("one.glb", "two.glb"):
        drop(own_page, name, (files / "c.glb").read_bytes())
    until(own_page, "doubletView.state.actors[0]?.actor.name === 'two' && doubletView.state.time > 1")
    assert own_page.execute_script("return doubletView.state.actors.length") == 1


def test_clips_that_another_character_cannot_dance_go(own_page, person, files, tmp_path):
    drop(own_page, "walk.bvh", walk(person.actor.skeleton, tmp_path / "walk.bvh"))
    until(own_page, "doubletView.state.clip === 1")
    drop(own_page, "column.glb", (files / "c.glb").read_bytes())
    until(own_page, "doubletView.state.actors[0]?.actor.name === 'column' && doubletView.state.time > 1")
    assert own_page.find_element(By.ID, "clip").text == "to and fro"
    assert own_page.find_element(By.ID, "status").text.startswith("walk: skeleton: expected a human skeleton")


def test_what_is_not_shown_any_more_is_freed(own_page):
    kept = "const { geometries, textures } = doubletView.stage.renderer.info.memory; return [geometries, textures]"
    before = own_page.execute_script(kept)
    for count in (2, 1):
        own_page.find_element(By.ID, "compare").click()
        until(own_page, f"doubletView.state.actors.length === {count} && doubletView.state.time > 1")
    own_page.execute_script("doubletView.stage.draw(true)")
    assert own_page.execute_script(kept) == before


EVEN_CLOCK = """
  let clock;
  const frame = window.requestAnimationFrame.bind(window), now = performance.now.bind(performance);
  performance.now = () => clock ?? now();
  window.requestAnimationFrame = (call) => frame((time) => call((clock = (clock ?? time) + 16)));
  window.away = () => (clock += 60000, document.dispatchEvent(new Event("visibilitychange")));
"""


def test_time_in_which_nothing_was_to_be_drawn_makes_no_coarser_pictures(bundle, files, browser):  # noqa: F811
    """Loading, and another tab."""
    assert doublet("view", files / "c.glb", "-o", files / "even").returncode == 0
    with scripted(browser, EVEN_CLOCK):
        browser.get((files / "even" / "index.html").as_uri())
        until(browser, "doubletView.state.pictures.length > 20 || doubletView.stage.quality > 0")
        assert browser.execute_script("return doubletView.stage.quality") == 0
        browser.execute_script("window.away()")
        until(browser, "doubletView.state.pictures.length > 50 || doubletView.stage.quality > 0")
        assert browser.execute_script("return doubletView.stage.quality") == 0


def test_a_browser_that_cannot_draw_says_so(bundle, files, browser):  # noqa: F811
    assert doublet("view", files / "c.glb", "-o", files / "undrawn").returncode == 0
    with scripted(browser, "HTMLCanvasElement.prototype.getContext = () => null"):
        browser.get((files / "undrawn" / "index.html").as_uri())
        until(browser, "document.getElementById('status').classList.contains('problem')")
        assert "WebGL" in browser.find_element(By.ID, "status").text
    (files / "undrawn" / "data.js").unlink()
    browser.get((files / "undrawn" / "index.html").as_uri())
    until(browser, "document.getElementById('status').classList.contains('problem')")
    assert "data.js" in browser.find_element(By.ID, "status").text
