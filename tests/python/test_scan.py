"""Scan and joints out of the cameras alone: a known body, seen by a ring of cameras."""

import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet import body_model_path
from doublet.cli import main
from doublet.common.scan_frame import scan_frame
from doublet.pages import edit_joints
from doublet.scan import make_scan
from doublet.session import keypoints
from PIL import Image

SHIPPED = Path(__file__).parents[2] / "examples" / "data" / "session"
FAST = ["--body-iterations", "6", "--scan-cell", "0.012", "--scan-poisson-depth", "7", "--scan-search-depth", "0", "--quiet"]


@pytest.fixture(scope="module")
def model() -> d.BodyModel:
    return d.BodyModel.read(body_model_path())


class Person:
    """Somebody of the model, turned and moved."""

    def __init__(self, model: d.BodyModel, yaw: float, seed: int):
        s = np.zeros(model.component_count)
        s[:8] = np.random.default_rng(seed).normal(size=8)
        c, n = np.cos(yaw), np.sin(yaw)
        self.turn, self.move = np.array([[c, 0, n], [0, 1, 0], [-n, 0, c]]), np.array([0.2, 0.9, -0.3])
        self.mesh = d.Mesh(self.world(model.vertices(s)), model.faces)
        self.joints = dict(zip(model.joint_names, self.world(model.joints(s)[0])))
        self.joints["chest"] = (self.joints["chest"] + self.joints["neck"]) / 2  # where the clavicles part
        self.joints["spine"] = self.joints["spine2"]

    def world(self, points):
        return np.asarray(points) @ self.turn.T + self.move

    def errors_mm(self, positions: dict) -> dict:
        return {n: 1000 * np.linalg.norm(np.ravel(p) - self.joints[n]) for n, p in positions.items() if n in self.joints}


def write_session(folder, person: Person, cameras: int = 8, size: int = 300, before=()):
    """before: meshes of the frames before the person's; with any, the person stands for two frames."""
    folder.mkdir()
    meshes = [*before, person.mesh, person.mesh] if before else [person.mesh]
    rig = []
    for c in range(cameras):
        camera = d.orbit_camera([0.2, 0.9, -0.3], 1.0, 2 * np.pi * (c + 0.3) / cameras, 0.15, size, size)
        camera.name = f"cam{c}"
        rig.append(camera)
        (folder / "masks" / camera.name).mkdir(parents=True)
        for t, mesh in enumerate(meshes):
            mask = d.rasterize(mesh.vertices, mesh.faces, camera)[0] >= 0
            Image.fromarray(mask.astype(np.uint8) * 255).save(folder / "masks" / camera.name / f"{t:04d}.png")
    d.write_calibration(folder / "calibration.yml", rig)
    described = {"name": "ring", "fps": 30, "frame_count": len(meshes), "calibration": "calibration.yml"}
    described["cameras"] = [{"name": c.name, "masks": f"masks/{c.name}/%04d.png"} for c in rig]
    (folder / "session.json").write_text(json.dumps(described), encoding="utf-8")
    return folder


@pytest.mark.parametrize(("yaw", "seed"), [(0.4, 1), (2.9, 2)])
def test_joints_are_found_whichever_way_the_person_faces(model, yaw, seed):
    person = Person(model, yaw, seed)
    marks = d.detect_joints(person.mesh, [], model, d.BodyFitOptions(iterations=8))
    assert marks.facing_ambiguity < 0.7
    assert marks.fit.residual < 0.002
    errors = person.errors_mm({mark.name: mark.position for mark in marks.joints})
    assert len(errors) == 21
    assert max(errors.values()) < 20, errors
    assert set(marks.landmarks) >= {"head_top", "nose_tip", "l_heel", "r_big_toe_tip"}
    assert len(d.Skeleton(marks.joints).dof_names) == 36


