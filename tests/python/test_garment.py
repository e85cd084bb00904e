"""The garment stage from Python: a mesher of one's own, the dressed actor, what the report shows."""

import json
import re
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.pages import report

SAID = d.Context()


class AsScanned(d.GarmentMesher):
    """Only as wide as the scan."""

    def mesh(self, actor, clothness, body, captured, context):
        garment = d.mesh_garment(actor, clothness, body, captured, d.GarmentOptions(vertices=300), context)
        garment.rest = garment.mesh.vertices
        return garment


@pytest.fixture(scope="module")
def skirt(shapes):
    """A cone, its lower half cloth, closed below by a sheet that nobody saw: (actor, clothness)."""
    vertices, faces = shapes["tube"](lambda h: 0.35 - 0.15 * h, 0.5, 1.5)
    around, below = 48, len(vertices)
    sheet = np.stack([np.full(around, below), (np.arange(around) + 1) % around, np.arange(around)], axis=1)
    vertices, faces = np.vstack([vertices, [[0, 0.5, 0]]]), np.vstack([faces, sheet]).astype(np.int32)
    valid = np.arange(len(faces)) < len(faces) - around
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 1, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(vertices, faces), valid.tolist(), np.ones((len(vertices), 1)), skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    return actor, d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))


def test_a_mesher_of_ones_own(skirt, tmp_path):
    actor, clothness = skirt
    garment = AsScanned().mesh(actor, clothness, d.Mesh(), d.MeshSequence(), SAID)
    d.write_garment(tmp_path / "garment.npz", garment)
    back = d.read_garment(tmp_path / "garment.npz", actor)
    np.testing.assert_allclose(back.rest, garment.mesh.vertices, atol=1e-6)
    np.testing.assert_array_equal(back.replaced_faces, garment.replaced_faces)
    assert back.region_count == 1
    summary = d.summarise_garment(back)
    assert (summary.regions, summary.loops, summary.hanging_loops) == (1, 2, 1)
    assert (summary.vertices, summary.faces) == (len(back.region), len(back.mesh.faces))


def test_the_dressed_actor_has_the_garment_behind_its_own_vertices(skirt):
    actor, clothness = skirt
    garment = d.mesh_garment(actor, clothness, d.Mesh(), d.MeshSequence(), d.GarmentOptions(vertices=300))
    dressed, bare = d.dress(actor, clothness, garment), len(actor.mesh.vertices)
    np.testing.assert_array_equal(dressed.actor.mesh.vertices[bare:], garment.mesh.vertices)
    np.testing.assert_array_equal(dressed.segmentation.clothness, np.r_[np.zeros(bare), garment.clothness])
    np.testing.assert_array_equal(dressed.segmentation.rest[bare:], garment.rest)
    valid = np.asarray(dressed.actor.face_valid, bool)
    assert (
        valid[len(actor.mesh.faces) :].all()
        and not valid[: len(actor.mesh.faces)][np.asarray(garment.replaced_faces, bool)].any()
    )
    performance = d.ReferencePerformance()
    performance.dofs, performance.frames, performance.joints = np.zeros((2, 6)), [0, 1], np.zeros((2, 1, 3))
    performance.surface = d.MeshSequence(actor.mesh.faces, np.stack([actor.mesh.vertices, actor.mesh.vertices + [0, 0.1, 0]]))
    frames = d.dress(performance, actor, garment).surface.frames
    np.testing.assert_allclose(frames[1, bare:], garment.mesh.vertices + [0, 0.1, 0], atol=1e-9)


def test_a_file_of_another_actor_is_refused(skirt, shapes, tmp_path):
    actor, clothness = skirt
    d.write_garment(tmp_path / "garment.npz", d.mesh_garment(actor, clothness, d.Mesh(), d.MeshSequence()))
    vertices, faces = shapes["tube"](0.3, 0.5, 1.5, rows=4)
    other = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.ones((len(vertices), 1)), actor.skeleton)
    with pytest.raises(d.Error, match=r"garment.npz: array 'covers'"):
        d.read_garment(tmp_path / "garment.npz", other)


def test_the_pipeline_wears_what_the_file_says(bell):
    """The bell's garment has no vertices: the cloth is the loose part of the template, and the report says so."""
    job = reconstruct.Job(bell, bell)
    assert len(job.results.dressed.actor.mesh.vertices) == len(job.results.actor.mesh.vertices)
    np.testing.assert_array_equal(job.results.dressed.segmentation.clothness, job.results.segmentation().clothness)
    assert job.results.dressed_performance().surface.frames.shape == job.results.performance().surface.frames.shape
    assert job.options["cloth"].stiffness == "compliance" and d.ClothOptions.paper().stiffness == "sweeps"

    class Shown:
        pass

    shown = Shown()
    shown.job = job
    assert "No mesh of its own" in report.garment(shown)


