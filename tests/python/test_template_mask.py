"""The user's mask of invalid triangles: goes before the suggestion, is checked, makes the rig run again."""

import shutil

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.common.console import Console

SUGGESTED, EDITED = "template_suggestion.npz", "template_mask.npz"


@pytest.fixture
def job(tmp_path, shapes):
    """OUT with a template, a tube, as after the stage `template`; and a session with one joint in it."""
    session, out = tmp_path / "session", tmp_path / "out"
    session.mkdir()
    out.mkdir()
    (session / "session.json").write_text("{}")
    (session / "joints.json").write_text("{}")
    vertices, faces = shapes["tube"](0.1, 0.0, 1.0)
    d.write_mesh(out / "template.ply", d.Mesh(vertices, faces))
    surface = d.Template()
    surface.face_valid, surface.high_face_valid = [1] * len(faces), [1, 1]
    d.write_template_suggestion(out / SUGGESTED, surface)
    job = reconstruct.Job(session, out, console=Console(quiet=True))
    made = d.Session()
    made.folder, made.scan, made.markers = session, session / "scan.ply", session / "joints.json"
    made.joints = [d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)]
    job.session = made
    return job


def half(job):
    mask = np.array(d.read_suggested_mask(job.out))
    mask[: len(mask) // 2] = 0
    return mask


def test_without_a_mask_the_suggestion_counts(job):
    assert d.read_template_mask(job.out).all()
    job.run(["rig"])
    assert job.record.summary("rig")["mask"] == "suggested"
    assert all(job.results.actor.face_valid)


def test_the_mask_goes_before_the_suggestion_and_the_rig_runs_again(job):
    assert job.run(["rig"]) and not job.run(["rig"])
    d.write_template_mask(job.out, half(job))
    assert job.run(["rig"]) and not job.run(["rig"])
    assert (job.results.actor.face_valid == half(job)).all()
    summary = job.record.data["stages"]["rig"]["summary"]
    assert summary["mask"] == "edited" and summary["invalid_area_m2"] == pytest.approx(np.pi * 0.1, rel=0.02)
    (job.out / EDITED).unlink()
    assert job.run(["rig"])
    assert all(job.results.actor.face_valid)


def test_masks_of_other_programs(job):
    np.savez(job.out / EDITED, face_valid=half(job).astype(np.int32))
    assert (d.read_template_mask(job.out) == half(job)).all()


@pytest.mark.parametrize(
    ("arrays", "complaint"),
    [
        ({"face_valid": np.ones(5)}, "5 values, not one for each"),
        ({"valid": np.ones(5)}, "face_valid"),
        ({"face_valid": np.full(23 * 48 * 2, 2)}, "neither 0 nor 1"),
        ({"face_valid": np.zeros(23 * 48 * 2)}, "no valid triangle"),
    ],
)
def test_wrong_masks_are_named(job, arrays, complaint):
    np.savez(job.out / EDITED, **arrays)
    with pytest.raises(RuntimeError, match=complaint) as caught:
        d.read_template_mask(job.out)
    assert EDITED in str(caught.value)


def test_broken_file(job):
    (job.out / EDITED).write_text("no npz")
    with pytest.raises(RuntimeError, match=EDITED):
        d.read_template_mask(job.out)


def test_a_mask_for_another_template_is_refused(job, shapes):
    d.write_template_mask(job.out, half(job))
    shutil.copy(job.out / "template.ply", job.out / "before.ply")
    vertices, faces = shapes["tube"](0.2, 0.0, 1.0)
    d.write_mesh(job.out / "template.ply", d.Mesh(vertices, faces))
    with pytest.raises(RuntimeError, match="another template"):
        d.read_template_mask(job.out)
    shutil.copy(job.out / "before.ply", job.out / "template.ply")
    assert (d.read_template_mask(job.out) == half(job)).all()


def test_only_masks_are_written(job):
    with pytest.raises(ValueError, match="3 values"):
        d.write_template_mask(job.out, [1, 0, 1])
    assert not (job.out / EDITED).exists()