def test_a_wide_garment_does_not_turn_the_person_round(model):
    """Front and back look the same in it: only feet and hands that stand out of the surface tell."""
    person = Person(model, 5.2, 5)
    vertices, joints = np.array(person.mesh.vertices), person.joints
    bare = np.any([np.linalg.norm(vertices - joints[wrist], axis=1) < 0.22 for wrist in ("l_wrist", "r_wrist")], axis=0)
    worn = (vertices[:, 1] > joints["l_knee"][1] + 0.1) & (vertices[:, 1] < joints["neck"][1] - 0.03) & ~bare
    dressed = vertices + 0.08 * worn[:, None] * d.vertex_normals(vertices, person.mesh.faces) * [1, 0.2, 1]
    marks = d.detect_joints(d.Mesh(dressed, person.mesh.faces), [], model, d.BodyFitOptions(iterations=8))
    assert marks.facing_ambiguity < 0.3
    assert max(person.errors_mm({mark.name: mark.position for mark in marks.joints}).values()) < 60


@pytest.mark.parametrize(("yaw", "seed"), [(0.4, 1), (2.9, 2)])
def test_folds_of_clothes_do_not_move_the_joints(model, yaw, seed):
    """Clothes from the knees to the neck and to the wrists hang 15 mm off and have folds 12 cm apart: no shape of a body."""
    person = Person(model, yaw, seed)
    vertices, joints, rng = np.array(person.mesh.vertices), person.joints, np.random.default_rng(seed)
    hands = np.any([np.linalg.norm(vertices - joints[wrist], axis=1) < 0.15 for wrist in ("l_wrist", "r_wrist")], axis=0)
    worn = (vertices[:, 1] > joints["l_knee"][1] + 0.1) & (vertices[:, 1] < joints["neck"][1] - 0.03) & ~hands
    waves = [np.sin(2 * np.pi / 0.12 * vertices @ rng.normal(size=3) + rng.uniform(0, 6)) for _ in range(6)]
    off = (0.015 + 0.01 * np.sum(waves, axis=0) / np.sqrt(6))[:, None] * d.vertex_normals(vertices, person.mesh.faces)
    dressed = d.Mesh(vertices + worn[:, None] * (off - [0, 0.015, 0]), person.mesh.faces)
    marks = d.detect_joints(dressed, [], model, d.BodyFitOptions(iterations=8))
    assert max(person.errors_mm({mark.name: mark.position for mark in marks.joints}).values()) < 25


def test_a_corner_of_a_garment_is_no_hand(model):
    person = Person(model, 0.4, 1)
    vertices, joints = np.array(person.mesh.vertices), person.joints
    behind = -person.turn[:, 2]
    seat = vertices[np.argmax(vertices @ behind - 10 * np.abs(vertices[:, 1] - joints["pelvis"][1]))]
    near = np.exp(-np.sum((vertices - seat) ** 2, axis=1) / 0.05**2)
    marks = d.detect_joints(
        d.Mesh(vertices + 0.65 * near[:, None] * behind, person.mesh.faces), [], model, d.BodyFitOptions(iterations=8)
    )
    assert max(person.errors_mm({mark.name: mark.position for mark in marks.joints}).values()) < 30


def test_no_person_no_joints(model):
    ball = d.capsule_mesh([0, 0.5, 0], [0, 1.5, 0], 0.3, 0.3)
    loose = d.Mesh(np.vstack([ball.vertices, [[0, 1, 0]]]), ball.faces)  # a vertex on no face, in the middle
    for surface in (ball, loose):
        with pytest.raises(d.Error, match="joint detection: expected a person, upright"):
            d.detect_joints(surface, [], model)
    with pytest.raises(ValueError, match="face_valid: expected"):
        d.detect_joints(ball, [1, 0], model)
    hole = d.Mesh(np.where(np.arange(len(ball.vertices))[:, None] == 7, np.nan, ball.vertices), ball.faces)
    with pytest.raises(d.Error, match="1 non-finite vertices"):
        d.detect_joints(hole, [], model)
    with pytest.raises(d.Error, match="corners in range"):
        d.detect_joints(d.Mesh(ball.vertices, ball.faces + 3), [], model)


@pytest.fixture(scope="module")
def scanned(model, tmp_path_factory):
    """A person, and the session of it that the command has completed."""
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path_factory.mktemp("scanned") / "session", person)
    assert main(["scan", str(folder), *FAST]) in (0, 3)
    return person, folder