def test_cloth_that_lies_on_the_body_is_carried_and_the_run_says_so(skirt, tmp_path):
    """The body is the surface itself, 3 mm smaller: nothing is simulated."""
    actor, clothness = skirt
    performance = d.ReferencePerformance()
    performance.frames, performance.dofs, performance.joints = [0, 1], np.zeros((2, 6)), np.zeros((2, 1, 3))
    performance.surface = d.MeshSequence(actor.mesh.faces, np.stack([actor.mesh.vertices] * 2))
    body = d.BodyFit()
    body.body = d.Mesh(actor.mesh.vertices * [0.99, 1, 0.99], actor.mesh.faces)
    d.write_actor(tmp_path / "actor.npz", actor)
    d.write_segmentation(tmp_path / "segmentation.npz", clothness)
    d.write_performance(tmp_path / "performance.npz", performance)
    d.write_body(tmp_path / "body.npz", body)
    job = reconstruct.Job(tmp_path, tmp_path)
    numbers = next(s for s in reconstruct.STAGES if s.name == "garment").run(job)
    assert numbers["regions"] == 0 and numbers["carried_area"] == pytest.approx(0.55, abs=0.05)
    (finding,) = d.quality_findings("garment", numbers)
    assert finding.kind == "carried"
    assert re.search(r"region 0 \(5\d(\.\d)? % of the surface\) within [23](\.\d+)? mm", finding.text)
    assert finding.kind in report.ADVICE
    assert job.results.dressed.segmentation.region_count == 0
    assert not np.any(job.results.dressed.segmentation.clothness)
    shown = SimpleNamespace(job=job, actor=actor, faces=actor.mesh.faces)
    text = report.garment(shown)
    assert "not simulated" in text and "there is no garment" in text and text.count("<img") == 2


def area_of(garment) -> float:
    return float(d.face_areas(garment.rest, garment.mesh.faces).sum())


def test_widths_are_offered_worn_and_read_back(skirt, tmp_path):
    """One mesh, a rest shape a width, the widest first; what material.json names is worn."""
    actor, clothness = skirt
    wide = np.array(actor.mesh.vertices) * [1.3, 1, 1.3]
    performance = d.ReferencePerformance()
    performance.frames, performance.dofs, performance.joints = [0, 1, 2, 3], np.zeros((4, 6)), np.zeros((4, 1, 3))
    performance.surface = d.MeshSequence(
        actor.mesh.faces, np.stack([actor.mesh.vertices + w * (wide - actor.mesh.vertices) for w in (0, 0.3, 0.6, 1)])
    )
    d.write_actor(tmp_path / "actor.npz", actor)
    d.write_segmentation(tmp_path / "segmentation.npz", clothness)
    d.write_performance(tmp_path / "performance.npz", performance)
    body = d.BodyFit()
    body.body = d.Mesh(np.array(actor.mesh.vertices) * [0.6, 1, 0.6], actor.mesh.faces)
    d.write_body(tmp_path / "body.npz", body)
    job = reconstruct.Job(tmp_path, tmp_path, {"garment": d.GarmentOptions(vertices=300, length_exceedances=[0.1, 0.5, 0.9])})
    areas = next(s for s in reconstruct.STAGES if s.name == "garment").run(job)["areas_m2"]
    assert len(areas) == 3 and areas[0] > 1.02 * areas[1] > 1.02 * 1.02 * areas[2]
    assert area_of(job.results.garment) == pytest.approx(areas[1], rel=1e-4)  # until the video has chosen, the middle one
    assert [area_of(g) for g in d.width_variants(job.results.offered_garment)] == pytest.approx(areas, rel=1e-4)
    (tmp_path / "material.json").write_text(json.dumps({"regions": [{"width": 0}]}))
    job.results.forget()
    assert area_of(job.results.garment) == pytest.approx(areas[0], rel=1e-4) and not job.results.garment.widths
    (tmp_path / "material.json").write_text(json.dumps({"regions": [{"width": 3}]}))  # of a garment with more widths
    job.results.forget()
    assert len(job.results.dressed_performance().surface.frames) == 4  # what the next search needs
    with pytest.raises(ValueError, match="expected a width between 0 and 2, found 3"):
        d.choose_widths(job.results.offered_garment, [3])
    with pytest.raises(ValueError, match="one width for each of 1 regions, found 2"):
        d.choose_widths(job.results.offered_garment, [0, 0])
    one = d.mesh_garment(
        actor, clothness, body.body, performance.surface, d.GarmentOptions(vertices=300, length_exceedances=[0.5])
    )
    assert not one.widths and len(d.width_variants(one)) == 1
    with pytest.raises(ValueError, match="length_exceedances: expected at least one, ascending"):
        d.GarmentMesher.create(d.GarmentOptions(length_exceedances=[0.5, 0.1]))
