"""The error measures on a scene whose errors are known: a trunk (body) in a wider tube (skirt), and a copy that is moved."""

import json
from pathlib import Path
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli
from doublet.common.console import Console
from doublet.evaluation import metrics as e
from doublet.evaluation import motion_metrics
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
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)])
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
        d.write_segmentation(scene["out"] / "segmentation.npz", d.Segmentation(np.zeros(len(vertices)), clothness, region))
    return e.Reconstruction(scene["out"]), e.Truth(scene["truth"])


def test_perfect_reconstruction_has_no_error(scene):
    made, truth = reconstruct(scene)
    assert e.joint_mm(made, truth, 1) == pytest.approx(0, abs=1e-4)
    surface = e.surface_mm(made, truth, scene["cameras"], 1, QUIET)
    assert surface["surface_body_mm"] == pytest.approx(0, abs=1e-3)
    assert surface["surface_cloth_mm"] == pytest.approx(0, abs=1e-3)
    assert e.silhouette_iou(made, truth, scene["cameras"], 1, QUIET) > 0.999


def test_a_garment_that_no_camera_sees_has_no_error(scene):
    chunk = scene["truth"] / "frames_0000.npz"
    with np.load(chunk) as truth:
        arrays = dict(truth)
    arrays["cloth"] = arrays["cloth"] * [0.2, 1, 0.2]  # in the trunk
    np.savez(chunk, **arrays)
    made, truth = reconstruct(scene)
    surface, _ = e.attempt(e.METRICS, {"surface": lambda: e.surface_mm(made, truth, scene["cameras"], 1, QUIET)})
    assert surface["surface_body_mm"] == pytest.approx(0, abs=1e-3) and surface["surface_cloth_mm"] is None


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


def reanimate(scene, garment=None, clothness=None, **arrays):
    """A reconstruction with its simulated.npz; the actor is the truth's unless arrays has `vertices`, (T, V, 3) or (V, 3).
    garment (G, 3) or (T, G, 3) is a skirt of its own, with faces as the true one, once or again and again."""
    made, truth = reconstruct(scene, clothness=clothness)
    arrays = {"vertices": scene["vertices"], **arrays}
    if garment is not None:
        arrays["garment"] = garment
        once, count = truth.cloth_faces, np.shape(garment)[-2]
        faces = np.vstack([once + k for k in range(0, count, once.max() + 1)])
        covers = clothness[scene["faces"]].mean(axis=1) > 0.5
        np.savez(scene["out"] / "garment.npz", vertices=np.zeros((count, 3)), faces=faces, covers=covers)
    every = {name: np.broadcast_to(np.asarray(array, np.float32), (FRAMES, *array.shape[-2:])) for name, array in arrays.items()}
    np.savez(scene["out"] / "simulated.npz", **every)
    return made.reanimated, truth


def is_cloth(scene):
    return (np.arange(len(scene["vertices"])) >= len(scene["body"][0])).astype(float)


def write_true_garment(scene, cloth, pelvis, joint_names=("pelvis",)):
    """cloth (T, G, 3) and pelvis (T, 3) take the place of the truth's."""
    body = np.zeros((len(cloth), *scene["body"][0].shape), np.float32)
    np.savez(scene["truth"] / "frames_0000.npz", frames=np.arange(len(cloth)), body=body, cloth=cloth)
    joints = np.full((len(cloth), len(joint_names), 3), 9.0)
    joints[:, joint_names.index("pelvis") if "pelvis" in joint_names else 0] = pelvis
    np.savez(scene["truth"] / "skeleton.npz", joint_names=joint_names, joints=joints)


def test_resimulated_cloth(scene):
    # The skirt hangs 20 cm above its place. Its lower edge is 20 cm below the moved body's lower end, but the trunk is 10 cm
    # inside the skirt: between 10 and 25 cm.
    assert 10 < e.cloth_rms_cm(*reanimate(scene, vertices=scene["vertices"] + [0, 0.5, 0]), 1, QUIET, "") < 25
    assert e.cloth_rms_cm(*reanimate(scene), 1, QUIET, "") < 1e-3


def test_two_sided_sees_cloth_that_was_torn_off(scene):
    """Of a double skirt one half flies 1 m above its place: 0.3 to 0.6 m above the upper rim of the true one, by rows."""
    truth = e.Truth(scene["truth"])
    skirt = truth.frame(0)[1]
    moving, truth = reanimate(scene, np.vstack([skirt, skirt + [0, 1, 0]]), is_cloth(scene))
    assert e.cloth_rms_cm(moving, truth, 1, QUIET, "") < 1e-3
    torn = np.square(skirt[:, 1] + 1 - 0.7).mean() / 2  # the other half is in its place
    expected = 100 * np.sqrt(torn / 2)  # and so is the true one for the surface
    assert e.cloth_rms_cm(moving, truth, 1, QUIET, "", two_sided=True) == pytest.approx(expected, rel=1e-3)