@pytest.fixture
def session_with_scan(scanned, tmp_path):
    """A copy, to be changed."""
    return shutil.copytree(scanned[1], tmp_path / "session")


def test_without_a_scan_the_command_that_makes_it_is_named(model, tmp_path, capsys):
    folder = write_session(tmp_path / "session", Person(model, 0.7, 3))
    assert main(["reconstruct", str(folder), "-o", str(tmp_path / "out"), "--quiet"]) == 1
    assert "`doublet scan` makes scan and joints from the cameras" in capsys.readouterr().err


def test_the_command_completes_a_session(scanned, capsys):
    person, folder = scanned
    session = d.Session(folder)
    assert session.scan_from_views
    surface = d.RayScene(person.mesh)
    assert surface.closest(d.read_mesh(session.scan).vertices)[1].mean() < 0.012
    errors = person.errors_mm({mark.name: mark.position for mark in session.joints})
    assert np.mean(list(errors.values())) < 25, errors
    assert Image.open(folder / "scan_check.png").size[0] > 300
    assert main(["scan", str(folder), *FAST]) == 1
    assert "names a scan and joints already; --force makes them anew" in capsys.readouterr().err


@pytest.mark.slow
def test_the_best_frame_is_found_and_the_take_stays_whole(model, tmp_path, capsys):
    person = Person(model, 0.7, 3)
    ball = d.capsule_mesh([0.2, 0.5, -0.3], [0.2, 1.2, -0.3], 0.3, 0.3)
    folder = write_session(tmp_path / "session", person, before=[ball, ball])
    before = (folder / "session.json").read_text(encoding="utf-8")
    assert main(["scan", str(folder), *FAST, "--frame", "4"]) == 1
    assert "--frame: expected 0 to 3, found 4" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["scan", str(folder), *FAST, "--frame", "last"])
    assert "expected the number of a frame, or best, found 'last'" in capsys.readouterr().err
    assert (folder / "session.json").read_text(encoding="utf-8") == before
    assert main(["scan", str(folder), *FAST, "--frame", "best"]) in (0, 3)
    session = d.Session(folder)
    assert session.frame_count == 4 and scan_frame(session) in (2, 3)
    assert np.mean(list(person.errors_mm({mark.name: mark.position for mark in session.joints}).values())) < 25
    found = d.find_start_frame(d.read_mesh(session.scan), session.rig, d.FrameSource.open(session))
    assert found.frame in (2, 3) and found.in_scan_pose  # where tracking starts


@pytest.mark.parametrize("frame", [1, -1, 0.5, True, "first", None])
def test_a_frame_of_the_scan_that_is_none_is_refused(session_with_scan, frame):
    described = json.loads((session_with_scan / "session.json").read_text(encoding="utf-8"))
    assert described["scan_frame"] == 0 == scan_frame(d.Session(session_with_scan))
    (session_with_scan / "session.json").write_text(json.dumps({**described, "scan_frame": frame}), encoding="utf-8")
    with pytest.raises(RuntimeError, match="scan_frame: expected a whole number from 0 to 0, found"):
        scan_frame(d.Session(session_with_scan))


def test_only_what_is_missing_is_made(model, tmp_path, capsys):
    person = Person(model, 0.0, 4)
    folder = write_session(tmp_path / "session", person)
    d.write_mesh(folder / "own.ply", person.mesh)
    described = json.loads((folder / "session.json").read_text(encoding="utf-8"))
    (folder / "session.json").write_text(json.dumps({**described, "scan": "own.ply"}), encoding="utf-8")
    (folder / "joints.json").write_text("mine", encoding="utf-8")
    assert main(["scan", str(folder), *FAST]) == 1
    assert "joints.json exists, but session.json does not name it" in capsys.readouterr().err
    assert (folder / "joints.json").read_text(encoding="utf-8") == "mine"
    (folder / "joints.json").unlink()
    assert main(["scan", str(folder), *FAST, "--given", "raw.ply"]) == 1
    assert "--given: " in capsys.readouterr().err
    assert main(["scan", str(folder), *FAST]) == 0
    assert d.Session(folder).scan.name == "own.ply"
    assert not (folder / "scan.ply").exists()


