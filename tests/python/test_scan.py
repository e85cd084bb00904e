"""Scan and joints out of the cameras alone: a known body, seen by a ring of cameras."""

import json

import doublet as d
import numpy as np
import pytest
from doublet import body_model_path
from doublet.cli import main
from PIL import Image

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
        self.joints = dict(zip(model.joint_names, self.world(model.joints(s)[0]), strict=True))
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
    marks = d.find_body_marks(person.mesh, [], model, d.BodyFitOptions(iterations=8))
    assert marks.rival < 0.7
    assert marks.fit.residual < 0.002
    errors = person.errors_mm({mark.name: mark.position for mark in marks.joints})
    assert len(errors) == 21
    assert max(errors.values()) < 20, errors
    assert set(marks.landmarks) >= {"head_top", "nose_tip", "l_heel", "r_big_toe_tip"}
    assert len(d.Skeleton(marks.joints).dof_names) == 36


def test_no_person_no_joints(model):
    ball = d.capsule_mesh([0, 0.5, 0], [0, 1.5, 0], 0.3, 0.3)
    with pytest.raises(d.Error, match="body marks: expected a person, upright"):
        d.find_body_marks(ball, [], model)
    with pytest.raises(ValueError, match="face_valid: expected"):
        d.find_body_marks(ball, [1, 0], model)
    hole = d.Mesh(np.where(np.arange(len(ball.vertices))[:, None] == 7, np.nan, ball.vertices), ball.faces)
    with pytest.raises(d.Error, match="1 non-finite vertices"):
        d.find_body_marks(hole, [], model)
    with pytest.raises(d.Error, match="corners in range"):
        d.find_body_marks(d.Mesh(ball.vertices, ball.faces + 3), [], model)


def test_the_command_completes_a_session(model, tmp_path, capsys):
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person)
    assert main(["reconstruct", str(folder), "-o", str(tmp_path / "out"), "--quiet"]) == 1
    assert "`doublet scan` makes scan and joints from the cameras" in capsys.readouterr().err
    assert main(["scan", str(folder), *FAST]) in (0, 3)
    session = d.Session(folder)
    surface = d.RayScene(person.mesh)
    assert surface.closest(d.read_mesh(session.scan).vertices)[1].mean() < 0.012
    errors = person.errors_mm({mark.name: mark.position for mark in session.joints})
    assert np.mean(list(errors.values())) < 25, errors
    assert Image.open(folder / "scan_check.png").size[0] > 300

    capsys.readouterr()
    assert main(["scan", str(folder), *FAST]) == 1
    assert "names a scan and joints already; --force makes them anew" in capsys.readouterr().err


def test_the_best_frame_is_found_and_the_session_begins_there(model, tmp_path, capsys):
    person = Person(model, 0.7, 3)
    ball = d.capsule_mesh([0.2, 0.5, -0.3], [0.2, 1.2, -0.3], 0.3, 0.3)
    folder = write_session(tmp_path / "session", person, before=[ball, ball])
    before = (folder / "session.json").read_text(encoding="utf-8")
    assert main(["scan", str(folder), *FAST, "--frame", "3"]) == 1
    assert "--frame: expected 0 to 2, for a motion to be left, found 3" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["scan", str(folder), *FAST, "--frame", "last"])
    assert "expected the number of a frame, or best, found 'last'" in capsys.readouterr().err
    assert (folder / "session.json").read_text(encoding="utf-8") == before
    assert main(["scan", str(folder), *FAST, "--frame", "best"]) in (0, 3)
    session = d.Session(folder)
    assert session.frame_count == 2 and {camera.first_frame for camera in session.cameras} == {2}
    assert np.mean(list(person.errors_mm({mark.name: mark.position for mark in session.joints}).values())) < 25
    assert main(["scan", str(folder), *FAST, "--force", "--frame", "1"]) == 1  # of what is left


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
    assert main(["scan", str(folder), *FAST]) == 0
    assert d.Session(folder).scan.name == "own.ply"
    assert not (folder / "scan.ply").exists()


def test_too_few_cameras(model, tmp_path, capsys):
    folder = write_session(tmp_path / "session", Person(model, 0.0, 5), cameras=2)
    before = (folder / "session.json").read_text(encoding="utf-8")
    assert main(["scan", str(folder), *FAST]) == 1
    assert "scan: expected the actor in at least 3 cameras, found 2 of 2 with a silhouette" in capsys.readouterr().err
    assert (folder / "session.json").read_text(encoding="utf-8") == before