def test_two_sided_without_a_garment_of_its_own(scene):
    """The actor's cloth is 5 cm wider than the true one, either way; the trunk is none of it."""
    wider = scene["vertices"] * np.where(is_cloth(scene) > 0, 1.25, 1)[:, None] ** np.array([1, 0, 1])
    moving, truth = reanimate(scene, vertices=wider, clothness=is_cloth(scene))
    assert e.cloth_rms_cm(moving, truth, 1, QUIET, "", two_sided=True) == pytest.approx(5, abs=0.1)
    with pytest.raises(e.Missing, match="has no cloth"):
        e.cloth_rms_cm(*reanimate(scene, clothness=0 * is_cloth(scene)), 1, QUIET, "", two_sided=True)


def test_cloth_has_a_face():
    moving = e.Animated({}, np.array([[0, 1, 2]]), np.array([1, 0.5, 0.6, 1]))
    assert moving.cloth.tolist() == [0, 2]


def test_garment_of_its_own_replaces_the_actors_cloth(scene):
    """The actor's cloth hangs where the true garment does, the garment 5 cm outside it, and that counts. A single vertex of the
    trunk that is said to be cloth takes no face away, and is none of the garment."""
    wider = e.Truth(scene["truth"]).frame(0)[1] * [1.25, 1, 1.25]
    clothness = is_cloth(scene)
    clothness[0] = 1
    moving, truth = reanimate(scene, wider, clothness)
    assert len(moving.faces) == len(scene["faces"])
    assert len(moving.cloth) == len(wider) and (moving.surfaces[1][moving.cloth] == wider.astype(np.float32)).all()
    assert e.cloth_rms_cm(moving, truth, 1, QUIET, "") == pytest.approx(5, abs=0.1)
    # Without a skirt the trunk, of which every face stays, is 10 cm away.
    far = reanimate(scene, wider + [9, 0, 0], is_cloth(scene))
    assert e.cloth_rms_cm(*far, 1, QUIET, "") == pytest.approx(10, abs=0.1)


def test_garment_that_does_not_fit_is_an_error(scene):
    skirt = e.Truth(scene["truth"]).frame(0)[1]
    reanimate(scene, skirt, is_cloth(scene))
    short = np.zeros((FRAMES, len(skirt) - 1, 3))
    np.savez(scene["out"] / "simulated.npz", vertices=np.stack([scene["vertices"]] * FRAMES), garment=short)
    count = len(skirt)
    with pytest.raises(
        d.Error, match=rf"simulated.npz: array 'garment': expected \({FRAMES}, {count}, 3\).* found .*{count - 1}"
    ):
        _ = e.Reconstruction(scene["out"]).reanimated
    (scene["out"] / "garment.npz").unlink()
    with pytest.raises(e.Missing, match="garment.npz does not exist"):
        _ = e.Reconstruction(scene["out"]).reanimated


def test_files_of_an_earlier_run_are_an_error(scene):
    """Of fewer frames, which would be taken for the first ones; of another template."""
    count = len(scene["vertices"])
    reanimate(scene, clothness=is_cloth(scene))
    np.savez(scene["out"] / "simulated.npz", vertices=np.zeros((FRAMES - 1, count, 3), np.float32))
    with pytest.raises(
        d.Error, match=rf"simulated.npz: array 'vertices': expected \({FRAMES}, {count}, 3\).* found .*{FRAMES - 1},"
    ):
        _ = e.Reconstruction(scene["out"]).reanimated
    other = np.zeros(count - 1)
    d.write_segmentation(scene["out"] / "segmentation.npz", d.Segmentation(other, other, np.full(count - 1, -1)))
    with pytest.raises(d.Error, match=rf"segmentation.npz: array 'clothness': expected \({count},\).* found \({count - 1},\)"):
        _ = e.Reconstruction(scene["out"]).clothness


def outline(moving, truth):
    return [e.outline_rms_cm(moving, truth, 1, measure) for measure in (e.lowest, e.wide_radius)]