def test_too_few_cameras(model, tmp_path, capsys):
    folder = write_session(tmp_path / "session", Person(model, 0.0, 5), cameras=2)
    before = (folder / "session.json").read_text(encoding="utf-8")
    assert main(["scan", str(folder), *FAST]) == 1
    assert "scan: expected the actor in at least 3 cameras, found 2 of 2 with a silhouette" in capsys.readouterr().err
    assert (folder / "session.json").read_text(encoding="utf-8") == before


def test_what_begins_with_a_byte_order_mark_is_read(model, tmp_path):
    """As some editors write it."""
    marks = tmp_path / "joints.json"
    marks.write_text("\ufeff" + json.dumps({"joints": {"pelvis": {"position": [0, 1, 0], "parent": None}}}), encoding="utf-8")
    assert edit_joints.read_marks(marks)["joints"].keys() == {"pelvis"}
    edit_joints.save_joints(marks, json.dumps({"joints": {"pelvis": [0, 2, 0]}, "landmarks": {}}).encode())
    assert json.loads(marks.read_text())["joints"]["pelvis"]["position"] == [0, 2, 0]
    folder = write_session(tmp_path / "session", Person(model, 0.7, 3), cameras=2)
    described = (folder / "session.json").read_text()
    (folder / "session.json").write_text("\ufeff" + described, encoding="utf-8")
    assert make_scan.read_description(folder) == json.loads(described)


def test_joints_that_somebody_moves_on_the_page_are_not_found_ones(tmp_path):
    """So that --refine leaves them."""
    marks = tmp_path / "joints.json"
    found = {
        "comment": f"{make_scan.FOUND} with a body",
        "joints": {"pelvis": {"position": [0, 1, 0]}},
        "landmarks": {"heel": [0, 0, 0]},
    }
    marks.write_text(json.dumps(found))

    def saved(pelvis: list, heel: list) -> str:
        edit_joints.save_joints(marks, json.dumps({"joints": {"pelvis": pelvis}, "landmarks": {"heel": heel}}).encode())
        return json.loads(marks.read_text())["comment"]

    assert saved([0, 1, 0], [0, 0, 0]) == found["comment"] and make_scan.found_here(marks)  # nothing moved
    assert saved([0, 1, 0], [0, 0, 0.01]) == f"corrected by hand; {found['comment']}" and not make_scan.found_here(marks)
    assert saved([0, 2, 0], [0, 0, 0.01]) == f"corrected by hand; {found['comment']}"
    marks.write_text(json.dumps({**found, "comment": None}))
    assert not make_scan.found_here(marks)


def write_keypoints(folder, session: d.Session, person: Person, kind: str) -> None:
    """The model's own joints as each camera sees them, in its images; one camera has left and right exchanged, in another nobody
    is sure."""
    folder.mkdir()
    for i, camera in enumerate(session.rig):
        seen = []
        for name in keypoints.JOINTS:
            side = {"l": "r", "r": "l"}[name[0]] if i == 1 else name[0]
            seen.append([*np.ravel(camera.project(person.joints[side + name[1:]])), 0.1 if i == 2 else 0.9])
        count = {"openpose": 25, "rtmpose": 17, "mediapipe": 33}[kind]
        points = np.zeros((count, 3))
        points[list(keypoints.LAYOUTS[count])] = seen
        if kind == "openpose":
            (folder / f"{camera.name}_json").mkdir()
            nobody = {"pose_keypoints_2d": [0.0] * 75}
            people = {"people": [nobody, {"pose_keypoints_2d": points.ravel().tolist()}]}
            (folder / f"{camera.name}_json" / "take_000000000000_keypoints.json").write_text(json.dumps(people))
        elif kind == "rtmpose":
            found = {"keypoints": points[:, :2].tolist(), "keypoint_scores": points[:, 2].tolist()}
            content = {"instance_info": [{"frame_id": 1, "instances": [found]}]}
            (folder / f"{camera.name}.json").write_text(json.dumps(content))
        else:
            (folder / f"{camera.name}.json").write_text(json.dumps([points.tolist()]))


