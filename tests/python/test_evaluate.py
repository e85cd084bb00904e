"""The error measures on a scene whose errors are known: a trunk (body) in a wider tube (skirt), and a copy that is moved."""

import doublet as d
import numpy as np
import pytest
from doublet import evaluate as e
from doublet.console import Console
from PIL import Image

FRAMES = 3
QUIET = Console(quiet=True).context()


@pytest.fixture
def scene(tmp_path, shapes):
    """Truth on disk and a reconstruction whose surface is the truth's."""
    body, body_faces = shapes["tube"](0.10, 0.0, 1.0)
    cloth, cloth_faces = shapes["tube"](0.20, 0.4, 0.7)
    truth, out = tmp_path / "truth", tmp_path / "out"
    (truth / "masks").mkdir(parents=True)
    out.mkdir()
    np.savez(truth / "static.npz", body_tris=body_faces, cloth_tris=cloth_faces)
    np.savez(
        truth / "frames_0000.npz", frames=np.arange(FRAMES), body=np.stack([body] * FRAMES), cloth=np.stack([cloth] * FRAMES)
    )
    np.savez(truth / "skeleton.npz", joint_names=["pelvis"], joints=np.tile([0.0, 0.5, 0.0], (FRAMES, 1, 1)))
    cameras = [shapes["camera"](a, name=f"cam{i}") for i, a in enumerate(np.linspace(0, 2 * np.pi, 4, endpoint=False))]
    vertices, faces = np.vstack([body, cloth]), np.vstack([body_faces, cloth_faces + len(body)])
    for camera in cameras:
        face, _ = d.rasterize(vertices, faces, camera)
        Image.fromarray(np.where(face >= 0, 255, 0).astype(np.uint8)).save(truth / "masks" / f"{camera.name}_0000.png")
    return {"truth": truth, "out": out, "cameras": cameras, "vertices": vertices, "faces": faces, "body": (body, body_faces)}