@pytest.mark.parametrize("joint_names", [("spine", "pelvis"), ("root", "spine")])
def test_hem_height_and_flare_are_measured_around_the_pelvis(scene, shapes, joint_names):
    """A cone that walks sideways. Its hem hangs 1, 2, 3 cm lower; then all of it is a tenth wider."""
    pelvis = np.array([[0.3 * t, 0.9, 0.1 * t] for t in range(FRAMES)])
    cone, faces = shapes["tube"](lambda h: 0.30 - 0.2 * h, -0.5, 0.0)  # about the pelvis; the hem has the radius 0.4
    sin, cos = np.sin(0.05), np.cos(0.05)  # no vertex on the border of two bins
    cone = cone @ np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
    np.savez(scene["truth"] / "static.npz", body_tris=scene["body"][1], cloth_tris=faces)
    write_true_garment(scene, cone + pelvis[:, None], pelvis, joint_names)
    lower = np.stack([cone - [0, 0.01 * (t + 1), 0] * (cone[:, 1:2] == -0.5) for t in range(FRAMES)])
    height, flare = outline(*reanimate(scene, lower + pelvis[:, None], is_cloth(scene)))
    assert height == pytest.approx(np.sqrt((1 + 4 + 9) / 3), abs=1e-3) and flare == pytest.approx(0, abs=1e-3)
    height, flare = outline(*reanimate(scene, cone * [1.1, 1, 1.1] + pelvis[:, None], is_cloth(scene)))
    wide = np.percentile(np.repeat(np.linspace(0.4, 0.3, 24), 2), 95)  # 24 rows of 48: two columns in a bin
    assert height == pytest.approx(0, abs=1e-3) and flare == pytest.approx(10 * wide, abs=1e-3)


def test_outline_compares_where_both_have_cloth(scene):
    skirt = e.Truth(scene["truth"]).frame(0)[1]
    tilted = skirt - [0, 0.02, 0] + np.where(skirt[:, :1] < -1e-6, [[0, 0.5, 0]], 0)  # half of it is wrong, and will not be there
    moving, truth = reanimate(scene, tilted, is_cloth(scene))
    half = e.Animated(moving.surfaces, moving.faces, moving.clothness * (moving.surfaces[0][:, 0] > 0.02))
    assert outline(half, truth)[0] == pytest.approx(2, abs=1e-3)
    write_true_garment(scene, np.stack([skirt[skirt[:, 0] < -0.02]] * FRAMES), np.zeros((FRAMES, 3)))
    np.savez(scene["truth"] / "static.npz", body_tris=scene["body"][1], cloth_tris=np.zeros((0, 3), np.int32))
    with pytest.raises(e.Missing, match="share no azimuth in frame 0"):
        outline(half, e.Truth(scene["truth"]))


def test_new_motion_is_measured_on_the_characters_own_mesh(scene, monkeypatch):
    """The dressed character has one vertex more than the actor, and a face there that the scan does not support."""
    _, truth = reanimate(scene)
    novel = scene["truth"] / "novel"
    novel.mkdir()
    (novel / "motion.bvh").touch()
    np.savez(novel / "frames_0000.npz", start=0, body=scene["body"][0][None], cloth=truth.frame(0)[1][None])
    vertices = np.vstack([scene["vertices"], [[0, 2, 0]]])
    faces = np.vstack([scene["faces"], [[0, 1, len(vertices) - 1]]])
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)])
    dressed = d.RiggedMesh(d.Mesh(vertices, faces), [1] * (len(faces) - 1) + [0], np.ones((len(vertices), 1)), skeleton)
    cloth = np.append(is_cloth(scene), 1)
    clothness = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    d.make_character(dressed, clothness, d.BodyFit(), [], [d.Material()], d.SolverSettings(1 / 40)).write(
        scene["out"] / "character.glb"
    )
    monkeypatch.setattr("doublet.evaluation.metrics.animate_exactly", lambda character, *_: character.actor.mesh.vertices[None])
    moving, there = e.new_motion(e.Reconstruction(scene["out"]), truth, 40, QUIET)
    assert there.folder == novel and len(moving.faces) == len(faces) - 1
    assert moving.cloth.tolist() == np.flatnonzero(is_cloth(scene)).tolist()
    assert e.cloth_rms_cm(moving, there, 1, QUIET, "", two_sided=True) < 1e-3


def test_the_command_line(scene, capsys):
    reanimate(scene, clothness=is_cloth(scene))
    session = Path(__file__).parents[2] / "examples" / "data" / "session"
    command = ["evaluate", scene["out"], "--truth", scene["truth"], "--session", session, "--quiet"]
    assert cli.main([str(a) for a in [*command, "--motion", "--json"]]) in (None, 0)
    result = json.loads(capsys.readouterr().out)
    assert list(result["metrics"]) == list(e.METRICS) and "novel_cloth_cm" in result["missing"]
    for name in ("resim_cloth_cm", "resim_two_sided_cm", "hem_height_cm", "flare_cm"):
        assert result["metrics"][name] == pytest.approx(0, abs=1e-3)
    motion = result["motion"]
    assert motion["truth"]["hem_speed_m_s"] == 0 and "two true child joints" in motion["missing"]["truth"]["hem_lag_s"]
    cli.main([str(a) for a in [*command, "--motion"]])
    assert "\nhem_lag_s" in capsys.readouterr().out
    cli.main([str(a) for a in command])
    assert "hem_lag_s" not in capsys.readouterr().out