@pytest.mark.parametrize("kind", ["openpose", "rtmpose", "mediapipe"])
def test_keypoints_of_all_cameras_are_triangulated(model, tmp_path, kind):
    person = Person(model, 0.7, 3)
    session = d.Session(write_session(tmp_path / "session", person, cameras=5, before=[person.mesh]))
    write_keypoints(tmp_path / "keypoints", session, person, kind)
    found, messages = keypoints.kept_joints(keeping(session, tmp_path / "keypoints"), 0), []
    assert found.keys() == set(keypoints.JOINTS)
    assert max(person.errors_mm(found).values()) < 1
    of_files = keypoints.triangulated(session, tmp_path / "keypoints", 0)
    assert all(np.abs(of_files[name] - point).max() < 1e-4 for name, point in found.items())  # a session keeps them as floats
    with pytest.raises(ValueError, match=r"keypoints: frame 1: expected at least 6 joints .* found 0"):
        keypoints.adopt_keypoints(session, tmp_path / "keypoints", 1, messages)
    assert len(messages) == 5 and messages[0].endswith("keypoints of 1 of 3 frames")


def test_cameras_that_are_late_show_a_frame_later(model, tmp_path):
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person, cameras=5, before=[person.mesh])
    early = [d.CalibratedCamera(camera, late=-1) for camera in d.Session(folder).rig]  # frame 1 of the session is their first
    d.write_calibration(folder / "calibration.yml", early)
    write_keypoints(tmp_path / "keypoints", d.Session(folder), person, "mediapipe")
    found = keypoints.kept_joints(keeping(d.Session(folder), tmp_path / "keypoints", frame=1), 1)
    assert max(person.errors_mm(found).values()) < 1
    with pytest.raises(ValueError, match="frame 0: expected at least 6 joints .* found 0"):
        keypoints.adopt_keypoints(d.Session(folder), tmp_path / "keypoints", 0, [])


def keeping(session: d.Session, path, frame: int = 0) -> d.Session:
    """The session once it has adopted these keypoints."""
    file = session.folder / "session.json"
    described = json.loads(file.read_text(encoding="utf-8"))
    described["keypoints"] = keypoints.adopt_keypoints(session, path, frame, [])
    file.write_text(json.dumps(described), encoding="utf-8")
    return d.Session(session.folder)


def test_lenses_do_not_bend_what_is_triangulated(model, tmp_path):
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person, cameras=4)
    rig = [bent(camera) for camera in d.Session(folder).rig]
    d.write_calibration(folder / "calibration.yml", rig)
    write_keypoints(tmp_path / "keypoints", d.Session(folder), person, "mediapipe")
    found = keypoints.kept_joints(keeping(d.Session(folder), tmp_path / "keypoints"), 0)
    assert max(person.errors_mm(found).values()) < 1


def bent(camera: d.Camera) -> d.Camera:
    camera.distortion = np.array([-0.2, 0.05, 0.001, 0.0, 0.0])
    return camera


@pytest.mark.slow
def test_joints_come_from_keypoints_where_arms_hang(model, tmp_path, capsys):
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person)
    person.joints["l_knee"] = person.joints["l_knee"] + [0, 0, 0.1]  # as if the network saw it there
    write_keypoints(tmp_path / "keypoints", d.Session(folder), person, "mediapipe")
    assert main(["scan", str(folder), *FAST, "--keypoints", str(tmp_path / "keypoints")]) in (0, 3)
    errors = person.errors_mm({mark.name: mark.position for mark in d.Session(folder).joints})
    assert np.mean(list(errors.values())) < 25 and errors["l_knee"] < 1, errors
    capsys.readouterr()
    assert main(["scan", str(folder), *FAST, "--keypoints", str(tmp_path / "keypoints")]) in (0, 3)  # anew, beside what is there
    assert capsys.readouterr().out.split("\n")[0] == str(folder / "keypoints.npz")
    assert main(["scan", str(folder), "--refine", str(folder), "--keypoints", str(tmp_path / "keypoints")]) == 1
    assert "--keypoints: expected no --refine beside it" in capsys.readouterr().err


