"""benchmarks/field.py: random clips, what of a simulation counts as a success, distances to a truth."""

import json
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
import field  # noqa: E402

FPS = 40.0
SESSION = ROOT / "examples" / "data" / "session"


@pytest.fixture(scope="module")
def write_bell(shapes, tmp_path_factory):
    """(material) -> file of a bell on a person's pelvis, its lower half of cloth, around a thinner body."""
    skeleton = d.Skeleton(d.Session(SESSION).joints)

    def written(material: d.Material) -> Path:
        vertices, faces = shapes["tube"](lambda h: 0.35 - 0.15 * h, 0.5, 1.5, around=24, rows=12)
        weights = np.zeros((len(vertices), len(skeleton.joint_names)))
        weights[:, skeleton.find("pelvis")] = 1
        actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
        cloth = (vertices[:, 1] < 1).astype(float)
        segmentation = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
        fit, solver = d.BodyFit(), d.SolverSettings(1 / FPS)
        fit.body = d.Mesh(*shapes["tube"](0.08, 0.4, 1.4, around=12, rows=8))
        valid = [1] * len(faces)
        path = tmp_path_factory.mktemp("bell") / "bell.glb"
        d.make_character(actor, segmentation, fit, [], [material], solver, actor.mesh, valid).write(path)
        return path

    return written


@pytest.fixture(scope="module")
def bell(write_bell):
    return write_bell(d.Material(k_stretch=1.0))


@pytest.fixture
def still(bell):
    return d.Motion(FPS, np.zeros((20, len(d.Character.read(bell).actor.skeleton.dof_names))))


def playing(monkeypatch, move=None, **options):
    """field.py's player has other options, and its cloth is moved before the first frame: move(positions) -> positions."""

    class Player(d.Player):
        def __init__(self, character):
            super().__init__(character, d.AnimateOptions(**options))

        def reset(self, dofs):
            super().reset(dofs)
            if move:
                state = self.state
                regions = state.regions
                regions[0].positions = move(np.array(regions[0].positions))
                state.regions = regions
                self.state = state
            return self.frame

    monkeypatch.setattr(field.d, "Player", Player)


def test_clips_are_played_and_told(bell, tmp_path):
    command = [
        sys.executable,
        ROOT / "benchmarks" / "field.py",
        f"bell={bell}",
        "--clips",
        SESSION / "motion.bvh",
        "-o",
        tmp_path,
    ]
    printed = subprocess.run([*command, "--count", "2"], capture_output=True, text=True, check=True).stdout
    rows = [json.loads(line) for line in (tmp_path / "bell.jsonl").read_text().splitlines()]
    assert [row["turned"] for row in rows] == [True, False] and all(0.7 <= row["speed"] <= 1.4 for row in rows)
    assert all(100 < row["frames"] < 160 and len(row["body"]) > 12 and row["seconds"] > 0 for row in rows)
    assert printed.splitlines()[-1].startswith("| bell | ")


def test_joints_are_turned_between_the_ends_of_a_clip(bell):
    skeleton = d.Character.read(bell).actor.skeleton
    motion = d.Motion(FPS, np.zeros((80, len(skeleton.dof_names))))
    dofs = field.turned(motion, skeleton, np.random.default_rng(3)).dofs
    assert not dofs[[0, -1]].any() and not dofs[:, :6].any()
    assert np.all(dofs >= skeleton.lower) and np.all(dofs <= skeleton.upper) and np.abs(dofs[:, 6:]).max(axis=0).min() > 0.1
    assert np.abs(np.diff(dofs, axis=0)).max() < 0.15
    assert np.array_equal(dofs, field.turned(motion, skeleton, np.random.default_rng(3)).dofs)


def test_cloth_that_hangs_succeeds_and_is_not_played_again(bell, still, tmp_path, monkeypatch):
    monkeypatch.setattr(field, "motion_of", lambda *_: still)
    drawn = {"seed": 1, "index": 0, "clip": "still.bvh", "turned": False}
    field.Subject("bell", bell, tmp_path).play(drawn, None)
    row = json.loads((tmp_path / "bell.jsonl").read_text())
    assert field.succeeded(row) and row["crossing"] == [0, 0] and row["stretch"] < 1.2 and row["body"] == [0, 0, 0]
    monkeypatch.setattr(field.Subject, "measured", None)
    again = field.Subject("bell", bell, tmp_path)
    again.play(drawn, None)
    assert field.table_row("bell", list(again.rows.values()))[:3] == ["bell", "1 of 1", "-"]
    with pytest.raises(SystemExit, match="take another folder"):
        again.play(drawn | {"clip": "other.bvh"}, None)
    other = d.Character.read(bell)
    other.materials = [d.Material(k_bend=0.9)]
    other.write(tmp_path / "other.glb")
    with pytest.raises(SystemExit, match="take another folder"):
        field.Subject("bell", tmp_path / "other.glb", tmp_path).play(drawn, None)


def test_cloth_that_is_too_long_fails(write_bell, still, tmp_path, monkeypatch):
    playing(monkeypatch, edge_collision=False)  # which would limit it
    row = field.Subject("bell", write_bell(d.Material(k_stretch=0.01)), tmp_path).measured(still)
    assert row["stretch"] > 3 and not field.succeeded(row)


def test_a_knot_that_stays_fails(bell, still, tmp_path, monkeypatch):
    def turn_over(cloth):
        return np.where(cloth[:, 1:2] < 0.8, cloth * [-1, 1, -1], cloth)

    playing(monkeypatch, turn_over, redrape_when_tangled=False, edge_collision=False)
    row = field.Subject("bell", bell, tmp_path).measured(still)
    assert row["crossing"][1] > field.TANGLED and row["let_go"] > field.TANGLED and not field.succeeded(row)


def test_distances_between_tubes(shapes):
    cameras = [shapes["camera"](a, name=f"cam{i}") for i, a in enumerate(np.linspace(0, 2 * np.pi, 4, endpoint=False))]
    truth, wider = (shapes["tube"](radius, 0.3, 0.7, around=96) for radius in (0.2, 0.22))
    same, off = field.scores(truth, truth, cameras), field.scores(wider, truth, cameras)
    assert list(same.values()) == pytest.approx([0, 0, 100, 100], abs=1e-3)
    assert list(off.values()) == pytest.approx([20, 0.8, 0, 100], rel=0.01, abs=1e-3)