def test_what_is_not_there_is_missing_not_zero(scene):
    made, truth = reconstruct(scene)
    with pytest.raises(e.Missing, match="segmentation.npz"):
        e.cloth_iou(made, truth, scene["cameras"])
    with pytest.raises(e.Missing, match="simulated.npz"):
        _ = made.reanimated
    moving, _ = reanimate(scene)
    assert e.cloth_rms_cm(moving, truth, 1, QUIET, "") < 1e-3  # needs no segmentation; what follows does
    with pytest.raises(e.Missing, match="segmentation.npz"):
        e.cloth_rms_cm(moving, truth, 1, QUIET, "", two_sided=True)
    with pytest.raises(e.Missing, match="segmentation.npz"):
        e.outline_rms_cm(moving, truth, 1, e.lowest)
    with pytest.raises(e.Missing, match="novel"):
        e.new_motion(made, truth, 40, QUIET)
    with pytest.raises(FileNotFoundError, match="ground truth"):
        e.Truth(scene["out"])


def session_of(scene, **description):
    (scene["out"] / "session.json").write_text(json.dumps(description), encoding="utf-8")
    return SimpleNamespace(folder=scene["out"], rig=scene["cameras"], fps=40.0, frame_count=FRAMES)


def test_the_scan_pose_is_that_of_the_frame_that_was_scanned(scene):
    """In frame 0 the person is elsewhere."""
    reconstruct(scene, clothness=is_cloth(scene))
    fit = d.BodyFit()
    fit.body, fit.coefficients, fit.model = d.Mesh(*scene["body"]), np.zeros(1), "test"
    d.write_body(scene["out"] / "body.npz", fit)
    count = len(scene["body"][0])
    moved = np.stack([scene["vertices"] + [0.3, 0.4, 0], *[scene["vertices"]] * (FRAMES - 1)])
    np.savez(scene["truth"] / "frames_0000.npz", start=0, body=moved[:, :count], cloth=moved[:, count:])
    found = []
    for described in ({"scan_frame": 2}, {}):  # a scan of which nothing is said is of frame 0
        metrics = e.evaluate(scene["out"], scene["truth"], session_of(scene, **described), Console(quiet=True))["metrics"]
        found.append([metrics[name] for name in ("template_invented_found", "cloth_iou", "hidden_body_mm")])
    assert found[0] == pytest.approx([1, 1, 0], abs=1e-3)  # nothing is invented
    assert found[1][0] == 0 and found[1][1] < 0.9 and found[1][2] > 10


def test_a_truth_without_a_garment_says_so(scene):
    """As that of a character without cloth; what can be measured is."""
    reanimate(scene, clothness=is_cloth(scene))
    fit = d.BodyFit()
    fit.body, fit.coefficients, fit.model = d.Mesh(*scene["body"]), np.zeros(1), "test"
    d.write_body(scene["out"] / "body.npz", fit)
    np.savez(scene["truth"] / "static.npz", body_tris=scene["body"][1], cloth_tris=np.zeros((0, 3), np.int32))
    body = np.stack([scene["body"][0]] * FRAMES)
    np.savez(scene["truth"] / "frames_0000.npz", start=0, body=body, cloth=np.zeros((FRAMES, 0, 3)))
    result = e.evaluate(scene["out"], scene["truth"], session_of(scene), Console(quiet=True))
    assert result["missing"]["surface_cloth_mm"] == "no camera sees a true garment"
    without = {name for name, reason in result["missing"].items() if reason == "the truth has no garment"}
    assert without == {"hidden_body_mm", "resim_cloth_cm", "resim_two_sided_cm", "hem_height_cm", "flare_cm"}
    assert result["metrics"]["cloth_iou"] == 0 and result["metrics"]["surface_body_mm"] < 0.01
    motion = motion_metrics.compare(e.Reconstruction(scene["out"]), e.Truth(scene["truth"]), 40.0)
    assert set(motion["missing"]["truth"].values()) == {"the truth has no garment"}


def test_cameras_that_do_not_see_the_truth_measure_no_cloth(scene):
    away = [d.orbit_camera([0, 500, 0], 1.0, 0.0, 0.0, 64, 64)]
    with pytest.raises(e.Missing, match="no surface that a camera sees"):
        e.cloth_iou(*reconstruct(scene, clothness=is_cloth(scene)), away)


def test_table_shows_missing_values():
    metrics = dict.fromkeys(e.METRICS, 1.5)
    metrics["cloth_iou"] = None
    text = e.format_table({"metrics": metrics, "missing": {"cloth_iou": "no segmentation"}})
    assert "missing" in text and "no segmentation" in text and text.count("1.500") == len(e.METRICS) - 1