@pytest.fixture
def shipped(tmp_path):
    """A copy of a session with a scan and joints; its videos are links."""
    folder = shutil.copytree(SHIPPED, tmp_path / "shipped", ignore=shutil.ignore_patterns("ground_truth", "*.mp4"))
    for video in (SHIPPED / "videos").iterdir():
        (folder / "videos" / video.name).symlink_to(video)
    return folder


def test_keypoints_are_looked_at_in_the_frame_of_the_scan(shipped, monkeypatch):
    """That is there already; in the first frame nobody may be seen."""
    described = json.loads((shipped / "session.json").read_text(encoding="utf-8"))
    (shipped / "session.json").write_text(json.dumps({**described, "scan_frame": 31}), encoding="utf-8")
    looked_at = []
    monkeypatch.setattr(make_scan, "adopt_keypoints", lambda _, __, frame, ___: looked_at.append(frame) or "keypoints.npz")
    for name in ("save", "with_check_picture"):
        monkeypatch.setattr(make_scan, name, lambda *_: None)
    job = SimpleNamespace(session_folder=shipped, session=d.Session(shipped))
    make_scan.scan_session(job, keypoints=Path("keypoints"))
    assert looked_at == [31]
    with pytest.raises(RuntimeError, match="names a scan already; --force makes another at --frame"):
        make_scan.scan_session(job, keypoints=Path("keypoints"), frame=0)


@pytest.mark.parametrize(("flag", "value"), [("--given", "raw.ply"), ("--frame", "0")])
def test_what_refining_does_not_look_at_is_refused(shipped, capsys, flag, value):
    assert main(["scan", str(shipped), "--refine", str(shipped), flag, value]) == 1
    assert f"{flag}: expected no --refine beside it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "expected JSON"),
        ("[" * 100000, "cam0.json: expected JSON, found brackets inside of brackets without end"),
        ('{"a": 1}', "expected keypoints (a list of frames"),
        ('[{"image_id": "0.jpg", "keypoints": [1, 2, 1]}]', "expected 17, 18, 25"),
        ('[{"image_name": "0.jpg", "keypoints": [1, 2, 1]}]', "found an entry of image_name, keypoints"),
        ("[[[1, 2, 1], [3, 4, 1]]]", "136, 308 keypoints of x, y and confidence, found (2, 3)"),
        ("[1.0]", "136, 308 keypoints of x, y and confidence, found (1,)"),
        ('[[["x", 2, 1]]]', "expected 17, 18, 25"),
        ("[null]", "frame 0: expected at least 6 joints that two cameras agree on, found 0"),
    ],
)
def test_wrong_keypoints_are_named(model, tmp_path, content, words):
    session = d.Session(write_session(tmp_path / "session", Person(model, 0.0, 5), cameras=3))

    def adopt(name: str) -> None:
        keypoints.adopt_keypoints(session, tmp_path / name, 0, [])

    with pytest.raises(FileNotFoundError, match="expected a folder with the keypoints"):
        adopt("nowhere")
    (tmp_path / "keypoints").mkdir()
    with pytest.raises(FileNotFoundError, match="expected a JSON file, or a folder of them"):
        adopt("keypoints")
    for camera in session.cameras:
        (tmp_path / "keypoints" / f"{camera.name}.json").write_text(content)
    with pytest.raises((RuntimeError, ValueError), match=re.escape(words)):
        adopt("keypoints")
    (tmp_path / "keypoints" / f"{session.cameras[0].name}.json").unlink()
    with pytest.raises(
        ValueError, match="expected one file or folder of keypoints for each camera, by name, found none for cam0"
    ):
        adopt("keypoints")


def tracked(session: d.Session, out, outwards: float) -> None:
    """OUT as after `segment`: a template of the scan, and frames in which it stands as it is, only so much thicker."""
    out.mkdir()
    surface = d.build_template(d.read_mesh(session.scan), d.TemplateOptions(poisson_depth=7, triangles=1500))
    actor = d.rig_template(surface, session.joints)
    d.write_actor(out / "actor.npz", actor)
    actor = d.read_actor(out / "actor.npz")
    rest = actor.mesh.vertices
    performance = d.ReferencePerformance()
    thicker = rest + outwards * d.vertex_normals(rest, actor.mesh.faces)
    performance.surface = d.MeshSequence(actor.mesh.faces, np.array([thicker] * 4))
    performance.dofs = np.zeros((4, len(actor.skeleton.dof_names)))
    performance.joints = [actor.skeleton.joint_positions(performance.dofs[0])] * 4
    performance.frames = range(4)
    d.write_performance(out / "performance.npz", performance)
    nothing = np.zeros(len(rest))
    d.write_segmentation(out / "segmentation.npz", d.Segmentation(nothing, nothing, np.full(len(rest), -1)))