def reconstruct(scene, shift=(0, 0, 0), clothness=None):
    vertices, faces = scene["vertices"], scene["faces"]
    skeleton = d.Skeleton([d.JointMark("pelvis", "", [0, 0.5, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.ones((len(vertices), 1)), skeleton)
    performance = d.ReferencePerformance()
    performance.surface = d.MeshSequence(faces, np.stack([vertices + shift] * FRAMES))
    performance.dofs = np.zeros((FRAMES, 6))
    performance.joints = np.tile(np.array([0.0, 0.5, 0.0]) + shift, (FRAMES, 1, 1))
    performance.frames = list(range(FRAMES))
    d.write_actor(scene["out"] / "actor.npz", actor)
    d.write_performance(scene["out"] / "performance.npz", performance)
    if clothness is not None:
        region = np.where(clothness > 0, 0, -1).astype(np.int32)
        d.write_clothness(scene["out"] / "segmentation.npz", d.Clothness(np.zeros(len(vertices)), clothness, region))
    return e.Reconstruction(scene["out"]), e.Truth(scene["truth"])


def test_perfect_reconstruction_has_no_error(scene):
    made, truth = reconstruct(scene)
    assert e.joint_mm(made, truth, 1) == pytest.approx(0, abs=1e-4)
    surface = e.surface_mm(made, truth, scene["cameras"], 1, QUIET)
    assert surface["surface_body_mm"] == pytest.approx(0, abs=1e-3)
    assert surface["surface_cloth_mm"] == pytest.approx(0, abs=1e-3)
    assert e.silhouette_iou(made, truth, scene["cameras"], 1, QUIET) > 0.999


def test_known_shift_gives_known_errors(scene):
    made, truth = reconstruct(scene, shift=(0, 0.01, 0))
    assert e.joint_mm(made, truth, 1) == pytest.approx(10, abs=1e-3)
    # A tube moved along its own axis is off only at its two ends.
    assert e.surface_mm(made, truth, scene["cameras"], 1, QUIET)["surface_body_mm"] < 1
    made, truth = reconstruct(scene, shift=(0.01, 0, 0))
    # Moved sideways by s, a round tube is off by |s sin(angle)|: 2 s / pi on average.
    assert e.surface_mm(made, truth, scene["cameras"], 1, QUIET)["surface_cloth_mm"] == pytest.approx(20 / np.pi, rel=0.05)
    assert e.silhouette_iou(made, truth, scene["cameras"], 1, QUIET) < 0.97


def test_jitter_is_relative_to_the_truth(scene):
    made, truth = reconstruct(scene)
    with pytest.raises(e.Missing, match="do not move"):
        e.jitter_ratio(made, truth)
    bent = np.zeros((FRAMES, 1, 3))
    bent[1, 0, 0] = 0.004
    np.savez(scene["truth"] / "skeleton.npz", joint_names=["pelvis"], joints=bent)
    assert e.jitter_ratio(made, truth) == pytest.approx(0, abs=1e-6)
    made.performance.joints = np.asarray(made.performance.joints) + 1.5 * bent
    assert e.jitter_ratio(made, truth) == pytest.approx(1.5, rel=1e-3)


def test_cloth_iou(scene):
    count = len(scene["body"][0])
    exact = (np.arange(len(scene["vertices"])) >= count).astype(float)
    assert e.cloth_iou(*reconstruct(scene, clothness=exact), scene["cameras"]) == pytest.approx(1, abs=1e-6)
    assert e.cloth_iou(*reconstruct(scene, clothness=0 * exact), scene["cameras"]) == 0
    half = exact * (scene["vertices"][:, 0] > 0)
    assert e.cloth_iou(*reconstruct(scene, clothness=half), scene["cameras"]) == pytest.approx(0.5, abs=0.05)


def test_template_mask(scene):
    """The sheet is a disc 10 cm under the trunk; first nothing is marked, then a quarter of it, then the trunk as well."""
    made, truth = reconstruct(scene)
    count, faces = len(scene["vertices"]), len(scene["faces"])
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    disc = np.stack([0.05 * np.sin(turn), np.full(24, -0.1), 0.05 * np.cos(turn)], 1)
    vertices = np.vstack([scene["vertices"], disc, [[0, -0.1, 0]]])
    fan = np.array([[count + k, count + (k + 1) % 24, count + 24] for k in range(24)], np.int32)
    mesh = d.Mesh(vertices, np.vstack([scene["faces"], fan]))
    valid = np.ones(faces + 24, int)

    def measure(valid):
        made.actor = d.RiggedMesh(mesh, valid.tolist(), np.ones((len(vertices), 1)), made.actor.skeleton)
        return e.template_mask(made, truth, scene["cameras"])

    assert measure(valid) == {"template_invented_found": 0, "template_true_marked": 0}
    valid[faces : faces + 6] = 0
    assert measure(valid) == {"template_invented_found": pytest.approx(0.25), "template_true_marked": 0}
    body = len(scene["body"][1])
    valid[:body] = 0  # of what is seen, the trunk is 2 pi 0.1 (0.4 + 0.3), about, beside the skirt's 2 pi 0.2 0.3
    assert measure(valid)["template_true_marked"] == pytest.approx(0.07 / (0.07 + 0.06), abs=0.06)


def test_hidden_body_is_what_the_garment_hides(scene):
    made, truth = reconstruct(scene)
    fit = d.BodyFit()
    body, faces = scene["body"]
    # Wrong by 20 mm where the skirt is not; that must not count.
    wider = body * np.where((body[:, 1] > 0.35) & (body[:, 1] < 0.75), 1, 1.2)[:, None] ** np.array([1, 0, 1])
    fit.body, fit.coefficients, fit.model = d.Mesh(wider, faces), np.zeros(1), "test"
    d.write_body(scene["out"] / "body.npz", fit)
    assert e.hidden_body_mm(made, truth, scene["cameras"]) < 0.5
    fit.body = d.Mesh(body * [1.1, 1, 1.1], faces)
    d.write_body(scene["out"] / "body.npz", fit)
    assert e.hidden_body_mm(made, truth, scene["cameras"]) == pytest.approx(10, rel=0.05)


def test_resimulated_cloth(scene):
    made, truth = reconstruct(scene)
    shifted = np.stack([scene["vertices"] + [0, 0.5, 0]] * FRAMES).astype(np.float32)  # the skirt hangs 20 cm above its place
    np.savez(scene["out"] / "simulated.npz", vertices=shifted)
    error = e.resim_cloth_cm(made, truth, 1, QUIET)
    # Lower edge 20 cm below the moved body's lower end, but the trunk is 10 cm inside the skirt: between 10 and 25 cm.
    assert 10 < error < 25
    np.savez(scene["out"] / "simulated.npz", vertices=np.stack([scene["vertices"]] * FRAMES).astype(np.float32))
    assert e.resim_cloth_cm(made, truth, 1, QUIET) < 1e-3


def test_what_is_not_there_is_missing_not_zero(scene):
    made, truth = reconstruct(scene)
    with pytest.raises(e.Missing, match="segmentation.npz"):
        e.cloth_iou(made, truth, scene["cameras"])
    with pytest.raises(e.Missing, match="simulated.npz"):
        e.resim_cloth_cm(made, truth, 1, QUIET)
    with pytest.raises(e.Missing, match="novel"):
        e.novel_cloth_cm(made, truth, 40, 1, QUIET)
    with pytest.raises(FileNotFoundError, match="ground truth"):
        e.Truth(scene["out"])


def test_table_shows_missing_values():
    metrics = dict.fromkeys(e.METRICS, 1.5)
    metrics["cloth_iou"] = None
    text = e.format_table({"metrics": metrics, "missing": {"cloth_iou": "no segmentation"}})
    assert "missing" in text and "no segmentation" in text and text.count("1.500") == len(e.METRICS) - 1