@pytest.mark.slow
def test_a_scan_that_was_deleted_is_made_anew_and_another_that_is_lost_is_said(session_with_scan):
    (session_with_scan / "scan.ply").unlink()
    with pytest.raises(FileNotFoundError, match="the scan that"):
        d.Session(session_with_scan)
    assert "scan" not in make_scan.read_description(session_with_scan)  # and so "wanted"
    assert not d.Session(session_with_scan).scan.name and d.Session(session_with_scan).markers.name == "joints.json"
    description = json.loads((session_with_scan / "session.json").read_text(encoding="utf-8"))
    description["scan"] = "laser.ply"
    (session_with_scan / "session.json").write_text(json.dumps(description), encoding="utf-8")
    with pytest.raises(FileNotFoundError, match="laser.ply"):
        make_scan.read_description(session_with_scan)


def test_a_scan_is_refined_by_what_was_tracked(session_with_scan, tmp_path):
    folder, out = session_with_scan, tmp_path / "out"
    first = d.read_mesh(folder / "scan.ply")
    tracked(d.Session(folder), out, 0.008)
    marks = (folder / "joints.json").read_text()
    assert main(["scan", str(folder), *FAST, "--refine", str(out)]) in (0, 3)
    refined = d.read_mesh(folder / "scan.ply")
    moved = ((refined.vertices - first.vertices) * d.vertex_normals(first.vertices, first.faces)).sum(axis=1)
    assert 0.006 < np.median(moved) < 0.009
    assert (d.read_mesh(folder / "scan_before.ply").vertices == first.vertices).all()
    assert (folder / "joints.json").read_text() != marks
    # Joints that somebody has moved stay, and so does the first scan.
    by_hand = json.loads(marks) | {"comment": "by hand"}
    (folder / "joints.json").write_text(json.dumps(by_hand))
    assert main(["scan", str(folder), *FAST, "--refine", str(out)]) in (0, 3)
    assert json.loads((folder / "joints.json").read_text()) == by_hand
    assert (d.read_mesh(folder / "scan_before.ply").vertices == first.vertices).all()
    assert (d.read_mesh(folder / "scan.ply").vertices == refined.vertices).all(), "it was corrected twice"


def test_a_scan_that_cannot_be_written_is_refined_into_another(session_with_scan, tmp_path, monkeypatch):
    folder, out = session_with_scan, tmp_path / "out"
    tracked(d.Session(folder), out, 0.008)
    path, scan = folder / "session.json", folder / "scan.obj"
    d.write_mesh(scan, d.read_mesh(folder / "scan.ply"))
    (folder / "scan.ply").unlink()
    path.write_text(json.dumps(json.loads(path.read_text()) | {"scan": scan.name}))
    monkeypatch.setattr(make_scan, "WRITTEN", (".ply",))  # as .glb is read alone
    before = scan.read_bytes()
    assert main(["scan", str(folder), *FAST, "--refine", str(out)]) in (0, 3)
    assert json.loads(path.read_text())["scan"] == "scan.ply" and (folder / "scan.ply").exists()
    assert scan.read_bytes() == before


def test_without_a_scan_nothing_is_refined(model, tmp_path, capsys):
    folder = write_session(tmp_path / "session", Person(model, 0.7, 3))
    assert main(["scan", str(folder), "--refine", str(tmp_path / "out")]) == 1
    assert "names no scan to refine; doublet scan makes one" in capsys.readouterr().err


def test_what_was_tracked_with_another_scan_refines_nothing(session_with_scan, tmp_path, capsys):
    folder, out = session_with_scan, tmp_path / "out"
    tracked(d.Session(folder), out, 0.0)
    scan = d.read_mesh(folder / "scan.ply")
    d.write_mesh(folder / "scan.ply", d.Mesh(scan.vertices + [0.1, 0, 0], scan.faces))
    before = (folder / "scan.ply").read_bytes()
    assert main(["scan", str(folder), *FAST, "--refine", str(out)]) == 1
    assert "expected a template made from" in capsys.readouterr().err
    assert (folder / "scan.ply").read_bytes() == before


@pytest.mark.parametrize("better", [31, 0, None])
def test_where_nobody_stands_the_frame_that_would_do_is_named(better):
    said = (
        f"; frame {better} is more like a standing body: doublet scan 's 1' --force --frame {better}"
        if better is not None
        else ""
    )

    def found(largest, **how):
        marks = SimpleNamespace(fit=SimpleNamespace(coefficients=np.array([0.3, -largest])))
        return make_scan.Marked([], next(iter(make_scan.shape_findings(marks)), None), **how)

    assert make_scan.reported(found(4.9), better, Path("s 1")) == []
    for largest, impossible in ((6, False), (9, True)):
        (finding,) = make_scan.reported(found(largest), better, Path("s 1"))
        assert finding.impossible == impossible and finding.text.endswith("have grown together" + said)
    with pytest.raises(RuntimeError, match="have grown together" + said):
        make_scan.reported(found(9, written=False), better, Path("s 1"))


@pytest.mark.parametrize(("rival", "largest", "stands"), [(0.6, 4, True), (0.9, 4, False), (0.6, 6, False), (0.9, 6, False)])
def test_nobody_stands_where_a_body_fits_both_ways_round_or_is_none(monkeypatch, tmp_path, rival, largest, stands):
    marks = SimpleNamespace(fit=SimpleNamespace(coefficients=np.array([largest])), facing_ambiguity=rival)
    job = SimpleNamespace(session=SimpleNamespace(scan=None), session_folder=tmp_path)
    for name, what in (("scan_frame", 0), ("seen_joints", {}), ("marks_of", marks), ("joints_file", {}), ("corrected", {})):
        monkeypatch.setattr(make_scan, name, lambda *_, what=what: what)
    monkeypatch.setattr(make_scan.d, "read_mesh", lambda _: None)
    found = make_scan.write_marks(job, True, of_cameras=True)
    assert (found.nobody is None) == stands and len(found.findings) == (rival > 0.7 and largest > 5)
    assert make_scan.write_marks(job, True, of_cameras=False).nobody is None  # a scanner's scan is of one frame alone

    def no_body(*_):
        raise d.Error("expected a person")

    monkeypatch.setattr(make_scan, "marks_of", no_body)
    found = make_scan.write_marks(job, True, of_cameras=True)
    assert found.nobody.text == "expected a person" and found.nobody.impossible and not found.written
    with pytest.raises(FileExistsError, match="joints.json exists"):  # somebody's own: no other frame is tried over it
        make_scan.write_marks(job, False, of_cameras=True)


@pytest.mark.slow
def test_another_frame_is_taken_where_nobody_stands_in_the_first(model, tmp_path, capsys, monkeypatch):
    """Unless the frame was named: then that one is refused, and the other named."""
    person, ball = Person(model, 0.7, 3), d.capsule_mesh([0.2, 0.5, -0.3], [0.2, 1.2, -0.3], 0.3, 0.3)
    folder = write_session(tmp_path / "session", person, before=[ball])
    monkeypatch.setattr(make_scan, "best_frame", lambda _: 1)
    assert main(["scan", str(folder), *FAST, "--frame", "0"]) == 1
    refusal = capsys.readouterr().err
    assert "joint detection: expected" in refusal and f"; frame 1 is more like a standing body: doublet scan {folder}" in refusal
    assert d.Session(folder).scan.name == "scan.ply" and not (folder / "joints.json").exists()  # what was made is kept
    assert main(["scan", str(folder), *FAST, "--force"]) in (0, 3)
    session = d.Session(folder)
    assert session.frame_count == 3 and scan_frame(session) == 1
    assert np.mean(list(person.errors_mm({mark.name: mark.position for mark in session.joints}).values())) < 25
